//! Joint values for a requested pose of the camera, as `calipose reach --json` prints them.

use schemars::JsonSchema;
use serde::Serialize;

use crate::feasibility::LinkPair;
use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::plan::document::plan::{Pose, joints_deg};
use crate::problem::Problem;
use crate::robot::Reached;
use crate::spatial;

/// Configurations that bring the camera to a requested pose, or near it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ReachDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem.
    pub problem: ProblemReference,
    /// The requested pose of the camera in the base frame.
    pub requested: Pose,
    /// Whether any configuration takes it.
    pub reached: bool,
    /// Names of the joints, in the order of the joint values.
    pub joints: Vec<String>,
    /// Whether the robot has bodies, so that collision is tested.
    pub collision_tested: bool,
    /// The configurations, the best first.
    pub configurations: Vec<ReachedConfiguration>,
}

/// A configuration, and where it brings the camera.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ReachedConfiguration {
    /// Joint values, rad (m for prismatic joints).
    pub joints_rad: Vec<f64>,
    /// Joint values, degrees (mm for prismatic joints).
    pub joints_deg: Vec<f64>,
    /// Whether it takes the requested pose.
    pub reached: bool,
    /// Distance of the camera from the requested position.
    pub position_error_m: f64,
    /// Angle of the camera to the requested orientation.
    pub angle_error_deg: f64,
    /// Distance of the joints from their limits as a share of half their range, the least: 0 at a limit.
    pub limit_margin: f64,
    /// Pose of the camera in the base frame.
    pub camera_in_base: Pose,
    /// Two links in each other's way; `null` if there are none, or nothing is tested.
    pub collision: Option<[String; 2]>,
}

impl Document for ReachDocument {
    const FORMAT: &'static str = "calipose.reach";
    const VERSION: u32 = 2;
}

impl ReachDocument {
    /// What was found for the `requested` pose `X_BC`, and for each the first links in each other's way.
    pub fn new(
        problem: &Problem,
        requested: &spatial::Pose,
        found: &[Reached],
        in_the_way: &[Option<LinkPair>],
    ) -> Self {
        let robot = &problem.robot;
        let name = |link: usize| robot.tree.links[link].name.clone();
        let configuration = |(configuration, pair): (&Reached, &Option<LinkPair>)| ReachedConfiguration {
            joints_rad: configuration.q.clone(),
            joints_deg: joints_deg(&robot.chain, &configuration.q),
            reached: configuration.reached,
            position_error_m: configuration.position_error,
            angle_error_deg: configuration.angle_error.to_degrees(),
            limit_margin: configuration.limit_margin,
            camera_in_base: Pose::new(&robot.camera_pose(&configuration.q)),
            collision: pair.map(|pair| pair.map(name)),
        };
        Self {
            header: Self::header(),
            problem: ProblemReference::new(problem),
            requested: Pose::new(requested),
            reached: found.iter().any(|configuration| configuration.reached),
            joints: robot.chain.joints.iter().map(|joint| joint.name.clone()).collect(),
            collision_tested: robot.has_bodies(),
            configurations: found.iter().zip(in_the_way).map(configuration).collect(),
        }
    }
}
