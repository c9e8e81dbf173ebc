//! What a pose may run into: the robot itself, the obstacles around it, and what is said where nothing is tested.

#![allow(non_snake_case, clippy::unwrap_used)]

use std::path::Path;

use calipose::feasibility::{Rejection, View, feasible_views};
use calipose::problem::Problem;
use calipose::robot::{Shape, Tree};
use calipose::spatial::Pose;
use nalgebra::Vector3;

/// A UR5 with a body on every link; that of its base is a plate of 2 m.
const CAPSULES: &str = include_str!("data/ur5-capsules.toml");
/// A UR5 without any, above a board that lies on its table.
const WITHOUT_BODIES: &str = include_str!("data/ur5-without-bodies.toml");

fn load(text: &str) -> Problem {
    Problem::parse(text, Path::new("problem.toml")).map_err(miette::Report::new).unwrap()
}

/// `text` with a scene, a small plate, less of a sample, and no clearance but what `scene` says.
fn with_scene(text: &str, scene: &str) -> Problem {
    let text = text.replace("sample = 200_000", "sample = 20_000").replace("[collision]\nclearance_mm = 10\n", "");
    let text = text.replace("box_mm = [2000, 2000, 20]", "box_mm = [150, 150, 20]");
    load(&text.replace("[sweep]", &format!("{scene}\n[sweep]")))
}

fn views(problem: &Problem) -> (Vec<View>, [usize; Rejection::ALL.len()]) {
    let all: Vec<usize> = (0..problem.space.len()).collect();
    feasible_views(&problem.checks(), &problem.space, &all)
}

/// A box of 4 m with its upper side at z = −1 mm.
const FLOOR: &str =
    "[[scene.bodies]]\nname = \"floor\"\nbox_mm = [4000, 4000, 4000]\npose = { position_mm = [0, 0, -2001] }";

/// Height in m of the lowest point of a shape at `X_BG`.
fn lowest(shape: &Shape, X_BG: &Pose) -> f64 {
    let axis = X_BG.rotation * Vector3::z();
    let below = match shape {
        Shape::Box { half_extents } => (0..3).map(|i| (X_BG.rotation * Vector3::ith(i, half_extents[i])).z.abs()).sum(),
        Shape::Cylinder { radius, length } => axis.z.abs() * length / 2.0 + radius * axis.x.hypot(axis.y),
        Shape::Capsule { radius, length } => axis.z.abs() * length / 2.0 + radius,
        Shape::Sphere { radius } => *radius,
        Shape::Convex { .. } => f64::NAN,
    };
    X_BG.translation.vector.z - below
}

/// Height in m of the lowest point of the links called `names`, at joint values `q`.
fn lowest_of(tree: &Tree, names: &[&str], q: &[f64]) -> f64 {
    let links = tree.links.iter().zip(tree.link_poses(q)).filter(|(link, _)| names.contains(&link.name.as_str()));
    let bodies =
        links.flat_map(|(link, X_BL)| link.bodies.iter().map(move |body| lowest(&body.shape, &(X_BL * body.X_LG))));
    bodies.fold(f64::INFINITY, f64::min)
}

const MOVING: [&str; 6] =
    ["shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint", "camera"];

#[test]
fn no_link_is_nearer_to_an_obstacle_than_the_clearance_and_none_is_rejected_that_is_not() {
    let (free, before) = views(&with_scene(CAPSULES, ""));
    for clearance in [0.0, 0.002] {
        let collision = format!("[collision]\nclearance_mm = {}", 1e3 * clearance);
        let free: Vec<View> = if clearance == 0.0 { free.clone() } else { views(&with_scene(CAPSULES, &collision)).0 };
        let problem = with_scene(CAPSULES, &format!("{FLOOR}\n{collision}"));
        let checks = problem.checks();
        let links = checks.collision().links();
        let number = |name: &str| problem.robot.tree.links.iter().position(|link| link.name == name).unwrap();
        // The shoulder's own capsule reaches through the plate: its model overlaps where the robot does not.
        assert_eq!(links.always, [[number("shoulder_pan_joint"), number("floor")]]);
        // The base stands on the floor, the board lies on it.
        assert!(
            [[0, number("floor")], [number("floor"), number("board")]].iter().all(|pair| links.adjacent.contains(pair))
        );
        let (left, rejected) = views(&problem);
        let height = |view: &View| lowest_of(&problem.robot.tree, &MOVING, &view.q) + 0.001 - clearance;
        let above: Vec<&View> = free.iter().filter(|view| height(view) > 0.0).collect();
        assert!(free.iter().all(|view| height(view).abs() > 1e-6));
        assert_eq!(left.iter().collect::<Vec<_>>(), above);
        for view in free.iter().filter(|view| height(view) < 0.0) {
            assert_eq!(checks.view(view.id, view.q.clone()), Err(Rejection::SceneCollision));
        }
        let scene = rejected[Rejection::SceneCollision as usize];
        assert!(!left.is_empty() && scene >= free.len() - left.len() && free.len() > left.len() + 5, "{rejected:?}");
        if clearance == 0.0 {
            // What the robot does to itself is counted first, as without obstacles.
            assert_eq!(rejected[..Rejection::SceneCollision as usize], before[..Rejection::SceneCollision as usize]);
        }
    }
}

#[test]
fn obstacles_hide_the_board_even_from_arms_without_bodies() {
    let (free, _) = views(&with_scene(WITHOUT_BODIES, ""));
    let lid = "[[scene.bodies]]\nname = \"lid\"\nbox_mm = [300, 220, 1]\npose = { position_mm = [-500, 0, 50] }";
    let problem = with_scene(WITHOUT_BODIES, lid);
    let (left, rejected) = views(&problem);
    assert_eq!(rejected[Rejection::Occluded as usize], free.len() - left.len());
    // Only a camera under the lid sees the whole board.
    assert!(left.iter().all(|view| view.X_BC.translation.z < 0.3) && left.len() * 20 < free.len(), "{}", left.len());
}

/// A camera that has no housing is a point, which no solid need touch: it must not see out of an obstacle that it is in.
#[test]
fn cameras_in_an_obstacle_see_nothing() {
    let (free, _) = views(&with_scene(WITHOUT_BODIES, ""));
    let block = "[[scene.bodies]]\nname = \"block\"\nbox_mm = [4000, 4000, 1000]\npose = { position_mm = [0, 0, 800] }";
    let (left, _) = views(&with_scene(WITHOUT_BODIES, block));
    let below: Vec<usize> = free.iter().filter(|view| view.X_BC.translation.z < 0.3).map(|view| view.id).collect();
    assert_eq!(left.iter().map(|view| view.id).collect::<Vec<_>>(), below);
    assert!(!below.is_empty() && below.len() < free.len());
}

#[test]
fn solids_of_one_name_are_one_obstacle_in_the_base_frame() {
    let scene = "[[scene.bodies]]\nname = \"table\"\nbox_mm = [1200, 800, 40]\npose = { position_mm = [0, 0, -20] }\n\
                 [[scene.bodies]]\nname = \"post\"\nsphere_mm = 50\npose = { position_mm = [0, 400, 500], rpy_deg = [0, 0, 90] }\n\
                 [[scene.bodies]]\nname = \"table\"\ncylinder_mm = [30, 700]\npose = { position_mm = [0, 0, -390] }\n\
                 [collision]\nignore = [[\"table\", \"wrist_3_joint\"], [\"post\", \"camera\"]]";
    let problem = with_scene(CAPSULES, scene);
    let tree = &problem.robot.tree;
    let obstacles: Vec<&str> = problem.robot.obstacles.iter().map(|&i| tree.links[i].name.as_str()).collect();
    assert_eq!(obstacles, ["table", "post"]);
    let table = &tree.links[problem.robot.obstacles[0]];
    assert_eq!(table.bodies.len(), 2);
    assert_eq!(table.bodies[0].shape, Shape::Box { half_extents: Vector3::new(0.6, 0.4, 0.02) });
    assert_eq!(table.bodies[1].X_LG, Pose::translation(0.0, 0.0, -0.39));
    // Wherever the arm is.
    for q in [[0.0; 6], [0.3; 6]] {
        assert!(problem.robot.obstacles.iter().all(|&i| tree.link_poses(&q)[i] == Pose::identity()));
    }
    let [table, post] = problem.robot.obstacles[..] else { panic!() };
    let number = |name: &str| tree.links.iter().position(|link| link.name == name).unwrap();
    let ignored = [[number("wrist_3_joint"), table], [number("camera"), post]];
    assert_eq!(problem.checks().collision().links().disabled, ignored);
}

#[test]
fn pairs_always_within_the_clearance_are_told_with_their_distances() {
    let problem = load(CAPSULES);
    let checks = problem.checks();
    let links = checks.collision().links();
    let name = |i: usize| problem.robot.tree.links[i].name.as_str();
    let close: Vec<_> = links.close.iter().map(|close| close.links.map(name)).collect();
    assert_eq!(close, [["wrist_1_joint", "wrist_3_joint"]]);
    // They are tested all the same, and what they reject is not worth a pose.
    assert!(links.tested.contains(&(links.close[0].links, 1.0)));
    assert_eq!(views(&with_scene(CAPSULES, "[collision]\nclearance_mm = 10")).0.len(), 0);
    let (nearest, farthest) = (links.close[0].nearest, links.close[0].farthest);
    assert!(0.0 < nearest && nearest <= farthest && farthest < 0.01, "{nearest} {farthest}");
    // Below their distance they pass.
    let below = with_scene(CAPSULES, &format!("[collision]\nclearance_mm = {}", 999.0 * farthest));
    assert_eq!(below.checks().collision().links().close, []);
    assert!(views(&below).0.len() > 5);
}
