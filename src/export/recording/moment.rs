//! The tour in steps of time.

use crate::export::program::{Leg, Program, ProgramJoint};
use crate::motion::JointLimits;
use crate::motion::timing::Profile;

/// Time between two moments, s.
const STEP: f64 = 0.05;
/// Most moments of a move, and of a stay; of longer ones the steps are longer.
const MOST: f64 = 1000.0;

/// Where the robot is at a time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Moment<'a> {
    /// Time since the tour's start, s.
    pub(super) time: f64,
    /// Value of each joint, rad or m.
    pub(super) q: Vec<f64>,
    /// What the robot comes to, if it does.
    pub(super) arrival: Option<Arrival<'a>>,
}

/// A place that the robot comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arrival<'a> {
    /// What people call it.
    pub(super) label: &'a str,
    /// The number from 1 on of the picture that is taken there; none where none is.
    pub(super) visit: Option<usize>,
}

/// The moments of a tour from its first place, where it begins at rest, in the order of their times.
pub(super) fn moments<'a>(program: &'a Program) -> Vec<Moment<'a>> {
    let mut moments = Vec::new();
    let mut start = 0.0;
    for leg in program.legs() {
        let end = start + leg.seconds;
        if let Some(from) = leg.from {
            let profile = Profile::between(from, leg.to, &limits(program));
            for at in steps(leg.seconds) {
                // As the move takes just as long as the tour says, whatever the limits are.
                let share = profile.at(at / leg.seconds * profile.duration());
                let q = from.iter().zip(leg.to).map(|(from, to)| from + share * (to - from)).collect();
                moments.push(Moment { time: start + at, q, arrival: None });
            }
        }
        let Leg { label, visit, to, .. } = leg;
        moments.push(Moment { time: end, q: to.to_vec(), arrival: Some(Arrival { label, visit }) });
        start = end;
        if leg.visit.is_some() && program.dwell > 0.0 {
            start += program.dwell;
            let stays = steps(program.dwell).chain(std::iter::once(program.dwell));
            moments.extend(stays.map(|at| Moment { time: end + at, q: to.to_vec(), arrival: None }));
        }
    }
    moments
}

/// What the joints do at the tour's share of their speeds.
fn limits(program: &Program) -> Vec<JointLimits> {
    let of = |joint: &ProgramJoint| {
        let ProgramJoint { speed, acceleration, jerk, .. } = *joint;
        JointLimits { speed: program.share * speed, acceleration, jerk }
    };
    program.joints.iter().map(of).collect()
}

/// Times strictly between 0 and `seconds`, evenly apart.
fn steps(seconds: f64) -> impl Iterator<Item = f64> {
    let count = (seconds / STEP).ceil().clamp(1.0, MOST) as u32;
    (1..count).map(move |i| f64::from(i) * seconds / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{joints, program, stops};
    use crate::export::program::{Home, Stop};

    #[test]
    fn the_robot_is_where_the_tour_says_when_it_says() {
        let (joints, mut stops) = (joints(), stops());
        stops.insert(1, Stop { label: "way to pose 3".into(), picture: false, ..stops[1].clone() });
        stops[1].q[0] = 0.7;
        let home = Some(Home { q: vec![0.0; 6], back: Some(3.0) });
        let tour = Program { home, ..program(&joints, &stops) };
        let moments = moments(&tour);
        let arrivals = moments.iter().filter_map(|moment| Some((moment.time, moment.arrival?, &moment.q)));
        let arrivals: Vec<_> = arrivals.collect();
        let seen: Vec<(f64, &str, Option<usize>)> = arrivals.iter().map(|(t, a, _)| (*t, a.label, a.visit)).collect();
        // 9 s to pose 7, 1.5 s there, 2.5 s to the turn, 2.5 s to pose 3, 1.5 s there, 3 s home.
        let expected = [
            (0.0, "home", None),
            (9.0, "pose 7", Some(1)),
            (13.0, "way to pose 3", None),
            (15.5, "pose 3", Some(2)),
            (20.0, "home", None),
        ];
        assert_eq!(seen, expected);
        assert_eq!(*arrivals[1].2, stops[0].q);
        for pair in moments.windows(2) {
            let gap = pair[1].time - pair[0].time;
            assert!(gap > 0.0 && gap < STEP + 1e-9, "{gap}");
        }
    }

    #[test]
    fn moves_are_those_of_the_profile() {
        let (joints, mut stops) = (joints(), stops());
        let limits = limits(&program(&joints, &stops));
        let profile = Profile::between(&stops[0].q, &stops[1].q, &limits);
        stops[1].seconds = profile.duration();
        let tour = Program { dwell: 0.0, ..program(&joints, &stops) };
        let [from, to] = [&stops[0].q, &stops[1].q];
        for moment in moments(&tour) {
            let share = profile.at(moment.time);
            let off = (0..6).map(|j| (moment.q[j] - from[j] - share * (to[j] - from[j])).abs());
            assert!(off.fold(0.0, f64::max) < 1e-12, "{}", moment.time);
        }
    }

    #[test]
    fn long_tours_have_longer_steps() {
        let (joints, stops) = (joints(), stops());
        let tour = Program { dwell: 3600.0, ..program(&joints, &stops) };
        assert!(moments(&tour).len() < 2200);
    }
}
