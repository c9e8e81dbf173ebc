//! Information of one view of the board.

use nalgebra::{DMatrix, Matrix2x6, Matrix3, Point3, SMatrix, Vector3};
use rayon::prelude::*;

use super::elimination::{Elimination, MOST_COLUMNS, POSE};
use super::{Noise, Unknowns, Whitening};
use crate::camera::IntrinsicsJacobian;
use crate::selection::InformationSet;
use crate::selection::packed::{inverse, packed_len};
use crate::spatial::Pose;
use crate::target::{Board, Corners, Feature, Warp};

/// What is observed, how well, and what is to be learnt from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement<'a> {
    /// The nominal camera and the intrinsics to estimate.
    pub unknowns: Unknowns<'a>,
    /// All corners of the board, in T (m).
    pub corners: Vec<Point3<f64>>,
    /// What each of them is.
    pub features: Vec<Feature>,
    /// How far they scatter.
    pub noise: Noise,
    /// How the board may bulge. Its heights are estimated too, of all views together: where it is given, the information is of
    /// them and of the intrinsics, in this order.
    pub warp: Option<Warp>,
    /// Pictures that a view is of: so many times as much is known of it.
    pub pictures: usize,
}

/// A corner's pixel by what it depends on.
pub(super) struct Derivatives {
    pub(super) by_intrinsics: IntrinsicsJacobian,
    /// By `(ω, v)`.
    pub(super) by_pose: Matrix2x6<f64>,
    /// By the board's heights; zero where it is flat.
    pub(super) by_heights: SMatrix<f64, 2, { Warp::HEIGHTS }>,
    pub(super) whitening: Whitening,
}

impl<'a> Measurement<'a> {
    /// Of a board's corners.
    pub fn new(unknowns: Unknowns<'a>, board: &Board, noise: Noise) -> Self {
        let features = (0..board.corner_count()).map(|i| board.feature(i)).collect();
        Self { unknowns, corners: board.corners().collect(), features, noise, warp: None, pictures: 1 }
    }

    /// How many numbers are estimated of all views together beside the intrinsics, and before them in all rows and columns: the
    /// board's heights.
    pub fn nuisance(&self) -> usize {
        if self.warp.is_some() { Warp::HEIGHTS } else { 0 }
    }

    /// The order of its matrices: the nuisance and the intrinsics.
    pub fn order(&self) -> usize {
        self.nuisance() + self.unknowns.len()
    }

    /// Covariance of the p intrinsics, p×p, by information on all that is estimated of all views together; `None` if it leaves
    /// something open.
    pub fn covariance(&self, information: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let (first, p) = (self.nuisance(), self.unknowns.len());
        Some(inverse(information)?.view((first, first), (p, p)).into_owned())
    }

    /// Information that the view of the corners `seen` from `X_CT` gives on the p estimated intrinsics, and before them on the
    /// heights of a board that may bulge, once the view's own pose is eliminated, packed: the Schur complement
    /// `(AᵀA − AᵀB (BᵀB)⁻¹ BᵀA) / σ²` of the normal matrix, where A (2m × [order](Self::order)) and B (2m×6) are the residual
    /// Jacobians by what is estimated and by the pose, whitened by the corners' covariances.
    ///
    /// `None` if a corner has no image or the corners do not determine the pose.
    pub(crate) fn information(&self, X_CT: &Pose, seen: &Corners) -> Option<Vec<f64>> {
        let mut elimination = Elimination::new(self.order());
        match seen {
            Corners::All => self.add(&mut elimination, X_CT, 0..self.corners.len()),
            Corners::Some(indices) => self.add(&mut elimination, X_CT, indices.iter().copied()),
        }?;
        let scale = self.scale();
        let mut information = elimination.finish()?;
        for entry in &mut information {
            *entry *= scale;
        }
        Some(information)
    }

    /// What the sum of squares of whitened rows is multiplied by: the pictures over σ².
    pub(crate) fn scale(&self) -> f64 {
        self.pictures as f64 / (self.noise.sigma * self.noise.sigma)
    }

    /// Adds the rows of the corners with those indices; `None` if one has no image.
    fn add(&self, elimination: &mut Elimination, X_CT: &Pose, corners: impl Iterator<Item = usize>) -> Option<()> {
        let R = X_CT.rotation.to_rotation_matrix().into_inner();
        for i in corners {
            let Derivatives { by_intrinsics, by_pose, by_heights, whitening } =
                self.derivatives(i, &R, &X_CT.translation.vector)?;
            let [mut u, mut v] = [[0.0; MOST_COLUMNS]; 2];
            for j in 0..POSE {
                [u[j], v[j]] = whitening.whitened(by_pose.column(j).into());
            }
            let nuisance = self.nuisance();
            for j in 0..nuisance {
                [u[POSE + j], v[POSE + j]] = whitening.whitened(by_heights.column(j).into());
            }
            for (j, &parameter) in self.unknowns.estimated.iter().enumerate() {
                let j = nuisance + j;
                [u[POSE + j], v[POSE + j]] = whitening.whitened(by_intrinsics.column(parameter).into());
            }
            elimination.add(&u);
            elimination.add(&v);
        }
        Some(())
    }

    /// The derivatives of a corner's pixel by its index, seen from `X_CT = (R, t)`; `None` if it has no image.
    #[inline]
    pub(super) fn derivatives(&self, i: usize, R: &Matrix3<f64>, t: &Vector3<f64>) -> Option<Derivatives> {
        // The pose is perturbed about the board's centre (see `spatial::perturb`).
        let arm = R * self.corners[i].coords;
        let (camera, p_C) = (self.unknowns.camera, Point3::from(arm + t));
        let projection = camera.project_with_derivatives(&p_C)?;
        let mut by_pose = Matrix2x6::zeros();
        for (row, by_point) in projection.by_point.row_iter().enumerate() {
            // −aᵀ[arm]× = (arm × a)ᵀ.
            by_pose.fixed_view_mut::<1, 3>(row, 0).copy_from(&arm.cross(&by_point.transpose()).transpose());
            by_pose.fixed_view_mut::<1, 3>(row, 3).copy_from(&by_point);
        }
        let vergence = camera.vergence(&p_C);
        let whitening = self.noise.model.whitening_in_view(&self.features[i], &projection.by_point, R, vergence);
        let mut by_heights = SMatrix::<f64, 2, { Warp::HEIGHTS }>::zeros();
        if let Some(warp) = &self.warp {
            let up = projection.by_point * R.column(2);
            for (mut column, rise) in by_heights.column_iter_mut().zip(warp.rises(&self.corners[i].coords.xy())) {
                column.copy_from(&(up * rise));
            }
        }
        Some(Derivatives { by_intrinsics: projection.by_intrinsics, by_pose, by_heights, whitening })
    }

    /// Information of many views, each from its `X_CT` and of the corners seen, in their order; `None` as for one.
    pub fn information_set<'b>(
        &self,
        views: impl IntoParallelIterator<Item = (&'b Pose, &'b Corners), Iter: IndexedParallelIterator>,
    ) -> Option<InformationSet> {
        let views = views.into_par_iter();
        let length = packed_len(self.order());
        // Straight into the table: of a million views there is no room for two.
        let mut table = vec![0.0; views.len() * length];
        table.par_chunks_exact_mut(length).zip(views).with_min_len(32).try_for_each(|(row, (X_CT, seen))| {
            row.copy_from_slice(&self.information(X_CT, seen)?);
            Some(())
        })?;
        InformationSet::from_packed_unchecked(self.order(), table).ok()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, Vector3};

    use super::*;
    use crate::camera::{Camera, Lens};
    use crate::information::NoiseModel;
    use crate::selection::packed::unpack;
    use crate::spatial::{Tangent, perturb, skew};
    use crate::target::Surface;

    const NOISE: Noise = Noise { sigma: 0.3, model: NoiseModel::Constant };

    /// Against the definition: Jacobians by central differences, the pose projected out with a thin QR.
    #[test]
    fn information_equals_its_definition_by_finite_differences() {
        let θ = [1000.0, 990.0, 640.0, 360.0, -0.2, 0.05, 1e-3, -1e-3, 0.01];
        let camera = Camera::new(Lens::BrownConrady, 1280, 720, &θ).unwrap();
        let board = Board::checkerboard(8, 6, 0.035);
        let corners: Vec<_> = board.corners().collect();
        let X_CT = Pose::new(Vector3::new(0.05, -0.03, 0.6), Vector3::new(2.8, 0.2, -0.3));
        let estimated = [0, 1, 2, 3, 4, 5, 8];
        let unknowns = Unknowns { camera: &camera, estimated: &estimated };
        let warp = Warp::new(1e-3, &board);
        let measurement = Measurement { warp: Some(warp), ..Measurement::new(unknowns, &board, NOISE) };
        let image_of = |camera: &Camera, X_CT: &Pose, heights: [f64; 2]| -> Vec<f64> {
            let surface = Surface::new(warp, heights);
            let pixel = |p: &Point3<f64>| camera.project(&(X_CT * surface.point(&p.coords.xy()))).unwrap().data.0[0];
            corners.iter().flat_map(pixel).collect()
        };
        let image = |camera: &Camera, X_CT: &Pose| image_of(camera, X_CT, [0.0; 2]);
        let slope = |plus: Vec<f64>, minus: Vec<f64>, h: f64| {
            nalgebra::DVector::from_iterator(plus.len(), plus.iter().zip(&minus).map(|(a, b)| (a - b) / (2.0 * h)))
        };
        let heights = [[1.0, 0.0], [0.0, 1.0]].map(|unit| {
            let moved = |h: f64| image_of(&camera, &X_CT, unit.map(|entry| h * entry));
            slope(moved(1e-3), moved(-1e-3), 1e-3)
        });
        let intrinsics = estimated.map(|j| {
            let h = if j < 4 { 1e-3 } else { 1e-6 };
            let moved = |h: f64| {
                let mut θ = θ;
                θ[j] += h;
                camera.with_intrinsics(&θ).unwrap()
            };
            slope(image(&moved(h), &X_CT), image(&moved(-h), &X_CT), h)
        });
        let A = DMatrix::from_columns(&[heights.as_slice(), &intrinsics].concat());
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
        // Of a flat board the intrinsics' part of it.
        let flat = Measurement::new(unknowns, &board, NOISE);
        for (measurement, first) in [(measurement, 0), (flat, 2)] {
            let p = measurement.order();
            let M = unpack(&measurement.information(&X_CT, &Corners::All).unwrap(), p);
            let definition = definition.view((first, first), (p, p));
            for (i, j) in (0..p).flat_map(|i| (0..p).map(move |j| (i, j))) {
                let scale = (definition[(i, i)] * definition[(j, j)]).sqrt();
                assert!((M[(i, j)] - definition[(i, j)]).abs() < 1e-5 * scale, "{i} {j}");
            }
        }
    }

    /// They leave the turn about their line open.
    #[test]
    fn corners_on_a_line_determine_no_pose() {
        let camera = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 1000.0, 639.5, 359.5]).unwrap();
        let X_CT = Pose::new(Vector3::new(0.05, -0.03, 0.6), Vector3::new(2.8, 0.2, -0.3));
        for (columns, rows, determined) in [(8, 2, true), (8, 1, false), (1, 6, false)] {
            let board = Board::checkerboard(columns, rows, 0.035);
            let unknowns = Unknowns { camera: &camera, estimated: &[0, 1] };
            let measurement = Measurement::new(unknowns, &board, NOISE);
            assert_eq!(measurement.information(&X_CT, &Corners::All).is_some(), determined, "{columns} × {rows}");
        }
    }

    /// A lens so long that the squares of what the pose explains outweigh the information by eight digits.
    #[test]
    fn a_long_lens_keeps_its_digits() {
        let θ = [20_000.0, 20_000.0, 640.0, 360.0, -0.2, 0.05, 1e-3, -1e-3, 0.01];
        let camera = Camera::new(Lens::BrownConrady, 1280, 720, &θ).unwrap();
        let board = Board::checkerboard(8, 6, 0.003);
        let corners: Vec<_> = board.corners().collect();
        let estimated = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        let unknowns = Unknowns { camera: &camera, estimated: &estimated };
        let measurement = Measurement::new(unknowns, &board, NOISE);
        let X_CT = Pose::new(Vector3::new(0.001, -0.002, 0.8), Vector3::new(2.7, 0.3, -0.4));
        let mut J = DMatrix::zeros(2 * corners.len(), POSE + 9);
        for (c, corner) in corners.iter().enumerate() {
            let projection = camera.project_with_derivatives(&(X_CT * corner)).unwrap();
            let turned = -projection.by_point * skew(&(X_CT.rotation * corner.coords));
            J.view_mut((2 * c, 0), (2, 3)).copy_from(&turned);
            J.view_mut((2 * c, 3), (2, 3)).copy_from(&projection.by_point);
            for j in 0..9 {
                J.view_mut((2 * c, POSE + j), (2, 1)).copy_from(&projection.by_intrinsics.column(j));
            }
        }
        let R = J.clone().qr().r();
        let root = R.view((POSE, POSE), (9, 9)).into_owned() / 0.3;
        let expected = root.transpose() * &root;
        let outweighed =
            (0..9).map(|j| J.column(POSE + j).norm_squared() / (0.09 * expected[(j, j)])).fold(0.0, f64::max);
        assert!(outweighed > 1e8, "{outweighed:e}");
        let M = unpack(&measurement.information(&X_CT, &Corners::All).unwrap(), 9);
        for i in 0..9 {
            for j in 0..9 {
                let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                assert!((M[(i, j)] - expected[(i, j)]).abs() < 1e-9 * scale, "{i} {j}");
            }
        }
    }
}
