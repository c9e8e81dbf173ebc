//! The paper's table III: how many configurations there are, and how many point the camera at the marker zone.
//!
//! The zone is inferred, so this does not prove the paper's counts; it holds the grid exactly and the zone's counts to
//! those of an independent computation.

use std::path::Path;

use calipose::problem::{Overrides, Problem};
use calipose::sweep::{AxisRule, sweep};

fn swept_and_kept(limits: &str, step_deg: u32) -> (usize, usize) {
    let overrides = Overrides::new().set(&format!("robot.limits={limits}")).unwrap();
    let overrides = overrides.set(&format!("sweep.step_deg={step_deg}")).unwrap();
    let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap();
    let found = sweep(&problem.robot, &problem.target, &problem.space, AxisRule::Zone, &|_| {});
    assert_eq!(found.candidates.len(), found.inside + found.edge);
    (found.swept, found.candidates.len())
}

#[test]
fn reference_limits() {
    assert_eq!(swept_and_kept("reference", 20), (13_860, 364));
    assert_eq!(swept_and_kept("reference", 10), (210_672, 4_525));
    assert_eq!(swept_and_kept("reference", 8), (502_656, 10_735));
}

#[test]
fn telemetry_limits() {
    assert_eq!(swept_and_kept("telemetry", 20).1, 192);
    assert_eq!(swept_and_kept("telemetry", 10).1, 2_973);
    assert_eq!(swept_and_kept("telemetry", 8).1, 6_770);
}
