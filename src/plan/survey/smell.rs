//! Mistakes in a problem's numbers that would explain why the camera never sees the board.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::fmt;

use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rayon::prelude::*;

use crate::feasibility::Sighting;
use crate::problem::Problem;
use crate::robot::{JointKind, Robot};
use crate::spatial::Pose;
use crate::target::{Board, Checkerboard};

/// Configurations tried with a mistake undone.
const TRIED: usize = 4000;

/// With the mistake undone at least so many of them must see the board; fewer may be chance.
const TELLING: usize = 8;

/// A mistake that the numbers smell of.
#[derive(Debug, Clone, PartialEq)]
pub enum Smell {
    /// A length in mm looks like one in metres: what, and its value in mm.
    Metres(&'static str, f64),
    /// The robot's lengths look like millimetres where its description takes metres: their sum in m.
    Millimetres(f64),
    /// An angle in degrees looks like one in radians: what, and its value in degrees.
    Radians(&'static str, f64),
    /// A focal length in px looks like one in mm.
    FocalLength(f64),
    /// With the board turned over the camera would see it, in this share of the configurations.
    FacingAway(f64),
    /// With a camera that looks along another axis it would.
    LooksAlong(&'static str, f64),
    /// With rows and columns exchanged it would.
    Swapped(f64),
}

/// Lengths below this, in m, that are not zero, are hardly meant in mm.
const TINY: f64 = 0.01;

/// What the numbers of `problem` smell of. Sizes and angles that cannot be meant come first; only without them are the board
/// and the camera turned to see what would help.
pub(crate) fn smells(problem: &Problem) -> Vec<Smell> {
    let found: Vec<Smell> = lengths(problem).into_iter().chain(angles(problem)).collect();
    if found.is_empty() { turned(problem).into_iter().collect() } else { found }
}

fn lengths(problem: &Problem) -> Vec<Smell> {
    let Problem { robot, target, visibility, camera, .. } = problem;
    let reach = reach(robot);
    let board = target.X_BT.translation.vector.amax();
    let tiny = |length: f64, below: f64| length > 0.0 && length < below;
    let mut smells = Vec::new();
    if tiny(reach, 2.0 * TINY) {
        smells.push(Smell::Metres("the sum of the robot's lengths", reach * 1e3));
    } else if reach > 50.0 {
        smells.push(Smell::Millimetres(reach));
    }
    if tiny(board, TINY) && reach > 10.0 * TINY {
        smells.push(Smell::Metres("`target.pose.position_mm`", board * 1e3));
    }
    let spacing = target.board.grid().map_or_else(|| target.board.spacing(), |(_, _, square)| square);
    if tiny(spacing, TINY / 10.0) {
        let what =
            if target.board.grid().is_some() { "`target.square_mm`" } else { "the spacing of the board's corners" };
        smells.push(Smell::Metres(what, spacing * 1e3));
    }
    if tiny(visibility.max_distance, 2.0 * TINY) {
        smells.push(Smell::Metres("`visibility.max_distance_mm`", visibility.max_distance * 1e3));
    }
    let focal_length = camera.intrinsics()[0];
    if focal_length < 0.05 * f64::from(camera.width()) {
        smells.push(Smell::FocalLength(focal_length));
    }
    smells
}

/// The lengths of all links, in m.
fn reach(robot: &Robot) -> f64 {
    let chain = &robot.chain;
    let links = chain.stages.iter().map(|stage| stage.X_PJ).chain([chain.X_nF]);
    let travel = chain.joints.iter().filter(|joint| joint.kind == JointKind::Prismatic);
    let travel = travel.map(|joint| joint.limits.max.abs().max(joint.limits.min.abs()));
    links.map(|X| X.translation.vector.norm()).sum::<f64>() + travel.sum::<f64>()
}

fn angles(problem: &Problem) -> Vec<Smell> {
    let Problem { robot, target, visibility, .. } = problem;
    let mut smells = Vec::new();
    let turning = robot.chain.joints.iter().filter(|joint| joint.kind == JointKind::Revolute);
    let widest =
        turning.map(|joint| joint.limits.max.abs().max(joint.limits.min.abs())).fold(0.0, f64::max).to_degrees();
    if widest > 0.5 && widest <= 2.0 * PI + 1e-9 {
        smells.push(Smell::Radians("the widest range of the joints", widest));
    }
    for (what, limit) in [
        ("`visibility.max_incidence_deg`", visibility.max_incidence),
        ("`visibility.max_tilt_deg`", visibility.max_tilt),
    ] {
        if limit.to_degrees() <= FRAC_PI_2 + 1e-9 {
            smells.push(Smell::Radians(what, limit.to_degrees()));
        }
    }
    let mut links = robot.chain.stages.iter().map(|stage| &stage.X_PJ);
    for (what, angle) in [
        ("the orientation of the board in `target.pose`", in_radians(&target.X_BT)),
        ("the orientation of the camera in `camera.mount`", in_radians(&robot.X_FC)),
        ("an angle of the robot's links", links.find_map(in_radians)),
    ] {
        smells.extend(angle.map(|angle| Smell::Radians(what, angle)));
    }
    smells
}

/// The largest of roll, pitch and yaw in degrees, where all are multiples of π/4 to the digits that people write.
fn in_radians(X: &Pose) -> Option<f64> {
    let (roll, pitch, yaw) = X.rotation.euler_angles();
    let degrees = Vector3::new(roll, pitch, yaw).map(f64::to_degrees);
    let multiple = |angle: f64| (angle / FRAC_PI_4 - (angle / FRAC_PI_4).round()).abs() < 0.02;
    let largest = degrees.amax();
    (largest > 0.5 && largest < 3.3 * PI && degrees.iter().all(|&angle| multiple(angle))).then_some(largest)
}

/// The one change of the board or the camera, of those tried, with which most configurations would see the board.
fn turned(problem: &Problem) -> Option<Smell> {
    let Problem { robot, camera, target, space, visibility, .. } = problem;
    let cameras: Vec<Pose> = {
        let ids: Vec<usize> = space.evenly(TRIED).collect();
        ids.par_iter().map(|&id| robot.camera_pose(&space.configuration(id))).collect()
    };
    let seen = |board: &Board, X_BT: &Pose, X_CN: &Pose| {
        let sighting = Sighting::new(camera, board, visibility);
        let sees = |X_BC: &&Pose| {
            let measures = sighting.measures(&((*X_BC * X_CN).inverse() * X_BT));
            sighting.shortfalls(&measures).iter().all(|&miss| miss <= 0.0)
        };
        cameras.par_iter().filter(sees).count()
    };
    let over = Pose::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI));
    let still = Pose::identity();
    let mut changes = vec![(Smell::FacingAway(0.0), seen(&target.board, &(target.X_BT * over), &still))];
    if let Board::Checkerboard(Checkerboard { columns, rows, square }) = target.board {
        let swapped = Board::checkerboard(rows, columns, square);
        changes.push((Smell::Swapped(0.0), seen(&swapped, &target.X_BT, &still)));
    }
    for (name, R_CN) in directions() {
        let X_CN = Pose::from_parts(Translation3::identity(), R_CN);
        changes.push((Smell::LooksAlong(name, 0.0), seen(&target.board, &target.X_BT, &X_CN)));
    }
    // Of equals the first: a board is turned over sooner than a camera.
    let (smell, count) =
        changes.into_iter().rev().max_by_key(|&(_, count)| count).filter(|&(_, count)| count >= TELLING)?;
    let share = count as f64 / cameras.len() as f64;
    Some(match smell {
        Smell::FacingAway(_) => Smell::FacingAway(share),
        Smell::LooksAlong(name, _) => Smell::LooksAlong(name, share),
        _ => Smell::Swapped(share),
    })
}

/// The axes of the stated camera frame that another optical axis may be, and the frame of a camera that looks along them.
fn directions() -> [(&'static str, UnitQuaternion<f64>); 5] {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    // Columns: right, down, forward. Along x as in ROS's body frames: x forward, y left, z up.
    let frame = |right: Vector3<f64>, down: Vector3<f64>, forward: Vector3<f64>| {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[
            right, down, forward,
        ])))
    };
    [
        ("x", frame(-y, -z, x)),
        ("-x", frame(y, -z, -x)),
        ("y", frame(x, -z, y)),
        ("-y", frame(x, z, -y)),
        ("-z", frame(-x, y, -z)),
    ]
}

impl Smell {
    /// Its name in documents.
    pub fn name(&self) -> &'static str {
        match self {
            Smell::Metres(..) => "metres",
            Smell::Millimetres(_) => "millimetres",
            Smell::Radians(..) => "radians",
            Smell::FocalLength(_) => "focal_length",
            Smell::FacingAway(_) => "facing_away",
            Smell::LooksAlong(..) => "looks_along",
            Smell::Swapped(_) => "rows_and_columns_swapped",
        }
    }
}

impl fmt::Display for Smell {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let percent = |share: &f64| format!("{:.1} %", 100.0 * share);
        match self {
            Smell::Metres(what, mm) => write!(f, "{what}: {mm:.4} mm looks like metres; lengths are in mm"),
            Smell::Millimetres(reach) => {
                write!(
                    f,
                    "the robot's links are {reach:.0} m long in total, which looks like millimetres; URDF is in metres"
                )
            }
            Smell::Radians(what, degrees) => {
                write!(f, "{what}: {degrees:.4}° looks like radians; angles are in degrees")
            }
            Smell::FocalLength(px) => write!(f, "`camera.fx_px`: {px} looks like mm; focal lengths are in px"),
            Smell::FacingAway(share) => write!(
                f,
                "the board faces away from the camera; if it were turned over, as with rpy_deg = [180, 0, 0], {} of the \
                 configurations would see it",
                percent(share)
            ),
            Smell::LooksAlong(axis, share) => {
                write!(
                    f,
                    "the camera looks along z of its frame (x right, y down, z forward); if it looked along {axis}, {} of the \
                     configurations would see the board",
                    percent(share)
                )?;
                match *axis {
                    "x" => f.write_str(
                        ". ROS's body frames, such as camera_link, look along x, and optical frames along z: name the \
                                        optical frame, or correct `camera.mount`",
                    ),
                    _ => f.write_str(": correct `camera.mount`"),
                }
            }
            Smell::Swapped(share) => write!(
                f,
                "columns and rows may be swapped; the other way round, {} of the configurations would see the board",
                percent(share)
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::plan::survey::diagnosis::{Diagnosis, Miss, diagnose};
    use crate::problem::STARTER;

    fn parsed(text: &str) -> Problem {
        Problem::parse(text, Path::new("problem.toml")).map_err(|error| format!("{:?}", error.faults())).unwrap()
    }

    /// The starter with its board out of reach and some other changes.
    fn far(changes: &[(&str, &str)]) -> Diagnosis {
        let mut text = STARTER.replace("position_mm = [650, ", "position_mm = [6000, ");
        assert!(text != STARTER);
        for (from, to) in changes {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        diagnose(&parsed(&text))
    }

    #[test]
    fn a_board_out_of_reach_is_told_in_its_own_units() {
        let found = far(&[]);
        let obstacle = found.obstacle.as_ref().unwrap();
        let Miss::TooFar(distance, most) = obstacle.nearest else { panic!("{found:?}") };
        assert!(obstacle.stops_all && found.views == 0 && (4.5..5.8).contains(&distance) && most == 1.5, "{found:?}");
        let told = found.to_string();
        assert!(told.contains("the closest camera is ") && told.contains("max_distance_mm is 1500"), "{told}");
        assert!(found.smells.is_empty(), "{told}");
    }

    #[test]
    fn lengths_in_metres_smell() {
        let found = far(&[
            ("d_mm = 400", "d_mm = 0.4"),
            ("a_mm = 450", "a_mm = 0.45"),
            ("a_mm = 40\n", "a_mm = 0.04\n"),
            ("d_mm = 450", "d_mm = 0.45"),
            ("d_mm = 80", "d_mm = 0.08"),
        ]);
        let [Smell::Metres("the sum of the robot's lengths", mm)] = found.smells[..] else { panic!("{found:?}") };
        assert!((1.3..1.5).contains(&mm), "{mm}");
        let found = far(&[("square_mm = 25", "square_mm = 0.025")]);
        assert_eq!(found.smells, [Smell::Metres("`target.square_mm`", 0.025)]);
        let found = far(&[
            ("min_distance_mm = 200", "min_distance_mm = 0.2"),
            ("max_distance_mm = 1500", "max_distance_mm = 1.5"),
        ]);
        assert_eq!(found.smells, [Smell::Metres("`visibility.max_distance_mm`", 1.5)]);
        assert!(found.to_string().contains("Suspicious: `visibility.max_distance_mm`: 1.5000 mm looks like metres"));
    }

    #[test]
    fn angles_in_radians_smell() {
        let found = far(&[
            ("[-60, 60]", "[-1.05, 1.05]"),
            ("[-30, 75]", "[-0.52, 1.31]"),
            ("[-60, 75]", "[-1.05, 1.31]"),
            ("[-90, 90]", "[-1.57, 1.57]"),
            ("[0, 110]", "[0, 1.92]"),
            ("[-180, 180]", "[-3.1, 3.1]"),
        ]);
        let [Smell::Radians("the widest range of the joints", widest)] = found.smells[..] else { panic!("{found:?}") };
        assert!((widest - 3.1).abs() < 1e-9);
        let found = far(&[("rpy_deg = [0, 0, 90]", "rpy_deg = [3.1416, 0, 1.5708]")]);
        assert!(
            matches!(found.smells[..], [Smell::Radians("the orientation of the board in `target.pose`", _)]),
            "{found:?}"
        );
        let found = far(&[("alpha_deg = -90\nlimits_deg = [-60, 60]", "alpha_deg = -1.5708\nlimits_deg = [-60, 60]")]);
        assert!(matches!(found.smells[..], [Smell::Radians("an angle of the robot's links", _)]), "{found:?}");
        let found = far(&[("[visibility]", "[visibility]\nmax_tilt_deg = 1.2")]);
        assert!(matches!(found.smells[..], [Smell::Radians("`visibility.max_tilt_deg`", _)]), "{found:?}");
    }

    #[test]
    fn a_focal_length_in_mm_smells() {
        // With the starter's lens such a camera is refused: its picture would reach beyond the lens.
        let found = far(&[
            ("fx_px = 1100\n", "fx_px = 4\n"),
            ("model = \"brown-conrady\"", "model = \"none\""),
            ("k1 = -0.1", ""),
        ]);
        assert_eq!(found.smells, [Smell::FocalLength(4.0)]);
    }

    /// A camera 0.3 m over a board, turned by a little.
    const ABOVE: &str = r#"
        [[robot.joints]]
        name = "turn"
        limits_deg = [-10, 10]
        [camera]
        mount = { position_mm = [0, 0, 300], rpy_deg = [180, 0, 0] }
        width_px = 640
        height_px = 240
        fx_px = 500
        [target]
        columns = 9
        rows = 3
        square_mm = 40
        pose = { position_mm = [0, 0, 0] }
        [sweep]
        step_deg = 0.5
        [visibility]
        margin_px = 5
        min_distance_mm = 100
    "#;

    fn above(from: &str, to: &str) -> Diagnosis {
        assert!(ABOVE.contains(from), "{from}");
        diagnose(&parsed(&ABOVE.replace(from, to)))
    }

    #[test]
    fn what_is_turned_or_exchanged_smells() {
        let right = above("columns = 9", "columns = 9");
        assert!(right.views == right.tried && right.obstacle.is_none() && right.smells.is_empty(), "{right:?}");
        let found = above("columns = 9\n        rows = 3", "columns = 3\n        rows = 9");
        assert_eq!(found.smells, [Smell::Swapped(1.0)], "{found:?}");
        assert!(matches!(found.obstacle.unwrap().nearest, Miss::OutsideImage(px) if px > 10.0));
        let found = above("position_mm = [0, 0, 0] }", "position_mm = [0, 0, 0], rpy_deg = [180, 0, 0] }");
        assert!(matches!(found.smells[..], [Smell::FacingAway(share)] if share > 0.9), "{found:?}");
        assert!(matches!(found.obstacle.unwrap().nearest, Miss::BackSide(angle) if angle > 3.0));
        // Looking down as a body frame of ROS does: its x down, its y along the board.
        let found = above("rpy_deg = [180, 0, 0]", "rpy_deg = [90, 90, 0]");
        assert!(matches!(found.smells[..], [Smell::LooksAlong("x", share)] if share > 0.9), "{found:?}");
        assert!(found.to_string().contains("ROS's body frames"), "{found}");
    }
}
