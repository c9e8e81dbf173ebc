//! Lloyd's method.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::centres::{Centres, Nearest};
use super::points::{Points, squared_distance};

/// Most rounds; some twenty to fifty are common.
const MOST_ROUNDS: usize = 300;

/// Points that a thread looks at at a time.
const POINTS_PER_TASK: usize = 1 << 15;

/// Points in clusters.
#[derive(Debug, Clone, PartialEq)]
pub struct Clustering {
    /// Centre of each cluster.
    pub centres: Vec<Vec<f64>>,
    /// Cluster of each point.
    pub labels: Vec<usize>,
    /// Sum of the squared distances of the points from their centres.
    pub inertia: f64,
}

/// Lloyd's method: every point joins the nearest of `centres`, at least one, each of as many coordinates as the points; these move to
/// the means of their points, until no point changes its cluster. A cluster that loses all its points stays where it is.
pub fn lloyd(points: &Points, centres: &[Vec<f64>]) -> Clustering {
    let start = Centres::new(points.width(), centres.iter().map(Vec::as_slice));
    let (centres, bounds) = rounds(points, start);
    let labels: Vec<usize> = bounds.iter().map(|bounds| bounds.label as usize).collect();
    let centres: Vec<Vec<f64>> = (0..centres.len()).map(|c| centres.get(c)).collect();
    let inertia = points.iter().zip(&labels).map(|(point, &c)| squared_distance(point, &centres[c])).sum();
    Clustering { centres, labels, inertia }
}

/// What is known of a point, as of the start: `upper` and what its centre travelled since then are at least its distance from it,
/// `lower` less what the others came nearer at most that from any other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    label: u32,
    upper: f64,
    lower: f64,
}

/// The rounds of [`lloyd`], from these centres on; the same on any number of threads.
///
/// By Hamerly's bounds (*Making k-means even faster*, 2010) most points are seen to stay without looking at other centres than
/// their own. Nothing is written of them, nor read but the bounds: what there is of a million points is in no cache.
pub(super) fn rounds(points: &Points, mut centres: Centres) -> (Centres, Vec<Bounds>) {
    let mut bounds = vec![Bounds { label: 0, upper: f64::INFINITY, lower: 0.0 }; points.len()];
    let none = vec![0.0; centres.len()];
    let mut motion = Motion { half_gaps: none.clone(), travelled: none.clone(), approached: none };
    join_nearest(points, &centres, &motion, &mut bounds);
    let mut members = Clusters::new(points, &bounds, centres.len());
    for _ in 0..MOST_ROUNDS {
        motion.add(&to_means(&members, &mut centres), &centres);
        let changes = join_nearest(points, &centres, &motion, &mut bounds);
        for &Change { point, from, to } in &changes {
            members.take(from, points.point(point));
            members.put(to, points.point(point));
        }
        leave_behind(points, &changes, &members, &mut centres);
        if changes.is_empty() && members.exact {
            break;
        }
        if changes.is_empty() {
            members = Clusters::new(points, &bounds, centres.len());
        }
    }
    (centres, bounds)
}

/// How the centres have moved.
struct Motion {
    /// Half of each centre's distance from the nearest other: a point within stays.
    half_gaps: Vec<f64>,
    /// Of each centre how far it has moved since the start, and how far any other may have come towards its points.
    travelled: Vec<f64>,
    approached: Vec<f64>,
}

impl Motion {
    /// Of centres that moved so far to where they are.
    fn add(&mut self, moves: &[f64], centres: &Centres) {
        let farthest = (0..moves.len()).max_by(|&a, &b| moves[a].total_cmp(&moves[b])).unwrap_or(0);
        let next = (0..moves.len()).filter(|&c| c != farthest).map(|c| moves[c]).fold(0.0, f64::max);
        for c in 0..moves.len() {
            // Itself is the nearest.
            self.half_gaps[c] = 0.5 * centres.nearest(&centres.get(c)).second_squared.sqrt();
            self.travelled[c] += moves[c];
            self.approached[c] += if c == farthest { next } else { moves[farthest] };
        }
    }
}

/// A point leaves a cluster for another.
struct Change {
    point: usize,
    from: usize,
    to: usize,
}

/// Every point joins its nearest centre; those that leave another for it, in their order.
fn join_nearest(points: &Points, centres: &Centres, motion: &Motion, bounds: &mut [Bounds]) -> Vec<Change> {
    let pass = |(chunk, bounds): (usize, &mut [Bounds])| {
        Arch::new().dispatch(Pass { points, first: chunk * POINTS_PER_TASK, centres, motion, bounds })
    };
    let changes: Vec<Vec<Change>> = bounds.par_chunks_mut(POINTS_PER_TASK).enumerate().map(pass).collect();
    changes.into_iter().flatten().collect()
}

/// [`join_nearest`] for the points of some bounds, from `first` on; compiled for every set of instructions that [`Arch`] tells apart.
struct Pass<'a> {
    points: &'a Points,
    first: usize,
    centres: &'a Centres,
    motion: &'a Motion,
    bounds: &'a mut [Bounds],
}

impl WithSimd for Pass<'_> {
    type Output = Vec<Change>;

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "only so is it compiled for each set of instructions")]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { points, first, centres, motion, bounds } = self;
        let Motion { half_gaps, travelled, approached } = motion;
        let mut changes = Vec::new();
        for (i, bounds) in (first..).zip(bounds) {
            let label = bounds.label as usize;
            let stays = half_gaps[label].max(bounds.lower - approached[label]);
            if bounds.upper + travelled[label] <= stays {
                continue;
            }
            let point = points.point(i);
            let distance = centres.squared_distance(point, label).sqrt();
            bounds.upper = distance - travelled[label];
            if distance > stays {
                let Nearest { centre, squared, second_squared } = centres.nearest(point);
                if centre != label {
                    changes.push(Change { point: i, from: label, to: centre });
                }
                let (upper, lower) = (squared.sqrt() - travelled[centre], second_squared.sqrt() + approached[centre]);
                *bounds = Bounds { label: centre as u32, upper, lower };
            }
        }
        changes
    }
}

/// The points of each cluster, summed.
struct Clusters {
    width: usize,
    /// Clusters × coordinates.
    sums: Vec<f64>,
    counts: Vec<usize>,
    /// Whether they were summed in the points' order, and not kept up as points changed their clusters, with the rounding of that.
    exact: bool,
}

impl Clusters {
    fn new(points: &Points, bounds: &[Bounds], clusters: usize) -> Self {
        let width = points.width();
        let mut found = Self { width, sums: vec![0.0; clusters * width], counts: vec![0; clusters], exact: true };
        for (point, bounds) in points.iter().zip(bounds) {
            found.put(bounds.label as usize, point);
        }
        Self { exact: true, ..found }
    }

    fn put(&mut self, cluster: usize, point: &[f64]) {
        self.counts[cluster] += 1;
        self.exact = false;
        for (sum, x) in self.sums[cluster * self.width..].iter_mut().zip(point) {
            *sum += x;
        }
    }

    fn take(&mut self, cluster: usize, point: &[f64]) {
        self.counts[cluster] -= 1;
        self.exact = false;
        for (sum, x) in self.sums[cluster * self.width..].iter_mut().zip(point) {
            *sum -= x;
        }
    }
}

/// Moves the centres to the means of their members; returns how far each moved.
fn to_means(members: &Clusters, centres: &mut Centres) -> Vec<f64> {
    let mut moves = vec![0.0; centres.len()];
    for (c, (sum, &count)) in members.sums.chunks_exact(members.width).zip(&members.counts).enumerate() {
        if count > 0 {
            let mean: Vec<f64> = sum.iter().map(|x| x / count as f64).collect();
            moves[c] = centres.squared_distance(&mean, c).sqrt();
            centres.put(c, &mean);
        }
    }
    moves
}

/// Puts the centres whose last points have just left to the exact means of these, for they stay there: the sums that they had moved by
/// are kept up with rounding.
fn leave_behind(points: &Points, changes: &[Change], members: &Clusters, centres: &mut Centres) {
    let mut emptied: Vec<usize> =
        changes.iter().map(|change| change.from).filter(|&c| members.counts[c] == 0).collect();
    emptied.sort_unstable();
    emptied.dedup();
    for c in emptied {
        let last: Vec<&[f64]> =
            changes.iter().filter(|change| change.from == c).map(|x| points.point(x.point)).collect();
        let mean = |i: usize| last.iter().map(|point| point[i]).sum::<f64>() / last.len() as f64;
        centres.put(c, &(0..members.width).map(mean).collect::<Vec<_>>());
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256Plus;

    use super::*;

    proptest! {
        /// The bounds change nothing: the same rounds without them.
        #[test]
        fn bounds_change_no_label(
            points in prop::collection::vec(prop::collection::vec(-1.0..1.0f64, 2), 1..60),
            count in 1usize..24,
        ) {
            let points = Points::new(&points).unwrap();
            let start: Vec<Vec<f64>> = (0..count.min(points.len())).map(|c| points.point(c).to_vec()).collect();
            let found = lloyd(&points, &start);
            prop_assert_eq!(found, plainly(&points, start));
        }
    }

    #[test]
    fn many_points_are_looked_at_in_parts() {
        let mut rng = Xoshiro256Plus::seed_from_u64(2);
        let count = 2 * POINTS_PER_TASK + 1000;
        let points: Vec<[f64; 2]> = (0..count).map(|_| [rng.gen_range(-1.0..1.0), rng.gen_range(-1.0..1.0)]).collect();
        let points = Points::new(&points).unwrap();
        let start: Vec<Vec<f64>> = (0..5).map(|c| points.point(c * POINTS_PER_TASK / 2).to_vec()).collect();
        assert_eq!(lloyd(&points, &start), plainly(&points, start));
    }

    /// The same in the plane without bounds, point by point.
    fn plainly(points: &Points, mut centres: Vec<Vec<f64>>) -> Clustering {
        let mut labels: Vec<usize> = vec![];
        loop {
            let nearest = |point: &[f64]| {
                let squared = centres.iter().map(|centre| squared_distance(point, centre)).enumerate();
                squared.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0
            };
            let now: Vec<usize> = points.iter().map(nearest).collect();
            if now == labels {
                break;
            }
            labels = now;
            for (c, centre) in centres.iter_mut().enumerate() {
                let own: Vec<&[f64]> = points.iter().zip(&labels).filter(|&(_, &l)| l == c).map(|(p, _)| p).collect();
                if !own.is_empty() {
                    let mean = |i: usize| own.iter().map(|point| point[i]).sum::<f64>() / own.len() as f64;
                    *centre = (0..2).map(mean).collect();
                }
            }
        }
        let inertia: f64 = points.iter().zip(&labels).map(|(p, &c)| squared_distance(p, &centres[c])).sum();
        Clustering { centres, labels, inertia }
    }
}
