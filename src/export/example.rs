//! A tour that the tests write.

use super::program::{Program, ProgramJoint, Stop};
use crate::robot::JointKind;

pub(super) const JOINTS: usize = 6;

pub(super) fn joints() -> Vec<ProgramJoint> {
    let joint = |i| ProgramJoint {
        name: format!("joint_{i}"),
        kind: JointKind::Revolute,
        speed: 2.0,
        acceleration: 4.0,
        jerk: f64::INFINITY,
    };
    (1..=JOINTS).map(joint).collect()
}

pub(super) fn stops() -> Vec<Stop> {
    let stop =
        |label: &str, q: [f64; JOINTS], seconds| Stop { label: label.into(), q: q.into(), seconds, picture: true };
    // 9 s is of the move from home, where there is one.
    vec![stop("pose 7", [0.1, -0.5, 1.0, -0.0, 1e-7, 3.0], 9.0), stop("pose 3", [0.4, 0.25, 1.0, 0.1, -0.2, 1.8], 2.5)]
}

pub(super) fn program<'a>(joints: &'a [ProgramJoint], stops: &'a [Stop]) -> Program<'a> {
    Program { name: "my robot", joints, stops, home: None, dwell: 1.5, share: 0.5 }
}

/// What `text` says below its comments, which begin with `comment`.
pub(super) fn below(text: &str, comment: &str) -> String {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with(comment));
    lines.map(|line| format!("{line}\n")).collect()
}
