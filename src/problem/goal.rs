//! What is asked for.

use std::borrow::Cow;
use std::fmt;
use std::time::Duration;

use super::Method;
use crate::continuum::ContinuumSettings;
use crate::information::Criterion;

/// What to choose, and within which limits.
#[derive(Debug, Clone, PartialEq)]
pub struct SelectionSettings {
    /// What is asked for.
    pub goal: Goal,
    /// Share of the best information found that is given up for a shorter tour.
    pub tour_tolerance: f64,
    /// Pictures taken at each pose.
    pub pictures: usize,
    /// Whether poses may leave the sweep's configurations.
    pub off_grid: bool,
    /// The bound over all joint values.
    pub continuum: ContinuumSettings,
    /// Seed of everything random.
    pub seed: u64,
    /// Relative gap at which the relaxation stops.
    pub tolerance: f64,
    /// Time after which a search for the proven best set ends.
    pub time_limit: Duration,
    /// Nodes after which it does.
    pub node_limit: usize,
}

impl SelectionSettings {
    /// Whether the poses may leave the sweep's configurations. Choices that look at no constraints are among these alone.
    pub fn leaves_grid(&self) -> bool {
        self.off_grid && self.goal.method().heeds_constraints()
    }
}

/// What is asked for: the best of sets of one size or of those that keep a time, or the smallest or fastest of those that are good
/// enough.
#[derive(Debug, Clone, PartialEq)]
pub enum Goal {
    /// So many poses, by criteria.
    Best {
        /// What to optimise: the weighted geometric mean of these criteria; the shares add up to one.
        criteria: Vec<(Criterion, f64)>,
        /// Number of poses.
        count: usize,
        /// How to choose them.
        method: Method,
    },
    /// As many poses as serve, by criteria, whose tour keeps a time.
    Within {
        /// As of [`Goal::Best`].
        criteria: Vec<(Criterion, f64)>,
        /// Time of the tour at most, dwells and all, s.
        seconds: f64,
    },
    /// As few poses as possible that reach all of these accuracies, as standard deviations, or those of the shortest tour.
    Fewest {
        /// At least one.
        accuracies: Vec<(Accuracy, f64)>,
        /// What is to be little.
        least: Least,
    },
}

/// What poses that reach accuracies are to take as little of as possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Least {
    /// Poses.
    #[default]
    Poses,
    /// Time of their tour.
    Time,
}

impl Least {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Poses, Self::Time];

    /// Name as written in problem files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Poses => "poses",
            Self::Time => "time",
        }
    }
}

/// Something that has a standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Accuracy {
    /// The RMS map error, px.
    MapError,
    /// An intrinsic, in its own unit: index among the estimated.
    Intrinsic(usize),
}

impl Accuracy {
    /// What the map error is called where intrinsics have their names.
    pub const MAP_ERROR: &'static str = "map_error_px";
}

impl Goal {
    /// What the accuracies are called where criteria have their names.
    pub const ACCURACY: &'static str = "accuracy";

    /// The criteria, or, of accuracies, the one that stands for them where a criterion is needed: `v`.
    pub fn criteria(&self) -> Cow<'_, [(Criterion, f64)]> {
        match self {
            Self::Best { criteria, .. } | Self::Within { criteria, .. } => Cow::Borrowed(criteria),
            Self::Fewest { .. } => Cow::Owned(vec![(Criterion::V, 1.0)]),
        }
    }

    /// The accuracies; none of a goal by criteria.
    pub fn accuracies(&self) -> &[(Accuracy, f64)] {
        match self {
            Self::Best { .. } | Self::Within { .. } => &[],
            Self::Fewest { accuracies, .. } => accuracies,
        }
    }

    /// The terms of what is optimised by their names, with their shares.
    pub fn terms(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Best { criteria, .. } | Self::Within { criteria, .. } => {
                criteria.iter().map(|&(criterion, share)| (criterion.name(), share)).collect()
            }
            Self::Fewest { .. } => vec![(Self::ACCURACY, 1.0)],
        }
    }

    /// Whether the fewest poses are asked for, or the fastest that are good enough, of which it is proven how few may be.
    pub fn proves_fewest(&self) -> bool {
        matches!(self, Self::Fewest { .. })
    }

    /// Number of poses, where it is asked for.
    pub fn count(&self) -> Option<usize> {
        match self {
            Self::Best { count, .. } => Some(*count),
            Self::Within { .. } | Self::Fewest { .. } => None,
        }
    }

    /// How the poses are chosen. The fewest are sought by the best means for every number of poses.
    pub fn method(&self) -> Method {
        match self {
            Self::Best { method, .. } => *method,
            Self::Within { .. } | Self::Fewest { .. } => Method::Best,
        }
    }

    /// Whether the choice ends with a search that may take as long as it is given.
    pub fn searches(&self) -> bool {
        match self {
            Self::Best { method, .. } => *method == Method::Exact,
            Self::Within { .. } => false,
            Self::Fewest { .. } => true,
        }
    }
}

impl fmt::Display for Goal {
    /// What is optimised: `v`, or `0.8 v + 0.2 diversity`, or `accuracy`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Best { criteria, .. } | Self::Within { criteria, .. } => f.write_str(&Criterion::describe(criteria)),
            Self::Fewest { .. } => f.write_str(Self::ACCURACY),
        }
    }
}
