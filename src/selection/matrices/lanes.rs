//! The arithmetic of [`packed`](super::packed) on several matrices at once, entry beside entry: to the same bits, lane by lane, but
//! with every vector instruction that the processor has.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

use pulp::{Arch, Simd, WithSimd};

use super::packed::{RESOLUTION, packed_len};

/// How many matrices are worked on at once.
pub(crate) const LANES: usize = 8;

/// One number of each.
pub(crate) type Lanes = [f64; LANES];

/// Allowance for the rounding of a factorisation, as a share of the matrix's trace.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Replaces each packed M by its Cholesky factor, as [`packed::cholesky`](super::packed::cholesky) does: of each matrix whether it has
/// one, and whether the determinant alone shows that it [`packed::is_resolved`](super::packed::is_resolved).
pub(crate) fn factor(m: &mut [Lanes], p: usize) -> ([bool; LANES], [bool; LANES]) {
    Arch::new().dispatch(Factor { m, p })
}

/// Of each factor `tr(Xᵀ M⁻¹ X)`, X being given by its columns of length p one after the other.
pub(crate) fn variance(l: &[Lanes], columns: &[f64], p: usize) -> Lanes {
    let mut short = [[0.0; LANES]; 16];
    let mut long = Vec::new();
    let white = if p <= short.len() {
        &mut short[..p]
    } else {
        long.resize(p, [0.0; LANES]);
        &mut long
    };
    Arch::new().dispatch(SumOfSquares { l, columns, p, white })
}

/// Of each factor L of a matrix the packed product `L₂₂ L₂₂ᵀ` of its last block, without the first `skipped` rows and columns.
pub(crate) fn last_block(l: &[Lanes], p: usize, skipped: usize) -> Vec<Lanes> {
    let row = |i: usize| &l[packed_len(i) + skipped..=packed_len(i) + i];
    let places = (skipped..p).flat_map(|i| (skipped..=i).map(move |j| (i, j)));
    places.map(|(i, j)| dot(row(i), row(j))).collect()
}

/// Of each matrix whether its least eigenvalue may exceed a positive `level`: not if it certainly, beyond rounding, does not.
pub(crate) fn exceed(m: &[Lanes], p: usize, level: f64) -> [bool; LANES] {
    Arch::new().dispatch(Exceed { m, p, level })
}

/// [`factor`], as the others below compiled for every set of instructions that [`Arch`] tells apart. Not by a closure: whether that is
/// inlined where it is dispatched is up to the compiler.
struct Factor<'a> {
    m: &'a mut [Lanes],
    p: usize,
}

impl WithSimd for Factor<'_> {
    type Output = ([bool; LANES], [bool; LANES]);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { m, p } = self;
        (cholesky(m, p), are_clearly_resolved(m, p))
    }
}

/// [`exceed`].
struct Exceed<'a> {
    m: &'a [Lanes],
    p: usize,
    level: f64,
}

impl WithSimd for Exceed<'_> {
    type Output = [bool; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { m, p, level } = self;
        let mut shifted = m.to_vec();
        let diagonal = (0..p).map(|i| packed_len(i) + i);
        let mut trace = [0.0; LANES];
        for place in diagonal.clone() {
            for lane in 0..LANES {
                trace[lane] += m[place][lane];
            }
        }
        for place in diagonal {
            for lane in 0..LANES {
                shifted[place][lane] -= level * (1.0 - 1e-9) - ROUNDING * trace[lane];
            }
        }
        cholesky(&mut shifted, p)
    }
}

#[inline(always)]
fn cholesky(m: &mut [Lanes], p: usize) -> [bool; LANES] {
    let mut is_definite = [true; LANES];
    for i in 0..p {
        let (before, rest) = m.split_at_mut(packed_len(i));
        let row_i = &mut rest[..=i];
        let original = row_i[i];
        for j in 0..i {
            let row_j = &before[packed_len(j)..=packed_len(j) + j];
            let known = dot(&row_i[..j], &row_j[..j]);
            for lane in 0..LANES {
                row_i[j][lane] = (row_i[j][lane] - known[lane]) / row_j[j][lane];
            }
        }
        let known = dot(&row_i[..i], &row_i[..i]);
        for lane in 0..LANES {
            let pivot = original[lane] - known[lane];
            is_definite[lane] &= pivot > 8.0 * f64::EPSILON * original[lane];
            row_i[i][lane] = pivot.sqrt();
        }
    }
    is_definite
}

#[inline(always)]
fn are_clearly_resolved(l: &[Lanes], p: usize) -> [bool; LANES] {
    let mut determinant = [1.0; LANES];
    for i in 0..p {
        let row = &l[packed_len(i)..=packed_len(i) + i];
        let length = dot(row, row);
        for lane in 0..LANES {
            determinant[lane] *= row[i][lane] * row[i][lane] / length[lane];
        }
    }
    determinant.map(|determinant| determinant > std::f64::consts::E * p as f64 * RESOLUTION)
}

/// [`variance`]: the squares of the entries of `L⁻¹ X`; `white` is work space for one of its columns.
struct SumOfSquares<'a> {
    l: &'a [Lanes],
    columns: &'a [f64],
    p: usize,
    white: &'a mut [Lanes],
}

impl WithSimd for SumOfSquares<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Lanes {
        let Self { l, columns, p, white } = self;
        let mut sum = [0.0; LANES];
        for column in columns.chunks_exact(p) {
            let mut squares = [0.0; LANES];
            for i in 0..p {
                let row = &l[packed_len(i)..=packed_len(i) + i];
                let known = dot(&row[..i], &white[..i]);
                for lane in 0..LANES {
                    let x = (column[i] - known[lane]) / row[i][lane];
                    white[i][lane] = x;
                    squares[lane] += x * x;
                }
            }
            for lane in 0..LANES {
                sum[lane] += squares[lane];
            }
        }
        sum
    }
}

/// `Σ aᵢ bᵢ`.
#[inline(always)]
fn dot(a: &[Lanes], b: &[Lanes]) -> Lanes {
    let mut sum = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sum[lane] += a[lane] * b[lane];
        }
    }
    sum
}
