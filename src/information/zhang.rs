//! What a view contributes to Zhang's closed-form solution (*A flexible new technique for camera calibration*, PAMI 2000).

use nalgebra::{Matrix2, Matrix2x6, Matrix5, SMatrix, Vector3, Vector6};
use rayon::prelude::*;

use super::view::Measurement;
use crate::selection::InformationSet;
use crate::spatial::Pose;
use crate::target::Corners;

/// The five directions in which `b = (B₁₁, B₁₂, B₂₂, B₁₃, B₂₃, B₃₃)` can err, in coordinates normalised by the nominal
/// camera, where it is (1, 0, 1, 0, 0, 1) up to its scale.
pub const ZHANG_DIRECTIONS: [&str; 5] = ["skew", "cx", "cy", "fx - fy", "focal length"];

/// The columns of U (6×5), an orthonormal basis of the complement of `b₀ = (1, 0, 1, 0, 0, 1)`, in the order of
/// [`ZHANG_DIRECTIONS`].
fn complement() -> SMatrix<f64, 6, 5> {
    let (half, sixth) = (0.5f64.sqrt(), 6f64.sqrt().recip());
    SMatrix::from_columns(&[
        Vector6::new(0.0, 1.0, 0.0, 0.0, 0.0, 0.0),
        Vector6::new(0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
        Vector6::new(0.0, 0.0, 0.0, 0.0, 1.0, 0.0),
        Vector6::new(half, 0.0, -half, 0.0, 0.0, 0.0),
        Vector6::new(sixth, 0.0, sixth, 0.0, 0.0, -2.0 * sixth),
    ])
}

impl Measurement<'_> {
    /// The share of the view of the corners `seen` from `X_CT`, `Uᵀ V_iᵀ Σ_i⁻¹ V_i U` of the closed form's normal matrix, 5×5 packed.
    ///
    /// `V_i` (2×6) holds the view's two constraints on b, v₁₂ and v₁₁ − v₂₂ of Zhang's equations 8 and 9, at the nominal
    /// homography `[r₁ r₂ t]`; `Σ_i` (2×2) is the covariance that the corners' noise gives `V_i b₀` through the homography.
    /// `None` if a corner has no image or the corners do not fix a homography.
    pub(crate) fn zhang_information(&self, X_CT: &Pose, seen: &Corners) -> Option<Vec<f64>> {
        let R = X_CT.rotation.to_rotation_matrix();
        let h: [Vector3<f64>; 3] = [R.matrix().column(0).into(), R.matrix().column(1).into(), X_CT.translation.vector];
        // Normal matrix of the homography's nine entries, column by column.
        let mut N = SMatrix::<f64, 9, 9>::zeros();
        for i in seen.indices(self.corners.len()) {
            let corner = &self.corners[i];
            let (camera, p_C) = (self.unknowns.camera, X_CT * corner);
            let by_point = camera.project_with_derivatives(&p_C)?.by_point;
            let (feature, vergence) = (&self.features[i], camera.vergence(&p_C));
            let whitening = self.noise.model.whitening_in_view(feature, &by_point, R.matrix(), vergence);
            let by_point = whitening.of_rows(&by_point) / self.noise.sigma;
            let mut A = SMatrix::<f64, 2, 9>::zeros();
            for (c, factor) in [corner.x, corner.y, 1.0].into_iter().enumerate() {
                A.fixed_columns_mut::<3>(3 * c).copy_from(&(by_point * factor));
            }
            N += A.transpose() * A;
        }
        // The corners do not see the homography's scale, and the constraints do not depend on it: any variance will do.
        let scale = SMatrix::<f64, 9, 1>::from_iterator(h.iter().flat_map(|h| h.iter().copied())).normalize();
        let covariance = (N + scale * scale.transpose() * (N.trace() / 9.0)).cholesky()?.inverse();
        // δ(h₁ᵀh₂) = h₂ᵀδh₁ + h₁ᵀδh₂ and δ(h₁ᵀh₁ − h₂ᵀh₂) = 2h₁ᵀδh₁ − 2h₂ᵀδh₂.
        let mut G = SMatrix::<f64, 2, 9>::zeros();
        for r in 0..3 {
            G[(0, r)] = h[1][r];
            G[(0, 3 + r)] = h[0][r];
            G[(1, r)] = 2.0 * h[0][r];
            G[(1, 3 + r)] = -2.0 * h[1][r];
        }
        let Σ: Matrix2<f64> = G * covariance * G.transpose();
        let v = |a: &Vector3<f64>, b: &Vector3<f64>| {
            Vector6::new(
                a.x * b.x,
                a.x * b.y + a.y * b.x,
                a.y * b.y,
                a.z * b.x + a.x * b.z,
                a.z * b.y + a.y * b.z,
                a.z * b.z,
            )
        };
        let V = Matrix2x6::from_rows(&[v(&h[0], &h[1]).transpose(), (v(&h[0], &h[0]) - v(&h[1], &h[1])).transpose()]);
        let VU = V * complement();
        let G_i: Matrix5<f64> = VU.transpose() * Σ.try_inverse()? * VU;
        Some((0..5).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| G_i[(i, j)]).collect())
    }

    /// What each of many views reveals to Zhang's closed form, each from its `X_CT` and of the corners seen, in their order; `None`
    /// as for one.
    pub fn zhang_set<'b>(
        &self,
        views: impl IntoParallelIterator<Item = (&'b Pose, &'b Corners), Iter: IndexedParallelIterator>,
    ) -> Option<InformationSet> {
        let views = views.into_par_iter().with_min_len(32);
        let rows: Option<Vec<Vec<f64>>> = views.map(|(X_CT, seen)| self.zhang_information(X_CT, seen)).collect();
        InformationSet::from_packed_unchecked(5, rows?.concat()).ok()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, Matrix3, Point3, SymmetricEigen};
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256Plus;

    use super::*;
    use crate::camera::{Camera, Lens};
    use crate::information::{Noise, NoiseModel, Unknowns};
    use crate::selection::packed::unpack;
    use crate::target::Board;

    /// Homographies of noisy corners, by linearised least squares about the true one; b by weighted least squares with the
    /// `Σ_i` of the definition. Its scatter is the inverse of the sum of the views' matrices.
    #[test]
    #[ignore = "slow: in the full set, `cargo test -- --ignored`"]
    fn it_predicts_the_scatter_of_the_closed_form() {
        let camera = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 1000.0, 639.5, 359.5]).unwrap();
        let board = Board::checkerboard(8, 6, 0.035);
        let corners: Vec<Point3<f64>> = board.corners().collect();
        let noise = 0.2;
        let unknowns = Unknowns { camera: &camera, estimated: &[0, 1, 2, 3] };
        let measurement = Measurement::new(unknowns, &board, Noise { sigma: noise, model: NoiseModel::Constant });
        let pose = |i: usize| {
            let angle = i as f64 * 1.3;
            let tilt = Vector3::new(0.6 * angle.cos(), 0.6 * angle.sin(), 0.3 * angle);
            let facing = nalgebra::UnitQuaternion::from_scaled_axis(Vector3::x() * std::f64::consts::PI);
            let R = nalgebra::UnitQuaternion::from_scaled_axis(tilt) * facing;
            Pose::from_parts(Vector3::new(0.02 * i as f64 - 0.05, 0.03, 0.55 + 0.03 * i as f64).into(), R)
        };
        let views: Vec<Pose> = (0..6).map(pose).collect();
        let sum = views.iter().fold(DMatrix::zeros(5, 5), |sum, X| {
            sum + unpack(&measurement.zhang_information(X, &Corners::All).unwrap(), 5)
        });
        let predicted = sum.clone().cholesky().unwrap().inverse();

        let mut rng = Xoshiro256Plus::seed_from_u64(3);
        let trials = 3000;
        let mut sampled = DMatrix::<f64>::zeros(5, 5);
        for _ in 0..trials {
            let mut right = nalgebra::DVector::<f64>::zeros(5);
            for X_CT in &views {
                let (G_row, b_error) = noisy_constraints(&camera, &corners, noise, X_CT, &mut rng);
                right += G_row.transpose() * b_error;
            }
            let b = &predicted * right;
            sampled += &b * b.transpose() / f64::from(trials);
        }
        let whitener = predicted.cholesky().unwrap().l().try_inverse().unwrap();
        let ratio = SymmetricEigen::new(&whitener * sampled * whitener.transpose()).eigenvalues;
        assert!(ratio.iter().all(|&ratio| (0.85..1.15).contains(&ratio)), "{ratio}");
    }

    /// `Σ⁻¹ V U` (2×5) and the error of `V b₀` from one noisy homography.
    fn noisy_constraints(
        camera: &Camera,
        corners: &[Point3<f64>],
        noise: f64,
        X_CT: &Pose,
        rng: &mut impl Rng,
    ) -> (DMatrix<f64>, nalgebra::DVector<f64>) {
        let R = X_CT.rotation.to_rotation_matrix();
        let t = X_CT.translation.vector;
        let H = Matrix3::from_columns(&[R.matrix().column(0).into(), R.matrix().column(1).into(), t]);
        let mut A = DMatrix::zeros(2 * corners.len(), 9);
        let mut e = nalgebra::DVector::zeros(2 * corners.len());
        for (i, corner) in corners.iter().enumerate() {
            let by_point = camera.project_with_derivatives(&(X_CT * corner)).unwrap().by_point;
            for (c, factor) in [corner.x, corner.y, 1.0].into_iter().enumerate() {
                A.view_mut((2 * i, 3 * c), (2, 3)).copy_from(&(by_point * factor));
            }
            for r in 0..2 {
                e[2 * i + r] = noise * rng.sample::<f64, _>(StandardNormal);
            }
        }
        let svd = A.clone().svd(true, true);
        let least = svd.singular_values.max() * 1e-9;
        let δ = svd.solve(&e, least).unwrap();
        let noisy = H + Matrix3::from_column_slice(δ.as_slice());
        let constraint = |H: &Matrix3<f64>| {
            let (a, b) = (H.column(0), H.column(1));
            nalgebra::DVector::from_vec(vec![a.dot(&b), a.dot(&a) - b.dot(&b)])
        };
        // Σ by differences, V U from the same bilinear form: v_ab · b = aᵀ B b.
        let pinv = A.pseudo_inverse(least).unwrap() * noise;
        let mut G = DMatrix::zeros(2, 9);
        for j in 0..9 {
            let mut step = Matrix3::zeros();
            step[j] = 1e-6;
            G.set_column(j, &((constraint(&(H + step)) - constraint(&(H - step))) / 2e-6));
        }
        let Σ = &G * &pinv * pinv.transpose() * G.transpose();
        let U = complement();
        let V = DMatrix::from_fn(2, 5, |r, c| {
            let b = U.column(c);
            let B = Matrix3::new(b[0], b[1], b[3], b[1], b[2], b[4], b[3], b[4], b[5]);
            let form = |x: usize, y: usize| (H.column(x).transpose() * B * H.column(y))[0];
            if r == 0 { form(0, 1) } else { form(0, 0) - form(1, 1) }
        });
        (Σ.try_inverse().unwrap() * V, constraint(&noisy))
    }
}
