//! Numbers as every reader of these formats takes them.

/// `x` with all its digits. With a point and a signed exponent, without which YAML 1.1 reads a text.
pub(super) fn number(x: f64) -> String {
    let text = format!("{x:?}");
    match text.split_once('e') {
        None => text,
        Some((mantissa, exponent)) => {
            let point = if mantissa.contains('.') { "" } else { ".0" };
            let sign = if exponent.starts_with('-') { "" } else { "+" };
            format!("{mantissa}{point}e{sign}{exponent}")
        }
    }
}

/// `[a, b, c]`.
pub(super) fn list(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_a_point_and_a_sign() {
        assert_eq!(list(&[0.0, 1000.0, 0.1 + 0.2]), "[0.0, 1000.0, 0.30000000000000004]");
        assert_eq!(list(&[1e-7, -1.5e-9, 1e20]), "[1.0e-7, -1.5e-9, 1.0e+20]");
    }
}
