//! Why a configuration is no view, with what was measured.

use crate::feasibility::{Checks, Measures, Rejection, Sighting};
use crate::figures::{grouped, short, trimmed};
use crate::problem::Problem;
use crate::robot::Limits;

/// The `reason` for which the configuration `q` is no view, in words.
pub(super) fn why(problem: &Problem, checks: &Checks, reason: Rejection, q: &[f64]) -> String {
    let limits = &problem.visibility;
    let X_CT = problem.robot.camera_pose(q).inverse() * problem.target.X_BT;
    let measures = || Sighting::new(&problem.camera, &problem.target.board, limits).measures(&X_CT);
    let mm = |length: f64| short(1e3 * length);
    let deg = |angle: f64| short(angle.to_degrees());
    match reason {
        Rejection::JointLimit => beyond_limits(problem, q),
        Rejection::BackSide => "the camera is on the unprinted side of the board".into(),
        Rejection::Distance => {
            let distance = measures().distance;
            if distance > limits.max_distance {
                format!("the board is {} mm away; max_distance_mm is {}", mm(distance), mm(limits.max_distance))
            } else {
                format!("the board is {} mm away; min_distance_mm is {}", mm(distance), mm(limits.min_distance))
            }
        }
        Rejection::Incidence => {
            let (angle, most) = (deg(measures().incidence), deg(limits.max_incidence));
            format!("the camera is {angle}° off the board's normal; max_incidence_deg is {most}")
        }
        Rejection::Tilt => {
            let (angle, most) = (deg(measures().tilt), deg(limits.max_tilt));
            format!("the optical axis is {angle}° off the board's normal; max_tilt_deg is {most}")
        }
        Rejection::BeyondLens => "a corner is behind the camera or beyond what the lens model projects".into(),
        Rejection::OutsideImage => match measures().overhang {
            beyond if beyond > 0.0 && beyond.is_finite() => {
                format!("a corner is {} px outside the image or its margin", short(beyond))
            }
            _ => "the image's border cuts a marker or a corner that must be seen".into(),
        },
        Rejection::CornerSpacing => match measures() {
            Measures { spacing, .. } if spacing < limits.min_corner_spacing => {
                let least = trimmed(limits.min_corner_spacing, 3);
                format!("squares are {} px high in the image; min_corner_spacing_px is {least}", short(spacing))
            }
            _ => "corners are too close together, or markers too small, in a part of the image".into(),
        },
        Rejection::Unstable => unstable(problem, q),
        Rejection::SelfCollision | Rejection::SceneCollision => {
            let links = &problem.robot.tree.links;
            match checks.collision().first(&problem.robot.tree.link_poses(q)) {
                Some([a, b]) => format!("links {} and {} are within the clearance", links[a].name, links[b].name),
                None => "two links are within the clearance".into(),
            }
        }
        Rejection::Occluded => "the robot or an obstacle hides corners of the board".into(),
        Rejection::Uncertain => "it is a view in too few of the set-ups that may be".into(),
    }
}

/// The joints that are beyond their limits.
fn beyond_limits(problem: &Problem, q: &[f64]) -> String {
    let joints = problem.robot.chain.joints.iter().zip(q);
    let beyond = joints.filter(|(joint, q)| !joint.limits.holds(**q));
    let said = beyond.map(|(joint, &q)| {
        let sign = joint.kind.display_sign();
        let shown = |value: f64| format!("{}{sign}", trimmed(joint.kind.to_display(value), 4));
        let Limits { min, max } = joint.limits;
        format!("{} is at {}; its limits are {} and {}", joint.name, shown(q), shown(min), shown(max))
    });
    said.collect::<Vec<_>>().join(", ")
}

fn unstable(problem: &Problem, q: &[f64]) -> String {
    let tree = &problem.robot.tree;
    let stability = problem.stability.as_ref();
    let measured = stability.and_then(|limit| Some((limit.margin_at(tree, &tree.link_poses(q))?, limit.margin)));
    match measured {
        Some((margin, least)) => {
            format!("the tip-over margin is {} mm; margin_mm is {}", short(1e3 * margin), trimmed(1e3 * least, 3))
        }
        None => format!("the centre of mass of the {} links is not known", grouped(tree.links.len())),
    }
}
