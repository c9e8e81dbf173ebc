//! The combination of the intrinsics that contributes most to the map error.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// What varies most, as the image shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Weakest {
    /// Its share of the mean squared map error.
    pub share: f64,
    /// By how much it changes each of the intrinsics together, at one standard deviation.
    pub change: DVector<f64>,
}

/// The direction in which errors of `covariance` (p×p) contribute most to the mean squared map error `tr(W · covariance)`;
/// `None` where that is zero or not finite.
///
/// With `covariance = L Lᵀ` it is `L u` for the eigenvector u of the greatest eigenvalue of `LᵀWL`; the eigenvalues add up to
/// the trace. L is found of the correlations, so that the units of the intrinsics do not matter.
pub fn weakest(covariance: &DMatrix<f64>, W: &DMatrix<f64>) -> Option<Weakest> {
    let p = covariance.nrows();
    let sigma = covariance.diagonal().map(f64::sqrt);
    let correlation = DMatrix::from_fn(p, p, |i, j| covariance[(i, j)] / (sigma[i] * sigma[j]));
    if !correlation.iter().all(|x| x.is_finite()) {
        return None;
    }
    let SymmetricEigen { mut eigenvectors, eigenvalues } = SymmetricEigen::new(correlation);
    for (mut vector, value) in eigenvectors.column_iter_mut().zip(eigenvalues.iter()) {
        vector *= value.max(0.0).sqrt();
    }
    let L = DMatrix::from_diagonal(&sigma) * eigenvectors;
    let eigen = SymmetricEigen::new(L.transpose() * W * &L);
    let (greatest, total) = (eigen.eigenvalues.imax(), eigen.eigenvalues.sum());
    let share = eigen.eigenvalues[greatest] / total;
    (share.is_finite() && total > 0.0).then(|| Weakest { share, change: L * eigen.eigenvectors.column(greatest) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_that_of_the_trace_and_no_direction_has_more() {
        let root = DMatrix::from_fn(4, 4, |i, j| [30.0, 1e-3, 2.0, 1e-6][i] * (1.0 + (i * 5 + j * 3) as f64).sin());
        let covariance = &root * root.transpose();
        let W = DMatrix::from_diagonal(&DVector::from_vec(vec![0.1, 1e7, 0.5, 1e12]));
        let found = weakest(&covariance, &W).unwrap();
        let trace = (&W * &covariance).trace();
        let shown = |change: &DVector<f64>| change.dot(&(&W * change)) / trace;
        assert!((shown(&found.change) - found.share).abs() < 1e-9);
        for i in 0..4 {
            // Columns of another root of the covariance.
            assert!(shown(&root.column(i).into()) <= found.share + 1e-12);
        }
        // One standard deviation: the ellipsoid's surface.
        let distance = found.change.dot(&covariance.lu().solve(&found.change).unwrap());
        assert!((distance - 1.0).abs() < 1e-6, "{distance}");
        assert_eq!(weakest(&DMatrix::zeros(2, 2), &DMatrix::identity(2, 2)), None);
        assert_eq!(weakest(&DMatrix::identity(2, 2), &DMatrix::zeros(2, 2)), None);
    }
}
