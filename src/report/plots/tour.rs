//! The tour in time: how near the arm comes to anything, and where its joints are.

use crate::figures::trimmed;
use crate::plan::document::{MarginCurve, Review, SceneJoint, TimedMove, Timeline};
use crate::report::figure::{Band, BandKind, Content, Figure, Hue, Line, Mark, Series, Strip};

/// Points of a joint's curve while it speeds up.
const RAMP: usize = 8;

/// Heights of strips against each other.
const OF_MARGIN: f64 = 1.5;
const OF_JOINT: f64 = 1.0;

/// Room above and below a joint's curve, as a share of how far it goes.
const ROOM: f64 = 0.12;

/// A limit is drawn that is no farther from a joint's curve than this share of how far that goes.
const LIMIT_NEAR: f64 = 0.25;

/// Clearances, tip-over margin and joints over time; none of plans that do not say in which order their poses are taken.
pub(super) fn tour(review: &Review) -> Option<Figure> {
    let timeline = review.timeline.as_ref()?;
    let mut strips: Vec<Strip> = clearance(timeline).into_iter().collect();
    strips.extend(timeline.tip_over_margin.as_ref().map(|curve| tip_over_margin(timeline, curve)));
    let caption = if strips.is_empty() {
        String::from(
            "Joint values along the tour; nothing is tested, so nothing is known of how near the arm comes to anything.",
        )
    } else {
        format!(
            "Margins as measured at {} times along the tour, and the joints. Nothing is measured in between; what is proven of the moves \
             holds there too.",
            timeline.measured_s.len()
        )
    };
    strips.extend(review.scene.joints.iter().enumerate().map(|(j, joint)| joint_strip(timeline, j, joint)));
    Some(Figure {
        name: "tour".into(),
        title: "The tour in time".into(),
        caption,
        x: "time [s]".into(),
        y: String::new(),
        content: Content::Strips { strips, bands: bands(review, timeline), end: timeline.end_s },
    })
}

/// Distances of links: of any, and of those alone whose distance changes.
fn clearance(timeline: &Timeline) -> Option<Strip> {
    let any = timeline.clearance.as_ref()?;
    let mut series = Vec::new();
    let shown = if let Some(changing) = &timeline.changing_clearance {
        series.push(curve("any links", Hue::Views, timeline, any));
        series.push(curve("links whose distance changes", Hue::Plan, timeline, changing));
        changing
    } else {
        series.push(curve("", Hue::Plan, timeline, any));
        any
    };
    Some(margin_strip("Clearance [mm]", timeline, any.required_m, series, shown))
}

fn tip_over_margin(timeline: &Timeline, shown: &MarginCurve) -> Strip {
    let series = vec![curve("", Hue::Plan, timeline, shown)];
    margin_strip("Tip-over margin [mm]", timeline, shown.required_m, series, shown)
}

/// A strip of margins, with what poses keep of them and where `shown` is least.
fn margin_strip(
    name: &str,
    timeline: &Timeline,
    required_m: f64,
    mut series: Vec<Series>,
    shown: &MarginCurve,
) -> Strip {
    let required = 1e3 * required_m;
    let values = series.iter().flat_map(|series| &series.points).map(|point| point.1);
    let (least, most) = ends(values.chain([0.0, required]));
    let range = (least, least + 1.08 * (most - least).max(1.0));
    series.push(level("required", timeline, required));
    series.push(Series {
        name: format!("{} mm", trimmed(1e3 * shown.least_m(), 1)),
        hue: Hue::Other,
        mark: Mark::Discs,
        points: vec![(timeline.measured_s[shown.least], 1e3 * shown.least_m())],
        titles: vec![least_in_words(timeline, shown)],
    });
    Strip { name: name.into(), range, height: OF_MARGIN, series }
}

/// "least 34.1 mm at 12.3 s, between wrist and board"
fn least_in_words(timeline: &Timeline, curve: &MarginCurve) -> String {
    let between = curve.links(curve.least).map(|[a, b]| format!(", between {a} and {b}")).unwrap_or_default();
    format!("least {} mm at {:.1} s{between}", trimmed(1e3 * curve.least_m(), 1), timeline.measured_s[curve.least])
}

/// What was measured; the arm rests before the first sample and after the last.
fn curve(name: &str, hue: Hue, timeline: &Timeline, curve: &MarginCurve) -> Series {
    let measured = || timeline.measured_s.iter().copied().zip(curve.measured_m.iter().map(|margin| 1e3 * margin));
    let before = measured().next().map(|(_, first)| (0.0, first));
    let after = measured().next_back().map(|(_, last)| (timeline.end_s, last));
    let points = before.into_iter().chain(measured()).chain(after).collect();
    Series { name: name.into(), hue, mark: Mark::Line(Line::Solid), points, titles: vec![] }
}

fn level(name: &str, timeline: &Timeline, value: f64) -> Series {
    Series {
        name: name.into(),
        hue: Hue::Bound,
        mark: Mark::Line(Line::Dashed),
        points: vec![(0.0, value), (timeline.end_s, value)],
        titles: vec![],
    }
}

/// A joint's values, with its limits where they are near.
fn joint_strip(timeline: &Timeline, j: usize, joint: &SceneJoint) -> Strip {
    let SceneJoint { name, unit, min, max, .. } = joint;
    let shown = |q: &[f64]| if unit == "deg" { q[j].to_degrees() } else { 1e3 * q[j] };
    let mut points = vec![(0.0, shown(&timeline.start))];
    for leg in timeline.legs() {
        let (ramp, end) = (leg.profile.ramp(), leg.end());
        let part = |step: usize| ramp * (step as f64 / RAMP as f64);
        let up = (0..=RAMP).map(|step| leg.start + part(step));
        let down = (0..=RAMP).rev().map(|step| end - part(step));
        points.extend(up.chain(down).map(|time| (time, shown(&leg.at(time)))));
    }
    points.extend(points.last().map(|&(_, last)| (timeline.end_s, last)));
    let (least, most) = ends(points.iter().map(|point| point.1));
    // A joint that hardly moves is not drawn as if it did.
    let gone = (most - least).max(0.01 * (max - min)).max(1e-6);
    let mut range = (least - ROOM * gone, most + ROOM * gone);
    let mut series =
        vec![Series { name: String::new(), hue: Hue::Plan, mark: Mark::Line(Line::Solid), points, titles: vec![] }];
    if least - min < LIMIT_NEAR * gone {
        range.0 = range.0.min(min - 0.5 * ROOM * gone);
        series.push(level("limit", timeline, *min));
    }
    if max - most < LIMIT_NEAR * gone {
        range.1 = range.1.max(max + 0.5 * ROOM * gone);
        let name = if series.len() == 1 { "limit" } else { "" };
        series.push(level(name, timeline, *max));
    }
    let sign = if unit == "deg" { "°" } else { unit };
    Strip { name: format!("{name} [{sign}]"), range, height: OF_JOINT, series }
}

/// The least and the greatest.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)))
}

/// The pictures, and the moves that are not straight and proven safe.
fn bands(review: &Review, timeline: &Timeline) -> Vec<Band> {
    let label = |id: usize| {
        review.poses.iter().find(|pose| pose.id == id).map_or_else(|| id.to_string(), |pose| pose.label.clone())
    };
    let stop = |id: Option<usize>| id.map_or_else(|| "home".into(), |id| format!("pose {}", label(id)));
    let moves = timeline.moves.iter().enumerate().filter_map(|(place, found)| {
        let (kind, how) = how(found)?;
        let title = format!("move {}, from {} to {}: {how}", place + 1, stop(found.from), stop(found.to));
        Some(Band { time: (found.start_s, found.start_s + found.seconds), kind, label: String::new(), title })
    });
    let pictures = timeline.pictures.iter().map(|picture| Band {
        time: (picture.start_s, picture.start_s + picture.seconds),
        kind: BandKind::Pictures,
        label: label(picture.id),
        title: format!("pose {}: pictures at {:.1} s", picture.id, picture.start_s),
    });
    moves.chain(pictures).collect()
}

/// What is worth knowing of a move.
fn how(found: &TimedMove) -> Option<(BandKind, String)> {
    match (found.safe, found.legs.len()) {
        (Some(false), _) => Some((BandKind::NotSafe, "not proven safe".into())),
        (_, 0 | 1) => None,
        (_, 2) => Some((BandKind::RoundAbout, "goes round about, with one turn".into())),
        (_, legs) => Some((BandKind::RoundAbout, format!("goes round about, with {} turns", legs - 1))),
    }
}
