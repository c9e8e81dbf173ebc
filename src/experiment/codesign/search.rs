//! The search for the best set-up.

use rayon::prelude::*;
use thiserror::Error;

use super::evaluate::{Known, Planned, Verdict};
use super::{Codesign, Place};
use crate::plan::document::{DesignDocument, DesignProof, Document, ProblemReference, SetUp, finite};

/// Set-ups whose neighbours are tried.
pub(super) const CENTRES: usize = 3;

/// Half the width of the first neighbourhood, in shares of the ranges, and what becomes of it in a round that finds nothing better.
const FIRST_REACH: f64 = 0.125;
const SHRINK: f64 = 0.5;

/// Set-ups that are listed.
const LISTED: usize = 20;

/// Points that are drawn for each that lies on the surface, at most.
const DRAWN: u32 = 50;

/// Why no set-up is found.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CodesignError {
    /// The board is never wholly on the surface, or the problem refuses every set-up.
    #[error(
        "none of the {drawn} set-ups drawn is possible: the board does not fit the surface, or the problem refuses them"
    )]
    Nowhere {
        /// Set-ups drawn.
        drawn: usize,
    },
    /// No set-up has a plan.
    #[error("none of the {tried} set-ups tried has a plan of so many poses")]
    NoPlan {
        /// Set-ups tried.
        tried: usize,
    },
}

/// The best set-up and what is known of the others.
#[derive(Debug, Clone)]
pub struct Designed {
    /// All of it, as a document.
    pub document: DesignDocument,
    /// The problem file of the best set-up, to stand in the folder that it was made for.
    pub problem_file: String,
}

/// Set-ups examined so far.
#[derive(Default)]
struct Family {
    planned: Vec<Planned>,
    discarded: usize,
    without_plan: usize,
    undecided: usize,
    seen: Vec<Vec<String>>,
}

impl Family {
    /// Those of `places` that were not examined before.
    fn new_ones(&mut self, places: Vec<Place>) -> Vec<Place> {
        let mut new = Vec::new();
        for place in places {
            let settings: Vec<String> = place.levels.iter().flat_map(|level| level.set.clone()).collect();
            if !self.seen.contains(&settings) {
                self.seen.push(settings);
                new.push(place);
            }
        }
        new
    }

    /// Examines set-ups; those that cannot be better than the best before are discarded.
    fn examine(&mut self, design: &Codesign, places: Vec<Place>, observe: &(dyn Fn() + Sync)) {
        let places = self.new_ones(places);
        let best = self.planned.first();
        let known = best.map(|best| Known { log_value: best.log_value, certificate: &best.certificate });
        // Against one best for all of them, whoever is first, so that the result does not depend on the threads.
        let verdicts: Vec<Verdict> = places
            .par_iter()
            .map(|place| {
                let verdict = design.evaluate(place, known);
                observe();
                verdict
            })
            .collect();
        for verdict in verdicts {
            match verdict {
                Verdict::Refused => {}
                Verdict::NoPlan => self.without_plan += 1,
                Verdict::Undecided => self.undecided += 1,
                Verdict::Discarded => self.discarded += 1,
                Verdict::Planned(planned) => self.planned.push(*planned),
            }
        }
        self.planned.sort_by(|a, b| b.log_value.total_cmp(&a.log_value));
    }
}

impl Codesign {
    /// Searches for the best set-up. `folder` is where its problem file is to stand; `observe` is told of every set-up that was
    /// tried. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// When no set-up is possible, or none has a plan.
    pub fn search(&self, folder: &std::path::Path, observe: &(dyn Fn() + Sync)) -> Result<Designed, CodesignError> {
        let screened = self.screened()?;
        let mut scored: Vec<(f64, Place)> = screened
            .into_par_iter()
            .map(|place| {
                let value = self.screen(&place);
                observe();
                (value, place)
            })
            .collect();
        let tried = scored.len();
        scored.retain(|(value, _)| value.is_finite());
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        let finalists = scored.into_iter().take(self.search.finalists as usize).map(|(_, place)| place).collect();
        let mut family = Family::default();
        family.examine(self, finalists, observe);
        self.climb(&mut family, observe);
        let Some(best) = family.planned.first().cloned() else { return Err(CodesignError::NoPlan { tried }) };
        let named = |planned: &Planned| self.named(planned);
        let criteria = &self.problem.selection.goal;
        let document = DesignDocument {
            header: DesignDocument::header(),
            name: self.name.clone(),
            sha256: self.sha256.clone(),
            problem: ProblemReference::new(&self.problem),
            criterion: criteria.to_string(),
            count: criteria.count().unwrap_or_default(),
            as_given: self.as_given().map(|given| given.document),
            best: named(&best),
            proof: proof(&family, &best, tried),
            ranking: family.planned.iter().take(LISTED).map(named).collect(),
            sensitivity: self.sensitivity(&best, observe),
            map: self.map(&best, observe),
        };
        Ok(Designed { problem_file: self.problem_file(&best.place, folder), document })
    }

    /// Set-ups that are possible, evenly over the ranges.
    pub(super) fn screened(&self) -> Result<Vec<Place>, CodesignError> {
        let wanted = self.search.screened as usize;
        let drawn = (self.search.screened.saturating_mul(DRAWN)).min(60_000);
        let mut places: Vec<Place> = Vec::new();
        // By blocks, so that no more are looked at than needed.
        let indices: Vec<u32> = (0..drawn).collect();
        for block in indices.chunks(wanted.max(64)) {
            let possible = block.par_iter().map(|&index| self.place(self.point(0, index)));
            let possible = possible.filter(|place| self.problem_at(place).is_some());
            places.extend(possible.collect::<Vec<_>>());
            if places.len() >= wanted {
                break;
            }
        }
        places.truncate(wanted);
        if places.is_empty() { Err(CodesignError::Nowhere { drawn: drawn as usize }) } else { Ok(places) }
    }

    /// Tries neighbours of the best, nearer ones where none is better.
    fn climb(&self, family: &mut Family, observe: &(dyn Fn() + Sync)) {
        let mut reach = FIRST_REACH;
        for round in 0..self.search.rounds {
            let Some(before) = family.planned.first().map(|best| best.log_value) else { return };
            let centres: Vec<Vec<f64>> =
                family.planned.iter().take(CENTRES).map(|planned| planned.place.shares.clone()).collect();
            let places = centres
                .iter()
                .enumerate()
                .flat_map(|(i, centre)| self.neighbours(centre, reach, round * CENTRES as u32 + i as u32));
            let places = places.collect();
            family.examine(self, places, observe);
            if family.planned.first().is_some_and(|best| best.log_value <= before) {
                reach *= SHRINK;
            }
        }
    }

    /// Neighbours of a set-up: along each range in both directions, and as many again at random within reach.
    fn neighbours(&self, centre: &[f64], reach: f64, stream: u32) -> Vec<Place> {
        let moved = |i: usize, by: f64| {
            let mut shares = centre.to_vec();
            shares[i] += self.at_least_a_level(i, by);
            shares
        };
        let along = (0..centre.len()).flat_map(|i| [moved(i, -reach), moved(i, reach)]);
        let around = (0..centre.len() as u32).map(|index| {
            let point = self.point(stream + 1, index);
            centre.iter().zip(point).map(|(share, point)| share + reach * (2.0 * point - 1.0)).collect()
        });
        let within = |shares: &Vec<f64>| shares.iter().all(|share| (0.0..1.0).contains(share));
        along.chain(around).filter(within).map(|shares| self.place(shares)).collect()
    }

    /// A step by so much along range `i`; to the next level where the range is of levels that are farther apart.
    pub(super) fn at_least_a_level(&self, i: usize, by: f64) -> f64 {
        match self.free[i].levels() {
            Some(levels) => by.signum() * by.abs().max(1.0 / levels.len() as f64),
            None => by,
        }
    }

    /// The document of a set-up, with the names of what is free.
    pub(super) fn named(&self, planned: &Planned) -> SetUp {
        let mut document = planned.document.clone();
        for (value, factor) in document.values.iter_mut().zip(&self.free) {
            value.name.clone_from(&factor.name);
        }
        document
    }
}

/// What is proven of the family.
fn proof(family: &Family, best: &Planned, screened: usize) -> DesignProof {
    // A discarded set-up's bound is below the best value, and so below the best set-up's own bound.
    let loosest = family.planned.iter().max_by(|a, b| a.certificate.log_bound.total_cmp(&b.certificate.log_bound));
    let worse = family.planned.iter().filter(|planned| planned.certificate.log_bound < best.log_value).count();
    DesignProof {
        screened,
        examined: family.planned.len() + family.discarded + family.without_plan,
        without_plan: family.without_plan,
        undecided: family.undecided,
        proven_worse: family.discarded + worse,
        bound: loosest.and_then(|planned| planned.document.bound),
        map_error_bound_px: loosest.and_then(|planned| planned.map_error_bound).and_then(finite),
    }
}
