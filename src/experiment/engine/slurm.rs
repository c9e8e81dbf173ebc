//! Slurm: a job array, and a job that depends on all of it.
//!
//! The scripts are submitted in their folder, so that their logs need no paths, whose spaces and percent signs Slurm would read in its
//! own way.

use super::job::Job;
use super::quoting::{shell, shell_line};
use super::work::Work;
use crate::problem::slug;

/// Names of the scripts.
pub(super) const CELLS: &str = "cells.sbatch";
pub(super) const MERGE: &str = "merge.sbatch";

/// The two scripts, and how they are submitted, with `options` for both.
pub(super) fn job(work: &Work, options: &[String]) -> Job {
    let sbatch = |more: &[String], script: &str| {
        let ours = ["sbatch".to_owned(), "--parsable".to_owned()].into_iter();
        ours.chain(options.iter().cloned()).chain(more.iter().cloned()).chain([script.to_owned()]).collect()
    };
    // Without the second, the merge of an array that failed would wait for ever.
    let after = [format!("{}{}", Job::AFTER, Job::BEFORE), "--kill-on-invalid-dep=yes".to_owned()];
    Job {
        files: vec![(CELLS, cells(work)), (MERGE, merge(work))],
        start: vec![sbatch(&[], CELLS), sbatch(&after, MERGE)],
    }
}

fn cells(work: &Work) -> String {
    // The number of the shard and of the cores are Slurm's to say.
    let command = work.shard(0);
    let line: Vec<String> = command
        .iter()
        .enumerate()
        .map(|(i, argument)| match command.get(i.wrapping_sub(1)).map(String::as_str) {
            Some("--shard") => format!("\"$SLURM_ARRAY_TASK_ID/{}\"", work.shards),
            Some("--threads") => "\"$SLURM_CPUS_PER_TASK\"".into(),
            _ => shell(argument),
        })
        .collect();
    format!(
        "#!/bin/sh
# {title}, each a task of this job array.
#
# Submitted in this folder: sbatch {CELLS}
# Cells that are there are not computed again, so it can be submitted as often as need be.
#SBATCH --job-name={name}
#SBATCH --array=0-{last}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={cores}
#SBATCH --output=shard-%a.log
#SBATCH --requeue

exec {line}
",
        title = work.title(),
        name = slug(&work.name),
        last = work.shards.get() - 1,
        cores = work.cores,
        line = line.join(" "),
    )
}

fn merge(work: &Work) -> String {
    format!(
        "#!/bin/sh
# The tables, figures and page of the study, when all its cells are there.
#
# Submitted in this folder, after the array: sbatch {after}{before} {MERGE}
#SBATCH --job-name={name}-merge
#SBATCH --ntasks=1
#SBATCH --output=merge.log
#SBATCH --requeue

exec {line}
",
        after = Job::AFTER,
        before = Job::BEFORE,
        name = slug(&work.name),
        line = shell_line(&work.merge()),
    )
}

#[cfg(test)]
mod tests {
    use super::super::work::tests::work;
    use super::*;

    #[test]
    fn the_array_has_a_task_for_each_shard() {
        let expected = r#"#!/bin/sh
# Study "Poses #SBATCH --exclusive": 8 cells in 4 shards, each a task of this job array.
#
# Submitted in this folder: sbatch cells.sbatch
# Cells that are there are not computed again, so it can be submitted as often as need be.
#SBATCH --job-name=poses-sbatch-exclusive
#SBATCH --array=0-3
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --output=shard-%a.log
#SBATCH --requeue

exec /opt/calipose study cell '/home/o'\''neil/my studies/"k" $HOME.toml' --shard "$SLURM_ARRAY_TASK_ID/4" --output '/scratch/100% new\old' --threads "$SLURM_CPUS_PER_TASK"
"#;
        assert_eq!(cells(&work()), expected);
    }

    #[test]
    fn the_merge_is_one_more_job() {
        let script = merge(&Work { force: true, ..work() });
        let line = r#"exec /opt/calipose study merge '/home/o'\''neil/my studies/"k" $HOME.toml' --output '/scratch/100% new\old' --force"#;
        assert!(script.ends_with(&format!("\n{line}\n")), "{script}");
        assert!(script.contains("\n#SBATCH --job-name=poses-sbatch-exclusive-merge\n"), "{script}");
    }

    #[test]
    fn options_go_to_both_jobs_and_the_merge_waits_for_the_array() {
        let job = job(&work(), &["--partition=short".into(), "--comment=two words".into()]);
        let lines: Vec<String> = job.start.iter().map(|command| shell_line(command)).collect();
        assert_eq!(
            lines,
            [
                "sbatch --parsable --partition=short '--comment=two words' cells.sbatch",
                "sbatch --parsable --partition=short '--comment=two words' --dependency=afterok:JOB --kill-on-invalid-dep=yes merge.sbatch",
            ]
        );
        let job = super::job(&work(), &["--comment=JOB".into()]);
        assert_eq!(job.line(1, "17")[2..4], ["--comment=JOB", "--dependency=afterok:17"]);
    }
}
