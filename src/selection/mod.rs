//! Choosing the k views that together teach most.
//!
//! This module knows nothing of robots and cameras: it sees n positive semidefinite p×p information matrices, an
//! [`InformationFunction`] Φ, and a budget k.

mod best;
mod certificate;
mod constraints;
mod curvature;
mod error;
mod exchange;
mod fewest;
mod function;
mod greedy;
mod influence;
mod instance;
mod kmeans;
mod method;
mod node;
mod packing;
mod random;
mod relaxation;
mod search;
mod soft_minimum;

pub use best::{Best, best};
pub use certificate::Certificate;
pub use constraints::{Cap, Constraints, Separation};
pub use curvature::Curvature;
pub use error::SelectionError;
pub use exchange::{exchange, improved_greedy};
pub use fewest::{Fewest, NotEnough, Refutation, fewest};
pub use function::{Gradient, InformationFunction};
pub use greedy::greedy;
pub use influence::{Spare, spares, without_each};
pub use instance::{Instance, Term};
pub use kmeans::{Clustering, ClusteringError, kmeans, lloyd};
pub use method::Method;
pub use random::random;
pub use relaxation::{Relaxation, RelaxationSettings, relax};
pub use search::{Search, SearchEnd, SearchProgress, search, start_of_search};
