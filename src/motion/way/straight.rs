//! Proof that a straight move is safe, by what its margins are at some places and how fast they change.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::{Margins, between};

/// Taken off every bound, m: more than the rounding of joint values and of the sums here, for arms of less than a kilometre.
const ROUNDING: f64 = 1e-9;

/// How closely a move is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Precision {
    /// A move with a margin of no more than this somewhere may count as unsafe though it is safe, m; taken as 2 nm at least. A
    /// margin that is as small all along takes the most measurements, up to `2 · change / tolerance`.
    pub tolerance: f64,
    /// How far the least bound may stay below the least margin of the move, m; taken as the tolerance at least. Infinite where
    /// only the verdict matters: bounds are positive then, but may be far too low.
    pub resolution: f64,
}

impl Precision {
    /// Of a tenth of a millimetre, for the verdict alone.
    pub const VERDICT: Self = Self { tolerance: 1e-4, resolution: f64::INFINITY };
}

impl Default for Precision {
    /// A tenth of a millimetre for the verdict, a millimetre for the bounds.
    fn default() -> Self {
        Self { resolution: 1e-3, ..Self::VERDICT }
    }
}

/// A margin measured somewhere on a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Number of the margin.
    pub margin: usize,
    /// Share of the move that lies before the place.
    pub share: f64,
    /// The margin there, m.
    pub value: f64,
}

/// A straight move is safe.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// For each margin, what it does not sink below anywhere on the move, m; positive.
    pub bounds: Vec<f64>,
    /// The least of the margins measured, which the least margin of the move does not exceed. None where all that was measured
    /// were lower bounds.
    pub seen: Option<Place>,
    /// Configurations at which margins were measured.
    pub evaluations: usize,
}

impl Proof {
    /// What no margin sinks below, m; infinite if there are none.
    pub fn least(&self) -> f64 {
        self.bounds.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// A straight move is not safe, or too close to it to tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Failure {
    /// Where, and by which margin. It is not positive, or positive but within the tolerance: too close to tell. NaN counts as
    /// unsafe, and so does any value without a finite bound on its change.
    pub place: Place,
    /// Configurations at which margins were measured.
    pub evaluations: usize,
}

/// Proves that all margins are positive everywhere on the straight move between two configurations (rad or m).
///
/// On a piece of the move that is the share l of it, no place is farther than l/2 from the middle. So a margin that is m in the
/// middle is nowhere on the piece below
///
/// ```text
/// m − change·l/2
/// ```
///
/// Where that is positive, by more than rounding, the margin is shown on the piece. Otherwise the piece is halved for this
/// margin, down to where `change·l/2` is within the tolerance. A move is held to be safe only if each margin is shown on pieces
/// that cover all of it. The piece with the least bound is looked at first (Piyavskii 1972), so that a collision is found early.
///
/// With a finite resolution, pieces are halved also where their bounds are farther than that below the least margin seen, and
/// positive bounds do for margins less than the resolution. So the least bound comes as near to the least margin of the move.
///
/// The verdict is the same there and back.
///
/// # Errors
/// With a place where a margin is not positive, or too small to tell.
pub fn prove(margins: &dyn Margins, from: &[f64], to: &[f64], precision: Precision) -> Result<Proof, Failure> {
    debug_assert_eq!(from.len(), to.len(), "a value for each joint");
    let mut check = Check::new(margins.changes(from, to), precision);
    let mut pieces = BinaryHeap::from([check.whole()]);
    while let Some(piece) = pieces.pop() {
        if check.settles(&piece) {
            continue;
        }
        let open = check.look(&piece, &*margins.at(&between(from, to, piece.middle)))?;
        if !open.is_empty() {
            pieces.extend(piece.halves(open));
        }
    }
    Ok(check.proof)
}

/// A margin not yet shown on a piece of the move.
#[derive(Debug, Clone, Copy)]
struct Open {
    margin: usize,
    /// What it does not sink below on the piece, as far as is known, m.
    bound: f64,
}

/// A piece of the move.
#[derive(Debug)]
struct Piece {
    /// Its middle as a share of the move.
    middle: f64,
    /// Half its length as a share of the move.
    half: f64,
    /// The margins to show on it, the least bound first.
    open: Vec<Open>,
}

impl Piece {
    fn least_bound(&self) -> f64 {
        self.open.first().map_or(f64::INFINITY, |open| open.bound)
    }

    /// Both halves, with what is to show on them. Their middles are exact.
    fn halves(&self, mut open: Vec<Open>) -> [Self; 2] {
        open.sort_by(|a, b| a.bound.total_cmp(&b.bound));
        let half = self.half / 2.0;
        [Self { middle: self.middle - half, half, open: open.clone() }, Self { middle: self.middle + half, half, open }]
    }
}

/// The proof as far as it has come.
struct Check {
    changes: Vec<f64>,
    precision: Precision,
    proof: Proof,
}

impl Check {
    fn new(changes: Vec<f64>, Precision { tolerance, resolution }: Precision) -> Self {
        debug_assert!(!changes.iter().any(|&change| change < 0.0), "{changes:?}");
        let tolerance = tolerance.max(2.0 * ROUNDING);
        let precision = Precision { tolerance, resolution: resolution.max(tolerance) };
        let proof = Proof { bounds: vec![f64::INFINITY; changes.len()], seen: None, evaluations: 0 };
        Self { changes, precision, proof }
    }

    fn whole(&self) -> Piece {
        let open = (0..self.changes.len()).map(|margin| Open { margin, bound: f64::NEG_INFINITY }).collect();
        Piece { middle: 0.5, half: 0.5, open }
    }

    /// What bounds must reach, m; positive. It sinks as smaller margins are seen.
    fn floor(&self) -> f64 {
        if self.precision.resolution == f64::INFINITY {
            return f64::MIN_POSITIVE;
        }
        self.proof.seen.map_or(f64::INFINITY, |seen| (seen.value - self.precision.resolution).max(f64::MIN_POSITIVE))
    }

    /// Whether what is known of a piece suffices, as it may since smaller margins were seen elsewhere; if so, it is noted.
    fn settles(&mut self, piece: &Piece) -> bool {
        let settles = piece.least_bound() >= self.floor();
        if settles {
            piece.open.iter().for_each(|&open| self.show(open));
        }
        settles
    }

    fn show(&mut self, Open { margin, bound }: Open) {
        self.proof.bounds[margin] = self.proof.bounds[margin].min(bound);
    }

    /// Measures in the middle of a piece the margins to show on it; those left to show on its halves.
    fn look(&mut self, piece: &Piece, measure: &dyn Fn(usize, f64) -> f64) -> Result<Vec<Open>, Failure> {
        self.proof.evaluations += 1;
        let mut left = Vec::new();
        for &Open { margin, bound } in &piece.open {
            let fall = self.changes[margin] * piece.half + ROUNDING;
            // By a little more than it takes, so that a bound of so much suffices in spite of rounding.
            let enough = self.floor() + fall + ROUNDING;
            let value = measure(margin, enough);
            let place = Place { margin, share: piece.middle, value };
            if value < enough && self.proof.seen.is_none_or(|seen| value < seen.value) {
                self.proof.seen = Some(place);
            }
            // But for rounding, never less than what was known of the longer piece.
            let open = Open { margin, bound: bound.max(value - fall) };
            if value > 0.0 && open.bound >= self.floor() {
                self.show(open);
            } else if value > 0.0 && fall > self.precision.tolerance && fall.is_finite() {
                left.push(open);
            } else {
                return Err(Failure { place, evaluations: self.proof.evaluations });
            }
        }
        Ok(left)
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The greatest is the one to look at first: that with the least bound.
impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        other.least_bound().total_cmp(&self.least_bound()).then_with(|| self.half.total_cmp(&other.half))
    }
}
