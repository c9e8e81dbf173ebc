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
    let (J, R) = on_grid(camera, estimated);
    let points = J.nrows() / 2;
    let Q = R.qr().q();
    let J_perpendicular = &J - &Q * (Q.transpose() * &J);
    J_perpendicular.transpose() * J_perpendicular / points.max(1) as f64
}

/// The unit of each of the `estimated` intrinsics in which they are alike: the change of it alone that moves the image of
/// fixed viewing directions by 1 px RMS over the same grid of image points.
pub fn pixel_units(camera: &Camera, estimated: &[usize]) -> Vec<f64> {
    let (J, _) = on_grid(camera, estimated);
    let points = (J.nrows() / 2).max(1) as f64;
    J.column_iter().map(|column| (column.norm_squared() / points).sqrt().recip()).collect()
}

/// The map error at each of `pixels`: the expected RMS distance in px by which an error of `covariance` (p×p, of the
/// `estimated` intrinsics) moves the projection of the direction seen there, or none where the lens does not reach.
///
/// The rotation taken out is that of [`map_error_weight`], the best over the whole image; so the mean square over that
/// function's grid is `tr(W · cov θ)`. With `T = (RᵀR)⁻¹RᵀJ` of the grid and `J_x`, `R_x` of the pixel it is the root of
/// `tr((J_x − R_x T) cov θ (J_x − R_x T)ᵀ)`.
pub fn map_error_at(
    camera: &Camera,
    estimated: &[usize],
    covariance: &DMatrix<f64>,
    pixels: &[Vector2<f64>],
) -> Vec<Option<f64>> {
    let (J, R) = on_grid(camera, estimated);
    let qr = R.qr();
    let T = qr.r().solve_upper_triangular(&(qr.q().transpose() * J));
    let error = |pixel: &Vector2<f64>| {
        let (J_x, R_x) = derivatives(camera, estimated, pixel)?;
        let moved = J_x - R_x * T.as_ref()?;
        Some((&moved * covariance * moved.transpose()).trace().sqrt())
    };
    pixels.iter().map(error).collect()
}

/// J (2 rows a point, p columns) and R (2 rows a point, 3 columns) of the points of the grid.
fn on_grid(camera: &Camera, estimated: &[usize]) -> (DMatrix<f64>, DMatrix<f64>) {
    let (width, height) = (f64::from(camera.width()), f64::from(camera.height()));
    let rows = ((COLUMNS as f64 * height / width).ceil() as usize).clamp(2, COLUMNS * COLUMNS);
    let at = |i: usize, count: usize, size: f64| i as f64 / (count - 1) as f64 * (size - 1.0);
    let grid = (0..rows * COLUMNS)
        .map(|g| Vector2::new(at(g % COLUMNS, COLUMNS, width), at(g / COLUMNS, rows, height)))
        .filter_map(|pixel| derivatives(camera, estimated, &pixel));
    let (mut J, mut R) = (Vec::new(), Vec::new());
    for (J_g, R_g) in grid {
        for r in 0..2 {
            J.extend(J_g.row(r).iter());
            R.extend(R_g.row(r).iter());
        }
    }
    let rows = R.len() / 3;
    (DMatrix::from_row_iterator(rows, estimated.len(), J), DMatrix::from_row_iterator(rows, 3, R))
}

/// Derivatives of the projection of the direction seen at `pixel`: by the `estimated` intrinsics (2×p) and by a rotation
/// of the camera (2×3).
fn derivatives(camera: &Camera, estimated: &[usize], pixel: &Vector2<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let ray = camera.unproject(pixel)?;
    let projection = camera.project_with_derivatives(&ray.into_inner().into())?;
    let by_rotation = -projection.by_point * skew(&ray);
    let by_intrinsics = DMatrix::from_fn(2, estimated.len(), |r, j| projection.by_intrinsics[(r, estimated[j])]);
    Some((by_intrinsics, DMatrix::from_fn(2, 3, |r, c| by_rotation[(r, c)])))
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

    #[test]
    fn errors_at_the_grid_average_to_the_weight() {
        let θ = [1000.0, 990.0, 639.5, 359.5, -0.2, 0.05, 1e-3, -1e-3, 0.01];
        let camera = Camera::new(Lens::BrownConrady, 1280, 720, &θ).unwrap();
        let estimated = [0, 1, 2, 3, 4, 6];
        let root = DMatrix::from_fn(6, 6, |i, j| if i < 4 { 0.1 } else { 1e-4 } * (1.0 + (i * 7 + j * 3) as f64).sin());
        let covariance = &root * root.transpose();
        let pixel = |g: usize| Vector2::new((g % 25) as f64 / 24.0 * 1279.0, (g / 25) as f64 / 14.0 * 719.0);
        let pixels: Vec<_> = (0..25 * 15).map(pixel).collect();
        let errors = map_error_at(&camera, &estimated, &covariance, &pixels);
        let mean = errors.iter().map(|error| error.unwrap().powi(2)).sum::<f64>() / 375.0;
        let expected = (map_error_weight(&camera, &estimated) * covariance).trace();
        assert!((mean / expected - 1.0).abs() < 1e-9, "{mean} {expected}");
    }
}
