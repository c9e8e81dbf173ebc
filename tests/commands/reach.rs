//! Inverse kinematics inverts forward kinematics, within the joint limits; what cannot be reached is said not to be.

use std::path::Path;

use calipose::plan::assess::reach_starts;
use calipose::problem::Problem;
use calipose::robot::{ReachSettings, reach};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde_json::Value;

use crate::desk::{command, text};

fn problem(name: &str) -> Problem {
    Problem::read(&Path::new("problems").join(name)).map_err(miette::Report::new).unwrap()
}

/// Random configurations within the limits, drawn without regard to the starts.
fn random_configurations(problem: &Problem, count: usize) -> Vec<Vec<f64>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(20_240_517);
    let joints = &problem.robot.chain.joints;
    let mut q = || joints.iter().map(|joint| rng.gen_range(joint.limits.min..=joint.limits.max)).collect();
    (0..count).map(|_| q()).collect()
}

/// FK(IK(X)) = X for poses that some configuration takes.
fn assert_inverts(name: &str, count: usize) {
    let problem = problem(name);
    let robot = &problem.robot;
    let starts = reach_starts(&problem);
    // Where these starts do not suffice, more are taken.
    let settings = ReachSettings { starts: 16, ..ReachSettings::default() };
    for q in random_configurations(&problem, count) {
        let requested = robot.camera_pose(&q);
        let found = reach(robot, &requested, &starts, &settings);
        assert!(found.iter().all(|end| end.reached), "{name}: {q:?}, nearest {found:?}");
        for (i, end) in found.iter().enumerate() {
            let X_BC = robot.camera_pose(&end.q);
            assert!((X_BC.translation.vector - requested.translation.vector).norm() < 1e-6);
            assert!(X_BC.rotation.angle_to(&requested.rotation) < 1e-6);
            for (joint, q) in robot.chain.joints.iter().zip(&end.q) {
                assert!((joint.limits.min..=joint.limits.max).contains(q));
            }
            assert!(i == 0 || end.limit_margin <= found[i - 1].limit_margin);
        }
    }
}

#[test]
fn six_axes() {
    assert_inverts("six-axis-rover.toml", 100);
}

#[test]
fn seven_axes() {
    assert_inverts("seven-axis-carrier.toml", 100);
}

/// Four joints reach only a part of all poses, but what they take they find again.
#[test]
fn servosila() {
    assert_inverts("servosila-engineer.toml", 100);
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn many_configurations_of_every_arm() {
    for arm in ["servosila-engineer.toml", "six-axis-rover.toml", "seven-axis-carrier.toml"] {
        assert_inverts(arm, 1000);
    }
}

#[test]
fn many_ways_lead_to_most_poses_of_six_axes() {
    let problem = problem("six-axis-rover.toml");
    let starts = reach_starts(&problem);
    let ways =
        |q: &Vec<f64>| reach(&problem.robot, &problem.robot.camera_pose(q), &starts, &ReachSettings::default()).len();
    let several = random_configurations(&problem, 50).iter().filter(|q| ways(q) > 1).count();
    assert!(several > 40, "{several}");
}

fn calipose(line: &str) -> (Option<i32>, String, String) {
    let output = command(Path::new("."), line).output().unwrap();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn the_command_looks_at_the_board_as_told() {
    let line = "reach problems/six-axis-rover.toml --distance-mm 450 --tilt-deg 20 --azimuth-deg -30 --roll-deg 15";
    let (code, stdout, stderr) = calipose(&format!("{line} --json"));
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    let document: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&document["format"], &document["reached"]), (&"calipose.reach".into(), &true.into()));
    let problem = problem("six-axis-rover.toml");
    let q: Vec<f64> = serde_json::from_value(document["configurations"][0]["joints_rad"].clone()).unwrap();
    let X_TC = problem.target.X_BT.inverse() * problem.robot.camera_pose(&q);
    let expected = calipose::target::viewpoint(0.45, 20f64.to_radians(), -30f64.to_radians(), 15f64.to_radians());
    assert!((X_TC.translation.vector - expected.translation.vector).norm() < 1e-6);
    assert!(X_TC.rotation.angle_to(&expected.rotation) < 1e-6);
    // The same request, as a pose.
    let list = |key: &str, factor: f64| {
        let numbers: Vec<f64> = serde_json::from_value(document["requested"][key].clone()).unwrap();
        numbers.iter().map(|x| (x * factor).to_string()).collect::<Vec<_>>().join(",")
    };
    let (position, quaternion) = (list("position_m", 1e3), list("quaternion_xyzw", 1.0));
    let (code, stdout, _) = calipose(&format!(
        "reach problems/six-axis-rover.toml --position-mm {position} --quaternion-xyzw {quaternion}"
    ));
    assert_eq!(code, Some(0));
    assert!(stdout.contains("take") && stdout.contains("wrist_pitch"), "{stdout}");
}

#[test]
fn the_command_says_what_it_cannot_reach() {
    let (code, stdout, stderr) =
        calipose("reach problems/six-axis-rover.toml --position-mm 3000,0,1000 --rpy-deg 180,0,0");
    assert_eq!(code, Some(4));
    assert!(stdout.contains("no configuration found takes the pose; the nearest"), "{stdout}");
    assert!(stderr.contains("no configuration found within the joint limits takes the pose"), "{stderr}");
    let (code, _, stderr) = calipose("reach problems/servosila-engineer.toml --distance-mm 600 --tilt-deg 20");
    assert_eq!(code, Some(4));
    assert!(stderr.contains("an arm with 4 joints takes few poses exactly"), "{stderr}");
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    for request in [
        "",
        "--distance-mm 0",
        "--distance-mm nan",
        "--distance-mm 500 --tilt-deg 90",
        "--distance-mm 500 --rpy-deg 0,0,0",
        "--position-mm 1,2,3",
        "--position-mm 1,2 --rpy-deg 0,0,0",
        "--position-mm 1,2,x --rpy-deg 0,0,0",
        "--position-mm 1,2,inf --rpy-deg 0,0,0",
        "--position-mm 1,2,3 --rpy-deg 0,0,0 --tilt-deg 5",
        "--position-mm 1,2,3 --quaternion-xyzw 0,0,0,2",
        "--position-mm 1,2,3 --quaternion-xyzw 0,0,0,1 --rpy-deg 0,0,0",
        "--distance-mm 500 --count 0",
    ] {
        let (code, stdout, stderr) = calipose(&format!("reach problems/six-axis-rover.toml {request}"));
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{request}: {stderr}");
    }
}
