//! Simulated detections.

use nalgebra::Point3;
use rand::{Rng, RngCore, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::{SplitMix64, Xoshiro256PlusPlus};

use crate::calibration::{Corner, FEWEST_CORNERS, ObservationError, Observations, View};
use crate::camera::Camera;
use crate::feasibility::told_in_image;
use crate::information::{Noise, NoiseModel, Whitening};
use crate::spatial::Pose;
use crate::target::{Board, Corners, Surface};

/// What the camera really meets, as against what a plan supposes.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The true camera.
    pub camera: Camera,
    /// The true pose `X_CT` of the board in each view.
    pub poses: Vec<Pose>,
    /// The corners to see in each view; others are hidden.
    pub seen: Vec<Corners>,
    /// Standard deviation of a pixel coordinate in each view, px; under a model of noise that of a corner seen square-on.
    pub sigma: Vec<f64>,
    /// How a corner's scatter depends on how it is seen.
    pub noise: NoiseModel,
    /// Chance of each corner to go undetected.
    pub missing: f64,
    /// The board's true face.
    pub surface: Surface,
}

impl Scene {
    /// Detects the corners of `board`: each coordinate with Gaussian noise, those outside the image, on markers that are not
    /// whole in it, or unlucky missing. Views left with too few corners to calibrate from are missing too. The same `seed`
    /// gives the same noise.
    ///
    /// # Errors
    /// [`ObservationError`] where no view is left, or one cannot be calibrated from for another reason.
    pub fn observe(&self, board: &Board, seed: u64) -> Result<Observations, ObservationError> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut views: Vec<View> = Vec::with_capacity(self.poses.len());
        let markers = board.markers();
        for ((X_CT, seen), sigma) in self.poses.iter().zip(&self.seen).zip(&self.sigma) {
            let is_told = told_in_image(&self.camera, &markers, board.corner_count(), X_CT);
            let mut see = |(index, p_T): (usize, Point3<f64>)| {
                if !(seen.contains(index) && is_told[index]) {
                    return None;
                }
                let p_T = self.surface.point(&p_T.coords.xy());
                let pixel = self.camera.project(&(X_CT * p_T)).filter(|pixel| self.camera.contains(pixel, 0.0))?;
                if self.missing > 0.0 && rng.gen_bool(self.missing) {
                    return None;
                }
                let normal = [rng.sample(StandardNormal), rng.sample(StandardNormal)];
                let noise = self.whitening(board, index, &p_T, X_CT)?.coloured(normal);
                Some(Corner { index, pixel: pixel + noise * *sigma, weight: 1.0 })
            };
            views.push(board.corners().enumerate().filter_map(&mut see).collect());
        }
        views.retain(|view| view.len() >= FEWEST_CORNERS);
        Observations::new(board.clone(), self.camera.width(), self.camera.height(), views)
    }

    fn whitening(&self, board: &Board, index: usize, p_T: &Point3<f64>, X_CT: &Pose) -> Option<Whitening> {
        if self.noise == NoiseModel::Constant {
            return Some(Whitening::NONE);
        }
        let p_C = X_CT * p_T;
        let by_point = self.camera.project_with_derivatives(&p_C)?.by_point;
        let R = X_CT.rotation.to_rotation_matrix();
        let vergence = self.camera.vergence(&p_C);
        Some(self.noise.through(&self.camera).whitening_in_view(&board.feature(index), &by_point, R.matrix(), vergence))
    }
}

/// The corners of `board` that `camera` sees at the poses `X_CT`, with Gaussian `noise`: a [`Scene`] as planned.
///
/// # Errors
/// As [`Scene::observe`].
pub fn simulate(
    camera: &Camera,
    board: &Board,
    poses: &[Pose],
    noise: Noise,
    seed: u64,
) -> Result<Observations, ObservationError> {
    let scene = Scene {
        camera: camera.clone(),
        poses: poses.to_vec(),
        seen: vec![Corners::All; poses.len()],
        sigma: vec![noise.sigma; poses.len()],
        noise: noise.model,
        missing: 0.0,
        surface: Surface::FLAT,
    };
    scene.observe(board, seed)
}

/// The seed of one of many trials. A hash: seeds that differ by little would give streams that overlap or correlate.
pub(crate) fn trial_seed(seed: u64, trial: usize) -> u64 {
    SplitMix64::seed_from_u64(seed ^ (trial as u64).rotate_left(32)).next_u64()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::camera::Lens;

    const BOARD: Board = Board::checkerboard(20, 20, 0.02);

    fn camera() -> Camera {
        Camera::new(Lens::Pinhole, 1000, 1000, &[1000.0, 1000.0, 499.5, 499.5]).unwrap()
    }

    fn noise(sigma: f64) -> Noise {
        Noise { sigma, model: NoiseModel::Constant }
    }

    #[test]
    fn noise_has_the_deviation_asked_for_and_repeats_with_its_seed() {
        let poses = vec![Pose::translation(0.0, 0.0, 1.0); 10];
        let noisy = simulate(&camera(), &BOARD, &poses, noise(0.5), 7).unwrap();
        assert_eq!(noisy, simulate(&camera(), &BOARD, &poses, noise(0.5), 7).unwrap());
        assert_ne!(noisy, simulate(&camera(), &BOARD, &poses, noise(0.5), 8).unwrap());
        let clean = simulate(&camera(), &BOARD, &poses, noise(0.0), 7).unwrap();
        let pairs = noisy.views().iter().flatten().zip(clean.views().iter().flatten());
        let sum: f64 = pairs.map(|(a, b)| (a.pixel - b.pixel).norm_squared()).sum();
        // 8000 coordinates: the deviation is known to 0.8 %.
        assert!(((sum / 8000.0).sqrt() / 0.5 - 1.0).abs() < 0.03);
    }

    #[test]
    fn corners_outside_the_image_are_missing() {
        let half = simulate(&camera(), &BOARD, &[Pose::translation(0.5, 0.0, 1.0)], noise(0.0), 1).unwrap();
        assert_eq!(half.corner_count(), 200);
        let behind = Pose::new(Vector3::new(0.0, 0.0, -1.0), Vector3::zeros());
        let error = simulate(&camera(), &BOARD, &[behind], noise(0.0), 1).unwrap_err();
        assert_eq!(error, ObservationError::NoViews);
    }

    #[test]
    fn trials_have_seeds_of_their_own() {
        let mut seeds: Vec<u64> = (0..1000).flat_map(|t| [trial_seed(1, t), trial_seed(2, t)]).collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 2000);
    }
}
