//! What the views do not show of a camera: regions of the image without corners, tilts that were not taken.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::observations::Observations;
use crate::camera::Camera;
use crate::spatial::Pose;

/// Share of the image's sides that is its border.
const BORDER: f64 = 0.2;

/// A ninth of the image: along each side its border or what lies between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// 0 left, 1 middle, 2 right.
    pub column: usize,
    /// 0 top, 1 middle, 2 bottom.
    pub row: usize,
}

impl Region {
    /// Every region, row by row.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..9).map(|i| Self { column: i % 3, row: i / 3 })
    }

    /// Where it is: `top left`, `right`, `centre`.
    pub fn name(self) -> &'static str {
        const NAMES: [[&str; 3]; 3] =
            [["top left", "top", "top right"], ["left", "centre", "right"], ["bottom left", "bottom", "bottom right"]];
        NAMES[self.row.min(2)][self.column.min(2)]
    }

    fn of(pixel: &Vector2<f64>, camera: &Camera) -> Self {
        let third = |x: f64, size: u32| {
            let share = (x + 0.5) / f64::from(size);
            usize::from(share >= BORDER) + usize::from(share > 1.0 - BORDER)
        };
        Self { column: third(pixel.x, camera.width()), row: third(pixel.y, camera.height()) }
    }

    fn middle(self, camera: &Camera) -> Vector2<f64> {
        let at =
            |third: usize, size: u32| [0.5 * BORDER, 0.5, 1.0 - 0.5 * BORDER][third.min(2)] * f64::from(size) - 0.5;
        Vector2::new(at(self.column, camera.width()), at(self.row, camera.height()))
    }
}

/// What the views cover.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// Regions of the image that the lens reaches and no corner lies in.
    pub empty: Vec<Region>,
    /// Greatest angle between a board's normal and the line of sight to its middle, rad.
    pub largest_tilt: f64,
    /// Standard deviation of the boards' tilts about the axis about which they differ least, rad.
    pub least_spread: f64,
}

impl Coverage {
    /// What the views of `observations` cover, taken by `camera` from `poses`, `X_CT` each.
    pub fn new(observations: &Observations, camera: &Camera, poses: &[Pose]) -> Self {
        let mut is_seen = [[false; 3]; 3];
        for corner in observations.views().iter().flatten() {
            let Region { column, row } = Region::of(&corner.pixel, camera);
            is_seen[row][column] = true;
        }
        let is_empty =
            |region: &Region| !is_seen[region.row][region.column] && camera.unproject(&region.middle(camera)).is_some();
        let tilt = |X_CT: &Pose| {
            let normal = X_CT.rotation * Vector3::z();
            let sight = X_CT.translation.vector;
            normal.cross(&sight).norm().atan2(normal.dot(&sight).abs())
        };
        Self {
            empty: Region::all().filter(is_empty).collect(),
            largest_tilt: poses.iter().map(tilt).fold(0.0, f64::max),
            least_spread: least_spread(poses),
        }
    }
}

fn least_spread(poses: &[Pose]) -> f64 {
    let tilts = || {
        poses.iter().map(|X_CT| {
            let normal = X_CT.rotation * Vector3::z();
            // Towards the camera, whichever way the corners run.
            let normal = if normal.z > 0.0 { -normal } else { normal };
            Vector2::new(normal.x, normal.y)
        })
    };
    let count = poses.len() as f64;
    let mean = tilts().sum::<Vector2<f64>>() / count;
    let scatter = tilts().map(|tilt| (tilt - mean) * (tilt - mean).transpose()).sum::<Matrix2<f64>>() / count;
    scatter.symmetric_eigenvalues().min().max(0.0).sqrt().asin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{Corner, View};
    use crate::camera::Lens;
    use crate::target::Board;

    fn pose(tilt: (f64, f64)) -> Pose {
        Pose::new(Vector3::new(0.0, 0.0, 1.0), Vector3::new(tilt.0, tilt.1, 0.0))
    }

    #[test]
    fn regions_without_corners_and_missing_tilts_are_found() {
        let camera = Camera::new(Lens::Pinhole, 1000, 500, &[800.0, 800.0, 499.5, 249.5]).unwrap();
        let board = Board::checkerboard(3, 2, 0.1);
        let at = |left: f64, top: f64| -> View {
            let pixel = |i: usize| Vector2::new(left + 150.0 * (i % 3) as f64, top + 100.0 * (i / 3) as f64);
            (0..6).map(|i| Corner { index: i, pixel: pixel(i), weight: 1.0 }).collect()
        };
        // From the left border to the middle, in the upper half but for the top right.
        let views = vec![at(10.0, 10.0), at(400.0, 150.0)];
        let observations = Observations::new(board, 1000, 500, views).unwrap();
        let coverage = Coverage::new(&observations, &camera, &[pose((0.3, 0.0)), pose((-0.3, 0.0))]);
        let names: Vec<_> = coverage.empty.iter().map(|region| region.name()).collect();
        assert_eq!(names, ["top right", "right", "bottom left", "bottom", "bottom right"]);
        assert!((coverage.largest_tilt - 0.3).abs() < 1e-12);
        assert!(coverage.least_spread < 1e-9);
        let both = [pose((0.3, 0.0)), pose((-0.3, 0.0)), pose((0.0, 0.3)), pose((0.0, -0.3))];
        let spread = Coverage::new(&observations, &camera, &both).least_spread;
        assert!((spread.sin() - 0.3f64.sin() / 2f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_the_lens_does_not_reach_is_not_missed() {
        let θ = [250.0, 250.0, 499.5, 499.5, -0.3, 0.0, 0.0, 0.0];
        let camera = Camera::new(Lens::KannalaBrandt, 1000, 1000, &θ).unwrap();
        let board = Board::checkerboard(2, 2, 0.1);
        let view = (0..4).map(|i| Corner {
            index: i,
            pixel: Vector2::new(450.0 + 90.0 * (i % 2) as f64, 450.0 + 90.0 * (i / 2) as f64),
            weight: 1.0,
        });
        let observations = Observations::new(board, 1000, 1000, vec![view.collect()]).unwrap();
        let empty = Coverage::new(&observations, &camera, &[pose((0.1, 0.1))]).empty;
        assert!(empty.iter().all(|region| region.column != 0 || region.row != 0), "{empty:?}");
    }
}
