//! A board of which no more is known than where its points are.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Point3, Vector2};

use super::error::BoardError;
use super::feature::Feature;
use super::layout::{Layout, Marker, fix_homography};

/// Points in a plane, in any order. Those of a group count only where the whole group is seen, as those of a marker do.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Shared, for problems are copied.
    of: Arc<[Listed]>,
    markers: Arc<[Marker]>,
    size: (f64, f64),
    middle: Vector2<f64>,
}

/// A point with what is near it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Listed {
    /// From the middle of all, m.
    at: Vector2<f64>,
    group: Option<i64>,
    neighbours: [usize; 2],
}

/// Most points of a board.
const MOST: usize = 10_000;

/// Points nearer than this (m) are one.
const APART: f64 = 1e-9;

/// The second neighbour is at least so far off the line to the first: sine of the angle.
const ASIDE: f64 = 0.1;

impl Points {
    /// A board of these points, m, each with its group where it has one. Frame T has its origin in the middle of the smallest
    /// rectangle along the axes that holds them all.
    ///
    /// # Errors
    /// [`BoardError`] for what is no board.
    pub fn new(points: &[([f64; 2], Option<i64>)]) -> Result<Self, BoardError> {
        let count = points.len();
        for (point, &([x, y], _)) in points.iter().enumerate() {
            if !(x.is_finite() && y.is_finite()) {
                return Err(BoardError::NotFinite { point, x: x * 1e3, y: y * 1e3 });
            }
        }
        if count < 4 {
            return Err(BoardError::TooFewPoints { count });
        }
        if count > MOST {
            return Err(BoardError::TooManyPoints { count, most: MOST });
        }
        let at: Vec<Vector2<f64>> = points.iter().map(|&(point, _)| point.into()).collect();
        let low = at.iter().fold(at[0], |low, point| low.inf(point));
        let high = at.iter().fold(at[0], |high, point| high.sup(point));
        let (middle, size) = ((low + high) / 2.0, high - low);
        // Duplicates are next to each other by x.
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&i, &j| at[i].x.total_cmp(&at[j].x).then(at[i].y.total_cmp(&at[j].y)));
        for (place, &i) in order.iter().enumerate() {
            let near = order[place + 1..].iter().take_while(|&&j| at[j].x - at[i].x < APART);
            if let Some(&j) = near.into_iter().find(|&&j| (at[j] - at[i]).norm() < APART) {
                let [x, y] = (at[i] * 1e3).into();
                return Err(BoardError::Duplicate { first: i.min(j), second: i.max(j), x, y });
            }
        }
        let neighbours = |i: usize| -> Option<[usize; 2]> {
            let others = || (0..count).filter(|&j| j != i);
            let near =
                |a: &usize, b: &usize| (at[*a] - at[i]).norm_squared().total_cmp(&(at[*b] - at[i]).norm_squared());
            let first = others().min_by(near)?;
            let along = (at[first] - at[i]).normalize();
            let aside = others().filter(|&j| {
                let to = at[j] - at[i];
                along.perp(&to).abs() > ASIDE * to.norm()
            });
            Some([first, aside.min_by(near).or_else(|| others().filter(|&j| j != first).min_by(near))?])
        };
        let listed = |(i, &(_, group)): (usize, &([f64; 2], Option<i64>))| {
            Some(Listed { at: at[i] - middle, group, neighbours: neighbours(i)? })
        };
        let of: Option<Arc<[Listed]>> = points.iter().enumerate().map(listed).collect();
        let of = of.ok_or(BoardError::TooFewPoints { count })?;
        let markers = groups(&of);
        let board = Self { of, markers, size: (size.x, size.y), middle };
        if fix_homography(&order, |i| at[i]) { Ok(board) } else { Err(BoardError::OnALine) }
    }

    /// The points as they were given, m, with their groups.
    pub fn listed(&self) -> impl Iterator<Item = ([f64; 2], Option<i64>)> + '_ {
        self.of.iter().map(|point| ((point.at + self.middle).into(), point.group))
    }
}

/// What must be seen whole: every group of several points.
fn groups(points: &[Listed]) -> Arc<[Marker]> {
    let mut groups: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for (i, point) in points.iter().enumerate() {
        if let Some(group) = point.group {
            groups.entry(group).or_default().push(i);
        }
    }
    let marker = |corners: Vec<usize>| Marker {
        outline: corners.iter().map(|&i| Point3::new(points[i].at.x, points[i].at.y, 0.0)).collect(),
        inside: Vec::new(),
        corners,
    };
    groups.into_values().filter(|corners| corners.len() > 1).map(marker).collect()
}

impl Layout for Points {
    fn corner_count(&self) -> usize {
        self.of.len()
    }

    fn columns(&self) -> usize {
        self.of.len()
    }

    fn corner(&self, index: usize) -> Point3<f64> {
        let at = self.of[index].at;
        Point3::new(at.x, at.y, 0.0)
    }

    fn feature(&self, _: usize) -> Feature {
        Feature::Point
    }

    fn neighbours(&self, index: usize) -> [usize; 2] {
        self.of[index].neighbours
    }

    fn printed_size(&self) -> (f64, f64) {
        self.size
    }

    fn markers(&self) -> Vec<Marker> {
        self.markers.to_vec()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn board(points: &[[f64; 2]]) -> Result<Points, BoardError> {
        Points::new(&points.iter().map(|&point| (point, None)).collect::<Vec<_>>())
    }

    #[test]
    fn points_are_about_their_middle_with_neighbours_in_two_directions() {
        let board = board(&[[0.1, 0.0], [0.2, 0.0], [0.3, 0.0], [0.1, 0.3], [0.15, 0.01]]).unwrap();
        assert!((board.corner(0) - Point3::new(-0.1, -0.15, 0.0)).norm() < 1e-15);
        assert_eq!(board.printed_size(), (0.3 - 0.1, 0.3));
        assert_eq!(board.neighbours(2), [1, 3]);
        assert_eq!(board.neighbours(0)[0], 4);
        let given: Vec<_> = board.listed().map(|(point, _)| point).collect();
        assert!((Vector2::from(given[3]) - Vector2::new(0.1, 0.3)).norm() < 1e-15);
    }

    #[test]
    fn groups_are_seen_whole_or_not_at_all() {
        let square = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];
        let points: Vec<_> = square.into_iter().zip([Some(7), None, Some(7), Some(3)]).collect();
        let markers = Points::new(&points).unwrap().markers();
        assert_eq!(markers.len(), 1);
        assert_eq!(markers[0].corners, [0, 2]);
    }

    #[test]
    fn what_is_no_board_is_refused() {
        let square = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];
        assert_eq!(board(&square[..3]), Err(BoardError::TooFewPoints { count: 3 }));
        let mut twice = square.to_vec();
        twice.push([0.1, 0.1 + 1e-12]);
        assert!(matches!(board(&twice), Err(BoardError::Duplicate { first: 2, second: 4, .. })));
        assert!(matches!(board(&[[f64::NAN, 0.0]; 4]), Err(BoardError::NotFinite { point: 0, .. })));
        let line: Vec<_> = (0..5).map(|i| [0.1 * f64::from(i), 0.3 * f64::from(i)]).collect();
        assert_eq!(board(&line), Err(BoardError::OnALine));
        let mut but_one = line;
        but_one.push([1.0, 0.0]);
        assert_eq!(board(&but_one), Err(BoardError::OnALine));
    }
}
