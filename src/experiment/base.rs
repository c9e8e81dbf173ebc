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
    /// Poses would leave the sweep's views.
    #[error(
        "`selection.off_grid` is true; studies and designs are about the sweep's views: leave it out, and `calipose plan` what they find"
    )]
    OffGrid,
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

    /// The problem with `KEY=VALUE` settings in place of its own. Experiments are about the sweep's views, which no pose leaves.
    pub(super) fn problem<'s>(&self, settings: impl Iterator<Item = &'s String>) -> Result<Problem, SettingFault> {
        let on_grid = Overrides::new().set("selection.off_grid=false")?;
        let overrides = settings.cloned().try_fold(on_grid, |overrides, text| overrides.set(&text))?;
        let problem = Problem::parse_with(&self.text, &self.path, &overrides)?;
        if problem.selection.off_grid { Err(SettingFault::OffGrid) } else { Ok(problem) }
    }

    /// What is wrong with a value that the problem refuses.
    pub(super) fn refusal(&self, fault: &SettingFault) -> Refusal {
        let problem = self.path.clone();
        let first = match fault {
            SettingFault::Problem(error) => error.faults().first(),
            SettingFault::Set(_) | SettingFault::Simulation(_) | SettingFault::OffGrid => None,
        };
        let of_key = match (fault, first) {
            (_, Some(first)) => matches!(first.reason, Reason::UnknownKey { .. }),
            (fault, None) => matches!(fault, SettingFault::Set(OverrideError::Key { .. }) | SettingFault::OffGrid),
        };
        let (sentence, hint) = match first {
            Some(first) => (first.to_string(), first.hint()),
            None => (fault.to_string(), None),
        };
        Refusal { reason: Reason::InProblem { problem, sentence, hint }, of_key }
    }

    /// Refuses, in the list of what is set in all of an experiment, what the problem refuses: the one that it refuses alone, or else
    /// all of them.
    pub(super) fn refuse_set(&self, check: &mut Check, set: &At<Vec<String>>, fault: &SettingFault) {
        let mut alone = set.elements().filter_map(|text| {
            let fault = self.problem(std::iter::once(text.value)).err()?;
            Some((text.path, self.refusal(&fault)))
        });
        let (path, refusal) = alone.next().unwrap_or_else(|| (set.path.clone(), self.refusal(fault)));
        check.fault(&path, refusal.reason);
    }
}

/// Why a problem refuses a value.
pub(super) struct Refusal {
    pub(super) reason: Reason,
    /// Whether it is the key that is wrong, whatever the value.
    pub(super) of_key: bool,
}
