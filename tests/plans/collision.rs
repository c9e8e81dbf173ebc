//! What a pose may run into: the robot itself, the obstacles around it, and what is said where nothing is tested.

use std::path::Path;

use crate::desk::Desk;
use calipose::feasibility::{Rejection, View, feasible_views};
use calipose::problem::Problem;
use calipose::robot::{Shape, Tree};
use calipose::spatial::Pose;
use nalgebra::Vector3;
use serde_json::{Value, json};

/// A UR5 with a body on every link; that of its base is a plate of 2 m.
const CAPSULES: &str = include_str!("../data/ur5-capsules.toml");
/// A UR5 without any, above a board that lies on its table.
const WITHOUT_BODIES: &str = include_str!("../data/ur5-without-bodies.toml");

fn load(text: &str) -> Problem {
    let text = text.replace("[selection]\n", "[selection]\noff_grid = false\n");
    Problem::parse(&text, Path::new("problem.toml")).map_err(miette::Report::new).unwrap()
}

/// `text` with a scene, a small plate, less of a sample, and no clearance but what `scene` says.
fn with_scene(text: &str, scene: &str) -> Problem {
    let text = text.replace("sample = 200_000", "sample = 20_000").replace("[collision]\nclearance_mm = 10\n", "");
    let text = text.replace("box_mm = [2000, 2000, 20]", "box_mm = [150, 150, 20]");
    load(&text.replace("[sweep]", &format!("{scene}\n[sweep]")))
}

fn views(problem: &Problem) -> (Vec<View>, [usize; Rejection::ALL.len()]) {
    let all = (0..problem.space.len()).collect();
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
            assert_eq!(checks.view(view.id, &view.q), Err(Rejection::SceneCollision));
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

/// A desk with `text` as `arm.toml`, swept coarsely for a few poses, with a scene.
fn desk(text: &str, scene: &str) -> Desk {
    let desk = Desk::new();
    let text = text.replace("sample = 200_000", "sample = 20_000").replace("count = 15", "count = 4");
    std::fs::write(desk.path("arm.toml"), text.replace("[sweep]", &format!("{scene}\n[sweep]"))).unwrap();
    desk
}

fn plan_json(desk: &Desk) -> Value {
    serde_json::from_str(&std::fs::read_to_string(desk.path("out/plan.json")).unwrap()).unwrap()
}

#[test]
fn check_and_plan_say_that_nothing_is_tested_where_nothing_has_a_body() {
    let arm = desk(WITHOUT_BODIES, "");
    let said = "Collision: NOT tested (no bodies)";
    assert!(arm.prose("check arm.toml").contains(said));
    let text = arm.prose("plan arm.toml -o out --trials 0 --set selection.off_grid=false");
    assert!(text.contains(said) && text.contains("[[scene.bodies]]"), "{text}");
    assert!(!text.contains("can be taken"), "{text}");
    let document = &plan_json(&arm)["collision"];
    assert_eq!((&document["tested"], &document["scene"]), (&json!(false), &json!([])));
    assert_eq!(document["joints_without_bodies"].as_array().unwrap().len(), 6);
    assert_eq!(arm.json("check arm.toml --json")["collision"], *document);
    assert_eq!(
        arm.json("plan arm.toml -o out --trials 0 --set selection.off_grid=false --json")["collision"],
        *document
    );
    // A table alone is touched by nothing that has a body.
    let table = desk(
        WITHOUT_BODIES,
        "[[scene.bodies]]\nname = \"table\"\nbox_mm = [2000, 2000, 20]\npose = { position_mm = [0, 0, -15] }",
    );
    let text = table.prose("plan arm.toml -o out --trials 0 --set selection.off_grid=false");
    assert!(text.contains("Collision: NOT tested (the robot has no bodies): table"), "{text}");
    assert_eq!(plan_json(&table)["collision"]["tested"], false);
}

#[test]
fn cells_that_are_not_modelled_are_said_to_be_so_until_there_are_obstacles() {
    let capsules =
        CAPSULES.replace("clearance_mm = 10", "clearance_mm = 1").replace("[2000, 2000, 20]", "[150, 150, 20]");
    let said = "The cell is NOT modelled: add [[scene.bodies]]";
    let bare = desk(&capsules, "");
    assert!(bare.prose("check arm.toml").contains(said));
    assert!(bare.prose("plan arm.toml -o out --trials 0 --set selection.off_grid=false").contains(said));
    assert_eq!(plan_json(&bare)["collision"]["scene"], json!([]));
    let table = "[[scene.bodies]]\nname = \"table\"\nbox_mm = [2000, 2000, 20]\npose = { position_mm = [0, 0, -15] }";
    let cell =
        desk(&capsules.replace("[[robot.bodies]]\nlink = \"elbow_joint\"", "[[robot.bodies]]\nlink = \"base\""), table);
    let text = cell.prose("plan arm.toml -o out --trials 0 --set selection.off_grid=false");
    assert!(
        !text.contains(said) && text.contains("against each other, the board and table, clearance 1.000 mm"),
        "{text}"
    );
    // What is left out is said, in the file too.
    assert!(text.contains("NOT tested, because always in contact: shoulder_pan_joint–table"), "{text}");
    assert!(text.contains("NOT tested, because without bodies: the parts moved by elbow_joint."), "{text}");
    let expected = json!({
        "tested": true,
        "clearance_m": 0.001,
        "scene": ["table"],
        "joints_without_bodies": ["elbow_joint"],
        "always_in_contact": [["shoulder_pan_joint", "table"]],
    });
    assert_eq!(plan_json(&cell)["collision"], expected);
    assert_eq!(cell.json("check arm.toml --json")["collision"], expected);
}

#[test]
fn refusals_name_the_pairs_that_are_always_within_the_clearance_and_the_remedy() {
    let arm = desk(CAPSULES, "");
    let remedy = "if they cannot touch, `ignore = [[\"wrist_1_joint\", \"wrist_3_joint\"]]` under [collision]";
    let text = arm.prose("check arm.toml");
    assert!(text.contains("within the clearance of 10.00 mm in every one of 1000 random configurations"), "{text}");
    assert!(text.contains(remedy), "{text}");
    let close = &arm.json("check arm.toml --json")["self_collision"]["always_within_clearance"];
    assert_eq!(close[0]["links"], json!(["wrist_1_joint", "wrist_3_joint"]));
    assert!(close[0]["farthest_mm"].as_f64().unwrap() < 10.0);
    let words = arm.complaint("plan arm.toml -o out", 1);
    assert!(words.contains("within the clearance in all") && words.contains(remedy), "{words}");
    assert!(words.contains("if they can, a clearance_mm below "), "{words}");
    // The remedies work.
    let ignored = "clearance_mm = 10\nignore = [[\"wrist_1_joint\", \"wrist_3_joint\"]]";
    let helped =
        desk(&CAPSULES.replace("clearance_mm = 10", ignored).replace("[2000, 2000, 20]", "[150, 150, 20]"), "");
    let text = helped.prose("plan arm.toml -o out --trials 0 --set selection.off_grid=false");
    assert!(!text.contains("Hardly any configuration can pass"), "{text}");
}

#[test]
fn reach_tells_which_links_its_configurations_bring_together() {
    let look = "reach arm.toml --distance-mm 400 --tilt-deg 20 -n 8";
    let free = desk(WITHOUT_BODIES, "");
    assert!(free.prose(look).contains("Collision: NOT tested (no bodies)"));
    assert_eq!(free.json(&format!("{look} --json"))["collision_tested"], false);
    // A floor 150 mm up, in which the shoulder always is.
    let floor = FLOOR.replace("-2001", "-1850");
    let problem = with_scene(CAPSULES, &floor);
    let capsules = CAPSULES.replace("[2000, 2000, 20]", "[150, 150, 20]").replace("clearance_mm = 10", "");
    let arm = desk(&capsules, &floor);
    let document = arm.json(&format!("{look} --json"));
    let found = document["configurations"].as_array().unwrap();
    let into_the_floor = |q: &[f64]| lowest_of(&problem.robot.tree, &MOVING[1..], q) < 0.15;
    let mut deep = 0;
    for configuration in found {
        let q: Vec<f64> = serde_json::from_value(configuration["joints_rad"].clone()).unwrap();
        deep += usize::from(into_the_floor(&q));
        assert!(!into_the_floor(&q) || configuration["collision"].is_array(), "{configuration}");
    }
    assert!(deep > 0 && found.iter().any(|configuration| configuration["collision"].is_null()), "{document}");
    assert!(arm.prose(look).contains("–floor"));
}

#[test]
fn check_says_which_way_is_up_in_the_picture() {
    let arm = desk(WITHOUT_BODIES, "");
    let text = arm.prose("check arm.toml");
    // All at 0: the arm is stretched along −x, and its last z points along −y.
    let said = "Camera: on the flange it looks along +z, up in the picture is -y; with every joint mid-range it looks along -y of the base, \
                up is ";
    assert!(text.contains(said), "{text}");
    let mounted = desk(
        &WITHOUT_BODIES.replace("mount = { position_mm = [0, -60, 30], rpy_deg = [0, 0, 0] }", "mount = \"ros-body\""),
        "",
    );
    assert!(mounted.prose("check arm.toml").contains("looks along +x, up in the picture is +z"));
    let camera = &mounted.json("check arm.toml --json")["camera"]["on_flange"];
    let near =
        |value: &Value, expected: [f64; 3]| (0..3).all(|i| (value[i].as_f64().unwrap() - expected[i]).abs() < 1e-12);
    assert!(near(&camera["looks_along"], [1.0, 0.0, 0.0]) && near(&camera["up"], [0.0, 0.0, 1.0]), "{camera}");
}
