//! Groups of candidates of which a selection holds only so many.

use std::fmt;

/// Candidates of which a selection holds only so many.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// A cap given, by its number.
    Cap(usize),
    /// All candidates nearer than half a separation's least distance to the point midway between two of them: any two in such a ball are
    /// too close to each other, so that a selection holds one at most.
    Ball {
        /// The separation, by its number.
        separation: usize,
        /// The two candidates; the same one twice where the ball is about that.
        between: [usize; 2],
    },
}

impl Group {
    /// Of a ball, as a share of the least distance: a little smaller than half, so that rounding never joins two points that do not
    /// conflict.
    pub(crate) const RADIUS: f64 = 0.5 * (1.0 - 1e-9);
}

impl fmt::Display for Group {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Cap(c) => write!(f, "cap {c}"),
            Self::Ball { separation, between: [a, b] } => {
                write!(f, "the ball of separation {separation} between candidates {a} and {b}")
            }
        }
    }
}
