//! A plan's tour in time.

use std::iter::{once, zip};

use crate::feasibility::Collision;
use crate::motion::course::{Curve, Leg, Samples, Watch};
use crate::motion::timing::Profile;
use crate::motion::{Danger, JointLimits, MarginKind, Safety};
use crate::plan::document::{
    MarginCurve, MoveDocument, PictureTime, Plan, TimedLeg, TimedMove, Timeline, TourDocument,
};
use crate::problem::Problem;
use crate::robot::Tree;

/// Lengths measured are rounded to so many to the metre.
const TO_THE_METRE: f64 = 1e5;

/// A stop of a tour: home, or a pose of an id.
struct Stop<'p> {
    id: Option<usize>,
    q: &'p [f64],
}

/// The tour of a plan in time, with what is measured along it; none of plans that do not say in which order their poses are taken.
pub(super) fn timeline(plan: &Plan, problem: &Problem, collision: &Collision) -> Option<Timeline> {
    let tour = plan.tour.as_ref()?;
    let mut timeline = timed(tour, &stops(plan, tour), &problem.motion.limits());
    let safety = Safety::new(&problem.robot, collision, problem.stability.as_ref());
    measure(&mut timeline, &safety, problem, &tour.moves);
    Some(timeline)
}

/// Where a tour stops, in its order.
fn stops<'p>(plan: &'p Plan, tour: &'p TourDocument) -> Vec<Stop<'p>> {
    let home = tour.home_rad.as_ref().map(|q| Stop { id: None, q });
    let back = tour.home_rad.as_ref().filter(|_| tour.returns).map(|q| Stop { id: None, q });
    let poses = plan.in_order().into_iter().map(|pose| Stop { id: Some(pose.id), q: &pose.joints_rad });
    home.into_iter().chain(poses).chain(back).collect()
}

/// When the arm is where, from stop to stop by the tour's moves.
fn timed(tour: &TourDocument, stops: &[Stop], limits: &[JointLimits]) -> Timeline {
    let mut time = 0.0;
    let mut pictures = Vec::new();
    let mut take = |stop: &Stop, time: &mut f64| {
        if let Some(id) = stop.id {
            pictures.push(PictureTime { id, start_s: *time, seconds: tour.dwell_s });
            *time += tour.dwell_s;
        }
    };
    if let Some(first) = stops.first() {
        take(first, &mut time);
    }
    let mut moves = Vec::new();
    for (found, ends) in zip(&tour.moves, stops.windows(2)) {
        let start = time;
        let turns = found.via_rad.iter().map(Vec::as_slice);
        let corners: Vec<&[f64]> = once(ends[0].q).chain(turns).chain([ends[1].q]).collect();
        let legs = corners.windows(2).map(|pair| {
            let profile = Profile::between(pair[0], pair[1], limits);
            let leg = TimedLeg {
                start_s: time,
                seconds: profile.duration(),
                ramp_s: profile.ramp(),
                ease_s: profile.ease(),
                to: pair[1].to_vec(),
            };
            time += leg.seconds;
            leg
        });
        let legs = legs.collect();
        moves.push(TimedMove {
            from: ends[0].id,
            to: ends[1].id,
            start_s: start,
            seconds: time - start,
            safe: found.safe,
            legs,
        });
        take(&ends[1], &mut time);
    }
    Timeline {
        start: stops.first().map(|stop| stop.q.to_vec()).unwrap_or_default(),
        moves,
        pictures,
        end_s: time,
        measured_s: vec![],
        clearance: None,
        changing_clearance: None,
        tip_over_margin: None,
    }
}

/// Measures the margins along the moves.
fn measure(timeline: &mut Timeline, safety: &Safety, problem: &Problem, moves: &[MoveDocument]) {
    let legs: Vec<Leg> = timeline.legs();
    if legs.is_empty() {
        return;
    }
    let kinds = safety.kinds();
    // Whether it is of the balance, and of the changing margins alone.
    let watches = kinds.iter().flat_map(|kind| {
        let is_balance = kind.is_balance();
        let changing = (!is_balance).then(|| Watch::changing(kind, &legs)).flatten();
        once((kind, false, Watch::all(kind))).chain(changing.map(|watch| (kind, true, watch)))
    });
    let (named, watches): (Vec<(&MarginKind, bool)>, Vec<Watch>) =
        watches.map(|(kind, changing, watch)| ((kind, changing), watch)).unzip();
    let Samples { times, curves } = Samples::new(&watches, &legs);
    for ((kind, changing), curve) in zip(named, curves) {
        let curve = margin_curve(&curve, kind, problem, moves);
        *match (kind.is_balance(), changing) {
            (true, _) => &mut timeline.tip_over_margin,
            (false, true) => &mut timeline.changing_clearance,
            (false, false) => &mut timeline.clearance,
        } = Some(curve);
    }
    if timeline.curves().next().is_some() {
        timeline.measured_s = times;
    }
}

fn margin_curve(curve: &Curve, kind: &MarginKind, problem: &Problem, moves: &[MoveDocument]) -> MarginCurve {
    let distance = |margin: f64| (kind.distance(margin) * TO_THE_METRE).round() / TO_THE_METRE;
    let floor = if kind.is_balance() { f64::NEG_INFINITY } else { 0.0 };
    let (pairs, nearest) = named(curve, kind, &problem.robot.tree);
    let proven = |found: &MoveDocument| if kind.is_balance() { found.tip_over_margin_m } else { found.clearance_m };
    MarginCurve {
        required_m: match &problem.stability {
            Some(stability) if kind.is_balance() => stability.margin,
            _ => problem.clearance,
        },
        kept_m: kind.distance(0.0),
        proven_m: moves.iter().map(proven).try_fold(f64::INFINITY, |least, proven| Some(least.min(proven?))),
        measured_m: curve.least.iter().map(|&(_, margin)| distance(margin).max(floor)).collect(),
        least: curve.least(),
        pairs,
        nearest,
    }
}

/// The names of the links nearest to each other, and which are at each time; none for the balance.
fn named(curve: &Curve, kind: &MarginKind, tree: &Tree) -> (Vec<[String; 2]>, Vec<usize>) {
    let mut seen: Vec<usize> = Vec::new();
    let (mut pairs, mut nearest) = (Vec::new(), Vec::new());
    for &(margin, _) in &curve.least {
        let Danger::Contact(links) = kind.danger(margin) else { return (vec![], vec![]) };
        nearest.push(seen.iter().position(|&other| other == margin).unwrap_or_else(|| {
            seen.push(margin);
            pairs.push(links.map(|link| tree.links[link].name.clone()));
            seen.len() - 1
        }));
    }
    (pairs, nearest)
}
