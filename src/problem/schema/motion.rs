//! `[motion]`: how the robot goes from pose to pose.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the robot goes from pose to pose, which the order of the poses and its time are reckoned by.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Motion {
    /// Joint values in degrees (mm), as in plan.csv, at which the tour begins; at any pose when left out.
    pub(crate) home: Option<Vec<f64>>,
    /// Whether a tour that begins at home ends there too.
    pub(crate) return_home: bool,
    /// Time for the pictures at each pose, in seconds.
    pub(crate) dwell_s: f64,
    /// Share of the joints' greatest speeds, accelerations and jerks at which the robot moves, in percent.
    pub(crate) speed_percent: f64,
    /// Greatest speed of revolute joints of which neither the table nor the URDF states one, in degrees per second.
    pub(crate) default_speed_deg_s: f64,
    /// The same of prismatic joints, in mm per second.
    pub(crate) default_speed_mm_s: f64,
    /// Greatest accelerations of revolute joints by the joints' names, in degrees per second squared. A joint without one reaches
    /// its greatest speed in a second.
    pub(crate) max_acceleration_deg_s2: BTreeMap<String, f64>,
    /// The same of prismatic joints, in mm per second squared.
    pub(crate) max_acceleration_mm_s2: BTreeMap<String, f64>,
    /// Greatest jerks of revolute joints by the joints' names, in degrees per second cubed. A joint without one changes its
    /// acceleration at once.
    pub(crate) max_jerk_deg_s3: BTreeMap<String, f64>,
    /// The same of prismatic joints, in mm per second cubed.
    pub(crate) max_jerk_mm_s3: BTreeMap<String, f64>,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            home: None,
            return_home: true,
            dwell_s: 1.0,
            speed_percent: 100.0,
            default_speed_deg_s: 10.0,
            default_speed_mm_s: 50.0,
            max_acceleration_deg_s2: BTreeMap::new(),
            max_acceleration_mm_s2: BTreeMap::new(),
            max_jerk_deg_s3: BTreeMap::new(),
            max_jerk_mm_s3: BTreeMap::new(),
        }
    }
}
