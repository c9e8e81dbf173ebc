//! Whether the views fix the intrinsics, and what they leave open where they do not.

use nalgebra::{DMatrix, SymmetricEigen, Vector3};

use super::CalibrationError;
use crate::camera::Camera;
use crate::spatial::Pose;

/// No detector places corners better than this, px; so that noise-free data of a degenerate set are refused as well.
const LEAST_NOISE: f64 = 0.01;

/// A focal length or principal point with a standard deviation beyond this share of the focal length is not known.
const LARGEST_DEVIATION: f64 = 0.25;

/// Below this share of a parameter's information left by the others, it is theirs but for rounding.
const LEAST_SHARE: f64 = 1e-14;

/// Boards within this angle count as parallel where the focal length is open, rad: noise alone tilts a frontal board by
/// many degrees.
const PARALLEL: f64 = 0.35;

/// `S⁻¹` for the information `S` of the `estimated` intrinsics (per unit of pixel noise).
///
/// # Errors
/// [`CalibrationError::ParallelBoards`] or [`CalibrationError::Unobservable`] where `S` is singular but for rounding,
/// or leaves fx, fy, cx or cy open by more than a quarter of the focal length at pixel noise `sigma`.
pub(super) fn inverse_information(
    S: &DMatrix<f64>,
    estimated: &[usize],
    camera: &Camera,
    poses: &[Pose],
    sigma: f64,
) -> Result<DMatrix<f64>, CalibrationError> {
    let θ = camera.intrinsics();
    // Comparisons with NaN are false, so that it is not known.
    let known = |inverse: &DMatrix<f64>| {
        estimated.iter().enumerate().all(|(i, &j)| {
            let share = 1.0 / (S[(i, i)] * inverse[(i, i)]);
            let deviation = sigma.max(LEAST_NOISE) * inverse[(i, i)].sqrt();
            share > LEAST_SHARE && (j >= 4 || deviation < LARGEST_DEVIATION * θ[j % 2])
        })
    };
    // Scaled to a unit diagonal: pixels and dimensionless coefficients differ by orders.
    let scale = S.diagonal().map(|d| 1.0 / d.sqrt());
    let scaled = DMatrix::from_fn(S.nrows(), S.ncols(), |i, j| S[(i, j)] * scale[i] * scale[j]);
    let inverse = scaled.clone().cholesky().map(|c| {
        let inverse = c.inverse();
        DMatrix::from_fn(S.nrows(), S.ncols(), |i, j| inverse[(i, j)] * scale[i] * scale[j])
    });
    match inverse {
        Some(inverse) if known(&inverse) => Ok(inverse),
        _ => Err(degeneracy(&scaled, estimated, camera, poses)),
    }
}

fn degeneracy(scaled: &DMatrix<f64>, estimated: &[usize], camera: &Camera, poses: &[Pose]) -> CalibrationError {
    let normals: Vec<Vector3<f64>> = poses.iter().map(|X_CT| X_CT.rotation * Vector3::z()).collect();
    let largest_angle = normals
        .iter()
        .enumerate()
        .flat_map(|(i, a)| normals[i + 1..].iter().map(|b| a.cross(b).norm().atan2(a.dot(b).abs())))
        .fold(0.0, f64::max);
    let seeks_focal_length = estimated.iter().any(|&j| j < 2);
    if seeks_focal_length && largest_angle < PARALLEL {
        return CalibrationError::ParallelBoards { largest_angle };
    }
    if scaled.iter().any(|x| !x.is_finite()) {
        // A parameter without any influence on the pixels.
        let names = camera.lens().parameter_names();
        let silent = estimated.iter().enumerate().filter(|&(i, _)| !scaled[(i, i)].is_finite());
        return CalibrationError::Unobservable { combination: silent.map(|(_, &j)| (names[j], 1.0)).collect() };
    }
    let eigen = SymmetricEigen::new(scaled.clone());
    let (least, _) = eigen.eigenvalues.argmin();
    let direction = eigen.eigenvectors.column(least);
    let largest = direction.amax();
    let named = estimated.iter().zip(direction.iter()).filter(|(_, share)| share.abs() > 0.1 * largest);
    let combination = named.map(|(&j, &share)| (camera.lens().parameter_names()[j], share)).collect();
    CalibrationError::Unobservable { combination }
}
