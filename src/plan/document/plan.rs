//! The plan as it is written: `plan.json` and `plan.csv`.

use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::proof::{AccuracyDocument, CertificateDocument, FewestDocument, SearchDocument};
use crate::feasibility::{Rejection, View};
use crate::information::Criterion;
use crate::plan::choose::Decision;
use crate::plan::choose::{Chooser, PlanError};
use crate::plan::survey::CollisionDocument;
use crate::plan::survey::Survey;

use crate::problem::{OverrideError, Overrides, Problem};
use crate::robot::{Chain, Joint, JointKind};
use crate::target::Corners;

/// Value of the key `format`.
pub const PLAN_FORMAT: &str = "calipose.plan";

/// Value of the key `version`; rises when a reader of the older version would misread the file.
pub const PLAN_VERSION: u32 = 2;

/// A calibration plan, key by key as in `plan.json`. SI units, angles in rad unless the key says otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// [`PLAN_FORMAT`].
    pub format: String,
    /// [`PLAN_VERSION`].
    pub version: u32,
    /// Version of calipose that made the plan.
    pub calipose: String,
    /// The problem it answers.
    pub problem: ProblemReference,
    /// Name of the criterion; of several with their shares, `0.8 v + 0.2 diversity`; `accuracy` where accuracies were wished
    /// for.
    pub criterion: String,
    /// Name of the method.
    pub method: String,
    /// Number of poses, k.
    pub count: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// The criterion's value: log det for `d` and `diversity`, a variance in px² for `a` and `v`, an eigenvalue for `e` and
    /// `zhang`, the weighted geometric mean Φ of several; for accuracies the least of (wished / reached)².
    pub value: f64,
    /// What no k of the candidates can surpass: a lower bound for `a` and `v`, an upper bound for the others.
    pub bound: f64,
    /// Certified efficiency: the share of the best possible information that the plan has at least.
    pub efficiency: f64,
    /// Where the poses were chosen from.
    pub candidates: Candidates,
    /// What the poses were tested for that could be hit; plans of older versions do not say.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub collision: Option<CollisionDocument>,
    /// Predicted standard deviations.
    pub intrinsics: Intrinsics,
    /// Predicted RMS error of the calibrated projection over the image, in px.
    pub map_error_px: f64,
    /// The proof of the bound; where a search followed, of the bound that it started from.
    pub certificate: CertificateDocument,
    /// How the search for the proven best set went, if there was one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub search: Option<SearchDocument>,
    /// Why no fewer poses suffice, if accuracies were wished for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fewest: Option<FewestDocument>,
    /// Names of the joints, in the order of the poses' joint values.
    pub joints: Vec<String>,
    /// The poses, by ascending id.
    pub poses: Vec<PlannedPose>,
}

/// Why a text is not a plan.
#[derive(Debug, Error)]
pub enum PlanReadError {
    /// It is not JSON, or a key is missing or of the wrong type.
    #[error("not a plan: {0}")]
    Json(serde_json::Error),
    /// It is another kind of document.
    #[error("the key `format` is \"{found}\"; a plan says \"{PLAN_FORMAT}\"")]
    Format {
        /// What it says.
        found: String,
    },
    /// It is of another version.
    #[error("the plan is of version {found}; this program reads version {PLAN_VERSION}")]
    Version {
        /// What it says.
        found: String,
    },
}

/// The problem file a plan was made from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProblemReference {
    /// Its name.
    pub name: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Values given in place of the file's, `KEY = VALUE` each.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub set: Vec<String>,
}

impl ProblemReference {
    /// What `problem` was read from.
    pub fn new(problem: &Problem) -> Self {
        Self { name: problem.name.clone(), sha256: problem.sha256.clone(), set: problem.overrides.of_results() }
    }

    /// The values given in place of the file's.
    ///
    /// # Errors
    /// When one is no `KEY = VALUE`.
    pub fn overrides(&self) -> Result<Overrides, OverrideError> {
        self.set.iter().try_fold(Overrides::new(), |overrides, text| overrides.set(text))
    }
}

/// Counts of the sweep.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Candidates {
    /// Configurations swept.
    pub swept: usize,
    /// Optical axes that fall inside the zone.
    pub axis_inside: usize,
    /// Optical axes that fall on the zone's edge.
    pub axis_edge: usize,
    /// Configurations tried around picked poses, beside the swept ones.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub refined: usize,
    /// Configurations that passed every check: what the poses were chosen from.
    pub kept: usize,
    /// Candidates rejected, by reason.
    pub rejected: std::collections::BTreeMap<String, usize>,
}

impl Candidates {
    pub(crate) fn new(survey: &Survey) -> Self {
        Self {
            swept: survey.sweep.swept,
            axis_inside: survey.sweep.inside,
            axis_edge: survey.sweep.edge,
            refined: survey.refined,
            kept: survey.views.len(),
            rejected: Rejection::ALL.iter().map(|r| r.name().into()).zip(survey.rejected).collect(),
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(number: &usize) -> bool {
    *number == 0
}

/// The estimated intrinsics; lists of one length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Names.
    pub names: Vec<String>,
    /// Nominal values.
    pub nominal: Vec<f64>,
    /// Predicted standard deviations.
    pub sigma: Vec<f64>,
}

/// One pose of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedPose {
    /// Number of the configuration in the swept joint space.
    pub id: usize,
    /// Joint values, rad (m for prismatic joints).
    pub joints_rad: Vec<f64>,
    /// Joint values, degrees (mm for prismatic joints).
    pub joints_deg: Vec<f64>,
    /// Pose of the camera in the base frame.
    pub camera_in_base: Pose,
    /// Where the optical axis meets the target's plane, in the base frame; `null` if it does not.
    pub target_point_m: Option<[f64; 3]>,
    /// Angle between the optical axis and the board's normal.
    pub tilt_deg: f64,
    /// Distance from the camera to the board's centre.
    pub distance_m: f64,
    /// Share of the information at hand; with the share of what was known beforehand they add up to one.
    pub share: f64,
    /// Tip-over margin: distance of the projected centre of mass from the support polygon's nearest edge. Left out where
    /// stability is not tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability_margin_m: Option<f64>,
    /// The corners seen, by index row by row. Left out where all are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corners_seen: Option<Vec<usize>>,
}

/// A pose as position and unit quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position.
    pub position_m: [f64; 3],
    /// Orientation, real part last and not negative.
    pub quaternion_xyzw: [f64; 4],
}

impl Pose {
    /// The pose of a rigid transform.
    pub fn new(X: &crate::spatial::Pose) -> Self {
        let q = X.rotation.coords;
        let q = if q.w < 0.0 { -q } else { q };
        Self { position_m: X.translation.vector.into(), quaternion_xyzw: q.into() }
    }
}

impl Plan {
    /// The plan of a decision of `chooser`.
    ///
    /// # Errors
    /// When the choice is not the chooser's.
    pub fn new(problem: &Problem, chooser: &Chooser, decision: &Decision) -> Result<Self, PlanError> {
        let settings = &problem.selection;
        let survey = chooser.survey();
        let choice = &decision.choice;
        let names = problem.unknowns().names();
        let shares = chooser.shares(&choice.selected)?;
        let poses = choice.selected.iter().zip(shares);
        let document = |certificate| CertificateDocument::new(chooser.objective(), certificate);
        let fewest = decision.fewest.as_ref().map(|proof| FewestDocument {
            accuracies: chooser.reached(choice).into_iter().map(AccuracyDocument::new).collect(),
            least: proof.least,
            refutation: proof.refutation.as_ref().map(|refutation| document(&refutation.certificate)),
            nodes: proof.refutation.as_ref().map_or(0, |refutation| refutation.nodes),
        });
        Ok(Self {
            format: PLAN_FORMAT.into(),
            version: PLAN_VERSION,
            calipose: env!("CARGO_PKG_VERSION").into(),
            problem: ProblemReference::new(problem),
            criterion: chooser.criterion(),
            method: settings.goal.method().name().into(),
            count: choice.selected.len(),
            seed: settings.seed,
            value: chooser.natural(choice.log_value),
            bound: chooser.natural(decision.log_bound),
            efficiency: (choice.log_value - decision.log_bound).exp(),
            candidates: Candidates::new(survey),
            collision: Some(CollisionDocument::new(problem, &survey.links)),
            intrinsics: Intrinsics {
                names: names.iter().map(|&name| name.into()).collect(),
                nominal: problem.unknowns().values(),
                sigma: choice.sigma.clone(),
            },
            map_error_px: choice.map_error,
            certificate: document(&decision.certificate),
            search: decision.search.as_ref().map(SearchDocument::new),
            fewest,
            joints: problem.robot.chain.joints.iter().map(|joint| joint.name.clone()).collect(),
            poses: poses.map(|(&i, share)| PlannedPose::new(problem, &survey.views[i], share)).collect(),
        })
    }

    /// The criteria that the plan optimises and their shares; `None` for accuracies, and where a name is not known or the
    /// shares are not positive and of sum one.
    pub fn criteria(&self) -> Option<Vec<(Criterion, f64)>> {
        let terms = self.certificate.terms.iter();
        let criteria: Option<Vec<_>> = terms.map(|term| Some((term.criterion.parse().ok()?, term.share))).collect();
        criteria.filter(|criteria| {
            let sum: f64 = criteria.iter().map(|(_, share)| share).sum();
            criteria.iter().all(|&(_, share)| share > 0.0) && (sum - 1.0).abs() < 1e-9
        })
    }

    /// The plan that `text`, the content of a `plan.json`, holds.
    ///
    /// # Errors
    /// When it is not JSON, not a plan, or of a version that this program does not know.
    pub fn from_json(text: &str) -> Result<Self, PlanReadError> {
        let value: serde_json::Value = serde_json::from_str(text).map_err(PlanReadError::Json)?;
        let format = value["format"].as_str().unwrap_or_default();
        if format != PLAN_FORMAT {
            return Err(PlanReadError::Format { found: format.to_owned() });
        }
        if value["version"] != PLAN_VERSION {
            return Err(PlanReadError::Version { found: value["version"].to_string() });
        }
        serde_json::from_value(value).map_err(PlanReadError::Json)
    }

    /// The bytes of `plan.json`.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// The bytes of `plan.csv`: one pose a line under a header, the values of all of `joints` in rad (m) under
    /// `joint_<name>_rad` (`_m`), then in degrees (mm) under `joint_<name>_deg` (`_mm`). The last column, `stability_margin_m`,
    /// is there where stability is tested.
    ///
    /// # Errors
    /// Never in practice: the writer writes to memory.
    pub fn to_csv(&self, joints: &[Joint]) -> Result<Vec<u8>, csv::Error> {
        poses_csv(joints, &self.poses)
    }
}

/// Poses as CSV, one a line under a header.
pub(crate) fn poses_csv(joints: &[Joint], poses: &[PlannedPose]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let joints = joint_columns(joints, JointKind::unit).chain(joint_columns(joints, JointKind::display_unit));
    let fixed = ["camera_x_m", "camera_y_m", "camera_z_m", "camera_qx", "camera_qy", "camera_qz", "camera_qw"];
    let header = joints.chain(fixed.map(String::from)).chain(["tilt_deg", "distance_m", "share"].map(String::from));
    let tested = poses.iter().any(|pose| pose.stability_margin_m.is_some());
    let header = header.chain(tested.then(|| "stability_margin_m".into()));
    writer.write_record(std::iter::once(String::from("id")).chain(header))?;
    for pose in poses {
        let numbers = pose.joints_rad.iter().chain(&pose.joints_deg).chain(&pose.camera_in_base.position_m);
        let numbers = numbers.chain(&pose.camera_in_base.quaternion_xyzw);
        let numbers = numbers.chain([&pose.tilt_deg, &pose.distance_m, &pose.share]);
        let numbers = numbers.chain(&pose.stability_margin_m).map(f64::to_string);
        writer.write_record(std::iter::once(pose.id.to_string()).chain(numbers))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

/// Headings of the joints' columns with their units: `joint_waist_rad`.
pub(crate) fn joint_columns(joints: &[Joint], unit: fn(JointKind) -> &'static str) -> impl Iterator<Item = String> {
    joints.iter().map(move |joint| format!("joint_{}_{}", joint.name, unit(joint.kind)))
}

/// Joint values `q` (rad or m) as people read them: in degrees, of prismatic joints in mm.
pub fn joints_deg(chain: &Chain, q: &[f64]) -> Vec<f64> {
    chain.joints.iter().zip(q).map(|(joint, &q)| joint.kind.to_display(q)).collect()
}

impl PlannedPose {
    pub(crate) fn new(problem: &Problem, view: &View, share: f64) -> Self {
        Self {
            id: view.id,
            joints_rad: view.q.clone(),
            joints_deg: joints_deg(&problem.robot.chain, &view.q),
            camera_in_base: Pose::new(&view.X_BC),
            target_point_m: view.target_point().map(|p: Point3<f64>| p.coords.into()),
            tilt_deg: view.tilt().to_degrees(),
            distance_m: view.distance(),
            share,
            stability_margin_m: view.stability_margin,
            corners_seen: match &view.seen {
                Corners::All => None,
                Corners::Some(indices) => Some(indices.clone()),
            },
        }
    }
}
