//! Why a selection problem is ill-posed.

use thiserror::Error;

use super::InformationError;
use super::group::Group;

/// Why nothing can be selected.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SelectionError {
    /// More views are asked for than there are candidates, or none.
    #[error("{count} of {candidates} candidates cannot be selected; ask for at least 1 and at most {candidates}")]
    Count {
        /// Number asked for.
        count: usize,
        /// Number of candidates.
        candidates: usize,
    },
    /// A matrix is of another order than the candidates'.
    #[error("the {what} is of order {found}, the candidates' matrices of order {expected}")]
    Order {
        /// What does not fit.
        what: &'static str,
        /// Order of the candidates.
        expected: usize,
        /// Its order.
        found: usize,
    },
    /// The terms are of different candidates, or their shares do not add up to one.
    #[error(
        "the terms have {candidates:?} candidates and shares that add up to {shares}; all must have the same \
             candidates, and positive shares must add up to 1"
    )]
    Terms {
        /// Number of candidates of each.
        candidates: Vec<usize>,
        /// Sum of the shares.
        shares: f64,
    },
    /// The prior is not an information matrix.
    #[error("the prior is refused: {0}")]
    Prior(InformationError),
    /// The weight of a variance is zero or not finite.
    #[error("the weight of the variance is zero or not finite; nothing can be made small by it")]
    Weight,
    /// A selection names a candidate that does not exist.
    #[error("candidate {candidate} is selected; there are {candidates}, counted from 0")]
    OutOfRange {
        /// The candidate named.
        candidate: usize,
        /// Number of candidates.
        candidates: usize,
    },
    /// A selection names a candidate twice.
    #[error("candidate {candidate} is selected twice")]
    Twice {
        /// The candidate.
        candidate: usize,
    },
    /// A relaxation starts from too few candidates.
    #[error("the relaxation starts from {found} candidates; it needs at least the {count} that are to be selected")]
    TooFew {
        /// Number to be selected.
        count: usize,
        /// Number to start from.
        found: usize,
    },
    /// Packed matrices are of another length than the terms' orders ask for.
    #[error("the {what} has {found} numbers; the terms' packed matrices have {expected} in all")]
    Length {
        /// What does not fit.
        what: &'static str,
        /// Numbers of the terms' matrices, p(p+1)/2 each.
        expected: usize,
        /// Its numbers.
        found: usize,
    },
    /// A certificate prices a group that does not exist.
    #[error("{group} has a price, but there is no such group")]
    NoSuchGroup {
        /// The group priced.
        group: Group,
    },
    /// A constraint names a candidate that does not exist.
    #[error("the constraints name candidate {candidate}; there are {candidates}, counted from 0")]
    NoSuchCandidate {
        /// The candidate named.
        candidate: usize,
        /// Number of candidates.
        candidates: usize,
    },
    /// The points of a separation do not fit the candidates.
    #[error(
        "a separation needs {dimension} finite coordinates for each of the {candidates} candidates and a distance of at \
             least 0; it has {coordinates} coordinates"
    )]
    Separation {
        /// Number of coordinates of all points.
        coordinates: usize,
        /// Coordinates of a point.
        dimension: usize,
        /// Number of candidates.
        candidates: usize,
    },
    /// A candidate must be in and must not.
    #[error("candidate {candidate} is required and forbidden")]
    RequiredAndForbidden {
        /// The candidate.
        candidate: usize,
    },
    /// The required candidates alone break a cap.
    #[error("{required} required candidates are in group {group}, which may have {most}")]
    RequiredAboveCap {
        /// The group, from 0.
        group: usize,
        /// Required candidates in it.
        required: usize,
        /// How many it may have.
        most: usize,
    },
    /// Two required candidates are too close to each other.
    #[error("the required candidates {first} and {second} are {distance} apart; the least separation is {least}")]
    RequiredTooClose {
        /// One of them.
        first: usize,
        /// The other.
        second: usize,
        /// Their distance.
        distance: f64,
        /// The least allowed.
        least: f64,
    },
    /// So many cannot be selected: more are required, or fewer allowed.
    #[error("{count} cannot be selected: {required} are required and {available} allowed")]
    Allowed {
        /// Number asked for.
        count: usize,
        /// Number of candidates that must be in.
        required: usize,
        /// Number of candidates that may be.
        available: usize,
    },
    /// No set of so many that the constraints allow was found. It is proven that there is none if `at_most` is below `count`.
    #[error(
        "no {count} candidates that the constraints allow together were found; {found} are, and more than {at_most} are \
             proven impossible"
    )]
    NoRoom {
        /// Number asked for.
        count: usize,
        /// The most that were found.
        found: usize,
        /// No allowed set is larger; the number of candidates where nothing is known.
        at_most: usize,
    },
    /// Some combination of the parameters is not determined, to working precision.
    #[error("{count} views leave a combination of the parameters undetermined")]
    Unobservable {
        /// Number of views that were tried: as many as asked for, or all candidates together.
        count: usize,
        /// The term whose parameters they are, from 0.
        term: usize,
        /// The combination, one coefficient per parameter, scaled so that the largest is 1 in size.
        combination: Vec<f64>,
    },
}
