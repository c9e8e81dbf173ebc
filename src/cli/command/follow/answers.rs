//! Answers from stdin, read beside whatever else is waited for.

use std::io::BufRead;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// What was heard.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Heard {
    /// A line, its end left out.
    Line(String),
    /// That no more lines can come.
    End,
    /// Nothing, so long.
    Nothing,
}

/// The lines of stdin.
pub(super) struct Answers(Receiver<String>);

impl Answers {
    /// Reads from now on.
    pub(super) fn new() -> Self {
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            let mut stdin = std::io::stdin().lock();
            let mut line = Vec::new();
            // What is no UTF-8 is no answer, but no end of them either.
            while stdin.read_until(b'\n', &mut line).is_ok_and(|count| count > 0) {
                if sender.send(String::from_utf8_lossy(&line).trim_end().to_owned()).is_err() {
                    break;
                }
                line.clear();
            }
        });
        Self(receiver)
    }

    /// Waits for a line, `most` so long if that is given.
    pub(super) fn wait(&self, most: Option<Duration>) -> Heard {
        let heard = match most {
            Some(most) => self.0.recv_timeout(most),
            None => self.0.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        match heard {
            Ok(line) => Heard::Line(line),
            Err(RecvTimeoutError::Timeout) => Heard::Nothing,
            Err(RecvTimeoutError::Disconnected) => Heard::End,
        }
    }
}
