//! What the points of boards are: how their places in pictures are found.

use nalgebra::Vector2;

/// What a point of a board is: how its place in a picture is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Feature {
    /// Edges that meet.
    Corner {
        /// The two edges on the board, as far as they reach from the corner, in m.
        edges: [Vector2<f64>; 2],
        /// Whether the edges go on across the corner, as those of a chessboard do.
        is_crossing: bool,
    },
    /// The centre of a circle.
    Circle {
        /// Its radius in m.
        radius: f64,
    },
    /// A point of which no more is known.
    Point,
}
