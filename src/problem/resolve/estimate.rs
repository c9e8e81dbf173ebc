//! What the calibration estimates, and what is known of it beforehand.

use super::check::Check;
use crate::camera::{Camera, Lens};
use crate::information::Unknowns;
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::text::{At, key};

/// Greatest standard deviation known beforehand.
const VAGUEST: f64 = 1e9;

/// What moves the image by so little, in units of the noise of a corner, is known, not estimated.
const KNOWN: f64 = 1e-4;

impl Check<'_, '_> {
    /// Indices of the intrinsics to estimate, ascending.
    pub(super) fn estimated(&mut self, estimate: &At<schema::Estimate>, lens: Lens) -> Vec<usize> {
        let all = lens.parameter_names();
        let Some(intrinsics) = key!(estimate, intrinsics).given() else {
            return (0..all.len()).collect();
        };
        if intrinsics.value.is_empty() {
            self.fault(&intrinsics.path, Reason::Empty);
        }
        let mut estimated = Vec::new();
        for At { value: name, path } in intrinsics.elements() {
            match all.iter().position(|known| known == name) {
                Some(index) if estimated.contains(&index) => {
                    self.fault(&path, Reason::Duplicate { name: name.clone() });
                }
                Some(index) => estimated.push(index),
                None => self.unknown(&path, name, all),
            }
        }
        estimated.sort_unstable();
        estimated
    }

    /// `camera` is none where something is wrong with it.
    pub(super) fn prior_sigma(
        &mut self,
        estimate: &At<schema::Estimate>,
        camera: Option<&Camera>,
        estimated: &[usize],
        names: &[&str],
        noise: f64,
    ) -> Vec<(usize, f64)> {
        let mut known = Vec::new();
        for (name, sigma) in key!(estimate, prior_sigma).entries() {
            let Some(j) = names.iter().position(|estimated| estimated == name) else {
                self.unknown(&sigma.path, name, names);
                continue;
            };
            // An intrinsic that moves no pixel has no unit.
            let alone = |camera| Unknowns { camera, estimated: &estimated[j..=j] };
            let unit = camera.map(|camera| alone(camera).pixel_units()[0]).filter(|unit| unit.is_finite());
            let least = unit.map_or(f64::MIN_POSITIVE, |unit| KNOWN * noise * unit);
            let value = *sigma.value;
            if value < least && value > 0.0 {
                self.fault(&sigma.path, Reason::KnownExactly { value, least });
            } else {
                self.number(&sigma, Allowed::positive(VAGUEST));
            }
            known.push((j, value));
        }
        known
    }
}
