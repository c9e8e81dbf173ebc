//! Why a plan does not hold.

use thiserror::Error;

use crate::plan::assess::locate::LocateError;

/// Why a plan does not hold.
#[derive(Debug, Error)]
pub enum CertifyError {
    /// A number is not what the plan says.
    #[error("{what} is {found} according to the problem file, but the plan says {stated}")]
    Number {
        /// What it is.
        what: String,
        /// What the plan says.
        stated: f64,
        /// What it is.
        found: f64,
    },
    /// Something else than a number is not what the plan says.
    #[error("{what} is {found} according to the problem file, but the plan says {stated}")]
    Other {
        /// What it is.
        what: String,
        /// What the plan says.
        stated: String,
        /// What it is.
        found: String,
    },
    /// The criterion is not what the certificate is for.
    #[error("the plan's criterion is \"{stated}\", but its certificate is for \"{found}\"")]
    Criterion {
        /// What the plan says.
        stated: String,
        /// What the certificate says.
        found: String,
    },
    /// The accuracies are not those that the problem file requests.
    #[error("the accuracies that the plan was made for are not those of the problem file")]
    Requests,
    /// The poses miss the accuracies.
    #[error("the poses do not reach the accuracy: the least of (requested / reached)² is {value}")]
    Accuracy {
        /// The plan's value.
        value: f64,
    },
    /// The poses break a constraint.
    #[error("the poses break a constraint of the problem file: {0}")]
    Constraint(BrokenConstraint),
    /// The matrix is no certificate.
    #[error("the certificate's matrix for `{criterion}` is not symmetric positive semidefinite of order {order}")]
    Matrix {
        /// Name of the criterion.
        criterion: String,
        /// The order it must have.
        order: usize,
    },
    /// A price or mixture is negative, or of no group or accuracy, or prices are not in order.
    #[error(
        "the certificate's prices or mixture are negative, do not add up to one, are not in order, or name something that does not exist"
    )]
    Prices,
    /// The refutation does not refute.
    #[error("the bound for {count} poses does not rule out that they reach the accuracy")]
    Refutation {
        /// The number of poses.
        count: usize,
    },
    /// A view may score more than the certificate over all joint values says.
    #[error("that no view scores more than {score} at any joint values is not confirmed by {boxes} boxes of them")]
    Continuum {
        /// The score.
        score: f64,
        /// Boxes of joint values that may be looked at.
        boxes: usize,
    },
    /// Rounding leaves too little of the numbers.
    #[error("the poses' information is so nearly singular that rounding leaves {what} uncertain by {share:.0e} of it")]
    Rounding {
        /// Of what.
        what: &'static str,
        /// By how much, as a share of the information.
        share: f64,
    },
    /// The plan does not fit the problem or its candidates.
    #[error(transparent)]
    Locate(#[from] LocateError),
    /// A view taken already does not see the board.
    #[error("from captured view {view} the nominal camera does not see enough of the board")]
    CapturedUnseen {
        /// The view, from 1.
        view: usize,
    },
    /// A view's corners do not fix what the criterion needs.
    #[error("the corners of a view do not determine its pose in the image")]
    Undetermined,
}

/// A constraint that poses break.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum BrokenConstraint {
    /// A required pose is missing.
    #[error("pose {id} is required, but not among them")]
    Missing {
        /// The pose's id.
        id: usize,
    },
    /// A pose is forbidden.
    #[error("pose {id} is forbidden, by its id or by a region of `constraints.keep_out`")]
    Forbidden {
        /// The pose's id.
        id: usize,
    },
    /// A group has too many.
    #[error("{count} of them are in group \"{group}\", which may have at most {most}")]
    Crowded {
        /// The group's name.
        group: String,
        /// Poses in it.
        count: usize,
        /// Poses that may be.
        most: usize,
    },
    /// Two are too close.
    #[error("poses {first} and {second} are closer together than the minimum separation")]
    Close {
        /// One pose's id.
        first: usize,
        /// The other's.
        second: usize,
    },
}
