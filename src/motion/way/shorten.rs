//! A way made shorter: needless corners removed, shortcuts taken at random, corners pulled in.

use rand::Rng;

use super::between;
use super::scout::Scout;

/// Least saving that counts, as a share of the cost of the part that is replaced.
const LEAST_GAIN: f64 = 1e-3;

/// Of costs, relative.
const ROUNDING: f64 = 1e-12;

/// Rounds of pulling all corners in, at most.
const ROUNDS: usize = 10;

/// How far a corner is pulled towards the straight line, as shares of the way to it.
const PULLS: [f64; 3] = [0.5, 0.25, 0.125];

/// A way between the same ends, proven move by move, that costs no more.
pub(super) fn shorten(scout: &mut Scout, corners: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut way = Shortened { scout, corners };
    way.drop_corners();
    for _ in 0..way.scout.settings.shortcuts {
        if way.take_shortcut() {
            way.drop_corners();
        }
    }
    for _ in 0..ROUNDS {
        if !way.pull_corners() {
            break;
        }
        way.drop_corners();
    }
    way.corners
}

struct Shortened<'s, 'a> {
    scout: &'s mut Scout<'a>,
    corners: Vec<Vec<f64>>,
}

impl Shortened<'_, '_> {
    /// Removes corners, many at once where that is safe.
    fn drop_corners(&mut self) {
        let mut first = 0;
        while first + 2 < self.corners.len() {
            let mut last = self.corners.len() - 1;
            while last > first + 1 && !self.replace(first, last, &[]) {
                last -= 1;
            }
            first += 1;
        }
    }

    /// Tries a straight move between random places of two moves; whether that saves anything.
    fn take_shortcut(&mut self) -> bool {
        let moves = self.corners.len() - 1;
        let mut pick = || self.scout.rng.gen_range(0.0..moves as f64);
        let (a, b) = (pick(), pick());
        let (a, b) = (a.min(b), a.max(b));
        let (first, last) = (a as usize, b as usize + 1);
        if last < first + 2 {
            return false;
        }
        let place = |at: f64| between(&self.corners[at as usize], &self.corners[at as usize + 1], at.fract());
        let via = [place(a), place(b)];
        self.replace(first, last, &via)
    }

    /// Pulls each corner towards the middle of its neighbours; whether that saves anything.
    fn pull_corners(&mut self) -> bool {
        let mut is_pulled = false;
        for corner in 1..self.corners.len() - 1 {
            let middle = between(&self.corners[corner - 1], &self.corners[corner + 1], 0.5);
            is_pulled |= PULLS.iter().any(|&pull| {
                let via = between(&self.corners[corner], &middle, pull);
                self.replace(corner - 1, corner + 1, &[via])
            });
        }
        is_pulled
    }

    /// Replaces the corners between two others by `via` if that is safe and saves enough.
    fn replace(&mut self, first: usize, last: usize, via: &[Vec<f64>]) -> bool {
        let old = &self.corners[first..=last];
        let new: Vec<&[f64]> = [&old[0]].into_iter().chain(via).chain(old.last()).map(Vec::as_slice).collect();
        let cost = |ends: [&[f64]; 2]| self.scout.cost(ends[0], ends[1]);
        let before: f64 = old.windows(2).map(|pair| cost([&pair[0], &pair[1]])).sum();
        let after: f64 = new.windows(2).map(|pair| cost([pair[0], pair[1]])).sum();
        // A corner less is worth having though it saves nothing, as on a straight line, where rounding decides.
        let saves = after <= before * if via.is_empty() { 1.0 + ROUNDING } else { 1.0 - LEAST_GAIN };
        // The longest move is the likeliest to be unsafe; of a shortcut, it is in the middle.
        let is_safe = saves && {
            let mut moves: Vec<_> = new.windows(2).collect();
            moves.sort_by(|a, b| cost([b[0], b[1]]).total_cmp(&cost([a[0], a[1]])));
            moves.into_iter().all(|pair| self.scout.is_safe(pair[0], pair[1]))
        };
        if is_safe {
            self.corners.splice(first + 1..last, via.iter().cloned());
        }
        is_safe
    }
}
