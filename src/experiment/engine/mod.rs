//! Engines that work on a study beyond one process: what a job is to each of them, in files that its user can read.
//!
//! A job is tasks, each a shard of the cells, and a merge after all of them. Nothing is started here.

mod hyperqueue;
mod job;
mod local;
mod quoting;
mod slurm;
mod work;

pub use job::Job;
pub use quoting::shell_line;
pub use work::Work;

/// What runs a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Processes on this machine.
    Local,
    /// The workload manager of many clusters: a job array, and a job that depends on it.
    Slurm,
    /// A task runtime for clusters, by its Python interface: a graph of tasks.
    HyperQueue,
}

impl Engine {
    /// Every engine.
    pub const ALL: [Self; 3] = [Self::Local, Self::Slurm, Self::HyperQueue];

    /// Every file that a job of any engine has.
    pub const FILES: [&str; 4] = [local::FILE, slurm::CELLS, slurm::MERGE, hyperqueue::FILE];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Slurm => "slurm",
            Self::HyperQueue => "hyperqueue",
        }
    }

    /// The job that does `work`; `options` are for Slurm's `sbatch`. One that is local has no command line to start it by: its
    /// processes are [`Work::shard`] for each shard, and [`Work::merge`] after them.
    pub fn job(self, work: &Work, options: &[String]) -> Job {
        match self {
            Self::Local => local::job(work),
            Self::Slurm => slurm::job(work, options),
            Self::HyperQueue => hyperqueue::job(work),
        }
    }
}
