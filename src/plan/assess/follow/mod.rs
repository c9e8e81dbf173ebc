//! Carrying a plan out, with a person or a program at the robot.
//!
//! [`Follow`] is the tour as it goes on: [`Input`]s come in (answers, pictures), [`Announcement`]s go out (poses to go to, what the
//! pictures tell, the end). It knows neither clock, files nor terminal; how far it has come is its [`FollowState`], which a run that goes
//! on begins with.
//!
//! [`FollowState`]: crate::plan::document::FollowState

mod announcement;
mod answer;
mod doubt;
mod events;
mod further;
mod knowledge;
mod mismatch;
mod picture;
#[cfg(test)]
mod tests;
mod tour;
mod until;
mod ways;

pub use announcement::{Announcement, End, Input, Refusal, Standing, Stop};
pub use answer::{Answer, UnknownAnswer};
pub use doubt::Doubt;
pub use knowledge::Known;
pub use mismatch::Mismatch;
pub use tour::Follow;
pub use until::{UnknownAccuracy, Until};
