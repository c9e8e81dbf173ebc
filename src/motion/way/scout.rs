//! What a search for a way is about, and its looking at moves.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Margins;
use super::straight::{Failure, Precision, Proof, prove};
use crate::robot::Limits;

/// Where ways are looked for.
#[derive(Clone, Copy)]
pub struct Space<'a> {
    /// What must hold all along.
    pub margins: &'a dyn Margins,
    /// Of each joint.
    pub limits: &'a [Limits],
    /// What a straight move costs, such as its duration, whatever the unit: positive but for a move to where it begins, the same
    /// there and back, growing along a line, and finite.
    pub cost: &'a dyn Fn(&[f64], &[f64]) -> f64,
}

/// How a way is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How closely moves are looked at. In the search the verdict alone counts; the way found is proven to the resolution.
    pub precision: Precision,
    /// The search ends without a way when it has taken this much. The last move tried may take more, the shortening is not
    /// counted.
    pub most: Effort,
    /// Random shortcuts tried on a way that was found.
    pub shortcuts: usize,
    /// Seed of what is random: the same gives the same way.
    pub seed: u64,
}

impl Default for Settings {
    /// For arms in cells: a second or so at 10 µs for each configuration.
    fn default() -> Self {
        let most = Effort { nodes: 20_000, evaluations: 100_000 };
        Self { precision: Precision::default(), most, shortcuts: 100, seed: 0 }
    }
}

/// What a search took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effort {
    /// Configurations that safe moves were found to.
    pub nodes: usize,
    /// Configurations at which margins were measured: nearly all of the time.
    pub evaluations: usize,
}

/// Looks at moves, counts what that takes, and draws what is random.
pub(super) struct Scout<'a> {
    pub(super) space: &'a Space<'a>,
    pub(super) settings: &'a Settings,
    pub(super) effort: Effort,
    pub(super) rng: Xoshiro256PlusPlus,
}

impl<'a> Scout<'a> {
    pub(super) fn new(space: &'a Space<'a>, settings: &'a Settings) -> Self {
        let rng = Xoshiro256PlusPlus::seed_from_u64(settings.seed);
        Self { space, settings, effort: Effort::default(), rng }
    }

    pub(super) fn prove(&mut self, from: &[f64], to: &[f64], precision: Precision) -> Result<Proof, Failure> {
        let outcome = prove(self.space.margins, from, to, precision);
        self.effort.evaluations += match &outcome {
            Ok(proof) => proof.evaluations,
            Err(failure) => failure.evaluations,
        };
        outcome
    }

    /// Whether the straight move is proven safe.
    pub(super) fn is_safe(&mut self, from: &[f64], to: &[f64]) -> bool {
        let verdict = Precision { resolution: f64::INFINITY, ..self.settings.precision };
        self.prove(from, to, verdict).is_ok()
    }

    pub(super) fn cost(&self, from: &[f64], to: &[f64]) -> f64 {
        (self.space.cost)(from, to)
    }

    pub(super) fn is_exhausted(&self) -> bool {
        let most = self.settings.most;
        self.effort.nodes >= most.nodes || self.effort.evaluations >= most.evaluations
    }
}
