//! `HyperQueue`: a graph of tasks, stated in Python, which its package submits.

use super::job::Job;
use super::quoting::python;
use super::work::Work;

/// Name of the script; not the package's, which Python would take it for.
pub(super) const FILE: &str = "submit.py";

/// The script, and how it is run.
pub(super) fn job(work: &Work) -> Job {
    Job { files: vec![(FILE, script(work))], start: vec![vec!["python3".into(), FILE.into()]] }
}

fn script(work: &Work) -> String {
    let force = if work.force { r#", "--force""# } else { "" };
    format!(
        r#"# {title}, each a task, and the merge after all of them.
#
# Submitted as `python3 {FILE}` to the HyperQueue server of $HQ_SERVER_DIR, or of ~/.hq-server. Cells that are there are not computed
# again, so it can be submitted as often as need be.
import os
from pathlib import Path

from hyperqueue import Client, Job
from hyperqueue.ffi.protocol import ResourceRequest

CALIPOSE = {calipose}
STUDY = {file}
OUTPUT = {output}
SHARDS = {shards}
CORES = {cores}

logs = Path(__file__).resolve().parent
# A task that fails does not end the others; the merge waits for all, and is left out if one has failed.
job = Job(name={name}, default_workdir=logs, max_fails=None)


def task(name, *command, cores=1, after=()):
    log = "%{{CWD}}/" + name + "."
    return job.program(
        [CALIPOSE, "study", *command, "--output", OUTPUT{force}],
        name=name,
        stdout=log + "out",
        stderr=log + "err",
        deps=after,
        resources=ResourceRequest(cpus=cores),
    )


shards = [
    task(f"shard-{{i}}", "cell", STUDY, "--shard", f"{{i}}/{{SHARDS}}", "--threads", str(CORES), cores=CORES)
    for i in range(SHARDS)
]
task("merge", "merge", STUDY, after=shards)
print(Client(os.environ.get("HQ_SERVER_DIR")).submit(job).id)
"#,
        title = work.title(),
        calipose = python(&work.calipose),
        file = python(&work.file),
        output = python(&work.output),
        shards = work.shards,
        cores = work.cores,
        name = python(&work.name),
    )
}

#[cfg(test)]
mod tests {
    use super::super::work::tests::work;
    use super::*;

    #[test]
    fn the_script_says_what_is_done_in_its_first_lines() {
        let script = script(&work());
        let head = r#"
CALIPOSE = "/opt/calipose"
STUDY = "/home/o'neil/my studies/\"k\" $HOME.toml"
OUTPUT = "/scratch/100% new\\old"
SHARDS = 4
CORES = 1

"#;
        assert!(script.contains(head), "{script}");
        assert!(script.contains("Job(name=\"Poses\\n#SBATCH --exclusive\", "), "{script}");
        assert!(
            script.starts_with("# Study \"Poses #SBATCH --exclusive\": 8 cells in 4 shards, each a task"),
            "{script}"
        );
    }

    #[test]
    fn a_forced_job_forces_every_task() {
        assert!(script(&Work { force: true, ..work() }).contains("\"--output\", OUTPUT, \"--force\"],"));
        assert!(!script(&work()).contains("force"));
    }
}
