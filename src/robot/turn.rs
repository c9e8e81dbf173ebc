//! Joints that go round: which values of theirs are one place.

use std::f64::consts::{PI, TAU};

use super::{Joint, JointKind, Limits, Motion, Robot};

/// The values to sweep of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The joint's limits, or a whole turn within them.
    pub limits: Limits,
    /// Whether the ends are one place.
    pub is_turn: bool,
}

/// Ranges that miss a whole turn by less than this, in rad, are one: 360° is no binary fraction of a rad.
const ROUNDING: f64 = 1e-9;
/// Ranges that pass a whole turn by less than this are one as they stand: descriptions write ±3.1416.
const OVERLAP: f64 = 1e-3;

impl Limits {
    /// The turn nearest to 0 in the range, if it holds one.
    fn turn(&self) -> Option<Self> {
        let Self { min, max } = *self;
        if max - min < TAU - ROUNDING {
            return None;
        }
        if max - min <= TAU + OVERLAP {
            return Some(*self);
        }
        let middle = 0f64.max(min + PI).min(max - PI);
        Some(Self { min: middle - PI, max: middle + PI })
    }
}

impl Robot {
    /// What of each joint's range holds every place that it can go to, mostly once: the turn nearest to 0 where a joint that goes
    /// round has a range of more than one, else the range.
    pub fn spans(&self) -> Vec<Span> {
        let span = |(i, limits): (usize, Limits)| {
            let turn = limits.turn().filter(|_| self.goes_round(i));
            Span { limits: turn.unwrap_or(limits), is_turn: turn.is_some() }
        };
        self.chain.joints.iter().map(|joint| joint.limits).enumerate().map(span).collect()
    }

    /// What poses may have of each joint's range: of a joint that goes round one turn, of others the limits less their margin.
    pub fn pose_ranges(&self) -> Vec<Limits> {
        let range = |(joint, span): (&Joint, Span)| {
            let Limits { min, max } = joint.range();
            Limits { min: min.max(span.limits.min), max: max.min(span.limits.max) }
        };
        self.chain.joints.iter().zip(self.spans()).map(range).collect()
    }

    /// Takes whole turns off joint values, so that joints that go round stay within the turn nearest to 0.
    pub fn unwind(&self, q: &mut [f64]) {
        self.take_turns(q);
        for (q, joint) in q.iter_mut().zip(&self.chain.joints) {
            *q = q.max(joint.limits.min).min(joint.limits.max);
        }
    }

    /// The same, but leaves values of joints that do not go round where they are, also beyond their limits.
    pub(crate) fn take_turns(&self, q: &mut [f64]) {
        for (q, span) in q.iter_mut().zip(self.spans()) {
            let Limits { min, max } = span.limits;
            if span.is_turn && !(min..=max).contains(q) {
                *q = min + (*q - min).rem_euclid(TAU);
            }
        }
    }

    /// Whether a whole turn of the joint brings everything back to where it was, also what mimics it.
    fn goes_round(&self, joint: usize) -> bool {
        let stages = self.chain.stages.iter().map(|stage| &stage.motion);
        let links = self.tree.links.iter().map(|link| &link.motion);
        stages.chain(links).all(|motion| match motion {
            Motion::Driven { joint: driver, kind, multiplier, .. } if *driver == joint => {
                *kind == JointKind::Revolute && multiplier.fract() == 0.0
            }
            _ => true,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::dh::{self, Convention, Row};
    use crate::spatial::Pose;

    fn robot(kind: JointKind, degrees: [f64; 2]) -> Robot {
        let [min, max] = degrees.map(f64::to_radians);
        let (a, limits) = (0.3, Limits { min, max });
        let row = Row { name: "j".into(), kind, a, alpha: 0.5, d: 0.1, theta: 0.2, limits, max_speed: None };
        let rows = [row];
        let chain = dh::chain(&rows, Convention::Standard, Pose::identity());
        let tree = dh::tree(&rows, Convention::Standard, Pose::identity());
        Robot { chain, tree, X_FC: Pose::identity(), board_link: 0, camera_link: 0, obstacles: Vec::new() }
    }

    #[test]
    fn poses_keep_to_one_turn_and_to_the_margin() {
        let ranges = |degrees| {
            let mut robot = robot(JointKind::Revolute, degrees);
            robot.chain.joints[0].limit_margin = 0.5f64.to_radians();
            let Limits { min, max } = robot.pose_ranges()[0];
            [min, max].map(|rad| (rad.to_degrees() * 1e6).round() / 1e6)
        };
        assert_eq!(ranges([-360.0, 360.0]), [-180.0, 180.0]);
        assert_eq!(ranges([-90.0, 45.0]), [-89.5, 44.5]);
    }

    #[test]
    fn the_turn_nearest_to_zero_holds_every_place_once() {
        let swept = |kind, degrees| {
            let [Span { limits, is_turn }] = robot(kind, degrees).spans()[..] else { panic!() };
            ([limits.min, limits.max].map(|rad| (rad.to_degrees() * 1e6).round() / 1e6), is_turn)
        };
        let revolute = JointKind::Revolute;
        assert_eq!(swept(revolute, [-360.0, 360.0]), ([-180.0, 180.0], true));
        assert_eq!(swept(revolute, [-100.0, 400.0]), ([-100.0, 260.0], true));
        assert_eq!(swept(revolute, [200.0, 900.0]), ([200.0, 560.0], true));
        assert_eq!(swept(revolute, [-180.0, 180.0]), ([-180.0, 180.0], true));
        assert_eq!(swept(revolute, [-180.001, 180.001]), ([-180.001, 180.001], true));
        assert_eq!(swept(revolute, [-179.0, 180.0]), ([-179.0, 180.0], false));
        assert_eq!(swept(JointKind::Prismatic, [-360.0, 360.0]), ([-360.0, 360.0], false));
    }

    #[test]
    fn unwinding_moves_no_link() {
        let robot = robot(JointKind::Revolute, [-360.0, 360.0]);
        for (wound, expected) in [(347.6, -12.4), (-190.0, 170.0), (180.0, 180.0), (-12.4, -12.4), (360.0, 0.0)] {
            let mut q = [f64::to_radians(wound)];
            let before = robot.camera_pose(&q);
            robot.unwind(&mut q);
            assert!((q[0].to_degrees() - expected).abs() < 1e-12, "{wound} {q:?}");
            assert!((robot.camera_pose(&q).to_homogeneous() - before.to_homogeneous()).norm() < 1e-14);
        }
    }

    /// What follows it at half the speed faces backwards after a turn.
    #[test]
    fn joints_that_others_follow_at_another_rate_do_not_go_round() {
        let mut robot = robot(JointKind::Revolute, [-360.0, 360.0]);
        let follower = |multiplier| Motion::Driven {
            joint: 0,
            kind: JointKind::Revolute,
            axis: nalgebra::Vector3::x_axis(),
            multiplier,
            offset: 0.3,
        };
        let link = robot.tree.links.len() - 1;
        robot.tree.links[link].motion = follower(-2.0);
        assert!(robot.spans()[0].is_turn);
        robot.tree.links[link].motion = follower(0.5);
        assert!(!robot.spans()[0].is_turn);
    }
}
