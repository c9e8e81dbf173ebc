//! What can be wrong with a problem file.

mod error;

pub use error::ProblemError;

use std::fmt;
use std::ops::{Bound, Range, RangeBounds};
use std::path::PathBuf;

use miette::{Diagnostic, LabeledSpan, SourceCode};
use thiserror::Error;

use crate::camera::Lens;
use crate::feasibility::StabilityError;
use crate::formats::{FileReadError, ReadFault};

/// One thing wrong with a problem file, and where.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}", self.sentence())]
pub struct Fault {
    /// The key, from the root: `robot.joints[2].a_mm`. Empty for a syntax error.
    pub key: String,
    /// Whether the file has the key. Where it does not, the value at fault is the default.
    pub written: bool,
    /// The line that gives the value in place of the file's: line, column and bytes are its own then.
    pub given: Option<String>,
    /// Line in the file, from 1.
    pub line: usize,
    /// Column in the line, in characters from 1.
    pub column: usize,
    /// Bytes of the file to point at.
    pub span: Range<usize>,
    /// What is wrong.
    pub reason: Reason,
    /// What the key means, where known.
    pub meaning: Option<String>,
}

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
        with: &'static str,
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
    /// The sample has no dimensions for so many joints.
    TooManyJoints {
        /// How many joints there are.
        joints: usize,
        /// How many are allowed.
        most: usize,
    },
}

/// An interval of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// Lower end.
    pub min: Bound<f64>,
    /// Upper end.
    pub max: Bound<f64>,
}

impl Allowed {
    /// From `min` to `max`, both included.
    pub(crate) const fn between(min: f64, max: f64) -> Self {
        Self { min: Bound::Included(min), max: Bound::Included(max) }
    }

    /// Greater than 0, at most `max`.
    pub(crate) const fn positive(max: f64) -> Self {
        Self { min: Bound::Excluded(0.0), max: Bound::Included(max) }
    }

    /// Whether `value` is in the interval; NaN never is.
    pub fn contains(&self, value: f64) -> bool {
        (self.min, self.max).contains(&value)
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (self.min, self.max) {
            (Bound::Included(min), Bound::Included(max)) => write!(f, "from {} to {}", Number(min), Number(max)),
            (min, max) => {
                match min {
                    Bound::Included(min) => write!(f, "at least {}", Number(min))?,
                    Bound::Excluded(min) => write!(f, "greater than {}", Number(min))?,
                    Bound::Unbounded => {}
                }
                f.write_str(if min == Bound::Unbounded || max == Bound::Unbounded { "" } else { " and " })?;
                match max {
                    Bound::Included(max) => write!(f, "at most {}", Number(max)),
                    Bound::Excluded(max) => write!(f, "less than {}", Number(max)),
                    Bound::Unbounded => Ok(()),
                }
            }
        }
    }
}

/// A number as one would write it: very large and very small ones with an exponent.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let size = self.0.abs();
        if size >= 1e7 || (size > 0.0 && size < 1e-4) { write!(f, "{:e}", self.0) } else { write!(f, "{}", self.0) }
    }
}

impl Fault {
    fn sentence(&self) -> String {
        let key = &self.key;
        match &self.reason {
            Reason::Syntax { message } if key.is_empty() => format!("this is not TOML: {message}"),
            Reason::Syntax { message } => format!("`{key}` cannot be read: {message}"),
            Reason::UnknownKey { .. } => format!("there is no key `{key}`"),
            Reason::UnknownName { name, .. } => format!("`{key}` is \"{name}\", which does not exist"),
            Reason::Missing { .. } => format!("`{key}` is missing"),
            Reason::Type { found, .. } => format!("`{key}` is {found}"),
            Reason::OutOfRange { value, .. } if !self.written => {
                format!("`{key}` is left out, and its default is {}", Number(*value))
            }
            Reason::OutOfRange { value, .. } => format!("`{key}` is {}", Number(*value)),
            Reason::KnownExactly { value, .. } => {
                format!("`{key}` is {}: the intrinsic is known, there is nothing to estimate", Number(*value))
            }
            Reason::Reversed { min, max } => format!("`{key}` runs from {} down to {}", Number(*min), Number(*max)),
            Reason::BoardBeyondZone { zone, .. } => {
                format!("`{key}` is {}, less than the board's own side", Number(*zone))
            }
            Reason::Length { found, .. } => format!("`{key}` has {found} entries"),
            Reason::Empty => format!("`{key}` is empty"),
            Reason::NoArm => format!("`{key}` is missing or empty, and `robot.urdf` is not given either"),
            Reason::Duplicate { name } => format!("`{key}` is \"{name}\", which occurs before"),
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
            Reason::CameraFile { path, error } | Reason::RobotFile { path, error } => {
                format!("{}: {error}", path.display())
            }
            Reason::NoShape { .. } => format!("`{key}` has no shape"),
            Reason::Ambiguous { name } => format!("`{key}` is \"{name}\", which several links are called"),
            Reason::Support { error } => error.to_string(),
            Reason::NoMasses => format!("`{key}` needs masses, and no link has one"),
            Reason::NoFolder { name } => format!("`{key}` is \"{name}\", which is no folder"),
            Reason::BeyondUrdf { range: [min, max], soft, .. } => {
                let what = if *soft { "the soft limits of the URDF's safety controller" } else { "the URDF's limits" };
                format!("`{key}` runs from {} to {}, beyond {what}", Number(*min), Number(*max))
            }
            Reason::NoLimits { joints } => {
                let names = joints.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
                let (joint, it) = if joints.len() == 1 { ("joint", "it") } else { ("joints", "they") };
                format!("the URDF gives {joint} {names} no limits, or from 0 to 0, so that {it} cannot move")
            }
            Reason::NothingMoves { camera_link, board_link } => {
                format!("no joint moves link \"{camera_link}\" against link \"{board_link}\"")
            }
            Reason::TooManyConfigurations { configurations, .. } => {
                format!("`{key}` makes {configurations:.1e} configurations")
            }
            Reason::TooManyJoints { joints, .. } => format!("`{key}` cannot serve {joints} joints"),
        }
    }

    /// What is allowed, to stand under the value.
    fn label(&self) -> String {
        match &self.reason {
            Reason::Syntax { .. } => "here".into(),
            Reason::UnknownKey { .. } => "unknown key".into(),
            Reason::UnknownName { .. } => "unknown name".into(),
            Reason::Missing { .. } | Reason::NoShape { .. } => "to be added here".into(),
            Reason::Type { expected, .. } => format!("must be {expected}"),
            Reason::OutOfRange { allowed, .. } if !self.written => {
                format!("give `{}` here: {allowed}", self.last_key())
            }
            Reason::OutOfRange { allowed, .. } => format!("must be {allowed}"),
            Reason::KnownExactly { least, .. } => format!("must be at least {least:.1e}"),
            Reason::Reversed { .. } => "must be [min, max]".into(),
            Reason::BoardBeyondZone { board, .. } => format!("must be at least {}", Number(*board)),
            Reason::Length { expected, per, .. } => format!("must have {expected}, one for each {per}"),
            Reason::Empty => "must not be empty".into(),
            Reason::NoArm => "needs one of the two".into(),
            Reason::Duplicate { .. } => "must occur only once".into(),
            Reason::Taken { .. } => "must be a name of its own".into(),
            Reason::NotApplicable { .. } => "has no meaning here".into(),
            Reason::Conflict { .. } => "only one may be given".into(),
            Reason::NotUnit { .. } => "must have norm 1".into(),
            Reason::FoldsBack { least, .. } => format!("must reach {:.0} % of the picture", 100.0 * least),
            Reason::CameraFile { error: FileReadError::Content(error), .. } => match error.fault {
                ReadFault::Mismatch { .. } => "does not agree".into(),
                ReadFault::UnknownCamera { .. } => "must name a camera of the file".into(),
                ReadFault::NotStated { .. } | ReadFault::SeveralCameras { .. } => "leaves this open".into(),
                ReadFault::OtherFormat { .. } | ReadFault::NoCamera { .. } => "names a file that is not read".into(),
                _ => format!("names a file with an error in line {}", error.line),
            },
            Reason::CameraFile { .. } => "must name a camera file".into(),
            Reason::Ambiguous { .. } => "must name one link".into(),
            Reason::Support { .. } => "must span an area".into(),
            Reason::NoMasses => "cannot be tested".into(),
            Reason::RobotFile { error: FileReadError::Robot(error), .. } if !error.is_of_another_file() => {
                format!("names a file with an error in line {}", error.line)
            }
            Reason::RobotFile { .. } => "must name a file that describes the robot".into(),
            Reason::BeyondUrdf { bounds: [min, max], .. } => {
                format!("must be within {} and {}", Number(*min), Number(*max))
            }
            Reason::NoLimits { .. } => "needs their ranges".into(),
            Reason::NoFolder { .. } => "must be an existing folder".into(),
            Reason::NothingMoves { .. } => "must be moved by a joint".into(),
            Reason::TooManyConfigurations { most, .. } => format!("must make at most {}", Number(*most as f64)),
            Reason::TooManyJoints { most, .. } => format!("serves at most {most}"),
        }
    }

    fn last_key(&self) -> &str {
        self.key.rsplit('.').next().unwrap_or_default()
    }

    fn hint(&self) -> Option<String> {
        let hint = match &self.reason {
            Reason::UnknownKey { allowed } => suggestion(self.last_key(), allowed, "keys here"),
            Reason::UnknownName { name, allowed } => suggestion(name, allowed, "allowed"),
            Reason::Missing { allowed } if !allowed.is_empty() => format!("choose one of {}", quoted(allowed)),
            Reason::NotApplicable { instead, .. } => instead.clone(),
            Reason::BoardBeyondZone { .. } => {
                "the printed board is one square larger each way than its inner corners; take a larger zone, smaller \
                 squares or fewer corners"
                    .into()
            }
            Reason::NoArm => {
                "write the arm's Denavit–Hartenberg table as `[[robot.joints]]`, or name its URDF file".into()
            }
            Reason::RobotFile { path, error: FileReadError::Robot(error) } if !error.is_of_another_file() => {
                format!("correct it there, in line {} of {}", error.line, path.display())
            }
            Reason::BeyondUrdf { joint, .. } => format!(
                "where the robot really goes farther than its description says, add \"{joint}\" to `robot.exceed_urdf_limits`"
            ),
            Reason::NoLimits { joints } => {
                let ranges = joints.iter().map(|name| format!("{name} = [min, max]")).collect::<Vec<_>>().join(", ");
                let unit = if self.last_key() == "limits_mm" { "mm" } else { "deg" };
                format!(
                    "give the ranges from the robot's manual, `limits_{unit} = {{ {ranges} }}`, or hold joints with \
                     `joint_values_{unit}`"
                )
            }
            Reason::NothingMoves { .. } => {
                "`camera_link` carries the camera, `target.link` the board; joints with a value \
                                            in `joint_values_deg` or `joint_values_mm` are held"
                    .into()
            }
            Reason::FoldsBack { .. } => {
                "check the signs and the order of the coefficients, that they are of this lens model (a fisheye is \
                 \"kannala-brandt\"), and that the focal lengths are in px, not in mm"
                    .into()
            }
            Reason::CameraFile { error: FileReadError::Content(error), .. } => return of_camera_file(&error.fault),
            Reason::TooManyConfigurations { .. } => "take a larger step, narrower joint limits, or a sample of them \
                                                     (`sample = 200000`); `axis = \"zone\"` holds only the \
                                                     configurations that point at the zone"
                .into(),
            Reason::KnownExactly { .. } => {
                "leave it out of `estimate.intrinsics`; what is left out is taken as known".into()
            }
            Reason::NoShape { allowed } => format!("give one of {}", quoted(allowed)),
            Reason::Ambiguous { .. } => "rename the joint".into(),
            Reason::NoMasses => "give them in `[[robot.masses]]`".into(),
            Reason::TooManyJoints { .. } => "give a grid with `step_deg` or `step_mm` instead".into(),
            _ => return self.meaning.clone(),
        };
        Some(hint)
    }
}

impl Diagnostic for Fault {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.hint().map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(Some(self.label()), self.span.clone()))))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        // The file's own text is the error's that holds the fault.
        self.given.as_ref().map(|line| line as &dyn SourceCode)
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

/// "did you mean" the name that other tools have `found` for, the most similar name, or all there are.
fn suggestion(found: &str, allowed: &[String], list: &str) -> String {
    const SIMILAR: f64 = 0.8;
    let same = |a: &str| a.replace('-', "_").eq_ignore_ascii_case(&found.replace('-', "_"));
    let known_as = |lens: &&Lens| lens.known_as().iter().any(|&other| same(other));
    if let Some(lens) = Lens::ALL.iter().find(known_as).filter(|lens| allowed.iter().any(|name| name == lens.name())) {
        return format!(
            "did you mean `{}`, which is what other tools call {found}? {list}: {}",
            lens.name(),
            quoted(allowed)
        );
    }
    // Case and the sign between words are no part of a name's meaning.
    let plain = |name: &str| name.to_lowercase().replace(['_', ' '], "-");
    let found = plain(found);
    let similarity = |name: &String| strsim::jaro_winkler(&found, &plain(name));
    match allowed.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b))) {
        Some(name) if similarity(name) > SIMILAR => format!("did you mean `{name}`? {list}: {}", quoted(allowed)),
        Some(_) => format!("{list}: {}", quoted(allowed)),
        None => "there is nothing to choose from".into(),
    }
}

fn quoted(names: &[String]) -> String {
    /// Robots may have a hundred links.
    const MOST: usize = 40;
    let quoted: Vec<String> = names.iter().take(MOST).map(|name| format!("`{name}`")).collect();
    let more = if names.len() > MOST { format!(" and {} more", names.len() - MOST) } else { String::new() };
    format!("{}{more}", quoted.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_hold_their_ends_and_no_nan() {
        let unit = Allowed::between(0.0, 1.0);
        assert!(unit.contains(0.0) && unit.contains(1.0));
        assert!(!unit.contains(-f64::MIN_POSITIVE) && !unit.contains(1.0f64.next_up()) && !unit.contains(f64::NAN));
        assert!(!Allowed::positive(1.0).contains(0.0) && Allowed::positive(1.0).contains(f64::MIN_POSITIVE));
        assert_eq!(unit.to_string(), "from 0 to 1");
        assert_eq!(Allowed::positive(1e9).to_string(), "greater than 0 and at most 1e9");
        let open = Allowed { min: Bound::Included(2.5), max: Bound::Unbounded };
        assert_eq!(open.to_string(), "at least 2.5");
    }
}
