//! What a study will take.

use std::collections::BTreeSet;
use std::num::NonZero;
use std::time::Instant;

use rayon::prelude::*;

use super::Study;
use super::cell::PreparedCell;
use crate::experiment::stages::Stages;
use crate::plan::document::{Document, StudyCheckDocument};

/// What a run of a study takes on this machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Cells.
    pub cells: usize,
    /// Surveys: cells that differ in nothing that one depends on share it.
    pub surveys: usize,
    /// Rows of the table.
    pub rows: usize,
    /// Seconds.
    pub seconds: f64,
    /// Bytes on the disk.
    pub bytes: f64,
}

/// Cells that are looked at to count what is shared.
const LOOKED_AT: usize = 2000;

/// Cells that are tried, at most and at least one, and for how long.
const TRIED: usize = 8;
const TRYING: f64 = 2.0;

/// Bytes of a row in the tables, and of the page and figures.
const ROW: f64 = 600.0;
const PAGE: f64 = 2e6;

impl Forecast {
    /// From some cells, which are computed, and thrown away; `None` where the machine gives no threads.
    pub fn new(study: &Study, threads: NonZero<usize>) -> Option<Self> {
        // A cell has one thread to itself.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().ok()?;
        let cells = study.cells();
        let stride = cells.div_ceil(LOOKED_AT).max(1);
        let looked_at: Vec<usize> = (0..cells).step_by(stride).collect();
        let seen: Vec<PreparedCell> = looked_at.into_par_iter().map(|i| PreparedCell::new(study, i)).collect();
        let kinds: BTreeSet<_> = seen.iter().filter_map(|cell| cell.stages).collect();
        let own = seen.iter().filter(|cell| cell.stages.is_none()).count();
        let shared = (kinds.len() + own) as f64 / seen.len() as f64;
        let start = Instant::now();
        let (mut survey, mut rest, mut bytes, mut rows, mut tried) = (0.0, 0.0, 0.0, 0, 0);
        // All over the cells, the last first: what costs most often stands at the end.
        let picks = [7, 3, 5, 1, 6, 2, 4, 0].map(|eighth| (2 * eighth + 1) * seen.len() / (2 * TRIED));
        while tried < TRIED.min(seen.len()) && (tried == 0 || start.elapsed().as_secs_f64() < TRYING) {
            let cell = &seen[picks[tried]];
            let found = pool.install(|| cell.compute(study, &Stages::new(1)));
            survey += found.seconds.survey;
            rest += found.seconds.rows;
            bytes += found.to_json().len() as f64;
            rows += found.rows.len();
            tried += 1;
        }
        let each = cells as f64 / tried as f64;
        let rows = rows as f64 * each;
        Some(Self {
            cells,
            surveys: (shared * cells as f64).ceil() as usize,
            rows: rows.round() as usize,
            seconds: (survey * shared + rest) * each / threads.get() as f64,
            bytes: bytes * each + rows * ROW + PAGE,
        })
    }

    /// The forecast as a document.
    pub fn document(&self, study: &Study) -> StudyCheckDocument {
        let Self { cells, surveys, rows, seconds, bytes } = *self;
        StudyCheckDocument {
            header: StudyCheckDocument::header(),
            name: study.name.clone(),
            sha256: study.sha256.clone(),
            cells,
            surveys,
            rows,
            seconds,
            bytes,
            output: study.output.clone(),
        }
    }
}
