//! The ways to choose a subset.

/// A way to choose k of n candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// The better of greedy and rounded relaxation, each improved by exchange.
    Best,
    /// The same, then branch and bound until the best set is proven or a limit reached.
    Exact,
    /// The relaxation's k largest weights.
    Relaxation,
    /// Greedy, improved by exchange.
    Exchange,
    /// The best marginal gain, k times.
    Greedy,
    /// k candidates at random.
    Random,
    /// The members nearest to the centres of k clusters of joint vectors.
    KMeansJoints,
    /// The members nearest to the centres of k clusters of camera positions.
    KMeansPositions,
}

impl Method {
    /// Every method.
    pub const ALL: [Method; 8] = [
        Method::Best,
        Method::Exact,
        Method::Relaxation,
        Method::Exchange,
        Method::Greedy,
        Method::Random,
        Method::KMeansJoints,
        Method::KMeansPositions,
    ];

    /// Name as written in problem files and plans.
    pub fn name(self) -> &'static str {
        match self {
            Method::Best => "best",
            Method::Exact => "exact",
            Method::Relaxation => "relaxation",
            Method::Exchange => "exchange",
            Method::Greedy => "greedy",
            Method::Random => "random",
            Method::KMeansJoints => "kmeans-joints",
            Method::KMeansPositions => "kmeans-positions",
        }
    }

    /// What it does, in a phrase.
    pub fn phrase(self) -> &'static str {
        match self {
            Method::Best => "the better of greedy and rounded relaxation, each improved by exchange",
            Method::Exact => "the same, then branch and bound until the best set is proven or a limit reached",
            Method::Relaxation => "the greatest weights of the convex relaxation",
            Method::Exchange => "greedy, then swaps as long as one improves",
            Method::Greedy => "the pose that adds most, again and again",
            Method::Random => "poses at random, to compare with",
            Method::KMeansJoints => "nearest to the centres of clusters of joint values, to compare with",
            Method::KMeansPositions => "nearest to the centres of clusters of camera positions, to compare with",
        }
    }

    /// Whether it chooses only what the constraints allow; the baselines do not look at them.
    pub fn heeds_constraints(self) -> bool {
        !matches!(self, Method::Random | Method::KMeansJoints | Method::KMeansPositions)
    }
}
