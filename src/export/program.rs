//! What is exported: the robot's joints, and where the tour stops.

use std::collections::HashSet;

use super::error::ExportError;
use crate::robot::JointKind;

/// Longest move and longest dwell, s: a day. Also keeps every sum of them within ROS's 32 bits of seconds.
const MOST_SECONDS: f64 = 86_400.0;

/// Largest joint value, speed and acceleration, in rad or m and their rates: beyond every robot, and few digits as a decimal.
const MOST: f64 = 1e6;

/// A tour of stops, at each of which a picture is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Program<'a> {
    /// Name of the plan; names of programs and files are made of it.
    pub name: &'a str,
    /// The joints in the order of every `q`, from the robot's base on.
    pub joints: &'a [ProgramJoint],
    /// The stops in the order of the visit.
    pub stops: &'a [Stop],
    /// Where the tour begins, if it is not at its first stop.
    pub home: Option<Home>,
    /// How long the robot stands at a stop, s.
    pub dwell: f64,
    /// The share, 0.001 to 1, of the joints' greatest speeds that the robot may use; their accelerations and jerks it may use whole.
    pub share: f64,
}

/// A joint, and how fast it may be.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramJoint {
    /// As the robot's description names it.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Greatest speed, rad/s or m/s.
    pub speed: f64,
    /// Greatest acceleration, rad/s² or m/s².
    pub acceleration: f64,
    /// Greatest jerk, rad/s³ or m/s³; infinite where there is no limit.
    pub jerk: f64,
}

/// Where the robot stands for a picture, or turns on its way.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// What people call it, as "pose 7".
    pub label: String,
    /// Value of each joint, rad or m.
    pub q: Vec<f64>,
    /// How long the move to it from the stop before takes, s; without meaning where there is none before.
    pub seconds: f64,
    /// Whether a picture is taken there.
    pub picture: bool,
}

/// Where the tour begins, and may end.
#[derive(Debug, Clone, PartialEq)]
pub struct Home {
    /// Value of each joint, rad or m.
    pub q: Vec<f64>,
    /// How long the move back from the last stop takes, s; none where the tour ends there.
    pub back: Option<f64>,
}

/// A move of the tour and what follows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leg<'a> {
    /// What people call its end.
    pub(super) label: &'a str,
    /// Where it begins; none for the first, of which only the end is known.
    pub(super) from: Option<&'a [f64]>,
    /// Where it ends, rad or m.
    pub(super) to: &'a [f64],
    /// How long it takes, s; 0 for the first.
    pub(super) seconds: f64,
    /// The number from 1 on of the picture that is taken at its end; none where none is.
    pub(super) visit: Option<usize>,
}

impl Program<'_> {
    /// The moves: to where the tour begins, from stop to stop, and home if it ends there.
    pub(super) fn legs(&self) -> Vec<Leg<'_>> {
        let mut legs: Vec<Leg> = Vec::with_capacity(self.stops.len() + 2);
        let home = |seconds| {
            self.home.as_ref().map(|home| Leg { label: "home", from: None, to: &home.q, seconds, visit: None })
        };
        legs.extend(home(0.0));
        let mut visits = 0;
        for Stop { label, q, seconds, picture } in self.stops {
            visits += usize::from(*picture);
            legs.push(Leg { label, from: None, to: q, seconds: *seconds, visit: picture.then_some(visits) });
        }
        legs.extend(self.home.as_ref().and_then(|at| home(at.back?)));
        legs[0].seconds = 0.0;
        for i in 1..legs.len() {
            legs[i].from = Some(legs[i - 1].to);
        }
        legs
    }

    /// The stops at which pictures are taken.
    pub(super) fn visits(&self) -> impl Iterator<Item = &Stop> {
        self.stops.iter().filter(|stop| stop.picture)
    }

    /// What files say that hold the poses alone, where the robot turns on its way from one to another.
    pub(super) fn note_of_turns(&self) -> Option<String> {
        let turns = self.stops.iter().filter(|stop| !stop.picture).count();
        (turns > 0).then(|| {
            format!(
                "NOT in this file: {turns} turns on the way from pose to pose. Straight moves there are not safe: let the ways be planned \
                 with all that stands around the robot, or take another format."
            )
        })
    }

    /// Whether a joint has a limit of jerk.
    pub(super) fn limits_jerk(&self) -> bool {
        self.joints.iter().any(|joint| joint.jerk.is_finite())
    }

    /// Whether every joint turns.
    pub(super) fn turns_only(&self) -> bool {
        self.joints.iter().all(|joint| joint.kind == JointKind::Revolute)
    }

    /// That there is a tour, with names and numbers that make sense.
    pub(super) fn check(&self) -> Result<(), ExportError> {
        for (what, is_empty) in [("joints", self.joints.is_empty()), ("stops", self.stops.is_empty())] {
            if is_empty {
                return Err(ExportError::Empty { what });
            }
        }
        self.check_joints()?;
        within("the share of the speeds", self.share, 1e-3, 1.0, "0.001 to 1")?;
        within("the dwell", self.dwell, 0.0, MOST_SECONDS, "0 to 86400 s")?;
        for stop in self.stops {
            self.check_place(&stop.label, &stop.q)?;
        }
        if let Some(home) = &self.home {
            self.check_place("home", &home.q)?;
        }
        self.legs().iter().try_for_each(check_time)
    }

    fn check_joints(&self) -> Result<(), ExportError> {
        let mut names = HashSet::new();
        for joint in self.joints {
            let name = joint.name.as_str();
            if name.is_empty() || !names.insert(name) {
                return Err(ExportError::JointName { name: name.to_owned() });
            }
            for (what, value) in [("speed", joint.speed), ("acceleration", joint.acceleration)] {
                within(&format!("the greatest {what} of \"{name}\""), value, 1e-9, MOST, "1e-9 to 1e6 in SI units")?;
            }
            // It stands in no file.
            let expected = "1e-9 in SI units or more, or infinite";
            within(&format!("the greatest jerk of \"{name}\""), joint.jerk, 1e-9, f64::INFINITY, expected)?;
        }
        Ok(())
    }

    fn check_place(&self, label: &str, q: &[f64]) -> Result<(), ExportError> {
        if q.len() != self.joints.len() {
            return Err(ExportError::Length { place: label.to_owned(), found: q.len(), expected: self.joints.len() });
        }
        for (joint, &value) in self.joints.iter().zip(q) {
            within(&format!("\"{}\" of {label}", joint.name), value, -MOST, MOST, "finite, and at most 1e6 rad or m")?;
        }
        Ok(())
    }
}

/// That a move has a time, and time if it is one.
fn check_time(leg: &Leg) -> Result<(), ExportError> {
    let moves = leg.from.is_some_and(|from| from != leg.to);
    let (least, expected) = if moves { (f64::MIN_POSITIVE, "above 0, up to 86400 s") } else { (0.0, "0 to 86400 s") };
    within(&format!("the time of the move to {}", leg.label), leg.seconds, least, MOST_SECONDS, expected)
}

fn within(what: &str, value: f64, least: f64, most: f64, expected: &'static str) -> Result<(), ExportError> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(ExportError::Number { what: what.to_owned(), value, expected })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{JOINTS, joints, program, stops};

    #[test]
    fn legs_begin_and_end_at_home() {
        let (joints, stops) = (joints(), stops());
        let mut tour = program(&joints, &stops);
        let seen = |tour: &Program| tour.legs().iter().map(|l| (l.label.to_owned(), l.seconds)).collect::<Vec<_>>();
        assert_eq!(seen(&tour), [("pose 7".into(), 0.0), ("pose 3".into(), 2.5)]);
        assert_eq!(tour.legs()[0].from, None);
        tour.home = Some(Home { q: vec![0.0; JOINTS], back: Some(3.0) });
        let legs = [("home", 0.0), ("pose 7", 9.0), ("pose 3", 2.5), ("home", 3.0)];
        assert_eq!(seen(&tour), legs.map(|(label, seconds)| (label.to_owned(), seconds)));
        assert_eq!(tour.legs()[1].from, Some(&[0.0; JOINTS][..]));
        assert_eq!(tour.legs()[3].visit, None);
        tour.home = Some(Home { q: vec![0.0; JOINTS], back: None });
        assert_eq!(
            seen(&tour),
            legs[..3].iter().map(|&(label, seconds)| (label.to_owned(), seconds)).collect::<Vec<_>>()
        );
    }

    #[test]
    fn nonsense_is_refused() {
        let (joints, stops) = (joints(), stops());
        let good = program(&joints, &stops);
        assert_eq!(good.check(), Ok(()));
        let fault = |program: &Program| program.check().unwrap_err().to_string();
        assert_eq!(fault(&Program { stops: &[], ..good.clone() }), "there are no stops");
        assert_eq!(
            fault(&Program { share: 0.0, ..good.clone() }),
            "the share of the speeds is 0; it must be 0.001 to 1"
        );
        assert!(fault(&Program { dwell: f64::NAN, ..good.clone() }).starts_with("the dwell is NaN"));
        let home = Some(Home { q: vec![0.0; 2], back: None });
        assert_eq!(fault(&Program { home, ..good.clone() }), "home has 2 joint values, but the robot has 6 joints");
        let mut wrong = stops.clone();
        wrong[1].seconds = 0.0;
        assert!(fault(&Program { stops: &wrong, ..good.clone() }).starts_with("the time of the move to pose 3 is 0"));
        wrong[1].q[2] = f64::INFINITY;
        assert!(fault(&Program { stops: &wrong, ..good.clone() }).starts_with("\"joint_3\" of pose 3 is inf"));
        let mut jerky = joints.clone();
        jerky[1].jerk = 2e7;
        assert_eq!(Program { joints: &jerky, ..good.clone() }.check(), Ok(()));
        jerky[1].jerk = 0.0;
        assert!(
            fault(&Program { joints: &jerky, ..good.clone() }).starts_with("the greatest jerk of \"joint_2\" is 0")
        );
        let mut twice = joints.clone();
        twice[1].name = "joint_1".into();
        assert!(fault(&Program { joints: &twice, ..good }).starts_with("a joint is called \"joint_1\""));
    }
}
