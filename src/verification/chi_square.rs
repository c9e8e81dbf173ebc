//! Confidence intervals of a standard deviation, by the quantiles of the χ² distribution.

/// The confidence interval of the true standard deviation over the sampled one, from `count` samples of a Gaussian:
/// `√((n−1)/χ²)` at both tails; `confidence` is two-sided, in (0, 1).
///
/// Zero to infinity for fewer than two samples.
pub fn deviation_interval(count: usize, confidence: f64) -> (f64, f64) {
    if count < 2 {
        return (0.0, f64::INFINITY);
    }
    let freedoms = (count - 1) as f64;
    let tail = (1.0 - confidence) / 2.0;
    let factor = |probability: f64| (freedoms / quantile(probability, freedoms)).sqrt();
    (factor(1.0 - tail), factor(tail))
}

/// The value below which χ² of `freedoms` degrees stays with `probability`.
fn quantile(probability: f64, freedoms: f64) -> f64 {
    // All but certainly below: mean + 40 deviations, and room for few degrees.
    let (mut low, mut high) = (0.0, freedoms + 40.0 * (2.0 * freedoms).sqrt() + 100.0);
    // Halving 60 times leaves less than rounding.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if lower_gamma(freedoms / 2.0, middle / 2.0) < probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The regularised lower incomplete gamma function `P(a, x)`: series below `a + 1`, continued fraction above (Press et
/// al., *Numerical Recipes*, §6.2).
fn lower_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > 1e-16 * sum {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return front * sum;
    }
    // Lentz's method.
    let mut b = x + 1.0 - a;
    let mut c = 1e300;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..100_000 {
        let i = f64::from(i);
        let an = -i * (i - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        let change = c * d;
        h *= change;
        if (change - 1.0).abs() < 1e-15 {
            break;
        }
    }
    1.0 - front * h
}

/// `ln Γ(x)` for x > 0 by Stirling's series, the argument raised to where it holds to rounding.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut product) = (x, 1.0);
    while x < 12.0 {
        product *= x;
        x += 1.0;
    }
    let z = 1.0 / (x * x);
    let series = (1.0 / 12.0 - z * (1.0 / 360.0 - z * (1.0 / 1260.0 - z * (1.0 / 1680.0 - z / 1188.0)))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + series - product.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_equal_the_tables() {
        // Abramowitz & Stegun, table 26.8.
        for (probability, freedoms, expected) in [
            (0.995, 1.0, 7.879_44),
            (0.005, 10.0, 2.155_85),
            (0.5, 2.0, 1.386_29),
            (0.995, 30.0, 53.671_9),
            (0.005, 100.0, 67.327_5),
        ] {
            let found = quantile(probability, freedoms);
            assert!((found - expected).abs() < 1e-5 * expected, "{found} for {expected}");
        }
    }

    #[test]
    fn the_interval_closes_as_samples_grow() {
        let (low, high) = deviation_interval(2000, 0.99);
        // 2.576/√(2·2000) = 0.0407.
        assert!((low - 0.961).abs() < 1e-3 && (high - 1.0425).abs() < 1e-3, "{low} {high}");
        assert_eq!(deviation_interval(1, 0.99), (0.0, f64::INFINITY));
    }
}
