//! What is printed: black shapes on white, in mm, x to the right and y up.

mod aprilgrid;
mod charuco;
mod checkerboard;
mod circles;
mod modules;
mod text;

pub use text::{Anchor, Text};

use std::f64::consts::TAU;

use super::error::PrintError;
use crate::target::Board;

/// A target's pattern in frame T, its centre the origin: what the pages are laid out from, whatever the target's kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Artwork {
    /// The black shapes.
    pub shapes: Vec<Shape>,
    /// Extent along x and y in mm.
    pub size: [f64; 2],
    /// White that must be left around it, in mm: half of a square at least, by which detectors tell it from what is behind.
    pub quiet: f64,
    /// White around it, in mm, beyond which more brings nothing.
    pub ample: f64,
    /// Where it is cut best when it has to be, along x and along y, ascending: far from all corners.
    pub cuts: [Vec<f64>; 2],
    /// What it is, in words.
    pub title: String,
}

impl Artwork {
    /// What is printed of a board, its corners where [`Board::corner`] has them.
    ///
    /// # Errors
    /// When the board is none, as a checkerboard of fewer than two or more than a thousand inner corners along a side or with
    /// squares of no positive size, or known by its points alone.
    pub fn new(board: &Board) -> Result<Self, PrintError> {
        match board {
            Board::Checkerboard(board) => Self::checkerboard(board),
            Board::Charuco(board) => Ok(Self::charuco(board)),
            Board::AprilGrid(board) => Ok(Self::aprilgrid(board)),
            Board::Circles(board) => Ok(Self::circles(board)),
            Board::Points(_) => Err(PrintError::NoPattern),
        }
    }

    /// The outlines of all that is black, with circles as polygons, in m in frame T.
    pub fn outlines(&self) -> Vec<Vec<[f64; 2]>> {
        self.shapes.iter().map(|shape| shape.outline().iter().map(|point| point.map(|x| x / 1e3)).collect()).collect()
    }
}

/// Something black.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A filled rectangle.
    Rectangle(Rectangle),
    /// A filled circle.
    Circle {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
    },
    /// A filled polygon, by its corners.
    Polygon(Vec<[f64; 2]>),
    /// A line of text.
    Text(Text),
}

/// A rectangle along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Corner with the least x and y.
    pub min: [f64; 2],
    /// Corner with the greatest x and y.
    pub max: [f64; 2],
}

impl Rectangle {
    /// The rectangle between two corners that lie across from each other.
    pub fn between(a: [f64; 2], b: [f64; 2]) -> Self {
        let ([ax, ay], [bx, by]) = (a, b);
        Self { min: [ax.min(bx), ay.min(by)], max: [ax.max(bx), ay.max(by)] }
    }

    /// Width and height.
    pub fn size(&self) -> [f64; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    /// Whether the two have more than a border in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.min[axis] < other.max[axis] && other.min[axis] < self.max[axis])
    }
}

impl Shape {
    /// The shape in other coordinates: `map` is a move, with or without quarter turns and an exchange of the axes.
    pub(super) fn mapped(&self, map: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        match self {
            Self::Rectangle(Rectangle { min, max }) => Self::Rectangle(Rectangle::between(map(*min), map(*max))),
            Self::Circle { centre, radius } => Self::Circle { centre: map(*centre), radius: *radius },
            Self::Polygon(corners) => Self::Polygon(corners.iter().map(|&corner| map(corner)).collect()),
            Self::Text(text) => Self::Text(Text { at: map(text.at), ..text.clone() }),
        }
    }

    /// The shape, moved.
    pub(super) fn moved(&self, by: [f64; 2]) -> Self {
        self.mapped(|[x, y]| [x + by[0], y + by[1]])
    }

    /// The corners of the polygon that it is, or that is close to it: of a circle, one of the same area.
    fn outline(&self) -> Vec<[f64; 2]> {
        /// Sides of the polygon for a circle, whose corners are 0.6 % of the radius outside of it.
        const SIDES: u32 = 24;
        match self {
            Self::Rectangle(Rectangle { min: [x0, y0], max: [x1, y1] }) => {
                vec![[*x0, *y0], [*x1, *y0], [*x1, *y1], [*x0, *y1]]
            }
            Self::Circle { centre: [x, y], radius } => {
                let side = TAU / f64::from(SIDES);
                let reach = radius * (side / side.sin()).sqrt();
                let angles = (0..SIDES).map(|i| (f64::from(i) + 0.5) * side);
                angles.map(|angle| [x + reach * angle.cos(), y + reach * angle.sin()]).collect()
            }
            Self::Polygon(corners) => corners.clone(),
            Self::Text(_) => Vec::new(),
        }
    }

    /// The rectangle around it.
    pub fn bounds(&self) -> Rectangle {
        match self {
            Self::Rectangle(rectangle) => *rectangle,
            Self::Circle { centre: [x, y], radius } => {
                Rectangle { min: [x - radius, y - radius], max: [x + radius, y + radius] }
            }
            Self::Polygon(corners) => {
                let fold = |start, pick: fn(f64, f64) -> f64| {
                    corners.iter().fold([start; 2], |[x, y], corner| [pick(x, corner[0]), pick(y, corner[1])])
                };
                Rectangle { min: fold(f64::INFINITY, f64::min), max: fold(f64::NEG_INFINITY, f64::max) }
            }
            Self::Text(text) => text.bounds(),
        }
    }
}
