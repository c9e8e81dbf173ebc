//! Information of one view of the board.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

use nalgebra::{DMatrix, Matrix3, Point3, Vector3};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::elimination::{Elimination, LANES, MOST_COLUMNS, POSE};
use super::noise::Kind;
use super::{Noise, Unknowns, Whitening};
use crate::camera::{Image, MAX_INTRINSICS};
use crate::lanes::{Lanes, Number};
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
    /// What each of them is; all of one kind, as those of a board are.
    pub features: Vec<Feature>,
    /// How far they scatter.
    pub noise: Noise,
    /// How the board may bulge. Its heights are estimated too, of all views together: where it is given, the information is of
    /// them and of the intrinsics, in this order.
    pub warp: Option<Warp>,
    /// Pictures that a view is of: so many times as much is known of it.
    pub pictures: usize,
}

/// A corner's pixel by what it depends on, or several corners' pixels: columns of two rows.
pub(super) struct Derivatives<N> {
    pub(super) by_intrinsics: [[N; 2]; MAX_INTRINSICS],
    /// By `(ω, v)`.
    pub(super) by_pose: [[N; 2]; POSE],
    /// By the board's heights; zero where it is flat.
    pub(super) by_heights: [[N; 2]; Warp::HEIGHTS],
    pub(super) whitening: Whitening<N>,
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
        let corner_count = match seen {
            Corners::All => self.corners.len(),
            Corners::Some(indices) => indices.len(),
        };
        let mut elimination = Elimination::new(self.order());
        Arch::new().dispatch(Rows { measurement: self, X_CT, seen, corner_count, elimination: &mut elimination })?;
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

    /// The derivatives of a corner's pixel by its index, seen from `X_CT = (R, t)`; `None` if it has no image.
    pub(super) fn derivatives(&self, i: usize, R: &Matrix3<f64>, t: &Vector3<f64>) -> Option<Derivatives<f64>> {
        self.derivatives_of(self.corners[i].coords.into(), &Kind::from(&self.features[i]), R, t)
    }

    /// The same of one point on the board or of several, and of what they are.
    #[inline(always)]
    fn derivatives_of<N: Number>(
        &self,
        p_T: [N; 3],
        kind: &Kind<N>,
        R: &Matrix3<f64>,
        t: &Vector3<f64>,
    ) -> Option<Derivatives<N>> {
        let along = |row: [N; 3], c: usize| row[0] * R[(0, c)] + row[1] * R[(1, c)] + row[2] * R[(2, c)];
        // The pose is perturbed about the board's centre (see `spatial::perturb`).
        let arm: [N; 3] = std::array::from_fn(|r| p_T[0] * R[(r, 0)] + p_T[1] * R[(r, 1)] + p_T[2] * R[(r, 2)]);
        let p_C: [N; 3] = std::array::from_fn(|r| arm[r] + N::all(t[r]));
        let camera = self.unknowns.camera;
        let Image { by_point, by_intrinsics, .. } = camera.image(p_C)?;
        // −aᵀ[arm]× = (arm × a)ᵀ.
        let turned = by_point
            .map(|a| [arm[1] * a[2] - arm[2] * a[1], arm[2] * a[0] - arm[0] * a[2], arm[0] * a[1] - arm[1] * a[0]]);
        let column = |rows: &[[N; 3]; 2], c: usize| [rows[0][c], rows[1][c]];
        let by_pose = std::array::from_fn(|c| if c < 3 { column(&turned, c) } else { column(&by_point, c - 3) });
        let by_place = by_point.map(|row| [along(row, 0), along(row, 1)]);
        let whitening = self.noise.model.whitening_of(kind, &by_place, camera.vergence_of(p_C));
        let by_heights = match &self.warp {
            Some(warp) => {
                let up = by_point.map(|row| along(row, 2));
                warp.rises_of([p_T[0], p_T[1]]).map(|rise| up.map(|entry| entry * rise))
            }
            None => [[N::all(0.0); 2]; Warp::HEIGHTS],
        };
        Some(Derivatives { by_intrinsics, by_pose, by_heights, whitening })
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

/// Adds the rows of the corners `seen`; `None` if one has no image. Compiled for every set of instructions that [`Arch`] tells apart.
struct Rows<'a, 'b> {
    measurement: &'b Measurement<'a>,
    X_CT: &'b Pose,
    seen: &'b Corners,
    corner_count: usize,
    elimination: &'b mut Elimination,
}

impl WithSimd for Rows<'_, '_> {
    type Output = Option<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Option<()> {
        let Self { measurement, X_CT, seen, corner_count, elimination } = self;
        let (R, t) = (X_CT.rotation.to_rotation_matrix().into_inner(), X_CT.translation.vector);
        let nuisance = measurement.nuisance();
        for first in (0..corner_count).step_by(LANES) {
            let count = LANES.min(corner_count - first);
            // The last corner in what is left of the lanes.
            let indices: [usize; LANES] = std::array::from_fn(|lane| {
                let at = first + lane.min(count - 1);
                match seen {
                    Corners::All => at,
                    Corners::Some(indices) => indices[at],
                }
            });
            let p_T = std::array::from_fn(|axis| Lanes(indices.map(|i| measurement.corners[i][axis])));
            let kind = Kind::of_all(indices.map(|i| &measurement.features[i]))?;
            let Derivatives { by_intrinsics, by_pose, by_heights, whitening } =
                measurement.derivatives_of(p_T, &kind, &R, &t)?;
            let mut rows = [[Lanes::ZERO; 2]; MOST_COLUMNS];
            for (row, by_pose) in rows.iter_mut().zip(by_pose) {
                *row = whitening.whitened(by_pose);
            }
            for (row, by_height) in rows[POSE..].iter_mut().zip(&by_heights[..nuisance]) {
                *row = whitening.whitened(*by_height);
            }
            for (row, &parameter) in rows[POSE + nuisance..].iter_mut().zip(measurement.unknowns.estimated) {
                *row = whitening.whitened(by_intrinsics[parameter]);
            }
            elimination.add(&rows, count);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, Vector3};

    use super::*;
    use crate::camera::{Camera, Lens};
    use crate::information::{Blur, NoiseModel};
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

    /// However many there are, through every lens, and whatever they are.
    #[test]
    fn corners_side_by_side_tell_what_each_of_them_tells() {
        let board = Board::checkerboard(9, 7, 0.03);
        let X_CT = Pose::new(Vector3::new(0.05, -0.03, 0.6), Vector3::new(2.8, 0.2, -0.3));
        let (R, t) = (X_CT.rotation.to_rotation_matrix().into_inner(), X_CT.translation.vector);
        let blur = Blur { focal_length: 1000.0, aperture: 0.002, focus: 1.0, turning: 1e-3, moving: 0.0 };
        let noise = Noise { sigma: 0.3, model: NoiseModel::Edges { window: 5.0, blur } };
        let estimated = [0, 1, 2, 3];
        for lens in Lens::ALL {
            let camera =
                Camera::new(lens, 1280, 720, &[&[1000.0, 990.0, 640.0, 360.0], lens.typical()].concat()).unwrap();
            let unknowns = Unknowns { camera: &camera, estimated: &estimated };
            let warp = Some(Warp::new(1e-3, &board));
            let mut measurement = Measurement { warp, ..Measurement::new(unknowns, &board, noise) };
            let p = measurement.order();
            for feature in [board.feature(0), Feature::Circle { radius: 0.01 }, Feature::Point] {
                measurement.features = vec![feature; measurement.corners.len()];
                for count in [9, 16, 21, 63] {
                    let seen: Vec<usize> = (0..count).map(|c| c * 11 % 63).collect();
                    let mut J = DMatrix::zeros(2 * count, POSE + p);
                    for (c, &i) in seen.iter().enumerate() {
                        let Derivatives { by_intrinsics, by_pose, by_heights, whitening } =
                            measurement.derivatives(i, &R, &t).unwrap();
                        let columns = by_pose.iter().chain(&by_heights).chain(&by_intrinsics[..4]);
                        for (j, &column) in columns.enumerate() {
                            J.view_mut((2 * c, j), (2, 1)).copy_from_slice(&whitening.whitened(column));
                        }
                    }
                    let root = J.qr().r().view((POSE, POSE), (p, p)).into_owned();
                    let expected = root.transpose() * root * measurement.scale();
                    let seen = if count == 63 { Corners::All } else { Corners::Some(seen) };
                    let M = unpack(&measurement.information(&X_CT, &seen).unwrap(), p);
                    for (i, j) in (0..p).flat_map(|i| (0..p).map(move |j| (i, j))) {
                        let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                        let off = (M[(i, j)] - expected[(i, j)]).abs();
                        assert!(off < 1e-8 * scale, "{lens:?} {feature:?} {count} {i} {j}: {off} {scale}");
                    }
                }
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
