//! A view's own pose eliminated from the rows of its corners.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

use pulp::{Arch, Simd, WithSimd};

use crate::camera::MAX_INTRINSICS;
use crate::lanes::Lanes;
use crate::selection::packed::packed_len;
use crate::target::Warp;

/// Variables of a pose.
pub(super) const POSE: usize = 6;

/// Columns of a row at most: the pose, the board's heights, the intrinsics.
pub(super) const MOST_COLUMNS: usize = POSE + Warp::HEIGHTS + MAX_INTRINSICS;

/// Rows that are eliminated together.
const BLOCK: usize = 96;

/// Rows that are worked on side by side. The sums are of these first, whatever the processor: to the same bits on all.
pub(super) const LANES: usize = 8;

/// Columns whose dot products with one are taken together: each waits for its own sums, not for the others'.
const TOGETHER: usize = 4;

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

    /// Adds two rows of each of the first `count` corners, by columns; what is beyond its own is not looked at.
    #[inline(always)]
    pub(super) fn add(&mut self, rows: &[[Lanes<LANES>; 2]; MOST_COLUMNS], count: usize) {
        if self.waiting + 2 * count > BLOCK {
            self.eliminate();
        }
        for (column, [u, v]) in self.columns.iter_mut().zip(rows) {
            let pairs = column[self.waiting..self.waiting + 2 * count].chunks_exact_mut(2);
            for (pair, (u, v)) in pairs.zip(u.0.iter().zip(v.0)) {
                pair.copy_from_slice(&[*u, v]);
            }
        }
        self.waiting += 2 * count;
    }

    /// Takes the waiting rows in.
    #[inline(never)]
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
        let mut products = &mut products[..];
        for i in POSE..columns.len() {
            let (row, rest) = products.split_at_mut(i - POSE + 1);
            let own = &columns[i][..length];
            for (products, columns) in row.chunks_mut(TOGETHER).zip(columns[POSE..=i].chunks(TOGETHER)) {
                for (product, dot) in products.iter_mut().zip(dots(own, columns)) {
                    *product += dot;
                }
            }
            products = rest;
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
        let [square] = dots_of(own, [&before[k]]);
        let norm = (pivot * pivot + square).sqrt();
        if norm == 0.0 {
            continue;
        }
        let top = pivot + norm.copysign(pivot);
        // 2 / vᵀv of the reflection's vector v.
        let scale = 1.0 / (norm * (norm + pivot.abs()));
        R_k[k] = -norm.copysign(pivot);
        for (entries, columns) in R_k[k + 1..].chunks_mut(TOGETHER).zip(after.chunks_mut(TOGETHER)) {
            let dots = dots(own, columns);
            for ((entry, column), dot) in entries.iter_mut().zip(columns).zip(dots) {
                let along = (top * *entry + dot) * scale;
                *entry -= top * along;
                for (entry, own) in column.iter_mut().zip(own) {
                    *entry -= own * along;
                }
            }
        }
    }
}

/// Of a column whose length is a multiple of [`LANES`] with each of at most [`TOGETHER`] others.
#[inline(always)]
fn dots(own: &[f64], columns: &[[f64; BLOCK]]) -> [f64; TOGETHER] {
    match columns {
        [a, b, c, d] => dots_of(own, [a, b, c, d]),
        [a, b, c] => {
            let [a, b, c] = dots_of(own, [a, b, c]);
            [a, b, c, 0.0]
        }
        [a, b] => {
            let [a, b] = dots_of(own, [a, b]);
            [a, b, 0.0, 0.0]
        }
        [a] => {
            let [a] = dots_of(own, [a]);
            [a, 0.0, 0.0, 0.0]
        }
        _ => unreachable!("columns are taken by {TOGETHER}"),
    }
}

/// The dot product with each of the columns.
#[inline(always)]
fn dots_of<const N: usize>(own: &[f64], columns: [&[f64; BLOCK]; N]) -> [f64; N] {
    let mut sums = [[0.0; LANES]; N];
    for (c, own) in own.chunks_exact(LANES).enumerate() {
        for (sums, column) in sums.iter_mut().zip(columns) {
            let column = &column[c * LANES..(c + 1) * LANES];
            for lane in 0..LANES {
                sums[lane] += own[lane] * column[lane];
            }
        }
    }
    sums.map(|sums| sums.iter().sum())
}
