//! MJCF, of `MuJoCo`.
//!
//! Source: `MuJoCo`'s XML reference. Its cameras look along −z with y up, have no distortion, and state where the image's centre is from the
//! principal point, x to the right and y down (so its pictures have it). A pair of bodies is tested for contact exactly if calipose tests
//! it.

use std::collections::HashSet;

use super::assembly::{Assembly, Inertia, Movement};
use super::assets::Assets;
use super::element::Element;
use super::note::beginning;
use super::placement::{numbers, quaternion, thick, vector};
use super::setup::Setup;
use crate::camera::{Camera, Lens};
use crate::export::text::decimal;
use crate::robot::{Body, JointKind, Limits, Shape};
use crate::spatial::Pose;

/// Pixels in a metre, which are not known: only their share of the focal length counts.
const PIXELS: f64 = 1e6;

/// Names of the assets.
const PLATE: &str = "board";

const NOTES: [&str; 2] = [
    "The keys are the plan's poses in their order. The joints have no drives: gravity is off, so that the arm stays at a key. Links without a known mass have 1 g.",
    "Bodies of two links are tested for contact exactly if the plan tests them: parents and children too, all other pairs are excluded.",
];
const DISTORTED: &str = "The camera has the lens's focal lengths and principal point; MuJoCo has no distortion.";
const FISHEYE: &str = "MuJoCo has no fisheye: the camera is left out, its link is there.";

pub(super) fn write(setup: &Setup, assembly: &Assembly, assets: &Assets) -> String {
    let mut notes = NOTES.to_vec();
    match setup.camera.lens() {
        Lens::Pinhole => {}
        lens if lens.is_fisheye() => notes.push(FISHEYE),
        _ => notes.push(DISTORTED),
    }
    let compiler = Element::new("compiler").with("angle", "radian").with("autolimits", "true");
    let flags = Element::new("flag").with("gravity", "disable").with("filterparent", "disable");
    let parts = [
        compiler.with("inertiafromgeom", "false"),
        Element::new("option").holding(flags),
        assets_of(assets),
        Element::new("worldbody").holding(body(setup, assembly, assets, 0)),
        contact(setup, assembly),
        equality(setup, assembly),
        keys(setup, assembly),
    ];
    let model = Element::new("mujoco").with("model", setup.program.name).holding_all(parts);
    model.document(&beginning(setup, assembly, Some(assets), &notes))
}

fn assets_of(assets: &Assets) -> Element {
    let mesh = |name: &str, file: &str| Element::new("mesh").with("name", name).with("file", file);
    let mut element = Element::new("asset").holding(mesh(PLATE, &assets.plate));
    if let Some(picture) = &assets.picture {
        let texture = Element::new("texture").with("name", PLATE).with("type", "2d").with("file", picture);
        let material = Element::new("material").with("name", PLATE).with("texture", PLATE);
        element.extend([texture, material]);
    }
    element.extend(assets.hulls().map(|file| mesh(file, file)));
    element
}

/// A link and all that hangs on it.
fn body(setup: &Setup, assembly: &Assembly, assets: &Assets, number: usize) -> Element {
    let link = &assembly.links[number];
    let mut element = placed(Element::new("body").with("name", &link.name), &link.X_PJ);
    let Inertia { mass, center, moment } = link.inertia();
    let inertial = Element::new("inertial").with("pos", vector(&center)).with("mass", decimal(mass));
    element.extend([inertial.with("diaginertia", numbers([moment; 3]))]);
    if let Movement::Leads { kind, axis, .. } | Movement::Follows { kind, axis, .. } = link.movement {
        let kind = match kind {
            JointKind::Revolute => "hinge",
            JointKind::Prismatic => "slide",
        };
        let Limits { min, max } = link.movement.range(|joint| setup.robot.chain.joints[joint].limits);
        let joint = Element::new("joint").with("name", &link.joint).with("type", kind).with("axis", vector(&axis));
        // A joint that is held has no range to move in, which MuJoCo refuses.
        element.extend([if min < max { joint.with("range", numbers([min, max])) } else { joint }]);
    }
    let solids = link.bodies.iter().enumerate();
    element.extend(solids.filter_map(|(place, body)| geom(body, assets.hull(number, place))).map(|geom| {
        // The board is to be seen with its picture, and touched where it is printed.
        if number == assembly.board { geom.with("group", "3") } else { geom }
    }));
    if number == assembly.board {
        let plate = Element::new("geom").with("type", "mesh").with("mesh", PLATE);
        let plate = plate.with("contype", "0").with("conaffinity", "0").with("group", "2");
        element.extend([if assets.picture.is_some() { plate.with("material", PLATE) } else { plate }]);
    }
    if number == assembly.camera && !setup.camera.lens().is_fisheye() {
        element.extend([camera(setup.camera)]);
    }
    element.extend(assembly.children(number).map(|child| body(setup, assembly, assets, child)));
    element
}

fn placed(element: Element, X: &Pose) -> Element {
    element.with("pos", vector(&X.translation.vector)).with("quat", quaternion(X))
}

/// A solid; none of a hull without a file.
fn geom(body: &Body, file: Option<&str>) -> Option<Element> {
    let geom = |kind: &str| placed(Element::new("geom").with("type", kind), &body.X_LG);
    let sized = |kind: &str, size: &[f64]| geom(kind).with("size", numbers(size.iter().map(|&size| thick(size))));
    Some(match &body.shape {
        Shape::Box { half_extents } => sized("box", half_extents.as_slice()),
        Shape::Cylinder { radius, length } => sized("cylinder", &[*radius, length / 2.0]),
        Shape::Sphere { radius } => sized("sphere", &[*radius]),
        Shape::Capsule { radius, length } => sized("capsule", &[*radius, length / 2.0]),
        Shape::Convex { .. } => geom("mesh").with("mesh", file?),
    })
}

/// The camera on the link of its frame C, from which its own is half a turn about x.
fn camera(camera: &Camera) -> Element {
    let θ = camera.intrinsics();
    let size = [camera.width(), camera.height()].map(f64::from);
    // (0, 0) is the centre of the top-left pixel.
    let principal = [0, 1].map(|axis| size[axis] / 2.0 - 0.5 - θ[2 + axis]);
    Element::new("camera")
        .with("name", "camera")
        .with("quat", "0 1 0 0")
        .with("resolution", format!("{} {}", camera.width(), camera.height()))
        .with("sensorsize", numbers(size.map(|size| size / PIXELS)))
        .with("focalpixel", numbers([θ[0], θ[1]]))
        .with("principalpixel", numbers(principal))
}

/// The pairs that are not tested.
fn contact(setup: &Setup, assembly: &Assembly) -> Element {
    let name = |link: usize| assembly.links[link].name.as_str();
    let exclude = |&[a, b]: &[usize; 2]| Element::new("exclude").with("body1", name(a)).with("body2", name(b));
    Element::new("contact").holding_all(setup.untested.iter().map(exclude))
}

/// How joints follow others.
fn equality(setup: &Setup, assembly: &Assembly) -> Element {
    let follows = assembly.links.iter().filter_map(|link| {
        let Movement::Follows { joint, multiplier, offset, .. } = link.movement else { return None };
        let joints =
            Element::new("joint").with("joint1", &link.joint).with("joint2", &setup.program.joints[joint].name);
        Some(joints.with("polycoef", numbers([offset, multiplier, 0.0, 0.0, 0.0])))
    });
    Element::new("equality").holding_all(follows)
}

/// The poses, and home.
fn keys(setup: &Setup, assembly: &Assembly) -> Element {
    let moving = assembly.moving();
    let mut taken = HashSet::new();
    let home = setup.program.home.iter().map(|home| ("home", &home.q));
    let places = home.chain(setup.program.visits().map(|stop| (stop.label.as_str(), &stop.q)));
    let keys = places.map(|(label, q)| {
        let key = Element::new("key");
        // Two keys of a name are refused.
        let key = if taken.insert(label.to_owned()) { key.with("name", label) } else { key };
        key.with("qpos", numbers(moving.iter().map(|&link| assembly.links[link].movement.value(q))))
    });
    Element::new("keyframe").holding_all(keys.collect::<Vec<_>>())
}
