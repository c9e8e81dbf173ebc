//! The tour, step by step: a coarse Servosila problem whose pictures are simulated.

#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;
use std::path::Path;

use crate::calibration::{Corner, Request};
use crate::plan::choose::{Chooser, decide};
use crate::plan::document::{Document, FollowState, Outcome, Plan, PlannedPose, TakenPicture, WhyEnded};
use crate::plan::survey::survey;
use crate::problem::{Overrides, Problem};
use crate::verification::simulate;

use super::*;

/// A problem and its plan.
struct Desk {
    problem: Problem,
    plan: Plan,
}

impl Desk {
    fn new(set: &[&str]) -> Self {
        let coarse = ["sweep.step_deg=20", "selection.off_grid=false", "selection.count=9"];
        let overrides = coarse.iter().chain(set).fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
        let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap();
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
        let plan = Plan::new(&chooser, &decision).unwrap();
        Self { problem, plan }
    }

    fn follow(&self, watches: bool, stated: &[(&str, f64)], state: Option<FollowState>) -> Follow<'_> {
        let stated: Vec<_> = stated.iter().map(|&(name, limit)| (name.to_owned(), limit)).collect();
        let until = Until::new(&self.problem, &self.plan, &stated).unwrap();
        Follow::new(&self.problem, &self.plan, "hash", until, watches, 2, state).unwrap()
    }

    /// A picture of a pose, with noise of its own.
    fn picture(&self, pose: &PlannedPose, seed: u64) -> TakenPicture {
        self.scattered(pose, seed, 1.0)
    }

    /// One whose corners scatter so many times as far.
    fn scattered(&self, pose: &PlannedPose, seed: u64, times: f64) -> TakenPicture {
        let Problem { robot, camera, target, noise, .. } = &self.problem;
        let X_CT = robot.camera_pose(&pose.joints_rad).inverse() * target.X_BT;
        let noise = crate::information::Noise { sigma: times * noise.sigma, ..*noise };
        let seen = simulate(camera, &target.board, &[X_CT], noise, seed).unwrap();
        TakenPicture::new("corners.vnl", &format!("{seed}.png"), &seen.views()[0])
    }
}

fn stop(told: &[Announcement]) -> Stop {
    let Some(Announcement::Go(stop)) = told.last() else { panic!("{told:?}") };
    (**stop).clone()
}

fn end(told: &[Announcement]) -> End {
    let Some(Announcement::End(end)) = told.last() else { panic!("{told:?}") };
    end.clone()
}

fn doubts(told: &[Announcement]) -> Vec<Doubt> {
    let doubts = told.iter().filter_map(|told| match told {
        Announcement::InDoubt(_, doubts) => Some(doubts.clone()),
        _ => None,
    });
    doubts.flatten().collect()
}

/// Takes pictures at all poses from the one announced last; what was told at the end, and how many were taken.
fn through(desk: &Desk, follow: &mut Follow, mut told: Vec<Announcement>) -> (Vec<Announcement>, u64) {
    let mut count = 0;
    while let Some(Announcement::Go(stop)) = told.last() {
        count += 1;
        assert!(count < 50);
        told = follow.take(Input::Pictures(vec![desk.picture(&stop.pose, stop.place as u64)]));
        assert_eq!(doubts(&told), []);
    }
    (told, count)
}

#[test]
fn without_pictures_answers_lead_through_the_tour() {
    let desk = Desk::new(&["motion.home=[0, 60, -100, 90]"]);
    let tour = desk.plan.tour.clone().unwrap();
    let mut follow = desk.follow(false, &[], None);
    let answer = |follow: &mut Follow, answer: Answer| follow.take(Input::Answer(answer));
    let first = stop(&follow.begin());
    assert_eq!((first.place, first.from, first.way.as_ref()), (0, Standing::Home, tour.moves.first()));
    assert_eq!(answer(&mut follow, Answer::Back), [Announcement::Refused(Refusal::First)]);
    // Nobody has gone there yet: the same way.
    assert_eq!(stop(&answer(&mut follow, Answer::Again)), first);
    for place in 1..9 {
        let next = stop(&answer(&mut follow, if place == 3 { Answer::Skip } else { Answer::Done }));
        assert_eq!((next.place, next.from), (place, Standing::Pose(place - 1)));
        assert_eq!((next.pose.id, next.way.as_ref()), (tour.order[place], tour.moves.get(place)));
    }
    // There and back again, by the same turns the other way.
    let back = stop(&answer(&mut follow, Answer::Back));
    assert_eq!((back.place, back.from), (7, Standing::Pose(8)));
    let turns = |way: &Option<crate::plan::document::MoveDocument>| way.as_ref().unwrap().via_rad.clone();
    assert_eq!(turns(&back.way), tour.moves[8].via_rad.iter().rev().cloned().collect::<Vec<_>>());
    assert!(Announcement::Go(Box::new(back)).sentence(&follow).contains("It is taken already"));
    answer(&mut follow, Answer::Done);
    let ended = end(&answer(&mut follow, Answer::Done));
    assert_eq!((ended.why, ended.good, ended.way.as_ref()), (WhyEnded::Poses, true, tour.moves.last()));
    assert_eq!([Outcome::Taken, Outcome::Skipped, Outcome::Open].map(|of| follow.count(of)), [8, 1, 0]);
    assert_eq!(answer(&mut follow, Answer::Done), []);
    // Whoever begins again sees that nothing is left.
    let state = follow.state().clone();
    assert_eq!(end(&desk.follow(false, &[], Some(state)).begin()).why, WhyEnded::Poses);
}

#[test]
fn the_tour_ends_as_soon_as_the_accuracy_is_reached() {
    let desk = Desk::new(&["motion.home=[0, 60, -100, 90]"]);
    let promised = desk.plan.map_error_px;
    let mut follow = desk.follow(true, &[("map_error_px", 3.0 * promised)], None);
    let mut told = follow.begin();
    let mut before = None;
    loop {
        let stop = stop(&told);
        told = follow.take(Input::Pictures(vec![desk.picture(&stop.pose, stop.place as u64)]));
        let Some(known) = follow.known() else { continue };
        let now = known.assessment.map_errors.rms;
        assert!(known.expected.is_none_or(|expected| expected < now), "{:?} {now}", known.expected);
        if let Some(Announcement::End(_)) = told.last() {
            assert!(now <= 3.0 * promised && before.is_none_or(|before| before > 3.0 * promised), "{now} {before:?}");
            // What is left would bring about what was promised.
            let expected = known.expected.unwrap();
            assert!((0.5..2.0).contains(&(expected / promised)), "{expected} {promised}");
            break;
        }
        before = Some(now);
    }
    let ended = end(&told);
    let left = follow.count(Outcome::Open);
    assert!(ended.why == WhyEnded::Accuracy && ended.good && left > 0);
    assert!(follow.seconds_left() > 0.0);
    // Home from here is not of the tour.
    assert!(ended.way.is_some_and(|way| way.seconds > 0.0));
    let sentence = told.last().unwrap().sentence(&follow);
    assert!(sentence.contains(&format!("{left} poses are saved")), "{sentence}");
    // More is asked for: on it goes, to the end, where what the plan promises is missed by little or not at all.
    let mut again = desk.follow(true, &[], Some(follow.state().clone()));
    let told = again.begin();
    let (told, count) = through(&desk, &mut again, told);
    assert!(count as usize <= left);
    match told.last().unwrap() {
        Announcement::End(end) => assert_eq!(end.why, WhyEnded::Accuracy),
        Announcement::More(2) => assert_eq!(count as usize, left),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_tour_goes_on_where_it_stopped_whenever_that_was() {
    let desk = Desk::new(&[]);
    let mut follow = desk.follow(true, &[], None);
    let mut told = follow.begin();
    for step in 0..6_u64 {
        let text = follow.state().to_json();
        let state = FollowState::from_json(&text).unwrap();
        assert_eq!(state.to_json(), text);
        let mut resumed = desk.follow(true, &[], Some(state));
        let stop = stop(&told);
        let begun = resumed.begin();
        assert_eq!(begun.last(), told.last());
        assert_eq!(resumed.known(), follow.known());
        let input = match step {
            2 => Input::Answer(Answer::Skip),
            4 => Input::Answer(Answer::Back),
            _ => Input::Pictures(vec![desk.picture(&stop.pose, step)]),
        };
        told = follow.take(input.clone());
        // What both know already, the resumed one need not have told again.
        assert_eq!(resumed.take(input), told);
        if step == 4 {
            // It says where it stands, not where it came from.
            assert_eq!(stop.place, follow.state().place + 1);
            told = follow.take(Input::Answer(Answer::Done));
        }
    }
    assert_eq!(end(&follow.take(Input::Closed)).why, WhyEnded::Closed);
    assert_eq!(end(&follow.take(Input::Answer(Answer::Quit))), End { why: WhyEnded::Quit, good: false, way: None });
}

#[test]
fn pictures_that_are_much_worse_than_planned_are_in_doubt() {
    let desk = Desk::new(&[]);
    let mut follow = desk.follow(true, &[], None);
    let first = stop(&follow.begin());
    let take = |follow: &mut Follow, picture: TakenPicture| follow.take(Input::Pictures(vec![picture]));
    let answer = |follow: &mut Follow, answer: Answer| follow.take(Input::Answer(answer));
    assert_eq!(answer(&mut follow, Answer::Done), [Announcement::Refused(Refusal::NoPicture)]);

    // Nothing to be seen, or next to nothing.
    assert_eq!(doubts(&take(&mut follow, TakenPicture::new("a.vnl", "a.png", &[]))), [Doubt::NotFound]);
    assert_eq!(answer(&mut follow, Answer::Done), [Announcement::Refused(Refusal::Unusable)]);
    let whole = desk.picture(&first.pose, 1);
    let cut = |corners: usize| TakenPicture { corners: whole.corners[..corners].to_vec(), ..whole.clone() };
    assert!(matches!(doubts(&take(&mut follow, cut(3)))[..], [Doubt::Unusable(_)]));
    assert_eq!(doubts(&take(&mut follow, cut(20))), [Doubt::FewCorners { found: 20, planned: 48 }]);
    // Rows taken for columns.
    let mut turned = whole.clone();
    for corner in &mut turned.corners {
        corner.index = 8 * (corner.index % 6) + corner.index / 6;
    }
    let told = take(&mut follow, turned);
    assert!(matches!(doubts(&told)[..], [Doubt::OtherBoard(_)]), "{told:?}");
    // The arm is there, and goes nowhere to take it again.
    let again = stop(&answer(&mut follow, Answer::Again));
    assert_eq!((again.place, again.from, again.way), (0, Standing::Here, None));
    // A whole one takes the place of what is in doubt.
    assert!(!doubts(&take(&mut follow, cut(20))).is_empty());
    let second = stop(&take(&mut follow, whole.clone()));
    assert_eq!((second.place, follow.state().visits[0].pictures.len()), (1, 1));

    // The arm did not move.
    let still = desk.picture(&first.pose, 2);
    assert_eq!(doubts(&take(&mut follow, still)), [Doubt::Still { other: "1.png".into() }]);
    // Whoever knows better lets it count.
    let mut third = stop(&answer(&mut follow, Answer::Done));
    assert_eq!((third.place, follow.state().visits[1].pictures.len()), (2, 1));
    // Or takes another, later.
    answer(&mut follow, Answer::Back);
    third = stop(&take(&mut follow, desk.picture(&second.pose, 3)));
    let names = |follow: &Follow| follow.state().visits[1].pictures.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    assert_eq!((third.place, names(&follow)), (2, vec!["3.png".to_owned()]));

    // Among five others, a blurred one and one with wrong corners stand out.
    for seed in 4..8 {
        third = stop(&take(&mut follow, desk.picture(&third.pose, seed)));
    }
    let told = take(&mut follow, desk.scattered(&third.pose, 9, 8.0));
    assert!(matches!(doubts(&told)[..], [Doubt::Residuals { .. }, ..]), "{told:?}");
    let sentence = told.last().unwrap().sentence(&follow);
    assert!(sentence.contains("its residuals are") && sentence.contains("`done` (Enter) lets it count"), "{sentence}");
    let mut wrong = desk.picture(&third.pose, 10);
    for corner in wrong.corners.iter_mut().take(5) {
        corner.corner_px[0] += 8.0;
    }
    let told = take(&mut follow, wrong);
    assert!(doubts(&told).contains(&Doubt::Outliers { count: 5, of: 48 }), "{told:?}");
    // It does not count yet.
    assert_eq!(follow.known().unwrap().observations.views().len(), 6);
    let next = stop(&answer(&mut follow, Answer::Skip));
    assert_eq!((next.place, follow.count(Outcome::Skipped)), (7, 1));
}

#[test]
fn poses_are_added_where_those_of_the_plan_do_not_suffice() {
    let desk = Desk::new(&[]);
    let until = [("map_error_px", 0.8 * desk.plan.map_error_px)];
    let mut follow = desk.follow(true, &until, None);
    let told = follow.begin();
    let (told, count) = through(&desk, &mut follow, told);
    assert_eq!((count, told.last()), (9, Some(&Announcement::More(2))));
    let added = follow.further(2, &|_| {}).unwrap();
    assert_eq!(added.len(), 2);
    let before = follow.known().unwrap().assessment.map_errors.rms;
    let told = follow.take(Input::Further(added.clone()));
    assert_eq!(told[0], Announcement::Added(2));
    assert!(follow.known().unwrap().expected.unwrap() < before);
    let next = stop(&told);
    assert_eq!((next.place, next.from, next.way.as_ref()), (9, Standing::Pose(8), Some(&added[0].way)));
    // The same after a pause.
    let mut resumed = desk.follow(true, &until, Some(follow.state().clone()));
    assert_eq!(stop(&resumed.begin()), next);
    let (told, count) = through(&desk, &mut resumed, told);
    // No more than these may be added.
    assert!(count <= 2);
    assert!([WhyEnded::Accuracy, WhyEnded::Poses].contains(&end(&told).why));
    assert!(resumed.known().unwrap().assessment.map_errors.rms < before);
    // None to add is the end.
    let mut state = follow.state().clone();
    state.visits.truncate(9);
    let mut other = desk.follow(true, &until, Some(state));
    assert_eq!(other.begin().last(), Some(&Announcement::More(2)));
    let ended = end(&other.take(Input::Further(vec![])));
    assert_eq!((ended.why, ended.good), (WhyEnded::Poses, false));
}

#[test]
fn every_pose_has_as_many_pictures_as_planned() {
    let desk = Desk::new(&["selection.pictures=2"]);
    let mut follow = desk.follow(true, &[], None);
    let first = stop(&follow.begin());
    let told = follow.take(Input::Pictures(vec![desk.picture(&first.pose, 1)]));
    assert!(matches!(told[..], [Announcement::Taken(_), ..]) && follow.state().place == 0, "{told:?}");
    let next = stop(&follow.take(Input::Pictures(vec![desk.picture(&first.pose, 2)])));
    // Two at once, or less where that is all there is.
    let both = vec![desk.picture(&next.pose, 3), desk.picture(&next.pose, 4)];
    let next = stop(&follow.take(Input::Pictures(both)));
    follow.take(Input::Pictures(vec![desk.picture(&next.pose, 5)]));
    let next = stop(&follow.take(Input::Answer(Answer::Done)));
    assert_eq!((next.place, follow.known().unwrap().observations.views().len()), (3, 5));
    // Names are made to differ.
    let mut again = desk.picture(&next.pose, 6);
    again.name = "1.png".into();
    follow.take(Input::Pictures(vec![again]));
    assert_eq!(follow.names(), ["1.png", "2.png", "3.png", "4.png", "5.png", "corners.vnl:1.png"]);
}

#[test]
fn plans_without_a_tour_go_by_their_ids_on_ways_that_are_found_then() {
    let mut desk = Desk::new(&[]);
    desk.plan.tour = None;
    let mut follow = desk.follow(false, &[], None);
    let first = stop(&follow.begin());
    assert_eq!((first.pose.id, first.from), (desk.plan.poses[0].id, Standing::Anywhere));
    let sentence = Announcement::Go(Box::new(first)).sentence(&follow);
    assert!(sentence.contains("The way to it is not planned"), "{sentence}");
    let second = stop(&follow.take(Input::Answer(Answer::Done)));
    assert_eq!(second.pose.id, desk.plan.poses[1].id);
    assert!(second.way.as_ref().is_some_and(|way| way.seconds > 0.0 && way.safe.is_none()));
    let sentence = Announcement::Go(Box::new(second)).sentence(&follow);
    assert!(sentence.contains("NOT tested for collision"), "{sentence}");
}

#[test]
fn states_of_other_plans_are_refused() {
    let desk = Desk::new(&[]);
    let mut follow = desk.follow(true, &[], None);
    let first = stop(&follow.begin());
    follow.take(Input::Pictures(vec![desk.picture(&first.pose, 1)]));
    let state = follow.state();
    let refused = |hash: &str, change: &dyn Fn(&mut FollowState)| {
        let mut state = state.clone();
        change(&mut state);
        let until = Until::new(&desk.problem, &desk.plan, &[]).unwrap();
        Follow::new(&desk.problem, &desk.plan, hash, until, true, 0, Some(state)).map(|_| ()).unwrap_err()
    };
    assert_eq!(refused("other", &|_| {}), Mismatch::Plan);
    assert_eq!(refused("hash", &|state| state.visits.swap(0, 1)), Mismatch::Poses);
    assert_eq!(refused("hash", &|state| state.visits.truncate(8)), Mismatch::Poses);
    assert_eq!(refused("hash", &|state| state.visits.push(state.visits[0].clone())), Mismatch::Poses);
    assert_eq!(refused("hash", &|state| state.place = 10), Mismatch::Place { place: 10, visits: 9 });
    let picture = refused("hash", &|state| state.visits[0].pictures[0].corners[0].index = 99);
    assert_eq!(
        picture.to_string(),
        "its picture 1.png is refused: view 0: corner 99 is not on the board, which has 48 corners"
    );
}

#[test]
fn accuracies_are_those_stated_else_the_problems_else_the_plans() {
    let desk = Desk::new(&[]);
    let until = |problem: &Problem, stated: &[(&str, f64)]| {
        let stated: Vec<_> = stated.iter().map(|&(name, limit)| (name.to_owned(), limit)).collect();
        Until::new(problem, &desk.plan, &stated)
    };
    let promised = until(&desk.problem, &[]).unwrap();
    assert_eq!(promised, Until { requests: vec![Request::MapError(desk.plan.map_error_px)], is_promise: true });
    let accuracy = Overrides::new().set("selection.accuracy={map_error_px=4.0, cx=2.0}").unwrap();
    let accurate = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &accuracy).unwrap();
    let requested = until(&accurate, &[]).unwrap();
    let cx = Request::Sigma { intrinsic: 2, sigma: 2.0 };
    assert!(!requested.is_promise && requested.requests.contains(&cx) && requested.requests.len() == 2);
    let stated = until(&accurate, &[("fx", 0.5)]).unwrap();
    assert_eq!(stated.requests, [Request::Sigma { intrinsic: 0, sigma: 0.5 }]);
    let unknown = until(&accurate, &[("fz", 0.5)]).unwrap_err().to_string();
    assert_eq!(unknown, "`fz` has no accuracy here; give one of map_error_px, fx, fy, cx, cy, k1, k2, p1, p2, k3");
}

/// Corners as [`TakenPicture`] keeps them are those that came.
#[test]
fn pictures_keep_their_corners() {
    let corner = Corner { index: 3, pixel: nalgebra::Vector2::new(0.1, 2.0 / 3.0), weight: 0.25 };
    assert_eq!(TakenPicture::new("a", "b", &[corner]).view(), [corner]);
}
