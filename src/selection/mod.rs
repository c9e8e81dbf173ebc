//! Choosing the k views that together teach most.
//!
//! This module knows nothing of robots and cameras: it sees n positive semidefinite p×p information matrices, an
//! [`InformationFunction`] Φ, and a budget k.

mod best;
mod best_first;
mod certificate;
mod error;
mod exchange;
mod function;
mod greedy;
mod group;
mod highest;
mod influence;
mod instance;
mod matrices;
mod relaxation;
mod search;

pub use best::{Best, best};
pub(crate) use best::{best_from_known, nonsingular_start, relax_from_greedy};
pub(crate) use best_first::BestFirst;
pub use certificate::Certificate;
pub use error::SelectionError;
pub(crate) use exchange::improved_sample;
pub use exchange::{exchange, improved_greedy};
pub use function::{Gradient, InformationFunction};
pub use greedy::greedy;
pub use group::Group;
pub(crate) use highest::highest;
pub use influence::{Spare, spares, without_each};
pub use instance::{Cap, Constraints, Instance, Separation, Term};
pub(crate) use instance::{Part, Rules};
use matrices::lanes;
pub(crate) use matrices::packed;
pub use matrices::{InformationError, InformationSet};
pub(crate) use relaxation::relax_until;
pub use relaxation::{Relaxation, RelaxationSettings, relax};
pub use search::{Fewest, NotEnough, Refutation, Search, SearchEnd, SearchProgress, fewest, search, start_of_search};
