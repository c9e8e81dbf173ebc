//! What a plan is worth where the set-up is not quite as stated.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::pose::{Pose, corners_seen};
use crate::feasibility::View;
use crate::plan::choose::Chooser;
use crate::plan::document::header::finite;
use crate::plan::survey::{Scene, Trial};

/// What a plan is worth where the set-up is not quite as stated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RobustnessDocument {
    /// What was made great over the scenarios: "mean" or "worst".
    pub goal: String,
    /// The scenarios, the set-up as stated first.
    pub scenarios: Vec<ScenarioDocument>,
    /// The poses tried in set-ups drawn anew.
    pub trial: TrialDocument,
}

/// A set-up that the plan was made for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScenarioDocument {
    /// The intrinsics, all of the lens's.
    pub intrinsics: Vec<f64>,
    /// Predicted map error in px; none where what is seen does not determine the intrinsics.
    pub map_error_px: Option<f64>,
    /// What the plan's poses show; none where one is no view.
    pub views: Vec<Option<SeenView>>,
}

/// What a pose shows in another set-up than that stated. The board is where it was stated to be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SeenView {
    /// Pose of the camera in the base frame.
    pub camera_in_base: Pose,
    /// The corners seen, by index row by row. Left out where all are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corners_seen: Option<Vec<usize>>,
}

/// Poses tried in set-ups drawn anew. A map error is none where what is seen does not determine the intrinsics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrialDocument {
    /// Number of set-ups.
    pub set_ups: usize,
    /// Of each pose the share of the set-ups in which it is a view.
    pub seen: Vec<f64>,
    /// Map error that half of the set-ups do not exceed, px.
    pub median_map_error_px: Option<f64>,
    /// Map error that 99 % of the set-ups do not exceed, px.
    pub map_error_of_99_percent_px: Option<f64>,
    /// The greatest map error, px.
    pub worst_map_error_px: Option<f64>,
}

impl RobustnessDocument {
    /// Of views of the set-up as stated; `None` where no robustness is asked for.
    pub(crate) fn new(chooser: &Chooser, views: &[View]) -> Option<Self> {
        let problem = chooser.problem();
        let goal = problem.robust.as_ref()?.goal;
        let trial = Trial::of(problem, views, &chooser.information(&[]))?;
        let scenes = chooser.survey().scenes(problem);
        let scenarios = scenes.iter().zip(chooser.known()).map(|(scene, known)| {
            let seen: Vec<_> = views.iter().map(|view| scene.view(view)).collect();
            ScenarioDocument::new(scene, &seen, finite(scene.map_error(&seen, known)))
        });
        Some(Self { goal: goal.name().into(), scenarios: scenarios.collect(), trial: TrialDocument::new(trial) })
    }
}

impl ScenarioDocument {
    /// Of what the views show there.
    pub(crate) fn new(scene: &Scene, seen: &[Option<View>], map_error_px: Option<f64>) -> Self {
        let seen_view = |View { X_BC, seen, .. }: &View| SeenView {
            camera_in_base: Pose::new(X_BC),
            corners_seen: corners_seen(seen),
        };
        Self {
            intrinsics: scene.measurement.unknowns.camera.intrinsics().to_vec(),
            map_error_px,
            views: seen.iter().map(|view| view.as_ref().map(seen_view)).collect(),
        }
    }
}

impl TrialDocument {
    /// Of what became of the poses.
    pub(crate) fn new(trial: Trial) -> Self {
        let map_error = |share| finite(trial.map_error_of(share));
        Self {
            set_ups: Trial::SET_UPS,
            median_map_error_px: map_error(0.5),
            map_error_of_99_percent_px: map_error(0.99),
            worst_map_error_px: map_error(1.0),
            seen: trial.seen,
        }
    }
}
