//! Searches that may take long: their progress, their time limit, and the interrupt that ends them with what they have.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::screen::Screen;
use crate::problem::Problem;
use crate::selection::SearchProgress;

/// Whether a search is on, which an interrupt ends before it would end the program.
static SEARCHING: AtomicBool = AtomicBool::new(false);

/// Whether it was interrupted.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Tells a search, if one is on, to end; `false` if there is none or it was told before.
pub(super) fn interrupt() -> bool {
    SEARCHING.load(Ordering::SeqCst) && !INTERRUPTED.swap(true, Ordering::SeqCst)
}

/// Runs `select` with an observer that shows progress, and ends searches at the problem's time limit or an interrupt.
pub(super) fn searching<T>(
    screen: &Screen,
    problem: &Problem,
    select: impl FnOnce(&mut dyn FnMut(&SearchProgress) -> ControlFlow<()>) -> T,
) -> T {
    let bar = screen.spinner("selecting");
    let start = Instant::now();
    let mut observe = |progress: &SearchProgress| {
        // From here on there is a set to end with.
        SEARCHING.store(true, Ordering::SeqCst);
        bar.set_message(format!(
            "{} nodes, {} waiting, gap {:.4} %",
            progress.nodes,
            progress.open,
            100.0 * (progress.log_bound - progress.log_value).exp_m1(),
        ));
        bar.tick();
        if start.elapsed() >= problem.selection.time_limit || INTERRUPTED.load(Ordering::SeqCst) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let selected = select(&mut observe);
    SEARCHING.store(false, Ordering::SeqCst);
    bar.finish_and_clear();
    selected
}
