//! Means and their confidence intervals.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.95;

/// The mean of numbers; `None` of none.
pub(super) fn mean(numbers: &[f64]) -> Option<f64> {
    (!numbers.is_empty()).then(|| numbers.iter().sum::<f64>() / numbers.len() as f64)
}

/// The median: of an even number the mean of the middle two.
pub(super) fn median(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let upper = sorted.get(sorted.len() / 2)?;
    Some(f64::midpoint(sorted[(sorted.len() - 1) / 2], *upper))
}

/// The 95 % confidence interval of the mean by Student's t; `None` of fewer than two numbers.
pub(super) fn interval(numbers: &[f64]) -> Option<[f64; 2]> {
    let n = numbers.len() as f64;
    let mean = mean(numbers)?;
    let variance = numbers.iter().map(|number| (number - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let t = StudentsT::new(0.0, 1.0, n - 1.0).ok()?.inverse_cdf(f64::midpoint(1.0, CONFIDENCE));
    let half = t * (variance / n).sqrt();
    half.is_finite().then_some([mean - half, mean + half])
}

/// Least and greatest.
pub(super) fn range(numbers: &[f64]) -> Option<[f64; 2]> {
    let least = numbers.iter().copied().reduce(f64::min)?;
    Some([least, numbers.iter().copied().fold(least, f64::max)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_the_tables() {
        // t of 9 degrees of freedom at 97.5 % is 2.2622; these ten numbers have mean 5.5 and standard deviation 3.0277.
        let numbers: Vec<f64> = (1..=10).map(f64::from).collect();
        let [low, high] = interval(&numbers).unwrap();
        assert!((low - 3.3342).abs() < 1e-4 && (high - 7.6658).abs() < 1e-4, "{low} {high}");
        assert_eq!((median(&numbers), mean(&numbers), range(&numbers)), (Some(5.5), Some(5.5), Some([1.0, 10.0])));
        assert_eq!(
            (interval(&[1.0]), interval(&[]), mean(&[]), median(&[]), range(&[])),
            (None, None, None, None, None)
        );
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
    }
}
