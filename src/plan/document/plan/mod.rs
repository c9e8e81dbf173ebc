//! The plan as it is written, and what is written beside it.

mod collision;
mod polished;
mod pose;
mod proof;
mod reading;
mod robustness;
mod run;
mod survey_counts;
mod tour;

pub use collision::CollisionDocument;
pub use polished::{GridPlan, PROVEN, PolishedPlan};
pub use pose::{PlannedPose, Pose, joints_deg};
pub(crate) use pose::{joint_columns, poses_csv};
pub use proof::{
    AccuracyDocument, BallPrice, CertificateDocument, CertificateTerm, Certificates, ContinuumDocument, FewestDocument,
    PicturePrice, Price, SearchDocument,
};
pub(in crate::plan::document) use reading::read;
pub use reading::{PlanReadError, PlannedPoses};
pub use robustness::{RobustnessDocument, ScenarioDocument, SeenView, TrialDocument};
pub use run::{Run, RunProblem, RunSeconds};
pub use survey_counts::SurveyCounts;
pub(crate) use survey_counts::rejected_by_name;
pub use tour::{GaveWayDocument, MoveDocument, TourDocument, TradeDocument};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::feasibility::View;
use crate::plan::choose::{Chooser, ContinuumCertificate, Decision, PlanError};
use crate::plan::document::header::{Document, Header, ProblemReference, finite};
use crate::robot::Joint;

/// A calibration plan, key by key as in `plan.json`. SI units, angles in rad unless the key says otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Plan {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem it answers.
    pub problem: ProblemReference,
    /// Name of the criterion; of several with their shares, `0.8 v + 0.2 diversity`; `accuracy` where accuracies were requested
    /// for.
    pub criterion: String,
    /// Name of the method.
    pub method: String,
    /// Number of poses, k.
    pub count: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// Pictures to take at each pose; 1 where it is not said.
    #[serde(skip_serializing_if = "is_one", default = "one")]
    pub pictures: usize,
    /// The criterion's value: log det for `d` and `diversity`, a variance in px² for `a` and `v`, an eigenvalue for `e` and
    /// `zhang`, the weighted geometric mean Φ of several; for accuracies the least of (requested / reached)².
    pub value: f64,
    /// What no k of the views can surpass: a lower bound for `a` and `v`, an upper bound for the others.
    pub bound: f64,
    /// Certified efficiency: the share of the best possible information that the plan has at least.
    pub efficiency: f64,
    /// What the poses were chosen from, in numbers.
    pub survey: SurveyCounts,
    /// What the poses were tested for that could be hit; plans of older versions do not say.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub collision: Option<CollisionDocument>,
    /// Predicted standard deviations.
    pub intrinsics: Intrinsics,
    /// Predicted RMS error of the calibrated projection over the image, in px.
    pub map_error_px: f64,
    /// What plain least squares would make of the poses, where the corners scatter unequally.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unweighted: Option<UnweightedAccuracy>,
    /// The pose whose picture is missed most; plans of older versions, and of one pose, do not say.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub worst_loss: Option<WorstLoss>,
    /// What the poses are worth where the set-up is not quite as stated, if that was asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub robust: Option<RobustnessDocument>,
    /// The proofs of the bounds.
    pub certificate: Certificates,
    /// How the search for the proven best set went, if there was one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub search: Option<SearchDocument>,
    /// Why no fewer poses suffice, if accuracies were requested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fewest: Option<FewestDocument>,
    /// Names of the joints, in the order of the poses' joint values.
    pub joints: Vec<String>,
    /// The poses, by ascending id.
    pub poses: Vec<PlannedPose>,
    /// The order in which they take least time; plans of older versions do not say.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub tour: Option<TourDocument>,
    /// Joint values, rad (m for prismatic joints), of the views off the grid that the poses were chosen from too; their ids go on
    /// after those of the swept configurations and of those tried around picked poses.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub off_grid: Vec<Vec<f64>>,
}

pub(super) fn one() -> usize {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
pub(in crate::plan::document) fn is_one(count: &usize) -> bool {
    *count == 1
}

/// The estimated intrinsics; lists of one length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Intrinsics {
    /// Names.
    pub names: Vec<String>,
    /// Nominal values.
    pub nominal: Vec<f64>,
    /// Predicted standard deviations.
    pub sigma: Vec<f64>,
}

/// What a calibration that gives all corners one weight, as OpenCV's `calibrateCamera` does, makes of the poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnweightedAccuracy {
    /// Predicted standard deviations of the intrinsics, in their order.
    pub sigma: Vec<f64>,
    /// Predicted RMS error of the calibrated projection over the image, in px.
    pub map_error_px: f64,
}

/// The pose without which the predicted map error is greatest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorstLoss {
    /// Its id.
    pub id: usize,
    /// Predicted RMS error of the calibrated projection over the image without it, in px; none where the others leave an intrinsic
    /// undetermined.
    pub map_error_px: Option<f64>,
}

impl WorstLoss {
    /// Of poses by id, from the map error without each.
    pub(crate) fn new(without_each: impl Iterator<Item = (usize, f64)>) -> Option<Self> {
        let undetermined = |map_error: f64| if map_error.is_nan() { f64::INFINITY } else { map_error };
        let (id, map_error) = without_each
            .map(|(id, map_error)| (id, undetermined(map_error)))
            .reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        Some(Self { id, map_error_px: finite(map_error) })
    }
}

impl UnweightedAccuracy {
    /// Of `views`, in the survey of `chooser` or not; `None` where weights change nothing.
    pub(crate) fn new<'v>(chooser: &Chooser, views: impl IntoIterator<Item = &'v View>) -> Option<Self> {
        chooser.unweighted(views).map(|(sigma, map_error_px)| Self { sigma, map_error_px })
    }
}

impl Document for Plan {
    const FORMAT: &'static str = "calipose.plan";
    const VERSION: u32 = 5;
}

impl Plan {
    /// The plan of a decision of `chooser`.
    ///
    /// # Errors
    /// When the choice is not the chooser's.
    pub fn new(chooser: &Chooser, decision: &Decision) -> Result<Self, PlanError> {
        let problem = chooser.problem();
        let settings = &problem.selection;
        let survey = chooser.survey();
        let choice = &decision.choice;
        let names = problem.unknowns().names();
        let shares = chooser.shares(&choice.selected)?;
        let poses = choice.selected.iter().zip(shares);
        let views: Vec<View> = choice.selected.iter().map(|&i| survey.views[i].clone()).collect();
        let document = |certificate| CertificateDocument::new(chooser.objective(), &survey.views, certificate);
        let fewest = decision.fewest.as_ref().map(|proof| FewestDocument {
            accuracies: chooser.reached(choice).into_iter().map(AccuracyDocument::new).collect(),
            least: proof.least,
            found: Some(proof.found).filter(|&found| found < choice.selected.len()),
            refutation: proof.refutation.as_ref().map(|refutation| document(&refutation.certificate)),
            nodes: proof.refutation.as_ref().map_or(0, |refutation| refutation.nodes),
        });
        let poses: Vec<PlannedPose> =
            poses.map(|(&i, share)| PlannedPose::new(problem, &survey.views[i], share)).collect();
        Ok(Self {
            header: Self::header(),
            problem: ProblemReference::new(problem),
            criterion: chooser.criterion(),
            method: settings.goal.method().name().into(),
            count: choice.selected.len(),
            seed: settings.seed,
            pictures: settings.pictures,
            value: chooser.natural(choice.log_value),
            bound: chooser.natural(decision.log_bound),
            efficiency: (choice.log_value - decision.log_bound).exp(),
            survey: SurveyCounts::new(survey),
            collision: Some(CollisionDocument::new(problem, &survey.links)),
            intrinsics: Intrinsics {
                names: names.iter().map(|&name| name.into()).collect(),
                nominal: problem.unknowns().values(),
                sigma: choice.sigma.clone(),
            },
            map_error_px: choice.map_error,
            unweighted: UnweightedAccuracy::new(chooser, &views),
            worst_loss: worst_loss(chooser, &choice.selected),
            robust: RobustnessDocument::new(chooser, &views),
            certificate: Certificates { grid: document(&decision.certificate), continuum: None },
            search: decision.search.as_ref().map(SearchDocument::new),
            fewest,
            joints: problem.robot.chain.joints.iter().map(|joint| joint.name.clone()).collect(),
            tour: Some(TourDocument::new(chooser, &poses, decision)),
            poses,
            off_grid: survey.off_grid_views().iter().map(|view| view.q.clone()).collect(),
        })
    }

    /// The same plan, of a decision of `chooser`, with the bound over all joint values.
    #[must_use]
    pub fn within_continuum(mut self, chooser: &Chooser, decision: &Decision, bound: &ContinuumCertificate) -> Self {
        let document = ContinuumDocument::new(chooser.objective(), bound, decision.choice.log_value);
        self.certificate.continuum = Some(document);
        self
    }

    /// The poses in the order in which to take them: that of the tour, by ascending id in plans without one.
    pub fn in_order(&self) -> Vec<&PlannedPose> {
        tour::in_order(&self.poses, self.tour.as_ref())
    }

    /// The bytes of `plan.csv`: one pose a line under a header, in the order in which to take them, the values of all of `joints` in rad (m) under
    /// `joint_<name>_rad` (`_m`), then in degrees (mm) under `joint_<name>_deg` (`_mm`). The last column, `stability_margin_m`,
    /// is there where stability is tested.
    ///
    /// # Errors
    /// Never in practice: the writer writes to memory.
    pub fn to_csv(&self, joints: &[Joint]) -> Result<Vec<u8>, csv::Error> {
        poses_csv(joints, self.in_order())
    }
}

/// Which of the poses is missed most, if it is not the only one.
fn worst_loss(chooser: &Chooser, selected: &[usize]) -> Option<WorstLoss> {
    let without = |&leaving: &usize| {
        let others = selected.iter().copied().filter(|&i| i != leaving).collect();
        (chooser.survey().views[leaving].id, chooser.assess(others).map_error)
    };
    if selected.len() > 1 { WorstLoss::new(selected.iter().map(without)) } else { None }
}
