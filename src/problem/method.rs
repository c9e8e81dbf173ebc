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
            Method::Exact => "best, then branch and bound until the best set is proven or a limit is reached",
            Method::Relaxation => "the largest weights of the convex relaxation",
            Method::Exchange => "greedy, then swaps as long as a swap improves the set",
            Method::Greedy => "the pose that adds most, one at a time",
            Method::Random => "random poses, for comparison",
            Method::KMeansJoints => "poses nearest to the centres of clusters of joint values, for comparison",
            Method::KMeansPositions => "poses nearest to the centres of clusters of camera positions, for comparison",
        }
    }

    /// Whether its choice depends on the seed.
    pub fn is_seeded(self) -> bool {
        matches!(self, Method::Random | Method::KMeansJoints | Method::KMeansPositions)
    }

    /// Whether it chooses only what the constraints allow; the baselines do not look at them.
    pub fn heeds_constraints(self) -> bool {
        !matches!(self, Method::Random | Method::KMeansJoints | Method::KMeansPositions)
    }
}
