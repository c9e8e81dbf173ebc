//! Poses from which a view has been taken already.

use nalgebra::{Point3, Vector2};

use crate::calibration::{Observations, View as Seen};
use crate::camera::Camera;
use crate::feasibility::View;
use crate::target::Board;

/// Two views are one where their corners lie as near as this on average, as a share of the image's longer side.
const SAME: f64 = 0.02;

/// Views taken, to be compared with those that could be.
pub(crate) struct Taken<'a> {
    observations: &'a Observations,
    camera: &'a Camera,
    /// The middle of each view's corners, px, and their mean position on the board, m.
    middles: Vec<(Vector2<f64>, Point3<f64>)>,
    /// In how many ways the board's corners may be counted.
    turns: usize,
}

impl<'a> Taken<'a> {
    pub(crate) fn new(observations: &'a Observations, camera: &'a Camera) -> Self {
        let middle = |view: &Seen| {
            let count = view.len() as f64;
            let pixel = view.iter().map(|corner| corner.pixel).sum::<Vector2<f64>>() / count;
            let points = view.iter().map(|corner| point(observations.board(), corner.index, 0).coords);
            (pixel, Point3::from(points.sum::<nalgebra::Vector3<f64>>() / count))
        };
        let turns = if observations.board().is_ambiguous() { 4 } else { 1 };
        Self { observations, camera, middles: observations.views().iter().map(middle).collect(), turns }
    }

    /// The view taken that shows the board where `view` would, whichever of its corners is listed first.
    pub(crate) fn like(&self, view: &View) -> Option<usize> {
        let side = f64::from(self.camera.width().max(self.camera.height()));
        (0..self.middles.len()).find(|&i| {
            (0..self.turns).any(|turn| {
                let (pixel, middle) = self.middles[i];
                // A quick look before the corners: perspective moves the middle by little.
                let image = self.camera.project(&(view.X_CT * turned(middle, turn)));
                image.is_some_and(|image| (image - pixel).norm() < 4.0 * SAME * side)
                    && self.distance(i, view, turn).is_some_and(|distance| distance < SAME * side)
            })
        })
    }

    /// Root mean square distance of the corners, px.
    fn distance(&self, taken: usize, view: &View, turn: usize) -> Option<f64> {
        let corners = &self.observations.views()[taken];
        let mut sum = 0.0;
        for corner in corners {
            let image = self.camera.project(&(view.X_CT * point(self.observations.board(), corner.index, turn)))?;
            sum += (image - corner.pixel).norm_squared();
        }
        Some((sum / corners.len() as f64).sqrt())
    }
}

/// A corner of the board if its columns (bit 0 of `turn`) and its rows (bit 1) are counted from the other end.
fn point(board: &Board, index: usize, turn: usize) -> Point3<f64> {
    turned(board.corner(index), turn)
}

fn turned(mut point: Point3<f64>, turn: usize) -> Point3<f64> {
    if turn & 1 != 0 {
        point.x = -point.x;
    }
    if turn & 2 != 0 {
        point.y = -point.y;
    }
    point
}
