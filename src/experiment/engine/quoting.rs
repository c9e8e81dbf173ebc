//! Texts as a shell and Python read them back.

/// A command line as a POSIX shell reads it.
pub fn shell_line(command: &[String]) -> String {
    command.iter().map(|argument| shell(argument)).collect::<Vec<_>>().join(" ")
}

/// An argument for a POSIX shell.
pub(super) fn shell(argument: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/.,_-+=:@%".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', r"'\''"))
}

/// A string literal of Python.
pub(super) fn python(text: &str) -> String {
    // Python has all of JSON's escapes, and this writer leaves whatever needs none as it is.
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_back_what_was_quoted() {
        let quoted = ["/opt/a-b_c.1", "two words", "o'neil", "\"$HOME\" `id`", "back\\slash", "", "~", "a\nb", "é"];
        let expected = [
            "/opt/a-b_c.1",
            "'two words'",
            r"'o'\''neil'",
            "'\"$HOME\" `id`'",
            r"'back\slash'",
            "''",
            "'~'",
            "'a\nb'",
            "'é'",
        ];
        assert_eq!(quoted.map(shell), expected);
    }

    #[test]
    fn python_reads_back_what_was_quoted() {
        let quoted = ["/a b", "o'neil \"k\"", "100% new\\old {x}", "a\nb\u{7}", "é°😀"];
        let expected = [r#""/a b""#, r#""o'neil \"k\"""#, r#""100% new\\old {x}""#, r#""a\nb\u0007""#, "\"é°😀\""];
        assert_eq!(quoted.map(python), expected);
    }
}
