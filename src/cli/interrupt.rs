//! Interrupts: Ctrl-C, a termination, a hang-up. They end a search with the best it has, and the process only between files,
//! never within a group that belongs together.

use std::collections::BTreeMap;
use std::process::Child;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Held while files are written, so that an interrupt waits for them.
static WRITING: Mutex<()> = Mutex::new(());

/// Whether a search is on, which an interrupt ends before it would end the program.
static SEARCHING: AtomicBool = AtomicBool::new(false);

/// Whether it was interrupted.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Processes that work for this one, by their numbers.
static STARTED: Mutex<BTreeMap<usize, Child>> = Mutex::new(BTreeMap::new());

/// Says whether there is a search that can be ended with a result.
pub(super) fn searching(on: bool) {
    SEARCHING.store(on, Ordering::SeqCst);
}

/// Whether a search was interrupted.
pub(super) fn came() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// Writes files that an interrupt waits for.
pub(super) fn writing<T>(write: impl FnOnce() -> T) -> T {
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    write()
}

/// The processes that work for this one, which an interrupt ends with it.
pub(super) fn started() -> MutexGuard<'static, BTreeMap<usize, Child>> {
    STARTED.lock().unwrap_or_else(PoisonError::into_inner)
}

fn interrupt(exit_code: i32) {
    if SEARCHING.load(Ordering::SeqCst) && !INTERRUPTED.swap(true, Ordering::SeqCst) {
        return;
    }
    writing(|| {
        let mut held = started();
        // One that has ended meanwhile needs no ending.
        held.values_mut().for_each(|child| drop(child.kill()));
        std::process::exit(exit_code)
    });
}

/// Handles interrupts from now on. Those that were ignored before, as by `nohup`, stay so. Without a handler they still end
/// the process.
#[cfg(unix)]
pub(super) fn handle() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let ignored = ignored();
    let handled = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let Ok(mut signals) = signal_hook::iterator::Signals::new(handled) else { return };
    std::thread::spawn(move || signals.forever().for_each(|signal| interrupt(128 + signal)));
}

#[cfg(not(unix))]
pub(super) fn handle() {
    drop(ctrlc::set_handler(|| interrupt(130)));
}

/// The signals that are ignored, a bit each from signal 1; none where the system does not tell.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
