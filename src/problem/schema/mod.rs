//! The problem file as written: one struct per section, one field per key, units in the names.
//!
//! The doc comments are the descriptions of the JSON Schema and the hints of error messages.
#![expect(clippy::struct_field_names, reason = "the units are part of the keys")]
mod bodies;
mod flexible;
mod json;
mod named;
mod selection;

pub(crate) use bodies::{Body, Collision, Mass, Scene, Stability};
pub(crate) use flexible::{NumberOrList, Numbers, Range, RangeOrSets, TextOrTable};
pub use json::schema_json;
pub(crate) use json::{least, meaning};
pub(crate) use named::{MountName, Named};
pub(crate) use selection::{Constraints, Selection};

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::camera::Lens;
use crate::robot::JointKind;
use crate::robot::dh::Convention;
use crate::sweep::AxisRule;

/// A calibration planning problem.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "calipose problem")]
pub(crate) struct File {
    /// Name of the problem; the file's name without its extension when left out.
    pub(crate) name: Option<String>,
    /// The arm.
    pub(crate) robot: Robot,
    /// The camera: its mount on the flange and its nominal calibration.
    pub(crate) camera: Camera,
    /// The checkerboard and its place on the robot.
    pub(crate) target: Target,
    /// The joint configurations to try.
    #[serde(default)]
    pub(crate) sweep: Sweep,
    /// What a view must satisfy.
    #[serde(default)]
    pub(crate) visibility: Visibility,
    /// What stands around the robot.
    #[serde(default)]
    pub(crate) scene: Scene,
    /// The test for collision.
    #[serde(default)]
    pub(crate) collision: Collision,
    /// The test for static stability; none when left out.
    pub(crate) stability: Option<Stability>,
    /// How well corners are detected.
    #[serde(default)]
    pub(crate) noise: Noise,
    /// What the calibration estimates.
    #[serde(default)]
    pub(crate) estimate: Estimate,
    /// Which poses to choose, and how.
    #[serde(default)]
    pub(crate) selection: Selection,
    /// Which sets of poses are allowed.
    #[serde(default)]
    pub(crate) constraints: Constraints,
    /// Where the plan goes.
    #[serde(default)]
    pub(crate) output: Output,
}

/// The arm: a Denavit–Hartenberg table, base first, or a URDF file.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Robot {
    /// Order of a row's factors: "standard" (the default) is Rz(theta) Tz(d) Tx(a) Rx(alpha), "modified" (Craig) is Rx(alpha)
    /// Tx(a) Rz(theta) Tz(d).
    pub(crate) convention: Option<Named<Convention>>,
    /// Which set of joint limits to use, for joints that give several.
    pub(crate) limits: Option<String>,
    /// Pose of the flange in the frame of the last row; the same frame when left out.
    pub(crate) flange: Option<Pose>,
    /// The rows of the table, one per joint.
    #[serde(default)]
    pub(crate) joints: Vec<Joint>,
    /// Solids attached to the links, for collision and occlusion.
    #[serde(default)]
    pub(crate) bodies: Vec<Body>,
    /// Masses attached to the links, for static stability.
    #[serde(default)]
    pub(crate) masses: Vec<Mass>,
    /// File that describes the robot, in place of a table: URDF, expanded if it is xacro. Relative to the problem file's folder.
    pub(crate) urdf: Option<String>,
    /// SRDF file whose `disable_collisions` name the pairs of links that are never tested for collision. Relative to the problem
    /// file's folder.
    pub(crate) srdf: Option<String>,
    /// Folders of the URDF's meshes beside its own: packages (`package://`), or folders of them. Relative to the problem file's
    /// folder.
    #[serde(default)]
    pub(crate) package_folders: Vec<String>,
    /// Link of the URDF that stands on the ground and whose frame is the robot's base frame; its root when left out.
    pub(crate) base_link: Option<String>,
    /// Link of the URDF that carries the camera; its frame is the flange frame. With a link such as ROS's
    /// `camera_optical_frame` the camera needs no mount.
    pub(crate) camera_link: Option<String>,
    /// Values in degrees at which revolute joints of the URDF are held, by the joints' names. A joint that moves the camera
    /// against the board is free when left out, any other is held at 0 or the limit next to it.
    #[serde(default)]
    pub(crate) joint_values_deg: BTreeMap<String, f64>,
    /// Values in mm at which prismatic joints of the URDF are held, by the joints' names.
    #[serde(default)]
    pub(crate) joint_values_mm: BTreeMap<String, f64>,
    /// Ranges [min, max] in degrees of revolute joints, by the joints' names, within those of the URDF or in place of limits that
    /// it does not state. A continuous joint has [-180, 180] when left out.
    #[serde(default)]
    pub(crate) limits_deg: BTreeMap<String, Range>,
    /// Ranges [min, max] in mm of prismatic joints, by the joints' names, likewise.
    #[serde(default)]
    pub(crate) limits_mm: BTreeMap<String, Range>,
    /// Joints whose ranges in `limits_deg` and `limits_mm` are meant to go beyond those that the URDF states.
    #[serde(default)]
    pub(crate) exceed_urdf_limits: Vec<String>,
}

/// One row of the table.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Joint {
    /// Name of the joint, as the robot's driver knows it.
    pub(crate) name: String,
    /// How the joint moves: its value is added to theta (revolute) or d (prismatic).
    #[serde(default = "revolute")]
    pub(crate) kind: Named<JointKind>,
    /// Link length along x, in mm.
    #[serde(default)]
    pub(crate) a_mm: f64,
    /// Link twist about x, in degrees.
    #[serde(default)]
    pub(crate) alpha_deg: f64,
    /// Link offset along z, in mm; a prismatic joint's value is added to it.
    #[serde(default)]
    pub(crate) d_mm: f64,
    /// Joint angle about z, in degrees; a revolute joint's value is added to it.
    #[serde(default)]
    pub(crate) theta_deg: f64,
    /// Range of a revolute joint: [min, max] in degrees, or a table of such ranges by name, of which `robot.limits`
    /// selects one.
    pub(crate) limits_deg: Option<RangeOrSets>,
    /// Range of a prismatic joint: [min, max] in mm, or a table of such ranges by name.
    pub(crate) limits_mm: Option<RangeOrSets>,
    /// Greatest speed of a revolute joint, in degrees per second.
    pub(crate) max_speed_deg_s: Option<f64>,
    /// Greatest speed of a prismatic joint, in mm per second.
    pub(crate) max_speed_mm_s: Option<f64>,
}

/// A position and an orientation.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Pose {
    /// Position x, y, z in mm; zero when left out.
    #[serde(default)]
    pub(crate) position_mm: Numbers<3>,
    /// Roll, pitch and yaw in degrees, as in URDF: Rz(yaw) Ry(pitch) Rx(roll). No rotation when left out.
    pub(crate) rpy_deg: Option<Numbers<3>>,
    /// Orientation as a unit quaternion x, y, z, w, instead of `rpy_deg`.
    pub(crate) quaternion_xyzw: Option<Numbers<4>>,
}

/// The nominal camera. Pixel (0, 0) is the centre of the top-left pixel.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Camera {
    /// Pose of the camera (x right, y down, z forward) in the flange frame: "optical-axis-z" or "ros-optical" when they are the
    /// same frame; "ros-body" when the flange frame is like ROS's `camera_link` (x forward, y left, z up); "opengl" when it is
    /// like Blender's or USD's camera (y up, looking along -z); "optical-axis-x" when the camera looks along the flange's x with
    /// its right along z (`z_C` = `x_F`, `y_C` = -`y_F`, `x_C` = `z_F`); or a table with `position_mm` and `rpy_deg` or
    /// `quaternion_xyzw`. `calipose check` says which way is up in the picture.
    #[serde(default)]
    pub(crate) mount: TextOrTable<Named<MountName>, Pose>,
    /// Solid around the camera; its pose is in the camera frame.
    pub(crate) housing: Option<Body>,
    /// File with the nominal calibration, in place of the keys below: ROS `camera_info` YAML or the message as `topic echo` prints it,
    /// OpenCV `FileStorage` YAML, XML or JSON, a Kalibr camchain, or mrcal's cameramodel. Relative to the problem file's folder.
    pub(crate) file: Option<String>,
    /// Which camera of `file`, where it has several: "cam1" of a Kalibr camchain, "M2" of OpenCV's stereo files, whose left camera it
    /// is when left out.
    pub(crate) file_camera: Option<String>,
    /// Image width in px; required without `file`, and with one that does not state it.
    #[schemars(range(min = 1))]
    pub(crate) width_px: Option<u32>,
    /// Image height in px; required without `file`, and with one that does not state it.
    #[schemars(range(min = 1))]
    pub(crate) height_px: Option<u32>,
    /// Focal length along x, in px; required without `file`.
    pub(crate) fx_px: Option<f64>,
    /// Focal length along y, in px; `fx_px` when left out.
    pub(crate) fy_px: Option<f64>,
    /// Principal point x, in px; the image centre, (width - 1) / 2, when left out.
    pub(crate) cx_px: Option<f64>,
    /// Principal point y, in px; the image centre, (height - 1) / 2, when left out.
    pub(crate) cy_px: Option<f64>,
    /// Lens distortion; none when left out.
    pub(crate) distortion: Option<Distortion>,
}

/// The lens model and its coefficients, with OpenCV's names. A coefficient that is left out is 0.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Distortion {
    /// Lens model: "brown-conrady" has k1 k2 p1 p2 k3 (ROS `plumb_bob`), "rational" k1 k2 p1 p2 k3 k4 k5 k6,
    /// "kannala-brandt" k1 k2 k3 k4 (OpenCV fisheye).
    pub(crate) model: Named<Lens>,
    /// First radial coefficient.
    pub(crate) k1: Option<f64>,
    /// Second radial coefficient.
    pub(crate) k2: Option<f64>,
    /// First tangential coefficient.
    pub(crate) p1: Option<f64>,
    /// Second tangential coefficient.
    pub(crate) p2: Option<f64>,
    /// Third radial coefficient.
    pub(crate) k3: Option<f64>,
    /// First radial coefficient of the denominator; for "kannala-brandt" the fourth of the angle.
    pub(crate) k4: Option<f64>,
    /// Second radial coefficient of the denominator.
    pub(crate) k5: Option<f64>,
    /// Third radial coefficient of the denominator.
    pub(crate) k6: Option<f64>,
}

/// A checkerboard. Its frame has the origin at the board's centre, x along the columns, y along the rows and z out of
/// the printed side.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Target {
    /// Inner corners along x.
    #[schemars(range(min = 2))]
    pub(crate) columns: u32,
    /// Inner corners along y.
    #[schemars(range(min = 2))]
    pub(crate) rows: u32,
    /// Side of a square in mm.
    pub(crate) square_mm: f64,
    /// Link of the robot's URDF that carries the board; the base when left out.
    pub(crate) link: Option<String>,
    /// Pose of the board in the frame of the link that carries it: the robot's base frame, unless `link` names another.
    pub(crate) pose: Pose,
    /// Thickness of the board, in mm: its body is a plate of the printed size under the printed side.
    #[serde(default = "thickness")]
    pub(crate) thickness_mm: f64,
    /// The zone, centred on the board, that the optical axis is tested against; the printed board when left out.
    #[serde(default)]
    pub(crate) zone: Zone,
}

/// A rectangle in the board's plane, centred on the board.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Zone {
    /// Extent along x in mm; the printed board's, (columns + 1) squares, when left out.
    pub(crate) width_mm: Option<f64>,
    /// Extent along y in mm; the printed board's, (rows + 1) squares, when left out.
    pub(crate) height_mm: Option<f64>,
    /// Width in mm of the band inside the border that counts as edge.
    #[serde(default)]
    pub(crate) edge_margin_mm: f64,
}

/// The joint configurations to try: a grid (`step_deg`, `step_mm`) or a low-discrepancy sample (`sample`). A sample of
/// 200 000 when nothing is given.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sweep {
    /// Step of the revolute joints in degrees: one number for all, or a list with one per revolute joint.
    pub(crate) step_deg: Option<NumberOrList>,
    /// Step of the prismatic joints in mm: one number for all, or a list with one per prismatic joint.
    pub(crate) step_mm: Option<NumberOrList>,
    /// Number of configurations of a Halton sample, instead of a grid.
    #[schemars(range(min = 1))]
    pub(crate) sample: Option<u64>,
    /// Rounds of refinement: each tries configurations around the poses that selection picks, ever closer; none when left out.
    #[serde(default)]
    pub(crate) refine: u64,
    /// Number of configurations that each round of refinement tries; 20 000 when left out.
    #[schemars(range(min = 1))]
    pub(crate) refine_sample: Option<u64>,
    /// Where the optical axis must go: "any" keeps all configurations, "zone" those whose axis meets the zone.
    #[serde(default = "any_axis")]
    pub(crate) axis: Named<AxisRule>,
    /// Counts that others published for this sweep; `calipose sweep` shows them beside its own.
    #[serde(default)]
    pub(crate) published: Vec<Published>,
}

/// Published counts of a sweep.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Published {
    /// Step of all joints in degrees.
    pub(crate) step_deg: f64,
    /// Number of configurations.
    pub(crate) swept: u64,
    /// Number of those whose optical axis meets the zone.
    pub(crate) in_zone: u64,
}

/// What a view must satisfy besides showing the corners.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Visibility {
    /// Least distance of every corner from the centres of the outermost pixels, in px.
    pub(crate) margin_px: f64,
    /// Greatest angle between the board's normal and the direction to the camera, in degrees.
    pub(crate) max_incidence_deg: f64,
    /// Greatest angle between the board's normal and the optical axis, in degrees.
    pub(crate) max_tilt_deg: f64,
    /// Least distance from the camera to the board's centre, in mm.
    pub(crate) min_distance_mm: f64,
    /// Greatest distance from the camera to the board's centre, in mm.
    pub(crate) max_distance_mm: f64,
    /// Least distance between neighbouring corners in the image, in px.
    pub(crate) min_corner_spacing_px: f64,
    /// Fewest corners that make a view, for boards that can be read in part (`ChArUco`, grids of tags); every corner when left
    /// out.
    #[schemars(range(min = 4))]
    pub(crate) min_corners: Option<u32>,
}

/// The error of a detected corner.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Noise {
    /// Standard deviation of a detected corner in each direction, in px.
    pub(crate) sigma_px: f64,
}

/// The parameters that the calibration estimates.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Estimate {
    /// Names of the intrinsics to estimate: fx, fy, cx, cy and the lens model's coefficients. All when left out.
    pub(crate) intrinsics: Option<Vec<String>>,
    /// What is known of intrinsics beforehand: their standard deviations by name, as in `{ cx = 20, cy = 20 }`. Nothing when
    /// left out.
    #[serde(default)]
    pub(crate) prior_sigma: BTreeMap<String, f64>,
}

/// Where the plan goes.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Output {
    /// Folder for the plan, relative to the working directory; "plans/" and the name in lower case when left out.
    pub(crate) folder: Option<String>,
}

fn thickness() -> f64 {
    5.0
}

fn revolute() -> Named<JointKind> {
    Named(JointKind::Revolute)
}

fn any_axis() -> Named<AxisRule> {
    Named(AxisRule::Any)
}

impl Default for Named<AxisRule> {
    fn default() -> Self {
        any_axis()
    }
}

impl Default for TextOrTable<Named<MountName>, Pose> {
    fn default() -> Self {
        Self::Text(Named(MountName::OpticalAxisZ))
    }
}

impl Distortion {
    /// The coefficient of that name.
    pub(crate) fn coefficient(&mut self, name: &str) -> Option<&mut Option<f64>> {
        let Self { model: _, k1, k2, p1, p2, k3, k4, k5, k6 } = self;
        let named = [("k1", k1), ("k2", k2), ("p1", p1), ("p2", p2), ("k3", k3), ("k4", k4), ("k5", k5), ("k6", k6)];
        named.into_iter().find(|(known, _)| *known == name).map(|(_, value)| value)
    }
}

impl Default for Target {
    /// No board: what must be given is out of range.
    fn default() -> Self {
        let (pose, zone) = (Pose::default(), Zone::default());
        Self { columns: 0, rows: 0, square_mm: 0.0, link: None, pose, thickness_mm: thickness(), zone }
    }
}

impl Default for Distortion {
    fn default() -> Self {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = [None; 8];
        Self { model: Named(Lens::Pinhole), k1, k2, p1, p2, k3, k4, k5, k6 }
    }
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            margin_px: 5.0,
            max_incidence_deg: 80.0,
            max_tilt_deg: 70.0,
            min_distance_mm: 0.0,
            max_distance_mm: 100_000.0,
            min_corner_spacing_px: 5.0,
            min_corners: None,
        }
    }
}

impl Default for Noise {
    fn default() -> Self {
        Self { sigma_px: 0.3 }
    }
}
