use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::*;
use super::worlds::*;

const TOLERANCE: f64 = Precision::VERDICT.tolerance;

/// The margin reported is that at the place reported, and it is within the tolerance.
fn assert_fails(margins: &dyn Margins, from: &[f64], to: &[f64], Failure { place, .. }: Failure) {
    let there = margins_at(margins, &between(from, to, place.share))[place.margin];
    assert_eq!(place.value, there);
    assert!(there <= TOLERANCE, "{place:?}");
}

#[test]
fn what_is_proven_holds_at_ten_thousand_places_and_what_fails_is_too_close() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut safe, mut until_failure) = (0, 0);
    for _ in 0..300 {
        let arm = Arm::random(&mut rng);
        let (from, to) = (arm.configuration(&mut rng), arm.configuration(&mut rng));
        match prove(&arm, &from, &to, Precision::VERDICT) {
            Ok(proof) => {
                safe += 1;
                assert_holds(&arm, &from, &to, &proof.bounds, 10_000);
            }
            Err(failure) => {
                until_failure += failure.evaluations;
                assert_fails(&arm, &from, &to, failure);
            }
        }
    }
    assert!((50..250).contains(&safe), "{safe}");
    assert!(until_failure < 6 * (300 - safe), "a collision is found early: {until_failure} {safe}");
}

#[test]
fn bounds_come_as_near_as_asked_to_the_least_margin() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    for _ in 0..300 {
        let arm = Arm::random(&mut rng);
        let (from, to) = (arm.configuration(&mut rng), arm.configuration(&mut rng));
        let precision = Precision::default();
        let fine = prove(&arm, &from, &to, precision);
        assert_eq!(fine.is_ok(), prove(&arm, &from, &to, Precision::VERDICT).is_ok());
        let Ok(proof) = fine else { continue };
        let seen = proof.seen.unwrap();
        assert_eq!(seen.value, margins_at(&arm, &between(&from, &to, seen.share))[seen.margin]);
        assert!(proof.least() <= seen.value && proof.least() >= seen.value - precision.resolution, "{proof:?}");
        assert_holds(&arm, &from, &to, &proof.bounds, 1000);
    }
}

#[test]
fn lower_bounds_of_margins_suffice() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    for _ in 0..300 {
        let arm = Terse(Arm::random(&mut rng));
        let (from, to) = (arm.0.configuration(&mut rng), arm.0.configuration(&mut rng));
        for precision in [Precision::VERDICT, Precision::default()] {
            let (terse, full) = (prove(&arm, &from, &to, precision), prove(&arm.0, &from, &to, precision));
            assert_eq!(terse.is_ok(), full.is_ok());
            let Ok(proof) = terse else { continue };
            assert_holds(&arm.0, &from, &to, &proof.bounds, 1000);
            assert_eq!(proof.seen.is_none(), proof.evaluations == 1 && precision == Precision::VERDICT, "{proof:?}");
        }
    }
}

#[test]
fn there_and_back_are_judged_alike() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    for _ in 0..2000 {
        let arm = Arm::random(&mut rng);
        let (from, to) = (arm.configuration(&mut rng), arm.configuration(&mut rng));
        let (there, back) = (prove(&arm, &from, &to, Precision::VERDICT), prove(&arm, &to, &from, Precision::VERDICT));
        assert_eq!(there.is_ok(), back.is_ok());
        if let (Ok(there), Ok(back)) = (there, back) {
            assert_eq!((there.bounds, there.evaluations), (back.bounds, back.evaluations));
        }
    }
}

#[test]
fn places_of_a_move_lie_between_its_ends() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(6);
    for i in 0..100_000 {
        let a: f64 = rng.gen_range(-3.0..3.0);
        let b = [a, a.next_up(), rng.gen_range(-3.0..3.0)][i % 3];
        let t = rng.gen_range(0.0..=1.0);
        let value = between(&[a], &[b], t)[0];
        assert!((a.min(b)..=a.max(b)).contains(&value), "{a} {b} {t}");
        let t = f64::from(rng.gen_range(0..=1024)) / 1024.0;
        assert_eq!(between(&[a], &[b], t), between(&[b], &[a], 1.0 - t));
    }
    assert_eq!((between(&[1.0], &[3.0], 0.0), between(&[1.0], &[3.0], 1.0)), (vec![1.0], vec![3.0]));
    assert!(between(&[1.0], &[f64::NAN], 0.5)[0].is_nan());
}

/// A margin that falls to `least` somewhere on the way and rises again, as fast as its bound allows.
fn dip(least: f64) -> Laws {
    Laws::one(1.0, move |q| least + (q - 0.3141).abs())
}

#[test]
fn moves_that_graze_are_safe_only_above_the_tolerance() {
    for precision in [Precision::VERDICT, Precision::default()] {
        for least in [-0.2, -1e-3, -1e-12, 0.0, 1e-12, 1e-6] {
            let failure = prove(&dip(least), &[0.0], &[1.0], precision).unwrap_err();
            assert_fails(&dip(least), &[0.0], &[1.0], failure);
        }
        for least in [1.001 * TOLERANCE, 2.0 * TOLERANCE, 0.1] {
            let proof = prove(&dip(least), &[0.0], &[1.0], precision).unwrap();
            assert!(proof.least() > 0.0 && proof.least() <= least, "{proof:?}");
        }
    }
    let fine = Precision { tolerance: 1e-7, resolution: 1e-7 };
    let proof = prove(&dip(1e-6), &[0.0], &[1.0], fine).unwrap();
    assert!((0.9e-6..=1e-6).contains(&proof.least()), "{proof:?}");
}

#[test]
fn the_work_has_a_bound() {
    let (least, length) = (1e-6, 3.0);
    let level = Laws::one(1.0, move |_| least);
    let failure = prove(&level, &[0.0], &[length], Precision::VERDICT).unwrap_err();
    assert!((failure.evaluations as f64) < 2.0 * length / TOLERANCE, "{failure:?}");
    // Just above the tolerance all along, every piece is halved to the last.
    let level = Laws::one(1.0, |_| 1.01 * TOLERANCE);
    let proof = prove(&level, &[0.0], &[length], Precision::VERDICT).unwrap();
    assert!((proof.evaluations as f64) < 2.0 * length / TOLERANCE, "{}", proof.evaluations);
    // Below what rounding may be, nothing is shown, however short the pieces.
    let (level, none) = (Laws::one(1.0, |_| 1e-12), Precision { tolerance: 0.0, ..Precision::VERDICT });
    assert!(prove(&level, &[0.0], &[1e-6], none).is_err());
}

#[test]
fn the_margin_that_fails_is_named() {
    let mut laws = dip(0.5);
    laws.0.extend(dip(-0.01).0);
    laws.0.extend(dip(0.2).0);
    let failure = prove(&laws, &[1.0], &[0.0], Precision::VERDICT).unwrap_err();
    assert_eq!(failure.place.margin, 1);
    assert!((failure.place.share - (1.0 - 0.3141)).abs() <= 0.01 + 1e-12, "{failure:?}");
}

#[test]
fn a_margin_that_does_not_change_is_measured_once() {
    for value in [1e-8, 1.0, f64::INFINITY] {
        for precision in [Precision::VERDICT, Precision::default()] {
            let proof = prove(&Laws::one(0.0, move |_| value), &[0.0], &[1.0], precision).unwrap();
            assert!(proof.evaluations == 1 && proof.least() > 0.0 && proof.least() <= value, "{proof:?}");
        }
    }
    for value in [1e-9, 1e-10, 0.0, -1.0, f64::NEG_INFINITY] {
        let failure = prove(&Laws::one(0.0, move |_| value), &[0.0], &[1.0], Precision::VERDICT).unwrap_err();
        assert_eq!(failure, Failure { place: Place { margin: 0, share: 0.5, value }, evaluations: 1 });
    }
}

#[test]
fn a_move_to_where_it_begins_is_judged_by_its_place() {
    let proof = prove(&dip(0.1), &[0.3141], &[0.3141], Precision::VERDICT).unwrap();
    assert!(proof.evaluations == 1 && (proof.least() - 0.1).abs() < 1e-8);
    assert!(prove(&dip(-0.1), &[0.3141], &[0.3141], Precision::VERDICT).is_err());
}

#[test]
fn without_margins_or_joints_there_is_little_to_prove() {
    let proof = prove(&Laws(vec![]), &[0.0], &[1.0], Precision::default()).unwrap();
    assert_eq!((proof.bounds.len(), proof.least(), proof.seen, proof.evaluations), (0, f64::INFINITY, None, 0));
    let maze = |clearance| Maze { walls: vec![[vec![], vec![]]], clearance };
    assert!(prove(&maze(-0.1), &[], &[], Precision::default()).is_ok());
    assert!(prove(&maze(0.0), &[], &[], Precision::default()).is_err());
}

#[test]
fn what_is_no_number_is_unsafe() {
    for precision in [Precision::VERDICT, Precision::default()] {
        let hole = Laws::one(1.0, |q| if (0.6..0.7).contains(&q) { f64::NAN } else { 0.1 });
        let failure = prove(&hole, &[0.0], &[1.0], precision).unwrap_err();
        assert!(failure.place.value.is_nan() && (0.6..0.7).contains(&failure.place.share));
        for slope in [f64::NAN, f64::INFINITY] {
            assert!(prove(&Laws::one(slope, |_| 1.0), &[0.0], &[1.0], precision).is_err());
        }
        assert!(prove(&Laws::one(1.0, |q| q), &[0.1], &[f64::NAN], precision).is_err());
        let none = Precision { tolerance: 0.0, ..precision };
        assert!(prove(&dip(0.0), &[0.0], &[1.0], none).is_err());
    }
}
