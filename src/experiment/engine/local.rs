//! Processes on this machine.

use super::job::Job;
use super::quoting::shell_line;
use super::work::Work;

/// Name of the script.
pub(super) const FILE: &str = "local.sh";

/// A script with the command lines that are started as processes; run by itself it does the same, one after the other.
pub(super) fn job(work: &Work) -> Job {
    let title = work.title();
    let shards: Vec<String> = (0..work.shards.get()).map(|shard| shell_line(&work.shard(shard))).collect();
    let script = format!(
        "#!/bin/sh
# {title}, and the merge.
#
# These are the processes of the job. Run by itself, as `sh {FILE}`, this script works on one after the other. Cells that are there
# are not computed again.
set -e

{shards}

{merge}
",
        shards = shards.join("\n"),
        merge = shell_line(&work.merge()),
    );
    Job { files: vec![(FILE, script)], start: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::super::work::tests::work;
    use super::*;

    #[test]
    fn the_script_has_a_line_for_each_process() {
        let job = job(&work());
        let script = &job.files[0].1;
        let file = r#"'/home/o'\''neil/my studies/"k" $HOME.toml'"#;
        let output = r"'/scratch/100% new\old'";
        for shard in 0..4 {
            let line = format!("/opt/calipose study cell {file} --shard {shard}/4 --output {output} --threads 1\n");
            assert!(script.contains(&line), "{script}");
        }
        assert!(script.ends_with(&format!("\n/opt/calipose study merge {file} --output {output}\n")), "{script}");
        assert!(job.start.is_empty());
    }
}
