//! Work that may take long: its progress, and the time limit of searches. An interrupt ends a search with what it has.

use std::ops::ControlFlow;
use std::time::Instant;

use super::interrupt;
use super::output::Screen;
use crate::continuum::ContinuumProgress;
use crate::problem::Problem;
use crate::selection::SearchProgress;

/// Runs `work`, which sweeps the problem, with an observer that shows how many configurations are done.
pub(super) fn sweeping<T>(screen: &Screen, problem: &Problem, work: impl FnOnce(&(dyn Fn(usize) + Sync)) -> T) -> T {
    let bar = screen.progress("sweeping", problem.space.len());
    let done = work(&|swept| bar.inc(swept as u64));
    bar.finish_and_clear();
    done
}

/// Runs `bound` with an observer that shows progress, and ends it at the problem's time limit or an interrupt with the bound reached.
pub(super) fn bounding<T>(
    screen: &Screen,
    problem: &Problem,
    bound: impl FnOnce(&mut dyn FnMut(&ContinuumProgress) -> ControlFlow<()>) -> T,
) -> T {
    let bar = screen.progress("bounding", problem.selection.continuum.most_boxes);
    let start = Instant::now();
    interrupt::searching(true);
    let mut observe = |progress: &ContinuumProgress| {
        bar.set_position(progress.boxes as u64);
        while_time(problem, start)
    };
    let done = bound(&mut observe);
    interrupt::searching(false);
    bar.finish_and_clear();
    done
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
        interrupt::searching(true);
        bar.set_message(format!(
            "{} nodes, {} waiting, gap {:.4} %",
            progress.nodes,
            progress.open,
            100.0 * (progress.log_bound - progress.log_value).exp_m1(),
        ));
        bar.tick();
        while_time(problem, start)
    };
    let selected = select(&mut observe);
    interrupt::searching(false);
    bar.finish_and_clear();
    selected
}

/// Whether a search goes on that began at `start`.
fn while_time(problem: &Problem, start: Instant) -> ControlFlow<()> {
    if start.elapsed() >= problem.selection.time_limit || interrupt::came() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}
