//! What joints can do.

/// What a joint can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Greatest speed in rad/s or m/s; positive and finite.
    pub speed: f64,
    /// Greatest acceleration and deceleration in rad/s² or m/s²; positive and finite.
    pub acceleration: f64,
    /// Greatest change of the acceleration in rad/s³ or m/s³; positive, infinite where there is no limit.
    pub jerk: f64,
}

impl JointLimits {
    /// Of a joint without a limit of jerk.
    pub const fn new(speed: f64, acceleration: f64) -> Self {
        Self { speed, acceleration, jerk: f64::INFINITY }
    }

    /// A share of all of them.
    #[must_use]
    pub fn at_share(&self, share: f64) -> Self {
        Self { speed: share * self.speed, acceleration: share * self.acceleration, jerk: share * self.jerk }
    }

    /// A way (rad or m) that the joint does not exceed from rest to rest in a time (s), convex in the time: with a limit of jerk the
    /// farthest way itself is not.
    ///
    /// A move at up to the speed `v ≤ speed` that it reaches by up to the acceleration `a ≤ acceleration` takes its way d the time
    /// `d/v + v/a + a/jerk`. This is the greatest d for the time, also where the way is too short to reach them: a maximum of
    /// functions that are linear in the time. Without a limit of jerk, and of long ways, it is the farthest way.
    pub fn reach(&self, time: f64) -> f64 {
        let Self { speed, acceleration, jerk } = *self;
        if time <= 0.0 {
            return 0.0;
        }
        let easing = acceleration / jerk;
        let best = if time > 3.0 * easing { acceleration * (time - easing) / 2.0 } else { jerk * time * time / 9.0 };
        let v = best.min(speed);
        let a = (jerk * v).sqrt().min(acceleration);
        v * (time - v / a - a / jerk)
    }

    /// The time in s for which a way (rad or m) is the [reach](Self::reach): no move is done sooner.
    pub fn soonest(&self, way: f64) -> f64 {
        if way <= 0.0 {
            return 0.0;
        }
        let [τ, σ, ρ] = [self.speed, self.acceleration, self.jerk].map(|limit| way / limit);
        let x = τ.max(ρ.cbrt());
        if (ρ * x).sqrt() >= σ {
            return x + 2.0 * (ρ / x).sqrt();
        }
        let x = τ.max(σ.sqrt());
        x + σ / x + ρ / σ
    }
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;
    use crate::motion::duration;

    #[test]
    fn a_reach_is_convex_and_not_exceeded() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        for run in 0..2000 {
            let jerk = if run % 4 == 0 { f64::INFINITY } else { 10_f64.powf(rng.gen_range(-1.5..3.0)) };
            let limits = JointLimits { speed: rng.gen_range(0.2..4.0), acceleration: rng.gen_range(0.2..8.0), jerk };
            let [a, b] = [0.0; 2].map(|_: f64| 10_f64.powf(rng.gen_range(-2.0..1.0)));
            let [near, middle, far] = [a, f64::midpoint(a, b), b].map(|time| limits.reach(time));
            assert!(middle <= f64::midpoint(near, far) * (1.0 + 1e-12), "{limits:?}: {a} {b}");
            let (soonest, takes) = (limits.soonest(near), duration(&[0.0], &[near], &[limits]));
            assert!((soonest - a).abs() < 1e-9 * a, "{limits:?}: {soonest} {a}");
            assert!((a * (1.0 - 1e-9)..=1.06 * a).contains(&takes), "{limits:?}: {takes} {a}");
            if run % 4 == 0 {
                assert!((takes - a).abs() < 1e-9 * a, "{limits:?}: {takes} {a}");
            }
        }
    }

    #[test]
    fn nothing_is_reached_in_no_time() {
        for jerk in [f64::INFINITY, 3.0] {
            let limits = JointLimits { speed: 1.0, acceleration: 2.0, jerk };
            assert_eq!((limits.reach(0.0), limits.soonest(0.0)), (0.0, 0.0));
            assert_eq!((limits.reach(-1.0), limits.soonest(-1.0)), (0.0, 0.0));
        }
    }
}
