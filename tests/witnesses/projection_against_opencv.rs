//! Projection, its derivatives and the information of a view are those of OpenCV.
//!
//! The golden file is written by the script beside it. It cannot tell whether OpenCV's models fit a real lens.

use calipose::camera::{Camera, Lens};
use calipose::information::{Measurement, Noise, NoiseModel, Unknowns};
use calipose::spatial::{Pose, skew};
use calipose::target::{Board, Corners};
use nalgebra::{DMatrix, DVector, Matrix3, Point3, UnitQuaternion, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Golden {
    sigma_px: f64,
    columns: usize,
    rows: usize,
    square_m: f64,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    lens: String,
    width: u32,
    height: u32,
    intrinsics: Vec<f64>,
    rvec: [f64; 3],
    tvec: [f64; 3],
    points: Vec<[f64; 3]>,
    pixels: Vec<[f64; 2]>,
    by_intrinsics: Vec<Vec<f64>>,
    by_pose: Vec<Vec<f64>>,
    information: Vec<Vec<f64>>,
}

fn golden() -> Golden {
    let golden: Golden = serde_json::from_str(include_str!("../golden/opencv_projection.json")).unwrap();
    for lens in Lens::ALL {
        assert!(golden.cases.iter().filter(|case| case.lens == lens.name()).count() >= 10, "{}", lens.name());
    }
    golden
}

impl Case {
    fn camera(&self) -> Camera {
        let lens = Lens::ALL.into_iter().find(|lens| lens.name() == self.lens).unwrap();
        Camera::new(lens, self.width, self.height, &self.intrinsics).unwrap()
    }

    fn X_CT(&self) -> Pose {
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(self.rvec));
        Pose::from_parts(Vector3::from(self.tvec).into(), rotation)
    }
}

fn matrix(rows: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// `∂ω/∂r` where `exp([r + dr]×) = exp([ω]×) exp([r]×)`: the left Jacobian of the rotation vector.
fn left_jacobian(r: &Vector3<f64>) -> Matrix3<f64> {
    let (θ, K) = (r.norm(), skew(r));
    Matrix3::identity() + K * ((1.0 - θ.cos()) / (θ * θ)) + K * K * ((θ - θ.sin()) / θ.powi(3))
}

/// Every entry to 10⁻⁹ of its row's or its column's largest, whichever is less.
fn assert_equal(ours: &DMatrix<f64>, theirs: &DMatrix<f64>, what: &str) {
    assert_eq!(ours.shape(), theirs.shape(), "{what}");
    for i in 0..theirs.nrows() {
        for j in 0..theirs.ncols() {
            let scale = theirs.row(i).amax().min(theirs.column(j).amax());
            let difference = (ours[(i, j)] - theirs[(i, j)]).abs();
            assert!(difference <= 1e-9 * scale, "{what} ({i}, {j}): {} and {}", ours[(i, j)], theirs[(i, j)]);
        }
    }
}

#[test]
fn pixels_and_derivatives() {
    for (number, case) in golden().cases.iter().enumerate() {
        let (camera, X_CT) = (case.camera(), case.X_CT());
        let p = case.intrinsics.len();
        let by_rvec = left_jacobian(&Vector3::from(case.rvec));
        let mut by_intrinsics = DMatrix::zeros(2 * case.points.len(), p);
        let mut by_pose = DMatrix::zeros(2 * case.points.len(), 6);
        for (i, (&point, &pixel)) in case.points.iter().zip(&case.pixels).enumerate() {
            let p_C = X_CT * Point3::from(point);
            let projection = camera.project_with_derivatives(&p_C).unwrap();
            for found in [projection.pixel, camera.project(&p_C).unwrap()] {
                let expected = DVector::from_row_slice(&pixel);
                assert!((found - &expected).amax() <= 1e-9 * expected.amax(), "case {number}, point {i}");
            }
            by_intrinsics.view_mut((2 * i, 0), (2, p)).copy_from(&projection.by_intrinsics.columns(0, p));
            let arm = X_CT.rotation * Vector3::from(point);
            by_pose.view_mut((2 * i, 0), (2, 3)).copy_from(&(-projection.by_point * skew(&arm) * by_rvec));
            by_pose.view_mut((2 * i, 3), (2, 3)).copy_from(&projection.by_point);
        }
        let what = |of: &str| format!("case {number} ({}), {of}", case.lens);
        assert_equal(&by_intrinsics, &matrix(&case.by_intrinsics), &what("by intrinsics"));
        assert_equal(&by_pose, &matrix(&case.by_pose), &what("by pose"));
    }
}

/// Against the definition, `(AᵀA − AᵀQQᵀA) / σ²`, by OpenCV's Jacobians and a thin QR.
#[test]
fn information_of_a_view() {
    let golden = golden();
    let board = Board::checkerboard(golden.columns, golden.rows, golden.square_m);
    let noise = Noise { sigma: golden.sigma_px, model: NoiseModel::Constant };
    for (number, case) in golden.cases.iter().enumerate() {
        let camera = case.camera();
        let estimated: Vec<usize> = (0..case.intrinsics.len()).collect();
        let measurement = Measurement::new(Unknowns { camera: &camera, estimated: &estimated }, &board, noise);
        let X_CT = case.X_CT();
        let views = measurement.information_set([(&X_CT, &Corners::All)]).unwrap();
        let M = views.matrix(0).unwrap();
        let expected = matrix(&case.information);
        for i in 0..estimated.len() {
            for j in 0..estimated.len() {
                let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                let difference = (M[(i, j)] - expected[(i, j)]).abs();
                assert!(difference <= 1e-6 * scale, "case {number} ({}), entry ({i}, {j})", case.lens);
            }
        }
    }
}
