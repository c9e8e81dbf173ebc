//! Tables that can be sorted and copied.

use maud::{Markup, html};

use crate::figures::short;

/// A cell: its text, and the number that it is sorted by where the text is none.
pub(super) enum Cell {
    /// Words, or a number as it stands.
    Text(String),
    /// A text, sorted by a number.
    Number(String, f64),
    /// Anything else.
    Markup(Markup),
}

impl Cell {
    /// A number in four digits; a dash where there is none.
    pub(super) fn short(number: Option<f64>) -> Self {
        number.map_or_else(|| Self::Text("–".into()), |number| Self::Number(short(number), number))
    }
}

/// A row, of a pose or of none.
pub(super) struct Row {
    pub(super) pose: Option<usize>,
    pub(super) cells: Vec<Cell>,
}

pub(super) fn table(name: &str, header: &[String], rows: &[Row]) -> Markup {
    html! {
        div class="scroll" role="region" tabindex="0" aria-label=(name) {
            table class="sortable" {
                caption { (name) }
                thead { tr { @for cell in header { th scope="col" { (cell) } } } }
                tbody { @for row in rows { tr data-pose=[row.pose] { @for cell in &row.cells { (cell_of(cell)) } } } }
            }
        }
    }
}

fn cell_of(cell: &Cell) -> Markup {
    match cell {
        Cell::Text(text) => html! { td { (text) } },
        Cell::Number(text, number) => html! { td data-value=(number) { (text) } },
        Cell::Markup(markup) => html! { td { (markup) } },
    }
}
