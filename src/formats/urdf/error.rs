//! What can be wrong with a robot description.

use std::path::PathBuf;

use thiserror::Error;

use crate::formats::mesh::MeshError;

/// What is wrong with a URDF or SRDF file, and where.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}{}: {fault}", element.as_ref().map(|element| format!(", {element}")).unwrap_or_default())]
pub struct UrdfError {
    /// Line, from 1.
    pub line: usize,
    /// The link or joint: `joint "elbow"`.
    pub element: Option<String>,
    /// What is wrong.
    pub fault: UrdfFault,
}

/// What is wrong with a robot description.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum UrdfFault {
    /// The text is not XML.
    #[error("this cannot be read as XML: {message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// The file still has to go through xacro.
    #[error("`{found}` is xacro, not URDF; run `xacro FILE > robot.urdf` first and name the result")]
    Xacro {
        /// The first sign of it.
        found: String,
    },
    /// The file is of something else.
    #[error("the outermost element is <{found}>; it must be <robot>")]
    Root {
        /// What is there.
        found: String,
    },
    /// There are no links.
    #[error("the robot has no links")]
    NoLinks,
    /// There is more than any robot has.
    #[error("there are {found} <{tag}> elements; at most {most} are read")]
    TooMany {
        /// What there is too much of.
        tag: &'static str,
        /// How many.
        found: usize,
        /// How many are read.
        most: usize,
    },
    /// An attribute or element is left out.
    #[error("{what} is missing")]
    Missing {
        /// What.
        what: String,
    },
    /// A name is empty.
    #[error("the name is empty")]
    Unnamed,
    /// A name occurs twice.
    #[error("this name is used already, at line {line}")]
    Repeated {
        /// Line of the first.
        line: usize,
    },
    /// A value is not the numbers that belong there.
    #[error("`{attribute}` is \"{text}\"; it must be {}", count(*expected))]
    Numbers {
        /// The attribute.
        attribute: String,
        /// What it says.
        text: String,
        /// How many finite numbers belong there.
        expected: usize,
    },
    /// A size, mass or speed is negative.
    #[error("the {what} is {value}; it must be at least 0")]
    Negative {
        /// What.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// An axis has no direction.
    #[error("the axis is 0 0 0, which has no direction")]
    ZeroAxis,
    /// A joint's limits are reversed.
    #[error("the limits run from {lower} down to {upper}")]
    LimitsReversed {
        /// Lower limit, rad or m.
        lower: f64,
        /// Upper limit, rad or m.
        upper: f64,
    },
    /// A joint's limits and its soft limits have nothing in common.
    #[error("the soft limits of the safety controller and the limits have no common range: {lower} is above {upper}")]
    SoftLimitsOutside {
        /// The greater of the lower limits, rad or m.
        lower: f64,
        /// The lesser of the upper limits, rad or m.
        upper: f64,
    },
    /// A joint moves in a way that no arm does.
    #[error(
        "the type is \"{found}\", which is not supported; supported: revolute, continuous, prismatic, fixed. Make the joint \
         fixed, or leave out what is above it"
    )]
    JointType {
        /// The type.
        found: String,
    },
    /// A link is named that does not exist.
    #[error("there is no link \"{name}\"")]
    UnknownLink {
        /// Its name.
        name: String,
    },
    /// A joint is mimicked that does not exist.
    #[error("it mimics joint \"{name}\", which does not exist")]
    MimicsUnknown {
        /// Its name.
        name: String,
    },
    /// A joint is mimicked that does not move.
    #[error("it mimics joint \"{name}\", which is fixed")]
    MimicsFixed {
        /// Its name.
        name: String,
    },
    /// Joints mimic each other in a circle.
    #[error("joints mimic each other in a cycle: {}", joints.join(" → "))]
    MimicLoop {
        /// The joints, the first again at the end.
        joints: Vec<String>,
    },
    /// A link hangs on two joints.
    #[error("it is the child of two joints, \"{}\" and \"{}\"; a URDF is a tree and cannot close a loop", joints[0], joints[1])]
    TwoParents {
        /// The joints.
        joints: [String; 2],
    },
    /// Links hang on each other in a circle.
    #[error("links form a loop: {}; a URDF is a tree", links.join(" → "))]
    Loop {
        /// The links from child to parent, the first again at the end.
        links: Vec<String>,
    },
    /// The links do not all hang together.
    #[error(
        "no joint has it as child, and none has link \"{other}\" at line {line}; a robot has only one such link, its root"
    )]
    TwoRoots {
        /// The other root.
        other: String,
        /// Its line.
        line: usize,
    },
    /// A `<geometry>` does not have one shape.
    #[error("<geometry> must have one of <box>, <cylinder>, <sphere>, <capsule>, <mesh>; it has {found}")]
    Geometry {
        /// What it has.
        found: String,
    },
    /// A mesh is scaled to nothing.
    #[error("the mesh has scale {} {} {}; no factor may be 0", scale[0], scale[1], scale[2])]
    ZeroScale {
        /// The factors.
        scale: [f64; 3],
    },
    /// A mesh is not found.
    #[error(
        "mesh \"{filename}\" was not found; looked for {}. Name the folders of packages with `robot.package_folders`{}",
        paths(sought),
        package.as_ref().map(|folder| format!("; {} has that name", folder.display())).unwrap_or_default()
    )]
    MeshNotFound {
        /// As the file names it.
        filename: String,
        /// Where it was looked for.
        sought: Vec<PathBuf>,
        /// A folder above the description that has the package's name, if there is one.
        package: Option<PathBuf>,
    },
    /// A mesh lies elsewhere.
    #[error(
        "mesh \"{filename}\" is outside the allowed folders: {}. If this is intended, add its folder to `robot.package_folders`",
        paths(folders)
    )]
    MeshOutside {
        /// As the file names it.
        filename: String,
        /// The folders.
        folders: Vec<PathBuf>,
    },
    /// A mesh is a symbolic link that leads elsewhere, as in workspaces that are linked rather than copied.
    #[error(
        "mesh \"{filename}\" leads through a symbolic link to {}, outside the allowed folders: {}. If this is intended, add the \
         folder that the link leads to, such as {}, to `robot.package_folders`",
        target.display(),
        paths(folders),
        target.parent().unwrap_or(target).display()
    )]
    MeshLinked {
        /// As the file names it.
        filename: String,
        /// Where the link leads.
        target: PathBuf,
        /// The folders.
        folders: Vec<PathBuf>,
    },
    /// A mesh is named by something else than a file.
    #[error("mesh \"{filename}\" is not a file; use package://PACKAGE/PATH, file:///PATH, or a path beside this file")]
    MeshAddress {
        /// As the file names it.
        filename: String,
    },
    /// A mesh cannot be read.
    #[error("mesh \"{filename}\": {error}")]
    Mesh {
        /// As the file names it.
        filename: String,
        /// Why not.
        error: MeshError,
    },
}

impl UrdfError {
    /// Whether the file is of another kind, rather than one with a mistake.
    pub fn is_of_another_file(&self) -> bool {
        match &self.fault {
            UrdfFault::Root { .. } | UrdfFault::Xacro { .. } => true,
            UrdfFault::Syntax { .. } => self.line == 1,
            _ => false,
        }
    }
}

impl UrdfFault {
    /// Whether it only leaves open how a single joint moves: nothing else of the description depends on it.
    pub(super) fn is_of_motion(&self) -> bool {
        matches!(
            self,
            Self::ZeroAxis | Self::LimitsReversed { .. } | Self::SoftLimitsOutside { .. } | Self::JointType { .. }
        )
    }
}

fn count(numbers: usize) -> String {
    if numbers == 1 { "a finite number".into() } else { format!("{numbers} finite numbers") }
}

fn paths(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}
