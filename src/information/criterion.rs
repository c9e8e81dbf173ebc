//! The criteria that a plan can be optimised for.

/// What a plan is to make good: a scalar summary of what its views teach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Criterion {
    /// The volume of the confidence ellipsoid.
    D,
    /// The sum of the intrinsics' variances, each in the unit that moves the image by 1 px.
    A,
    /// The variance of the worst combination of the intrinsics, in the same units.
    E,
    /// The mean variance, in px², of the calibrated projection over the image.
    V,
    /// The worst direction of Zhang's closed-form solution.
    Zhang,
    /// The spread of the views over angle and distance.
    Diversity,
}

impl Criterion {
    /// Every criterion.
    pub const ALL: [Criterion; 6] =
        [Criterion::D, Criterion::A, Criterion::E, Criterion::V, Criterion::Zhang, Criterion::Diversity];

    /// Name as written in problem files and plans.
    pub fn name(self) -> &'static str {
        match self {
            Criterion::D => "d",
            Criterion::A => "a",
            Criterion::E => "e",
            Criterion::V => "v",
            Criterion::Zhang => "zhang",
            Criterion::Diversity => "diversity",
        }
    }

    /// What it makes good, in a phrase.
    pub fn phrase(self) -> &'static str {
        match self {
            Criterion::D => "the volume of the confidence ellipsoid",
            Criterion::A => "the sum of the intrinsics' variances, each in the unit that moves the image by 1 px",
            Criterion::E => "the worst combination of the intrinsics, in the same units",
            Criterion::V => "the mean variance of the calibrated projection over the image",
            Criterion::Zhang => "the worst direction of Zhang's closed-form solution",
            Criterion::Diversity => "the spread of the views over angle and distance",
        }
    }

    /// Whether it is a function of the information on the estimated intrinsics.
    pub fn is_of_intrinsics(self) -> bool {
        !matches!(self, Criterion::Zhang | Criterion::Diversity)
    }

    /// Several criteria with their shares in words: `v`, or `0.8 v + 0.2 diversity`.
    pub fn describe(shares: &[(Criterion, f64)]) -> String {
        match shares {
            [(criterion, _)] => criterion.name().into(),
            several => {
                let each: Vec<_> =
                    several.iter().map(|(criterion, share)| format!("{share} {}", criterion.name())).collect();
                each.join(" + ")
            }
        }
    }
}
