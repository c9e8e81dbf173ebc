//! Why there is no choice.

use thiserror::Error;

use super::ClusteringError;
use super::choice::Reached;
use super::constraints::ConstraintError;
use crate::figures::grouped;
use crate::plan::survey::SurveyError;
use crate::problem::Accuracy;
use crate::selection::SelectionError;

/// Why a problem has no plan.
#[derive(Debug, Error)]
pub enum PlanError {
    /// There is nothing to choose from.
    #[error(transparent)]
    Survey(#[from] SurveyError),
    /// More poses are asked for than there are views.
    #[error("{} poses are asked for, but only {} configurations see the board and can be taken", grouped(*count), grouped(*views))]
    TooFewViews {
        /// Poses asked for.
        count: usize,
        /// Views found.
        views: usize,
    },
    /// The poses leave some combination of the intrinsics undetermined.
    #[error("{} cannot determine all intrinsics; undetermined: {}", describe_tried(*count, *views), describe(combination))]
    Unobservable {
        /// Poses tried.
        count: usize,
        /// Views to choose from: where as many were tried, there are no more.
        views: usize,
        /// Names of the parameters and their coefficients in the combination, largest 1.
        combination: Vec<(String, f64)>,
    },
    /// The poses found leave some combination of the intrinsics all but undetermined, where others might tell far more.
    #[error(
        "the set found, of size {count}, gives less than {:e} of the information that the certificate's bound allows; it \
             hardly determines: {}",
        Self::LEAST_EFFICIENCY,
        describe(combination)
    )]
    HardlyObservable {
        /// Poses found.
        count: usize,
        /// Names of the parameters and their coefficients in the combination least known, largest 1.
        combination: Vec<(String, f64)>,
    },
    /// The constraints cannot be held.
    #[error(transparent)]
    Constraints(#[from] ConstraintError),
    /// No set of so many poses that the constraints allow was found.
    #[error("{}", describe_room(*count, *found, *at_most))]
    NoRoom {
        /// Poses asked for.
        count: usize,
        /// The most that were found.
        found: usize,
        /// No allowed set has more.
        at_most: usize,
    },
    /// The accuracies are out of reach.
    #[error("{}: {}", describe_reach(*count, *bound), describe_shortfalls(shortfalls))]
    Inaccurate {
        /// Poses of the best set found.
        count: usize,
        /// The accuracies that it misses.
        shortfalls: Vec<Reached>,
        /// Share of the accuracy that no set of so many surpasses: below 1 it is proven that none suffices; infinite if nothing is
        /// known.
        bound: f64,
    },
    /// The time asked for is too short.
    #[error("{}", describe_time(*seconds, *shortest))]
    NoTime {
        /// Time that the tour may take, s.
        seconds: f64,
        /// Time of the shortest tour seen of poses that determine all intrinsics, s; infinite if there was none.
        shortest: f64,
    },
    /// The robot cannot be where its tour begins.
    #[error("{}", describe_home(links.as_ref()))]
    UnsafeHome {
        /// Names of two links that are too close to each other; none where the robot might tip over.
        links: Option<[String; 2]>,
    },
    /// What is known already is not positive definite.
    #[error("the covariance of the calibration is not positive definite to working precision")]
    Covariance,
    /// The selection was refused.
    #[error(transparent)]
    Selection(SelectionError),
    /// The baseline failed.
    #[error(transparent)]
    Clustering(#[from] ClusteringError),
}

impl PlanError {
    /// Certified efficiency below which a choice is no plan: standard deviations could be a thousandth.
    pub const LEAST_EFFICIENCY: f64 = 1e-6;
}

fn describe_room(count: usize, found: usize, at_most: usize) -> String {
    if at_most >= count {
        format!(
            "no {count} poses that [constraints] allow together were found; the most found are {found}, and it is not \
             proven that more are impossible"
        )
    } else if at_most == found {
        format!("[constraints] allow at most {found} poses together, which is proven; {count} are asked for")
    } else {
        format!("[constraints] allow no {count} poses together: {found} were found, and at most {at_most} are possible")
    }
}

fn describe_time(seconds: f64, shortest: f64) -> String {
    let found =
        if shortest.is_finite() { format!("; the shortest found takes {shortest:.1} s") } else { String::new() };
    format!("no tour of poses that determine all intrinsics was found that takes {seconds} s or less{found}")
}

fn describe_home(links: Option<&[String; 2]>) -> String {
    match links {
        Some([a, b]) => {
            format!("the robot cannot be at `motion.home`: {a} and {b} touch there, or are within the clearance")
        }
        None => "the robot cannot be at `motion.home`: its tip-over margin is less there than is allowed".into(),
    }
}

fn describe_tried(count: usize, views: usize) -> String {
    match count {
        1 => "1 pose".into(),
        _ if count == views => format!("all {} views together", grouped(count)),
        _ => format!("{count} poses"),
    }
}

fn describe(combination: &[(String, f64)]) -> String {
    let mut terms: Vec<_> = combination.iter().filter(|(_, c)| c.abs() > 1e-3).collect();
    terms.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let mut text = String::new();
    for (i, (name, c)) in terms.into_iter().enumerate() {
        let sign = match (i, *c < 0.0) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        text += &format!("{sign}{:.3} {name}", c.abs());
    }
    text
}

fn describe_reach(count: usize, bound: f64) -> String {
    if bound < 1.0 {
        format!("not even {count} poses, all that may be chosen, reach the requested accuracy")
    } else {
        format!("no set of poses was found that reaches the requested accuracy; with the best one, of {count} poses")
    }
}

fn describe_shortfalls(shortfalls: &[Reached]) -> String {
    let each = shortfalls.iter().map(|Reached { name, requested, reached }| {
        let what = if name == Accuracy::MAP_ERROR { "the map error in px".into() } else { format!("sigma of {name}") };
        format!("{what} is {reached:.4}, but {requested} is requested")
    });
    each.collect::<Vec<_>>().join(", ")
}
