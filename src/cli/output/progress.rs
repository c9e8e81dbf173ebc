//! How far long work has come: drawn where stderr is a terminal, else told in a line now and then.

use std::io::{IsTerminal, Write};
use std::ops::Deref;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::figures::grouped;

/// Time between two lines where there is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(20);

/// A progress bar that tells of itself also where nobody sees it drawn.
pub(crate) struct Progress {
    bar: ProgressBar,
    /// Its end ends the lines.
    _lines: Option<Sender<()>>,
}

impl Progress {
    /// Of `length` steps, where that is known.
    pub(crate) fn new(quiet: bool, what: &'static str, length: Option<usize>, template: &str) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(length.map(|length| length as u64), target);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_prefix(what);
        let told = !quiet && !std::io::stderr().is_terminal();
        let lines = told.then(|| {
            lines(bar.clone(), BETWEEN_LINES, |line| {
                // There is nobody left to tell when stderr is closed.
                let _ = writeln!(std::io::stderr().lock(), "{line}");
            })
        });
        Self { bar, _lines: lines }
    }
}

impl Deref for Progress {
    type Target = ProgressBar;

    fn deref(&self) -> &ProgressBar {
        &self.bar
    }
}

/// Tells of `bar` after every `interval`, until it is finished or what this returns is dropped.
fn lines(bar: ProgressBar, interval: Duration, tell: impl Fn(String) + Send + 'static) -> Sender<()> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        while receiver.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) && !bar.is_finished() {
            tell(line(&bar));
        }
    });
    sender
}

/// Where the work stands: `sweeping: 1 200 of 502 656, 20 s`.
fn line(bar: &ProgressBar) -> String {
    let mut text = format!("{}: ", bar.prefix());
    match bar.length() {
        Some(length) => text += &format!("{} of {}, ", grouped(bar.position() as usize), grouped(length as usize)),
        None if !bar.message().is_empty() => text += &format!("{}, ", bar.message()),
        None => {}
    }
    text + &format!("{} s", bar.elapsed().as_secs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_terminal_lines_tell_how_far_it_has_come() {
        let bar = ProgressBar::with_draw_target(Some(502_656), ProgressDrawTarget::hidden());
        bar.set_prefix("sweeping");
        bar.set_position(1200);
        let (told, heard) = channel();
        let sender = lines(bar, Duration::from_millis(1), move |line| drop(told.send(line)));
        for _ in 0..2 {
            assert!(heard.recv().unwrap().starts_with("sweeping: 1 200 of 502 656, "));
        }
        drop(sender);
        // The thread ends, and with it the sender of its lines.
        assert!(heard.iter().count() < 1000);
    }

    #[test]
    fn work_of_unknown_length_tells_its_message() {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        bar.set_prefix("selecting");
        assert_eq!(line(&bar), "selecting: 0 s");
        bar.set_message("32 nodes");
        assert_eq!(line(&bar), "selecting: 32 nodes, 0 s");
    }
}
