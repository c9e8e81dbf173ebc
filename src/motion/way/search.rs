//! Search for a safe way: the straight move where it will do, a way round where one is found.

use std::fmt;

use thiserror::Error;

use super::connect::connect;
use super::scout::{Effort, Scout, Settings, Space};
use super::shorten::shorten;
use super::straight::{Failure, Precision, Proof};
use crate::robot::Limits;

/// A way that is proven safe.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// From start to goal; moves between are straight.
    pub corners: Vec<Vec<f64>>,
    /// Of each move.
    pub proofs: Vec<Proof>,
    /// What all moves cost together.
    pub cost: f64,
    /// What the search took, shortening and proofs included.
    pub effort: Effort,
}

impl Way {
    /// For each margin, what it does not sink below anywhere on the way, m; positive.
    pub fn bounds(&self) -> Vec<f64> {
        let least = |margin: usize| self.proofs.iter().map(|proof| proof.bounds[margin]).fold(f64::INFINITY, f64::min);
        (0..self.proofs.first().map_or(0, |proof| proof.bounds.len())).map(least).collect()
    }

    /// What no margin sinks below, m; infinite if there are none.
    pub fn least(&self) -> f64 {
        self.proofs.iter().map(Proof::least).fold(f64::INFINITY, f64::min)
    }
}

/// An end of a way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Where it begins.
    Start,
    /// Where it is to lead.
    Goal,
}

/// Why there is no way to show.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NoWay {
    /// An end is outside the limits of a joint, or no number: there is none.
    #[error("the {end} is outside the limits of joint {joint}")]
    Outside {
        /// Which end.
        end: End,
        /// The first such joint.
        joint: usize,
    },
    /// A margin is not positive at an end, but for rounding: there is none.
    #[error("margin {margin} is {value} m at the {end}")]
    Unsafe {
        /// Which end.
        end: End,
        /// Number of the margin.
        margin: usize,
        /// The margin, m.
        value: f64,
    },
    /// None was found with the effort allowed, which does not prove that there is none.
    #[error(
        "no way was found in {} measurements, with {} configurations reached from the start and {} from the goal; that does not prove that \
         there is none",
        effort.evaluations,
        reached[0],
        reached[1]
    )]
    NotFound {
        /// What was spent.
        effort: Effort,
        /// Configurations found from the start and from the goal, themselves included. Where one number stays far below the
        /// other, that end is enclosed, or there is but a narrow way out.
        reached: [usize; 2],
    },
    /// A margin was seen to sink below what had been proven of it: the bounds on its change do not hold, and nothing is proven.
    #[error("margin {margin} changes by more than the bound on its change")]
    Contradiction {
        /// Number of the margin.
        margin: usize,
    },
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Goal => "goal",
        })
    }
}

/// A safe way between two configurations (rad or m): the straight move where that is safe, else a way round where one is found
/// within the effort allowed, shortened. It need not be the shortest: other seeds may find shorter ones.
///
/// # Errors
/// When an end is not allowed or no way was found.
pub fn find(space: &Space, from: &[f64], to: &[f64], settings: &Settings) -> Result<Way, NoWay> {
    let mut scout = Scout::new(space, settings);
    admit(&mut scout, End::Start, from)?;
    admit(&mut scout, End::Goal, to)?;
    let straight = vec![from.to_vec(), to.to_vec()];
    if let Ok(proof) = scout.prove(from, to, settings.precision) {
        return Ok(way(&scout, straight, vec![proof]));
    }
    let corners = match connect(&mut scout, from, to) {
        Ok(corners) => shorten(&mut scout, corners),
        Err(reached) => return Err(NoWay::NotFound { effort: scout.effort, reached }),
    };
    let prove = |pair: &[Vec<f64>]| scout.prove(&pair[0], &pair[1], settings.precision);
    let proofs: Result<Vec<Proof>, Failure> = corners.windows(2).map(prove).collect();
    // Each move was proven safe before: where it is seen not to be, that proof was from wrong bounds.
    let proofs = proofs.map_err(|failure| NoWay::Contradiction { margin: failure.place.margin })?;
    Ok(way(&scout, corners, proofs))
}

/// Whether a way may begin or end at `q`.
fn admit(scout: &mut Scout, end: End, q: &[f64]) -> Result<(), NoWay> {
    debug_assert_eq!(q.len(), scout.space.limits.len(), "a value for each joint");
    let is_outside = |(&value, limits): (&f64, &Limits)| !limits.holds(value);
    if let Some(joint) = q.iter().zip(scout.space.limits).position(is_outside) {
        return Err(NoWay::Outside { end, joint });
    }
    let at_rest = scout.prove(q, q, Precision::VERDICT);
    at_rest.map(|_| ()).map_err(|Failure { place, .. }| NoWay::Unsafe { end, margin: place.margin, value: place.value })
}

fn way(scout: &Scout, corners: Vec<Vec<f64>>, proofs: Vec<Proof>) -> Way {
    let cost = corners.windows(2).map(|pair| scout.cost(&pair[0], &pair[1])).sum();
    Way { corners, proofs, cost, effort: scout.effort }
}
