//! Choosing the k views that together teach most.
//!
//! This module knows nothing of robots and cameras: it sees n positive semidefinite p×p information matrices, an
//! [`InformationFunction`] Φ, and a budget k.

mod best;
mod certificate;
mod exchange;
mod function;
mod greedy;
mod instance;
mod kmeans;
mod method;
mod random;
mod relaxation;

pub use best::{Best, best};
pub use certificate::Certificate;
pub use exchange::exchange;
pub use function::{Curvature, InformationFunction};
pub use greedy::greedy;
pub use instance::{Instance, SelectionError};
pub use kmeans::{ClusteringError, kmeans};
pub use method::Method;
pub use random::random;
pub use relaxation::{Relaxation, RelaxationSettings, relax};
