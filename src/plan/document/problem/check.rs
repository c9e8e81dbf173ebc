//! What a run would find and do, as `calipose check --json` prints it.

use schemars::JsonSchema;
use serde::Serialize;

use super::{CameraSights, SelfCollision};
use crate::camera::Camera;
use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::plan::document::plan::CollisionDocument;
use crate::plan::survey::{Diagnosis, Obstacle, Smell};

/// A valid problem, and what a run on it would find and take.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CheckDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem.
    pub problem: ProblemReference,
    /// Configurations to sweep.
    pub configurations: usize,
    /// Views that are likely among them.
    pub estimated_views: usize,
    /// Poses that would be chosen: as many as asked for, or the fewest that reach the accuracies; `null` where that cannot be
    /// told.
    pub estimated_poses: Option<usize>,
    /// Time that a run would take on this machine, a search for the proven best set left out.
    pub estimated_seconds: Option<f64>,
    /// Time after which that search ends at the latest; `null` where there is none.
    pub search_limit_seconds: Option<f64>,
    /// Memory that a run would take at most.
    pub estimated_memory_mb: Option<f64>,
    /// That this may be more than there is.
    pub memory_warning: Option<String>,
    /// Why views are scarce; `null` where they are not.
    pub diagnosis: Option<DiagnosisDocument>,
    /// Where the camera looks.
    pub camera: CameraSights,
    /// How much of the picture the lens reaches.
    pub lens: LensDocument,
    /// What poses are tested for that could be hit, as in plans.
    pub collision: CollisionDocument,
    /// The pairs of links by what is done about them; `null` for robots without bodies.
    pub self_collision: Option<SelfCollision>,
    /// Mass of the robot; `null` where no masses are given.
    pub mass_kg: Option<f64>,
    /// What was read otherwise than it stands in the files.
    pub notes: Vec<NoteDocument>,
}

/// Why views are scarce.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DiagnosisDocument {
    /// Configurations that were tried.
    pub tried: usize,
    /// Views among them.
    pub views: usize,
    /// What stops most; `null` where nothing does.
    pub obstacle: Option<ObstacleDocument>,
    /// What looks like a slip in the problem file.
    pub suspicions: Vec<Suspicion>,
}

/// What keeps configurations from being views.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ObstacleDocument {
    /// Its name.
    pub reason: String,
    /// Whether it stops all configurations, or only most.
    pub stops_all: bool,
    /// How near the nearest configuration comes, in words.
    pub nearest: String,
    /// What to do about it.
    pub advice: String,
}

/// Something that looks like a slip.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Suspicion {
    /// Its name.
    pub name: String,
    /// What is suspected, in words.
    pub sentence: String,
}

/// How much of the picture the lens reaches.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LensDocument {
    /// The lens model.
    pub model: String,
    /// Share of the picture that it reaches.
    pub picture_reached: f64,
    /// Angle off the optical axis beyond which the model folds back and nothing is seen; `null` where it does not.
    pub folds_back_at_deg: Option<f64>,
}

/// What was read otherwise than it stands in a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NoteDocument {
    /// The key that it is about.
    pub key: String,
    /// What was read.
    pub note: String,
}

impl Document for CheckDocument {
    const FORMAT: &'static str = "calipose.check";
    const VERSION: u32 = 2;
}

impl DiagnosisDocument {
    pub(crate) fn new(diagnosis: &Diagnosis) -> Self {
        let obstacle = |Obstacle { stops_all, nearest }: &Obstacle| ObstacleDocument {
            reason: nearest.name().into(),
            stops_all: *stops_all,
            nearest: nearest.to_string(),
            advice: nearest.advice().into(),
        };
        let suspicion = |smell: &Smell| Suspicion { name: smell.name().into(), sentence: smell.to_string() };
        Self {
            tried: diagnosis.tried,
            views: diagnosis.views,
            obstacle: diagnosis.obstacle.as_ref().map(obstacle),
            suspicions: diagnosis.smells.iter().map(suspicion).collect(),
        }
    }
}

impl LensDocument {
    pub(crate) fn new(camera: &Camera) -> Self {
        Self {
            model: camera.lens().name().into(),
            picture_reached: camera.coverage(),
            folds_back_at_deg: camera.fold().map(f64::to_degrees),
        }
    }
}
