//! What can be wrong with a problem file, and how it is said.

use std::path::PathBuf;

use super::allowed::{Allowed, Number};
use super::suggestion::{quoted, suggestion};
use crate::feasibility::StabilityError;
use crate::figures::trimmed;
use crate::formats::{FileReadError, ReadFault};
use crate::robot::JointKind;
use crate::target::BoardError;

/// What is wrong with a key or its value. Values are in the file's units.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// The text is not TOML, or not what belongs here.
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// There is no such key.
    UnknownKey {
        /// The keys of the section.
        allowed: Vec<String>,
    },
    /// There is no such name.
    UnknownName {
        /// The name found.
        name: String,
        /// The names that exist.
        allowed: Vec<String>,
    },
    /// A required key is left out.
    Missing {
        /// The values to choose from; empty where they cannot be listed.
        allowed: Vec<String>,
    },
    /// The value has the wrong type.
    Type {
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// The number is not allowed.
    OutOfRange {
        /// The number.
        value: f64,
        /// The numbers that are.
        allowed: Allowed,
    },
    /// A standard deviation known beforehand is so small that there is nothing to estimate.
    KnownExactly {
        /// The standard deviation.
        value: f64,
        /// The least that is.
        least: f64,
    },
    /// A range ends before it begins.
    Reversed {
        /// Its first number.
        min: f64,
        /// Its second.
        max: f64,
    },
    /// The board does not fit its zone.
    BoardBeyondZone {
        /// Side of the zone in mm.
        zone: f64,
        /// Side of the printed board in mm.
        board: f64,
    },
    /// A list has the wrong number of entries.
    Length {
        /// Entries found.
        found: usize,
        /// Entries needed.
        expected: usize,
        /// What each entry is for.
        per: &'static str,
    },
    /// A text or list that must not be is empty.
    Empty,
    /// The robot has neither joints nor a file that describes it.
    NoArm,
    /// A plan is to withstand deviations, and none is stated.
    NothingUncertain,
    /// An entry occurs twice.
    Duplicate {
        /// The entry.
        name: String,
    },
    /// The name is that of something else.
    Taken {
        /// The name.
        name: String,
    },
    /// The key has no meaning here.
    NotApplicable {
        /// What the key does not apply to.
        to: String,
        /// What to write instead.
        instead: String,
    },
    /// Two keys exclude each other.
    Conflict {
        /// The other key.
        with: String,
    },
    /// A quaternion is not a rotation.
    NotUnit {
        /// Its norm.
        norm: f64,
    },
    /// The lens model folds back so far inside the picture that it is not of the camera.
    FoldsBack {
        /// Angle to the optical axis at which it does, rad; none where the circle of the whole sphere is so small.
        angle: Option<f64>,
        /// Share of the picture that it reaches.
        share: f64,
        /// Share that it has to reach.
        least: f64,
    },
    /// The file that the key names gives no camera.
    CameraFile {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: FileReadError,
    },
    /// The file that the key names gives no board.
    TargetFile {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: FileReadError,
    },
    /// The file describes a board of another kind.
    OtherKind {
        /// The kind that is stated.
        stated: &'static str,
        /// The file's.
        found: &'static str,
        /// The file.
        file: PathBuf,
    },
    /// There is no such board.
    Board {
        /// Why not.
        error: BoardError,
    },
    /// A body has no shape.
    NoShape {
        /// The keys that give one.
        allowed: Vec<String>,
    },
    /// Several links have the name.
    Ambiguous {
        /// The name.
        name: String,
    },
    /// The points span no support polygon.
    Support {
        /// Why not.
        error: StabilityError,
    },
    /// Stability is asked for, but nothing has a mass.
    NoMasses,
    /// A folder does not exist.
    NoFolder {
        /// As the file names it.
        name: String,
    },
    /// The file that the key names does not describe the robot.
    RobotFile {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: FileReadError,
    },
    /// The range goes beyond that of the robot's description.
    BeyondUrdf {
        /// The joint.
        joint: String,
        /// The range.
        range: [f64; 2],
        /// The description's.
        bounds: [f64; 2],
        /// Whether a safety controller sets these bounds.
        soft: bool,
    },
    /// The robot's description does not say how far joints of the arm may move.
    NoLimits {
        /// How they move.
        kind: JointKind,
        /// The joints, at least one.
        joints: Vec<String>,
    },
    /// No joint moves the camera against the board.
    NothingMoves {
        /// Link that carries the camera.
        camera_link: String,
        /// Link that carries the board.
        board_link: String,
    },
    /// The sweep has more configurations than a computer can hold.
    TooManyConfigurations {
        /// How many.
        configurations: f64,
        /// How many are allowed.
        most: usize,
    },
    /// A problem in which the value is set refuses it.
    InProblem {
        /// The problem file.
        problem: PathBuf,
        /// What is wrong with the problem then.
        sentence: String,
        /// What to do.
        hint: Option<String>,
    },
    /// The experiment has more cells than can be.
    TooManyCells {
        /// How many.
        cells: f64,
        /// How many are allowed.
        most: usize,
    },
    /// The sample has no dimensions for so many joints.
    TooManyJoints {
        /// How many joints there are.
        joints: usize,
        /// How many are allowed.
        most: usize,
    },
}

impl Reason {
    /// What is wrong with `key`. Where it is not `written`, the value at fault is the default.
    pub(super) fn sentence(&self, key: &str, written: bool) -> String {
        match self {
            Reason::Syntax { message } if key.is_empty() => format!("this is not TOML: {message}"),
            Reason::Syntax { message } => format!("`{key}` cannot be read: {message}"),
            Reason::UnknownKey { .. } => format!("there is no key `{key}`"),
            Reason::UnknownName { name, .. } => format!("`{key}` is \"{name}\", which does not exist"),
            Reason::Missing { .. } => format!("`{key}` is missing"),
            Reason::Type { found, .. } => format!("`{key}` is {found}"),
            Reason::OutOfRange { value, .. } if !written => {
                format!("`{key}` is left out, and its default is {}", Number(*value))
            }
            Reason::OutOfRange { value, .. } => format!("`{key}` is {}", Number(*value)),
            Reason::KnownExactly { value, .. } => {
                format!("`{key}` is {}: the intrinsic is then known, and there is nothing to estimate", Number(*value))
            }
            Reason::Reversed { min, max } => format!("`{key}` runs from {} down to {}", Number(*min), Number(*max)),
            Reason::BoardBeyondZone { zone, .. } => {
                format!("`{key}` is {}, less than the side of the printed board", Number(*zone))
            }
            Reason::Length { found, .. } => format!("`{key}` has {found} entries"),
            Reason::Empty => format!("`{key}` is empty"),
            Reason::NoArm => format!("`{key}` is missing or empty, and `robot.urdf` is not given either"),
            Reason::NothingUncertain => format!("`{key}` states no standard deviation"),
            Reason::Duplicate { name } => format!("`{key}` is \"{name}\", which is used already"),
            Reason::Taken { name } => format!("`{key}` is \"{name}\", which is the name of a link"),
            Reason::NotApplicable { to, .. } => format!("`{key}` does not apply to {to}"),
            Reason::Conflict { with } => format!("`{key}` and `{with}` exclude each other"),
            Reason::NotUnit { norm } => format!("`{key}` has norm {}", Number(*norm)),
            Reason::FoldsBack { angle: Some(angle), share, .. } => format!(
                "`{key}` folds back {:.1}° off the optical axis and reaches only {:.0} % of the picture",
                angle.to_degrees(),
                100.0 * share
            ),
            Reason::FoldsBack { angle: None, share, .. } => {
                format!("`{key}` reaches only {:.0} % of the picture", 100.0 * share)
            }
            Reason::CameraFile { path, error }
            | Reason::RobotFile { path, error }
            | Reason::TargetFile { path, error } => {
                format!("{}: {error}", path.display())
            }
            Reason::NoShape { .. } => format!("`{key}` has no shape"),
            Reason::Ambiguous { name } => format!("`{key}` is \"{name}\", which is the name of several links"),
            Reason::Support { error } => error.to_string(),
            Reason::OtherKind { stated, found, file } => {
                format!("`{key}` is \"{stated}\", but {} describes a board of the kind \"{found}\"", file.display())
            }
            Reason::Board { error } => error.to_string(),
            Reason::NoMasses => format!("`{key}` needs masses, and no link has one"),
            Reason::NoFolder { name } => format!("`{key}` is \"{name}\", which is not a folder"),
            Reason::BeyondUrdf { range: [min, max], soft, .. } => {
                let what = if *soft { "the soft limits of the URDF's safety controller" } else { "the URDF's limits" };
                format!("`{key}` runs from {} to {}, beyond {what}", Number(*min), Number(*max))
            }
            Reason::NoLimits { joints, .. } => {
                let names = joints.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
                let (joint, it) = if joints.len() == 1 { ("joint", "it") } else { ("joints", "they") };
                format!("the URDF gives {joint} {names} no limits, or limits from 0 to 0, so that {it} cannot move")
            }
            Reason::NothingMoves { camera_link, board_link } => {
                format!("no joint moves link \"{camera_link}\" relative to link \"{board_link}\"")
            }
            Reason::TooManyConfigurations { configurations, .. } => {
                format!("`{key}` makes {configurations:.1e} configurations")
            }
            Reason::InProblem { sentence, .. } => format!("`{key}`: {sentence}"),
            Reason::TooManyCells { cells, .. } => format!("`{key}` makes {cells:.1e} cells"),
            Reason::TooManyJoints { joints, .. } => format!("`{key}` does not support {joints} joints"),
        }
    }

    /// What is allowed, to stand under the value.
    pub(super) fn label(&self, key: &str, written: bool) -> String {
        match self {
            Reason::Syntax { .. } => "here".into(),
            Reason::UnknownKey { .. } => "unknown key".into(),
            Reason::UnknownName { .. } => "unknown name".into(),
            Reason::Missing { .. } | Reason::NoShape { .. } => "add it here".into(),
            Reason::Type { expected, .. } => format!("must be {expected}"),
            Reason::OutOfRange { allowed, .. } if !written => {
                format!("give `{}` here: {allowed}", last(key))
            }
            Reason::OutOfRange { allowed, .. } => format!("must be {allowed}"),
            Reason::KnownExactly { least, .. } => format!("must be at least {least:.1e}"),
            Reason::Reversed { .. } => "must be [min, max]".into(),
            Reason::BoardBeyondZone { board, .. } => format!("must be at least {}", Number(*board)),
            Reason::Length { expected, per, .. } => format!("must have {expected}, one for each {per}"),
            Reason::Empty => "must not be empty".into(),
            Reason::NoArm => "give one of the two".into(),
            Reason::NothingUncertain => "nothing is uncertain here".into(),
            Reason::Duplicate { .. } => "must occur only once".into(),
            Reason::Taken { .. } => "must be a different name".into(),
            Reason::NotApplicable { .. } => "does not apply here".into(),
            Reason::Conflict { .. } => "only one may be given".into(),
            Reason::NotUnit { .. } => "must have norm 1".into(),
            Reason::FoldsBack { least, .. } => format!("must reach {:.0} % of the picture", 100.0 * least),
            Reason::CameraFile { error: FileReadError::Content(error), .. } => match error.fault {
                ReadFault::Mismatch { .. } => "does not agree".into(),
                ReadFault::UnknownCamera { .. } => "must name a camera of the file".into(),
                ReadFault::NotStated { .. } | ReadFault::SeveralCameras { .. } => "leaves this open".into(),
                ReadFault::OtherFormat { .. } | ReadFault::NoCamera { .. } => "names a file that cannot be used".into(),
                _ => format!("names a file with an error at line {}", error.line),
            },
            Reason::CameraFile { .. } => "must name a camera file".into(),
            Reason::TargetFile { error: FileReadError::Content(error), .. } => match error.fault {
                ReadFault::NoBoard => "names a file that cannot be used".into(),
                _ => format!("names a file with an error at line {}", error.line),
            },
            Reason::TargetFile { .. } => "must name a file that describes a board".into(),
            Reason::OtherKind { found, .. } => format!("must be \"{found}\", or left out"),
            Reason::Board { error } => match error {
                BoardError::TooLarge { room, .. } => format!("must be less than {}", trimmed(*room, 4)),
                BoardError::TooFewMarkers { needed, .. } => format!("needs {needed} markers"),
                BoardError::Duplicate { first, .. } => format!("is point {first} once more"),
                BoardError::OnALine => "must span an area".into(),
                BoardError::TooFew { .. }
                | BoardError::Length { .. }
                | BoardError::NotFinite { .. }
                | BoardError::TooFewPoints { .. }
                | BoardError::TooManyPoints { .. } => "is no board".into(),
            },
            Reason::Ambiguous { .. } => "must name one link".into(),
            Reason::Support { .. } => "must span an area".into(),
            Reason::NoMasses => "cannot be tested".into(),
            Reason::RobotFile { error: FileReadError::Robot(error), .. } if !error.is_of_another_file() => {
                format!("names a file with an error at line {}", error.line)
            }
            Reason::RobotFile { .. } => "must name a file that describes the robot".into(),
            Reason::BeyondUrdf { bounds: [min, max], .. } => {
                format!("must be within {} and {}", Number(*min), Number(*max))
            }
            Reason::NoLimits { .. } => "needs their ranges".into(),
            Reason::NoFolder { .. } => "must be an existing folder".into(),
            Reason::NothingMoves { .. } => "must be moved by a joint".into(),
            Reason::TooManyConfigurations { most, .. } | Reason::TooManyCells { most, .. } => {
                format!("must make at most {}", Number(*most as f64))
            }
            Reason::InProblem { problem, .. } => format!("refused by {}", problem.display()),
            Reason::TooManyJoints { most, .. } => format!("supports at most {most}"),
        }
    }

    /// What to do; for many reasons it is enough to know what the key means.
    pub(super) fn hint(&self, key: &str, meaning: Option<&str>) -> Option<String> {
        let hint = match self {
            Reason::UnknownKey { allowed } => suggestion(last(key), allowed, "keys here"),
            Reason::UnknownName { name, allowed } => suggestion(name, allowed, "allowed"),
            Reason::Missing { allowed } if !allowed.is_empty() => format!("choose one of {}", quoted(allowed)),
            Reason::NotApplicable { instead, .. } => instead.clone(),
            Reason::BoardBeyondZone { .. } => {
                "the printed board is one square larger each way than its inner corners; choose a larger zone, smaller \
                 squares or fewer corners"
                    .into()
            }
            Reason::NoArm => {
                "write the arm's Denavit–Hartenberg table as `[[robot.joints]]`, or name its URDF file with `urdf`".into()
            }
            Reason::NothingUncertain => {
                "state how far what was measured may be off, as in `mount_translation_mm = 3` and `mount_rotation_deg = 1`".into()
            }
            Reason::RobotFile { path, error: FileReadError::Robot(error) } if !error.is_of_another_file() => {
                format!("correct line {} of {}", error.line, path.display())
            }
            Reason::BeyondUrdf { joint, .. } => format!(
                "if the robot really moves farther than its description says, add \"{joint}\" to `robot.exceed_urdf_limits`"
            ),
            Reason::NoLimits { kind, joints } => {
                let ranges = joints.iter().map(|name| format!("{name} = [min, max]")).collect::<Vec<_>>().join(", ");
                let unit = match kind {
                    JointKind::Revolute => "deg",
                    JointKind::Prismatic => "mm",
                };
                format!(
                    "give the ranges from the robot's manual, `limits_{unit} = {{ {ranges} }}`, or hold joints with \
                     `joint_values_{unit}`"
                )
            }
            Reason::NothingMoves { .. } => {
                "`camera_link` carries the camera, `target.link` the board; joints with a value in `joint_values_deg` or \
                 `joint_values_mm` are held fixed"
                    .into()
            }
            Reason::FoldsBack { .. } => {
                "check the signs and the order of the coefficients, that they belong to this lens model (a fisheye is \
                 \"kannala-brandt\"), and that the focal lengths are in px, not in mm"
                    .into()
            }
            Reason::CameraFile { error: FileReadError::Content(error), .. } => return of_camera_file(&error.fault),
            Reason::TooManyConfigurations { .. } => "use a larger step, narrower joint limits, or a sample \
                                                     (`sample = 200000`); `axis = \"zone\"` keeps only the \
                                                     configurations that point at the zone"
                .into(),
            Reason::KnownExactly { .. } => {
                "leave it out of `estimate.intrinsics`; intrinsics that are left out are treated as known".into()
            }
            Reason::NoShape { allowed } => format!("give one of {}", quoted(allowed)),
            Reason::Ambiguous { .. } => "rename the joint".into(),
            Reason::Board { error: BoardError::TooFewMarkers { .. } } => {
                "take a larger dictionary of the same size, as DICT_5X5_1000 for DICT_5X5_50, or fewer squares or tags".into()
            }
            Reason::Board { error: BoardError::TooLarge { .. } } => {
                "markers and circles are smaller than the squares or the distances that they stand in".into()
            }
            Reason::TargetFile { error: FileReadError::Content(error), path } if error.fault != ReadFault::NoBoard => {
                format!("correct line {} of {}", error.line, path.display())
            }
            Reason::NoMasses => "give them in `[[robot.masses]]`".into(),
            Reason::InProblem { hint, .. } => return hint.clone(),
            Reason::TooManyCells { .. } => {
                "vary fewer factors at a time, or draw settings with `design = { kind = \"sampled\", draws = 256 }`".into()
            }
            Reason::TooManyJoints { .. } => "give a grid with `step_deg` or `step_mm` instead".into(),
            _ => return meaning.map(str::to_owned),
        };
        Some(hint)
    }
}

/// What to write beside `camera.file` where the file has `fault`.
fn of_camera_file(fault: &ReadFault) -> Option<String> {
    let hint = match fault {
        ReadFault::NotStated { .. } => "give `width_px` and `height_px` beside `file`",
        ReadFault::SeveralCameras { .. } | ReadFault::UnknownCamera { .. } => {
            "`file_camera` names the camera of a file that has several: `file_camera = \"cam0\"`"
        }
        ReadFault::Mismatch { .. } => {
            "beside a file that states the image size, `width_px` and `height_px` may be left out"
        }
        _ => return None,
    };
    Some(hint.to_owned())
}

/// The last key of a path.
fn last(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or_default()
}
