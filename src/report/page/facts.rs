//! Numbers with their units, in sensible digits.

use maud::{Markup, html};

/// Names and what they are.
pub(super) fn facts(facts: &[(&str, String)]) -> Markup {
    html! { dl class="facts" { @for (name, value) in facts { dt { (name) } dd { (value) } } } }
}

pub(super) fn degrees(angle: f64) -> String {
    format!("{angle:.1}°")
}

pub(super) fn millimetres(length: f64) -> String {
    format!("{:.0} mm", 1e3 * length)
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// In the unit of a joint.
pub(super) fn joint(value: f64, unit: &str) -> String {
    if unit == "deg" { degrees(value) } else { format!("{value:.1} {unit}") }
}
