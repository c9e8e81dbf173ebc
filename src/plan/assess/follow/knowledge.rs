//! What the pictures so far tell of the camera.

use crate::calibration::{
    Assessment, Calibration, CalibrationError, CalibrationSettings, Judgement, LossKind, Observations, calibrate_by,
    other_lens,
};
use crate::plan::assess::next::after;
use crate::problem::Problem;
use crate::selection::packed::unpack;
use crate::target::Corners;

use super::until::Until;
use super::ways::Leg;

/// Fewest measurements beyond the unknowns from which the noise, and with it any accuracy, is known to 7 %.
const FEWEST_EXCESS: usize = 100;

/// What the pictures so far tell of the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// The views.
    pub observations: Observations,
    /// The calibration by them.
    pub calibration: Calibration,
    /// What it is worth if the tour ended now.
    pub assessment: Assessment,
    /// Map error predicted after all poses that are left, px; none where there are none or one is no view of the camera found.
    pub expected: Option<f64>,
    /// Whether so much was measured that its accuracy is known.
    is_sure: bool,
}

/// How calibrations of the problem's pictures are made.
pub(super) fn settings(problem: &Problem) -> CalibrationSettings {
    CalibrationSettings { noise: problem.noise.model, warp: problem.target.warp, ..CalibrationSettings::default() }
}

impl Known {
    /// Calibrates from the views, and predicts what the poses that are `left` would add.
    pub(super) fn new(
        problem: &Problem,
        observations: Observations,
        until: &Until,
        left: &[Leg],
    ) -> Result<Self, CalibrationError> {
        let (loss, settings) = (LossKind::Squared, settings(problem));
        let calibration = calibrate_by(loss, &observations, &problem.camera, &problem.estimated, &settings)?;
        let assess = |other| Assessment::new(&observations, &calibration, loss, other, &until.requests);
        let mut assessment = assess(None);
        if assessment.judgement == Judgement::Good {
            // Other lenses are tried only where nothing else speaks against this one.
            assessment = assess(other_lens(&observations, problem.camera.lens(), settings.warp));
        }
        let unknown = calibration.estimated.len() + 6 * observations.views().len();
        let is_sure = 2 * observations.corner_count() >= unknown + FEWEST_EXCESS;
        let expected = expected(problem, &calibration, left);
        Ok(Self { observations, calibration, assessment, expected, is_sure })
    }

    /// Whether the tour may end: the accuracies are reached by a calibration that nothing speaks against.
    pub fn reaches(&self) -> bool {
        self.is_close(1.0) && self.objection().is_none()
    }

    /// Whether that will do where no pose is left.
    pub(super) fn will_do(&self, until: &Until) -> bool {
        self.is_close(until.share_in_the_end()) && self.objection().is_none()
    }

    /// Whether the accuracies predicted are those requested or better, to that share.
    pub(super) fn is_close(&self, share: f64) -> bool {
        self.assessment.requested.iter().all(|accuracy| accuracy.reached <= share * accuracy.limit)
    }

    /// What speaks against the calibration beside its accuracy.
    pub(super) fn objection(&self) -> Option<String> {
        match self.assessment.judgement {
            Judgement::Good | Judgement::Missed(_) if self.is_sure => None,
            Judgement::Good | Judgement::Missed(_) => Some("So few corners do not tell the noise.".into()),
            _ => Some(self.assessment.verdict.clone()),
        }
    }
}

/// Root mean square map error, px, linearised about the camera found, once all poses that are left are taken as planned.
fn expected(problem: &Problem, calibration: &Calibration, left: &[Leg]) -> Option<f64> {
    if left.is_empty() {
        return None;
    }
    let problem = after(problem, calibration);
    let measurement = problem.measurement();
    let mut information = calibration.joint_covariance.clone().cholesky()?.inverse();
    for Leg { pose, .. } in left {
        let X_CT = problem.robot.camera_pose(&pose.joints_rad).inverse() * problem.target.X_BT;
        let seen = pose.corners_seen.clone().map_or(Corners::All, Corners::Some);
        information += unpack(&measurement.information(&X_CT, &seen)?, measurement.order());
    }
    let covariance = measurement.covariance(&information)?;
    let map_error = (problem.unknowns().map_error_weight() * covariance).trace().sqrt();
    map_error.is_finite().then_some(map_error)
}
