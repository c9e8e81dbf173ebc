//! What a plan proves, as it is written: parts of `plan.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::continuum::ContinuumEnd;
use crate::feasibility::View;
use crate::information::Criterion;
use crate::plan::choose::{ContinuumCertificate, Objective, Reached, SearchSummary};
use crate::plan::survey::{PricedPictures, Survey};
use crate::problem::Goal;
use crate::selection::packed::{packed_len, unpack};
use crate::selection::{Certificate, Group, SearchEnd};

/// The numbers that prove a bound: scores `Σ_t ⟨Y_t, M_ti⟩` less the prices of the caps, see the book's page "The method".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CertificateDocument {
    /// The bound that they prove, as [`Plan::bound`](crate::plan::document::Plan::bound).
    pub bound: f64,
    /// One term per criterion, scenario after scenario.
    pub terms: Vec<CertificateTerm>,
    /// For accuracies, the mixture λ of the names' variances that the bound is taken for.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub mixture: Vec<f64>,
    /// Prices of the constraints' groups that bind, ascending by the group.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub prices: Vec<Price>,
    /// Prices of the balls that bind, of which the separations leave a set no more than one view each; ascending by separation and ids.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub balls: Vec<BallPrice>,
}

/// What proves a plan's bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Certificates {
    /// For the sets of the views that the poses were chosen from: those of the sweep, and those found off the grid. Where a search
    /// followed, of the bound that it started from.
    pub grid: CertificateDocument,
    /// For the sets of poses at any joint values; left out where no pose leaves the grid, or no bound was found.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub continuum: Option<ContinuumDocument>,
}

/// The numbers that prove a bound on all sets of so many poses at any joint values that keep the pictures apart: k times the greatest
/// score `Σ_t ⟨Y_t, M_t(q)⟩` less the prices of the balls that the picture is in, and the prices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContinuumDocument {
    /// Number of poses of the sets: the plan's, or one less where as few as possible were asked for.
    pub count: usize,
    /// What no such set can surpass, in the unit of the plan's bound.
    pub bound: f64,
    /// The share of the best possible information of so many poses that the plan has at least; where one less is bounded, below 1 if
    /// they cannot suffice.
    pub efficiency: f64,
    /// The score, less prices, that no view exceeds, whatever its joint values.
    pub score: f64,
    /// Share by which it was to be known.
    pub tolerance: f64,
    /// Boxes of joint values that were bounded.
    pub boxes: usize,
    /// "closed": the score is known to the tolerance; or what ended it before: "box limit", "time limit or interrupt".
    pub end: String,
    /// One term per criterion, scenario after scenario.
    pub terms: Vec<CertificateTerm>,
    /// For accuracies, the mixture λ of the names' variances that the bound is taken for.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub mixture: Vec<f64>,
    /// Prices of balls of pictures, of which the separation of the pictures leaves a set no more than one view each; ascending by their
    /// joint values.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub balls: Vec<PicturePrice>,
}

/// A criterion's part of a certificate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CertificateTerm {
    /// Number of the scenario, 0 for the set-up as stated; none where it is the only one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub scenario: Option<usize>,
    /// Name of the criterion.
    pub criterion: String,
    /// Its share, of the scenario's where the worst scenario counts.
    pub share: f64,
    /// Y, p×p, positive semidefinite, row by row; the share is in it.
    pub matrix: Vec<Vec<f64>>,
}

/// The price of a group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Price {
    /// Number of the group in the problem file, from 0.
    pub group: usize,
    /// Its price, at least 0.
    pub price: f64,
}

/// The price of a ball: the views nearer than half a separation's least distance to the point midway between two of them. Any two of
/// them are too close to each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BallPrice {
    /// Number of the separation among those in force, from 0, in the order joint, view, picture.
    pub separation: usize,
    /// The ids of the two views, ascending; the same twice where the ball is about one.
    pub between: [usize; 2],
    /// Its price, at least 0.
    pub price: f64,
}

/// The price of a ball of pictures at any joint values: those nearer than half the least distance of pictures to the point midway between
/// those from two configurations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PicturePrice {
    /// The joint values of the two, rad or m, ascending; the same twice where the ball is about one.
    pub between_rad: [Vec<f64>; 2],
    /// Its price, at least 0.
    pub price: f64,
}

/// How the search for the proven best set went.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SearchDocument {
    /// "optimal"; or what ended it before: "node limit", "time limit or interrupt": [`SearchDocument::ENDS`].
    pub end: String,
    /// Parts of the search space that were bounded.
    pub nodes: usize,
    /// Views left open: not proven to be in no better set, or in every one.
    pub open_views: usize,
}

/// Why no fewer poses suffice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FewestDocument {
    /// What was requested, and what the plan reaches.
    pub accuracies: Vec<AccuracyDocument>,
    /// Fewer poses than this are proven not to suffice; as many as the plan has if the proof is complete.
    pub least: usize,
    /// Fewest poses found that suffice, where the plan has more and a shorter tour.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub found: Option<usize>,
    /// The proof that `least - 1` do not suffice: its bound on the least of (requested / reached)² is below 1. Where a search
    /// was needed, the bound that it started from.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub refutation: Option<CertificateDocument>,
    /// Parts of the search space that were bounded for it; 0 if the refutation stands alone.
    pub nodes: usize,
}

/// An accuracy, requested and reached, as standard deviations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AccuracyDocument {
    /// `map_error_px` or the name of an intrinsic.
    pub name: String,
    /// What was requested.
    pub requested: f64,
    /// What the plan reaches.
    pub reached: f64,
}

impl AccuracyDocument {
    pub(super) fn new(Reached { name, requested, reached }: Reached) -> Self {
        Self { name, requested, reached }
    }
}

impl SearchDocument {
    /// How a search ends that proved the best set.
    pub const OPTIMAL: &'static str = "optimal";

    /// All ways to end.
    pub const ENDS: [&'static str; 3] = [Self::OPTIMAL, "node limit", "time limit or interrupt"];

    pub(crate) fn new(search: &SearchSummary) -> Self {
        let end = match search.end {
            SearchEnd::Optimal => 0,
            SearchEnd::NodeLimit => 1,
            SearchEnd::Stopped => 2,
        };
        Self { end: Self::ENDS[end].into(), nodes: search.nodes, open_views: search.open_at_root }
    }
}

impl CertificateDocument {
    /// Of a certificate for choices among `views`.
    pub(crate) fn new(objective: &Objective, views: &[View], certificate: &Certificate) -> Self {
        let (mut prices, mut balls) = (vec![], vec![]);
        for &(group, price) in &certificate.prices {
            match group {
                Group::Cap(group) => prices.push(Price { group, price }),
                Group::Ball { separation, between } => {
                    balls.push(BallPrice { separation, between: between.map(|i| views[i].id), price });
                }
            }
        }
        // In an order of their own, whatever their places are.
        for ball in &mut balls {
            ball.between.sort_unstable();
        }
        balls.sort_unstable_by_key(|ball| (ball.separation, ball.between));
        Self {
            bound: objective.natural(certificate.log_bound),
            terms: terms(objective, &certificate.y),
            mixture: certificate.mixture.clone(),
            prices,
            balls,
        }
    }

    /// The prices of the groups of a survey's views; `None` if one is about a view that is not among them.
    pub(crate) fn group_prices(&self, survey: &Survey) -> Option<Vec<(Group, f64)>> {
        let caps = self.prices.iter().map(|&Price { group, price }| Some((Group::Cap(group), price)));
        let balls = self.balls.iter().map(|&BallPrice { separation, between: [a, b], price }| {
            Some((Group::Ball { separation, between: [survey.index_of(a)?, survey.index_of(b)?] }, price))
        });
        caps.chain(balls).collect()
    }
}

impl ContinuumDocument {
    /// Every way to end.
    pub const ENDS: [&'static str; 3] = ["closed", "box limit", "time limit or interrupt"];

    /// Of a plan of log Φ = `log_value`.
    pub(crate) fn new(objective: &Objective, certificate: &ContinuumCertificate, log_value: f64) -> Self {
        let end = match certificate.end {
            ContinuumEnd::Closed => 0,
            ContinuumEnd::BoxLimit => 1,
            ContinuumEnd::Stopped => 2,
        };
        Self {
            count: certificate.count,
            bound: objective.natural(certificate.log_bound),
            efficiency: (log_value - certificate.log_bound).exp(),
            score: certificate.score,
            tolerance: certificate.tolerance,
            boxes: certificate.boxes,
            end: Self::ENDS[end].into(),
            terms: terms(objective, &certificate.gradient.y),
            mixture: certificate.gradient.mixture.clone(),
            balls: certificate.balls.iter().map(PicturePrice::new).collect(),
        }
    }
}

impl PicturePrice {
    fn new(PricedPictures { between, price }: &PricedPictures) -> Self {
        Self { between_rad: between.clone(), price: *price }
    }

    pub(crate) fn priced(&self) -> PricedPictures {
        let Self { between_rad: [a, b], price } = self;
        PricedPictures::new(a, b, *price)
    }
}

/// Y, packed, term after term.
fn terms(objective: &Objective, y: &[f64]) -> Vec<CertificateTerm> {
    let mut rest = y;
    let scenarios = objective.scenarios();
    let terms = objective.criteria().map(|(scenario, criterion, share, p)| {
        let (own, others) = rest.split_at(packed_len(p));
        rest = others;
        CertificateTerm {
            scenario: (scenarios > 1).then_some(scenario),
            criterion: criterion.map_or(Goal::ACCURACY, Criterion::name).into(),
            share,
            matrix: unpack(own, p).row_iter().map(|row| row.iter().copied().collect()).collect(),
        }
    });
    terms.collect()
}
