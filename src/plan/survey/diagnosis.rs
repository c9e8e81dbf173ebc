//! Why a problem has no views, or few: the test that rejects most configurations, the nearest miss, what to change, and numbers
//! that look wrong.

use std::fmt;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::smell::{Smell, smells};
use crate::feasibility::{Measures, Occlusion, Rejection, Sighting, VisibilityTest};
use crate::figures::grouped;
use crate::problem::Problem;
use crate::spatial::Pose;
use crate::sweep::AxisRule;
use crate::target::Zone;

/// Configurations looked at.
const TRIED: usize = 20_000;

/// Of those that see the board, at most so many are held against the robot's bodies.
const HELD_AGAINST_BODIES: usize = 200;

/// What was found out about a problem with no views or few.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// Configurations looked at, evenly among those to be swept.
    pub tried: usize,
    /// How many of them are views.
    pub views: usize,
    /// What stands in the way most; none where nothing does.
    pub obstacle: Option<Obstacle>,
    /// Mistakes that would explain it.
    pub smells: Vec<Smell>,
}

/// A test that configurations fail, and the nearest of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Whether none of the configurations looked at passes it.
    pub stops_all: bool,
    /// The nearest miss; among the configurations that pass every other test, if there are any.
    pub nearest: Miss,
}

/// A failed test with what was measured. SI units.
#[derive(Debug, Clone, PartialEq)]
pub enum Miss {
    /// The optical axis passes the zone at this distance; infinite where it runs away from the board's plane.
    Axis(f64),
    /// The camera is on the unprinted side; angle between the board's normal and the direction to it.
    BackSide(f64),
    /// Too far: distance, and the greatest allowed.
    TooFar(f64, f64),
    /// Too near: distance, and the least allowed.
    TooNear(f64, f64),
    /// Seen too flatly: angle of incidence, and the greatest allowed.
    Incidence(f64, f64),
    /// Tilted too far: angle, and the greatest allowed.
    Tilt(f64, f64),
    /// The lens does not reach the corners; angle between the optical axis and the direction to the board's centre.
    BeyondLens(f64),
    /// A corner is so many px beyond the allowed part of the image.
    OutsideImage(f64),
    /// Neighbouring corners are so many px apart; the least allowed.
    Spacing(f64, f64),
    /// Markers too small to be read: their least side, and the least allowed.
    Marker(f64, f64),
    /// The tip-over margin, where it can be computed, and the least allowed.
    Unstable(Option<f64>, f64),
    /// Two links, or a link and an obstacle, are within the clearance: the reason of the rejection, their names, their distance and
    /// the clearance.
    Collision(Rejection, [String; 2], f64, f64),
    /// Share of the corners that the robot hides.
    Occluded(f64),
}

/// Looks at configurations of `problem` all over its joint space.
pub fn diagnose(problem: &Problem) -> Diagnosis {
    let Problem { robot, camera, target, space, visibility, .. } = problem;
    let sighting = Sighting::new(camera, &target.board, visibility);
    let ids: Vec<usize> = space.evenly(TRIED).collect();
    let looks: Vec<Look> = ids
        .par_iter()
        .map(|&id| {
            let q = space.configuration(id);
            let X_CT = robot.camera_pose(&q).inverse() * target.X_BT;
            let measures = sighting.measures(&X_CT);
            let mut misses = [0.0; TESTS];
            misses[0] = if problem.axis == AxisRule::Zone { beside(&target.zone, &X_CT) } else { 0.0 };
            misses[1..].copy_from_slice(&sighting.shortfalls(&measures));
            Look { id, measures, misses }
        })
        .collect();
    let seeing: Vec<&Look> = looks.iter().filter(|look| look.failed().next().is_none()).collect();
    let (views, bodies) = against_bodies(problem, &seeing);
    let obstacle = if seeing.is_empty() || bodies.is_none() { sight_obstacle(problem, &looks) } else { bodies };
    // Where poses are lost to the robot's own body, the numbers of the camera and the board are sound.
    let smells = if seeing.is_empty() { smells(problem) } else { Vec::new() };
    Diagnosis { tried: looks.len(), views, obstacle, smells }
}

/// The axis test, and those of visibility.
const TESTS: usize = 1 + VisibilityTest::ALL.len();

/// Their numbers from the one that says most to the one that says least, where several stop all: a board out of reach is out of the
/// image too.
const TELLING: [usize; TESTS] = [2, 1, 3, 4, 0, 5, 6];

/// One configuration.
struct Look {
    id: usize,
    measures: Measures,
    /// By how much each test is missed; not positive where it is passed.
    misses: [f64; TESTS],
}

impl Look {
    fn failed(&self) -> impl Iterator<Item = usize> {
        (0..TESTS).filter(|&test| self.misses[test] > 0.0 || self.misses[test].is_nan())
    }
}

/// The distance in m at which the optical axis passes the zone; 0 where it meets it.
fn beside(zone: &Zone, X_CT: &Pose) -> f64 {
    let X_TC = X_CT.inverse();
    let axis = X_TC.rotation * Vector3::z();
    let t = -X_TC.translation.z / axis.z;
    if !(t.is_finite() && t > 0.0) {
        return f64::INFINITY;
    }
    let point = X_TC.translation.vector + axis * t;
    (point.x.abs() - zone.width / 2.0).max(point.y.abs() - zone.height / 2.0).max(0.0)
}

/// The test that stands in the way of the board being seen: the one that most configurations fail and nothing else; where none
/// fails just one, the one that fewest pass.
fn sight_obstacle(problem: &Problem, looks: &[Look]) -> Option<Obstacle> {
    let (mut alone, mut passed) = ([0usize; TESTS], [0usize; TESTS]);
    for look in looks {
        let mut failed = [false; TESTS];
        for test in look.failed() {
            failed[test] = true;
        }
        let count = failed.iter().filter(|&&failed| failed).count();
        for test in 0..TESTS {
            alone[test] += usize::from(failed[test] && count == 1);
            passed[test] += usize::from(!failed[test]);
        }
    }
    let only = TELLING.into_iter().rev().max_by_key(|&test| alone[test]).filter(|&test| alone[test] > 0);
    let test = only.or_else(|| TELLING.into_iter().min_by_key(|&test| passed[test]))?;
    let is_near =
        |look: &&Look| look.failed().any(|failed| failed == test) && (only.is_none() || look.failed().nth(1).is_none());
    let nearest = looks.iter().filter(is_near).min_by(|a, b| a.misses[test].total_cmp(&b.misses[test]))?;
    Some(Obstacle { stops_all: passed[test] == 0, nearest: miss(problem, test, nearest) })
}

/// What `look` measures in a test that it fails.
fn miss(problem: &Problem, test: usize, look: &Look) -> Miss {
    let limits = &problem.visibility;
    let Measures { distance, incidence, tilt, off_axis, overhang, spacing, marker } = look.measures;
    let Some(test) = test.checked_sub(1) else { return Miss::Axis(look.misses[0]) };
    match VisibilityTest::ALL[test] {
        VisibilityTest::Side => Miss::BackSide(incidence),
        VisibilityTest::Distance if distance > limits.max_distance => Miss::TooFar(distance, limits.max_distance),
        VisibilityTest::Distance => Miss::TooNear(distance, limits.min_distance),
        VisibilityTest::Incidence => Miss::Incidence(incidence, limits.max_incidence),
        VisibilityTest::Tilt => Miss::Tilt(tilt, limits.max_tilt),
        VisibilityTest::Image if overhang.is_finite() => Miss::OutsideImage(overhang),
        VisibilityTest::Image => Miss::BeyondLens(off_axis),
        VisibilityTest::Spacing if spacing >= limits.min_corner_spacing => Miss::Marker(marker, limits.min_marker),
        VisibilityTest::Spacing => Miss::Spacing(spacing, limits.min_corner_spacing),
    }
}

/// How many of the configurations that see the board are views, and what of the robot itself stands in the way of most others.
fn against_bodies(problem: &Problem, seeing: &[&Look]) -> (usize, Option<Obstacle>) {
    let checks = problem.checks();
    if seeing.is_empty() || !(checks.has_bodies() || problem.stability.is_some()) {
        return (seeing.len(), None);
    }
    let held = &seeing[..seeing.len().min(HELD_AGAINST_BODIES)];
    let configuration = |look: &Look| problem.space.configuration(look.id);
    let verdicts: Vec<_> = held.par_iter().map(|look| checks.view(look.id, &configuration(look)).err()).collect();
    let count = |reason: Rejection| verdicts.iter().filter(|&&verdict| verdict == Some(reason)).count();
    let reasons = [Rejection::Unstable, Rejection::SelfCollision, Rejection::SceneCollision, Rejection::Occluded];
    let taken = verdicts.iter().filter(|verdict| verdict.is_none()).count();
    let views = taken * seeing.len() / held.len();
    let most = reasons.into_iter().max_by_key(|&reason| count(reason)).filter(|&reason| count(reason) > 0);
    let Some(reason) = most else { return (views, None) };
    let failing = held.iter().zip(&verdicts).filter(|(_, verdict)| **verdict == Some(reason)).map(|(look, _)| look);
    let failing: Vec<Vec<f64>> = failing.map(|look| configuration(look)).collect();
    let nearest = match reason {
        Rejection::Unstable => steadiest(problem, &failing),
        Rejection::Occluded => Miss::Occluded(least_hidden(problem, &failing)),
        reason => closest_links(problem, reason, &failing),
    };
    (views, Some(Obstacle { stops_all: taken == 0 && failing.len() == held.len(), nearest }))
}

fn steadiest(problem: &Problem, configurations: &[Vec<f64>]) -> Miss {
    let Some(stability) = &problem.stability else { return Miss::Unstable(None, 0.0) };
    let tree = &problem.robot.tree;
    let margins = configurations.iter().filter_map(|q| stability.margin_at(tree, &tree.link_poses(q)));
    Miss::Unstable(margins.reduce(f64::max), stability.margin)
}

/// The pair of links that is within the clearance most often, at its widest.
fn closest_links(problem: &Problem, reason: Rejection, configurations: &[Vec<f64>]) -> Miss {
    let (tree, clearance) = (&problem.robot.tree, problem.clearance);
    let checks = problem.checks();
    let gaps: Vec<_> = configurations.iter().map(|q| checks.collision().gaps(&tree.link_poses(q))).collect();
    let within = |&&(pair, _): &&([usize; 2], f64)| {
        gaps.iter().flatten().filter(|&&(other, gap)| other == pair && gap <= clearance).count()
    };
    let worst = gaps.first().and_then(|first| first.iter().max_by_key(within)).map(|&(pair, _)| pair);
    let Some(pair) = worst else { return Miss::Collision(reason, <[String; 2]>::default(), 0.0, clearance) };
    let widest = gaps.iter().flatten().filter(|(other, gap)| *other == pair && *gap <= clearance);
    let gap = widest.map(|(_, gap)| *gap).fold(f64::NEG_INFINITY, f64::max);
    Miss::Collision(reason, pair.map(|link| tree.links[link].name.clone()), gap.max(0.0), clearance)
}

/// The least share of the corners that is hidden.
fn least_hidden(problem: &Problem, configurations: &[Vec<f64>]) -> f64 {
    let Problem { robot, target, .. } = problem;
    let occlusion = Occlusion::new(&robot.tree, robot.camera_link);
    // Every corner of a large board would take long; a few tell as much.
    let stride = target.board.corner_count().div_ceil(100);
    let corners: Vec<_> = target.board.corners().step_by(stride).collect();
    let hidden = |q: &Vec<f64>| {
        let hidden = occlusion.hidden(&robot.link_poses(q), &robot.camera_pose(q), &target.X_BT, &corners);
        hidden.iter().filter(|&&hidden| hidden).count() as f64 / corners.len() as f64
    };
    configurations.iter().map(hidden).fold(1.0, f64::min)
}

impl Miss {
    /// Name of the reason, as in plans; `axis` where the optical axis misses the zone.
    pub fn name(&self) -> &'static str {
        match self {
            Miss::Axis(_) => "axis",
            Miss::BackSide(_) => Rejection::BackSide.name(),
            Miss::TooFar(..) | Miss::TooNear(..) => Rejection::Distance.name(),
            Miss::Incidence(..) => Rejection::Incidence.name(),
            Miss::Tilt(..) => Rejection::Tilt.name(),
            Miss::BeyondLens(_) => Rejection::BeyondLens.name(),
            Miss::OutsideImage(_) => Rejection::OutsideImage.name(),
            Miss::Spacing(..) | Miss::Marker(..) => Rejection::CornerSpacing.name(),
            Miss::Unstable(..) => Rejection::Unstable.name(),
            Miss::Collision(reason, ..) => reason.name(),
            Miss::Occluded(_) => Rejection::Occluded.name(),
        }
    }

    /// Whether the robot or an obstacle is the cause, for which only configurations that see the board are tested.
    fn is_of_robot(&self) -> bool {
        matches!(self, Miss::Unstable(..) | Miss::Collision(..) | Miss::Occluded(_))
    }

    /// What to change.
    pub fn advice(&self) -> &'static str {
        match self {
            Miss::Axis(_) => {
                "correct `target.pose` or `camera.mount`, widen `target.zone`, sweep with a finer step, or drop the axis test \
                 with `sweep.axis = \"any\"`"
            }
            Miss::BackSide(_) => {
                "the printed side is where the z axis of the board's frame points: correct `target.pose`, or the joint limits \
                 that keep the camera behind the board"
            }
            Miss::TooFar(..) => "raise `visibility.max_distance_mm`, or bring the board nearer with `target.pose`",
            Miss::TooNear(..) => "lower `visibility.min_distance_mm`, or move the board away with `target.pose`",
            Miss::Incidence(..) => {
                "raise `visibility.max_incidence_deg`, or turn the board towards the camera with `target.pose`"
            }
            Miss::Tilt(..) => {
                "raise `visibility.max_tilt_deg`, or turn the board towards the camera with `target.pose`"
            }
            Miss::BeyondLens(_) => {
                "the camera looks past the board: correct `camera.mount` or `target.pose`, or widen the joint limits"
            }
            Miss::OutsideImage(_) => {
                "use a smaller board, let it be farther away (`visibility.max_distance_mm`), or state with \
                 `visibility.min_corners` that it can be read in part"
            }
            Miss::Marker(..) => {
                "lower `visibility.min_marker_px`, use larger markers or a dictionary of fewer bits, or bring the board nearer with \
                 `target.pose`"
            }
            Miss::Spacing(..) => {
                "lower `visibility.min_corner_spacing_px`, use larger squares, or bring the board nearer with `target.pose`"
            }
            Miss::Unstable(..) => "lower `stability.margin_mm`, or correct the masses and `stability.support_mm`",
            Miss::Collision(..) => {
                "make the bodies of these links smaller, lower `collision.clearance_mm`, or exclude the pair with \
                 `collision.ignore`"
            }
            Miss::Occluded(_) => {
                "correct the bodies between the camera and the board, move the board with `target.pose`, or state with \
                 `visibility.min_corners` that it can be read in part"
            }
        }
    }
}

/// Angles in degrees, lengths in mm.
impl fmt::Display for Miss {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mm = |length: &f64| format!("{} mm", rounded(length * 1e3));
        let deg = |angle: &f64| format!("{}°", rounded(angle.to_degrees()));
        match self {
            Miss::Axis(beside) if beside.is_finite() => {
                write!(
                    f,
                    "the optical axis that comes nearest passes the target's zone at a distance of {}",
                    mm(beside)
                )
            }
            Miss::Axis(_) => f.write_str("the optical axis never meets the board's plane in front of the camera"),
            Miss::BackSide(angle) => {
                write!(
                    f,
                    "the camera that comes nearest to the printed side is {} off the board's normal",
                    deg(angle)
                )?;
                f.write_str("; at 90° or more it is behind the board")
            }
            Miss::TooFar(distance, most) => {
                write!(
                    f,
                    "the closest camera is {} from the board; max_distance_mm is {}",
                    mm(distance),
                    rounded(most * 1e3)
                )
            }
            Miss::TooNear(distance, least) => {
                write!(
                    f,
                    "the farthest camera is {} from the board; min_distance_mm is {}",
                    mm(distance),
                    rounded(least * 1e3)
                )
            }
            Miss::Incidence(angle, most) => {
                let most = rounded(most.to_degrees());
                write!(
                    f,
                    "the camera nearest to the board's normal is {} off it; max_incidence_deg is {most}",
                    deg(angle)
                )
            }
            Miss::Tilt(angle, most) => {
                let most = rounded(most.to_degrees());
                write!(
                    f,
                    "the smallest angle between the optical axis and the board's normal is {}; max_tilt_deg is {most}",
                    deg(angle)
                )
            }
            Miss::BeyondLens(angle) => {
                write!(
                    f,
                    "the camera that points best at the board has the board's centre {} off its optical axis",
                    deg(angle)
                )
            }
            Miss::OutsideImage(beyond) => {
                write!(
                    f,
                    "in the configuration that comes nearest, a corner is {} px outside the image or its margin",
                    rounded(*beyond)
                )
            }
            Miss::Marker(side, least) => {
                let (side, least) = (rounded(*side), rounded(*least));
                write!(f, "the sides of markers are at most {side} px long; min_marker_px is {least}")
            }
            Miss::Spacing(spacing, least) => {
                let (spacing, least) = (rounded(*spacing), rounded(*least));
                write!(f, "the squares are at most {spacing} px high in the image; min_corner_spacing_px is {least}")
            }
            Miss::Unstable(Some(margin), least) => {
                write!(f, "the greatest tip-over margin is {}; margin_mm is {}", mm(margin), rounded(least * 1e3))
            }
            Miss::Unstable(None, _) => f.write_str("the robot's centre of mass is not known"),
            Miss::Collision(_, [a, b], gap, clearance) => {
                let clearance = rounded(clearance * 1e3);
                if *gap > 0.0 {
                    write!(f, "links {a} and {b} are at most {} apart; clearance_mm is {clearance}", mm(gap))
                } else {
                    write!(f, "links {a} and {b} touch; clearance_mm is {clearance}")
                }
            }
            Miss::Occluded(share) => {
                write!(f, "the robot hides at least {} % of the corners", rounded(share * 100.0))
            }
        }
    }
}

/// A number for a sentence: to three digits, without an exponent.
fn rounded(number: f64) -> String {
    let decimals = if number == 0.0 { 0 } else { (2 - number.abs().log10().floor() as i32).clamp(0, 6) as usize };
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if let Some(Obstacle { stops_all, nearest }) = &self.obstacle {
            let tried = if nearest.is_of_robot() {
                "tested configurations that see the board".to_owned()
            } else {
                format!("{} configurations tried", grouped(self.tried))
            };
            let reason = nearest.name().replace('_', " ");
            if *stops_all {
                writeln!(f, "All of the {tried} are rejected for the reason \"{reason}\".")?;
            } else {
                writeln!(f, "Main reason for rejection among the {tried}: \"{reason}\".")?;
            }
            write!(f, "Nearest miss: {nearest}.\nWhat to change: {}.", nearest.advice())?;
        }
        for smell in &self.smells {
            write!(f, "\nSuspicious: {smell}.")?;
        }
        Ok(())
    }
}
