//! What can be wrong with a file.

use thiserror::Error;

use crate::calibration::ObservationError;
use crate::target::BoardError;

/// What is wrong with a file, and where.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {fault}")]
pub struct ReadError {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub fault: ReadFault,
}

/// What is wrong with a file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReadFault {
    /// There is nothing in it.
    #[error("the file is empty")]
    Empty,
    /// The text is not of the format.
    #[error("{message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A key is left out.
    #[error("`{key}` is missing")]
    Missing {
        /// The key.
        key: String,
    },
    /// A key or an image's block of lines occurs twice.
    #[error("`{name}` occurs a second time")]
    Repeated {
        /// The key or the image.
        name: String,
    },
    /// A value has the wrong type.
    #[error("`{key}` is {found}; it must be {expected}")]
    Type {
        /// The key.
        key: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: &'static str,
    },
    /// A number is not allowed.
    #[error("`{key}` is {}; it must be {}", plain(*value), interval(*min, *max))]
    OutOfRange {
        /// The key.
        key: String,
        /// The number.
        value: f64,
        /// The least allowed.
        min: f64,
        /// The greatest allowed.
        max: f64,
    },
    /// A list has the wrong number of entries.
    #[error("`{key}` has {found} entries; it must have {expected}")]
    Length {
        /// The key.
        key: String,
        /// Entries found.
        found: usize,
        /// Entries needed.
        expected: String,
    },
    /// The numbers of a list are not separated.
    #[error("`{key}`: numbers in a list are separated by commas")]
    Commas {
        /// The list.
        key: String,
    },
    /// A name of something that calipose does not know.
    #[error("`{key}` is \"{found}\", which is not supported; supported: {supported}")]
    Unsupported {
        /// The key.
        key: String,
        /// The name found.
        found: String,
        /// The names that are supported.
        supported: &'static str,
    },
    /// A lens model that no [`Lens`](crate::camera::Lens) is.
    #[error("`{key}` is \"{found}\", which is not supported; supported: {supported}{}", after(instead))]
    LensModel {
        /// The key.
        key: String,
        /// The name found.
        found: String,
        /// The names that are supported.
        supported: String,
        /// What it is, and what to do; empty where that is not known.
        instead: &'static str,
    },
    /// A file of another tool that is known but not read.
    #[error("this is {what}, which is not supported; {instead}")]
    OtherFormat {
        /// What it is.
        what: &'static str,
        /// What to do.
        instead: &'static str,
    },
    /// A file in which nothing belongs to a board.
    #[error(
        "there is no board in the file; supported are Kalibr's targets, OpenCV's ChArUco boards and tables of points"
    )]
    NoBoard,
    /// What the file states is no board.
    #[error(transparent)]
    Board(BoardError),
    /// Rows and columns of a checkerboard are apart unequally.
    #[error("the rows are {rows} apart and the columns {columns}; only square squares are supported")]
    NotSquare {
        /// Distance of rows.
        rows: String,
        /// Distance of columns.
        columns: String,
    },
    /// A file in which nothing belongs to a camera.
    #[error("there is no camera in the file; supported are {read}")]
    NoCamera {
        /// The files that are read.
        read: String,
    },
    /// A coefficient beyond those of the lens model.
    #[error("`{key}` is {}: {model} has no such coefficient{}", plain(*value), after(instead))]
    Coefficient {
        /// The coefficient.
        key: String,
        /// Its value.
        value: f64,
        /// The lens model, as the file names it.
        model: String,
        /// What to do; empty where that is not known.
        instead: &'static str,
    },
    /// The pixels' rows and columns are not at right angles.
    #[error("`{key}` is {}: skew is not supported; a nominal camera must have 0 here", plain(*value))]
    Skew {
        /// The entry of the camera matrix.
        key: String,
        /// Its value, px.
        value: f64,
    },
    /// The images are parts of those that the calibration is of.
    #[error("`{key}` is {}: the images are not those of the calibration, but {what} of them; give the calibration of the images as they are used", plain(*value))]
    PartOfImage {
        /// The key.
        key: String,
        /// Its value.
        value: f64,
        /// What is left of them.
        what: &'static str,
    },
    /// The file has several cameras, and none is chosen.
    #[error("the file has the cameras {}; name one of them", names.join(", "))]
    SeveralCameras {
        /// Their names.
        names: Vec<String>,
    },
    /// The file does not have the camera that is asked for.
    #[error("there is no camera \"{name}\"; the file has {}", cameras(names))]
    UnknownCamera {
        /// The name asked for.
        name: String,
        /// Those that the file has; none where it has one camera without a name.
        names: Vec<String>,
    },
    /// A line has the wrong number of columns.
    #[error("{found} columns, but the header has {expected}")]
    Columns {
        /// Columns found.
        found: usize,
        /// Columns of the header.
        expected: usize,
    },
    /// An image does not have the board's corners.
    #[error("image \"{view}\" has {found} corners up to this line; the {board} has {corners}")]
    CornerCount {
        /// The image.
        view: String,
        /// Corners listed.
        found: usize,
        /// The board.
        board: String,
        /// Its corners.
        corners: usize,
    },
    /// The format does not state something, and nobody else has.
    #[error("this format does not state the {what}; it must be given separately")]
    NotStated {
        /// What.
        what: &'static str,
    },
    /// The file contradicts what is known.
    #[error("the {what} is {found} in the file, but given as {given}")]
    Mismatch {
        /// What.
        what: &'static str,
        /// As the file has it.
        found: String,
        /// As it is known.
        given: String,
    },
    /// The images are of several cameras.
    #[error("judging by their names, the images are from {} cameras: {}", cameras.len(), counts(cameras))]
    Cameras {
        /// What the names call each, and how many images it has.
        cameras: Vec<(String, usize)>,
    },
    /// No image is meant.
    #[error("none of the {of} image names matches `{pattern}`; the first is \"{first}\"")]
    NoImage {
        /// The form of the names.
        pattern: String,
        /// Images in the file.
        of: usize,
        /// Name of the first.
        first: String,
    },
    /// A joint that the robot does not have.
    #[error("there is no joint \"{name}\"; the robot's joints are {}", joints.join(", "))]
    UnknownJoint {
        /// The name found.
        name: String,
        /// The robot's.
        joints: Vec<String>,
    },
    /// Joints of the robot are left out.
    #[error("{} of the robot {} no value{}", all_of(joints), if joints.len() == 1 { "has" } else { "have" }, after(instead))]
    MissingJoints {
        /// The joints left out.
        joints: Vec<String>,
        /// What to do; empty where that is plain.
        instead: &'static str,
    },
    /// A column of joint values whose unit is not stated, or is of another kind of joint.
    #[error("the column \"{heading}\" {}; call it {}", if *is_stated { "has a unit that is not the joint's" } else { "does not state its unit" }, names.join(" or "))]
    JointUnit {
        /// The heading.
        heading: String,
        /// Whether there is a unit.
        is_stated: bool,
        /// The headings with their units that the column could have.
        names: [String; 2],
    },
    /// A file that lists poses in no way that is known.
    #[error("this is no list of poses that is known; read are {read}")]
    NoPoseList {
        /// The files that are read.
        read: String,
    },
    /// A list of poses without any.
    #[error("there are no poses in the file")]
    NoPoses,
    /// The detections of a view cannot be calibrated from.
    #[error("image \"{view}\"{}", without_number(fault))]
    View {
        /// The image.
        view: String,
        /// Why not.
        fault: ObservationError,
    },
    /// The detections as a whole cannot be calibrated from.
    #[error(transparent)]
    Observations(ObservationError),
}

impl ReadFault {
    pub(super) fn at(self, line: usize) -> ReadError {
        ReadError { line, fault: self }
    }
}

/// `text` after a semicolon, if there is any.
fn after(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("; {text}") }
}

/// `joint a`, or `joints a, b`.
fn all_of(joints: &[String]) -> String {
    format!("{} {}", if joints.len() == 1 { "joint" } else { "joints" }, joints.join(", "))
}

fn cameras(names: &[String]) -> String {
    if names.is_empty() { "a single camera, which needs no name".to_owned() } else { names.join(", ") }
}

/// Most cameras that are named.
const MOST_NAMED: usize = 8;

fn counts(cameras: &[(String, usize)]) -> String {
    let named = cameras.iter().take(MOST_NAMED).map(|(name, count)| format!("{name} ({count} images)"));
    let mut text = named.collect::<Vec<_>>().join(", ");
    if cameras.len() > MOST_NAMED {
        text += &format!(" and {} more", cameras.len() - MOST_NAMED);
    }
    text
}

/// A number as one would write it: very large and very small ones with an exponent.
fn plain(x: f64) -> String {
    let size = x.abs();
    if size >= 1e7 || (size > 0.0 && size < 1e-4) { format!("{x:e}") } else { x.to_string() }
}

fn interval(min: f64, max: f64) -> String {
    if min == max { plain(min) } else { format!("from {} to {}", plain(min), plain(max)) }
}

/// The fault of a view without the view's number, which counts neither lines nor images: ` has 3 corners`, `: corner 5 …`.
fn without_number(fault: &ObservationError) -> String {
    let text = fault.to_string();
    let unnumbered = text.strip_prefix("view ").map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
    unnumbered.map_or_else(|| format!(": {text}"), str::to_owned)
}
