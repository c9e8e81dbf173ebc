//! Which candidates are worth a picture: those that the robot can take and from which the camera really sees the board.
//!
//! [`Checks`] holds a candidate against everything in turn, the cheapest first: visibility in the image, [`Stability`],
//! [`Collision`], [`Occlusion`].

mod collision;
mod hull;
mod occlusion;
mod rejection;
mod shortfall;
mod solid;
mod stability;
mod travel;
mod views;
mod visibility;

pub use collision::{Close, Collision, LinkPair, LinkPairs};
pub use hull::{Simplified, simplify_hulls};
pub(crate) use occlusion::FLUSH;
pub use occlusion::Occlusion;
pub use rejection::Rejection;
pub use shortfall::{Measures, Sighting, VisibilityTest};
pub(crate) use stability::convex_hull;
pub use stability::{Stability, StabilityError};
pub use views::{Checks, View, feasible_views};
pub(crate) use views::{half_focal, outer_corners, picture};
pub use visibility::{MARKER_MARGIN, VisibilityLimits, told_in_image};
