//! Safe ways: straight moves proven safe between their ends, and ways round where the straight move is not.
//!
//! What must hold on a way is said as [`Margins`], each with a bound on its change. By these [`prove`] shows a straight move to
//! be safe everywhere, not at samples alone, and [`find`] looks for a way of such moves. That it finds none does not prove that
//! there is none.

mod connect;
mod margins;
mod scout;
mod search;
mod shorten;
mod straight;
mod tree;

#[cfg(test)]
mod tests;

pub use margins::{Margins, Measure};
pub use scout::{Effort, Settings, Space};
pub use search::{End, NoWay, Way, find};
pub use straight::{Failure, Place, Precision, Proof, prove};

/// The configuration at the share `t` of a straight move: no joint beyond its ends by rounding, and on the way back, bit for bit
/// the same at 1 − t where 1 − t is exact.
pub(super) fn between(from: &[f64], to: &[f64], t: f64) -> Vec<f64> {
    let value = |(&a, &b): (&f64, &f64)| match (1.0 - t) * a + t * b {
        value if value < a.min(b) => a.min(b),
        value if value > a.max(b) => a.max(b),
        value => value,
    };
    from.iter().zip(to).map(value).collect()
}
