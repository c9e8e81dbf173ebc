//! What there is to do, whatever does it.

use std::num::NonZero;

/// The cells of a study, in shards, and their merge. Paths are absolute: a task starts anywhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Work {
    /// The program.
    pub calipose: String,
    /// The study file.
    pub file: String,
    /// Folder for the results.
    pub output: String,
    /// Name of the study.
    pub name: String,
    /// Cells.
    pub cells: usize,
    /// Shards of them.
    pub shards: NonZero<usize>,
    /// Cores that a shard works on.
    pub cores: NonZero<usize>,
    /// Whether the folder may hold another study.
    pub force: bool,
}

impl Work {
    /// The command line of a shard, from 0.
    pub fn shard(&self, shard: usize) -> Vec<String> {
        let shard = format!("{shard}/{}", self.shards);
        let command = [&self.calipose, "study", "cell", &self.file, "--shard", &shard, "--output", &self.output];
        self.with_force(&command, &["--threads", &self.cores.to_string()])
    }

    /// The command line of the merge.
    pub fn merge(&self) -> Vec<String> {
        self.with_force(&[&self.calipose, "study", "merge", &self.file, "--output", &self.output], &[])
    }

    fn with_force(&self, command: &[&str], more: &[&str]) -> Vec<String> {
        let force: &[&str] = if self.force { &["--force"] } else { &[] };
        command.iter().chain(more).chain(force).map(|&argument| argument.to_owned()).collect()
    }

    /// What it is, in a line for a comment.
    pub(super) fn title(&self) -> String {
        let name: String = self.name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let cells = if self.cells == 1 { "1 cell".into() } else { format!("{} cells", self.cells) };
        let shards = if self.shards.get() == 1 { "1 shard".into() } else { format!("{} shards", self.shards) };
        format!("Study \"{name}\": {cells} in {shards}")
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Work with names that a shell or Python would trip over.
    pub(in crate::experiment::engine) fn work() -> Work {
        Work {
            calipose: "/opt/calipose".into(),
            file: "/home/o'neil/my studies/\"k\" $HOME.toml".into(),
            output: "/scratch/100% new\\old".into(),
            name: "Poses\n#SBATCH --exclusive".into(),
            cells: 8,
            shards: NonZero::new(4).unwrap_or(NonZero::<usize>::MIN),
            cores: NonZero::<usize>::MIN,
            force: false,
        }
    }

    #[test]
    fn each_shard_has_a_command_line_and_all_have_the_force() {
        let work = Work { force: true, ..work() };
        assert_eq!(work.shard(3)[4..], ["--shard", "3/4", "--output", &work.output, "--threads", "1", "--force"]);
        assert_eq!(work.merge()[1..], ["study", "merge", &work.file, "--output", &work.output, "--force"]);
    }

    #[test]
    fn a_title_is_one_line() {
        assert_eq!(work().title(), "Study \"Poses #SBATCH --exclusive\": 8 cells in 4 shards");
    }
}
