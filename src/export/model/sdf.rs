//! SDF, of Gazebo.
//!
//! Source: the `SDFormat` specification 1.9, and 1.11 where joints follow others. A camera's sensor has x forward, y left and z up.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use super::assembly::{Assembly, Inertia, ModelLink, Movement};
use super::assets::Assets;
use super::element::Element;
use super::note::beginning;
use super::placement::{numbers, roll_pitch_yaw, thick, vector};
use super::setup::Setup;
use crate::camera::{Camera, Lens};
use crate::export::error::ExportError;
use crate::export::text::decimal;
use crate::robot::{Body, JointKind, Limits, Shape};
use crate::spatial::Pose;

/// What the camera sees, m.
const NEAR: f64 = 0.01;
const FAR: f64 = 100.0;

/// Pictures a second.
const RATE: f64 = 10.0;

const NOTE: &str = "The joints have no drives: gravity is off, so that the arm stays where it is put. Links without a known mass have 1 g.";
const RATIONAL: &str =
    "SDF has no rational distortion: the camera has the lens's focal lengths and principal point alone.";
const FISHEYE: &str = "SDF has no fisheye by Kannala and Brandt: the camera is left out, its link is there.";

pub(super) fn write(setup: &Setup, assembly: &Assembly, assets: &Assets) -> Result<String, ExportError> {
    for link in &assembly.links {
        is_legal(&link.name)?;
        is_legal(&link.joint)?;
    }
    let mut notes = vec![NOTE];
    match setup.camera.lens() {
        lens if lens.is_fisheye() => notes.push(FISHEYE),
        Lens::Rational => notes.push(RATIONAL),
        _ => {}
    }
    let mut model = Element::new("model").with("name", identifier(setup.program.name));
    let root = &assembly.links[0].name;
    let ground = Element::new("joint").with("name", "world_joint").with("type", "fixed");
    model.extend([ground.holding_all([Element::text("parent", "world"), Element::text("child", root)])]);
    for (number, element) in assembly.links.iter().enumerate() {
        model.extend([link(setup, assembly, assets, number, element)]);
    }
    model.extend(assembly.links.iter().filter_map(|link| joint(setup, assembly, link)));
    let follows = assembly.links.iter().any(|link| matches!(link.movement, Movement::Follows { .. }));
    let version = if follows { "1.11" } else { "1.9" };
    let document = Element::new("sdf").with("version", version).holding(model);
    Ok(document.document(&beginning(setup, assembly, Some(assets), &notes)))
}

/// The model's name as SDF takes it.
fn identifier(name: &str) -> String {
    name.replace("::", "_").trim_matches('_').to_owned()
}

/// That SDF does not keep the name for itself.
fn is_legal(name: &str) -> Result<(), ExportError> {
    if name.contains("::") || (name.len() >= 4 && name.starts_with("__") && name.ends_with("__")) || name == "world" {
        let (format, allowed) = ("sdf", "without \"::\", not \"world\", and not between \"__\" and \"__\"");
        return Err(ExportError::ReservedName { format, name: name.to_owned(), allowed });
    }
    Ok(())
}

fn pose(X: &Pose) -> Element {
    let [roll, pitch, yaw] = roll_pitch_yaw(X);
    Element::text("pose", format!("{} {}", vector(&X.translation.vector), numbers([roll, pitch, yaw])))
}

fn link(setup: &Setup, assembly: &Assembly, assets: &Assets, number: usize, link: &ModelLink) -> Element {
    let mut element = Element::new("link").with("name", &link.name);
    let place = pose(&link.X_PJ);
    element.extend([match link.parent {
        Some(parent) => place.with("relative_to", &assembly.links[parent].name),
        None => place,
    }]);
    element.extend([Element::text("gravity", "false"), inertial(link.inertia())]);
    if number == assembly.board {
        element.extend([placed("visual", "plate", &Pose::identity(), mesh(&assets.plate))]);
    }
    for (place, body) in link.bodies.iter().enumerate() {
        let Some(shape) = shape(body, assets.hull(number, place)) else { continue };
        let name = |kind: &str| format!("{kind}_{}", place + 1);
        if number != assembly.board {
            element.extend([placed("visual", &name("visual"), &body.X_LG, shape.clone())]);
        }
        element.extend([placed("collision", &name("collision"), &body.X_LG, shape)]);
    }
    if number == assembly.camera && !setup.camera.lens().is_fisheye() {
        element.extend([sensor(setup.camera, &link.name)]);
    }
    element
}

fn inertial(Inertia { mass, center, moment }: Inertia) -> Element {
    let X_LG = Pose::translation(center.x, center.y, center.z);
    let moments = ["ixx", "iyy", "izz"].map(|name| Element::text(name, decimal(moment)));
    let products = ["ixy", "ixz", "iyz"].map(|name| Element::text(name, "0"));
    let tensor = Element::new("inertia").holding_all(moments).holding_all(products);
    Element::new("inertial").holding_all([pose(&X_LG), Element::text("mass", decimal(mass)), tensor])
}

fn placed(tag: &'static str, name: &str, X_LG: &Pose, shape: Element) -> Element {
    Element::new(tag).with("name", name).holding_all([pose(X_LG), Element::new("geometry").holding(shape)])
}

fn mesh(file: &str) -> Element {
    Element::new("mesh").holding(Element::text("uri", file))
}

/// A solid; none of a hull without a file.
fn shape(body: &Body, file: Option<&str>) -> Option<Element> {
    let size = |name, size: f64| Element::text(name, decimal(thick(size)));
    Some(match &body.shape {
        Shape::Box { half_extents } => {
            let sides = half_extents.map(|half| thick(2.0 * half));
            Element::new("box").holding(Element::text("size", vector(&sides)))
        }
        Shape::Cylinder { radius, length } => {
            Element::new("cylinder").holding_all([size("radius", *radius), size("length", *length)])
        }
        Shape::Sphere { radius } => Element::new("sphere").holding(size("radius", *radius)),
        Shape::Capsule { radius, length } => {
            Element::new("capsule").holding_all([size("radius", *radius), size("length", *length)])
        }
        Shape::Convex { .. } => mesh(file?),
    })
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
    let joint = Element::new("joint").with("name", &link.joint).with("type", kind);
    let joint = joint.holding_all([Element::text("parent", parent), Element::text("child", &link.name)]);
    let Some((leader, axis)) = moving else { return Some(joint) };
    let Limits { min, max } = link.movement.range(|joint| setup.robot.chain.joints[joint].limits);
    let speed = setup.program.joints[leader].speed * link.movement.rate().abs();
    let limit = Element::new("limit").holding_all([
        Element::text("lower", decimal(min)),
        Element::text("upper", decimal(max)),
        Element::text("velocity", decimal(speed)),
    ]);
    let mut axis = Element::new("axis").holding_all([Element::text("xyz", vector(&axis)), limit]);
    if let Movement::Follows { joint, multiplier, offset, .. } = link.movement {
        let mimic = Element::new("mimic").with("joint", &setup.program.joints[joint].name);
        axis.extend([mimic.holding_all([
            Element::text("multiplier", decimal(multiplier)),
            Element::text("offset", decimal(offset)),
            Element::text("reference", "0"),
        ])]);
    }
    Some(joint.holding(axis))
}

/// The camera on the link of its frame C.
fn sensor(camera: &Camera, frame: &str) -> Element {
    let θ = camera.intrinsics();
    let (width, height) = (camera.width(), camera.height());
    // Columns are the sensor's x, y and z in C: forward, left and up.
    let R_CS = Matrix3::new(
        0.0, -1.0, 0.0, //
        0.0, 0.0, -1.0, //
        1.0, 0.0, 0.0,
    );
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(R_CS));
    let view = 2.0 * (f64::from(width) / (2.0 * θ[0])).atan();
    let number = |name, value: f64| Element::text(name, decimal(value));
    let image = Element::new("image").holding_all([
        Element::text("width", width.to_string()),
        Element::text("height", height.to_string()),
        Element::text("format", "R8G8B8"),
    ]);
    let clip = Element::new("clip").holding_all([number("near", NEAR), number("far", FAR)]);
    // Gazebo counts pixels from the picture's corner.
    let names = [("fx", θ[0]), ("fy", θ[1]), ("cx", θ[2] + 0.5), ("cy", θ[3] + 0.5)];
    let intrinsics = names.map(|(name, value)| number(name, value));
    let intrinsics = Element::new("intrinsics").holding_all(intrinsics).holding(number("s", 0.0));
    let mut inside = Element::new("camera").holding_all([number("horizontal_fov", view), image, clip]);
    if camera.lens() == Lens::BrownConrady {
        let coefficients = ["k1", "k2", "p1", "p2", "k3"].iter().zip(&θ[4..]);
        let centre = [(θ[2] + 0.5) / f64::from(width), (θ[3] + 0.5) / f64::from(height)];
        inside.extend([Element::new("distortion")
            .holding_all(coefficients.map(|(&name, &value)| number(name, value)))
            .holding(Element::text("center", numbers(centre)))]);
    }
    inside.extend([Element::new("lens").holding(intrinsics), Element::text("optical_frame_id", frame)]);
    Element::new("sensor").with("name", "camera").with("type", "camera").holding_all([
        pose(&Pose::from_parts([0.0; 3].into(), rotation)),
        Element::text("update_rate", decimal(RATE)),
        inside,
    ])
}
