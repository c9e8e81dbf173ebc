//! What is answered to a pose that was announced.

use std::str::FromStr;

use thiserror::Error;

/// An answer to a pose that was announced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// The pose is taken; of a picture in doubt, that it counts.
    Done,
    /// The pose is left out.
    Skip,
    /// To the pose before.
    Back,
    /// The pose again, from its beginning.
    Again,
    /// Enough for now.
    Quit,
}

impl Answer {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Done, Self::Skip, Self::Back, Self::Again, Self::Quit];

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Skip => "skip",
            Self::Back => "back",
            Self::Again => "again",
            Self::Quit => "quit",
        }
    }
}

/// A line that is no answer.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("\"{0}\" is no answer; answers are Enter or done, skip, back, again, quit")]
pub struct UnknownAnswer(
    /// The line.
    pub String,
);

impl FromStr for Answer {
    type Err = UnknownAnswer;

    /// The answer that a line says; an empty one says [`Done`](Self::Done).
    fn from_str(line: &str) -> Result<Self, UnknownAnswer> {
        let word = line.trim();
        if word.is_empty() {
            return Ok(Self::Done);
        }
        let answer = Self::ALL.into_iter().find(|answer| answer.name().eq_ignore_ascii_case(word));
        answer.ok_or_else(|| UnknownAnswer(word.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_answers_whatever_their_case_and_space() {
        for answer in Answer::ALL {
            assert_eq!(format!(" {}\r\n", answer.name().to_uppercase()).parse(), Ok(answer));
        }
        assert_eq!("\n".parse(), Ok(Answer::Done));
        let error = "next".parse::<Answer>().unwrap_err();
        assert_eq!(error.to_string(), "\"next\" is no answer; answers are Enter or done, skip, back, again, quit");
    }
}
