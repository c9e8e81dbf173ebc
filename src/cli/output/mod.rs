//! What the user sees: text or JSON on stdout, progress and errors on stderr.

pub(super) mod collision;
mod error_document;
pub(super) mod failure;
pub(super) mod joint_table;
pub(super) mod pose_table;
mod progress;
pub(super) mod verdict;

use std::io::Write;

use comfy_table::{CellAlignment, Table, presets};
use miette::{GraphicalReportHandler, GraphicalTheme};

pub(crate) use crate::figures::{fixed, grouped, short};
use crate::plan::document::{Document, ErrorDocument};
use error_document::error_document;
use failure::Failure;
use progress::Progress;

pub(crate) struct Screen {
    quiet: bool,
    json: bool,
}

impl Screen {
    pub(crate) fn new(quiet: bool, json: bool) -> Self {
        Self { quiet, json }
    }

    /// Whether text is shown: not if the user asked for quiet or for JSON.
    pub(crate) fn shows_text(&self) -> bool {
        !self.quiet && !self.json
    }

    /// Prints text where it is shown.
    pub(crate) fn text(&mut self, text: &str) -> Result<(), Failure> {
        if self.shows_text() { Self::print(text) } else { Ok(()) }
    }

    /// Prints the document, if the user asked for JSON.
    pub(crate) fn document(&mut self, document: &impl Document) -> Result<(), Failure> {
        if self.json { Self::print(document.to_json().trim_end()) } else { Ok(()) }
    }

    /// Prints the document on a line of its own, if the user asked for JSON: one of several.
    pub(crate) fn line(&mut self, document: &impl Document) -> Result<(), Failure> {
        if self.json { Self::print(&document.to_line()) } else { Ok(()) }
    }

    /// Prints what was asked for whatever the flags.
    pub(crate) fn print(text: &str) -> Result<(), Failure> {
        match writeln!(std::io::stdout().lock(), "{text}") {
            // A reader that has seen enough (`calipose … | head`) is no failure.
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
            written => Ok(written?),
        }
    }

    /// Tells of what may go wrong, on stderr.
    pub(crate) fn warn(&self, text: &str) {
        if !self.quiet {
            Self::complain(&format!("Warning: {text}."));
        }
    }

    /// A progress bar over `length` steps, on stderr.
    pub(crate) fn progress(&self, what: &'static str, length: usize) -> Progress {
        Progress::new(self.quiet, what, Some(length), "{prefix:>12} {bar:40} {human_pos}/{human_len} {eta}")
    }

    /// A line for work of unknown length, on stderr.
    pub(crate) fn spinner(&self, what: &'static str) -> Progress {
        Progress::new(self.quiet, what, None, "{prefix:>12} {spinner} {elapsed} {msg}")
    }

    /// Says what went wrong: drawn, or as a document if the user asked for JSON.
    pub(crate) fn fail(&self, failure: &Failure) {
        if self.json {
            return Self::complain_in_json(&error_document(failure));
        }
        let theme = if std::io::IsTerminal::is_terminal(&std::io::stderr()) && std::env::var_os("NO_COLOR").is_none() {
            GraphicalTheme::unicode()
        } else {
            GraphicalTheme::unicode_nocolor()
        };
        let mut text = String::new();
        if GraphicalReportHandler::new_themed(theme).render_report(&mut text, failure).is_err() {
            text = failure.to_string();
        }
        Self::complain(text.trim_end());
    }

    /// Says in JSON what is wrong with the command line.
    pub(crate) fn refuse(error: &clap::Error) {
        let message = error.render().to_string();
        Self::complain_in_json(&ErrorDocument::new("command-line", 2, message.trim_end(), None, Vec::new()));
    }

    pub(crate) fn report_bug(what: &str, json: bool) {
        let message = format!(
            "This is a bug in calipose {}, not your mistake. Please report it with the problem file and this line:\n{what}",
            env!("CARGO_PKG_VERSION")
        );
        if json {
            Self::complain_in_json(&ErrorDocument::new("bug", 70, &message, None, Vec::new()));
        } else {
            Self::complain(&message);
        }
    }

    fn complain_in_json(document: &ErrorDocument) {
        Self::complain(document.to_json().trim_end());
    }

    fn complain(text: &str) {
        // There is nobody left to tell when stderr is closed.
        let _ = writeln!(std::io::stderr().lock(), "{text}");
    }
}

/// Columns of a terminal that texts and tables keep to.
pub(crate) const WIDTH: usize = 80;

/// Prose in lines that fit a terminal; numbers keep together, and so do they with their unit.
pub(crate) fn wrapped(text: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let digit = |i: usize| characters.get(i).is_some_and(char::is_ascii_digit);
    let joined = |i: usize| {
        let unit = characters[i + 1..].starts_with(&['p', 'x']);
        characters[i] == ' ' && i > 0 && digit(i - 1) && (unit || (1..=3).all(|next| digit(i + next)))
    };
    let bound = (0..characters.len()).map(|i| if joined(i) { '\u{a0}' } else { characters[i] }).collect::<String>();
    // Pairs of links, joined by a dash, keep together too.
    let options = textwrap::Options::new(WIDTH)
        .break_words(false)
        .word_separator(textwrap::WordSeparator::AsciiSpace)
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(&bound, options).replace('\u{a0}', " ")
}

/// A table with a header; the first column to the left, the others to the right.
pub(crate) fn table<S: AsRef<str>>(header: &[S], rows: &[Vec<String>]) -> String {
    padded_table(header, rows, 1)
}

/// The same with columns as near as they can be.
pub(crate) fn tight_table<S: AsRef<str>>(header: &[S], rows: &[Vec<String>]) -> String {
    padded_table(header, rows, 0)
}

fn padded_table<S: AsRef<str>>(header: &[S], rows: &[Vec<String>], padding: u16) -> String {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_header(header.iter().map(AsRef::as_ref));
    table.add_rows(rows);
    for (i, column) in table.column_iter_mut().enumerate() {
        column.set_padding((u16::from(i != 0), padding));
        column.set_cell_alignment(if i == 0 { CellAlignment::Left } else { CellAlignment::Right });
    }
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

/// A time as one would say it.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{} days", grouped((s / 86_400.0) as usize)),
    }
}

#[cfg(test)]
mod tests {
    use super::{WIDTH, duration, wrapped};

    #[test]
    fn numbers_stay_whole_where_prose_is_wrapped() {
        for before in 60..WIDTH {
            let text = format!("{} of 502 656 views at 7.146 px", "x".repeat(before));
            let lines = wrapped(&text);
            assert!(lines.lines().all(|line| line.chars().count() <= WIDTH), "{lines}");
            assert!(lines.contains("502 656") && lines.contains("7.146 px"), "{lines}");
            assert_eq!(lines.replace('\n', " "), text);
        }
    }

    #[test]
    fn times_are_told_in_their_units() {
        assert_eq!(
            [0.52, 33.2, 119.0, 150.0, 8000.0, 1e6].map(duration),
            ["0.5 s", "33 s", "119 s", "2 min", "2.2 h", "11 days"]
        );
    }
}
