//! The criteria that a plan can be optimised for.

use std::str::FromStr;

use thiserror::Error;

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
                let each: Vec<_> = several
                    .iter()
                    .map(|&(criterion, share)| format!("{} {}", short(share), criterion.name()))
                    .collect();
                each.join(" + ")
            }
        }
    }
}

/// A name that no criterion has.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("\"{name}\" is not a criterion; the criteria are {}", Criterion::ALL.map(Criterion::name).join(", "))]
pub struct UnknownCriterion {
    /// The name.
    pub name: String,
}

impl FromStr for Criterion {
    type Err = UnknownCriterion;

    fn from_str(name: &str) -> Result<Self, UnknownCriterion> {
        let named = Self::ALL.into_iter().find(|criterion| criterion.name() == name);
        named.ok_or_else(|| UnknownCriterion { name: name.into() })
    }
}

/// A share to four decimals, as many as there are; one that is smaller to one digit.
fn short(share: f64) -> String {
    if share < 1e-4 { format!("{share:.0e}") } else { ((share * 1e4).round() / 1e4).to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_read_as_they_were_written() {
        let described = |v: f64, d: f64| Criterion::describe(&[(Criterion::V, v), (Criterion::D, d)]);
        assert_eq!(described(0.7 + f64::EPSILON, 0.3 - f64::EPSILON), "0.7 v + 0.3 d");
        assert_eq!(described(2.0 / 3.0, 1.0 / 3.0), "0.6667 v + 0.3333 d");
        assert_eq!(described(1.0 - 1e-6, 1e-6), "1 v + 1e-6 d");
        assert_eq!(Criterion::describe(&[(Criterion::E, 1.0)]), "e");
    }
}
