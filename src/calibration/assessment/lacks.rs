//! What the views lack for a smaller map error.

use std::fmt;

use nalgebra::DMatrix;

use crate::calibration::{Calibration, Coverage, Observations, Region};
use crate::information::weakest;

/// Boards tilted by less say little of the focal length, rad.
const ENOUGH_TILT: f64 = 0.45;

/// Boards whose tilts about an axis vary by less are all tilted about the other one, rad.
const ENOUGH_SPREAD: f64 = 0.12;

/// Intrinsics with at least this share of the largest are named in a combination.
const NAMED: f64 = 0.3;

/// What the views lack, as far as one can tell; in a sentence for each by `Display`.
#[derive(Debug, Clone, PartialEq)]
pub struct Lacks {
    /// The combination of the intrinsics that is known least.
    pub weakest: Option<WeakCombination>,
    /// Regions of the image in which no corner lies.
    pub empty: Vec<Region>,
    /// How the boards are not tilted.
    pub tilt: Option<TiltLack>,
    /// How many views like these would do, where nothing but their number is wrong.
    pub more_views: Option<MoreViews>,
}

/// Intrinsics that are known badly together.
#[derive(Debug, Clone, PartialEq)]
pub struct WeakCombination {
    /// Their names, the one first that moves the image most.
    pub names: Vec<&'static str>,
    /// Their combination's share of the mean squared map error.
    pub share: f64,
}

/// What is wrong with the tilts of the boards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TiltLack {
    /// None is tilted by more than this, rad.
    TooFlat(f64),
    /// They are tilted about one axis only.
    OneAxis,
}

/// How many views like those taken reach a map error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoreViews {
    /// So many.
    pub views: f64,
    /// Those taken.
    pub taken: usize,
    /// The map error to reach, px.
    pub goal: f64,
}

impl Lacks {
    /// What the views lack for a map error of `goal` px in place of `map_error`; `W` is the p×p weight of the map error.
    pub(super) fn new(
        observations: &Observations,
        calibration: &Calibration,
        W: &DMatrix<f64>,
        map_error: f64,
        goal: Option<f64>,
    ) -> Self {
        let Calibration { camera, poses, .. } = calibration;
        let Coverage { empty, largest_tilt, least_spread } = Coverage::new(observations, camera, poses);
        let tilt = if largest_tilt < ENOUGH_TILT {
            Some(TiltLack::TooFlat(largest_tilt))
        } else {
            (least_spread < ENOUGH_SPREAD).then_some(TiltLack::OneAxis)
        };
        let is_spread = empty.is_empty() && tilt.is_none();
        let more_views = goal.filter(|goal| is_spread && map_error > *goal).map(|goal| MoreViews {
            views: (poses.len() as f64 * (map_error / goal).powi(2)).ceil(),
            taken: poses.len(),
            goal,
        });
        Self { weakest: WeakCombination::new(calibration, W), empty, tilt, more_views }
    }
}

impl WeakCombination {
    fn new(calibration: &Calibration, W: &DMatrix<f64>) -> Option<Self> {
        let Calibration { camera, estimated, covariance, .. } = calibration;
        let weakest = weakest(covariance, W)?;
        let units = calibration.unknowns().pixel_units();
        let moved: Vec<f64> = weakest.change.iter().zip(&units).map(|(change, unit)| (change / unit).abs()).collect();
        let largest = moved.iter().copied().fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..moved.len()).filter(|&i| moved[i] >= NAMED * largest).collect();
        order.sort_by(|&a, &b| moved[b].total_cmp(&moved[a]));
        let names = order.iter().map(|&i| camera.lens().parameter_names()[estimated[i]]).collect();
        Some(Self { names, share: weakest.share })
    }
}

impl fmt::Display for Lacks {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { weakest, empty, tilt, more_views } = self;
        if let Some(WeakCombination { names, share }) = weakest {
            write!(f, " {:.0} % of the squared map error comes from ", 100.0 * share)?;
            match &names[..] {
                [name] => write!(f, "{name}.")?,
                names => write!(f, "one combination of {}.", names.join(", "))?,
            }
        }
        if !empty.is_empty() {
            let names: Vec<&str> = empty.iter().map(|region| region.name()).collect();
            write!(f, " There are no corners in the image's {}: move the board there.", names.join(", "))?;
        }
        match tilt {
            Some(TiltLack::TooFlat(largest)) => {
                let degrees = largest.to_degrees();
                write!(f, " No board is tilted by more than {degrees:.0}°: tilt some by 30° to 50°.")?;
            }
            Some(TiltLack::OneAxis) => {
                f.write_str(" The boards are tilted about one axis only: tilt some about the other.")?;
            }
            None => {}
        }
        if let Some(MoreViews { views, taken, goal }) = more_views {
            write!(f, " About {views} views like these {taken} would bring the map error to {goal} px.")?;
        }
        Ok(())
    }
}
