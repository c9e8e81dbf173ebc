//! Times of tours through poses.

use crate::motion::tour::{Costs, Ends, tour};
use crate::motion::{JointLimits, duration};
use crate::problem::{Home, MotionSettings};

/// What straight moves through poses take, and the pictures there.
#[derive(Debug, Clone)]
pub(crate) struct Times<'a> {
    limits: Vec<JointLimits>,
    home: Option<&'a Home>,
    /// Time for the pictures at each pose, s.
    dwell: f64,
}

impl<'a> Times<'a> {
    pub(crate) fn new(motion: &'a MotionSettings) -> Self {
        Self { limits: motion.limits(), home: motion.home.as_ref(), dwell: motion.dwell }
    }

    /// Time of the move between two configurations, s.
    pub(super) fn between(&self, from: &[f64], to: &[f64]) -> f64 {
        duration(from, to, &self.limits)
    }

    /// Time of the move to a first pose, s: none where the tour begins there.
    pub(super) fn begin(&self, first: &[f64]) -> f64 {
        self.home.map_or(0.0, |home| self.between(&home.q, first))
    }

    /// Time of the move after a last pose, s: none where the tour ends there.
    pub(super) fn end(&self, last: &[f64]) -> f64 {
        self.home.filter(|home| home.returns).map_or(0.0, |home| self.between(last, &home.q))
    }

    /// The order of poses in which straight moves take least time, and that time, s.
    pub(super) fn ordered(&self, poses: &[&[f64]], seed: u64) -> (Vec<usize>, f64) {
        let ends = self.ends(poses.len());
        let stops = self.stops(poses);
        let found = tour(&Costs::from_fn(stops.len(), |i, j| self.between(stops[i], stops[j])), ends, seed);
        (found.order.into_iter().filter(|&stop| stop < poses.len()).collect(), found.cost)
    }

    /// Time of the move between neighbours on a tour, of which the first or the last pose has but one, s.
    pub(super) fn across(&self, before: Option<&[f64]>, after: Option<&[f64]>) -> f64 {
        match (before, after) {
            (Some(before), Some(after)) => self.between(before, after),
            (None, Some(first)) => self.begin(first),
            (Some(last), None) => self.end(last),
            (None, None) => 0.0,
        }
    }

    /// What the moves through poses in this order take less without the one at that place, s.
    pub(super) fn saved(&self, poses: &[&[f64]], place: usize) -> f64 {
        let (before, after) = (place.checked_sub(1).map(|before| poses[before]), poses.get(place + 1).copied());
        let by_way = self.across(before, Some(poses[place])) + self.across(Some(poses[place]), after);
        by_way - self.across(before, after)
    }

    /// Before which of the poses in this order another one best comes, and what the moves then take more, s.
    pub(super) fn by_way_of(&self, poses: &[&[f64]], q: &[f64]) -> (usize, f64) {
        let longer = |gap: usize| {
            let (before, after) = (gap.checked_sub(1).map(|before| poses[before]), poses.get(gap).copied());
            self.across(before, Some(q)) + self.across(Some(q), after) - self.across(before, after)
        };
        let gaps = (0..=poses.len()).map(|gap| (gap, longer(gap)));
        gaps.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
    }

    /// Time of a tour of so many poses whose moves take `moving`, s.
    pub(super) fn total(&self, moving: f64, poses: usize) -> f64 {
        moving + self.dwell * poses as f64
    }

    /// Time that no tour of so many poses takes less than which has one where the joint's value is `low` or less and one where it is
    /// `high` or more, and whose poses are `nearest` apart by time, s.
    ///
    /// A joint goes the farther in a given time the fewer moves it takes: its [reach](JointLimits::reach) in the time of a move is convex.
    /// So all moves but one are as short as can be.
    pub(super) fn least_across(&self, joint: usize, [low, high]: [f64; 2], poses: usize, nearest: f64) -> f64 {
        let limits = &self.limits[joint];
        let reach = limits.reach(nearest);
        let between = poses.saturating_sub(1) as f64;
        let way = match self.home {
            None => high - low,
            Some(home) => {
                let (down, up) = ((home.q[joint] - low).max(0.0), (high - home.q[joint]).max(0.0));
                if home.returns { 2.0 * (down + up) } else { down + up + down.min(up) }
            }
        };
        let from_pose_to_pose = if poses > 1 {
            (between - 1.0) * nearest + nearest.max(limits.soonest(way - (between - 1.0) * reach))
        } else {
            f64::INFINITY
        };
        let from_home = match self.home {
            None if poses < 2 => 0.0,
            None => f64::INFINITY,
            Some(_) => between * nearest + limits.soonest(way - between * reach),
        };
        from_pose_to_pose.min(from_home)
    }

    /// The poses, and home after them.
    pub(crate) fn stops<'p>(&'p self, poses: &[&'p [f64]]) -> Vec<&'p [f64]> {
        poses.iter().copied().chain(self.home.map(|home| home.q.as_slice())).collect()
    }

    /// Where a tour of the [stops](Self::stops) of so many poses begins and ends.
    pub(crate) fn ends(&self, poses: usize) -> Ends {
        match self.home {
            None => Ends::Open,
            Some(home) if home.returns => Ends::Round(poses),
            Some(_) => Ends::From(poses),
        }
    }
}
