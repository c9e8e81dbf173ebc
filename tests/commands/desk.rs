//! A desk to try the program at: a folder with a problem, and the program's answers.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// A problem that is solved in no time: the shipped one, swept coarsely, and of swept poses alone.
pub(crate) struct Desk {
    folder: TempDir,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::copy("problems/servosila-engineer.toml", desk.path("coarse.toml")).unwrap();
        desk.change(
            "coarse.toml",
            &[("step_deg = 8", "step_deg = 15"), ("[selection]", "[selection]\noff_grid = false")],
        );
        desk
    }

    /// Writes the coarse problem under another name, with some of its text replaced.
    pub(crate) fn change(&self, name: &str, replacements: &[(&str, &str)]) {
        let mut text = std::fs::read_to_string(self.path("coarse.toml")).unwrap();
        for (from, to) in replacements {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        std::fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program in this folder with arguments as typed.
    pub(crate) fn command(&self, line: &str) -> Command {
        command(self.folder.path(), line)
    }

    pub(crate) fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// What a command that must succeed prints.
    pub(crate) fn stdout(&self, line: &str) -> String {
        stdout(self.folder.path(), line)
    }

    /// The same with its lines joined: prose is wrapped.
    pub(crate) fn prose(&self, line: &str) -> String {
        self.stdout(line).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// What a command prints that did its work and says that its result is bad.
    pub(crate) fn bad(&self, line: &str) -> String {
        let output = self.run(line);
        assert_eq!(output.status.code(), Some(4), "{line}: {}", text(&output.stderr));
        assert_eq!(complaints(&output), "", "{line}");
        text(&output.stdout)
    }

    pub(crate) fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.stdout(line)).unwrap()
    }

    /// What a command that must fail with `code` complains of; stdout must stay empty.
    pub(crate) fn complaint(&self, line: &str, code: i32) -> String {
        complaint(self.folder.path(), line, code)
    }

    pub(crate) fn files(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// The program in `folder` with arguments as typed.
pub(crate) fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_calipose"));
    command.current_dir(folder).args(line.split_whitespace()).stdin(Stdio::null());
    command
}

/// What a command in `folder` that must succeed prints.
pub(crate) fn stdout(folder: &Path, line: &str) -> String {
    let output = command(folder, line).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
    assert_eq!(complaints(&output), "", "{line}");
    text(&output.stdout)
}

/// What is on stderr beside how far the work has come, which a busy machine has time to tell: `sweeping: 3 of 4, 20 s`.
fn complaints(output: &Output) -> String {
    let stderr = text(&output.stderr);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is_progress = |line: &str| {
        let parts = line.strip_suffix(" s").and_then(|line| line.split_once(": "));
        parts.is_some_and(|(stage, rest)| {
            let seconds = rest.rsplit_once(", ").map_or(rest, |(_, seconds)| seconds);
            stage.bytes().all(|byte| byte.is_ascii_lowercase()) && is_number(seconds)
        })
    };
    stderr.split_inclusive('\n').filter(|line| !is_progress(line.trim_end())).collect()
}

/// What a command in `folder` that must fail with `code` complains of; stdout must stay empty.
pub(crate) fn complaint(folder: &Path, line: &str, code: i32) -> String {
    let output = command(folder, line).output().unwrap();
    assert_eq!(output.status.code(), Some(code), "{line}: {}", text(&output.stderr));
    assert_eq!(text(&output.stdout), "", "{line}");
    assert!(!text(&output.stderr).contains("bug"), "{}", text(&output.stderr));
    // Errors are drawn to the terminal's width; the words matter here.
    text(&output.stderr).replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Bytes that must be UTF-8.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Sends a signal to a running program.
pub(crate) fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap().success());
}

/// Whether this process, and so what it starts, ignores a signal; where the system does not tell, it is taken not to.
pub(crate) fn is_ignored_here(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() >> (signal - 1) & 1 == 1)
}
