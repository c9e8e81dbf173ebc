//! The tour in time: its drawing, in a wide and a narrow form, and what it shows in words.

use maud::{Markup, PreEscaped, html};

use super::labelled;
use crate::plan::document::{MarginCurve, Review, TimedMove, Timeline};
use crate::report::drawing::{Frame, Style, svg};
use crate::report::figure::{Content, Figure};
use crate::report::plots::tour_figure;
use crate::report::{PlanDocuments, on_the_way};

/// Widths of the drawings, px: where there is room, and on a phone.
const WIDE: f64 = 840.0;
const NARROW: f64 = 400.0;

/// What is above and below the strips of a drawing, and how high one is on average, px.
const AROUND: f64 = 80.0;
const STRIP: f64 = 76.0;

/// The place of the timeline; none of plans that do not say in which order their poses are taken.
pub(super) fn tour(documents: &PlanDocuments) -> Option<Markup> {
    let PlanDocuments { plan, review, .. } = documents;
    let (stated, timeline) = (plan.tour.as_ref()?, review.timeline.as_ref()?);
    let figure = tour_figure(documents)?;
    let Content::Strips { strips, .. } = &figure.content else { return None };
    let height = AROUND + STRIP * strips.len() as f64;
    let [wide, narrow] = [WIDE, NARROW].map(|width| Style::page(width, height));
    Some(html! {
        section id="tour" {
            h2 { (figure.title) }
            div class="timeline" style=(format!("{}; {}", axis("wide", &wide), axis("narrow", &narrow))) {
                (drawing(&figure, &wide, "wide"))
                (drawing(&figure, &narrow, "narrow"))
            }
            p class="note" {
                "Above, the numbers of the poses while their pictures are taken; outlined, moves that go round about; in the colour of warnings, \
                 moves that are not proven safe. " (figure.caption)
            }
            (closest(timeline))
            (marked(review, timeline))
            @for line in on_the_way(stated).lines() { p { (line) } }
        }
    })
}

/// Where the time axis of a drawing is, in parts of its width, for what the script lays over it.
fn axis(name: &str, style: &Style) -> String {
    let Frame { left, right } = Frame::new(style);
    let percent = |length: f64| 100.0 * length / style.width;
    format!("--{name}-left: {:.3}%; --{name}-span: {:.3}%", percent(left), percent(right - left))
}

fn drawing(figure: &Figure, style: &Style, form: &str) -> Markup {
    html! { div class=(form) { (PreEscaped(labelled(&svg(figure, style), figure, style))) } }
}

/// What the tour comes closest to, and when.
fn closest(timeline: &Timeline) -> Markup {
    let any = timeline.clearance.as_ref();
    // What is nearest of all is not said twice.
    let changing = timeline.changing_clearance.as_ref().filter(|curve| any.is_none_or(|any| any.least != curve.least));
    let named = [
        ("Nearest links", any),
        ("Nearest links of those whose distance changes", changing),
        ("Least tip-over margin", timeline.tip_over_margin.as_ref()),
    ];
    let found: Vec<(&str, &MarginCurve)> = named.into_iter().filter_map(|(name, curve)| Some((name, curve?))).collect();
    html! {
        @if !found.is_empty() {
            ul class="closest" {
                @for (name, curve) in found {
                    @let time = timeline.measured_s[curve.least];
                    li {
                        (name) ": " strong { (millimetres(curve.least_m())) }
                        @if let Some([a, b]) = curve.links(curve.least) { " between " (a) " and " (b) }
                        @if curve.is_steady() { " all along; " } @else { " at " (format!("{time:.1}")) " s; " }
                        (millimetres(curve.required_m)) " required at poses, "
                        (millimetres(curve.kept_m)) " on the way. "
                        button type="button" class="choose" data-time=(time) aria-label={ "Show " (name) } { "show" }
                    }
                }
            }
        }
    }
}

/// The moves that the drawing marks.
fn marked(review: &Review, timeline: &Timeline) -> Markup {
    let stop = |id: Option<usize>| {
        let pose = id.and_then(|id| review.poses.iter().find(|pose| pose.id == id));
        pose.map_or_else(|| "home".to_owned(), |pose| format!("pose {}", pose.label))
    };
    let is_marked = |found: &&TimedMove| found.safe == Some(false) || found.legs.len() > 1;
    html! {
        @if timeline.moves.iter().any(|found| is_marked(&found)) {
            ul class="closest" {
                @for found in timeline.moves.iter().filter(is_marked) {
                    li {
                        "From " (stop(found.from)) " to " (stop(found.to)) ", at " (format!("{:.1}", found.start_s)) " s for "
                        (format!("{:.1}", found.seconds)) " s: "
                        @if found.safe == Some(false) { strong { "not proven safe" } } @else { "round about" }
                        @match found.legs.len() { 0 | 1 => {}, 2 => { ", with one turn" }, legs => { ", with " (legs - 1) " turns" } }
                        ". "
                        button type="button" class="choose" data-time=(found.start_s) aria-label={ "Show the move from " (stop(found.from)) } { "show" }
                    }
                }
            }
        }
    }
}

/// To a tenth.
fn millimetres(length: f64) -> String {
    format!("{:.1} mm", 1e3 * length)
}
