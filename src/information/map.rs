//! The map error: how far a calibration's error moves the image of the world.

use nalgebra::{DMatrix, Vector2};

use crate::camera::Camera;
use crate::spatial::skew;

/// Columns of the grid of image points; the rows follow from the image's shape.
const COLUMNS: usize = 25;

/// The p×p weight W of the map error: `tr(W · cov θ)` is the expected squared error in px², averaged over a grid of image
/// points, of the calibrated projection of fixed viewing directions.
///
/// With `J_g` (2×p) the derivative of the projection with respect to the `estimated` intrinsics at grid point g, and
/// `R_g` (2×3) that with respect to a rotation of the camera, stack both over the grid; a small rotation is no calibration
/// error, so its columns are projected out: `W = J⊥ᵀ J⊥ / points`, `J⊥ = J − R (RᵀR)⁻¹ RᵀJ`. Points that the lens does not
/// reach are left out.
pub fn map_error_weight(camera: &Camera, estimated: &[usize]) -> DMatrix<f64> {
    let (width, height) = (f64::from(camera.width()), f64::from(camera.height()));
    let rows = ((COLUMNS as f64 * height / width).ceil() as usize).clamp(2, COLUMNS * COLUMNS);
    let at = |i: usize, count: usize, size: f64| i as f64 / (count - 1) as f64 * (size - 1.0);
    let grid = (0..rows * COLUMNS)
        .map(|g| Vector2::new(at(g % COLUMNS, COLUMNS, width), at(g / COLUMNS, rows, height)))
        .filter_map(|pixel| camera.unproject(&pixel))
        .filter_map(|ray| Some((ray, camera.project_with_derivatives(&ray.into_inner().into())?)));
    let (mut J, mut R) = (Vec::new(), Vec::new());
    for (ray, projection) in grid {
        let by_rotation = -projection.by_point * skew(&ray);
        for r in 0..2 {
            J.extend(estimated.iter().map(|&j| projection.by_intrinsics[(r, j)]));
            R.extend(by_rotation.row(r).iter());
        }
    }
    let points = R.len() / 6;
    let J = DMatrix::from_row_iterator(2 * points, estimated.len(), J);
    let Q = DMatrix::from_row_iterator(2 * points, 3, R).qr().q();
    let J_perpendicular = &J - &Q * (Q.transpose() * &J);
    J_perpendicular.transpose() * J_perpendicular / points.max(1) as f64
}

#[cfg(test)]
mod tests {
    use nalgebra::{DVector, Rotation3, Vector3};

    use super::*;
    use crate::camera::Lens;

    /// For a small change of the intrinsics, √(δᵀWδ) is the RMS distance left after the best rotation, found here by
    /// minimising over rotations directly.
    #[test]
    fn weight_is_the_residual_after_the_best_rotation() {
        let θ = [1000.0, 990.0, 639.5, 359.5, -0.2, 0.05, 1e-3, -1e-3, 0.01];
        let camera = Camera::new(Lens::BrownConrady, 1280, 720, &θ).unwrap();
        let estimated: Vec<usize> = (0..9).collect();
        let δ = DVector::from_row_slice(&[0.02, -0.01, 0.03, -0.02, 1e-5, -2e-5, 1e-6, 2e-6, 1e-5]);
        let moved: Vec<f64> = θ.iter().zip(&δ).map(|(a, b)| a + b).collect();
        let moved = camera.with_intrinsics(&moved).unwrap();
        let residuals = |ω: &Vector3<f64>| -> DVector<f64> {
            let R = Rotation3::from_scaled_axis(*ω);
            let mut out = Vec::new();
            for g in 0..25 * 15 {
                let pixel = Vector2::new(f64::from(g % 25) / 24.0 * 1279.0, f64::from(g / 25) / 14.0 * 719.0);
                let ray = camera.unproject(&pixel).unwrap();
                out.extend((moved.project(&(R * ray.into_inner()).into()).unwrap() - pixel).iter().copied());
            }
            DVector::from_vec(out)
        };
        let mut ω = Vector3::zeros();
        for _ in 0..5 {
            let r = residuals(&ω);
            let slope = DMatrix::from_columns(&[0, 1, 2].map(|j| {
                let mut step = Vector3::zeros();
                step[j] = 1e-6;
                (residuals(&(ω + step)) - residuals(&(ω - step))) / 2e-6
            }));
            let step = (slope.transpose() * &slope).try_inverse().unwrap() * slope.transpose() * r;
            ω -= Vector3::new(step[0], step[1], step[2]);
        }
        let rms = (residuals(&ω).norm_squared() / 375.0).sqrt();
        let W = map_error_weight(&camera, &estimated);
        let predicted = (δ.transpose() * W * &δ)[0].sqrt();
        assert!((predicted / rms - 1.0).abs() < 1e-3, "{predicted} {rms}");
    }
}
