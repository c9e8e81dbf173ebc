//! What is printed on a board, looked up point by point.

use super::artwork::{Artwork, Shape};

/// Cells along the longer side of a pattern.
const CELLS: f64 = 96.0;

/// A target's printed pattern in frame T, and the white around it.
#[derive(Debug, Clone)]
pub struct Pattern {
    shapes: Vec<Shape>,
    /// Half the extent along x and y of the pattern with its white, mm.
    half: [f64; 2],
    /// Side of a cell, mm.
    cell: f64,
    columns: usize,
    /// For each cell, row by row, the shapes that reach into it.
    cells: Vec<Vec<usize>>,
}

impl Pattern {
    /// The pattern of `artwork`, with the white that it needs around it.
    pub fn new(artwork: &Artwork) -> Self {
        let half = artwork.size.map(|size| 0.5 * size + artwork.quiet);
        let cell = 2.0 * half[0].max(half[1]) / CELLS;
        let [columns, rows] = half.map(|half| ((2.0 * half / cell).ceil() as usize).max(1));
        let mut cells = vec![Vec::new(); columns * rows];
        for (index, shape) in artwork.shapes.iter().enumerate() {
            let bounds = shape.bounds();
            let range = |axis: usize, count: usize| {
                let place = |x: f64| ((x + half[axis]) / cell).floor().clamp(0.0, (count - 1) as f64) as usize;
                place(bounds.min[axis])..=place(bounds.max[axis])
            };
            for row in range(1, rows) {
                for column in range(0, columns) {
                    cells[row * columns + column].push(index);
                }
            }
        }
        Self { shapes: artwork.shapes.clone(), half, cell, columns, cells }
    }

    /// Half the extent along x and y of the pattern with its white, m.
    pub fn half_extents(&self) -> [f64; 2] {
        self.half.map(|half| half / 1e3)
    }

    /// Whether the paper is black at a point of T, in m; `None` beside it.
    pub fn is_black(&self, x: f64, y: f64) -> Option<bool> {
        let at = [x * 1e3, y * 1e3];
        if !(at[0].abs() < self.half[0] && at[1].abs() < self.half[1]) {
            return None;
        }
        let [column, row] = [0, 1].map(|axis| ((at[axis] + self.half[axis]) / self.cell) as usize);
        let near = self.cells.get(row * self.columns + column)?;
        Some(near.iter().any(|&shape| covers(&self.shapes[shape], at)))
    }
}

/// Whether a shape covers a point, mm; a text covers nothing.
fn covers(shape: &Shape, [x, y]: [f64; 2]) -> bool {
    match shape {
        Shape::Rectangle(rectangle) => {
            (rectangle.min[0]..rectangle.max[0]).contains(&x) && (rectangle.min[1]..rectangle.max[1]).contains(&y)
        }
        Shape::Circle { centre, radius } => (x - centre[0]).hypot(y - centre[1]) < *radius,
        Shape::Polygon(corners) => {
            // A ray to the right crosses the outline of what it starts in an odd number of times.
            let mut inside = false;
            for (i, [ax, ay]) in corners.iter().enumerate() {
                let [bx, by] = corners[(i + 1) % corners.len()];
                if (*ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
                    inside = !inside;
                }
            }
            inside
        }
        Shape::Text(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::Board;

    #[test]
    fn squares_are_black_and_white_in_turn() {
        let pattern = Pattern::new(&Artwork::new(&Board::checkerboard(3, 2, 0.02)).unwrap());
        // 4 x 3 squares; the centre of T is the corner in the middle of the second row's edge.
        let at = |i: i32, j: i32| pattern.is_black(f64::from(2 * i - 3) * 0.01, f64::from(j - 1) * 0.02);
        for (i, j) in (0..4).flat_map(|i| (0..3).map(move |j| (i, j))) {
            assert_eq!(at(i, j).map(|black| black ^ ((i + j) % 2 == 0)), at(0, 0).map(|black| !black), "{i} {j}");
        }
        assert_eq!(pattern.is_black(0.0, 0.035), Some(false));
        assert_eq!(pattern.is_black(0.0, 0.06), None);
    }

    #[test]
    fn a_polygon_covers_what_is_inside() {
        let arrow = Shape::Polygon(vec![[0.0, 0.0], [4.0, 2.0], [0.0, 4.0], [1.0, 2.0]]);
        for (point, inside) in [([2.0, 2.0], true), ([0.5, 2.0], false), ([0.5, 0.5], true), ([3.0, 3.0], false)] {
            assert_eq!(covers(&arrow, point), inside, "{point:?}");
        }
    }
}
