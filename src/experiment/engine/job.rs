//! A job as an engine takes it.

/// Files, and how it is started from them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Job {
    /// Names and contents of the files, which belong into one folder.
    pub files: Vec<(&'static str, String)>,
    /// Command lines that start it, to be run in that folder one after the other; each prints what the engine calls what it started.
    pub start: Vec<Vec<String>>,
}

impl Job {
    /// Stands in a command line for what the one before it printed.
    pub const BEFORE: &str = "JOB";

    /// The option of Slurm's by which a job waits for another to succeed.
    pub(super) const AFTER: &str = "--dependency=afterok:";

    /// A command line of [`Job::start`], when the one before it has printed `before`.
    pub fn line(&self, number: usize, before: &str) -> Vec<String> {
        let line = self.start[number].iter();
        // Nothing else: what is the user's may say the same.
        let after = |argument: &String| argument.strip_prefix(Self::AFTER).is_some_and(|job| job == Self::BEFORE);
        line.map(|argument| if after(argument) { format!("{}{before}", Self::AFTER) } else { argument.clone() })
            .collect()
    }
}
