//! The view in space: its place, what is in it, and the script that draws it.

use maud::{Markup, PreEscaped, html};

use super::script;
use crate::plan::document::{Review, Space};

/// The script stands right after the place: the view is drawn before what follows on the page is read.
pub(super) fn space(review: &Review) -> Markup {
    html! {
        section id="view3d" hidden { h2 { "The poses in space" } }
        script type="application/json" id="scene-data" { (PreEscaped(Space::new(review).to_line().replace("</", "<\\/"))) }
        (script())
    }
}
