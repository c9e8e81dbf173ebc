//! The map error: how far a calibration's error moves the image of the world.

use nalgebra::{DMatrix, Vector2};

use super::Unknowns;
use super::image_area::{AreaNode, image_area};
use crate::spatial::skew;

impl Unknowns<'_> {
    /// The p×p weight W of the map error: `tr(W · cov θ)` is the expected squared error in px², averaged over the image's area,
    /// of the calibrated projection of fixed viewing directions.
    ///
    /// With `J(u)` (2×p) the derivative of the projection of the direction seen at image point u with respect to the estimated
    /// intrinsics, and `R(u)` (2×3) that with respect to a rotation of the camera: a small rotation is no calibration error,
    /// so what it explains best over the whole image is projected out, `J⊥ = J − R (∫RᵀR du)⁻¹ ∫RᵀJ du`, and
    /// `W = (1/|Ω|) ∫ J⊥ᵀJ⊥ du`. The area Ω is the image, [−½, w−½] × [−½, h−½], as far as the lens reaches.
    pub fn map_error_weight(&self) -> DMatrix<f64> {
        self.weight_over(&image_area(self.camera))
    }

    /// The weight with the integrals as sums over `nodes`.
    pub(super) fn weight_over(&self, nodes: &[AreaNode]) -> DMatrix<f64> {
        let (J, R) = self.stacked(nodes);
        let Q = R.qr().q();
        let J_perpendicular = &J - &Q * (Q.transpose() * &J);
        J_perpendicular.transpose() * J_perpendicular
    }

    /// The unit of each in which they are alike: the change of it alone that moves the image of fixed viewing directions by
    /// 1 px RMS over the image's area.
    pub fn pixel_units(&self) -> Vec<f64> {
        let (J, _) = self.stacked(&image_area(self.camera));
        J.column_iter().map(|column| column.norm().recip()).collect()
    }

    /// The map error at each of `pixels`: the expected RMS distance in px by which an error of `covariance` (p×p) moves the
    /// projection of the direction seen there, or none where the lens does not reach.
    ///
    /// The rotation taken out is that of [`Unknowns::map_error_weight`], the best over the whole image; so the mean square over
    /// the image's area is `tr(W · cov θ)`. With `T = (∫RᵀR)⁻¹∫RᵀJ` and `J_x`, `R_x` of the pixel it is the root of
    /// `tr((J_x − R_x T) cov θ (J_x − R_x T)ᵀ)`.
    pub fn map_error_at(&self, covariance: &DMatrix<f64>, pixels: &[Vector2<f64>]) -> Vec<Option<f64>> {
        let (J, R) = self.stacked(&image_area(self.camera));
        let qr = R.qr();
        let T = qr.r().solve_upper_triangular(&(qr.q().transpose() * J));
        let error = |pixel: &Vector2<f64>| {
            let (J_x, R_x) = self.derivatives(pixel)?;
            let moved = J_x - R_x * T.as_ref()?;
            Some((&moved * covariance * moved.transpose()).trace().sqrt())
        };
        pixels.iter().map(error).collect()
    }

    /// J (2 rows a node, p columns) and R (2 rows a node, 3 columns), each row by the root of the node's share: sums of products
    /// of the stack's columns are means over the area.
    fn stacked(&self, nodes: &[AreaNode]) -> (DMatrix<f64>, DMatrix<f64>) {
        let (mut J, mut R) = (Vec::new(), Vec::new());
        for AreaNode { pixel, share } in nodes {
            let Some((J_u, R_u)) = self.derivatives(pixel) else { continue };
            for r in 0..2 {
                J.extend(J_u.row(r).iter().map(|entry| entry * share.sqrt()));
                R.extend(R_u.row(r).iter().map(|entry| entry * share.sqrt()));
            }
        }
        let rows = R.len() / 3;
        (DMatrix::from_row_iterator(rows, self.len(), J), DMatrix::from_row_iterator(rows, 3, R))
    }

    /// Derivatives of the projection of the direction seen at `pixel`: by the estimated intrinsics (2×p) and by a rotation of
    /// the camera (2×3).
    fn derivatives(&self, pixel: &Vector2<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let ray = self.camera.unproject(pixel)?;
        let projection = self.camera.project_with_derivatives(&ray.into_inner().into())?;
        let by_rotation = -projection.by_point * skew(&ray);
        let by_intrinsics = DMatrix::from_fn(2, self.len(), |r, j| projection.by_intrinsics[(r, self.estimated[j])]);
        Some((by_intrinsics, DMatrix::from_fn(2, 3, |r, c| by_rotation[(r, c)])))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DVector, Rotation3, Vector3};

    use super::*;
    use crate::camera::{Camera, Lens};

    fn camera() -> Camera {
        let θ = [1000.0, 990.0, 639.5, 359.5, -0.2, 0.05, 1e-3, -1e-3, 0.01];
        Camera::new(Lens::BrownConrady, 1280, 720, &θ).unwrap()
    }

    /// The centres of 64 × 36 equal cells: each stands for the same area.
    fn cells() -> impl Iterator<Item = Vector2<f64>> {
        let center = |i: usize| i as f64 * 20.0 + 9.5;
        (0..64 * 36).map(move |g| Vector2::new(center(g % 64), center(g / 64)))
    }

    /// For a small change of the intrinsics, √(δᵀWδ) is the RMS distance over the area left after the best rotation, found
    /// here by minimising over rotations directly.
    #[test]
    fn weight_is_the_residual_after_the_best_rotation() {
        let camera = camera();
        let estimated: Vec<usize> = (0..9).collect();
        let δ = DVector::from_row_slice(&[0.02, -0.01, 0.03, -0.02, 1e-5, -2e-5, 1e-6, 2e-6, 1e-5]);
        let moved: Vec<f64> = camera.intrinsics().iter().zip(&δ).map(|(a, b)| a + b).collect();
        let moved = camera.with_intrinsics(&moved).unwrap();
        let residuals = |ω: &Vector3<f64>| -> DVector<f64> {
            let R = Rotation3::from_scaled_axis(*ω);
            let mut out = Vec::new();
            for pixel in cells() {
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
        let rms = (residuals(&ω).norm_squared() / cells().count() as f64).sqrt();
        let W = Unknowns { camera: &camera, estimated: &estimated }.map_error_weight();
        let predicted = (δ.transpose() * W * &δ)[0].sqrt();
        assert!((predicted / rms - 1.0).abs() < 2e-3, "{predicted} {rms}");
    }

    /// A focal length moves a point by its distance from the principal point over f: w/√12 over f RMS.
    #[test]
    fn pixel_units_of_a_pinhole_are_known() {
        let pinhole = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 900.0, 639.5, 359.5]).unwrap();
        let expected = [1000.0 * 12f64.sqrt() / 1280.0, 900.0 * 12f64.sqrt() / 720.0, 1.0, 1.0];
        let unknowns = Unknowns { camera: &pinhole, estimated: &[0, 1, 2, 3] };
        for (unit, expected) in unknowns.pixel_units().iter().zip(expected) {
            assert!((unit / expected - 1.0).abs() < 1e-9, "{unit} {expected}");
        }
    }

    #[test]
    fn errors_over_the_area_average_to_the_weight() {
        let camera = camera();
        let estimated = [0, 1, 2, 3, 4, 6];
        let root = DMatrix::from_fn(6, 6, |i, j| if i < 4 { 0.1 } else { 1e-4 } * (1.0 + (i * 7 + j * 3) as f64).sin());
        let covariance = &root * root.transpose();
        let pixels: Vec<_> = cells().collect();
        let unknowns = Unknowns { camera: &camera, estimated: &estimated };
        let errors = unknowns.map_error_at(&covariance, &pixels);
        let mean = errors.iter().map(|error| error.unwrap().powi(2)).sum::<f64>() / pixels.len() as f64;
        let expected = (unknowns.map_error_weight() * covariance).trace();
        assert!((mean / expected - 1.0).abs() < 2e-3, "{mean} {expected}");
    }
}
