//! The files of a plan's folder, and `run.json`, which tells how they came about and holds their hashes.
//!
//! A run may be killed while it writes. `run.json` is replaced first and `plan.json` last, so that whatever is between them
//! is found out by the hashes: a plan that has its own is among files of its own run.

mod files;

pub use files::{FileError, probe, write_atomically, write_together};

use std::path::Path;

use sha2::{Digest, Sha256};

use crate::plan::document::{Document, Run};
use crate::problem::Problem;
use files::Held;

/// Name of the file with the plan, by which the others are of one run or not.
pub const PLAN_FILE: &str = "plan.json";

/// Name of the file with the hashes.
pub const RUN_FILE: &str = "run.json";

/// Name of the file that tells how far the plan was carried out.
pub const FOLLOW_FILE: &str = "follow.json";

/// Files beside a plan that not every run writes; those of one plan must not stay beside another.
pub const OPTIONAL_FILES: [&str; 9] = [
    "verification.json",
    "report.html",
    "views.csv",
    "views.parquet",
    "polished.json",
    "polished.csv",
    "next.json",
    "next.csv",
    FOLLOW_FILE,
];

impl Run {
    /// The run that left its `run.json` in `folder`; `None` if there is none that can be read.
    pub fn read(folder: &Path) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(folder.join(RUN_FILE)).ok()?).ok()
    }
}

/// Writes a plan and the files that belong to it to `folder`, in place of those of the plan before; the last of `files` is
/// the plan. What was made from another plan is removed, what was made from this one stays. Gives the names of the removed.
///
/// # Errors
/// When a file cannot be written.
pub fn write_results(folder: &Path, run: &mut Run, files: &[(&str, Vec<u8>)]) -> Result<Vec<&'static str>, FileError> {
    let held = Held::new(folder)?;
    let removed = enter(folder, run, files);
    held.write(&with_run(&run.to_json(), files), &removed)?;
    Ok(removed)
}

/// Enters the files into `run`, and those in `folder` that still hold. Gives the names of those that do not.
fn enter(folder: &Path, run: &mut Run, files: &[(&str, Vec<u8>)]) -> Vec<&'static str> {
    let same = |(name, bytes): &(&str, Vec<u8>)| std::fs::read(folder.join(name)).is_ok_and(|old| old == *bytes);
    let same_plan = files.last().is_some_and(same);
    let before = Run::read(folder).map(|run| run.files).unwrap_or_default();
    run.files = files.iter().map(|(name, bytes)| ((*name).to_owned(), hash(bytes))).collect();
    let mut removed = Vec::new();
    let others = OPTIONAL_FILES.into_iter().filter(|name| files.iter().all(|(written, _)| written != name));
    for name in others.filter(|name| folder.join(name).symlink_metadata().is_ok()) {
        match before.get(name) {
            _ if !same_plan => removed.push(name),
            Some(hash) => drop(run.files.insert(name.to_owned(), hash.clone())),
            None => {}
        }
    }
    removed
}

/// Writes files that were made from the plan at `path`, whose contents are `plan`, beside it, and enters them into the
/// `run.json` there: into `run`, which takes its place, or into the one that knows the plan.
///
/// # Errors
/// When a file cannot be written, and when the plan was replaced meanwhile.
pub fn add_results(path: &Path, plan: &[u8], run: Option<&Run>, files: &[(&str, Vec<u8>)]) -> Result<(), FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let held = Held::new(folder)?;
    still_there(path, plan, files.first().map_or("", |(name, _)| name))?;
    let run = run.cloned().or_else(|| Run::read(folder).filter(|run| run.files.get(PLAN_FILE) == Some(&hash(plan))));
    let Some(mut run) = run else { return held.write(files, &[]) };
    run.files.extend(files.iter().map(|(name, bytes)| ((*name).to_owned(), hash(bytes))));
    held.write(&with_run(&run.to_json(), files), &[])
}

/// Writes the file `name` with `bytes` beside the plan at `path`, whose contents are `plan`, in place of `before`, what was written there
/// last. `run.json` does not tell of it: it changes while the plan is carried out, and a run killed between the two would make the plan
/// look torn.
///
/// # Errors
/// When the file cannot be written, and when the plan or the file was replaced meanwhile.
pub fn keep_beside(path: &Path, plan: &[u8], name: &str, before: Option<&[u8]>, bytes: &[u8]) -> Result<(), FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let held = Held::new(folder)?;
    still_there(path, plan, name)?;
    let path = folder.join(name);
    if before.is_some_and(|before| std::fs::read(&path).is_ok_and(|now| now != before)) {
        let source = std::io::Error::other("another program wrote it meanwhile");
        return Err(FileError { path, source, done: Vec::new() });
    }
    held.write(&[(name, bytes)], &[])
}

/// That the plan at `path` is still `plan`, before the file `name` is written beside it.
fn still_there(path: &Path, plan: &[u8], name: &str) -> Result<(), FileError> {
    if std::fs::read(path).is_ok_and(|now| now != plan) {
        let source = std::io::Error::other(format!("{} was replaced meanwhile", path.display()));
        let path = path.parent().unwrap_or(Path::new("")).join(name);
        return Err(FileError { path, source, done: Vec::new() });
    }
    Ok(())
}

/// The files to write, `run.json` first.
fn with_run<'a>(run: &'a str, files: &'a [(&'a str, Vec<u8>)]) -> Vec<(&'a str, &'a [u8])> {
    let files = files.iter().map(|(name, bytes)| (*name, bytes.as_slice()));
    std::iter::once((RUN_FILE, run.as_bytes())).chain(files).collect()
}

/// Names of the files beside the plan at `path` (and of itself) that are not as the run wrote them that left its `run.json`
/// there. Files that are no longer there are not missed; without a `run.json` that knows the plan's file, there is nothing to
/// check.
pub fn check_results(path: &Path) -> Vec<String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = Run::read(folder).map(|run| run.files).unwrap_or_default();
    if path.file_name().is_none_or(|name| !files.keys().any(|known| name == known.as_str())) {
        return Vec::new();
    }
    let changed = |name: &String, then: &String| match std::fs::read(folder.join(name)) {
        Ok(bytes) => hash(&bytes) != *then,
        Err(error) => error.kind() != std::io::ErrorKind::NotFound,
    };
    files.iter().filter(|(name, then)| changed(name, then)).map(|(name, _)| name.clone()).collect()
}

/// Whose plan is in `folder`, where it is that of another problem than `problem`, which `file` states. A problem file that was
/// changed or moved is the same; one of another name and contents is another.
pub fn owner(folder: &Path, problem: &Problem, file: &Path) -> Option<String> {
    let path = folder.join(PLAN_FILE);
    path.symlink_metadata().ok()?;
    let same = |name: &str, sha256: &str| sha256 == problem.sha256 || name == problem.name;
    let Some(Run { problem: theirs, .. }) = Run::read(folder) else {
        let plan: serde_json::Value = serde_json::from_slice(&std::fs::read(path).ok()?).unwrap_or_default();
        let reference = |key: &str| plan["problem"][key].as_str();
        return match (reference("name"), reference("sha256")) {
            (Some(name), Some(sha256)) if same(name, sha256) => None,
            (Some(name), Some(_)) => Some(format!("\"{name}\"")),
            _ => Some("no problem".into()),
        };
    };
    let Some(their_file) = theirs.file.filter(|file| file.is_file()) else {
        return (!same(&theirs.name, &theirs.sha256)).then(|| format!("\"{}\"", theirs.name));
    };
    let path = |file: &Path| file.canonicalize().ok();
    let same = path(&their_file) == path(file) || theirs.sha256 == problem.sha256;
    (!same).then(|| format!("{} (\"{}\")", their_file.display(), theirs.name))
}

/// Waits until no run writes beside the plan at `path`; none begins to before the handle is dropped.
pub fn hold_to_read(path: &Path) -> Option<std::fs::File> {
    Held::to_read(path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")))
}

/// SHA-256 of a file's bytes, in hexadecimal.
pub fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |hex, byte| format!("{hex}{byte:02x}"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::collections::BTreeMap;

    use super::*;
    use crate::plan::document::{RunProblem, RunSeconds};
    use crate::plan::results::files::Step;

    fn run() -> Run {
        let problem = RunProblem { name: "arm".into(), sha256: "0".into(), file: None };
        let seconds = RunSeconds { survey: 0.0, selection: 0.0, total: 0.0 };
        Run { header: Run::header(), problem, threads: 1, seconds, files: BTreeMap::new() }
    }

    fn files(names: &[&'static str], made: &str) -> Vec<(&'static str, Vec<u8>)> {
        names.iter().map(|&name| (name, format!("{name} {made}").into_bytes())).collect()
    }

    fn contents(folder: &Path) -> BTreeMap<String, String> {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
        let text = |entry: std::fs::DirEntry| {
            (entry.file_name().into_string().unwrap(), std::fs::read_to_string(entry.path()).unwrap())
        };
        entries.map(text).collect()
    }

    /// The plan before, with all that can be made of it.
    fn old(folder: &Path) {
        let mut run = run();
        write_results(folder, &mut run, &files(&["views.csv", "plan.csv", PLAN_FILE], "old")).unwrap();
        let path = folder.join(PLAN_FILE);
        let made = files(&["verification.json", "polished.csv", "polished.json"], "old");
        add_results(&path, b"plan.json old", None, &made).unwrap();
        assert_eq!(check_results(&path), [""; 0]);
    }

    #[test]
    fn a_run_killed_between_any_two_steps_leaves_one_set_whole_or_is_found_out() {
        let new = files(&["views.parquet", "plan.csv", PLAN_FILE], "new");
        let mut outcomes = Vec::new();
        for (over, killed_after) in (0..=8).map(|n| (true, n)).chain((0..=4).map(|n| (false, n))) {
            let folder = tempfile::tempdir().unwrap();
            let folder = folder.path();
            if over {
                old(folder);
            }
            let before = contents(folder);
            let held = Held::new(folder).unwrap();
            let mut entered = run();
            let removed = enter(folder, &mut entered, &new);
            let steps = held.steps(&with_run(&entered.to_json(), &new), &removed).unwrap();
            let count = steps.len();
            for (i, step) in steps.into_iter().enumerate() {
                match step {
                    step if i < killed_after => step.take().unwrap(),
                    Step::Replace { staged, .. } => drop(staged.keep().unwrap()),
                    Step::Remove(_) => {}
                }
            }
            drop(held);
            let mut after = contents(folder);
            after.retain(|name, _| !name.starts_with('.'));
            let is_new =
                |(name, bytes): &(&str, Vec<u8>)| after.get(*name).is_some_and(|text| text.as_bytes() == bytes);
            let whole = after == before || (new.iter().all(is_new) && after.len() == new.len() + 1);
            let found_out = !after.contains_key(PLAN_FILE) || !check_results(&folder.join(PLAN_FILE)).is_empty();
            assert!(
                whole != found_out || !over && !after.contains_key(PLAN_FILE),
                "{killed_after} of {count}: {after:?}"
            );
            outcomes.push(whole);

            // The next run makes it good, and leaves nothing of the killed one behind.
            write_results(folder, &mut run(), &new).unwrap();
            assert_eq!(contents(folder).len(), new.len() + 1, "{:?}", contents(folder).keys());
            assert_eq!(check_results(&folder.join(PLAN_FILE)), [""; 0]);
        }
        let torn = outcomes.iter().filter(|whole| !**whole).count();
        assert_eq!((outcomes.len(), torn), (14, 10));
    }

    #[test]
    fn what_was_made_of_the_same_plan_stays_and_of_another_goes() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        old(folder);
        let removed = write_results(folder, &mut run(), &files(&["plan.csv", PLAN_FILE], "old")).unwrap();
        assert_eq!((removed.len(), contents(folder).len()), (0, 7));
        assert_eq!(check_results(&folder.join(PLAN_FILE)), [""; 0]);
        let removed = write_results(folder, &mut run(), &files(&["plan.csv", PLAN_FILE], "new")).unwrap();
        assert_eq!(removed, ["verification.json", "views.csv", "polished.json", "polished.csv"]);
        assert_eq!(contents(folder).len(), 3);
    }

    #[test]
    fn a_changed_file_is_named_and_a_missing_one_is_not_missed() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        old(folder);
        let plan = folder.join(PLAN_FILE);
        std::fs::remove_file(folder.join("views.csv")).unwrap();
        std::fs::write(folder.join("notes.txt"), "mine").unwrap();
        assert_eq!(check_results(&plan), [""; 0]);
        std::fs::write(folder.join("plan.csv"), "changed").unwrap();
        assert_eq!(check_results(&plan), ["plan.csv"]);
        // A copy under another name is not of the set.
        std::fs::copy(&plan, folder.join("kept.json")).unwrap();
        assert_eq!(check_results(&folder.join("kept.json")), [""; 0]);
    }

    #[test]
    fn what_was_made_of_a_plan_that_is_gone_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        old(folder);
        let before = contents(folder);
        let made = files(&["polished.csv"], "new");
        let error = add_results(&folder.join(PLAN_FILE), b"another plan", None, &made).unwrap_err();
        assert!(error.source.to_string().contains("replaced meanwhile"));
        assert_eq!(contents(folder), before);
    }

    #[test]
    fn what_changes_with_the_tour_is_kept_beside_its_plan_alone() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        old(folder);
        let plan = folder.join(PLAN_FILE);
        let keep = |before: Option<&[u8]>, bytes: &[u8]| {
            keep_beside(&plan, b"plan.json old", FOLLOW_FILE, before, bytes).map_err(|error| error.source.to_string())
        };
        keep(None, b"1").unwrap();
        keep(Some(b"1"), b"2").unwrap();
        // It is in nobody's way, and stays with its plan.
        assert_eq!(check_results(&plan), [""; 0]);
        assert_eq!(write_results(folder, &mut run(), &files(&["plan.csv", PLAN_FILE], "old")).unwrap(), [""; 0]);
        assert!(keep(Some(b"1"), b"3").unwrap_err().contains("another program wrote it"));
        assert_eq!(std::fs::read(folder.join(FOLLOW_FILE)).unwrap(), b"2");
        let removed = write_results(folder, &mut run(), &files(&["plan.csv", PLAN_FILE], "new")).unwrap();
        assert!(removed.contains(&FOLLOW_FILE));
        assert!(keep(None, b"3").unwrap_err().contains("replaced meanwhile"));
        assert!(!folder.join(FOLLOW_FILE).exists());
    }
}
