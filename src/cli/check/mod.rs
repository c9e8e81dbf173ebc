//! `calipose check`.

mod lens;
mod sight;
mod tested;

use std::path::Path;

use serde_json::json;

use super::failure::Failure;
use super::plan::what_views_do;
use super::screen::{Screen, grouped, short};
use crate::feasibility::{Rejection, feasible_views};
use crate::plan::CollisionDocument;
use crate::problem::Problem;
use crate::sweep::{AxisRule, JointSpace};
use crate::target::AxisCase;
use lens::{lens, lens_text};
use sight::{sight, sight_text};
use tested::{center_of_mass, self_collision, tests_text};

/// Configurations tried to estimate how many see the board.
const PILOT: usize = 20_000;

/// Configurations swept per second and core, conservatively; see benches/.
const SWEEP_RATE: f64 = 5e7;

/// Seconds to test one candidate's view and weigh its information, conservatively.
const VIEW_TIME: f64 = 1e-5;

/// Seconds to test one visible candidate for collision and occlusion.
const BODY_TIME: f64 = 1e-4;

pub(super) fn run(file: &Path, screen: &mut Screen) -> Result<(), Failure> {
    let problem = Problem::read(file)?;
    let Problem { robot, target, space, .. } = &problem;
    let checks = problem.checks();
    let total = space.len();
    let pilot: Vec<usize> = if total <= PILOT {
        (0..total).collect()
    } else {
        // Golden-section steps: an even stride would be in step with the grid and see one value of the inner joints.
        (0..PILOT).map(|i| ((i as f64 * 0.618_033_988_749_895).fract() * total as f64) as usize).collect()
    };
    let (mut views, rejected) = feasible_views(&checks, space, &pilot);
    let visible = views.len() + rejected[Rejection::Unstable as usize..].iter().sum::<usize>();
    if problem.axis == AxisRule::Zone {
        views.retain(|view| view.axis_case(target) != AxisCase::Outside);
    }
    let share = views.len() as f64 / pilot.len() as f64;
    let seen = (share * total as f64).round() as usize;
    let p = problem.estimated.len();
    let cores = rayon::current_num_threads() as f64;
    // With the axis test the sweep hands on few; without it every configuration's view is tested.
    let tested = if problem.axis == AxisRule::Any { total } else { (0.1 * total as f64) as usize };
    let with_bodies = if checks.has_bodies() { visible as f64 / pilot.len() as f64 * total as f64 } else { 0.0 };
    let work = total as f64 / SWEEP_RATE + tested as f64 * VIEW_TIME + with_bodies * BODY_TIME;
    let seconds = work / cores + 0.5;
    let per_view = 8 * (robot.chain.dof() + 20 + p * (p + 1) / 2);
    let megabytes = ((tested * 8 + 2 * seen * per_view) as f64 / 1e6).ceil() + 30.0;
    let space_text = match space {
        JointSpace::Grid(grid) => {
            let counts: Vec<String> = grid.counts().iter().map(usize::to_string).collect();
            format!("grid of {} = {} configurations", counts.join(" x "), grouped(total))
        }
        JointSpace::Sample(_) => format!("sample of {} configurations", grouped(total)),
    };
    let selection = &problem.selection;
    screen.document(
        &json!({
            "format": "calipose.check",
            "version": 1,
            "problem": { "name": problem.name, "sha256": problem.sha256 },
            "configurations": total,
            "estimated_views": seen,
            "estimated_seconds": seconds,
            "estimated_memory_mb": megabytes,
            "camera": sight(&problem),
            "lens": lens(&problem.camera),
            "collision": CollisionDocument::new(&problem, checks.collision().links()),
            "self_collision": self_collision(&problem, &checks),
            "mass_kg": center_of_mass(&problem).map(|center| center.mass),
        })
        .to_string(),
    )?;
    screen.text(&format!(
        "{}: valid.\n{} joints, {space_text}.\n{}\n{}\n{}About {} of them {} (from {} tried).\n`calipose plan` would \
         choose {} poses by `{}` for criterion `{}`, estimating {}, and write to {}.\nIt would take about {} s and {} MB on \
         this machine.",
        problem.name,
        robot.chain.dof(),
        sight_text(&problem),
        lens_text(&problem.camera),
        tests_text(&problem, &checks),
        grouped(seen),
        what_views_do(&problem),
        grouped(pilot.len()),
        selection.count,
        selection.method.name(),
        selection.criterion(),
        problem.estimated_names().join(" "),
        problem.output.display(),
        short(seconds),
        megabytes,
    ))
}
