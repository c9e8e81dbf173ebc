//! Cholesky factors of the small matrices that a calibration solves by the thousand, in arrays of fixed size that the
//! compiler unrolls.

/// `L` of `M = L Lᵀ`; the reciprocal of its diagonal beside it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Factor<const N: usize> {
    L: [[f64; N]; N],
    reciprocal: [f64; N],
}

impl<const N: usize> Factor<N> {
    pub(super) const ZERO: Self = Self { L: [[0.0; N]; N], reciprocal: [0.0; N] };

    /// Factors the symmetric matrix with the upper triangle `upper`, each diagonal entry enlarged by the share `λ`;
    /// `None` where it is not positive definite to working accuracy.
    #[allow(clippy::needless_range_loop, reason = "the indices are the algorithm")]
    pub(super) fn of(upper: &[[f64; N]; N], λ: f64) -> Option<Self> {
        let mut factor = Self::ZERO;
        for j in 0..N {
            let diagonal = upper[j][j] * (1.0 + λ);
            let mut pivot = diagonal;
            for k in 0..j {
                pivot -= factor.L[j][k] * factor.L[j][k];
            }
            // What is left is rounding of what was there.
            if pivot.is_nan() || pivot <= 1e-15 * diagonal {
                return None;
            }
            let root = pivot.sqrt();
            factor.L[j][j] = root;
            factor.reciprocal[j] = 1.0 / root;
            for i in j + 1..N {
                let mut entry = upper[j][i];
                for k in 0..j {
                    entry -= factor.L[i][k] * factor.L[j][k];
                }
                factor.L[i][j] = entry * factor.reciprocal[j];
            }
        }
        Some(factor)
    }

    /// `L⁻¹ x`.
    pub(super) fn forward(&self, mut x: [f64; N]) -> [f64; N] {
        for i in 0..N {
            for k in 0..i {
                x[i] -= self.L[i][k] * x[k];
            }
            x[i] *= self.reciprocal[i];
        }
        x
    }

    /// `L⁻ᵀ x`.
    pub(super) fn backward(&self, mut x: [f64; N]) -> [f64; N] {
        for i in (0..N).rev() {
            for k in i + 1..N {
                x[i] -= self.L[k][i] * x[k];
            }
            x[i] *= self.reciprocal[i];
        }
        x
    }

    /// `M⁻¹ x`.
    pub(super) fn solve(&self, x: [f64; N]) -> [f64; N] {
        self.backward(self.forward(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_and_refuses() {
        let M = [[4.0, 2.0, 0.4], [f64::NAN, 3.0, -0.5], [f64::NAN, f64::NAN, 2.0]];
        let x = Factor::of(&M, 0.0).unwrap().solve([6.4, 4.5, 1.9]);
        assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-14), "{x:?}");
        let x = Factor::of(&M, 1.0).unwrap().solve([10.4, 7.5, 3.9]);
        assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-14), "{x:?}");
        assert!(Factor::of(&[[1.0, 2.0], [2.0, 4.0]], 0.0).is_none());
        assert!(Factor::of(&[[f64::NAN]], 0.0).is_none());
    }
}
