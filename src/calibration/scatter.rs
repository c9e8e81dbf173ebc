//! How far corners scatter, from repeated pictures of scenes that do not move.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use thiserror::Error;

use super::homography::homography;
use super::observations::Observations;
use crate::information::{Blur, Noise, NoiseModel};
use crate::target::Feature;

/// How the corners of repeated pictures scatter, and which model of it fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatter {
    /// Corners of a scene that were seen in two pictures at least.
    pub corners: usize,
    /// Deviations from their means that are independent: two for each time that a corner was seen once more.
    pub freedoms: usize,
    /// Constant noise.
    pub constant: FittedNoise,
    /// The edges' model.
    pub edges: FittedNoise,
    /// Root mean square of the pictures' common shift, in px: what moves all corners of a picture alike.
    pub common_shift: f64,
    /// What that would be if the corners scattered each for itself.
    pub expected_shift: f64,
}

/// A model of the noise with its standard deviation as measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedNoise {
    /// The model, and σ.
    pub noise: Noise,
    /// Standard deviation of the corners' own σ about the model's, as a share of it, beyond what chance explains.
    pub misfit: f64,
    /// Logarithm of the likelihood, up to a constant that the models share.
    pub log_likelihood: f64,
}

/// Why nothing can be said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ScatterError {
    /// No corner was seen twice in a scene.
    #[error("no corner is seen in two pictures of one scene; {pictures} {} given", if *pictures == 1 { "picture is" } else { "pictures are" })]
    NoRepetition {
        /// Pictures of all scenes.
        pictures: usize,
    },
    /// The corners do not differ from picture to picture.
    #[error("the corners are the same in every picture, to the last digit: the pictures are copies of one")]
    Copies,
}

/// A corner of a scene.
struct Repeated {
    /// Deviations from their mean, px.
    deviations: Vec<Vector2<f64>>,
    /// Derivative of the pixel by the place on the board, px per m.
    by_place: Matrix2<f64>,
    feature: Feature,
}

impl Scatter {
    /// Of `scenes`, each the pictures of one camera and one board that both stand still, of a detector with that `window`, half
    /// its side in px, and of the camera's `blur`.
    ///
    /// # Errors
    /// When no corner was seen twice, or all are the same.
    pub fn new(scenes: &[Observations], window: f64, blur: Blur) -> Result<Self, ScatterError> {
        let corners: Vec<Repeated> = scenes.iter().flat_map(repeated).collect();
        let freedoms = corners.iter().map(|corner| 2 * (corner.deviations.len() - 1)).sum();
        if freedoms == 0 {
            return Err(ScatterError::NoRepetition { pictures: scenes.iter().map(|scene| scene.views().len()).sum() });
        }
        if corners.iter().flat_map(|corner| &corner.deviations).all(|deviation| deviation.norm() == 0.0) {
            return Err(ScatterError::Copies);
        }
        let constant = fitted(&corners, freedoms, NoiseModel::Constant);
        let edges = fitted(&corners, freedoms, NoiseModel::Edges { window, blur: blur.at_rest() });
        let (common_shift, expected_shift) = shifts(scenes);
        Ok(Self { corners: corners.len(), freedoms, constant, edges, common_shift, expected_shift })
    }

    /// The model that fits better.
    pub fn better(&self) -> &FittedNoise {
        if self.edges.log_likelihood > self.constant.log_likelihood { &self.edges } else { &self.constant }
    }
}

/// The corners of a scene that were seen twice at least.
fn repeated(scene: &Observations) -> Vec<Repeated> {
    let board = scene.board();
    let mut seen: Vec<Vec<Vector2<f64>>> = vec![Vec::new(); board.corner_count()];
    for corner in scene.views().iter().flatten() {
        seen[corner.index].push(corner.pixel);
    }
    let places: Vec<Vector2<f64>> = board.corners().map(|corner| corner.coords.xy()).collect();
    let mean = |pixels: &Vec<Vector2<f64>>| pixels.iter().sum::<Vector2<f64>>() / pixels.len() as f64;
    let all: Vec<usize> = (0..seen.len()).filter(|&i| !seen[i].is_empty()).collect();
    let on_board: Vec<_> = all.iter().map(|&i| places[i]).collect();
    let in_picture: Vec<_> = all.iter().map(|&i| mean(&seen[i])).collect();
    // The lens bends it little over the distance of two corners.
    let Some(H) = homography(&on_board, &in_picture) else { return Vec::new() };
    let corner = |&i: &usize| {
        let centre = mean(&seen[i]);
        let deviations = seen[i].iter().map(|pixel| pixel - centre).collect();
        Repeated { deviations, by_place: slope(&H, &places[i]), feature: board.feature(i) }
    };
    all.iter().filter(|&&i| seen[i].len() > 1).map(corner).collect()
}

/// The derivative of a homography at a point.
fn slope(H: &Matrix3<f64>, place: &Vector2<f64>) -> Matrix2<f64> {
    let image: Vector3<f64> = H * place.push(1.0);
    let pixel = image.xy() / image.z;
    (H.fixed_view::<2, 2>(0, 0) - pixel * H.fixed_view::<1, 2>(2, 0)) / image.z
}

fn fitted(corners: &[Repeated], freedoms: usize, model: NoiseModel) -> FittedNoise {
    let whitened = |corner: &Repeated| {
        let whitening = model.whitening(&corner.feature, &corner.by_place);
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        let sum: f64 = corner.deviations.iter().map(|&deviation| square(whitening.whitened(deviation.into()))).sum();
        (sum, 2.0 * (corner.deviations.len() - 1) as f64, whitening.covariance().determinant())
    };
    let sums: Vec<(f64, f64, f64)> = corners.iter().map(whitened).collect();
    let variance = sums.iter().map(|(sum, ..)| sum).sum::<f64>() / freedoms as f64;
    // Each corner's own variance over the model's: of ν freedoms it scatters by 2/ν about 1.
    let (mut excess, mut log_det) = (0.0, 0.0);
    for (sum, own, determinant) in &sums {
        excess += own * ((sum / (own * variance) - 1.0).powi(2) - 2.0 / own);
        log_det += 0.5 * own * determinant.ln();
    }
    FittedNoise {
        noise: Noise { sigma: variance.sqrt(), model },
        // A share of the variance is twice that of the deviation.
        misfit: 0.5 * (excess / freedoms as f64).max(0.0).sqrt(),
        log_likelihood: -0.5 * (freedoms as f64 * variance.ln() + log_det),
    }
}

/// Root mean square of the pictures' mean deviations, and what corners that scatter each for itself would give.
fn shifts(scenes: &[Observations]) -> (f64, f64) {
    let (mut found, mut expected, mut pictures) = (0.0, 0.0, 0.0);
    for scene in scenes {
        let count = scene.board().corner_count();
        let mut sums = vec![(Vector2::zeros(), 0.0, 0.0); count];
        for corner in scene.views().iter().flatten() {
            let (sum, square, n) = &mut sums[corner.index];
            *sum += corner.pixel;
            *square += corner.pixel.norm_squared();
            *n += 1.0;
        }
        let mean = |i: usize| sums[i].0 / sums[i].2;
        let variance = |i: usize| (sums[i].1 / sums[i].2 - mean(i).norm_squared()).max(0.0);
        for view in scene.views() {
            let n = view.len() as f64;
            let shift: Vector2<f64> = view.iter().map(|corner| corner.pixel - mean(corner.index)).sum();
            found += (shift / n).norm_squared();
            expected += view.iter().map(|corner| variance(corner.index)).sum::<f64>() / (n * n);
            pictures += 1.0;
        }
    }
    ((found / pictures).sqrt(), (expected / pictures).sqrt())
}
