//! Prints a problem's links, bodies and masses, and what calipose says of random configurations, as one JSON document for
//! `tests/cross_check/self_collision.py`: `cargo run --release --example feasibility_dump -- FILE COUNT`.

#![allow(non_snake_case, clippy::unwrap_used, clippy::print_stdout, reason = "an example")]

use std::path::Path;

use calipose::problem::Problem;
use calipose::robot::{Body, JointKind, Link, Motion, Shape};
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
        Shape::Convex { points } => ("convex", points.iter().map(|p| json!(p.coords.as_slice())).collect()),
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

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, count] = &arguments[..] else { panic!("usage: feasibility_dump FILE COUNT") };
    let problem = Problem::read(Path::new(file)).map_err(miette::Report::new).unwrap();
    let (tree, checks) = (&problem.robot.tree, problem.checks());
    let collision = checks.collision();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(20);
    let configurations = (0..count.parse().unwrap()).map(|_| {
        let limits = problem.robot.chain.joints.iter().map(|joint| joint.limits);
        let q: Vec<f64> = limits.map(|limits| rng.gen_range(limits.min..=limits.max)).collect();
        let X_BL = tree.link_poses(&q);
        json!({
            "q": q,
            "collides": collision.collides(&X_BL),
            "gaps": collision.gaps(&X_BL).iter().map(|(_, gap)| gap).collect::<Vec<_>>(),
            "center_of_mass": tree.center_of_mass(&X_BL).map(|m| m.center.coords.as_slice().to_vec()),
        })
    });
    let configurations: Vec<Value> = configurations.collect();
    let document = json!({
        "problem": problem.name,
        "clearance": problem.clearance,
        "links": tree.links.iter().map(link).collect::<Value>(),
        "pairs": collision.links().tested.iter().map(|(pair, _)| pair).collect::<Vec<_>>(),
        "configurations": configurations,
    });
    println!("{document}");
}
