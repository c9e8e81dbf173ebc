//! The k-means baseline: one member of each of k clusters.

use linfa::DatasetBase;
use linfa::traits::Fit;
use linfa_clustering::KMeans;
use ndarray::Array2;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256Plus;
use thiserror::Error;

/// Why the clustering failed.
#[derive(Debug, Error)]
#[error("k-means failed: {0}")]
pub struct ClusteringError(String);

/// Clusters the rows of `features` into `count` clusters (k-means++ start, Lloyd's iterations) and returns the member
/// nearest to each centre, distinct and in ascending order.
///
/// # Errors
/// When the clustering does, as for features that are not finite.
pub fn kmeans(features: &[Vec<f64>], count: usize, seed: u64) -> Result<Vec<usize>, ClusteringError> {
    let width = features.first().map_or(0, Vec::len);
    let table = Array2::from_shape_fn((features.len(), width), |(i, j)| features[i][j]);
    let model = KMeans::params_with_rng(count, Xoshiro256Plus::seed_from_u64(seed))
        .n_runs(1)
        .max_n_iterations(300)
        .tolerance(1e-4)
        .fit(&DatasetBase::from(table))
        .map_err(|error| ClusteringError(error.to_string()))?;
    let mut taken = vec![false; features.len()];
    let mut selected: Vec<usize> = model
        .centroids()
        .rows()
        .into_iter()
        .filter_map(|centre| {
            let distance = |i: usize| -> f64 { features[i].iter().zip(&centre).map(|(a, b)| (a - b) * (a - b)).sum() };
            let nearest =
                (0..features.len()).filter(|&i| !taken[i]).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
            taken[nearest] = true;
            Some(nearest)
        })
        .collect();
    selected.sort_unstable();
    Ok(selected)
}
