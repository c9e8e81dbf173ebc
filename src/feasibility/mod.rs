//! Which candidates are worth a picture: those from which the camera really sees the board.

mod visibility;

pub use visibility::{Rejection, View, VisibilityLimits, view_from, visible_views};
