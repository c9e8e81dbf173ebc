//! What comes in while a plan is carried out, and what goes out.

use thiserror::Error;

use crate::calibration::CalibrationError;
use crate::plan::document::{AddedPose, MoveDocument, PlannedPose, TakenPicture, WhyEnded};

use super::answer::Answer;
use super::doubt::Doubt;

/// What comes in.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// An answer.
    Answer(Answer),
    /// Pictures that came since the pose was announced.
    Pictures(Vec<TakenPicture>),
    /// Poses to go on with, after [`Announcement::More`]; none to end.
    Further(Vec<AddedPose>),
    /// That no more answers can come.
    Closed,
}

/// What goes out.
#[derive(Debug, Clone, PartialEq)]
pub enum Announcement {
    /// A pose to go to.
    Go(Box<Stop>),
    /// A picture counts.
    Taken(TakenPicture),
    /// A picture is in doubt, for these reasons; at least one.
    InDoubt(TakenPicture, Vec<Doubt>),
    /// What the pictures so far tell: in [`Follow::known`](super::Follow::known).
    Known,
    /// Why they do not give a camera yet.
    Unknown(CalibrationError),
    /// The last answer changes nothing.
    Refused(Refusal),
    /// All poses are done and the accuracy is not reached: so many more poses may be proposed, by [`Follow::further`](super::Follow::further).
    More(usize),
    /// So many poses were added.
    Added(usize),
    /// The tour ends.
    End(End),
}

/// A pose to go to.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Its place in the tour, from 0.
    pub place: usize,
    /// The pose.
    pub pose: PlannedPose,
    /// Where the arm is to stand before.
    pub from: Standing,
    /// The way from there; none where it is not known, or there is none.
    pub way: Option<MoveDocument>,
}

/// Where an arm stands before it moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Anywhere: the way is not planned.
    Anywhere,
    /// At home.
    Home,
    /// At the pose of that place.
    Pose(usize),
    /// Where it is to be.
    Here,
}

/// Why an answer changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Refusal {
    /// There is no pose before the first.
    #[error("this is the first pose: there is none before it")]
    First,
    /// Without a picture a watched pose is not taken.
    #[error("no picture of this pose has come yet: wait for it, or leave the pose out with `skip`")]
    NoPicture,
    /// The picture that came cannot count.
    #[error("the picture cannot count: take another, or leave the pose out with `skip`")]
    Unusable,
}

/// The end of a tour.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// Why it ends.
    pub why: WhyEnded,
    /// Whether nothing is left to do.
    pub good: bool,
    /// The way home, where the tour returns and the arm is at a pose.
    pub way: Option<MoveDocument>,
}
