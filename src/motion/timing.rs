//! Timing of straight moves between joint configurations.

/// What a joint can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Greatest speed in rad/s or m/s; positive and finite.
    pub speed: f64,
    /// Greatest acceleration and deceleration in rad/s² or m/s²; positive and finite.
    pub acceleration: f64,
}

/// How far along a straight move the joints are at what time, from rest to rest and as fast as their limits allow: an even
/// acceleration, a cruise unless the move is short, an even deceleration.
///
/// On a straight line in joint space one path parameter s from 0 to 1 moves all joints: joint j, displaced by `d_j`, moves at
/// `|d_j|·ṡ` and accelerates at `|d_j|·s̈`. So its limits are limits of s:
///
/// ```text
/// ṡ ≤ 1/τ,  τ = max_j |d_j|/v_j        |s̈| ≤ 1/σ,  σ = max_j |d_j|/a_j
/// ```
///
/// The fastest s that keeps them takes `x + σ/x` with `x = max(τ, √σ)`: at the speed 1/x, which it reaches in the time σ/x.
///
/// Each joint by itself may be done sooner, even the slowest of them: by up to a fifth, where one joint limits the speed of the
/// line and another its acceleration. But then the joints would not keep to the line.
///
/// The duration is a metric. It is the least `x + σ/x` of all x ≥ τ, and both τ and σ are norms of d: if moves with x₁ and x₂
/// lead round a corner, `x = x₁ + x₂ ≥ τ₁ + τ₂ ≥ τ` is allowed on the straight line, and takes no longer:
/// `x + σ/x ≤ x₁ + x₂ + (σ₁ + σ₂)/x ≤ x₁ + σ₁/x₁ + x₂ + σ₂/x₂`. A stop on the way never saves time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// x: the time that the whole path takes at its greatest speed, s.
    pass: f64,
    /// σ/x: the time to reach that speed, s; at most `pass`.
    ramp: f64,
}

impl Profile {
    /// Of the move between two configurations (rad or m), joint by joint.
    pub fn between(from: &[f64], to: &[f64], limits: &[JointLimits]) -> Self {
        debug_assert!(from.len() == limits.len() && to.len() == limits.len(), "a value and limits for each joint");
        let (mut τ, mut σ) = (0.0_f64, 0.0_f64);
        for ((from, to), limits) in from.iter().zip(to).zip(limits) {
            let d = (to - from).abs();
            τ = τ.max(d / limits.speed);
            σ = σ.max(d / limits.acceleration);
        }
        let pass = τ.max(σ.sqrt());
        Self { pass, ramp: if pass > 0.0 { (σ / pass).min(pass) } else { 0.0 } }
    }

    /// Of a move that takes so long (s), of which it speeds up, and slows down, for `ramp` (s).
    pub fn lasting(duration: f64, ramp: f64) -> Self {
        let ramp = ramp.min(duration / 2.0);
        Self { pass: duration - ramp, ramp }
    }

    /// Time of the move, s.
    pub fn duration(&self) -> f64 {
        self.pass + self.ramp
    }

    /// Time for which it speeds up, and slows down, s.
    pub fn ramp(&self) -> f64 {
        self.ramp
    }

    /// The share of the way that is done at time `t` (s): 0 before the move, 1 after it.
    pub fn at(&self, t: f64) -> f64 {
        let spent = t.clamp(0.0, self.duration());
        let left = self.duration() - spent;
        if left == 0.0 {
            1.0
        } else if spent <= left {
            self.in_first_half(spent)
        } else {
            1.0 - self.in_first_half(left)
        }
    }

    fn in_first_half(&self, t: f64) -> f64 {
        if t < self.ramp { t * t / (2.0 * self.ramp * self.pass) } else { (t - self.ramp / 2.0) / self.pass }
    }
}

/// Least time in s of the straight move between two configurations (rad or m), from rest to rest: see [`Profile`].
pub fn duration(from: &[f64], to: &[f64], limits: &[JointLimits]) -> f64 {
    Profile::between(from, to, limits).duration()
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;

    const UNEVEN: [JointLimits; 2] =
        [JointLimits { speed: 1.0, acceleration: 100.0 }, JointLimits { speed: 10.0, acceleration: 0.4 }];

    /// Limits, and so many configurations, of up to seven joints, that hardly move where `scale` is small.
    fn random<const N: usize>(rng: &mut Xoshiro256PlusPlus, scale: f64) -> (Vec<JointLimits>, [Vec<f64>; N]) {
        let joints = rng.gen_range(1..=7);
        let mut values = |from: f64, to: f64| (0..joints).map(|_| rng.gen_range(from..to)).collect::<Vec<_>>();
        let speeds_and_accelerations = values(0.2, 4.0).into_iter().zip(values(0.2, 8.0));
        let limits =
            speeds_and_accelerations.map(|(speed, acceleration)| JointLimits { speed, acceleration }).collect();
        (limits, std::array::from_fn(|_| values(-scale, scale)))
    }

    /// The least time of the slowest joint by itself.
    fn of_slowest_joint(from: &[f64], to: &[f64], limits: &[JointLimits]) -> f64 {
        let least = |j: usize| duration(&from[j..=j], &to[j..=j], &limits[j..=j]);
        (0..limits.len()).map(least).fold(0.0, f64::max)
    }

    #[test]
    fn a_joint_by_itself_takes_the_textbook_time() {
        let limits = [JointLimits { speed: 2.0, acceleration: 4.0 }];
        assert_eq!(duration(&[0.5], &[4.5], &limits), 4.0 / 2.0 + 2.0 / 4.0);
        assert_eq!(duration(&[0.0], &[-1.0], &limits), 1.0);
        assert_eq!(duration(&[0.0], &[0.25], &limits), 2.0 * (0.25_f64 / 4.0).sqrt());
    }

    #[test]
    fn the_line_takes_longer_where_one_joint_limits_its_speed_and_another_its_acceleration() {
        let (from, to) = ([0.0, 0.0], [1.0, 0.1]);
        assert!((of_slowest_joint(&from, &to, &UNEVEN) - 1.01).abs() < 1e-12);
        assert!((duration(&from, &to, &UNEVEN) - 1.25).abs() < 1e-12);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        for _ in 0..20_000 {
            let (limits, [from, to]) = random(&mut rng, 3.0);
            let ratio = of_slowest_joint(&from, &to, &limits) / duration(&from, &to, &limits);
            assert!((0.8 - 1e-12..=1.0 + 1e-12).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn no_joint_exceeds_its_limits_and_one_reaches_them() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
        for i in 0..300 {
            let (limits, [from, to]) = random(&mut rng, [3.0, 0.05][i % 2]);
            let profile = Profile::between(&from, &to, &limits);
            let steps = 1000;
            let h = profile.duration() / f64::from(steps);
            let s = |step: i32| profile.at(f64::from(step) * h);
            let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
            for step in -1..=steps {
                speed = speed.max((s(step + 1) - s(step)) / h);
                acceleration = acceleration.max((s(step + 1) - 2.0 * s(step) + s(step - 1)).abs() / (h * h));
            }
            let share = |path: f64, limit: fn(&JointLimits) -> f64| {
                let shares = (0..limits.len()).map(|j| path * (to[j] - from[j]).abs() / limit(&limits[j]));
                shares.fold(0.0, f64::max)
            };
            let (of_speed, of_acceleration) = (share(speed, |l| l.speed), share(acceleration, |l| l.acceleration));
            assert!(of_speed <= 1.0 + 1e-9 && of_acceleration <= 1.0 + 1e-6, "{of_speed} {of_acceleration}");
            assert!(of_acceleration > 0.99, "{of_acceleration}");
        }
    }

    #[test]
    fn the_way_is_the_same_from_either_end() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
        for _ in 0..300 {
            let (limits, [from, to]) = random(&mut rng, 2.0);
            let profile = Profile::between(&from, &to, &limits);
            assert_eq!(profile, Profile::between(&to, &from, &limits));
            let end = profile.duration();
            assert_eq!(
                [profile.at(-1.0), profile.at(0.0), profile.at(end), profile.at(end + 1.0)],
                [0.0, 0.0, 1.0, 1.0]
            );
            let mut before = 0.0;
            for share in (0..=100).map(|percent| f64::from(percent) / 100.0) {
                let gone = profile.at(share * end);
                assert!((gone + profile.at((1.0 - share) * end) - 1.0).abs() < 1e-12 && gone >= before);
                before = gone;
            }
        }
    }

    #[test]
    fn its_duration_and_its_ramp_say_all_of_a_profile() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
        for i in 0..300 {
            let (limits, [from, to]) = random(&mut rng, [3.0, 0.05][i % 2]);
            let profile = Profile::between(&from, &to, &limits);
            let again = Profile::lasting(profile.duration(), profile.ramp());
            for share in (0..=100).map(|percent| f64::from(percent) / 100.0) {
                let t = share * profile.duration();
                assert!((again.at(t) - profile.at(t)).abs() < 1e-14, "{profile:?} {t}");
            }
        }
        assert_eq!(Profile::lasting(0.0, 0.0).at(0.0), 1.0);
    }

    #[test]
    fn joints_that_do_not_move_take_no_time() {
        let at_rest = Profile::between(&[0.3, -1.0], &[0.3, -1.0], &UNEVEN);
        assert_eq!((at_rest.duration(), at_rest.at(-1.0), at_rest.at(0.0)), (0.0, 1.0, 1.0));
        assert_eq!(duration(&[], &[], &[]), 0.0);
        assert_eq!(duration(&[0.3, -1.0], &[0.3, 1.0], &UNEVEN), duration(&[-1.0], &[1.0], &UNEVEN[1..]));
    }

    #[test]
    fn a_stop_on_the_way_saves_no_time() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
        let mut closest = f64::INFINITY;
        for i in 0..100_000 {
            let (limits, [from, mut via, to]) = random(&mut rng, [3.0, 0.3, 0.02][i % 3]);
            if i % 2 == 0 {
                // Near the straight line, where little is lost.
                let share = rng.gen_range(0.0..1.0_f64).powi(4);
                for j in 0..via.len() {
                    via[j] = from[j] + share * (to[j] - from[j]) + 1e-3 * via[j];
                }
            }
            let straight = duration(&from, &to, &limits);
            let round = duration(&from, &via, &limits) + duration(&via, &to, &limits);
            assert!(straight <= round * (1.0 + 1e-14), "{straight} {round}");
            closest = closest.min(round / straight);
        }
        assert!(closest < 1.01, "{closest}");
    }
}
