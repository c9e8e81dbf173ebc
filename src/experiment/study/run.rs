//! Computing cells on all cores.

use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use thiserror::Error;

use super::cell::PreparedCell;
use super::store::Store;
use super::{Shard, Study};
use crate::experiment::stages::Stages;
use crate::plan::results::FileError;

/// Cells that are prepared at a time: their problems take memory.
const BATCH: usize = 4096;

/// Why cells could not be computed.
#[derive(Debug, Error)]
pub enum RunError {
    /// A cell cannot be written. Those written before are kept.
    #[error(transparent)]
    File(#[from] FileError),
    /// The machine gives no threads.
    #[error("no threads to work on: {0}")]
    Threads(String),
}

/// Computes the cells of a shard that the store does not have, on `threads` threads, and writes each when it is done. `observe` is
/// told of each cell that is there, whether it had to be computed or not. Gives how many were computed.
///
/// # Errors
/// When a cell cannot be written.
pub fn run(
    study: &Study,
    shard: Shard,
    store: &Store,
    threads: NonZero<usize>,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<usize, RunError> {
    let cells: Vec<usize> = shard.cells(study.cells()).collect();
    let mut computed = 0;
    for batch in cells.chunks(BATCH) {
        let mut prepared: Vec<PreparedCell> = batch
            .par_iter()
            .map(|&index| PreparedCell::new(study, index))
            .filter(|cell| store.cell(&cell.fingerprint).is_none())
            .collect();
        // Cells that differ in name alone are one.
        prepared.sort_by(|a, b| (&a.stages, &a.fingerprint, a.index).cmp(&(&b.stages, &b.fingerprint, b.index)));
        prepared.dedup_by(|a, b| a.fingerprint == b.fingerprint);
        observe(batch.len() - prepared.len());
        compute(study, &prepared, store, threads, &|| observe(1))?;
        computed += prepared.len();
    }
    Ok(computed)
}

/// Computes cells in their order.
///
/// Each worker has threads of its own, and waits where another is at work on a stage that it needs: on shared threads it could be
/// lent to the cell that waits for it.
fn compute(
    study: &Study,
    cells: &[PreparedCell],
    store: &Store,
    threads: NonZero<usize>,
    observe: &(dyn Fn() + Sync),
) -> Result<(), RunError> {
    if cells.is_empty() {
        return Ok(());
    }
    let workers = threads.get().min(cells.len());
    let stages = Stages::new(workers);
    let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let failure = Mutex::new(None);
    let fail = |error: RunError| {
        stopped.store(true, Ordering::Relaxed);
        failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    };
    let work = || {
        while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
            if stopped.load(Ordering::Relaxed) {
                return;
            }
            match store.keep(&cell.compute(study, &stages)) {
                Ok(()) => observe(),
                Err(error) => return fail(error.into()),
            }
        }
    };
    std::thread::scope(|scope| {
        for worker in 0..workers {
            // The threads that are left over go to the first workers.
            let own = threads.get() / workers + usize::from(worker < threads.get() % workers);
            let (work, fail) = (&work, &fail);
            scope.spawn(move || match rayon::ThreadPoolBuilder::new().num_threads(own).build() {
                Ok(pool) => pool.install(work),
                Err(error) => fail(RunError::Threads(error.to_string())),
            });
        }
    });
    match failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(()),
    }
}
