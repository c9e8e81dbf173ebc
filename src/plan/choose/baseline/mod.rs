//! How poses are chosen without regard to what they teach: what the certified choice is compared with.

mod kmeans;
mod random;

pub use kmeans::{Clustering, ClusteringError, kmeans, lloyd};
pub use random::random;
