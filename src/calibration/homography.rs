//! Plane-to-plane homographies by the normalised direct linear transform (Hartley & Zisserman, alg. 4.2).

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Vector2, Vector3};

/// The homography `H` with `(x, y, 1) ~ H (X, Y, 1)` that takes the points `from` to the points `to`, in least
/// squares of the algebraic error; `None` when the points fix none.
///
/// In coordinates centred on both point sets, `h₃₃` is the depth of the board's middle and cannot vanish, so it is
/// set to 1. The normal matrix of the other eight entries is an arrow: `h₃₁` and `h₃₂` follow from a 2×2 system,
/// then the first two rows from 3×3 ones.
pub fn homography(from: &[Vector2<f64>], to: &[Vector2<f64>]) -> Option<Matrix3<f64>> {
    let (N_from, N_to) = (Normalisation::of(from)?, Normalisation::of(to)?);
    // Q = Σ q qᵀ with q = (X, Y, 1); E_u = Σ u q (X, Y), E_v alike; b_u = Σ u q; C = Σ (u² + v²)(X, Y)(X, Y)ᵀ.
    let mut Q = Matrix3::zeros();
    let (mut E_u, mut E_v) = (Matrix3x2::zeros(), Matrix3x2::zeros());
    let (mut b_u, mut b_v) = (Vector3::zeros(), Vector3::zeros());
    let (mut C, mut c) = (Matrix2::zeros(), Vector2::zeros());
    for (X, x) in from.iter().zip(to) {
        let (X, x) = (N_from.apply(X), N_to.apply(x));
        let q = X.push(1.0);
        let outer = q * X.transpose();
        Q += q * q.transpose();
        E_u += outer * x.x;
        E_v += outer * x.y;
        b_u += q * x.x;
        b_v += q * x.y;
        C += X * X.transpose() * x.norm_squared();
        c -= X * x.norm_squared();
    }
    let Q = Q.cholesky()?;
    let (F_u, F_v) = (Q.solve(&E_u), Q.solve(&E_v));
    let reduced = C - E_u.transpose() * F_u - E_v.transpose() * F_v;
    let h_3 = reduced.cholesky()?.solve(&(c + F_u.transpose() * b_u + F_v.transpose() * b_v));
    let h_1 = Q.solve(&b_u) + F_u * h_3;
    let h_2 = Q.solve(&b_v) + F_v * h_3;
    let H = Matrix3::from_rows(&[h_1.transpose(), h_2.transpose(), h_3.push(1.0).transpose()]);
    let H = N_to.inverse_matrix() * H * N_from.matrix();
    H.iter().all(|h| h.is_finite()).then_some(H)
}

/// Moves the points' mean to the origin and their mean distance from it to √2.
struct Normalisation {
    mean: Vector2<f64>,
    scale: f64,
}

impl Normalisation {
    fn of(points: &[Vector2<f64>]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = points.iter().sum::<Vector2<f64>>() / count;
        let spread = points.iter().map(|p| (p - mean).norm()).sum::<f64>() / count;
        (points.len() >= 4 && spread > 0.0).then(|| Self { mean, scale: std::f64::consts::SQRT_2 / spread })
    }

    fn apply(&self, p: &Vector2<f64>) -> Vector2<f64> {
        (p - self.mean) * self.scale
    }

    fn matrix(&self) -> Matrix3<f64> {
        let (s, m) = (self.scale, self.mean);
        Matrix3::new(s, 0.0, -s * m.x, 0.0, s, -s * m.y, 0.0, 0.0, 1.0)
    }

    fn inverse_matrix(&self) -> Matrix3<f64> {
        let (s, m) = (self.scale, self.mean);
        Matrix3::new(1.0 / s, 0.0, m.x, 0.0, 1.0 / s, m.y, 0.0, 0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Vec<Vector2<f64>> {
        (0..20).map(|i| Vector2::new(f64::from(i % 5) * 0.03, f64::from(i / 5) * 0.03)).collect()
    }

    fn map(H: &Matrix3<f64>, p: &Vector2<f64>) -> Vector2<f64> {
        let q = H * p.push(1.0);
        q.xy() / q.z
    }

    #[test]
    fn exact_points_give_back_the_homography() {
        let H = Matrix3::new(3000.0, -400.0, 500.0, 250.0, 2800.0, 300.0, 0.9, -0.6, 1.0);
        let image: Vec<_> = grid().iter().map(|p| map(&H, p)).collect();
        let found = homography(&grid(), &image).unwrap();
        assert!((found / found[(2, 2)] - H).norm() < 1e-9 * H.norm());
        // Four corners of it are enough.
        let four = [0, 4, 15, 19];
        let found = homography(&four.map(|i| grid()[i]), &four.map(|i| image[i])).unwrap();
        assert!((found / found[(2, 2)] - H).norm() < 1e-9 * H.norm());
    }

    #[test]
    fn points_on_a_line_fix_no_homography() {
        let line: Vec<_> = (0..6).map(|i| Vector2::new(f64::from(i), 2.0 * f64::from(i))).collect();
        assert!(homography(&line, &grid()[..6]).is_none());
        assert!(homography(&[Vector2::zeros(); 5], &grid()[..5]).is_none());
    }
}
