//! Information of one view of the board.

use nalgebra::{Matrix2x6, Point3};
use rayon::prelude::*;

use super::packed::packed_len;
use super::set::InformationSet;
use crate::camera::{Camera, MAX_INTRINSICS};
use crate::spatial::{Pose, skew};
use crate::target::Corners;

/// What is observed, how well, and what is to be learnt from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement<'a> {
    /// The nominal camera.
    pub camera: &'a Camera,
    /// All corners of the board, in T (m).
    pub corners: &'a [Point3<f64>],
    /// Standard deviation of a detected corner in px, in each direction.
    pub noise: f64,
    /// The intrinsics to estimate: indices into the camera's.
    pub estimated: &'a [usize],
}

const POSE: usize = 6;
const MOST_COLUMNS: usize = POSE + MAX_INTRINSICS;

impl Measurement<'_> {
    /// Information that the view of the corners `seen` from `X_CT` gives on the p estimated intrinsics once the view's own pose is
    /// eliminated, p×p packed: the Schur complement `(AᵀA − AᵀB (BᵀB)⁻¹ BᵀA) / σ²` of the normal matrix, where A (2m×p)
    /// and B (2m×6) are the residual Jacobians by the intrinsics and by the pose.
    ///
    /// `None` if a corner has no image.
    pub fn information(&self, X_CT: &Pose, seen: &Corners) -> Option<Vec<f64>> {
        match seen {
            Corners::All => self.information_of(X_CT, self.corners.iter()),
            Corners::Some(indices) => self.information_of(X_CT, indices.iter().map(|&i| &self.corners[i])),
        }
    }

    fn information_of<'c>(&self, X_CT: &Pose, corners: impl Iterator<Item = &'c Point3<f64>>) -> Option<Vec<f64>> {
        let mut normal = [0.0; packed_len(MOST_COLUMNS)];
        let columns = POSE + self.estimated.len();
        for corner in corners {
            // The pose is perturbed about the board's centre (see `spatial::perturb`).
            let arm = X_CT.rotation * corner.coords;
            let projection = self.camera.project_with_derivatives(&(X_CT * corner))?;
            let mut B = Matrix2x6::zeros();
            B.fixed_columns_mut::<3>(0).copy_from(&(-projection.by_point * skew(&arm)));
            B.fixed_columns_mut::<3>(3).copy_from(&projection.by_point);
            let mut rows = [[0.0; MOST_COLUMNS]; 2];
            for (r, row) in rows.iter_mut().enumerate() {
                for j in 0..POSE {
                    row[j] = B[(r, j)];
                }
                for (j, &parameter) in self.estimated.iter().enumerate() {
                    row[POSE + j] = projection.by_intrinsics[(r, parameter)];
                }
            }
            let [u, v] = &rows;
            for i in 0..columns {
                let (ui, vi) = (u[i], v[i]);
                for (sum, (u, v)) in normal[packed_len(i)..=packed_len(i) + i].iter_mut().zip(u.iter().zip(v)) {
                    *sum += ui * u + vi * v;
                }
            }
        }
        eliminate_pose(&mut normal, columns)?;
        let scale = 1.0 / (self.noise * self.noise);
        Some(
            (POSE..columns)
                .flat_map(|i| (POSE..=i).map(move |j| (i, j)))
                .map(|(i, j)| normal[packed_len(i) + j] * scale)
                .collect(),
        )
    }

    /// Information of many views, each from its `X_CT` and of the corners seen, in their order; `None` if a corner of one has no image.
    pub fn information_set<'b>(
        &self,
        views: impl IntoParallelIterator<Item = (&'b Pose, &'b Corners), Iter: IndexedParallelIterator>,
    ) -> Option<InformationSet> {
        let rows: Option<Vec<Vec<f64>>> =
            views.into_par_iter().with_min_len(32).map(|(X_CT, seen)| self.information(X_CT, seen)).collect();
        InformationSet::from_packed_unchecked(self.estimated.len(), rows?.concat()).ok()
    }
}

/// Eliminates the pose's six variables, the first of a packed symmetric matrix, by six steps of Cholesky's method, leaving
/// the Schur complement in the rest. `None` if they are not determined.
fn eliminate_pose(m: &mut [f64], order: usize) -> Option<()> {
    let original: [f64; POSE] = std::array::from_fn(|k| m[packed_len(k) + k]);
    for k in 0..POSE {
        let pivot = m[packed_len(k) + k];
        if pivot.is_nan() || pivot <= 8.0 * f64::EPSILON * original[k] {
            return None;
        }
        for i in k + 1..order {
            let factor = m[packed_len(i) + k] / pivot;
            for j in k + 1..=i {
                m[packed_len(i) + j] -= factor * m[packed_len(j) + k];
            }
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, Vector3};

    use super::*;
    use crate::camera::Lens;
    use crate::information::packed::unpack;
    use crate::spatial::{Tangent, perturb};
    use crate::target::Board;

    /// Against the definition: Jacobians by central differences, the pose projected out with a thin QR.
    #[test]
    fn information_equals_its_definition_by_finite_differences() {
        let θ = [1000.0, 990.0, 640.0, 360.0, -0.2, 0.05, 1e-3, -1e-3, 0.01];
        let camera = Camera::new(Lens::BrownConrady, 1280, 720, &θ).unwrap();
        let board = Board { columns: 8, rows: 6, square: 0.035 };
        let corners: Vec<_> = board.corners().collect();
        let X_CT = Pose::new(Vector3::new(0.05, -0.03, 0.6), Vector3::new(2.8, 0.2, -0.3));
        let estimated = [0, 1, 2, 3, 4, 5, 8];
        let measurement = Measurement { camera: &camera, corners: &corners, noise: 0.3, estimated: &estimated };
        let image = |camera: &Camera, X_CT: &Pose| -> Vec<f64> {
            corners.iter().flat_map(|p| camera.project(&(X_CT * p)).unwrap().data.0[0]).collect()
        };
        let slope = |plus: Vec<f64>, minus: Vec<f64>, h: f64| {
            nalgebra::DVector::from_iterator(plus.len(), plus.iter().zip(&minus).map(|(a, b)| (a - b) / (2.0 * h)))
        };
        let A = DMatrix::from_columns(&estimated.map(|j| {
            let h = if j < 4 { 1e-3 } else { 1e-6 };
            let moved = |h: f64| {
                let mut θ = θ;
                θ[j] += h;
                camera.with_intrinsics(&θ).unwrap()
            };
            slope(image(&moved(h), &X_CT), image(&moved(-h), &X_CT), h)
        }));
        let B = DMatrix::from_columns(&[0, 1, 2, 3, 4, 5].map(|j| {
            let h = 1e-6;
            let moved = |h: f64| {
                let mut ξ = Tangent::zeros();
                ξ[j] = h;
                perturb(&X_CT, &ξ)
            };
            slope(image(&camera, &moved(h)), image(&camera, &moved(-h)), h)
        }));
        let Q = B.qr().q();
        let definition = (A.transpose() * &A - A.transpose() * &Q * Q.transpose() * &A) / (0.3 * 0.3);
        let M = unpack(&measurement.information(&X_CT, &Corners::All).unwrap(), estimated.len());
        for i in 0..estimated.len() {
            for j in 0..estimated.len() {
                let scale = (definition[(i, i)] * definition[(j, j)]).sqrt();
                assert!((M[(i, j)] - definition[(i, j)]).abs() < 1e-5 * scale, "{i} {j}");
            }
        }
    }
}
