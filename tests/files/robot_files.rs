//! Robots from URDF and SRDF files: what they mean, and that every mistake is named with its line and element.

use std::f64::consts::PI;
use std::path::Path;

use calipose::feasibility::feasible_views;
use calipose::formats::{Description, read_srdf, read_urdf};
use calipose::problem::{Problem, draft};
use calipose::robot::{JointKind, Motion, Shape, Stage};
use calipose::spatial::Pose;
use calipose::sweep::sweep;
use calipose::target::AxisCase;
use miette::{GraphicalReportHandler, GraphicalTheme};
use nalgebra::{Point3, Vector3};

/// A right description; each case changes it in one place.
const RIGHT: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="base">
    <inertial><mass value="10"/></inertial>
    <collision><geometry><box size="0.2 0.4 0.6"/></geometry></collision>
  </link>
  <joint name="turn" type="revolute">
    <parent link="base"/>
    <child link="column"/>
    <origin xyz="0 0 0.3" rpy="0 0 1.5707963267948966"/>
    <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="10" velocity="1.5"/>
  </joint>
  <link name="column">
    <inertial><origin xyz="0 0 0.1"/><mass value="2.5"/></inertial>
    <collision><origin xyz="0 0 0.2"/><geometry><mesh filename="column.stl" scale="2 2 -2"/></geometry></collision>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="column"/>
    <child link="tool"/>
    <axis xyz="0.6 0 0.8"/>
    <limit lower="0.1" upper="0.5" effort="10" velocity="0"/>
  </joint>
  <link name="tool">
    <collision><geometry><capsule radius="0.02" length="0.1"/></geometry></collision>
  </link>
  <joint name="finger" type="prismatic">
    <parent link="tool"/>
    <child link="fingertip"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/>
    <mimic joint="slide" multiplier="-0.5" offset="0.01"/>
  </joint>
  <link name="fingertip">
    <collision><geometry><sphere radius="0.01"/></geometry></collision>
  </link>
  <joint name="wheel_joint" type="continuous">
    <parent link="base"/>
    <child link="wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="wheel">
    <collision><geometry><cylinder radius="0.1" length="0.05"/></geometry></collision>
  </link>
</robot>
"#;

const ASCII_STL: &str = "solid column\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 0\n\
                         endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0 0.1\n\
                         endloop\nendfacet\nendsolid\n";

/// Name, what to replace (must occur once), and the replacement.
const WRONG: &[(&str, &str, &str)] = &[
    ("broken XML", "</robot>", "</robo>"),
    ("xacro element", "<joint name=\"turn\"", "<xacro:macro name=\"m\"/><joint name=\"turn\""),
    (
        "xacro element, declared",
        "<robot name=\"arm\">",
        "<robot name=\"arm\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:include filename=\"a.xacro\"/>",
    ),
    ("xacro value", "lower=\"-2\"", "lower=\"${-pi / 2}\""),
    ("xacro argument", "\"column.stl\"", "\"$(find arm)/column.stl\""),
    ("loop with the root", "<child link=\"wheel\"/>", "<child link=\"base\"/>"),
    ("loop apart", "<parent link=\"column\"/>", "<parent link=\"fingertip\"/>"),
    ("two parents", "<child link=\"wheel\"/>", "<child link=\"tool\"/>"),
    ("two roots", "<link name=\"wheel\">", "<link name=\"stray\"/><link name=\"wheel\">"),
    ("unknown parent", "<parent link=\"tool\"/>", "<parent link=\"tol\"/>"),
    ("unknown child", "<child link=\"tool\"/>", "<child link=\"tol\"/>"),
    ("link twice", "<link name=\"wheel\">", "<link name=\"tool\"/><link name=\"wheel\">"),
    ("joint twice", "<joint name=\"slide\"", "<joint name=\"turn\""),
    ("link without a name", "<link name=\"wheel\">", "<link/><link name=\"wheel\">"),
    ("joint with an empty name", "<joint name=\"slide\"", "<joint name=\" \""),
    ("no parent", "<parent link=\"column\"/>", ""),
    ("no type", "<joint name=\"slide\" type=\"prismatic\"", "<joint name=\"slide\""),
    ("floating", "type=\"continuous\"", "type=\"floating\""),
    ("limits reversed", "lower=\"-2\"", "lower=\"3\""),
    (
        "soft limits beside the limits",
        "upper=\"2\" effort=\"10\" velocity=\"1.5\"/>",
        "upper=\"2\"/><safety_controller soft_lower_limit=\"3\" soft_upper_limit=\"4\"/>",
    ),
    ("negative velocity", "velocity=\"1.5\"", "velocity=\"-1.5\""),
    ("not a number", "lower=\"-2\"", "lower=\"NaN\""),
    ("infinite", "xyz=\"0 0 0.3\"", "xyz=\"0 0 inf\""),
    ("two of three numbers", "xyz=\"0 0 0.3\"", "xyz=\"0 0\""),
    ("a word for a number", "value=\"2.5\"", "value=\"heavy\""),
    ("zero axis", "xyz=\"0.6 0 0.8\"", "xyz=\"0 0 0\""),
    ("mimic of an unknown joint", "mimic joint=\"slide\"", "mimic joint=\"slid\""),
    ("mimic of itself", "mimic joint=\"slide\"", "mimic joint=\"finger\""),
    (
        "mimic loop",
        "<limit lower=\"0.1\" upper=\"0.5\" effort=\"10\" velocity=\"0\"/>",
        "<limit lower=\"0\" upper=\"1\"/><mimic joint=\"finger\"/>",
    ),
    ("mimic of a fixed joint", "<joint name=\"slide\" type=\"prismatic\">", "<joint name=\"slide\" type=\"fixed\">"),
    ("negative mass", "value=\"2.5\"", "value=\"-2.5\""),
    ("inertial without a mass", "<mass value=\"10\"/>", ""),
    ("negative radius", "radius=\"0.01\"", "radius=\"-0.01\""),
    ("no length", "radius=\"0.1\" length=\"0.05\"", "radius=\"0.1\""),
    ("unknown shape", "<sphere radius=\"0.01\"/>", "<cone radius=\"0.01\"/>"),
    ("two shapes", "<sphere radius=\"0.01\"/>", "<sphere radius=\"0.01\"/><sphere radius=\"0.02\"/>"),
    ("zero scale", "scale=\"2 2 -2\"", "scale=\"2 0 2\""),
    ("missing mesh", "\"column.stl\"", "\"package://arm/none.stl\""),
    ("mesh outside the folders", "\"column.stl\"", "\"../outside.stl\""),
    ("mesh on the web", "\"column.stl\"", "\"https://example.org/column.stl\""),
    ("mesh of an unknown format", "\"column.stl\"", "\"robot.urdf\""),
    ("mesh with a mistake", "\"column.stl\"", "\"broken.stl\""),
];

/// A folder with the description `urdf`, its meshes, and a file outside that folder.
fn folder(urdf: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("robot")).unwrap();
    for (name, text) in [
        ("robot/robot.urdf", urdf),
        ("robot/column.stl", ASCII_STL),
        ("robot/broken.stl", "solid\nvertex 0 0 one\n"),
        ("outside.stl", ASCII_STL),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn a_description_means_what_it_says() {
    let folder = folder(RIGHT);
    let Description { mechanism, stuck, notes, .. } = read_urdf(RIGHT, &folder.path().join("robot"), &[]).unwrap();
    assert!(stuck.is_empty() && notes.is_empty());
    let names: Vec<&str> = mechanism.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["turn", "slide", "wheel_joint"]);
    assert_eq!(mechanism.followers, ["finger"]);
    let [turn, slide, wheel] = &mechanism.joints[..] else { panic!() };
    assert_eq!((turn.kind, turn.limits.max, turn.max_speed), (JointKind::Revolute, 2.0, Some(1.5)));
    assert_eq!((slide.kind, slide.limits.min, slide.max_speed), (JointKind::Prismatic, 0.1, None));
    assert_eq!((wheel.limits.min, wheel.limits.max, wheel.max_speed), (-PI, PI, None));

    let links = &mechanism.tree.links;
    let names: Vec<&str> = links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!(names, ["base", "column", "tool", "fingertip", "wheel"]);
    assert_eq!(links.iter().map(|link| link.parent).collect::<Vec<_>>(), [None, Some(0), Some(1), Some(2), Some(0)]);
    assert_eq!(links[0].bodies[0].shape, Shape::Box { half_extents: Vector3::new(0.1, 0.2, 0.3) });
    assert_eq!(links[2].bodies[0].shape, Shape::Capsule { radius: 0.02, length: 0.1 });
    assert_eq!(links[4].bodies[0].shape, Shape::Cylinder { radius: 0.1, length: 0.05 });
    let Shape::Convex { points, margin: 0.0 } = &links[1].bodies[0].shape else { panic!() };
    assert_eq!(points.len(), 4);
    assert!(points.contains(&Point3::new(0.0, 0.0, -0.2)));
    assert_eq!(links[2].mass, None);
    assert!(matches!(links[3].motion, Motion::Driven { joint: 1, multiplier: -0.5, offset: 0.01, .. }));

    // By hand: the column turned by a right angle and q, the tool 0.2 m along its (0.6, 0, 0.8), the finger −0.09 m along x.
    let X_BL = mechanism.tree.link_poses(&[0.0, 0.2, 0.0]);
    assert!((X_BL[3].translation.vector - Vector3::new(0.0, 0.12 - 0.09, 0.3 + 0.16)).norm() < 1e-15);
    let center = mechanism.tree.center_of_mass(&X_BL).unwrap();
    assert_eq!(center.mass, 12.5);
    assert!((center.center - Point3::new(0.0, 0.0, 0.08)).norm() < 1e-15);
}

#[test]
fn every_mistake_is_named_with_its_line_and_element() {
    let whole = |text: &str| read_urdf(text, Path::new("."), &[]).unwrap_err();
    let mut messages = vec![
        format!("empty: {}", whole("")),
        format!("not a robot: {}", whole("<sdf version=\"1.7\"/>")),
        format!("no links: {}", whole("<robot name=\"arm\"/>")),
    ];
    for (name, right, wrong) in WRONG {
        assert_eq!(RIGHT.matches(right).count(), 1, "{name}");
        let text = RIGHT.replace(right, wrong);
        let folder = folder(&text);
        // What is wrong with the motion of a single joint matters only where that joint is on the arm.
        let error = match read_urdf(&text, &folder.path().join("robot"), &[]) {
            Ok(description) => description.stuck.first().expect(name).1.clone(),
            Err(error) => error,
        };
        messages.push(format!("{name}: {}", error.to_string().replace(&*folder.path().to_string_lossy(), "FOLDER")));
    }
    insta::assert_snapshot!(messages.join("\n"));
}

#[test]
fn descriptions_cut_short_give_an_answer() {
    let folder = folder(RIGHT);
    for end in (0..RIGHT.len()).step_by(7) {
        assert!(read_urdf(&RIGHT[..end], &folder.path().join("robot"), &[]).is_err() || end + 8 > RIGHT.len());
    }
}

#[test]
fn pairs_that_are_never_tested() {
    let folder = folder(RIGHT);
    let tree = read_urdf(RIGHT, &folder.path().join("robot"), &[]).unwrap().mechanism.tree;
    let srdf = |pairs: &str| format!("<robot name=\"arm\">\n<group name=\"g\"/>\n{pairs}</robot>");
    let text = srdf(
        "<disable_collisions link1=\"tool\" link2=\"base\" reason=\"Never\"/>\n\
         <disable_collisions link1=\"base\" link2=\"column\" reason=\"Adjacent\"/>\n\
         <disable_collisions link1=\"base\" link2=\"tool\"/>\n",
    );
    assert_eq!(read_srdf(&text, &tree), Ok((vec![[0, 1], [0, 2]], vec![])));
    // Links that this robot does not have, and one pair that it has.
    let strangers = "<disable_collisions link1=\"grip\" link2=\"base\"/>\n<disable_collisions link1=\"tool\" link2=\"grip\"/>\n\
                     <disable_collisions link1=\"base\" link2=\"tool\"/>\n";
    let (pairs, notes) = read_srdf(&srdf(strangers), &tree).unwrap();
    assert_eq!(pairs, [[0, 2]]);
    let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes, ["line 3: there is no link \"grip\"; its pairs are left out"]);
    let fail = |pairs: &str| read_srdf(&srdf(pairs), &tree).unwrap_err().to_string();
    insta::assert_snapshot!(
        [fail("<disable_collisions link1=\"tol\" link2=\"base\"/>"), fail("\n<disable_collisions link1=\"tool\"/>")].join("\n"),
        @r#"
    line 3: there is no link "tol"
    line 4: `link2` of <disable_collisions> is missing
    "#
    );
}

/// A problem whose robot section and target link are these, or how its faults are drawn.
fn problem(robot: &str, target: &str) -> Result<Problem, String> {
    problem_of(RIGHT, robot, target)
}

/// The same with the description `urdf`.
fn problem_of(urdf: &str, robot: &str, target: &str) -> Result<Problem, String> {
    let folder = folder(urdf);
    std::fs::write(
        folder.path().join("robot/other.srdf"),
        "<robot name='x'><disable_collisions link1='a' link2='b'/></robot>",
    )
    .unwrap();
    let text = format!(
        "[robot]\n{robot}\n[camera]\nwidth_px = 640\nheight_px = 480\nfx_px = 500\n\
         [target]\ncolumns = 4\nrows = 3\nsquare_mm = 30\npose = {{}}\n{target}\n"
    );
    Problem::parse(&text, &folder.path().join("arm.toml")).map_err(|error| {
        let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
            .with_width(110)
            .without_syntax_highlighting();
        let mut drawing = String::new();
        handler.render_report(&mut drawing, &error).unwrap();
        drawing.replace(&*folder.path().to_string_lossy(), "FOLDER")
    })
}

const URDF: &str = "urdf = \"robot/robot.urdf\"\n";

#[test]
fn problem_files_choose_the_arm() {
    let names = |problem: &Problem| {
        problem.robot.chain.joints.iter().map(|joint| joint.name.clone()).collect::<Vec<_>>().join(" ")
    };
    let from_base = problem(&format!("{URDF}camera_link = \"fingertip\""), "").unwrap();
    assert_eq!(names(&from_base), "turn slide");
    assert_eq!(from_base.robot.chain.stages.len(), 3);
    let from_wheel = problem(
        &format!(
            "{URDF}camera_link = \"tool\"\nbase_link = \"column\"\njoint_values_mm = {{ slide = 100 }}\n\
             limits_deg = {{ turn = [-90, 45], wheel_joint = [-30, 30] }}"
        ),
        "link = \"wheel\"",
    )
    .unwrap();
    assert_eq!(names(&from_wheel), "wheel_joint turn");
    let [wheel, turn] = &from_wheel.robot.chain.joints[..] else { panic!() };
    assert_eq!((wheel.limits.max, turn.limits.max), (30f64.to_radians(), 45f64.to_radians()));
    let links: Vec<&str> = from_wheel.robot.tree.links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!(links[0], "column");
    assert_eq!(links[from_wheel.robot.board_link], "wheel");
    assert_eq!(links[from_wheel.robot.camera_link], "tool");
    // The wheel turned back by q₀, the base below it, the column on that: by hand at q = (π/2, 0).
    let X_BC = from_wheel.robot.camera_pose(&[PI / 2.0, 0.0]);
    let slide = Vector3::new(0.0, 0.06, 0.08 + 0.3);
    assert!((X_BC.translation.vector - Vector3::new(-slide.z, slide.y, slide.x)).norm() < 1e-15, "{X_BC}");
}

/// The sweep's tables hold only for joints that drive stages side by side; for others it must find the same.
/// Obstacles stand in the frame of `base_link`, wherever the URDF's root is and whatever carries the board.
#[test]
fn obstacles_stand_in_the_frame_of_the_base_link() {
    let robot = "urdf = \"robot/robot.urdf\"\nbase_link = \"column\"\ncamera_link = \"tool\"\n\
                 [[scene.bodies]]\nname = \"post\"\nsphere_mm = 50\npose = { position_mm = [0, 400, 500] }";
    let problem = problem(robot, "link = \"wheel\"\n").unwrap();
    let tree = &problem.robot.tree;
    let [post] = problem.robot.obstacles[..] else { panic!() };
    assert_eq!((tree.links[post].name.as_str(), tree.links[post].parent), ("post", Some(0)));
    assert_eq!(tree.links[0].name, "column");
    let q = vec![0.3; problem.robot.chain.dof()];
    let (X_RL, X_BL) = (tree.link_poses(&q), problem.robot.link_poses(&q));
    let body = tree.links[post].bodies[0].X_LG;
    assert_eq!(X_RL[post] * body, Pose::translation(0.0, 0.4, 0.5));
    let seen_from_board = X_RL[problem.robot.board_link].inverse() * X_RL[0] * body;
    assert!(((X_BL[post] * body).to_homogeneous() - seen_from_board.to_homogeneous()).norm() < 1e-12);
}

#[test]
fn sweeps_find_the_same_whatever_drives_what() {
    let mut problem = problem(
        &format!("{URDF}camera_link = \"tool\""),
        "[target.zone]\nwidth_mm = 900\nheight_mm = 900\nedge_margin_mm = 100\n[sweep]\nstep_deg = 2\nstep_mm = 7\naxis = \"zone\"",
    )
    .unwrap();
    let follower = |joint, turned| Stage {
        X_PJ: Pose::new(Vector3::new(0.1, 0.0, 0.2), Vector3::new(turned, 0.3, 0.0)),
        motion: Motion::Driven {
            joint,
            kind: JointKind::Revolute,
            axis: Vector3::y_axis(),
            multiplier: 0.3 + 0.2 * joint as f64,
            offset: 0.1,
        },
    };
    for (joint, turned) in [(0, 2.6), (1, 0.3)] {
        problem.robot.chain.stages.push(follower(joint, turned));
        let found = sweep(&problem.robot, &problem.target, &problem.space, problem.axis, &|_| {});
        let case = |id: &usize| {
            let X_TC = problem.target.X_BT.inverse() * problem.robot.camera_pose(&problem.space.configuration(*id));
            let (p, z) = (X_TC.translation.vector, X_TC.rotation * Vector3::z());
            let t = -p.z / z.z;
            if t > 0.0 { problem.target.zone.case(p.x + t * z.x, p.y + t * z.y) } else { AxisCase::Outside }
        };
        let expected: Vec<usize> = (0..problem.space.len()).filter(|id| case(id) != AxisCase::Outside).collect();
        assert_eq!(found.candidates.iter().collect::<Vec<_>>(), expected);
        assert!(expected.len() > 100 && expected.len() < problem.space.len() / 2, "{}", expected.len());
    }
}

/// `RIGHT` with each first text, which must occur once, replaced by the second.
fn changed(changes: &[(&str, &str)]) -> String {
    let change = |text: String, (right, other): &(&str, &str)| {
        assert_eq!(text.matches(right).count(), 1, "{right}");
        text.replace(right, other)
    };
    changes.iter().fold(RIGHT.to_owned(), change)
}

fn notes(problem: &Problem) -> String {
    problem.notes.iter().map(|note| format!("{}: {}\n", note.key, note.text)).collect()
}

#[test]
fn what_is_put_right_or_left_out_is_noted() {
    let urdf = changed(&[
        ("xyz=\"0.6 0 0.8\"", "xyz=\"3 0 4\""),
        ("<sphere radius=\"0.01\"/>", "<sphere radius=\"0\"/>"),
        ("<geometry><box size=\"0.2 0.4 0.6\"/></geometry>", ""),
        ("<geometry><cylinder radius=\"0.1\" length=\"0.05\"/></geometry>", "<geometry/>"),
        ("type=\"continuous\"", "type=\"floating\""),
        ("mimic joint=\"slide\"", "mimic joint=\"nobody\""),
    ]);
    let problem = problem_of(&urdf, &format!("{URDF}camera_link = \"tool\""), "").unwrap();
    let tree = &problem.robot.tree;
    let bodied: Vec<&str> =
        tree.links.iter().filter(|link| !link.bodies.is_empty()).map(|link| link.name.as_str()).collect();
    assert_eq!(bodied, ["column", "tool", "board"]);
    let X_BC = problem.robot.camera_pose(&[0.0, 0.5]);
    assert!((X_BC.translation.vector - Vector3::new(0.0, 0.3, 0.3 + 0.4)).norm() < 1e-15);
    insta::assert_snapshot!(notes(&problem), @r#"
    robot.urdf: line 5, link "base": the <collision> has no shape and is left out
    robot.urdf: line 21, joint "slide": the axis has length 5 and is normalised
    robot.urdf: line 34, link "fingertip": the <sphere> has no extent and is left out
    robot.urdf: line 42, link "wheel": the <collision> has no shape and is left out
    robot.urdf: line 31, joint "finger": it mimics joint "nobody", which does not exist. It is off the arm and is held at 0
    robot.urdf: line 36, joint "wheel_joint": the type is "floating", which is not supported; supported: revolute, continuous, prismatic, fixed. Make the joint fixed, or leave out what is above it. It is off the arm and is held at 0
    "#);
    // Plates and rods are no empty shapes: others can touch them.
    let flat = changed(&[("0.2 0.4 0.6", "0.2 0.4 0"), ("<cylinder radius=\"0.1\"", "<cylinder radius=\"0\"")]);
    let flat = problem_of(&flat, &format!("{URDF}camera_link = \"tool\""), "").unwrap();
    assert!(flat.notes.is_empty() && flat.robot.tree.links.iter().all(|link| !link.bodies.is_empty()));
}

const NO_LIMITS: (&str, &str) = ("<limit lower=\"0.1\" upper=\"0.5\" effort=\"10\" velocity=\"0\"/>", "");
const ZERO_LIMITS: (&str, &str) = ("lower=\"-2\" upper=\"2\"", "lower=\"0\" upper=\"0\"");
const SOFT_LIMITS: (&str, &str) = (
    "velocity=\"1.5\"/>",
    "velocity=\"1.5\"/><safety_controller soft_lower_limit=\"-1\" soft_upper_limit=\"3\" k_position=\"100\" k_velocity=\"10\"/>",
);

#[test]
fn limits_that_the_description_leaves_open_are_the_problem_files() {
    let urdf = changed(&[NO_LIMITS, ZERO_LIMITS]);
    let limits = "limits_deg = { turn = [-60, 60] }\nlimits_mm = { slide = [0, 300] }";
    let robot = |keys: &str| problem_of(&urdf, &format!("{URDF}camera_link = \"tool\"\n{keys}"), "");
    let given = robot(limits).unwrap();
    let ranges: Vec<_> = given.robot.chain.joints.iter().map(|joint| (joint.limits.min, joint.limits.max)).collect();
    assert_eq!(ranges, [(-60f64.to_radians(), 60f64.to_radians()), (0.0, 0.3)]);
    // A held joint needs no limits, nor does one off the arm.
    assert!(robot("limits_deg = { turn = [-60, 60] }\njoint_values_mm = { slide = 150 }").is_ok());
    assert!(problem_of(&changed(&[NO_LIMITS]), &format!("{URDF}camera_link = \"column\""), "").is_ok());
    insta::assert_snapshot!(robot("").unwrap_err());
}

#[test]
fn soft_limits_hold_where_they_are_tighter() {
    let urdf = changed(&[SOFT_LIMITS]);
    let robot = |keys: &str| problem_of(&urdf, &format!("{URDF}camera_link = \"tool\"\n{keys}"), "");
    let softened = robot("").unwrap();
    let limits = softened.robot.chain.joints[0].limits;
    assert_eq!((limits.min, limits.max), (-1.0, 2.0));
    assert_eq!(
        notes(&softened),
        "robot.urdf: joint \"turn\" moves from -57.296° to 114.592°, the soft limits of its safety controller, which are \
         tighter than its limits from -114.592° to 114.592°\n"
    );
    // Rounded to a thousandth as they are told, they are the URDF's own.
    let same = robot("limits_deg = { turn = [-57.296, 114.592] }").unwrap();
    assert_eq!((same.robot.chain.joints[0].limits, same.notes.len()), (limits, 0));
    let meant = robot("limits_deg = { turn = [-100, 90] }\nexceed_urdf_limits = [\"turn\"]").unwrap();
    assert_eq!(meant.robot.chain.joints[0].limits.min, -100f64.to_radians());
    assert_eq!(
        notes(&meant),
        "robot.limits_deg.turn: goes beyond the URDF's range from -57.296 to 114.592, as `exceed_urdf_limits` allows\n"
    );
    let off_the_arm = problem_of(&urdf, &format!("{URDF}camera_link = \"wheel\""), "").unwrap();
    assert!(off_the_arm.notes.is_empty());
    let refused = [
        robot("limits_deg = { turn = [-100, 90] }"),
        robot("limits_mm = { slide = [0, 400] }\nexceed_urdf_limits = [\"turn\", \"slid\"]"),
        robot("joint_values_deg = { turn = -100 }"),
    ];
    insta::assert_snapshot!(refused.map(Result::unwrap_err).join("\n"));
}

#[test]
fn mistakes_on_the_arm_are_told_as_what_they_are() {
    let cases: [&[(&str, &str)]; 4] = [
        &[("mimic joint=\"slide\"", "mimic joint=\"nobody\"")],
        &[("xyz=\"0.6 0 0.8\"", "xyz=\"0 0 0\"")],
        &[("<robot name=\"arm\">", "<robot name='arm'><link name='base'/>")],
        &[("</robot>", "</robo>")],
    ];
    let drawings =
        cases.map(|changes| problem_of(&changed(changes), &format!("{URDF}camera_link = \"fingertip\""), ""));
    insta::assert_snapshot!(drawings.map(Result::unwrap_err).join("\n"));
}

/// A joint without end is swept over one turn, and so is one whose range has several: every place of it once.
#[test]
fn joints_that_go_round_are_swept_once_round() {
    let swept = |keys: &str| {
        let robot = format!("{URDF}camera_link = \"wheel\"\n{keys}");
        let problem = problem(&robot, "[sweep]\nstep_deg = 30").unwrap();
        let values = (0..problem.space.len()).map(|id| problem.space.configuration(id)[0].to_degrees().round());
        let joint = &problem.robot.chain.joints[0];
        (values.collect::<Vec<_>>(), joint.limits.max.to_degrees().round(), notes(&problem))
    };
    let once: Vec<f64> = (0..12).map(|i| -180.0 + 30.0 * f64::from(i)).collect();
    assert_eq!(swept(""), (once.clone(), 180.0, String::new()));
    let (values, limit, note) = swept("limits_deg = { wheel_joint = [-360, 360] }");
    assert_eq!((values, limit), (once, 360.0));
    assert_eq!(
        note,
        "sweep: joint \"wheel_joint\" can turn through 720°; only the turn from -180° to 180° is swept, which contains every position\n"
    );
    assert_eq!(swept("limits_deg = { wheel_joint = [-90, 240] }").0.len(), 12);
}

/// What `init --urdf` writes is a valid problem of the file's name, on which the guessed camera sees the guessed board.
#[test]
fn drafts_from_descriptions_are_problems() {
    let urdf = changed(&[NO_LIMITS, ZERO_LIMITS, ("<link name=\"tool\">", "<link name=\"tool\"><visual/>")]);
    let urdf = urdf.replace("\"tool\"", "\"wrist camera_link\"");
    let folder = folder(&urdf);
    let own = folder.path().join("robot/robot.urdf");
    let shipped = |name: &str| Path::new("problems/urdf").join(name);
    for (urdf, camera, joints) in [
        (own.clone(), "wrist camera_link", 2),
        (shipped("six-axis-rover.urdf"), "camera_optical_frame", 6),
        (shipped("seven-axis-carrier.urdf"), "camera_optical_frame", 8),
    ] {
        let file = folder.path().join("my-arm.toml");
        let text = draft(&urdf, &file).unwrap();
        let problem = Problem::parse(&text, &file).unwrap_or_else(|error| panic!("{error:?}\n{text}"));
        let robot = &problem.robot;
        assert_eq!((problem.name.as_str(), robot.tree.links[robot.camera_link].name.as_str()), ("my-arm", camera));
        assert_eq!(robot.chain.dof(), joints);
        let ids = (0..2000).collect();
        let (views, rejected) = feasible_views(&problem.checks(), &problem.space, &ids);
        assert!(!views.is_empty(), "{rejected:?}\n{text}");
    }
    let text = draft(&own, &folder.path().join("my-arm.toml")).unwrap();
    for line in
        ["urdf = \"robot/robot.urdf\"", "limits_deg = { turn = [-180, 180] }", "limits_mm = { slide = [0, 100] }"]
    {
        assert!(text.contains(line), "{text}");
    }
    // Wrong input.
    let refused = |text: &str| {
        std::fs::write(&own, text).unwrap();
        draft(&own, &folder.path().join("a.toml")).unwrap_err().to_string()
    };
    assert_eq!(refused("<robot name=\"r\"><link name=\"base\"/></robot>"), "no joint of the robot can move a camera");
    assert_eq!(refused("<sdf/>"), "line 1: the outermost element is <sdf>; it must be <robot>");
}

/// Files made to take for ever, in time that a test has.
#[test]
fn endless_descriptions_are_refused() {
    let attributes: String = (0..100_000).map(|i| format!(" a{i}=\"\"")).collect();
    let links: String = (0..1001).map(|i| format!("<link name=\"l{i}\"/>")).collect();
    // Ten instances of a node of ten instances of a node …: 10^11 triangles.
    let mut nodes = String::from("<node id=\"n0\"><instance_geometry url=\"#g\"/></node>");
    for level in 1..=11 {
        let instances = format!("<instance_node url=\"#n{}\"/>", level - 1).repeat(10);
        nodes += &format!("<node id=\"n{level}\">{instances}</node>");
    }
    let dae = format!(
        "<COLLADA><library_geometries><geometry id='g'><mesh/></geometry></library_geometries><library_nodes>{nodes}</library_nodes>\
         <library_visual_scenes><visual_scene id='s'><instance_node url='#n11'/></visual_scene></library_visual_scenes></COLLADA>"
    );
    let dae_folder = folder(RIGHT);
    std::fs::write(dae_folder.path().join("robot/endless.dae"), dae).unwrap();
    let with_dae = RIGHT.replace("column.stl", "endless.dae");
    let errors = [
        read_urdf(&format!("<robot>\n<link name=\"a\"{attributes}/></robot>"), Path::new("."), &[]).unwrap_err(),
        read_urdf(&format!("<robot>{links}</robot>"), Path::new("."), &[]).unwrap_err(),
        read_urdf(&with_dae, &dae_folder.path().join("robot"), &[]).unwrap_err(),
    ];
    insta::assert_snapshot!(errors.map(|error| error.to_string()).join("\n"), @r#"
    line 2: this cannot be read as XML: an element has more than 1000 attributes
    line 1: there are 1001 <link> elements; at most 1000 are read
    line 16, link "column": mesh "endless.dae": line 1: the instances of the scene have more than 10000000 elements in all
    "#);
}

#[test]
fn what_problem_files_get_wrong_about_their_robot() {
    let tool = "camera_link = \"tool\"\n";
    let cases = [
        ("urdf = \"robot/none.urdf\"\ncamera_link = \"tool\"".to_owned(), ""),
        ("urdf = \"robot/column.stl\"\ncamera_link = \"tool\"".to_owned(), ""),
        (URDF.to_owned(), ""),
        (format!("{URDF}camera_link = \"tol\""), "link = \"weel\""),
        (format!("{URDF}{tool}base_link = \"floor\""), ""),
        (format!("{URDF}{tool}package_folders = [\"robot\", \"nowhere\"]"), ""),
        (format!("{URDF}{tool}srdf = \"robot/other.srdf\""), ""),
        (format!("{URDF}{tool}convention = \"standard\"\nflange = {{}}"), ""),
        (format!("{URDF}{tool}joint_values_deg = {{ slide = 200, tern = 5, finger = 1 }}"), ""),
        (format!("{URDF}{tool}joint_values_mm = {{ slide = 600 }}\njoint_values_deg = {{ turn = 115 }}"), ""),
        (format!("{URDF}{tool}limits_deg = {{ turn = [10, -10] }}"), ""),
        (format!("{URDF}camera_link = \"wheel\""), "link = \"wheel\""),
        (format!("{tool}limits_mm = {{ slide = [0, 1] }}"), "link = \"wheel\""),
        (String::new(), ""),
    ];
    let drawings: Vec<String> = cases.iter().map(|(robot, target)| problem(robot, target).expect_err(robot)).collect();
    insta::assert_snapshot!(drawings.join("\n"));
}
