//! The picture that a pose gives: the board in it, with its corners, and the bodies behind and before it.

use maud::{Markup, html};

use crate::plan::document::{Picture, Scene, Silhouette};

pub(super) fn picture(scene: &Scene, picture: &Picture, name: &str) -> Markup {
    let (width, height) = (scene.camera.width_px, scene.camera.height_px);
    // Pixel (0, 0) is the centre of the first.
    let frame = format!("-0.5 -0.5 {width} {height}");
    let size = f64::from(width.max(height));
    let is = |i: usize, list: &[usize]| list.binary_search(&i).is_ok();
    let corners = || picture.corners_px.iter().enumerate().filter_map(|(i, corner)| Some((i, (*corner)?)));
    html! {
        svg viewBox=(frame) role="img" aria-label=(name) {
            (bodies(scene, picture, false))
            polygon points=(points(&picture.border_px)) fill="var(--panel)" {}
            g fill="var(--ink)" fill-opacity="0.55" {
                @for outline in &picture.pattern_px { polygon points=(points(outline)) {} }
            }
            g stroke="var(--paper)" stroke-width=(size / 900.0) {
                @for (i, [u, v]) in corners().filter(|(i, _)| !is(*i, &picture.hidden)) {
                    @let hue = if is(i, &picture.unseen) { "none" } else { "var(--series-1)" };
                    circle cx=(format!("{u:.1}")) cy=(format!("{v:.1}")) r=(format!("{:.1}", size / 160.0)) fill=(hue) {}
                }
            }
            (bodies(scene, picture, true))
            g stroke="var(--series-2)" stroke-width=(format!("{:.1}", size / 320.0)) {
                @for (_, corner) in corners().filter(|(i, _)| is(*i, &picture.hidden)) { path d=(cross(corner, size / 160.0)) {} }
            }
            rect x="-0.5" y="-0.5" width=(width) height=(height) fill="none" stroke="var(--line)" stroke-width=(size / 320.0) {}
        }
    }
}

/// The bodies before the board or behind it, with the names of their links.
fn bodies(scene: &Scene, picture: &Picture, before: bool) -> Markup {
    let of_link = |body: &Silhouette| scene.links.get(body.link);
    let drawn = picture.bodies.iter().filter(|body| body.before_board == before);
    html! {
        @for body in drawn {
            @let (hue, name) = of_link(body).map_or(("var(--body)", ""), |link| {
                (if link.obstacle { "var(--obstacle)" } else { "var(--body)" }, link.name.as_str())
            });
            polygon points=(points(&body.outline_px)) fill=(hue) stroke="var(--ink)" stroke-opacity="0.5" vector-effect="non-scaling-stroke" {
                title { (name) }
            }
        }
    }
}

fn points(polygon: &[[f64; 2]]) -> String {
    polygon.iter().map(|[u, v]| format!("{u:.1},{v:.1}")).collect::<Vec<_>>().join(" ")
}

/// Two strokes through a point, `arm` px long to either side in u and v.
fn cross([u, v]: [f64; 2], arm: f64) -> String {
    let stroke = |dv: f64| format!("M{:.1} {:.1}L{:.1} {:.1}", u - arm, v - dv, u + arm, v + dv);
    stroke(arm) + &stroke(-arm)
}
