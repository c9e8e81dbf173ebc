//! What a file says of itself, in comments that no name breaks out of.

use crate::export::program::Program;

/// Characters of a comment's line.
const WIDTH: usize = 100;

/// What every file says of itself, then what the format adds.
pub(in crate::export) fn header(program: &Program, notes: &[String]) -> Vec<String> {
    let start = program.legs().first().map(|leg| one_line(leg.label)).unwrap_or_default();
    let mut sentences = vec![
        format!("Made by calipose {} from the plan \"{}\".", env!("CARGO_PKG_VERSION"), one_line(program.name)),
        "Check it in simulation and at low speed first.".to_owned(),
        format!("Bring the robot to the start, {start}, beforehand: the way there is not planned."),
    ];
    sentences.extend_from_slice(notes);
    sentences
}

/// `sentences` as comments that begin with `mark`, each on lines of its own.
pub(in crate::export) fn comments(mark: &str, sentences: &[String]) -> String {
    let lines = sentences.iter().flat_map(|sentence| wrapped(sentence, WIDTH));
    lines.map(|line| format!("{mark}{line}\n")).collect()
}

/// `text` in lines of at most `width` characters, broken at spaces, or inside a word that is longer.
pub(in crate::export) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let used = |lines: &[String]| lines.last().map_or(0, |line| line.chars().count());
        if used(&lines) > 0 && used(&lines) + 1 + word.chars().count() > width {
            lines.push(String::new());
        }
        let gap = if used(&lines) > 0 { " " } else { "" };
        for c in gap.chars().chain(word.chars()) {
            if used(&lines) == width {
                lines.push(String::new());
            }
            if let Some(line) = lines.last_mut() {
                line.push(c);
            }
        }
    }
    lines
}

/// `text` in one line, with single spaces for all others and for what is no character of YAML.
pub(in crate::export) fn one_line(text: &str) -> String {
    let spaced: String = text.chars().map(|c| if is_printable(c) { c } else { ' ' }).collect();
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `text` as every controller shows it, also inside quotes: printable ASCII, without quotes, backslashes and semicolons.
pub(in crate::export) fn plain(text: &str) -> String {
    let plain = |c: char| match c {
        '"' => '\'',
        '\\' => '/',
        ';' => ',',
        ' '..='~' => c,
        _ => '?',
    };
    one_line(text).chars().map(plain).collect()
}

/// Whether `c` may stand in a line of YAML as it is.
pub(in crate::export) fn is_printable(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_at_spaces_and_inside_long_words() {
        assert_eq!(wrapped("a bc defghij k", 4), ["a bc", "defg", "hij", "k"]);
        assert_eq!(wrapped("", 4), [""]);
    }

    #[test]
    fn names_stay_on_their_line() {
        assert_eq!(one_line("a\nb\u{2028}é"), "a b é");
        assert_eq!(plain("a\n\"é\";\\"), "a '?',/");
    }
}
