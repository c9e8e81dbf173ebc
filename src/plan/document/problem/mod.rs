//! What is answered about a problem before there is a plan.

mod board;
mod check;
mod init;
mod reach;
mod self_collision;
mod sights;
mod sweep;

pub use board::{BoardDescription, BoardDocument, PageDocument, PatternDocument, PrintedFile, TilesDocument};
pub use check::{CheckDocument, DiagnosisDocument, LensDocument, NoteDocument, ObstacleDocument, Suspicion};
pub use init::InitDocument;
pub use reach::{ReachDocument, ReachedConfiguration};
pub use self_collision::{ClosePair, SelfCollision, TestedPair};
pub use sights::{CameraSights, Sight};
pub use sweep::{PublishedCounts, SweepCounts, SweepDocument};
