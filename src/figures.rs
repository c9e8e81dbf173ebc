//! Figures as people read them.

/// A count with thin groups of three digits, as in 502 656.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let first = digits.len() % 3;
    let mut text = digits[..first].to_owned();
    for group in digits.as_bytes()[first..].chunks(3) {
        if !text.is_empty() {
            text.push(' ');
        }
        text.extend(group.iter().map(|&digit| char::from(digit)));
    }
    text
}

/// A number to so many decimals, without a sign on 0.
pub fn fixed(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// A number to at most so many decimals, as many as it needs: 35, 35.7.
pub fn trimmed(number: f64, decimals: usize) -> String {
    let text = fixed(number, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A number to four significant digits.
pub fn short(number: f64) -> String {
    if !number.is_finite() {
        return "-".into();
    }
    if number == 0.0 {
        return "0".into();
    }
    let magnitude = number.abs().log10().floor() as i32;
    if (-4..5).contains(&magnitude) {
        format!("{number:.*}", (3 - magnitude).max(0) as usize)
    } else {
        format!("{number:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        assert_eq!([0, 999, 1000, 502_656, 1_000_000].map(grouped), ["0", "999", "1 000", "502 656", "1 000 000"]);
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!([-0.04, 6.13e-15, -6.13e-15, -0.05001].map(|q| fixed(q, 1)), ["0.0", "0.0", "0.0", "-0.1"]);
        assert_eq!(fixed(-0.4, 0), "0");
        assert_eq!([35.0, 0.0357 * 1e3, -1e-9, 100.0].map(|length| trimmed(length, 4)), ["35", "35.7", "0", "100"]);
        assert_eq!(trimmed(100.4, 0), "100");
    }
}
