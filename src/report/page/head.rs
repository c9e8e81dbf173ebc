//! What stands first and last on a page: the verdict, what to do next, the figures that matter, and what it was made from.

use maud::{Markup, html};

use crate::plan::document::ProblemReference;

/// How good the news is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tone {
    Good,
    Bad,
    Open,
}

/// The head of a page.
pub(super) struct Head<'a> {
    /// What the page is of.
    pub(super) kind: &'a str,
    /// Version of calipose that made the document.
    pub(super) calipose: &'a str,
    pub(super) name: &'a str,
    pub(super) tone: Tone,
    pub(super) verdict: String,
    /// What more there is to say of it, if anything.
    pub(super) details: String,
    pub(super) next: Markup,
    pub(super) figures: Vec<Markup>,
}

/// A number with its name and what it is of.
pub(super) fn figure(name: &str, number: impl Into<String>, unit: &str) -> Markup {
    let number = number.into();
    html! { div { dt { (name) } dd { (number) " " small { (unit) } } } }
}

impl Tone {
    fn class(self) -> &'static str {
        match self {
            Self::Good => "verdict good",
            Self::Bad => "verdict bad",
            Self::Open => "verdict",
        }
    }
}

impl Head<'_> {
    pub(super) fn markup(&self) -> Markup {
        html! {
            header class="page-head" {
                p class="kicker" { "calipose " (self.calipose) " · " (self.kind) }
                h1 { (self.name) }
                p class=(self.tone.class()) {
                    strong { (self.verdict) }
                    @if !self.details.is_empty() { " " (self.details) }
                }
                p class="next" { (self.next) }
                dl class="figures" { @for figure in &self.figures { (figure) } }
            }
        }
    }

    pub(super) fn foot(&self, problem: Option<&ProblemReference>) -> Markup {
        html! {
            footer class="page-foot" {
                "Made by calipose " (self.calipose)
                @if let Some(problem) = problem {
                    ". Problem file " code { (problem.sha256) }
                    @for set in &problem.set { ", " code { (set) } }
                }
                "."
            }
        }
    }
}
