//! YAML that every reader takes for what it is.

use crate::export::text::{decimal, is_printable};

/// `[a, b, c]`.
pub(super) fn numbers(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|&x| decimal(x)).collect::<Vec<_>>().join(", "))
}

/// `["a", "b", "c"]`.
pub(super) fn texts<'a>(values: impl IntoIterator<Item = &'a str>) -> String {
    format!("[{}]", values.into_iter().map(text).collect::<Vec<_>>().join(", "))
}

/// `value` in double quotes, without which yes is a truth value and 1e3 a number.
fn text(value: &str) -> String {
    format!("\"{}\"", value.chars().map(character).collect::<String>())
}

fn character(c: char) -> String {
    match (c, u32::from(c)) {
        ('"' | '\\', _) => format!("\\{c}"),
        _ if is_printable(c) => c.to_string(),
        (_, code @ 0..=0xff) => format!("\\x{code:02x}"),
        (_, code @ 0..=0xffff) => format!("\\u{code:04x}"),
        (_, code) => format!("\\U{code:08x}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_quoted_and_numbers_have_a_point() {
        assert_eq!(
            texts(["yes", "1e3", "a\"\\: é日😀", "\n\u{85}\u{2028}"]),
            r#"["yes", "1e3", "a\"\\: é日😀", "\x0a\x85\u2028"]"#
        );
        assert_eq!(numbers(&[1.0, -0.0, 1e-7]), "[1.0, 0.0, 0.0000001]");
    }
}
