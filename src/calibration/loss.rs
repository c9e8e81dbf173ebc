//! Losses: how much a corner's residual counts.

/// The loss `ρ` of a corner's residual length `|r|`; the cost is the sum of `ρ` over the corners.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Loss {
    /// `|r|²`: least squares, the best for Gaussian noise without outliers.
    #[default]
    Squared,
    /// Quadratic up to `scale`, linear beyond (Huber 1964): `2·scale·|r| − scale²`.
    Huber {
        /// Where it turns linear, px; must be positive. A usual choice is 1.345 σ.
        scale: f64,
    },
    /// `scale²·ln(1 + |r|²/scale²)`: gross outliers hardly count.
    Cauchy {
        /// Where the pull of a corner is greatest, px; must be positive. A usual choice is 2.385 σ.
        scale: f64,
    },
}

impl Loss {
    /// `(ρ, w)` at the squared residual `r2` (px²): the loss in px² and its slope `w = dρ/d|r|²`, the weight of the
    /// corner in the normal equations.
    pub fn at(self, r2: f64) -> (f64, f64) {
        match self {
            Loss::Squared => (r2, 1.0),
            Loss::Huber { scale } => {
                let r = r2.sqrt();
                if r <= scale { (r2, 1.0) } else { (scale * (2.0 * r - scale), scale / r) }
            }
            Loss::Cauchy { scale } => {
                let s2 = scale * scale;
                (s2 * (r2 / s2).ln_1p(), s2 / (s2 + r2))
            }
        }
    }

    /// The scale, px, of the losses that have one.
    pub(super) fn scale(self) -> Option<f64> {
        match self {
            Loss::Squared => None,
            Loss::Huber { scale } | Loss::Cauchy { scale } => Some(scale),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_slopes_of_the_losses() {
        for loss in [Loss::Squared, Loss::Huber { scale: 0.7 }, Loss::Cauchy { scale: 0.7 }] {
            for r2 in [0.01, 0.3, 0.6, 2.0, 50.0] {
                let h = 1e-6 * r2;
                let slope = (loss.at(r2 + h).0 - loss.at(r2 - h).0) / (2.0 * h);
                assert!((slope - loss.at(r2).1).abs() < 1e-8, "{loss:?} at {r2}");
            }
        }
    }

    #[test]
    fn small_residuals_count_as_squares() {
        for loss in [Loss::Huber { scale: 1.0 }, Loss::Cauchy { scale: 1.0 }] {
            let (ρ, w) = loss.at(1e-6);
            assert!((ρ - 1e-6).abs() < 1e-12 && (w - 1.0).abs() < 1e-5);
        }
    }
}
