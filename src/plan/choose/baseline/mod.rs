//! How poses are chosen without regard to what they teach: what the certified choice is compared with.

mod centres;
mod kmeans;
mod lloyd;
mod points;
mod random;

pub use kmeans::KMeans;
pub use lloyd::{Clustering, lloyd};
pub use points::{ClusteringError, Points};
pub use random::random;
