//! Which sets of poses are allowed.

use crate::robot::Limits;

/// Which sets of poses are allowed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PoseConstraints {
    /// Numbers of swept configurations that must be in the plan.
    pub required: Vec<usize>,
    /// Numbers of those that must not.
    pub forbidden: Vec<usize>,
    /// Joint values, rad or m, of views taken already.
    pub captured: Vec<Vec<f64>>,
    /// Regions without poses.
    pub keep_out: Vec<JointRegion>,
    /// Regions with few poses.
    pub groups: Vec<PoseGroup>,
    /// Least distance of two poses in joint space, rad; only revolute joints count.
    pub joint_separation: f64,
    /// Least angle between the directions from which two poses see the board's centre, rad.
    pub view_separation: f64,
    /// Least distance of the board's pictures from two poses, px, as [`View::picture`](crate::feasibility::View::picture) has it;
    /// where none is stated, see [`Problem::picture_separation`](super::Problem::picture_separation).
    pub picture_separation: Option<f64>,
}

impl PoseConstraints {
    /// Least distance of the board's pictures from two poses off the grid where none is stated, px. What is systematic in a picture
    /// does not average out over pictures that are the same.
    pub(super) const PICTURE_SEPARATION: f64 = 20.0;

    /// Whether any set of the candidates is allowed.
    pub fn allow_all(&self) -> bool {
        let Self {
            required,
            forbidden,
            keep_out,
            groups,
            joint_separation,
            view_separation,
            picture_separation,
            captured: _,
        } = self;
        let none = required.is_empty() && forbidden.is_empty() && keep_out.is_empty() && groups.is_empty();
        let together =
            *joint_separation == 0.0 && *view_separation == 0.0 && picture_separation.is_none_or(|px| px == 0.0);
        none && together
    }

    /// The least distance of pictures from poses off the grid, px.
    pub fn polished_picture_separation(&self) -> f64 {
        self.picture_separation.unwrap_or(Self::PICTURE_SEPARATION)
    }
}

/// A region of joint space: ranges of some joints, by index.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRegion(pub Vec<(usize, Limits)>);

impl JointRegion {
    /// Whether the configuration is in the region, ends included.
    pub fn contains(&self, q: &[f64]) -> bool {
        // A grid's own values are rounded.
        self.0.iter().all(|(joint, limits)| (limits.min - 1e-9..=limits.max + 1e-9).contains(&q[*joint]))
    }
}

/// A region with at most so many poses.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseGroup {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub region: JointRegion,
    /// Most poses in it.
    pub most: usize,
}
