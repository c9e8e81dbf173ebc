//! A smooth concave stand-in for the least of several numbers.

/// The soft minimum of m positive numbers xᵢ at softness ε:
///
/// ```text
/// log φ = max over 0 < t < min x of  (1 − ε) log t + (ε/m) Σ log(xᵢ − t)
/// ```
///
/// It is homogeneous of degree one and concave, and composed with concave functions it stays so. At ε = 1 it is the
/// geometric mean; as ε → 0 its maximiser t tends to the least number: the central path of an interior-point method.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SoftMinimum {
    /// log φ.
    pub(crate) log_value: f64,
    /// The maximiser.
    pub(crate) t: f64,
    /// `xᵢ − t`.
    pub(crate) gaps: Vec<f64>,
    /// `(ε/m) / (xᵢ − t)`: the derivatives of log φ by xᵢ.
    pub(crate) slopes: Vec<f64>,
    /// `√(1 − γ)` of [`SoftMinimum::second_derivative`].
    shrink: f64,
}

impl SoftMinimum {
    /// The soft minimum of `numbers`, all positive, at `0 < softness < 1`.
    pub(crate) fn new(numbers: &[f64], softness: f64) -> Self {
        let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
        let each = softness / numbers.len() as f64;
        // In s = min x − t the stationarity (1−ε)/t = Σ (ε/m)/(xᵢ−t) rises from −∞ to ∞; these ends enclose its root, which
        // Newton's method finds, or halving where it would leave the interval.
        let (mut low, mut high) = (least * each / (1.0 - softness + each), least * softness);
        let mut s = 0.5 * (low + high);
        for _ in 0..100 {
            let t = least - s;
            let (mut value, mut slope) = ((1.0 - softness) / t, (1.0 - softness) / (t * t));
            for x in numbers {
                let term = each / (x - least + s);
                value -= term;
                slope += term / (x - least + s);
            }
            if value < 0.0 {
                low = s;
            } else {
                high = s;
            }
            let newton = s - value / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let done = (next - s).abs() <= 2.0 * f64::EPSILON * s;
            s = next;
            if done {
                break;
            }
        }
        let t = least - s;
        let gaps: Vec<f64> = numbers.iter().map(|x| x - least + s).collect();
        let log_value = (1.0 - softness) * t.ln() + each * gaps.iter().map(|gap| gap.ln()).sum::<f64>();
        let at_t = (1.0 - softness) / (t * t);
        let at_gaps: f64 = gaps.iter().map(|gap| each / (gap * gap)).sum();
        let slopes = gaps.iter().map(|gap| each / gap).collect();
        Self { log_value, t, gaps, slopes, shrink: (at_t / (at_t + at_gaps)).sqrt() }
    }

    /// For changes `d` of the numbers the vector y with `‖y‖² = −D² log φ[d, d]`.
    ///
    /// With `zᵢ = √(ε/m) dᵢ/(xᵢ − t)` the second derivative is `‖z‖² − γ ⟨û, z⟩²`, û the unit vector along
    /// `1/(xᵢ − t)`, γ < 1 from eliminating t; its root takes the share `1 − √(1 − γ)` of z along û away.
    pub(crate) fn second_derivative(&self, d: &mut [f64]) {
        let norm = self.slopes.iter().map(|slope| slope * slope).sum::<f64>().sqrt();
        let mut along = 0.0;
        for ((d, &slope), gap) in d.iter_mut().zip(&self.slopes).zip(&self.gaps) {
            *d *= (slope / gap).sqrt();
            along += *d * slope / norm;
        }
        for (d, slope) in d.iter_mut().zip(&self.slopes) {
            *d -= (1.0 - self.shrink) * along * slope / norm;
        }
    }
}

/// The soft minimum of numbers known by their logarithms, which may be far from 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LogSoftMinimum {
    /// Of the numbers as shares of the least.
    soft: SoftMinimum,
    /// Logarithm of the least.
    least: f64,
    /// The numbers as shares of the least.
    shares: Vec<f64>,
    /// The derivatives of log φ by the logarithms, which add up to one.
    pub(crate) slopes: Vec<f64>,
}

impl LogSoftMinimum {
    /// The soft minimum of the numbers with these logarithms, all finite, at `0 < softness < 1`.
    pub(crate) fn new(logarithms: &[f64], softness: f64) -> Self {
        let least = logarithms.iter().copied().fold(f64::INFINITY, f64::min);
        // What is so much greater does not matter, and must not overflow.
        let shares: Vec<f64> = logarithms.iter().map(|logarithm| (logarithm - least).min(MOST_APART).exp()).collect();
        let soft = SoftMinimum::new(&shares, softness);
        let slopes = soft.slopes.iter().zip(&shares).map(|(slope, share)| slope * share).collect();
        Self { soft, least, shares, slopes }
    }

    /// log φ.
    pub(crate) fn log_value(&self) -> f64 {
        self.least + self.soft.log_value
    }

    /// As [`SoftMinimum::second_derivative`], for changes of the logarithms of linear functions.
    pub(crate) fn second_derivative(&self, d: &mut [f64]) {
        for (d, share) in d.iter_mut().zip(&self.shares) {
            *d *= share;
        }
        self.soft.second_derivative(d);
    }
}

/// Logarithms are taken to be no further apart than this.
const MOST_APART: f64 = 300.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_equal_finite_differences() {
        let (x, d) = ([1.0, 1.2, 3.0], [0.3, -0.5, 0.8]);
        for softness in [0.9, 0.3, 0.02] {
            let at = |h: f64| SoftMinimum::new(&[0, 1, 2].map(|i| x[i] + h * d[i]), softness).log_value;
            let soft = SoftMinimum::new(&x, softness);
            let h = 1e-4;
            let slope: f64 = soft.slopes.iter().zip(d).map(|(s, d)| s * d).sum();
            assert!((slope - (at(h) - at(-h)) / (2.0 * h)).abs() < 1e-6);
            let mut y = d;
            soft.second_derivative(&mut y);
            let bend: f64 = y.iter().map(|y| y * y).sum();
            assert!((bend + (at(h) - 2.0 * at(0.0) + at(-h)) / (h * h)).abs() < 1e-3 * (1.0 + bend), "{softness}");
        }
    }

    #[test]
    fn it_runs_from_the_geometric_mean_to_the_minimum() {
        let x = [2.0, 8.0];
        assert!((SoftMinimum::new(&x, 1.0 - 1e-9).log_value - 4f64.ln()).abs() < 1e-6);
        assert!((SoftMinimum::new(&x, 1e-9).t - 2.0).abs() < 1e-8);
        // Homogeneous of degree one.
        let twice = SoftMinimum::new(&[4.0, 16.0], 0.1).log_value - SoftMinimum::new(&x, 0.1).log_value;
        assert!((twice - 2f64.ln()).abs() < 1e-12);
    }
}
