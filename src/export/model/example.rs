//! A small robot whose models the tests read: a lift, an arm, and a finger that follows the arm.

use nalgebra::{Point3, Vector3};

use super::setup::Setup;
use crate::camera::{Camera, Lens};
use crate::export::program::{Home, Program, ProgramJoint, Stop};
use crate::feasibility::LinkPair;
use crate::robot::{Body, Chain, Joint, JointKind, Limits, Link, Motion, PointMass, Robot, Shape, Stage, Tree};
use crate::spatial::Pose;
use crate::target::{Board, Target, Zone};

pub(in crate::export) struct Example {
    pub(in crate::export) robot: Robot,
    pub(in crate::export) camera: Camera,
    pub(in crate::export) target: Target,
    joints: Vec<ProgramJoint>,
    stops: Vec<Stop>,
    untested: Vec<LinkPair>,
}

impl Example {
    /// The arm's joint has a constant, and its axis points backwards.
    pub(in crate::export) fn new() -> Self {
        let driven = |joint, kind, axis, multiplier, offset| Motion::Driven { joint, kind, axis, multiplier, offset };
        let lift = driven(0, JointKind::Prismatic, Vector3::z_axis(), 1.0, 0.0);
        let arm = driven(1, JointKind::Revolute, Vector3::y_axis(), -1.0, 0.25);
        let finger = driven(1, JointKind::Revolute, Vector3::x_axis(), 0.5, 0.1);
        let link = |name: &str, parent, X_PJ, motion: &Motion, shape: Option<Shape>| Link {
            name: name.into(),
            parent,
            X_PJ,
            motion: motion.clone(),
            bodies: shape.into_iter().map(|shape| Body { X_LG: Pose::translation(0.0, 0.0, 0.1), shape }).collect(),
            mass: None,
        };
        let up = Pose::translation(0.0, 0.0, 0.5);
        let ahead = Pose::new(Vector3::new(0.25, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.5));
        let cuboid = Shape::Box { half_extents: Vector3::new(0.1, 0.2, 0.05) };
        let corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]].map(Point3::from);
        let hull = Shape::Convex { points: corners.to_vec(), margin: 0.0 };
        let mut links = vec![
            link("world", None, Pose::identity(), &Motion::Fixed, Some(cuboid)),
            link("lift", Some(0), up, &lift, Some(Shape::Cylinder { radius: 0.05, length: 0.5 })),
            link("arm", Some(1), ahead, &arm, Some(Shape::Capsule { radius: 0.04, length: 0.25 })),
            link("finger", Some(2), ahead, &finger, Some(hull)),
        ];
        links[2].mass = Some(PointMass { mass: 2.0, center: Point3::new(0.0, 0.0, 0.125) });
        let X_FC = Pose::new(Vector3::new(0.0, 0.0, 0.25), Vector3::new(0.0, 1.0, 0.0));
        let X_BT = Pose::translation(0.5, 0.0, 0.0625);
        let thickness = 0.005;
        let board = Board::checkerboard(4, 3, 0.02);
        let (width, height) = board.printed_size();
        let mut tree = Tree { links, disabled: Vec::new() };
        let sphere = Body { X_LG: Pose::identity(), shape: Shape::Sphere { radius: 0.03 } };
        tree.attach("camera", 2, X_FC, sphere);
        let shape = Shape::Box { half_extents: Vector3::new(width, height, thickness) / 2.0 };
        tree.attach("board", 0, X_BT, Body { X_LG: Pose::translation(0.0, 0.0, -thickness / 2.0), shape });
        let joint = |name: &str, kind, min, max| Joint::free(name.into(), kind, Limits { min, max }, None);
        let joints =
            vec![joint("lift", JointKind::Prismatic, 0.0, 0.5), joint("shoulder", JointKind::Revolute, -1.0, 2.0)];
        let stages = vec![Stage { X_PJ: up, motion: lift }, Stage { X_PJ: ahead, motion: arm }];
        let program_joint = |joint: &Joint| ProgramJoint {
            name: joint.name.clone(),
            kind: joint.kind,
            speed: 1.5,
            acceleration: 3.0,
            jerk: f64::INFINITY,
        };
        let stop = |label: &str, q: [f64; 2], picture| Stop { label: label.into(), q: q.into(), seconds: 2.0, picture };
        let zone = Zone { width, height, edge_margin: 0.0 };
        let θ = [600.0, 610.0, 319.5, 241.0, -0.25, 0.125, 0.0, 0.0625, 0.0];
        Self {
            joints: joints.iter().map(program_joint).collect(),
            stops: vec![
                stop("pose 7", [0.125, 0.5], true),
                stop("way to pose 3", [0.25, 0.5], false),
                stop("pose 3", [0.25, -0.5], true),
            ],
            robot: Robot {
                chain: Chain { joints, stages, X_nF: Pose::identity() },
                tree,
                X_FC,
                board_link: 0,
                camera_link: 2,
                obstacles: Vec::new(),
            },
            camera: Camera::new(Lens::BrownConrady, 640, 480, &θ).unwrap(),
            target: Target { board, X_BT, zone, warp: None, thickness },
            untested: vec![[0, 1], [1, 2], [0, 5]],
        }
    }

    pub(in crate::export) fn program(&self) -> Program<'_> {
        let home = Some(Home { q: vec![0.0, 0.0], back: None });
        Program { name: "lift & arm", joints: &self.joints, stops: &self.stops, home, dwell: 1.0, share: 0.5 }
    }

    pub(in crate::export) fn setup<'a>(&'a self, program: &'a Program<'a>) -> Setup<'a> {
        let Self { robot, camera, target, untested, .. } = self;
        Setup { program, robot, camera, target, untested }
    }
}

/// That a model's text below its comments says the same as `expected`: the same words, and numbers but for rounding.
pub(super) fn assert_agrees(text: &str, expected: &str) {
    let below = text.lines().skip_while(|line| line.starts_with("<?") || line.starts_with("<!--"));
    let below: Vec<&str> = below.collect();
    let words = |text: &str| -> Vec<String> {
        let separate = |c: char| c.is_whitespace() || matches!(c, '<' | '>' | '"' | '=');
        text.split(separate).filter(|word| !matches!(*word, "" | "/")).map(str::to_owned).collect()
    };
    let (found, expected) = (words(&below.join("\n")), words(expected));
    for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let same = match (found.parse::<f64>(), expected.parse::<f64>()) {
            (Ok(found), Ok(expected)) => (found - expected).abs() < 1e-14,
            _ => found == expected,
        };
        assert!(same, "word {i}: {found}, not {expected}, in\n{text}");
    }
    assert_eq!(found.len(), expected.len(), "{text}");
}
