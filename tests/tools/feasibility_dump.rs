//! Prints a problem's links, bodies and masses, and what calipose says of random configurations, as one JSON document for
//! `tests/cross_check/self_collision.py`: `cargo run --example feasibility_dump -- FILE COUNT`.

#![allow(non_snake_case, clippy::unwrap_used, clippy::print_stdout, reason = "an example")]

use std::path::Path;

use calipose::problem::Problem;
use calipose::robot::{Body, JointKind, Limits, Link, Motion, Shape};
use calipose::spatial::Pose;
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde_json::{Value, json};

fn pose(X: &Pose) -> Value {
    let q = X.rotation.coords;
    json!({ "position": X.translation.vector.as_slice(), "quaternion_wxyz": [q.w, q.x, q.y, q.z] })
}

fn motion(motion: &Motion) -> Value {
    match motion {
        Motion::Fixed => Value::Null,
        Motion::Driven { joint, kind, axis, multiplier, offset } => json!({
            "joint": joint,
            "kind": if *kind == JointKind::Revolute { "hinge" } else { "slide" },
            "axis": axis.as_slice(),
            "multiplier": multiplier,
            "offset": offset,
        }),
    }
}

/// The shape with its full sizes in m.
fn body(body: &Body) -> Value {
    let (shape, size) = match &body.shape {
        Shape::Box { half_extents } => ("box", json!((half_extents * 2.0).as_slice())),
        Shape::Cylinder { radius, length } => ("cylinder", json!([radius, length])),
        Shape::Sphere { radius } => ("sphere", json!([radius])),
        Shape::Capsule { radius, length } => ("capsule", json!([radius, length])),
        Shape::Convex { points, .. } => ("convex", points.iter().map(|p| json!(p.coords.as_slice())).collect()),
    };
    json!({ "shape": shape, "size": size, "pose": pose(&body.X_LG) })
}

fn link(link: &Link) -> Value {
    json!({
        "name": link.name,
        "parent": link.parent,
        "pose": pose(&link.X_PJ),
        "motion": motion(&link.motion),
        "bodies": link.bodies.iter().map(body).collect::<Value>(),
        "mass": link.mass.map(|m| json!({ "mass": m.mass, "center": m.center.coords.as_slice() })),
    })
}

/// Joint values drawn evenly from the limits.
fn random(problem: &Problem, count: usize) -> Vec<Vec<f64>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(20);
    let mut value = |limits: Limits| rng.gen_range(limits.min..=limits.max);
    let joints = &problem.robot.chain.joints;
    (0..count).map(|_| joints.iter().map(|joint| value(joint.limits)).collect()).collect()
}

/// Configurations just before and just in collision: on the way between one that collides and one that does not, each within
/// a ten-thousandth of the way of where the verdict changes.
fn borderline(configurations: &[Vec<f64>], collides: impl Fn(&[f64]) -> bool) -> Vec<Vec<f64>> {
    let (inside, outside): (Vec<_>, Vec<_>) = configurations.iter().partition(|q| collides(q));
    let mut found = Vec::new();
    for (a, b) in inside.into_iter().zip(outside) {
        let at = |t: f64| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + t * (b - a)).collect() };
        let (mut low, mut high) = (0.0, 1.0);
        while high - low > 1e-4 {
            let middle = f64::midpoint(low, high);
            if collides(&at(middle)) { low = middle } else { high = middle }
        }
        found.extend([at(low), at(high)]);
    }
    found
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, count] = &arguments[..] else { panic!("usage: feasibility_dump FILE COUNT") };
    let problem = Problem::read(Path::new(file)).map_err(miette::Report::new).unwrap();
    let (tree, checks) = (&problem.robot.tree, problem.checks());
    let collision = checks.collision();
    let collides = |q: &[f64]| collision.collides(&tree.link_poses(q));
    let mut configurations = random(&problem, count.parse().unwrap());
    let borderline = borderline(&configurations, collides);
    configurations.extend(borderline);
    let answers = configurations.iter().map(|q| {
        let X_BL = tree.link_poses(q);
        json!({
            "q": q,
            "collides": collides(q),
            "gaps": collision.gaps(&X_BL).iter().map(|(_, gap)| gap).collect::<Vec<_>>(),
            "center_of_mass": tree.center_of_mass(&X_BL).map(|m| m.center.coords.as_slice().to_vec()),
        })
    });
    let document = json!({
        "problem": problem.name,
        "clearance": problem.clearance,
        "links": tree.links.iter().map(link).collect::<Value>(),
        "pairs": collision.links().tested.iter().map(|(pair, _)| pair).collect::<Vec<_>>(),
        "configurations": answers.collect::<Value>(),
    });
    println!("{document}");
}
