//! Processes that work beside each other.

use std::io::Read;
use std::process::{Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::cli::interrupt::started;

/// Time between two looks at the processes.
const BETWEEN_LOOKS: Duration = Duration::from_millis(10);

/// What a process says.
struct Said {
    out: JoinHandle<String>,
    err: JoinHandle<String>,
}

/// Runs all command lines, so many at a time, and gives what they print. `observe` is told how many are done. When one fails the others
/// are ended.
///
/// # Errors
/// Which of them failed, and what it said.
pub(super) fn run_all(
    commands: &[Vec<String>],
    at_once: usize,
    observe: &dyn Fn(usize),
) -> Result<Vec<String>, (usize, String)> {
    let mut printed = vec![String::new(); commands.len()];
    let mut running: Vec<(usize, Said)> = Vec::new();
    let (mut next, mut done) = (0, 0);
    observe(0);
    while done < commands.len() {
        while next < commands.len() && running.len() < at_once {
            running.push((next, spawn(next, &commands[next]).map_err(|error| failed(next, error.to_string()))?));
            next += 1;
        }
        std::thread::sleep(BETWEEN_LOOKS);
        let mut still = Vec::with_capacity(running.len());
        for (number, said) in running {
            match ended(number).map_err(|error| failed(number, error.to_string()))? {
                None => still.push((number, said)),
                Some(status) => {
                    let (out, err) = (said.out.join().unwrap_or_default(), said.err.join().unwrap_or_default());
                    if !status.success() {
                        let err = err.trim_end();
                        return Err(failed(number, if err.is_empty() { status.to_string() } else { err.to_owned() }));
                    }
                    printed[number] = out;
                    done += 1;
                    observe(done);
                }
            }
        }
        running = still;
    }
    Ok(printed)
}

/// Starts a process, which an interrupt of this one ends.
fn spawn(number: usize, command: &[String]) -> std::io::Result<Said> {
    let (program, arguments) = command.split_first().ok_or(std::io::ErrorKind::InvalidInput)?;
    let mut held = started();
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let said = Said { out: listen(child.stdout.take()), err: listen(child.stderr.take()) };
    held.insert(number, child);
    Ok(said)
}

/// All that comes, so that no process waits for a reader.
fn listen(from: Option<impl Read + Send + 'static>) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What was read before a fault is still of use.
        let _ = from.map(|mut from| from.read_to_end(&mut bytes));
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// How the process of that number ended, if it has.
fn ended(number: usize) -> std::io::Result<Option<ExitStatus>> {
    let mut held = started();
    let Some(child) = held.get_mut(&number) else { return Ok(None) };
    let status = child.try_wait()?;
    if status.is_some() {
        held.remove(&number);
    }
    Ok(status)
}

/// Ends the processes that are left, of which one has failed.
fn failed(number: usize, said: String) -> (usize, String) {
    let mut held = started();
    for child in held.values_mut() {
        // One that has ended meanwhile needs no ending.
        let _ = child.kill();
        let _ = child.wait();
    }
    held.clear();
    (number, said)
}

#[cfg(all(test, unix))]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::time::Instant;

    use super::*;

    fn shell(script: &str) -> Vec<String> {
        ["sh", "-c", script].map(String::from).to_vec()
    }

    /// In one test: the processes of a program are all in one list.
    #[test]
    fn processes_run_beside_each_other_and_end_with_the_first_that_fails() {
        let commands: Vec<Vec<String>> = (0..5).map(|i| shell(&format!("echo {i}"))).collect();
        let counts = std::cell::RefCell::new(Vec::new());
        let printed = run_all(&commands, 2, &|done| counts.borrow_mut().push(done)).unwrap();
        assert_eq!(printed, ["0\n", "1\n", "2\n", "3\n", "4\n"]);
        assert_eq!(counts.into_inner(), [0, 1, 2, 3, 4, 5]);

        let start = Instant::now();
        let commands = [shell("exec sleep 60"), shell("echo why >&2; exit 3"), shell("exec sleep 60")];
        assert_eq!(run_all(&commands, 2, &|_| {}).unwrap_err(), (1, "why".to_owned()));
        assert!(run_all(&[shell("kill -9 $$")], 1, &|_| {}).unwrap_err().1.contains("signal: 9"));
        assert_eq!(run_all(&[vec!["/none".into()]], 1, &|_| {}).unwrap_err().0, 0);
        assert!(start.elapsed() < Duration::from_secs(30));
        assert!(started().is_empty());
    }
}
