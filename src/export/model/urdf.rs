//! URDF, of ROS.
//!
//! Source: the XML specification of `urdf` (wiki.ros.org/urdf/XML) as urdfdom 1.0 reads it. It has no capsules, which are a cylinder and two
//! spheres here, and no cameras.

use super::assembly::{Assembly, Inertia, ModelLink, Movement};
use super::assets::Assets;
use super::element::Element;
use super::note::beginning;
use super::placement::{numbers, roll_pitch_yaw, vector};
use super::setup::Setup;
use crate::export::text::decimal;
use crate::robot::{Body, JointKind, Limits, Shape};
use crate::spatial::Pose;

/// Greatest effort in N·m or N, which must be stated and is not known.
const EFFORT: f64 = 1000.0;

const NOTE: &str =
    "Limits and speeds of the joints are the problem's; efforts are not known, and 1000 stands for them.";

pub(super) fn write(setup: &Setup, assembly: &Assembly, assets: &Assets) -> String {
    let comments = beginning(setup, assembly, Some(assets), &[NOTE]);
    robot(setup, assembly, Some(assets)).document(&comments)
}

/// The robot as text that names no other files: without the hulls of meshes and the board's picture.
pub(in crate::export) fn description(setup: &Setup, assembly: &Assembly) -> String {
    robot(setup, assembly, None).document(&beginning(setup, assembly, None, &[NOTE]))
}

fn robot(setup: &Setup, assembly: &Assembly, assets: Option<&Assets>) -> Element {
    let mut robot = Element::new("robot").with("name", setup.program.name);
    for (number, link) in assembly.links.iter().enumerate() {
        let mut element = Element::new("link").with("name", &link.name);
        element.extend(link.mass.map(|_| inertial(link.inertia())));
        if number == assembly.board {
            let visual = match assets {
                Some(assets) => placed("visual", &Pose::identity(), mesh(&assets.plate)),
                None => plate(setup),
            };
            element.extend([visual]);
        }
        for (place, body) in link.bodies.iter().enumerate() {
            let file = assets.and_then(|assets| assets.hull(number, place));
            for (X_LG, shape) in solids(body, file) {
                // The board is to be seen with its picture.
                if number != assembly.board {
                    element.extend([placed("visual", &X_LG, shape.clone())]);
                }
                element.extend([placed("collision", &X_LG, shape)]);
            }
        }
        robot.extend([element]);
    }
    robot.extend(assembly.links.iter().filter_map(|link| joint(setup, assembly, link)));
    robot
}

fn origin(X: &Pose) -> Element {
    Element::new("origin").with("xyz", vector(&X.translation.vector)).with("rpy", numbers(roll_pitch_yaw(X)))
}

fn inertial(Inertia { mass, center, moment }: Inertia) -> Element {
    let on_axis = |name: &str| if name.as_bytes()[1] == name.as_bytes()[2] { decimal(moment) } else { "0".to_owned() };
    let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    let tensor = names.iter().fold(Element::new("inertia"), |tensor, name| tensor.with(name, on_axis(name)));
    let X_LG = Pose::translation(center.x, center.y, center.z);
    Element::new("inertial").holding_all([origin(&X_LG), Element::new("mass").with("value", decimal(mass)), tensor])
}

/// The plate of the board, as large as it is printed.
fn plate(setup: &Setup) -> Element {
    let (width, height) = setup.target.board.printed_size();
    let size = numbers([width, height, setup.target.thickness]);
    let X_TG = Pose::translation(0.0, 0.0, -setup.target.thickness / 2.0);
    placed("visual", &X_TG, Element::new("box").with("size", size))
}

fn placed(tag: &'static str, X_LG: &Pose, shape: Element) -> Element {
    Element::new(tag).holding_all([origin(X_LG), Element::new("geometry").holding(shape)])
}

fn mesh(file: &str) -> Element {
    Element::new("mesh").with("filename", file)
}

/// A body as shapes that URDF has, with their poses in the link's frame; a hull is in the `file`, and left out without one.
fn solids(body: &Body, file: Option<&str>) -> Vec<(Pose, Element)> {
    let X_LG = body.X_LG;
    let cylinder = |radius: f64, length: f64| {
        (X_LG, Element::new("cylinder").with("radius", decimal(radius)).with("length", decimal(length)))
    };
    let sphere = |X: Pose, radius: f64| (X, Element::new("sphere").with("radius", decimal(radius)));
    match &body.shape {
        Shape::Box { half_extents } => vec![(X_LG, Element::new("box").with("size", vector(&(half_extents * 2.0))))],
        Shape::Cylinder { radius, length } => vec![cylinder(*radius, *length)],
        Shape::Sphere { radius } => vec![sphere(X_LG, *radius)],
        Shape::Capsule { radius, length } => {
            let end = |z: f64| sphere(X_LG * Pose::translation(0.0, 0.0, z), *radius);
            vec![cylinder(*radius, *length), end(length / 2.0), end(-length / 2.0)]
        }
        Shape::Convex { .. } => file.map(|file| (X_LG, mesh(file))).into_iter().collect(),
    }
}

/// The joint by which a link hangs on its parent; none for the root.
fn joint(setup: &Setup, assembly: &Assembly, link: &ModelLink) -> Option<Element> {
    let parent = &assembly.links[link.parent?].name;
    let (kind, moving) = match link.movement {
        Movement::Fixed => ("fixed", None),
        Movement::Leads { joint, kind, axis } | Movement::Follows { joint, kind, axis, .. } => {
            let kind = match kind {
                JointKind::Revolute => "revolute",
                JointKind::Prismatic => "prismatic",
            };
            (kind, Some((joint, axis)))
        }
    };
    let mut element = Element::new("joint").with("name", &link.joint).with("type", kind).holding_all([
        origin(&link.X_PJ),
        Element::new("parent").with("link", parent),
        Element::new("child").with("link", &link.name),
    ]);
    if let Some((joint, axis)) = moving {
        let Limits { min, max } = link.movement.range(|joint| setup.robot.chain.joints[joint].limits);
        let speed = setup.program.joints[joint].speed * link.movement.rate().abs();
        let limit = Element::new("limit").with("lower", decimal(min)).with("upper", decimal(max));
        let limit = limit.with("velocity", decimal(speed)).with("effort", decimal(EFFORT));
        element.extend([Element::new("axis").with("xyz", vector(&axis)), limit]);
    }
    if let Movement::Follows { joint, multiplier, offset, .. } = link.movement {
        let mimic = Element::new("mimic").with("joint", &setup.program.joints[joint].name);
        element.extend([mimic.with("multiplier", decimal(multiplier)).with("offset", decimal(offset))]);
    }
    Some(element)
}
