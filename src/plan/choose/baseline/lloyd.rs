//! Lloyd's method.

use pulp::{Arch, Simd, WithSimd};

use super::centres::{Centres, Nearest};
use super::points::{Points, squared_distance};

/// Most rounds; some twenty to fifty are common.
const MOST_ROUNDS: usize = 300;

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
    let (centres, bounds) = Arch::new().dispatch(Rounds { points, centres: start });
    let labels: Vec<usize> = bounds.iter().map(|bounds| bounds.label as usize).collect();
    let centres: Vec<Vec<f64>> = (0..centres.len()).map(|c| centres.get(c)).collect();
    let inertia = points.iter().zip(&labels).map(|(point, &c)| squared_distance(point, &centres[c])).sum();
    Clustering { centres, labels, inertia }
}

/// What is known of a point: `upper` is at least its distance from its centre, `lower` at most that from any other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    label: u32,
    upper: f64,
    lower: f64,
}

impl From<Nearest> for Bounds {
    fn from(Nearest { centre, squared, second_squared }: Nearest) -> Self {
        Self { label: centre as u32, upper: squared.sqrt(), lower: second_squared.sqrt() }
    }
}

/// The rounds of [`lloyd`], from these centres on; compiled for every set of instructions that [`Arch`] tells apart.
///
/// By Hamerly's bounds (*Making k-means even faster*, 2010) most points are seen to stay without looking at other centres than
/// their own.
pub(super) struct Rounds<'a> {
    pub(super) points: &'a Points,
    pub(super) centres: Centres,
}

impl WithSimd for Rounds<'_> {
    type Output = (Centres, Vec<Bounds>);

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "only so is it compiled for each set of instructions")]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { points, mut centres } = self;
        let mut bounds: Vec<Bounds> = Vec::with_capacity(points.len());
        for point in points.iter() {
            bounds.push(centres.nearest(point).into());
        }
        let mut half_gaps = vec![0.0; centres.len()];
        for _ in 0..MOST_ROUNDS {
            let moves = to_means(points, &bounds, &mut centres);
            let farthest = (0..moves.len()).max_by(|&a, &b| moves[a].total_cmp(&moves[b])).unwrap_or(0);
            let next = (0..moves.len()).filter(|&c| c != farthest).map(|c| moves[c]).fold(0.0, f64::max);
            // Half of each centre's distance from the nearest other, itself being the nearest: a point within stays.
            for (c, half_gap) in half_gaps.iter_mut().enumerate() {
                *half_gap = 0.5 * centres.nearest(&centres.get(c)).second_squared.sqrt();
            }
            let mut changed = false;
            for (bounds, point) in bounds.iter_mut().zip(points.iter()) {
                let label = bounds.label as usize;
                bounds.upper += moves[label];
                bounds.lower -= if label == farthest { next } else { moves[farthest] };
                let stays = half_gaps[label].max(bounds.lower);
                if bounds.upper > stays {
                    bounds.upper = centres.squared_distance(point, label).sqrt();
                }
                if bounds.upper > stays {
                    *bounds = centres.nearest(point).into();
                    changed |= bounds.label as usize != label;
                }
            }
            if !changed {
                break;
            }
        }
        (centres, bounds)
    }
}

/// Moves the centres to the means of their points; returns how far each moved.
fn to_means(points: &Points, bounds: &[Bounds], centres: &mut Centres) -> Vec<f64> {
    let width = points.width();
    let (mut sums, mut counts) = (vec![0.0; centres.len() * width], vec![0usize; centres.len()]);
    for (point, bounds) in points.iter().zip(bounds) {
        let label = bounds.label as usize;
        counts[label] += 1;
        for (sum, x) in sums[label * width..][..width].iter_mut().zip(point) {
            *sum += x;
        }
    }
    let mut moves = vec![0.0; centres.len()];
    for (c, (sum, count)) in sums.chunks_exact_mut(width).zip(counts).enumerate() {
        if count > 0 {
            for x in sum.iter_mut() {
                *x /= count as f64;
            }
            moves[c] = centres.squared_distance(sum, c).sqrt();
            centres.put(c, sum);
        }
    }
    moves
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

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
            let mut centres = start;
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
            prop_assert_eq!(found, Clustering { centres, labels, inertia });
        }
    }
}
