//! The problem: models and settings, as a problem file states them.
//!
//! A problem file is TOML. [`schema_json`] describes its keys, [`STARTER`] is one to start from, [`Problem::read`] checks
//! one and builds the models. Everything wrong with a file is a [`Fault`] with its line, column and key.

mod builder;
mod constraints;
#[cfg(feature = "cli")]
mod diagnostic;
mod disturbance;
mod draft;
mod error;
mod fault;
mod goal;
mod method;
mod motion;
mod note;
mod resolve;
mod robust;
mod schema;
mod text;

pub use builder::ProblemBuilder;
pub use constraints::{JointRegion, PoseConstraints, PoseGroup};
pub use disturbance::StatedDisturbance;
pub(crate) use draft::relative;
pub use draft::{DraftError, draft};
pub use error::{ProblemError, SourceFile};
pub use fault::{Allowed, Fault, Reason};
pub use goal::{Accuracy, Goal, Least, SelectionSettings};
pub use method::Method;
pub use motion::{Home, MotionSettings};
pub use note::Note;
pub use robust::{RobustGoal, Robustness, Uncertainty};
pub use schema::schema_json;
pub use text::{OverrideError, Overrides};

use std::path::{Path, PathBuf};

use crate::calibration::Request;
use crate::camera::Camera;
use crate::feasibility::{Checks, Stability, VisibilityLimits};
use crate::formats::read_at_most;
use crate::information::{Measurement, Noise, Unknowns};
use crate::robot::Robot;
use crate::sweep::{AxisRule, JointSpace};
use crate::target::Target;
pub(crate) use resolve::{Check, slug};
pub(crate) use schema::{Choice, Named, Numbers, Vocabulary, toml_schema};
pub(crate) use text::{At, KeyPath, Optional, Source, excluded_by, key, read};

/// A commented problem file to start from.
pub const STARTER: &str = include_str!("starter.toml");

/// A checked problem, in metres, radians and pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Name of the problem.
    pub name: String,
    /// SHA-256 of the problem file's bytes, in lower-case hexadecimal.
    pub sha256: String,
    /// Values given in place of the file's, those left out that say the same.
    pub overrides: Overrides,
    /// The arm and the camera's mount.
    pub robot: Robot,
    /// The nominal camera.
    pub camera: Camera,
    /// The board and its zone.
    pub target: Target,
    /// The joint configurations to sweep.
    pub space: JointSpace,
    /// More configurations around the poses that selection picks.
    pub refinement: Refinement,
    /// What others published of the sweep at various steps.
    pub published: Vec<PublishedSweep>,
    /// The axis test.
    pub axis: AxisRule,
    /// What a view must satisfy.
    pub visibility: VisibilityLimits,
    /// Least distance in m between links; touching is a collision at 0.
    pub clearance: f64,
    /// What the robot stands on, where its stability is to be tested.
    pub stability: Option<Stability>,
    /// How far detected corners scatter.
    pub noise: Noise,
    /// The intrinsics to estimate: indices into the camera's, ascending.
    pub estimated: Vec<usize>,
    /// Standard deviations known beforehand, of estimated intrinsics by index among them.
    pub prior_sigma: Vec<(usize, f64)>,
    /// What the plan must withstand; none for the set-up as stated alone.
    pub robust: Option<Robustness>,
    /// What to select.
    pub selection: SelectionSettings,
    /// Which sets of poses are allowed.
    pub constraints: PoseConstraints,
    /// How the robot goes from pose to pose.
    pub motion: MotionSettings,
    /// Folder for the plan, relative to the working directory.
    pub output: PathBuf,
    /// What was read otherwise than it stands in the files, put right or left out.
    pub notes: Vec<Note>,
}

/// How candidates are refined around the poses that selection picks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refinement {
    /// Rounds; 0 for none.
    pub rounds: usize,
    /// Configurations tried in each round.
    pub sample: usize,
}

/// Published counts of a sweep with one step for all joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedSweep {
    /// The step in rad.
    pub step: f64,
    /// Configurations.
    pub swept: usize,
    /// Those whose optical axis meets the zone.
    pub in_zone: usize,
}

/// Bytes of a problem file; a larger one is something else.
const LARGEST: u64 = 16_000_000;

/// Most configurations that a sweep may have. One that keeps all of them as candidates holds them all in memory; one
/// that keeps those that point at the zone only takes time.
fn most_configurations(rule: AxisRule) -> usize {
    match rule {
        AxisRule::Any => 100_000_000,
        AxisRule::Zone => 10_000_000_000,
    }
}

/// The text of a file that people write.
///
/// # Errors
/// When the file cannot be read, or is no UTF-8.
pub(crate) fn read_text(path: &Path) -> Result<String, ProblemError> {
    let bytes = read_at_most(path, LARGEST).map_err(|source| ProblemError::Read { path: path.into(), source })?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = String::from_utf8_lossy(valid).matches('\n').count() + 1;
        ProblemError::Encoding { path: path.into(), line }
    })
}

impl Problem {
    /// The tests that make a configuration a view.
    pub fn checks(&self) -> Checks<'_> {
        let Self { robot, camera, target, visibility, clearance, stability, .. } = self;
        Checks::new(robot, camera, target, visibility, *clearance, stability.as_ref())
    }

    /// Least distance of the board's pictures from two poses, px; 0 for none. Swept poses are apart by their steps.
    pub fn picture_separation(&self) -> f64 {
        let stated = self.constraints.picture_separation;
        stated.unwrap_or(if self.selection.leaves_grid() { PoseConstraints::PICTURE_SEPARATION } else { 0.0 })
    }

    /// The intrinsics to estimate, of the nominal camera.
    pub fn unknowns(&self) -> Unknowns<'_> {
        Unknowns { camera: &self.camera, estimated: &self.estimated }
    }

    /// The accuracies that are requested, as a calibration is held against them.
    pub fn requests(&self) -> Vec<Request> {
        let request = |&(accuracy, requested): &(Accuracy, f64)| match accuracy {
            Accuracy::MapError => Some(Request::MapError(requested)),
            Accuracy::Intrinsic(j) => {
                self.estimated.get(j).map(|&intrinsic| Request::Sigma { intrinsic, sigma: requested })
            }
        };
        self.selection.goal.accuracies().iter().filter_map(request).collect()
    }

    /// What a planned view measures, with all its pictures.
    pub fn measurement(&self) -> Measurement<'_> {
        Measurement { pictures: self.selection.pictures, ..self.measurement_of_one_picture() }
    }

    /// What a view taken already measures.
    pub fn measurement_of_one_picture(&self) -> Measurement<'_> {
        Measurement { warp: self.target.warp, ..Measurement::new(self.unknowns(), &self.target.board, self.noise) }
    }

    /// The problem that the file at `path` states.
    ///
    /// # Errors
    /// When the file cannot be read or says something impossible.
    pub fn read(path: &Path) -> Result<Self, ProblemError> {
        Self::read_with(path, &Overrides::new())
    }

    /// The problem that the file at `path` states, with other values for some of its keys.
    ///
    /// # Errors
    /// When the file cannot be read, or the two together say something impossible.
    pub fn read_with(path: &Path, overrides: &Overrides) -> Result<Self, ProblemError> {
        Self::parse_with(&read_text(path)?, path, overrides)
    }

    /// The problem that `text` states; `path` is its name in messages and, without the extension, the name of a
    /// problem that gives none. A camera file is sought from the folder of `path`.
    ///
    /// # Errors
    /// When the text says something impossible.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ProblemError> {
        Self::parse_with(text, path, &Overrides::new())
    }

    /// As [`Problem::parse`], with other values for some of the keys.
    ///
    /// # Errors
    /// When the two together say something impossible.
    pub fn parse_with(text: &str, path: &Path, overrides: &Overrides) -> Result<Self, ProblemError> {
        let source = Source::new(text, overrides);
        let problem = match text::read(&source, Vocabulary::of_problems()) {
            Ok((document, file)) => resolve::resolve(&document, &file, path),
            Err(fault) => Err(vec![*fault]),
        };
        problem.map_err(|faults| ProblemError::Invalid {
            file: SourceFile { name: path.to_string_lossy().into_owned(), text: text.to_owned() },
            faults,
        })
    }
}
