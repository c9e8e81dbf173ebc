//! Timing of straight moves between joint configurations.

use super::limits::JointLimits;

/// How far along a straight move the joints are at what time, from rest to rest and as fast as their limits allow: an
/// acceleration, a cruise unless the move is short, a deceleration that mirrors it. The acceleration is even, or grows and falls
/// evenly where joints have limits of jerk.
///
/// On a straight line in joint space one path parameter s from 0 to 1 moves all joints: joint j, displaced by `d_j`, moves at
/// `|d_j|·ṡ`, accelerates at `|d_j|·s̈` and so on. So its limits are limits of s:
///
/// ```text
/// ṡ ≤ 1/τ,  τ = max_j |d_j|/v_j      |s̈| ≤ 1/σ,  σ = max_j |d_j|/a_j      |s⃛| ≤ 1/ρ,  ρ = max_j |d_j|/jerk_j
/// ```
///
/// An s that speeds up to 1/x at accelerations of up to 1/A, which it reaches in the time ρ/A, takes `x + A/x + ρ/A`, of which it
/// speeds up for `A/x + ρ/A`, and as long it slows down; so that is at most x. Of all `x ≥ τ` and `A ≥ σ` that keep to this the
/// fastest has the least x, and to it `A = max(σ, √(ρx))`. Without limits of jerk that is `x + σ/x` with `x = max(τ, √σ)`.
///
/// Each joint by itself may be done sooner, even the slowest of them: by up to a fifth, where one joint limits the speed of the
/// line and another its acceleration. But then the joints would not keep to the line.
///
/// The duration is a metric, for τ, σ and ρ are norms of d. If moves with x₁, A₁ and x₂, A₂ lead round a corner, `x = x₁ + x₂` and
/// `A = A₁ + A₂` are allowed on the straight line: A/x is a mean of the Aᵢ/xᵢ, and ρ/A no more than one of the ρᵢ/Aᵢ, so each is
/// at most the sum of those round the corner, which keeps to `A/x + ρ/A ≤ x` too and takes no longer. A stop on the way never saves time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// x: the time that the whole path takes at its greatest speed, s.
    pass: f64,
    /// A/x + ρ/A: the time to reach that speed, s; at most `pass`.
    ramp: f64,
    /// ρ/A: the time to reach the greatest acceleration, s; at most half of `ramp`.
    ease: f64,
}

impl Profile {
    /// Of the move between two configurations (rad or m), joint by joint.
    pub fn between(from: &[f64], to: &[f64], limits: &[JointLimits]) -> Self {
        debug_assert!(from.len() == limits.len() && to.len() == limits.len(), "a value and limits for each joint");
        let (mut τ, mut σ, mut ρ) = (0.0_f64, 0.0_f64, 0.0_f64);
        for ((from, to), limits) in from.iter().zip(to).zip(limits) {
            let d = (to - from).abs();
            τ = τ.max(d / limits.speed);
            σ = σ.max(d / limits.acceleration);
            ρ = ρ.max(d / limits.jerk);
        }
        // The least x with A/x + ρ/A ≤ x: with A = √(ρx), or, where that is less than σ, with A = σ.
        let least = (4.0 * ρ).cbrt();
        let least = if σ > (ρ * least).sqrt() {
            let jerk_time = ρ / σ;
            f64::midpoint(jerk_time, (jerk_time * jerk_time + 4.0 * σ).sqrt())
        } else {
            least
        };
        let pass = τ.max(least);
        if pass == 0.0 {
            return Self { pass, ramp: 0.0, ease: 0.0 };
        }
        let a = σ.max((ρ * pass).sqrt());
        let ease = if a > 0.0 { ρ / a } else { 0.0 };
        let ramp = (a / pass + ease).min(pass);
        Self { pass, ramp, ease: ease.min(ramp / 2.0) }
    }

    /// Of a move that takes so long (s), of which it speeds up, and slows down, for `ramp` (s), and in the first and the last `ease` (s)
    /// of each ramp reaches and leaves its greatest acceleration.
    pub fn lasting(duration: f64, ramp: f64, ease: f64) -> Self {
        let ramp = ramp.min(duration / 2.0);
        Self { pass: duration - ramp, ramp, ease: ease.min(ramp / 2.0) }
    }

    /// Time of the move, s.
    pub fn duration(&self) -> f64 {
        self.pass + self.ramp
    }

    /// Time for which it speeds up, and slows down, s.
    pub fn ramp(&self) -> f64 {
        self.ramp
    }

    /// Time in which it reaches, and leaves, its greatest acceleration, s; 0 without limits of jerk.
    pub fn ease(&self) -> f64 {
        self.ease
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
        let Self { pass, ramp, ease } = *self;
        if t >= ramp {
            return (t - ramp / 2.0) / pass;
        }
        let acceleration = 1.0 / ((ramp - ease) * pass);
        // The way while the acceleration grows from rest, and what it is short of the even speed while it falls.
        let eased = |t: f64| acceleration * t * t * t / (6.0 * ease);
        if t < ease {
            eased(t)
        } else if t <= ramp - ease {
            let since = t - ease / 2.0;
            acceleration * (since * since / 2.0 + ease * ease / 24.0)
        } else {
            (t - ramp / 2.0) / pass + eased(ramp - t)
        }
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

    const UNEVEN: [JointLimits; 2] = [JointLimits::new(1.0, 100.0), JointLimits::new(10.0, 0.4)];

    /// Limits, and so many configurations, of up to seven joints, that hardly move where `scale` is small. Of every second one some
    /// joints have limits of jerk.
    fn random<const N: usize>(rng: &mut Xoshiro256PlusPlus, scale: f64) -> (Vec<JointLimits>, [Vec<f64>; N]) {
        let joints = rng.gen_range(1..=7);
        let eased = rng.r#gen::<bool>();
        let limit = |_| JointLimits {
            speed: rng.gen_range(0.2..4.0),
            acceleration: rng.gen_range(0.2..8.0),
            jerk: if eased && rng.gen_bool(0.7) { 10_f64.powf(rng.gen_range(-0.5..2.0)) } else { f64::INFINITY },
        };
        let limits = (0..joints).map(limit).collect();
        (limits, std::array::from_fn(|_| (0..joints).map(|_| rng.gen_range(-scale..scale)).collect()))
    }

    /// The least time of the slowest joint by itself.
    fn of_slowest_joint(from: &[f64], to: &[f64], limits: &[JointLimits]) -> f64 {
        let least = |j: usize| duration(&from[j..=j], &to[j..=j], &limits[j..=j]);
        (0..limits.len()).map(least).fold(0.0, f64::max)
    }

    #[test]
    fn a_joint_by_itself_takes_the_textbook_time() {
        let limits = [JointLimits::new(2.0, 4.0)];
        assert_eq!(duration(&[0.5], &[4.5], &limits), 4.0 / 2.0 + 2.0 / 4.0);
        assert_eq!(duration(&[0.0], &[-1.0], &limits), 1.0);
        assert_eq!(duration(&[0.0], &[0.25], &limits), 2.0 * (0.25_f64 / 4.0).sqrt());
    }

    #[test]
    fn a_joint_with_a_limit_of_jerk_takes_the_time_of_its_seven_phases() {
        let limits = [JointLimits { speed: 2.0, acceleration: 4.0, jerk: 16.0 }];
        let takes = |way: f64| duration(&[0.0], &[way], &limits);
        // All seven: 1/4 s to the acceleration, 1/2 s at it and to the speed, all that anew, cruising in between.
        assert!((takes(4.0) - (4.0 / 2.0 + 2.0 / 4.0 + 4.0 / 16.0)).abs() < 1e-12);
        // Without a cruise, up to 1.5 rad/s: 3/8 s at the acceleration, twice 1/4 s to it and from it.
        assert!((takes(1.5 * 0.625) - 2.0 * 0.625).abs() < 1e-12);
        // Without even acceleration: a quarter of the time to its greatest.
        assert!((takes(0.1) - 4.0 * (0.1_f64 / (2.0 * 16.0)).cbrt()).abs() < 1e-12);
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
            let eased = limits.iter().any(|joint| joint.jerk.is_finite());
            let least = if eased { 0.6 } else { 0.8 - 1e-12 };
            assert!((least..=1.0 + 1e-12).contains(&ratio), "{ratio}");
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
            let (mut speed, mut acceleration, mut jerk) = (0.0_f64, 0.0_f64, 0.0_f64);
            for step in -1..=steps {
                let changes = [s(step), s(step + 1), s(step + 2)].map(|to| to - s(step - 1));
                speed = speed.max((changes[1] - changes[0]) / h);
                acceleration = acceleration.max((changes[1] - 2.0 * changes[0]).abs() / (h * h));
                jerk = jerk.max((changes[2] - 3.0 * changes[1] + 3.0 * changes[0]).abs() / (h * h * h));
            }
            let share = |path: f64, limit: fn(&JointLimits) -> f64| {
                let shares = (0..limits.len()).map(|j| path * (to[j] - from[j]).abs() / limit(&limits[j]));
                shares.fold(0.0, f64::max)
            };
            let (of_speed, of_acceleration) = (share(speed, |l| l.speed), share(acceleration, |l| l.acceleration));
            let of_jerk = share(jerk, |l| l.jerk);
            assert!(of_speed <= 1.0 + 1e-9 && of_acceleration <= 1.0 + 1e-6, "{of_speed} {of_acceleration}");
            assert!(of_jerk <= 1.0 + 1e-3, "{of_jerk}");
            assert!(of_acceleration.max(of_jerk) > 0.99, "{of_acceleration} {of_jerk}");
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
    fn its_times_say_all_of_a_profile() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
        for i in 0..300 {
            let (limits, [from, to]) = random(&mut rng, [3.0, 0.05][i % 2]);
            let profile = Profile::between(&from, &to, &limits);
            let again = Profile::lasting(profile.duration(), profile.ramp(), profile.ease());
            for share in (0..=100).map(|percent| f64::from(percent) / 100.0) {
                let t = share * profile.duration();
                assert!((again.at(t) - profile.at(t)).abs() < 1e-14, "{profile:?} {t}");
            }
        }
        assert_eq!(Profile::lasting(0.0, 0.0, 0.0).at(0.0), 1.0);
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
