//! A plan's tour in time: the joints are where the moves say, and margins what they are there.

use std::iter::once;
use std::ops::ControlFlow;
use std::path::Path;

use calipose::motion::JointLimits;
use calipose::motion::timing::{Profile, duration};
use calipose::plan::assess::review;
use calipose::plan::choose::{Chooser, decide, plan_survey};
use calipose::plan::document::{MarginCurve, Plan, Timeline};
use calipose::plan::survey::Survey;
use calipose::problem::{Overrides, Problem};
use serde::Deserialize;

/// The plan of a problem, its tour in time, and that of the plan as `change` leaves it.
fn planned(file: &str, set: &[&str], change: impl Fn(&mut Plan)) -> (Problem, Plan, Timeline) {
    let coarse = ["sweep.step_deg=20", "selection.off_grid=false", "selection.count=7"];
    let overrides = coarse.iter().chain(set).fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    let problem = Problem::read_with(Path::new(&format!("problems/{file}.toml")), &overrides).unwrap();
    let survey: Survey = plan_survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    let mut plan = Plan::new(&chooser, &decision).unwrap();
    change(&mut plan);
    let timeline = review(&plan, &chooser, &decision.choice.selected).unwrap().timeline.unwrap();
    (problem, plan, timeline)
}

const HOME: &str = "motion.home=[0, 60, -150, 90]";

fn assert_near(found: &[f64], expected: &[f64]) {
    let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == expected.len() && worst < 1e-12, "{found:?} {expected:?}");
}

#[test]
fn the_arm_is_at_each_pose_when_its_pictures_are_taken() {
    for set in [vec![], vec![HOME], vec![HOME, "motion.return_home=false", "motion.dwell_s=0"]] {
        let (problem, plan, timeline) = planned("servosila-engineer", &set, |_| {});
        let tour = plan.tour.as_ref().unwrap();
        let in_order = plan.in_order();
        assert_eq!(timeline.pictures.len(), in_order.len());
        for (picture, pose) in timeline.pictures.iter().zip(in_order) {
            assert_eq!((picture.id, picture.seconds), (pose.id, problem.motion.dwell));
            for share in [0.0, 0.5, 1.0] {
                assert_near(&timeline.joints_at(picture.start_s + share * picture.seconds), &pose.joints_rad);
            }
        }
        assert_eq!(timeline.moves.len(), tour.moves.len());
        for (found, stated) in timeline.moves.iter().zip(&tour.moves) {
            assert!((found.seconds - stated.seconds).abs() < 1e-8 && found.legs.len() == 1, "{found:?} {stated:?}");
        }
        assert!((timeline.end_s - tour.total_s).abs() < 1e-6, "{} {}", timeline.end_s, tour.total_s);
        let home = tour.home_rad.as_ref();
        if let Some(home) = home {
            assert_near(&timeline.joints_at(0.0), home);
            let (first, last) = (timeline.moves.first().unwrap(), timeline.moves.last().unwrap());
            assert_eq!((first.from, first.to), (None, tour.order.first().copied()));
            if tour.returns {
                assert_eq!((last.from, last.to), (tour.order.last().copied(), None));
                assert_near(&timeline.joints_at(timeline.end_s), home);
            }
        }
        // Nothing is tested of an arm without bodies.
        assert!(timeline.measured_s.is_empty() && timeline.curves().next().is_none());
    }
}

#[test]
fn a_move_round_about_turns_where_it_says() {
    let turn = vec![0.1, 0.5, -1.5, 0.3];
    let (problem, plan, timeline) = planned("servosila-engineer", &[], |plan| {
        plan.tour.as_mut().unwrap().moves[2].via_rad = vec![turn.clone()];
    });
    let poses = plan.in_order();
    let limits = problem.motion.limits();
    let legs = &timeline.moves[2].legs;
    let times = [duration(&poses[2].joints_rad, &turn, &limits), duration(&turn, &poses[3].joints_rad, &limits)];
    assert_eq!(legs.iter().map(|leg| leg.seconds).collect::<Vec<_>>(), times);
    assert_near(&timeline.joints_at(legs[1].start_s), &turn);
    assert_near(&timeline.joints_at(timeline.pictures[3].start_s), &poses[3].joints_rad);
}

/// The curve between its samples, on a line.
fn between(timeline: &Timeline, curve: &MarginCurve, time: f64) -> f64 {
    let after = timeline.measured_s.partition_point(|&sample| sample < time).clamp(1, timeline.measured_s.len() - 1);
    let (from, to) = (timeline.measured_s[after - 1], timeline.measured_s[after]);
    let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
    (1.0 - share) * curve.measured_m[after - 1] + share * curve.measured_m[after]
}

#[test]
fn margins_are_those_of_the_configurations_and_keep_what_is_proven() {
    /// Of what is rounded.
    const ROUNDED: f64 = 6e-6;
    let (problem, plan, timeline) = planned("servosila-engineer-bodies", &[HOME], |_| {});
    let (checks, tree) = (problem.checks(), &problem.robot.tree);
    let stability = problem.stability.as_ref().unwrap();
    let clearance = timeline.clearance.as_ref().unwrap();
    let changing = timeline.changing_clearance.as_ref().unwrap();
    let balance = timeline.tip_over_margin.as_ref().unwrap();
    assert_eq!((clearance.required_m, balance.required_m), (problem.clearance, stability.margin));
    assert!(timeline.measured_s.windows(2).all(|pair| pair[0] < pair[1]));
    let name = |[a, b]: [usize; 2]| [tree.links[a].name.clone(), tree.links[b].name.clone()];
    let gaps = |time: f64| checks.collision().gaps(&tree.link_poses(&timeline.joints_at(time)));
    let nearest = |time: f64| gaps(time).into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let steadiness = |time: f64| stability.margin_at(tree, &tree.link_poses(&timeline.joints_at(time))).unwrap();
    for (i, &time) in timeline.measured_s.iter().enumerate() {
        let (links, gap) = nearest(time);
        assert!((clearance.measured_m[i] - gap.max(0.0)).abs() < ROUNDED, "{time}: {gap}");
        let named = clearance.links(i).unwrap();
        let own = gaps(time).into_iter().find(|(links, _)| name(*links) == *named).unwrap();
        assert!((own.1 - gap).abs() < ROUNDED, "{time}: {named:?} {links:?}");
        assert!((balance.measured_m[i] - steadiness(time)).abs() < ROUNDED, "{time}");
        assert!(changing.measured_m[i] >= clearance.measured_m[i]);
    }
    // Of each move, the least sample is not below what is proven, and not far above.
    let sampled = |curve: &MarginCurve, [from, to]: [f64; 2]| {
        let own = timeline.measured_s.iter().zip(&curve.measured_m).filter(|(time, _)| (from..=to).contains(*time));
        own.map(|(_, margin)| *margin).fold(f64::INFINITY, f64::min)
    };
    for (found, stated) in timeline.moves.iter().zip(&plan.tour.as_ref().unwrap().moves) {
        let time = [found.start_s - 1e-4, found.start_s + found.seconds + 1e-4];
        for (curve, proven) in [(clearance, stated.clearance_m), (balance, stated.tip_over_margin_m)] {
            let (least, proven) = (sampled(curve, time), proven.unwrap());
            assert!(least >= proven - ROUNDED && least <= proven + 2e-3, "{least} {proven}");
        }
    }
    for curve in [clearance, balance] {
        let least = curve.measured_m.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(curve.least_m() == least && least >= curve.proven_m.unwrap() - ROUNDED);
    }
    // In between, the samples miss little.
    let (mut lowest, mut off) = (f64::INFINITY, 0.0_f64);
    for step in 0..5000 {
        let time = timeline.end_s * f64::from(step) / 5000.0;
        let steady = steadiness(time);
        lowest = lowest.min(steady);
        off = off.max((between(&timeline, balance, time) - steady).abs());
        off = off.max((between(&timeline, clearance, time) - nearest(time).1).abs());
    }
    assert!(off < 1e-3 && balance.least_m() < lowest + 1e-5, "{off} {lowest} {}", balance.least_m());
}

/// One of the tours that `tests/golden/timeline.py` reckoned.
#[derive(Deserialize)]
struct Golden {
    speeds: Vec<f64>,
    accelerations: Vec<f64>,
    /// None where there is no limit.
    jerks: Vec<Option<f64>>,
    timeline: Timeline,
    at: Vec<At>,
}

#[derive(Deserialize)]
struct At {
    time_s: f64,
    joints: Vec<f64>,
}

#[test]
fn joint_values_are_those_of_the_textbook() {
    let tours: Vec<Golden> = serde_json::from_str(include_str!("../golden/timeline.json")).unwrap();
    assert_eq!(tours.len(), 3);
    for Golden { speeds, accelerations, jerks, timeline, at } in tours {
        let limits = (0..speeds.len()).map(|j| JointLimits {
            speed: speeds[j],
            acceleration: accelerations[j],
            jerk: jerks[j].unwrap_or(f64::INFINITY),
        });
        let limits: Vec<JointLimits> = limits.collect();
        let legs: Vec<_> = timeline.moves.iter().flat_map(|found| &found.legs).collect();
        let from = once(&timeline.start).chain(legs.iter().map(|leg| &leg.to));
        for (from, leg) in from.zip(&legs) {
            let profile = Profile::between(from, &leg.to, &limits);
            let found = [profile.duration(), profile.ramp(), profile.ease()];
            assert_near(&found, &[leg.seconds, leg.ramp_s, leg.ease_s]);
        }
        assert!(at.len() > 50);
        for At { time_s, joints } in at {
            let found = timeline.joints_at(time_s);
            assert!(found.iter().zip(&joints).all(|(a, b)| (a - b).abs() < 1e-9), "{time_s}: {found:?} {joints:?}");
        }
    }
}
