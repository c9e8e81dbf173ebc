//! The criteria that a plan can be optimised for.

/// What a plan is to make small: a scalar summary of the covariance of the estimated intrinsics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Criterion {
    /// The volume of the confidence ellipsoid.
    D,
    /// The mean variance, in px², of the calibrated projection over the image.
    V,
}

impl Criterion {
    /// Every criterion.
    pub const ALL: [Criterion; 2] = [Criterion::D, Criterion::V];

    /// Name as written in problem files and plans.
    pub fn name(self) -> &'static str {
        match self {
            Criterion::D => "d",
            Criterion::V => "v",
        }
    }
}
