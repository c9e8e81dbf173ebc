//! Numbers without exponents, which some controllers do not read.

/// `x` with all its digits, as the shortest decimal that reads back as `x`; with a point, without which YAML has an integer.
pub(in crate::export) fn decimal(x: f64) -> String {
    // Adding 0 takes the sign from −0.
    let text = (x + 0.0).to_string();
    if text.contains('.') { text } else { format!("{text}.0") }
}

/// `x` with so many decimals.
pub(in crate::export) fn fixed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// `speed` with so many decimals, rounded down: no joint gets faster than it may be.
pub(in crate::export) fn rounded_down(speed: f64, decimals: u8) -> String {
    let unit = 10_f64.powi(i32::from(decimals));
    // What is 1 but for rounding is 1.
    fixed((speed * unit + 1e-6).floor() / unit, usize::from(decimals))
}

/// `seconds` with so many decimals, rounded up: no move gets faster than planned.
pub(in crate::export) fn rounded_up(seconds: f64, decimals: u8) -> String {
    let unit = 10_f64.powi(i32::from(decimals));
    // 0.7 × 10³ is 700.0000000000001 at worst, which is no reason for a millisecond more.
    fixed((seconds * unit - 1e-6).ceil() / unit, usize::from(decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_keep_their_digits_and_have_no_exponent() {
        for (x, text) in [(0.1 + 0.2, "0.30000000000000004"), (1e-7, "0.0000001"), (-2.0, "-2.0"), (-0.0, "0.0")] {
            assert_eq!(decimal(x), text);
            assert_eq!(text.parse::<f64>(), Ok(x));
        }
    }

    #[test]
    fn rounding_leaves_no_minus_zero_and_no_time_too_short() {
        assert_eq!([fixed(-1e-9, 3), fixed(-1.2345, 3), fixed(-10.0, 0)], ["0.000", "-1.234", "-10"]);
        assert_eq!([rounded_down(1.0 - 1e-16, 6), rounded_down(0.1239, 3)], ["1.000000", "0.123"]);
        assert_eq!([rounded_up(2.5, 3), rounded_up(2.5001, 3), rounded_up(0.7, 2)], ["2.500", "2.501", "0.70"]);
    }
}
