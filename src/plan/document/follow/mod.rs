//! Carrying a plan out: how far it has come, and what is told on the way.

mod event;
mod state;

pub use event::{AnnouncedPose, CountedPicture, EventKind, FollowEnd, FollowEvent, KnownSoFar, WhyEnded};
pub use state::{AddedPose, FollowReadError, FollowState, Outcome, SeenCorner, TakenPicture, Visit};
