//! A problem file drafted from a robot's description: what the description says, and guesses for the rest.

use std::path::{Component, Path, PathBuf};

use nalgebra::Vector3;
use thiserror::Error;

use crate::formats::{Description, FileReadError, Outline, StatedRange, outline_urdf_file};
use crate::robot::{Assembly, Joint, JointKind, Mechanism, Robot};
use crate::spatial::Pose;

/// Why no problem file can be drafted.
#[derive(Debug, Error)]
pub enum DraftError {
    /// The file describes no robot.
    #[error(transparent)]
    File(#[from] FileReadError),
    /// Nothing moves.
    #[error("no joint of the robot can move a camera")]
    Still,
}

/// The parts of a link's name that speak for a camera on it, the best first. Frames called optical have the camera's axes.
const CAMERA_NAMES: [&[&str]; 5] = [
    &["color_optical", "rgb_optical", "left_optical"],
    &["optical"],
    &["camera", "cam_", "_cam"],
    &["tool0", "flange", "tcp"],
    &["ee_link", "end_effector", "gripper", "hand"],
];
/// Names of links that stand on the ground.
const BASE_NAMES: [&str; 3] = ["base_link", "base", "base_footprint"];
/// From the camera to the board of the draft, m.
const TO_BOARD: f64 = 0.6;

/// The text of a problem file, to stand at `file`, for the robot that the URDF at `urdf` describes. What is guessed or left to be
/// filled in says so.
///
/// # Errors
/// When the file describes no robot, or one without joints.
pub fn draft(urdf: &Path, file: &Path) -> Result<String, DraftError> {
    let outline = outline_urdf_file(urdf)?;
    let Description { mechanism, .. } = &outline.description;
    let base = base_link(mechanism);
    let camera = camera_link(mechanism, base).ok_or(DraftError::Still)?;
    let assembly = Assembly {
        base_link: base,
        board_link: base,
        camera_link: camera,
        X_FC: mount(&mechanism.tree.links[camera].name),
        held: vec![None; mechanism.joints.len()],
    };
    let robot = mechanism.robot(&assembly);
    let folder = absolute(file).parent().map(Path::to_owned).unwrap_or_default();
    let parts = [
        head(file),
        robot_section(&outline, &robot, urdf, &folder, [base, camera]),
        camera_section(&mechanism.tree.links[camera].name),
        target_section(&robot, &outline.description),
        REST.to_owned(),
    ];
    Ok(parts.join("\n"))
}

const REST: &str = "\
# The joint configurations to try.
[sweep]
sample = 200_000

# Which poses to choose. `calipose init` without --urdf writes a file that shows all keys.
[selection]
count = 10
";

/// The root, or the link under it that is called as a base usually is.
fn base_link(mechanism: &Mechanism) -> usize {
    let rests = |&link: &usize| moving(mechanism, 0, link) == 0;
    BASE_NAMES.iter().filter_map(|name| mechanism.link(name)).find(rests).unwrap_or(0)
}

/// How many joints move link `to` against link `from`.
fn moving(mechanism: &Mechanism, from: usize, to: usize) -> usize {
    let held = vec![None; mechanism.joints.len()];
    let assembly = Assembly { base_link: from, board_link: from, camera_link: to, X_FC: Pose::identity(), held };
    mechanism.robot(&assembly).chain.dof()
}

/// The link that moves and is most likely to carry a camera, by its name, then by how many joints move it.
fn camera_link(mechanism: &Mechanism, base: usize) -> Option<usize> {
    let rank = |link: usize| {
        let name = mechanism.tree.links[link].name.to_lowercase();
        let speaks = |parts: &&[&str]| parts.iter().any(|part| name.contains(part));
        CAMERA_NAMES.iter().position(speaks).unwrap_or(CAMERA_NAMES.len())
    };
    let links = (0..mechanism.tree.links.len()).map(|link| (link, moving(mechanism, base, link)));
    let moved = links.filter(|&(_, joints)| joints > 0);
    moved.min_by_key(|&(link, joints)| (rank(link), std::cmp::Reverse(joints))).map(|(link, _)| link)
}

/// Whether the link's name says that its axes are the camera's.
fn is_optical(link: &str) -> bool {
    link.to_lowercase().contains("optical")
}

/// Whether the link's name says that it is a camera's body, whose x is forward and z up in ROS.
fn is_body(link: &str) -> bool {
    let name = link.to_lowercase();
    !is_optical(link) && CAMERA_NAMES[2].iter().any(|part| name.contains(part))
}

/// Pose of the camera on a link of that name.
fn mount(link: &str) -> Pose {
    if is_body(link) {
        let quarter = std::f64::consts::FRAC_PI_2;
        Pose::from_parts([0.0; 3].into(), nalgebra::UnitQuaternion::from_euler_angles(-quarter, 0.0, -quarter))
    } else {
        Pose::identity()
    }
}

fn head(file: &Path) -> String {
    let file = plain(&file.display().to_string());
    format!(
        "#:schema ./calipose.schema.json\n\
         # Drafted from the robot's URDF. Check the lines that say GUESS, replace those that say FILL IN, then run:\n#\n\
         #   calipose check {file}     validate this file and show what a run would do\n\
         #   calipose plan {file}      choose the poses\n#\n\
         # Lengths are in mm, angles in degrees and image sizes in px. The problem's name is the file name without its extension.\n"
    )
}

/// A name as it may stand in a comment, where a line's end would end it.
fn plain(name: &str) -> String {
    name.replace(char::is_control, " ")
}

/// Names as a list in a comment, wrapped.
fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    const WIDTH: usize = 120;
    let mut lines = vec![String::from("#  ")];
    for name in names {
        if lines[lines.len() - 1].len() + name.len() + 1 > WIDTH {
            lines.push(String::from("#  "));
        }
        let last = lines.len() - 1;
        lines[last] += &format!(" {}", plain(name));
    }
    lines.join("\n")
}

fn robot_section(outline: &Outline, robot: &Robot, urdf: &Path, folder: &Path, [base, camera]: [usize; 2]) -> String {
    let Description { mechanism, ranges, .. } = &outline.description;
    let links = &mechanism.tree.links;
    let arm = &robot.chain.joints;
    let mut text = format!("[robot]\nurdf = {}\n", quoted(&relative(folder, urdf)));
    text += &packages(&outline.meshes, urdf, folder);
    text += &format!(
        "# Links of the URDF:\n{}\n\
         base_link = {} # GUESS: stands on the ground; its frame is the robot's base frame\n\
         camera_link = {} # GUESS: carries the camera\n",
        listed(links.iter().map(|link| link.name.as_str())),
        quoted(&links[base].name),
        quoted(&links[camera].name),
    );
    text += "# The joints between the two, in order, with their ranges:\n";
    let mut blank = [Vec::new(), Vec::new()];
    for joint in arm {
        let range = mechanism.joint(&joint.name).map(|i| ranges[i]).unwrap_or_default();
        text += &format!("#   {}: {}\n", plain(&joint.name), described(joint, &range));
        if range.is_blank() {
            blank[usize::from(joint.kind == JointKind::Prismatic)].push(joint.name.as_str());
        }
    }
    for (names, (key, guess)) in blank.iter().zip([("limits_deg", "[-180, 180]"), ("limits_mm", "[0, 100]")]) {
        if !names.is_empty() {
            let ranges: Vec<String> = names.iter().map(|name| format!("{} = {guess}", toml_key(name))).collect();
            text += &format!(
                "{key} = {{ {} }} # FILL IN: the URDF does not say how far these may move\n",
                ranges.join(", ")
            );
        }
    }
    let held = mechanism.joints.iter().filter(|joint| !arm.iter().any(|moving| moving.name == joint.name));
    let held: Vec<&str> = held.map(|joint| joint.name.as_str()).collect();
    if let [first, ..] = held[..] {
        let kind = mechanism.joint(first).map(|i| mechanism.joints[i].kind);
        let key = if kind == Some(JointKind::Prismatic) { "joint_values_mm" } else { "joint_values_deg" };
        text += &format!(
            "# All other joints are held at 0, or at the limit nearest to 0; for other values, give {key} = {{ {} = 10 }}:\n{}\n",
            toml_key(first),
            listed(held.into_iter()),
        );
    }
    if outline.collisions == 0 {
        text += "# The URDF has no <collision> bodies, so neither self-collision nor occlusion of the board is tested. FILL IN:\n\
                 # [[robot.bodies]]\n# link = \"...\"\n# capsule_mm = [60, 400] # or box_mm, sphere_mm, cylinder_mm\n\
                 # pose = { position_mm = [0, 0, 200] }\n";
    }
    text
}

/// Kind and range of a joint for people.
fn described(joint: &Joint, range: &StatedRange) -> String {
    let kind = match joint.kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
    };
    let unit = joint.kind.display_sign();
    let [min, max] = [joint.limits.min, joint.limits.max].map(|limit| joint.kind.to_display(limit));
    match range {
        _ if range.is_blank() => format!("{kind}, without limits"),
        StatedRange { continuous: true, soft: None, .. } => "continuous".into(),
        _ => format!("{kind}, {min:.1} … {max:.1}{unit}"),
    }
}

/// The folders of the packages that hold meshes, as far as they are above the URDF.
fn packages(meshes: &[String], urdf: &Path, folder: &Path) -> String {
    let package = |mesh: &String| Some(mesh.strip_prefix("package://")?.split_once('/')?.0.to_owned());
    let mut names: Vec<String> = meshes.iter().filter_map(package).collect();
    names.sort_unstable();
    names.dedup();
    let urdf = absolute(urdf);
    let mut folders: Vec<String> = Vec::new();
    let mut missing = Vec::new();
    for name in names {
        let holds = |above: &&Path| above.ends_with(&name) || above.join(&name).is_dir();
        match urdf.ancestors().skip(1).find(holds) {
            // Beside the URDF they are found without being named.
            Some(found) if urdf.parent() == Some(found) => {}
            Some(found) => folders.push(quoted(&relative(folder, found))),
            None => missing.push(name),
        }
    }
    folders.dedup();
    let mut text = String::new();
    if !folders.is_empty() {
        text += &format!("package_folders = [{}] # with the meshes of the collision bodies\n", folders.join(", "));
    }
    if !missing.is_empty() {
        let missing = plain(&missing.join(", "));
        text += &format!("# FILL IN: package_folders = [\"...\"] # folders of the packages with meshes: {missing}\n");
    }
    text
}

fn camera_section(link: &str) -> String {
    let mount = if is_optical(link) {
        "# The link's frame is taken as the camera's: x right, y down, z forward. If it is not: mount = { rpy_deg = [0, 0, 0] }\n"
    } else if is_body(link) {
        "mount = { rpy_deg = [-90, 0, -90] } # GUESS: the link's x is forward and its z up, as on camera bodies in ROS\n"
    } else {
        "mount = { position_mm = [0, 0, 0], rpy_deg = [0, 0, 0] } # FILL IN: the camera (x right, y down, z forward) on the link\n"
    };
    format!(
        "# The camera's nominal calibration: what you know now. FILL IN, or name a file: file = \"camera_info.yaml\"\n[camera]\n\
         {mount}width_px = 1280\nheight_px = 720\nfx_px = 900\n# distortion = {{ model = \"brown-conrady\" }}\n"
    )
}

fn target_section(robot: &Robot, description: &Description) -> String {
    let middle: Vec<f64> = robot.spans().iter().map(|span| f64::midpoint(span.limits.min, span.limits.max)).collect();
    // Ahead of the camera, its printed side towards it.
    let X_BT =
        robot.camera_pose(&middle) * Pose::new(Vector3::new(0.0, 0.0, TO_BOARD), Vector3::x() * std::f64::consts::PI);
    let [x, y, z] = (X_BT.translation.vector * 1e3).map(|mm| mm.round() + 0.0).into();
    let (roll, pitch, yaw) = X_BT.rotation.euler_angles();
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| (angle.to_degrees() * 10.0).round() / 10.0 + 0.0);
    let name = if description.name.is_empty() { "the robot".into() } else { plain(&description.name) };
    let distance = TO_BOARD * 1e3;
    format!(
        "# The board: FILL IN its inner corners and its pose. `link = \"...\"` puts it on another link than base_link.\n\
         [target]\ncolumns = 8\nrows = 6\nsquare_mm = 30\n\
         # GUESS: {distance} mm in front of the camera and facing it, with the joints of {name} in the middle of their ranges.\n\
         pose = {{ position_mm = [{x}, {y}, {z}], rpy_deg = [{roll}, {pitch}, {yaw}] }}\n"
    )
}

/// `text` as a TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// `name` as a TOML key.
fn toml_key(name: &str) -> String {
    let bare = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-".contains(&byte));
    if bare { name.to_owned() } else { quoted(name) }
}

/// `path` from the root, its `.` and `..` carried out.
fn absolute(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).components() {
        if part == Component::ParentDir {
            plain.pop();
        } else {
            plain.push(part);
        }
    }
    plain
}

/// `path` as it is named from `folder`.
pub(crate) fn relative(folder: &Path, path: &Path) -> String {
    let (folder, path) = (&absolute(folder), absolute(path));
    let common = folder.components().zip(path.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(path.components().skip(common)).collect();
    if way.as_os_str().is_empty() { ".".into() } else { way.to_string_lossy().replace('\\', "/") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_the_problem_files_folder() {
        let from = |folder: &str, path: &str| relative(Path::new(folder), Path::new(path));
        assert_eq!(from("/a/b", "/a/b/robot.urdf"), "robot.urdf");
        assert_eq!(from("/a/b", "/a/c/../d/robot.urdf"), "../d/robot.urdf");
        assert_eq!(from("/a/b", "/a/b"), ".");
        assert_eq!(from("/", "/a"), "a");
    }

    #[test]
    fn names_are_written_as_toml_takes_them() {
        assert_eq!(
            (toml_key("joint_1-a"), toml_key("left arm"), toml_key("")),
            ("joint_1-a".into(), "\"left arm\"".into(), "\"\"".into())
        );
        let table: toml::Table = format!("{} = {}", toml_key("a.\"b"), quoted("c\\\"d\n")).parse().unwrap();
        assert_eq!(table["a.\"b"].as_str(), Some("c\\\"d\n"));
    }
}
