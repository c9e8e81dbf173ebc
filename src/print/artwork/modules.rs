//! The black modules of markers.

use super::{Rectangle, Shape};

/// The modules of a marker of `side` mm whose lower left corner is at `[x, y]`, by rows from the top: as few rectangles as make
/// up what is black when runs of a row are joined to equal ones of the next.
pub(super) fn modules(
    [x, y]: [f64; 2],
    side: f64,
    count: usize,
    is_light: impl Fn(usize, usize) -> bool,
) -> Vec<Shape> {
    let edge = |i: usize| side * (i as f64 / count as f64);
    let runs = |row: usize| {
        let mut runs: Vec<[usize; 2]> = Vec::new();
        for column in (0..count).filter(|&column| !is_light(row, column)) {
            match runs.last_mut() {
                Some([_, end]) if *end == column => *end += 1,
                _ => runs.push([column, column + 1]),
            }
        }
        runs
    };
    let shape = |[begin, end]: [usize; 2], [top, bottom]: [usize; 2]| {
        let (left, right) = (x + edge(begin), x + edge(end));
        let (low, high) = (y + edge(count - bottom), y + edge(count - top));
        Shape::Rectangle(Rectangle { min: [left, low], max: [right, high] })
    };
    let mut shapes = Vec::new();
    let mut open: Vec<([usize; 2], usize)> = Vec::new();
    for row in 0..=count {
        let now = if row < count { runs(row) } else { Vec::new() };
        open.retain(|&(run, top)| {
            let goes_on = now.contains(&run);
            if !goes_on {
                shapes.push(shape(run, [top, row]));
            }
            goes_on
        });
        for run in now {
            if open.iter().all(|&(other, _)| other != run) {
                open.push((run, row));
            }
        }
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_black_is_covered_once() {
        // A ring with a hole and a notch.
        let light = [[false, false, false], [false, true, false], [false, true, true]];
        let shapes = modules([10.0, 20.0], 3.0, 3, |row, column| light[row][column]);
        let covered = |row: usize, column: usize| {
            let [x, y] = [10.5 + column as f64, 22.5 - row as f64];
            let point = Rectangle { min: [x, y], max: [x, y] };
            shapes.iter().filter(|shape| shape.bounds().overlaps(&point)).count()
        };
        for (row, modules) in light.iter().enumerate() {
            for (column, is_light) in modules.iter().enumerate() {
                assert_eq!(covered(row, column), usize::from(!is_light), "{row} {column}");
            }
        }
        assert_eq!(shapes.len(), 3);
    }
}
