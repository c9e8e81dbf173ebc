//! The k-means baseline: one member of each of k clusters.

use rand::SeedableRng;
use rand::distributions::{Distribution, WeightedIndex};
use rand_xoshiro::Xoshiro256Plus;
use thiserror::Error;

/// Most rounds of Lloyd's method; some twenty to fifty are common.
const MOST_ROUNDS: usize = 300;

/// Why points cannot be clustered.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ClusteringError {
    /// A point is not of as many finite coordinates as the first.
    #[error("k-means needs points with the same number of finite coordinates; point {point}, counted from 0, differs")]
    Point {
        /// The point.
        point: usize,
    },
    /// No cluster is asked for, or more than there are points.
    #[error("{points} points do not make {count} clusters")]
    Count {
        /// Clusters asked for.
        count: usize,
        /// Number of points.
        points: usize,
    },
}

/// Clusters the rows of `features` into `count` clusters (k-means++ start, Lloyd's method) and returns the
/// member nearest to each centre, distinct and in ascending order.
///
/// # Errors
/// When features are not finite or not equally many, or `count` is 0 or above their number.
pub fn kmeans(features: &[Vec<f64>], count: usize, seed: u64) -> Result<Vec<usize>, ClusteringError> {
    let width = features.first().map_or(0, Vec::len);
    let sound = |point: &Vec<f64>| point.len() == width && point.iter().all(|x| x.is_finite());
    if let Some(point) = features.iter().position(|point| !sound(point)) {
        return Err(ClusteringError::Point { point });
    }
    if count == 0 || count > features.len() {
        return Err(ClusteringError::Count { count, points: features.len() });
    }
    let start = plus_plus(features, count, &mut Xoshiro256Plus::seed_from_u64(seed));
    let clustering = lloyd(features, start.into_iter().map(|i| features[i].clone()).collect());
    let mut taken = vec![false; features.len()];
    for centre in &clustering.centres {
        let free = (0..features.len()).filter(|&i| !taken[i]);
        let nearest = free.map(|i| (squared_distance(&features[i], centre), i)).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, nearest)) = nearest {
            taken[nearest] = true;
        }
    }
    Ok((0..features.len()).filter(|&i| taken[i]).collect())
}

/// Points to start from (Arthur & Vassilvitskii, *k-means++: the advantages of careful seeding*, 2007): each drawn with a chance
/// in proportion to its squared distance from the nearest of those before; the first ones again once no point is apart.
fn plus_plus(points: &[Vec<f64>], count: usize, rng: &mut Xoshiro256Plus) -> Vec<usize> {
    let mut drawn = Vec::with_capacity(count);
    let mut weights = vec![1.0; points.len()];
    for round in 0..count {
        let i = WeightedIndex::new(&weights).map_or(0, |chances| chances.sample(rng));
        drawn.push(i);
        for (weight, point) in weights.iter_mut().zip(points) {
            let distance = squared_distance(point, &points[i]);
            *weight = if round == 0 { distance } else { distance.min(*weight) };
        }
    }
    drawn
}

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

/// Lloyd's method: every point joins the nearest of `centres`, at least one; these move to the means of their points, until no
/// point changes its cluster. A cluster that loses all its points stays where it is.
///
/// By Hamerly's bounds (*Making k-means even faster*, 2010) most points are seen to stay without looking at other centres than
/// their own: `upper` is at least a point's distance from its centre, `lower` at most that from any other.
pub fn lloyd(points: &[Vec<f64>], mut centres: Vec<Vec<f64>>) -> Clustering {
    let mut bounds: Vec<Bounds> = points.iter().map(|point| Bounds::of(point, &centres)).collect();
    for _ in 0..MOST_ROUNDS {
        let moves = to_means(points, &bounds, &mut centres);
        let farthest = (0..moves.len()).max_by(|&a, &b| moves[a].total_cmp(&moves[b])).unwrap_or(0);
        let next = (0..moves.len()).filter(|&c| c != farthest).map(|c| moves[c]).fold(0.0, f64::max);
        let half_gaps = half_gaps(&centres);
        let mut changed = false;
        for (bounds, point) in bounds.iter_mut().zip(points) {
            bounds.upper += moves[bounds.label];
            bounds.lower -= if bounds.label == farthest { next } else { moves[farthest] };
            let stays = half_gaps[bounds.label].max(bounds.lower);
            if bounds.upper > stays {
                bounds.upper = squared_distance(point, &centres[bounds.label]).sqrt();
            }
            if bounds.upper > stays {
                let before = bounds.label;
                *bounds = Bounds::of(point, &centres);
                changed |= bounds.label != before;
            }
        }
        if !changed {
            break;
        }
    }
    let labels: Vec<usize> = bounds.iter().map(|bounds| bounds.label).collect();
    let inertia = points.iter().zip(&labels).map(|(point, &c)| squared_distance(point, &centres[c])).sum();
    Clustering { centres, labels, inertia }
}

/// What is known of a point.
struct Bounds {
    label: usize,
    upper: f64,
    lower: f64,
}

impl Bounds {
    fn of(point: &[f64], centres: &[Vec<f64>]) -> Self {
        let (mut label, mut nearest, mut second) = (0, f64::INFINITY, f64::INFINITY);
        for (c, centre) in centres.iter().enumerate() {
            let distance = squared_distance(point, centre);
            if distance < nearest {
                (label, nearest, second) = (c, distance, nearest);
            } else if distance < second {
                second = distance;
            }
        }
        Self { label, upper: nearest.sqrt(), lower: second.sqrt() }
    }
}

/// Moves the centres to the means of their points; returns how far each moved.
fn to_means(points: &[Vec<f64>], bounds: &[Bounds], centres: &mut [Vec<f64>]) -> Vec<f64> {
    let mut sums: Vec<(Vec<f64>, usize)> = centres.iter().map(|centre| (vec![0.0; centre.len()], 0)).collect();
    for (point, bounds) in points.iter().zip(bounds) {
        let (sum, count) = &mut sums[bounds.label];
        *count += 1;
        for (sum, x) in sum.iter_mut().zip(point) {
            *sum += x;
        }
    }
    let moved = |(centre, (sum, count)): (&mut Vec<f64>, (Vec<f64>, usize))| {
        if count == 0 {
            return 0.0;
        }
        let mean = sum.into_iter().map(|x| x / count as f64).collect();
        let before = std::mem::replace(centre, mean);
        squared_distance(&before, centre).sqrt()
    };
    centres.iter_mut().zip(sums).map(moved).collect()
}

/// Half of each centre's distance from the nearest other: a point within stays.
fn half_gaps(centres: &[Vec<f64>]) -> Vec<f64> {
    let nearest = |c: usize| {
        let others = (0..centres.len()).filter(|&other| other != c);
        others.map(|other| squared_distance(&centres[c], &centres[other])).fold(f64::INFINITY, f64::min)
    };
    (0..centres.len()).map(|c| 0.5 * nearest(c).sqrt()).collect()
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
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
            count in 1usize..8,
        ) {
            let start: Vec<Vec<f64>> = (0..count.min(points.len())).map(|c| points[c].clone()).collect();
            let found = lloyd(&points, start.clone());
            let mut centres = start;
            let mut labels: Vec<usize> = vec![];
            loop {
                let now: Vec<usize> = points.iter().map(|point| Bounds::of(point, &centres).label).collect();
                if now == labels {
                    break;
                }
                labels = now;
                let bounds: Vec<Bounds> =
                    labels.iter().map(|&label| Bounds { label, upper: 0.0, lower: 0.0 }).collect();
                to_means(&points, &bounds, &mut centres);
            }
            let inertia: f64 = points.iter().zip(&labels).map(|(p, &c)| squared_distance(p, &centres[c])).sum();
            prop_assert_eq!(found, Clustering { centres, labels, inertia });
        }

        #[test]
        fn as_many_members_as_clusters(
            points in prop::collection::vec(prop::collection::vec(-2i32..3, 1), 1..20),
            share in 0.0..1.0f64,
        ) {
            // Many of them equal.
            let points: Vec<Vec<f64>> = points.iter().map(|p| vec![f64::from(p[0])]).collect();
            let count = 1 + (share * (points.len() - 1) as f64) as usize;
            let selected = kmeans(&points, count, 3).unwrap();
            prop_assert!(selected.len() == count && selected.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }

    #[test]
    fn every_well_separated_group_has_its_member() {
        let points: Vec<Vec<f64>> = (0..60).map(|i| vec![f64::from(i % 6) * 100.0 + f64::from(i / 6), 0.0]).collect();
        for seed in 0..20 {
            let mut groups: Vec<usize> = kmeans(&points, 6, seed).unwrap().into_iter().map(|i| i % 6).collect();
            groups.sort_unstable();
            assert_eq!(groups, [0, 1, 2, 3, 4, 5], "seed {seed}");
        }
    }

    #[test]
    fn what_cannot_be_clustered_is_refused() {
        let points = vec![vec![0.0, 1.0], vec![f64::NAN, 1.0], vec![1.0]];
        assert_eq!(kmeans(&points, 1, 0), Err(ClusteringError::Point { point: 1 }));
        assert_eq!(kmeans(&[vec![0.0], vec![0.0, 1.0]], 1, 0), Err(ClusteringError::Point { point: 1 }));
        assert_eq!(kmeans(&points[..1], 0, 0), Err(ClusteringError::Count { count: 0, points: 1 }));
        assert_eq!(kmeans(&points[..1], 2, 0), Err(ClusteringError::Count { count: 2, points: 1 }));
    }
}
