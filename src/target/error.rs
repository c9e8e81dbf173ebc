//! Why there is no such board.

use thiserror::Error;

use crate::figures::trimmed;

/// Why there is no such board. Lengths are in mm.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BoardError {
    /// There are too few of what it is made of along a side.
    #[error("{count} {what} along a side are too few; there must be at least {least}")]
    TooFew {
        /// What.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there must be.
        least: usize,
    },
    /// A length is not positive and finite.
    #[error("the {what} is {value} mm; it must be positive and finite")]
    Length {
        /// What.
        what: &'static str,
        /// The length.
        value: f64,
    },
    /// What is printed does not fit into its place.
    #[error("{what} of {} mm do not fit: there is room for less than {} mm", trimmed(*size, 4), trimmed(*room, 4))]
    TooLarge {
        /// What.
        what: &'static str,
        /// Its size.
        size: f64,
        /// The room.
        room: f64,
    },
    /// The dictionary has too few markers.
    #[error("the board needs {needed} markers, and {dictionary} has {has}")]
    TooFewMarkers {
        /// Markers that the board needs.
        needed: usize,
        /// Name of the dictionary.
        dictionary: &'static str,
        /// Its markers.
        has: usize,
    },
    /// A coordinate is no number.
    #[error("point {point} is ({x}, {y}); both must be finite")]
    NotFinite {
        /// The point, from 0.
        point: usize,
        /// Its coordinates.
        x: f64,
        /// Its coordinates.
        y: f64,
    },
    /// Two points are one.
    #[error("points {first} and {second} are one: ({x}, {y}) mm")]
    Duplicate {
        /// The first, from 0.
        first: usize,
        /// The second.
        second: usize,
        /// Where they are.
        x: f64,
        /// Where they are.
        y: f64,
    },
    /// There are fewer points than fix a view.
    #[error("{count} points are too few; a view needs at least 4")]
    TooFewPoints {
        /// How many there are.
        count: usize,
    },
    /// There are more points than a board may have.
    #[error("{count} points are too many; a board has at most {most}")]
    TooManyPoints {
        /// How many there are.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// All points, or all but one, lie on a line.
    #[error("the points, or all but one of them, lie on a line, which does not fix the board's pose in a picture")]
    OnALine,
}

/// A length in m that must be positive and finite.
pub(super) fn length(what: &'static str, value: f64) -> Result<(), BoardError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(BoardError::Length { what, value: value * 1e3 }) }
}

/// A number of things along a side.
pub(super) fn at_least(least: usize, what: &'static str, counts: [usize; 2]) -> Result<(), BoardError> {
    let count = counts[0].min(counts[1]);
    if count >= least { Ok(()) } else { Err(BoardError::TooFew { what, count, least }) }
}
