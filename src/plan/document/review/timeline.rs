//! A plan's tour in time: where the arm is when, and how near it comes to anything.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::motion::course::{Leg, configuration};
use crate::motion::timing::Profile;

/// A plan's tour in time. All joints start and stop together: on every leg, for `ramp_s` they speed up and for as long they slow down,
/// evenly but for `ease_s` at the beginning and the end of that, in which the acceleration grows and falls evenly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timeline {
    /// Joint values at the beginning, rad (m for prismatic joints): at home, or at the first pose.
    pub start: Vec<f64>,
    /// The moves of the tour, one after the other.
    pub moves: Vec<TimedMove>,
    /// When pictures are taken, pose by pose.
    pub pictures: Vec<PictureTime>,
    /// When the tour ends.
    pub end_s: f64,
    /// When margins were measured; empty where nothing is tested.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub measured_s: Vec<f64>,
    /// Distance of the two tested links nearest to each other; left out where none are tested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub clearance: Option<MarginCurve>,
    /// The same of those tested links alone whose distance changes by more than a millimetre along the tour; left out where none's or
    /// all links' does.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub changing_clearance: Option<MarginCurve>,
    /// The tip-over margin; left out where it is not tested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub tip_over_margin: Option<MarginCurve>,
}

/// A move in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TimedMove {
    /// Id of the pose where it begins; `null` for home.
    pub from: Option<usize>,
    /// Id of the pose where it ends; `null` for home.
    pub to: Option<usize>,
    /// When it begins.
    pub start_s: f64,
    /// How long it takes.
    pub seconds: f64,
    /// Whether it is proven safe, as the plan says; left out where nothing is tested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub safe: Option<bool>,
    /// Its straight legs, one more than it has turns.
    pub legs: Vec<TimedLeg>,
}

/// A straight way from rest to rest, which begins where the one before ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TimedLeg {
    /// When it begins.
    pub start_s: f64,
    /// How long it takes.
    pub seconds: f64,
    /// For how long of it the joints speed up; for as long they slow down.
    pub ramp_s: f64,
    /// In which time the acceleration comes to its greatest, and goes again; left out where the joints change it at once.
    #[serde(skip_serializing_if = "none", default)]
    pub ease_s: f64,
    /// Joint values where it ends, rad (m for prismatic joints).
    pub to: Vec<f64>,
}

/// When the pictures of a pose are taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PictureTime {
    /// Id of the pose.
    pub id: usize,
    /// When the arm is there.
    pub start_s: f64,
    /// How long it stays.
    pub seconds: f64,
}

/// The least of some margins at the times of `measured_s`. What it is in between is not measured; `proven_m` holds there too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MarginCurve {
    /// What poses keep.
    pub required_m: f64,
    /// What is kept on the way.
    pub kept_m: f64,
    /// What the plan proves that it does not sink below on any move; `null` where a move is not proven safe.
    pub proven_m: Option<f64>,
    /// What was measured, rounded to 10 µm; 0 where links touch.
    pub measured_m: Vec<f64>,
    /// Number of the least of them.
    pub least: usize,
    /// Names of the pairs of links that are nearest anywhere; left out for the tip-over margin.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub pairs: Vec<[String; 2]>,
    /// Number of the nearest pair at each time; left out for the tip-over margin.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub nearest: Vec<usize>,
}

/// That it takes no time.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn none(seconds: &f64) -> bool {
    *seconds == 0.0
}

impl Timeline {
    /// The straight ways of all moves.
    pub fn legs(&self) -> Vec<Leg> {
        let timed: Vec<&TimedLeg> = self.moves.iter().flat_map(|found| &found.legs).collect();
        let from = std::iter::once(&self.start).chain(timed.iter().map(|leg| &leg.to));
        let leg = |(from, leg): (&Vec<f64>, &&TimedLeg)| Leg {
            start: leg.start_s,
            from: from.clone(),
            to: leg.to.clone(),
            profile: Profile::lasting(leg.seconds, leg.ramp_s, leg.ease_s),
        };
        from.zip(&timed).map(leg).collect()
    }

    /// Joint values at a time in s, rad (m for prismatic joints).
    pub fn joints_at(&self, time: f64) -> Vec<f64> {
        configuration(&self.legs(), time).unwrap_or_else(|| self.start.clone())
    }

    /// The curves of margins that there are.
    pub fn curves(&self) -> impl Iterator<Item = &MarginCurve> {
        self.clearance.iter().chain(&self.changing_clearance).chain(&self.tip_over_margin)
    }

    /// Whether all lists are as long as they should be for an arm of so many joints, and all numbers of pairs and times are there.
    pub(crate) fn is_regular(&self, joints: usize) -> bool {
        let mut legs = self.moves.iter().flat_map(|found| &found.legs);
        let times = self.measured_s.len();
        let of_one_length = |curve: &MarginCurve| {
            let is_named = curve.nearest.len() == times && curve.nearest.iter().all(|&pair| pair < curve.pairs.len());
            let has_no_names = curve.nearest.is_empty() && curve.pairs.is_empty();
            curve.measured_m.len() == times && curve.least < times && (is_named || has_no_names)
        };
        self.start.len() == joints && legs.all(|leg| leg.to.len() == joints) && self.curves().all(of_one_length)
    }
}

impl MarginCurve {
    /// The names of the two links that are nearest at the sample of that number; none for the tip-over margin.
    pub fn links(&self, sample: usize) -> Option<&[String; 2]> {
        self.pairs.get(*self.nearest.get(sample)?)
    }

    /// Whether it changes by no more than a millimetre along the tour, as far as was measured.
    pub fn is_steady(&self) -> bool {
        self.measured_m.iter().all(|margin| margin - self.least_m() <= 1e-3)
    }

    /// The least that was measured, m.
    pub fn least_m(&self) -> f64 {
        self.measured_m.get(self.least).copied().unwrap_or(f64::NAN)
    }
}
