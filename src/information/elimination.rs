//! A view's own pose eliminated from the rows of its corners.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

use pulp::{Arch, Simd, WithSimd};

use crate::camera::MAX_INTRINSICS;
use crate::selection::packed::packed_len;
use crate::target::Warp;

/// Variables of a pose.
pub(super) const POSE: usize = 6;

/// Columns of a row at most: the pose, the board's heights, the intrinsics.
pub(super) const MOST_COLUMNS: usize = POSE + Warp::HEIGHTS + MAX_INTRINSICS;

/// Rows that are eliminated together.
const BLOCK: usize = 96;

/// Rows that are worked on side by side. The sums are of these first, whatever the processor: to the same bits on all.
const LANES: usize = 8;

/// A pose's variable of which its column leaves no more than this share beside the others before it is not determined.
const UNDETERMINED: f64 = 1e-12;

/// The pose's six variables eliminated from the rows of [B A], by reflections: what B does not explain of A is left before
/// anything is squared. A long lens sees a change of its principal point all but as a turn of the camera, and the
/// difference of the squares, `AᵀA − AᵀB (BᵀB)⁻¹ BᵀA`, would lose twice the digits.
pub(super) struct Elimination {
    /// The six rows of `R` in `[B A] = Q R`, of the rows so far.
    R: [[f64; MOST_COLUMNS]; POSE],
    /// Rows that wait, by columns; zeros below them.
    columns: Vec<[f64; BLOCK]>,
    waiting: usize,
    /// `A⊥ᵀA⊥` of the rows done, p×p packed.
    products: Vec<f64>,
}

impl Elimination {
    /// Of rows of six entries of B and p of A.
    pub(super) fn new(p: usize) -> Self {
        Self {
            R: [[0.0; MOST_COLUMNS]; POSE],
            columns: vec![[0.0; BLOCK]; POSE + p],
            waiting: 0,
            products: vec![0.0; packed_len(p)],
        }
    }

    /// Adds a row; what is beyond its own columns is not looked at.
    pub(super) fn add(&mut self, row: &[f64; MOST_COLUMNS]) {
        for (column, &entry) in self.columns.iter_mut().zip(row) {
            column[self.waiting] = entry;
        }
        self.waiting += 1;
        if self.waiting == BLOCK {
            self.eliminate();
        }
    }

    /// Takes the waiting rows in.
    fn eliminate(&mut self) {
        let length = self.waiting.next_multiple_of(LANES);
        Arch::new().dispatch(Waiting { elimination: self, length });
        for column in &mut self.columns {
            column[..length].fill(0.0);
        }
        self.waiting = 0;
    }

    /// `A⊥ᵀA⊥`, packed; `None` if the pose is not determined.
    pub(super) fn finish(mut self) -> Option<Vec<f64>> {
        self.eliminate();
        let determined = |k: usize| {
            let column = (0..=k).map(|i| self.R[i][k] * self.R[i][k]).sum::<f64>().sqrt();
            self.R[k][k].abs() > UNDETERMINED * column
        };
        (0..POSE).all(determined).then_some(self.products)
    }
}

/// The arithmetic of [`Elimination::eliminate`] on so many rows, compiled for every set of instructions that [`Arch`] tells apart. Not by a
/// closure: whether that is inlined where it is dispatched is up to the compiler.
struct Waiting<'a> {
    elimination: &'a mut Elimination,
    length: usize,
}

impl WithSimd for Waiting<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { elimination: Elimination { R, columns, products, .. }, length } = self;
        reflect(R, columns, length);
        let mut products = products.iter_mut();
        for i in POSE..columns.len() {
            for (j, product) in (POSE..=i).zip(&mut products) {
                *product += dot(&columns[i][..length], &columns[j][..length]);
            }
        }
    }
}

/// A Householder reflection for each pose variable k, of row k of R and the waiting rows, clears its column in these. What is left of
/// their other columns is orthogonal to B.
#[inline(always)]
fn reflect(R: &mut [[f64; MOST_COLUMNS]; POSE], columns: &mut [[f64; BLOCK]], length: usize) {
    for (k, R_k) in R.iter_mut().enumerate() {
        let (before, after) = columns.split_at_mut(k + 1);
        let own = &before[k][..length];
        let pivot = R_k[k];
        let norm = (pivot * pivot + dot(own, own)).sqrt();
        if norm == 0.0 {
            continue;
        }
        let top = pivot + norm.copysign(pivot);
        // 2 / vᵀv of the reflection's vector v.
        let scale = 1.0 / (norm * (norm + pivot.abs()));
        R_k[k] = -norm.copysign(pivot);
        for (entry, column) in R_k[k + 1..].iter_mut().zip(after) {
            let column = &mut column[..length];
            let along = (top * *entry + dot(own, column)) * scale;
            *entry -= top * along;
            for (entry, own) in column.iter_mut().zip(own) {
                *entry -= own * along;
            }
        }
    }
}

/// Of columns whose length is a multiple of [`LANES`].
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum()
}
