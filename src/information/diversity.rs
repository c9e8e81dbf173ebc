//! How varied the views are, without a camera model.

use nalgebra::Vector3;

use crate::selection::InformationSet;
use crate::spatial::Pose;

/// What varies between views: tilt of the board about the camera's x and y (rad), and the logarithm of its distance (m).
const FEATURES: [&str; 3] = ["tilt x", "tilt y", "distance"];

/// A feature whose variance is below this does not vary.
const LEAST_VARIANCE: f64 = 1e-12;

/// The model of a quadratic response surface over the features of the views, standardised over a population of views:
/// designs that determine it well spread over angles and distances (Box & Draper, *Response Surfaces, Mixtures, and Ridge
/// Analyses*).
///
/// Its vector z of a view holds the monomials up to degree two of the board's tilts in the camera and the logarithm of its
/// distance; ten of them, or fewer where a feature does not vary.
#[derive(Debug, Clone, PartialEq)]
pub struct DiversityModel {
    mean: Vector3<f64>,
    deviation: Vector3<f64>,
    /// Each monomial is a product of two: the constant 1 (`None`) or features.
    pairs: Vec<[Option<usize>; 2]>,
}

impl DiversityModel {
    /// What the criterion `diversity` assumes known beforehand, as a share of one average view: enough to compare sets of fewer
    /// views than the ten numbers of the model, too little to weigh in larger ones.
    pub const PRIOR: f64 = 0.1;

    /// The model standardised over the views `X_CT`.
    pub fn new(poses: &[Pose]) -> Self {
        let features: Vec<Vector3<f64>> = poses.iter().map(features).collect();
        let n = features.len().max(1) as f64;
        let mean = features.iter().sum::<Vector3<f64>>() / n;
        let variance = features.iter().map(|x| (x - mean).component_mul(&(x - mean))).sum::<Vector3<f64>>() / n;
        let varying = (0..3).filter(|&f| variance[f] > LEAST_VARIANCE).map(Some);
        let factors: Vec<Option<usize>> = std::iter::once(None).chain(varying).collect();
        let pairs = (0..factors.len()).flat_map(|a| (0..=a).map(move |b| (a, b)));
        let pairs = pairs.map(|(a, b)| [factors[a], factors[b]]).collect();
        Self { mean, deviation: variance.map(f64::sqrt), pairs }
    }

    /// Names of z's entries.
    pub fn monomials(&self) -> Vec<String> {
        let name = |pair: &[Option<usize>; 2]| {
            let factors: Vec<&str> = pair.iter().flatten().map(|&f| FEATURES[f]).collect();
            if factors.is_empty() { "1".into() } else { factors.join(" * ") }
        };
        self.pairs.iter().map(name).collect()
    }

    /// `z zᵀ` of the view `X_CT`, packed.
    pub(crate) fn information(&self, X_CT: &Pose) -> Vec<f64> {
        let x = features(X_CT);
        let value = |factor: Option<usize>| factor.map_or(1.0, |f| (x[f] - self.mean[f]) / self.deviation[f]);
        let z: Vec<f64> = self.pairs.iter().map(|&[a, b]| value(a) * value(b)).collect();
        (0..z.len()).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| z[i] * z[j]).collect()
    }

    /// `z zᵀ` of many views, in their order.
    pub fn information_set(&self, poses: &[Pose]) -> InformationSet {
        let table = poses.iter().flat_map(|X_CT| self.information(X_CT)).collect();
        InformationSet::from_packed_trusted(self.pairs.len(), table)
    }
}

/// The [`FEATURES`] of a view.
fn features(X_CT: &Pose) -> Vector3<f64> {
    let toward = -(X_CT.rotation * Vector3::z());
    Vector3::new(toward.y.atan2(toward.z), toward.x.atan2(toward.z), X_CT.translation.vector.norm().ln())
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::selection::packed::log_det;

    /// Views spread over angle and distance score higher than the same number at one angle.
    #[test]
    fn spread_views_are_more_diverse_than_equal_ones() {
        let pose = |i: usize| {
            let (a, b, c) = ((i % 3) as f64 - 1.0, (i / 3 % 3) as f64 - 1.0, (i / 9) as f64);
            let R = UnitQuaternion::from_euler_angles(std::f64::consts::PI + 0.4 * a, 0.4 * b, 0.0);
            Pose::from_parts(Vector3::new(0.0, 0.0, 0.5 + 0.2 * c).into(), R)
        };
        let poses: Vec<Pose> = (0..27).map(pose).collect();
        let model = DiversityModel::new(&poses);
        let set = model.information_set(&poses);
        assert_eq!(model.monomials().len(), 10);
        let value = |selected: &[usize]| {
            let mut total = set.total(&set.mean(), selected);
            assert!(crate::selection::packed::cholesky(&mut total, 10));
            log_det(&total, 10)
        };
        assert!(value(&[0, 2, 6, 8, 18, 20, 24, 26, 13, 4]) > value(&[13; 10]) + 1.0);
    }

    /// Distances of equal ratios are evenly spread: standardised they are −√1.5, 0 and √1.5. A tilt by rounding is none.
    #[test]
    fn features_are_standardised_logarithms() {
        let pose = |i: i32| {
            let R = UnitQuaternion::from_euler_angles(std::f64::consts::PI + 1e-9 * f64::from(i), 0.0, 0.0);
            Pose::from_parts(Vector3::new(0.0, 0.0, 2f64.powi(i)).into(), R)
        };
        let poses = [-1, 0, 1].map(pose);
        let model = DiversityModel::new(&poses);
        assert_eq!(model.monomials(), ["1", "distance", "distance * distance"]);
        for (pose, z) in poses.iter().zip([-1.0, 0.0, 1.0].map(|sign| sign * 1.5f64.sqrt())) {
            let expected = [1.0, z, z * z, z * z, z * z * z, z * z * z * z];
            let found = model.information(pose);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
        }
    }

    /// A camera that never rolls sees a level board tilted about one axis only.
    #[test]
    fn features_that_do_not_vary_are_left_out() {
        let pose = |i: usize| {
            let R = UnitQuaternion::from_euler_angles(std::f64::consts::PI + 0.1 * i as f64, 0.0, 0.0);
            Pose::from_parts(Vector3::new(0.0, 0.0, 0.5 + 0.03 * (i * i % 7) as f64).into(), R)
        };
        let poses: Vec<Pose> = (0..9).map(pose).collect();
        let model = DiversityModel::new(&poses);
        assert_eq!(model.information_set(&poses).order(), 6);
        assert_eq!(
            model.monomials(),
            ["1", "tilt x", "tilt x * tilt x", "distance", "distance * tilt x", "distance * distance"]
        );
    }
}
