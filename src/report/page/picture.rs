//! The picture that a pose gives: the board in it, with its corners.

use maud::{Markup, html};

use crate::plan::document::{Picture, SceneCamera};

pub(super) fn picture(camera: &SceneCamera, picture: &Picture, name: &str) -> Markup {
    let (width, height) = (camera.width_px, camera.height_px);
    // Pixel (0, 0) is the centre of the first.
    let frame = format!("-0.5 -0.5 {width} {height}");
    let size = f64::from(width.max(height));
    let points =
        |square: &[[f64; 2]; 4]| square.iter().map(|[u, v]| format!("{u:.1},{v:.1}")).collect::<Vec<_>>().join(" ");
    let corners = picture.corners_px.iter().enumerate().filter_map(|(i, corner)| Some((i, (*corner)?)));
    html! {
        svg viewBox=(frame) role="img" aria-label=(name) {
            rect x="-0.5" y="-0.5" width=(width) height=(height) fill="none" stroke="var(--line)" stroke-width=(size / 320.0) {}
            g fill="var(--ink)" fill-opacity="0.55" {
                @for square in &picture.squares_px { polygon points=(points(square)) {} }
            }
            g stroke="var(--paper)" stroke-width=(size / 900.0) {
                @for (i, [u, v]) in corners {
                    @let hue = if picture.unseen.binary_search(&i).is_ok() { "none" } else { "var(--series-1)" };
                    circle cx=(format!("{u:.1}")) cy=(format!("{v:.1}")) r=(format!("{:.1}", size / 160.0)) fill=(hue) {}
                }
            }
        }
    }
}
