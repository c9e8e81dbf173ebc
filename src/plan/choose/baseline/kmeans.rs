//! The k-means baseline: one member of each of k clusters.

use std::borrow::Cow;

use pulp::{Arch, Simd, WithSimd};
use rand::SeedableRng;
use rand::distributions::{Distribution, WeightedIndex};
use rand_xoshiro::Xoshiro256Plus;

use super::centres::Centres;
use super::lloyd::rounds;
use super::points::{ClusteringError, Points, squared_distance};

/// Points from which on an even sample of them is clustered first, and how many stand for one in it.
const MANY: usize = 1 << 17;
const SAMPLED_OF: usize = 16;

/// Clusters points from random starts (k-means++, then Lloyd's method), all from one seed: what was drawn for few clusters starts
/// those of more. Where points are many, an even sample of them is clustered so, and its centres start Lloyd's method on all (Bradley &
/// Fayyad, *Refining initial points for k-means clustering*, 1998).
#[derive(Debug, Clone)]
pub struct KMeans<'a> {
    points: &'a Points,
    /// What is drawn from and clustered first: the sample, or where points are few all of them.
    drawn_from: Cow<'a, Points>,
    rng: Xoshiro256Plus,
    /// Points drawn so far, and of each point the squared distance from the nearest of them.
    drawn: Vec<usize>,
    weights: Vec<f64>,
}

impl<'a> KMeans<'a> {
    /// Clusterings of `points` from `seed`.
    pub fn new(points: &'a Points, seed: u64) -> Self {
        let drawn_from = if points.len() < MANY { Cow::Borrowed(points) } else { Cow::Owned(points.every(SAMPLED_OF)) };
        let weights = vec![1.0; drawn_from.len()];
        Self { points, drawn_from, rng: Xoshiro256Plus::seed_from_u64(seed), drawn: vec![], weights }
    }

    /// Of `count` clusters the member nearest to each centre, distinct and in ascending order.
    ///
    /// # Errors
    /// When `count` is 0 or above the number of points.
    pub fn members(&mut self, count: usize) -> Result<Vec<usize>, ClusteringError> {
        let points = self.points;
        if count == 0 || count > points.len() {
            return Err(ClusteringError::Count { count, points: points.len() });
        }
        self.draw(count);
        let start = self.drawn[..count].iter().map(|&i| self.drawn_from.point(i));
        let mut centres = Centres::new(points.width(), start);
        if let Cow::Owned(sample) = &self.drawn_from {
            (centres, _) = rounds(sample, centres);
        }
        let (centres, _) = rounds(points, centres);
        let nearest = Arch::new().dispatch(NearestPoints { points, centres: &centres });
        let mut taken = vec![false; points.len()];
        for (c, mut member) in nearest.into_iter().enumerate() {
            if taken[member] {
                let centre = centres.get(c);
                let free = (0..points.len()).filter(|&i| !taken[i]);
                let nearest = free.map(|i| (squared_distance(points.point(i), &centre), i));
                member = nearest.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(member, |(_, i)| i);
            }
            taken[member] = true;
        }
        Ok((0..points.len()).filter(|&i| taken[i]).collect())
    }

    /// Draws as many points to start from (Arthur & Vassilvitskii, *k-means++: the advantages of careful seeding*, 2007): each drawn with a
    /// chance in proportion to its squared distance from the nearest of those before; the first ones again once no point is apart.
    fn draw(&mut self, count: usize) {
        while self.drawn.len() < count {
            let i = WeightedIndex::new(&self.weights).map_or(0, |chances| chances.sample(&mut self.rng));
            let is_first = self.drawn.is_empty();
            self.drawn.push(i);
            for (weight, point) in self.weights.iter_mut().zip(self.drawn_from.iter()) {
                let distance = squared_distance(point, self.drawn_from.point(i));
                *weight = if is_first { distance } else { distance.min(*weight) };
            }
        }
    }
}

/// [`Centres::nearest_points`], compiled for every set of instructions that [`Arch`] tells apart.
struct NearestPoints<'a> {
    points: &'a Points,
    centres: &'a Centres,
}

impl WithSimd for NearestPoints<'_> {
    type Output = Vec<usize>;

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "only so is it compiled for each set of instructions")]
    fn with_simd<S: Simd>(self, _: S) -> Vec<usize> {
        self.centres.nearest_points(self.points)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::lloyd::lloyd;
    use super::*;

    fn members(points: &[Vec<f64>], count: usize, seed: u64) -> Result<Vec<usize>, ClusteringError> {
        KMeans::new(&Points::new(points)?, seed).members(count)
    }

    proptest! {
        #[test]
        fn as_many_members_as_clusters(
            points in prop::collection::vec(prop::collection::vec(-2i32..3, 1), 1..20),
            share in 0.0..1.0f64,
        ) {
            // Many of them equal.
            let points: Vec<Vec<f64>> = points.iter().map(|p| vec![f64::from(p[0])]).collect();
            let count = 1 + (share * (points.len() - 1) as f64) as usize;
            let selected = members(&points, count, 3).unwrap();
            prop_assert!(selected.len() == count && selected.windows(2).all(|pair| pair[0] < pair[1]));
        }

        /// Each centre takes the nearest point that is free, the first of those equally near.
        #[test]
        fn members_are_nearest_to_their_centres(
            points in prop::collection::vec(prop::collection::vec(-9i32..9, 2), 20..60),
            count in 1usize..20,
        ) {
            let points: Vec<Vec<f64>> = points.iter().map(|p| vec![f64::from(p[0]), f64::from(p[1])]).collect();
            let clustered = Points::new(&points).unwrap();
            let mut drawing = KMeans::new(&clustered, 5);
            drawing.draw(count);
            let start: Vec<Vec<f64>> = drawing.drawn.iter().map(|&i| points[i].clone()).collect();
            let mut expected: Vec<usize> = vec![];
            for centre in lloyd(&clustered, &start).centres {
                let free = (0..points.len()).filter(|i| !expected.contains(i));
                let nearest = free.map(|i| (squared_distance(&points[i], &centre), i));
                expected.push(nearest.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1);
            }
            expected.sort_unstable();
            prop_assert_eq!(members(&points, count, 5).unwrap(), expected);
        }
    }

    #[test]
    fn every_well_separated_group_has_its_member() {
        let points: Vec<Vec<f64>> = (0..60).map(|i| vec![f64::from(i % 6) * 100.0 + f64::from(i / 6), 0.0]).collect();
        for seed in 0..20 {
            let mut groups: Vec<usize> = members(&points, 6, seed).unwrap().into_iter().map(|i| i % 6).collect();
            groups.sort_unstable();
            assert_eq!(groups, [0, 1, 2, 3, 4, 5], "seed {seed}");
        }
    }

    /// Of so many that a sample is clustered first.
    #[test]
    fn many_points_are_clustered_like_few() {
        let points: Vec<[f64; 2]> =
            (0..MANY as u32 + 1000).map(|i| [f64::from(i % 7) * 100.0 + f64::from(i % 1013) / 500.0, 0.0]).collect();
        let points = Points::new(&points).unwrap();
        let mut clusterings = KMeans::new(&points, 3);
        assert_eq!(clusterings.drawn_from.len(), points.len().div_ceil(SAMPLED_OF));
        for count in [7, 12, 7] {
            let found = clusterings.members(count).unwrap();
            assert_eq!(found, KMeans::new(&points, 3).members(count).unwrap());
            let mut groups: Vec<usize> = found.iter().map(|i| i % 7).collect();
            groups.sort_unstable();
            groups.dedup();
            assert_eq!((found.len(), groups.len()), (count, 7));
        }
        // Each nearest to the mean of its own, of all and not of the sample alone.
        for i in clusterings.members(7).unwrap() {
            let group: Vec<f64> = (i % 7..points.len()).step_by(7).map(|j| points.point(j)[0]).collect();
            let mean = group.iter().sum::<f64>() / group.len() as f64;
            let nearest = group.iter().map(|x| (x - mean).abs()).fold(f64::INFINITY, f64::min);
            assert!((points.point(i)[0] - mean).abs() <= nearest + 1e-9);
        }
    }

    #[test]
    fn clusterings_do_not_depend_on_those_before() {
        let points: Vec<Vec<f64>> =
            (0..200).map(|i| vec![(f64::from(i) * 0.7).sin(), (f64::from(i) * 1.3).cos()]).collect();
        let points = Points::new(&points).unwrap();
        let mut clusterings = KMeans::new(&points, 1);
        for count in [3, 40, 10] {
            assert_eq!(clusterings.members(count), KMeans::new(&points, 1).members(count));
        }
    }

    #[test]
    fn what_cannot_be_clustered_is_refused() {
        let points = vec![vec![0.0, 1.0], vec![f64::NAN, 1.0], vec![1.0]];
        assert_eq!(members(&points, 1, 0), Err(ClusteringError::Point { point: 1 }));
        assert_eq!(members(&[vec![0.0], vec![0.0, 1.0]], 1, 0), Err(ClusteringError::Point { point: 1 }));
        assert_eq!(members(&[vec![]], 1, 0), Err(ClusteringError::Point { point: 0 }));
        assert_eq!(members(&points[..1], 0, 0), Err(ClusteringError::Count { count: 0, points: 1 }));
        assert_eq!(members(&points[..1], 2, 0), Err(ClusteringError::Count { count: 2, points: 1 }));
    }
}
