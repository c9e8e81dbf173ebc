//! A tour whose moves are safe: straight where that is proven, else round about.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::limits::JointLimits;
use super::safety::{Danger, Safety};
use super::timing::duration;
use super::tour::{Costs, Ends, Tour, cost, tour};
use super::way::{Effort, Failure, Precision, Settings, Space, find, prove};
use crate::robot::{Limits, Robot};

/// What the search for a way round may take: half a second or so.
const MOST: Effort = Effort { nodes: 2000, evaluations: 20_000 };

/// Tours found at most, each with the moves of the one before timed as they must go.
const MOST_TOURS: usize = 60;

/// How much longer a move counts than all straight ones together, for which no way was found.
const AVOIDED: f64 = 10.0;

/// What moves are made by.
pub struct Arm<'a> {
    safety: Safety<'a>,
    /// What each joint may do.
    limits: Vec<JointLimits>,
    /// What each joint's value may be, rad or m.
    ranges: Vec<Limits>,
}

/// Stops in the order in which safe moves between them take least time, as far as was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Journey {
    /// All stops, home first.
    pub order: Vec<usize>,
    /// The moves between them in this order, the return included.
    pub moves: Vec<Move>,
    /// Time that no order's moves take less than, s: those of straight moves, safe or not.
    pub least: f64,
    /// Time of straight moves from stop to stop as they are numbered, s.
    pub as_numbered: f64,
}

/// A move from stop to stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Where it turns between its ends, rad or m; from there to there it is straight, and the arm at rest.
    pub via: Vec<Vec<f64>>,
    /// Its time, s.
    pub seconds: f64,
    /// What is known of its safety; none where nothing is tested.
    pub safety: Option<Result<Clear, Blocked>>,
}

/// A move is proven safe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clear {
    /// What the distance of two tested links does not sink below, m.
    pub clearance: Option<f64>,
    /// What the tip-over margin does not sink below, m.
    pub tip_over_margin: Option<f64>,
    /// What came nearest to failing.
    pub nearest: Option<Danger>,
}

/// A move is not safe, nor was a way round found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blocked {
    /// What stands in the way.
    pub danger: Danger,
}

impl Journey {
    /// From stop to stop of `stops`, joint values in rad or m; the seed decides where good orders and ways are sought.
    ///
    /// # Panics
    /// When home is none of the stops.
    pub fn new(arm: &Arm, stops: &[&[f64]], ends: Ends, seed: u64) -> Self {
        let straight = Costs::from_fn(stops.len(), |i, j| duration(stops[i], stops[j], &arm.limits));
        let numbered: Vec<usize> =
            ends.home().into_iter().chain((0..stops.len()).filter(|&stop| Some(stop) != ends.home())).collect();
        let first = tour(&straight, ends, seed);
        let avoided = AVOIDED * cost(&straight, ends, &numbered);
        let mut known: BTreeMap<[usize; 2], Move> = BTreeMap::new();
        // The best of the tours whose moves are all known, by how many are blocked and by its time.
        let mut best: Option<((usize, f64), Tour)> = None;
        let mut found = first.clone();
        for _ in 0..MOST_TOURS {
            let legs: Vec<[usize; 2]> = pairs(&found, ends).into_iter().map(sorted).collect();
            let open: Vec<[usize; 2]> = legs.iter().copied().filter(|pair| !known.contains_key(pair)).collect();
            let is_last = open.is_empty();
            let moves = open.into_par_iter().map(|[i, j]| ([i, j], arm.go(stops[i], stops[j], seed)));
            known.extend(moves.collect::<Vec<_>>());
            let of_tour = || legs.iter().filter_map(|pair| known.get(pair));
            let blocked = of_tour().filter(|found| matches!(found.safety, Some(Err(_)))).count();
            let worth = (blocked, of_tour().map(|found| found.seconds).sum());
            if best.as_ref().is_none_or(|(least, _)| worth < *least) {
                best = Some((worth, found));
            }
            if is_last {
                break;
            }
            let cost = |i: usize, j: usize| match known.get(&[i, j]) {
                Some(Move { safety: Some(Err(_)), .. }) => avoided,
                Some(found) => found.seconds,
                None => straight.between(i, j),
            };
            found = tour(&Costs::from_fn(stops.len(), cost), ends, seed);
        }
        let found = best.map_or_else(|| first.clone(), |(_, found)| found);
        let moves = pairs(&found, ends).into_iter().filter_map(|[i, j]| {
            let there = known.get(&sorted([i, j]))?.clone();
            Some(if i < j { there } else { Move { via: there.via.into_iter().rev().collect(), ..there } })
        });
        Self {
            moves: moves.collect(),
            least: first.bound,
            as_numbered: cost(&straight, ends, &numbered),
            order: found.order,
        }
    }
}

impl<'a> Arm<'a> {
    /// The arm of a robot whose joints may do so much, with what must hold on its way.
    pub fn new(robot: &Robot, limits: Vec<JointLimits>, safety: Safety<'a>) -> Self {
        Self { safety, limits, ranges: robot.chain.joints.iter().map(|joint| joint.limits).collect() }
    }

    /// Whether a configuration is within the limits of all joints.
    pub fn reaches(&self, q: &[f64]) -> bool {
        q.len() == self.ranges.len() && q.iter().zip(&self.ranges).all(|(&value, range)| range.holds(value))
    }

    /// The move between two places, joint values in rad or m: straight where that is safe or nothing is tested, else by a way round, if
    /// one is found; the seed decides where it is sought.
    pub fn go(&self, from: &[f64], to: &[f64], seed: u64) -> Move {
        let cost = |from: &[f64], to: &[f64]| duration(from, to, &self.limits);
        let straight = |safety| Move { via: vec![], seconds: cost(from, to), safety };
        if self.safety.is_empty() {
            return straight(None);
        }
        let space = Space { margins: &self.safety, limits: &self.ranges, cost: &cost };
        // The margins are looked at below.
        let settings = Settings { precision: Precision::VERDICT, most: MOST, seed, ..Settings::default() };
        let (corners, seconds) = match find(&space, from, to, &settings) {
            Ok(way) => (way.corners, way.cost),
            Err(_) => (vec![from.to_vec(), to.to_vec()], cost(from, to)),
        };
        let safety = self.look_at(&corners.iter().map(Vec::as_slice).collect::<Vec<_>>());
        Move { via: corners[1..corners.len() - 1].to_vec(), seconds, safety }
    }

    /// What is known of the safety of straight moves from corner to corner, two at least; none where nothing is tested.
    pub fn look_at(&self, corners: &[&[f64]]) -> Option<Result<Clear, Blocked>> {
        let mut clear = Clear { clearance: None, tip_over_margin: None, nearest: None };
        let mut nearest = f64::INFINITY;
        for kind in self.safety.kinds() {
            let mut least = f64::INFINITY;
            for pair in corners.windows(2) {
                match prove(&kind, pair[0], pair[1], Precision::default()) {
                    Ok(proof) => {
                        least = least.min(proof.least());
                        if let Some(seen) = proof.seen.filter(|seen| seen.value < nearest) {
                            nearest = seen.value;
                            clear.nearest = Some(kind.danger(seen.margin));
                        }
                    }
                    Err(Failure { place, .. }) => return Some(Err(Blocked { danger: kind.danger(place.margin) })),
                }
            }
            let distance = if kind.is_balance() { &mut clear.tip_over_margin } else { &mut clear.clearance };
            *distance = Some(kind.distance(least));
        }
        (!self.safety.is_empty()).then_some(Ok(clear))
    }
}

/// The stops between which a tour moves, one move after the other.
fn pairs(tour: &Tour, ends: Ends) -> Vec<[usize; 2]> {
    let back = tour.order.first().filter(|_| matches!(ends, Ends::Round(_)));
    let way: Vec<usize> = tour.order.iter().chain(back).copied().collect();
    way.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

fn sorted([i, j]: [usize; 2]) -> [usize; 2] {
    [i.min(j), i.max(j)]
}
