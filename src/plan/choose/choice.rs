//! A set of poses and what it is worth.

/// A set of poses and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The views chosen, ascending indices into the survey's.
    pub selected: Vec<usize>,
    /// log Φ of the choice; −∞ if it leaves a combination of the intrinsics undetermined.
    pub log_value: f64,
    /// Standard deviation of each estimated intrinsic; empty if one is undetermined.
    pub sigma: Vec<f64>,
    /// Expected RMS map error in px; infinite if an intrinsic is undetermined.
    pub map_error: f64,
}

/// An accuracy, requested and reached, as standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// `map_error_px` or the name of an intrinsic.
    pub name: String,
    /// What was requested.
    pub requested: f64,
    /// What the poses reach.
    pub reached: f64,
}
