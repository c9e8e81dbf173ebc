//! Base problems, and what is set in them.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::problem::{At, Check, OverrideError, Overrides, Problem, ProblemError, Reason, read_text};

/// A problem file that experiments set values in.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Base {
    pub(super) path: PathBuf,
    pub(super) text: String,
    /// Name of the problem.
    pub(super) name: String,
}

/// Why a problem does not take what is set in it.
#[derive(Debug, Error)]
pub enum SettingFault {
    /// A value is not written as one.
    #[error(transparent)]
    Set(#[from] OverrideError),
    /// The problem refuses the setting.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A key of the simulation refuses its value.
    #[error("{0}")]
    Simulation(String),
}

impl SettingFault {
    /// What is wrong, in a row: names no file, whose path is another on each machine.
    pub(super) fn reason(&self) -> String {
        match self {
            Self::Problem(error) if error.faults().len() > 1 => {
                error.faults().iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
            }
            other => other.to_string(),
        }
    }
}

impl Base {
    /// The problem file that the key names, relative to `folder`; none if there is no such file.
    ///
    /// # Errors
    /// What is wrong with the problem is told as of itself.
    pub(super) fn read(check: &mut Check, named: &At<String>, folder: &Path) -> Result<Option<Self>, ProblemError> {
        let path = folder.join(named.value);
        match read_text(&path) {
            Ok(text) => {
                let Problem { name, .. } = Problem::parse(&text, &path)?;
                Ok(Some(Self { path, text, name }))
            }
            Err(error) => {
                let sentence = match error {
                    ProblemError::Read { source, .. } => source.to_string(),
                    other => other.to_string(),
                };
                let hint = Some("paths are relative to the folder of this file".to_owned());
                check.fault(&named.path, Reason::InProblem { problem: path, sentence, hint });
                Ok(None)
            }
        }
    }

    /// The problem with `KEY=VALUE` settings in place of its own.
    pub(super) fn problem<'s>(&self, settings: impl Iterator<Item = &'s String>) -> Result<Problem, SettingFault> {
        let overrides = settings.cloned().try_fold(Overrides::new(), |overrides, text| overrides.set(&text))?;
        Ok(Problem::parse_with(&self.text, &self.path, &overrides)?)
    }

    /// What is wrong with a value that the problem refuses.
    pub(super) fn refusal(&self, fault: &SettingFault) -> Reason {
        let problem = self.path.clone();
        let first = match fault {
            SettingFault::Problem(error) => error.faults().first(),
            SettingFault::Set(_) | SettingFault::Simulation(_) => None,
        };
        match first {
            Some(first) => Reason::InProblem { problem, sentence: first.to_string(), hint: first.hint() },
            None => Reason::InProblem { problem, sentence: fault.to_string(), hint: None },
        }
    }

    /// Refuses, in the list of what is set in all of an experiment, what the problem refuses.
    pub(super) fn refuse_set(&self, check: &mut Check, set: &At<Vec<String>>, fault: &SettingFault) {
        let line = match fault {
            SettingFault::Problem(error) => error.faults().first().and_then(|fault| fault.given.as_deref()),
            SettingFault::Set(_) | SettingFault::Simulation(_) => None,
        };
        // The line is written anew, with blanks and quotes of its own.
        let plain = |text: &str| text.replace([' ', '"'], "");
        let is_of = |text: &String| line.is_some_and(|line| plain(text) == plain(line));
        let refused = |text: &String| Overrides::new().set(text).is_err();
        let index = set.value.iter().position(|text| is_of(text) || refused(text));
        let path = index.map_or(set.path.clone(), |index| set.path.at(index));
        check.fault(&path, self.refusal(fault));
    }
}
