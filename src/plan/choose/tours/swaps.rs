//! Sets of poses traded against the time of their tours, pose by pose.

use super::times::Times;
use crate::selection::Instance;

/// Most poses whose best order is found anew after each swap; of more, a pose that joins goes where it costs least.
const MOST_ORDERED: usize = 12;

/// Most swaps of a descent.
const MOST_SWAPS: usize = 400;

/// Most sets that are valued for a swap.
const MOST_VALUED: usize = 600;

/// Gain of a swap below which it is rounding.
const LEAST_GAIN: f64 = 1e-9;

/// How much more a second of moves counts from descent to descent, as a factor.
const STEEPER: f64 = 1.5;

/// Most descents.
const DESCENTS: usize = 40;

/// What is sought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Aim {
    /// The least time of moves, while log Φ stays at least so great.
    LeastTime {
        /// Least log Φ.
        floor: f64,
    },
    /// The greatest log Φ, while the moves take no more time.
    MostInformation {
        /// Greatest time of the moves, s.
        most: f64,
    },
}

impl Aim {
    /// What a set is worth: the greater, the better; none where it is not allowed.
    pub(super) fn worth(self, log_value: f64, moving: f64) -> Option<f64> {
        match self {
            Self::LeastTime { floor } => (log_value >= floor).then_some(-moving),
            Self::MostInformation { most } => (moving <= most).then_some(log_value),
        }
    }

    /// What all the moves of a set of this log Φ count at first.
    fn first_price(self, log_value: f64) -> f64 {
        match self {
            Self::LeastTime { floor } => (0.1 * (log_value - floor)).max(1e-4),
            Self::MostInformation { .. } => 1e-2,
        }
    }
}

/// A set of poses and its tour.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Route {
    /// The views, in the order of the tour.
    pub(super) order: Vec<usize>,
    pub(super) log_value: f64,
    /// Time of the straight moves, s.
    pub(super) moving: f64,
}

/// What sets are traded from.
pub(super) struct Market<'a> {
    instance: &'a Instance<'a>,
    /// Of all views.
    joints: &'a [&'a [f64]],
    times: &'a Times<'a>,
    /// Views that may join.
    pool: Vec<usize>,
    seed: u64,
}

/// A set on the way, with what the next swap is reckoned from.
struct Current {
    route: Route,
    total: Vec<f64>,
    /// For each pose in the order, the times of the moves to the views of the pool.
    moves: Vec<Vec<f64>>,
}

/// A pose gives way to a view of the pool.
#[derive(Clone, Copy)]
struct Swap {
    place: usize,
    pooled: usize,
    /// Place in the order of the others before which the view comes.
    before: usize,
    moving: f64,
    /// No less than its gain.
    gain: f64,
}

impl<'a> Market<'a> {
    pub(super) fn new(
        instance: &'a Instance<'a>,
        joints: &'a [&'a [f64]],
        times: &'a Times<'a>,
        pool: impl IntoIterator<Item = usize>,
        seed: u64,
    ) -> Self {
        let pool = pool.into_iter().filter(|&i| instance.is_open(i)).collect();
        Self { instance, joints, times, pool, seed }
    }

    /// The set with its best order.
    pub(super) fn route(&self, selected: &[usize]) -> Route {
        let poses: Vec<&[f64]> = selected.iter().map(|&i| self.q(i)).collect();
        let (order, moving) = self.times.ordered(&poses, self.seed);
        let log_value = self.instance.log_value_at(&self.instance.total(selected));
        Route { order: order.into_iter().map(|place| selected[place]).collect(), log_value, moving }
    }

    /// The best set for `aim` that swaps of one pose lead to from `start`; none where no set on the way was allowed. `observe` sees
    /// those on the way.
    ///
    /// Swaps that win time at once spend the information on the first poses that they find. So sets first descend by
    /// `μ · time − log Φ`, with a second counting more from descent to descent, and then by the aim itself from the best.
    pub(super) fn trade(&self, start: &[usize], aim: Aim, observe: &mut dyn FnMut(&Route)) -> Option<Route> {
        let first = self.route(start);
        let mut best: Option<Route> = None;
        let mut see = |seen: &Route| {
            observe(seen);
            let worth = |set: &Route| aim.worth(set.log_value, set.moving);
            if worth(seen) > best.as_ref().and_then(worth) {
                best = Some(seen.clone());
            }
        };
        see(&first);
        if first.moving == 0.0 || first.log_value == f64::NEG_INFINITY {
            return best;
        }
        let mut per_second = aim.first_price(first.log_value) / first.moving;
        let mut current = self.current(first);
        let mut beyond = 0;
        for _ in 0..DESCENTS {
            self.descend(&mut current, &|log_value, moving| Some(log_value - per_second * moving), &mut see);
            beyond += match aim {
                Aim::LeastTime { floor } => usize::from(current.route.log_value < floor),
                Aim::MostInformation { most } => usize::from(current.route.moving <= most),
            };
            if beyond > 1 {
                break;
            }
            per_second *= STEEPER;
        }
        let mut current = self.current(best?);
        let mut best = current.route.clone();
        self.descend(&mut current, &|log_value, moving| aim.worth(log_value, moving), &mut |seen| best = seen.clone());
        Some(best)
    }

    /// As many poses as `count`: those of a set and others, that tell most for their time, or without those that tell least. `None`
    /// where the constraints leave too few.
    pub(super) fn resized(&self, from: &Route, count: usize) -> Option<Vec<usize>> {
        let mut order = from.order.clone();
        while order.len() != count {
            let gradient = self.instance.gradient_at(&self.instance.total(&order))?;
            let poses: Vec<&[f64]> = order.iter().map(|&i| self.q(i)).collect();
            let per_second = |lead: f64, moving: f64| lead / self.times.total(moving, 1).max(f64::MIN_POSITIVE);
            let worth = |(place, lead): &(usize, f64), longer: &dyn Fn(usize) -> f64| per_second(*lead, longer(*place));
            if order.len() > count {
                let leads = self.instance.scores_of(&gradient.y, &order).into_iter().enumerate();
                let free = leads.filter(|&(place, _)| !self.instance.required().contains(&order[place]));
                let saved = |place: usize| self.times.saved(&poses, place);
                let least = free.min_by(|a, b| worth(a, &saved).total_cmp(&worth(b, &saved)))?;
                order.remove(least.0);
            } else {
                let rules = self.instance.rules();
                let leads = self.instance.scores_of(&gradient.y, &self.pool).into_iter().enumerate();
                let allowed = leads.filter(|&(pooled, _)| {
                    !order.contains(&self.pool[pooled]) && rules.allows(&order, None, self.pool[pooled])
                });
                let longer = |pooled: usize| self.times.by_way_of(&poses, self.q(self.pool[pooled])).1;
                let most = allowed.max_by(|a, b| worth(a, &longer).total_cmp(&worth(b, &longer)))?;
                let joins = self.pool[most.0];
                order.insert(self.times.by_way_of(&poses, self.q(joins)).0, joins);
            }
        }
        Some(order)
    }

    fn q(&self, i: usize) -> &'a [f64] {
        self.joints[i]
    }

    fn current(&self, route: Route) -> Current {
        let total = self.instance.total(&route.order);
        let moves = route.order.iter().map(|&i| self.moves(i)).collect();
        Current { route, total, moves }
    }

    /// Times of the moves between a view and those of the pool.
    fn moves(&self, i: usize) -> Vec<f64> {
        self.pool.iter().map(|&j| self.times.between(self.q(i), self.q(j))).collect()
    }

    /// Swaps poses as long as that gains by `worth` of log Φ and the time of moves, which grows with log Φ.
    fn descend(&self, current: &mut Current, worth: &dyn Fn(f64, f64) -> Option<f64>, see: &mut dyn FnMut(&Route)) {
        for _ in 0..MOST_SWAPS {
            let Some(swap) = self.best_swap(current, worth) else { break };
            self.apply(current, swap);
            see(&current.route);
        }
    }

    /// The swap that gains most. By the concavity of Φ no swap gains more than the gradient tells, so that few sets are valued.
    fn best_swap(&self, current: &Current, worth: &dyn Fn(f64, f64) -> Option<f64>) -> Option<Swap> {
        let Route { order, log_value, moving } = &current.route;
        let own = worth(*log_value, *moving).unwrap_or(f64::NEG_INFINITY);
        let gradient = self.instance.gradient_at(&current.total)?;
        let leads = self.instance.scores_of(&gradient.y, &self.pool);
        let own_leads = self.instance.scores_of(&gradient.y, order);
        let stays: Vec<bool> = order.iter().map(|i| self.instance.required().contains(i)).collect();
        let poses: Vec<&[f64]> = order.iter().map(|&i| self.q(i)).collect();
        let detours = Detours::new(self.times, &poses, &current.moves);
        let mut swaps = Vec::new();
        for (pooled, &i) in self.pool.iter().enumerate().filter(|(_, i)| !order.contains(i)) {
            for (place, (before, longer)) in detours.instead(pooled, self.q(i)).enumerate().filter(|(p, _)| !stays[*p])
            {
                let greatest = log_value + (leads[pooled] - own_leads[place]).ln_1p();
                let worth = worth(greatest, moving + longer);
                if let Some(gain) = worth.map(|worth| worth - own).filter(|gain| *gain > LEAST_GAIN) {
                    swaps.push(Swap { place, pooled, before, moving: moving + longer, gain });
                }
            }
        }
        swaps.sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then((a.pooled, a.place).cmp(&(b.pooled, b.place))));
        let mut best: Option<Swap> = None;
        for swap in swaps.into_iter().take(MOST_VALUED) {
            if best.is_some_and(|best| best.gain >= swap.gain) {
                break;
            }
            let (leaves, joins) = (order[swap.place], self.pool[swap.pooled]);
            if !self.instance.rules().allows(order, Some(leaves), joins) {
                continue;
            }
            let mut total = current.total.clone();
            self.instance.add_to(&mut total, leaves, -1.0);
            self.instance.add_to(&mut total, joins, 1.0);
            let gain = worth(self.instance.log_value_in_place(&mut total), swap.moving).map(|worth| worth - own);
            if let Some(gain) = gain.filter(|gain| *gain > LEAST_GAIN)
                && best.is_none_or(|best| gain > best.gain)
            {
                best = Some(Swap { gain, ..swap });
            }
        }
        best
    }

    fn apply(&self, current: &mut Current, swap: Swap) {
        let mut order = current.route.order.clone();
        order.remove(swap.place);
        current.moves.remove(swap.place);
        let joins = self.pool[swap.pooled];
        order.insert(swap.before, joins);
        current.moves.insert(swap.before, self.moves(joins));
        current.total = self.instance.total(&order);
        let log_value = self.instance.log_value_at(&current.total);
        current.route = Route { order, log_value, moving: swap.moving };
        if current.route.order.len() <= MOST_ORDERED {
            let route = self.route(&current.route.order);
            let place = |i: &usize| current.route.order.iter().position(|j| j == i);
            let places: Vec<usize> = route.order.iter().filter_map(place).collect();
            current.moves = places.into_iter().map(|place| std::mem::take(&mut current.moves[place])).collect();
            current.route = Route { log_value, ..route };
        }
    }
}

/// What it takes to go by other poses on a tour.
///
/// Gap g is before the pose at place g; the last one is after all poses.
struct Detours<'c> {
    times: &'c Times<'c>,
    moves: &'c [Vec<f64>],
    /// Times of the moves across the gaps.
    gaps: Vec<f64>,
    /// Times of the moves across each pose's place, once it has left.
    without: Vec<f64>,
}

impl<'c> Detours<'c> {
    fn new(times: &'c Times, poses: &[&[f64]], moves: &'c [Vec<f64>]) -> Self {
        let k = poses.len();
        let across = |before: Option<usize>, after: usize| {
            times.across(before.map(|before| poses[before]), poses.get(after).copied())
        };
        Self {
            times,
            moves,
            gaps: (0..=k).map(|gap| across(gap.checked_sub(1), gap)).collect(),
            without: (0..k).map(|place| across(place.checked_sub(1), place + 1)).collect(),
        }
    }

    /// For each pose: before which of the others number `pooled` of the pool, at joint values `q`, best comes in its place, and how
    /// much longer the moves then take.
    fn instead(&self, pooled: usize, q: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let k = self.without.len();
        let (begin, end) = (self.times.begin(q), self.times.end(q));
        let by = move |before: usize, after: usize| {
            let to = if before == 0 { begin } else { self.moves[before - 1][pooled] };
            to + if after == k { end } else { self.moves[after][pooled] }
        };
        // Of three gaps one at least is not beside the pose that leaves.
        let mut least = [(f64::INFINITY, 0); 3];
        for gap in 0..=k {
            let cost = by(gap, gap) - self.gaps[gap];
            let place = least.iter().position(|&(known, _)| cost < known);
            if let Some(place) = place {
                least[place..].rotate_right(1);
                least[place] = (cost, gap);
            }
        }
        (0..k).map(move |place| {
            let elsewhere = least.iter().find(|(_, gap)| *gap != place && *gap != place + 1);
            let (elsewhere, gap) = elsewhere.copied().unwrap_or((f64::INFINITY, 0));
            let here = by(place, place + 1) - self.without[place];
            let saved = self.gaps[place] + self.gaps[place + 1] - self.without[place];
            if here <= elsewhere {
                (place, here - saved)
            } else {
                (if gap > place { gap - 1 } else { gap }, elsewhere - saved)
            }
        })
    }
}
