//! Reports: pages that stand alone, with plots, tables and, where there is something in space, a view of it.
//!
//! Everything is on the page without its script; that adds the view in space, choosing poses, and sorting of tables.

mod calibration;
mod comparison;
mod design;
mod diff;
mod facts;
mod head;
mod picture;
mod plan;
mod space;
mod study;
mod table;
mod tour;
mod verification;

pub use calibration::calibration_page;
pub use comparison::comparison_page;
pub use design::design_page;
pub use diff::diff_page;
pub use plan::plan_page;
pub use study::study_page;
pub use verification::verification_page;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::drawing::{Style, svg};
use super::figure::Figure;

/// What every page bears in its head.
pub const PAGE_MARK: &str = "<meta name=\"generator\" content=\"calipose\">";

const STYLE: &str = include_str!("web/report.css");
const SCRIPT: &str = include_str!("web/dist/report.js");

/// A whole page. Its `body` ends with the script, or has it where the script is needed earlier.
fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                (PreEscaped(PAGE_MARK))
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}

/// What links and sorts, and draws what is in space.
fn script() -> Markup {
    html! { script { (PreEscaped(SCRIPT)) } }
}

/// Plots beside each other.
fn plots(figures: &[Figure]) -> Markup {
    html! { div class="plots" { @for figure in figures { (plot(figure)) } } }
}

/// A plot with its title and caption.
fn plot(figure: &Figure) -> Markup {
    let style = Style::page(560.0, 340.0);
    let drawn = svg(figure, &style);
    html! {
        figure class="plot" id=(&*figure.name) {
            h3 { (figure.title) }
            (PreEscaped(labelled(&drawn, figure, &style)))
            figcaption { (figure.caption) }
        }
    }
}

/// The drawing as an image with a name, as wide as its place.
fn labelled(drawn: &str, figure: &Figure, style: &Style) -> String {
    let name = html! { (figure.title) }.into_string();
    let Style { width, height, .. } = style;
    drawn.replacen(
        &format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\""),
        &format!("<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{name}\""),
        1,
    )
}
