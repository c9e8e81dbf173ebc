//! A pose of a plan, and poses as a table.

use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::feasibility::View;
use crate::problem::Problem;
use crate::robot::{Chain, Joint, JointKind};
use crate::target::Corners;

/// One pose of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
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

    /// The rigid transform that it states.
    pub fn transform(&self) -> crate::spatial::Pose {
        let [x, y, z, w] = self.quaternion_xyzw;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        crate::spatial::Pose::from_parts(Translation3::from(self.position_m), rotation)
    }
}

/// The corners of a view by index, where they are not all.
pub(super) fn corners_seen(seen: &Corners) -> Option<Vec<usize>> {
    match seen {
        Corners::All => None,
        Corners::Some(indices) => Some(indices.clone()),
    }
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
            corners_seen: corners_seen(&view.seen),
        }
    }
}

/// Poses as CSV, one a line under a header.
pub(crate) fn poses_csv<'p>(
    joints: &[Joint],
    poses: impl IntoIterator<Item = &'p PlannedPose>,
) -> Result<Vec<u8>, csv::Error> {
    let poses: Vec<&PlannedPose> = poses.into_iter().collect();
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
