//! The paper's table III: how many configurations there are, and how many point the camera at the marker zone.
//!
//! The zone is inferred, so this does not prove the paper's counts; it holds the grid exactly and the zone's counts to
//! those of an independent computation.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use calipose::problem::Problem;
use calipose::sweep::{AxisRule, sweep};

const FILE: &str = "problems/servosila-engineer.toml";

fn swept_and_kept(problem: &Problem, step_deg: f64) -> (usize, usize) {
    let problem = problem.with_step(step_deg.to_radians()).unwrap();
    let found = sweep(&problem.robot, &problem.target, &problem.space, AxisRule::Zone, &|_| {});
    assert_eq!(found.candidates.len(), found.inside + found.edge);
    (found.swept, found.candidates.len())
}

#[test]
fn reference_limits() {
    let problem = Problem::read(Path::new(FILE)).unwrap();
    assert_eq!(swept_and_kept(&problem, 20.0), (13_860, 364));
    assert_eq!(swept_and_kept(&problem, 10.0), (210_672, 4_525));
    assert_eq!(swept_and_kept(&problem, 8.0), (502_656, 10_735));
}

#[test]
fn telemetry_limits() {
    let text = std::fs::read_to_string(FILE).unwrap();
    let text = text.replace("limits = \"reference\"", "limits = \"telemetry\"");
    let problem = Problem::parse(&text, Path::new(FILE)).unwrap();
    assert_eq!(swept_and_kept(&problem, 20.0).1, 192);
    assert_eq!(swept_and_kept(&problem, 10.0).1, 2_973);
    assert_eq!(swept_and_kept(&problem, 8.0).1, 6_770);
}
