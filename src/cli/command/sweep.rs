//! `calipose sweep`.

use std::time::Instant;

use clap::Args;

use crate::cli::arguments::ProblemArguments;
use crate::cli::long_work::sweeping;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, grouped, table, wrapped};
use crate::plan::document::{SweepCounts, SweepDocument};
use crate::plan::survey::certain_views;
use crate::sweep::sweep;

#[derive(Debug, Args)]
pub(crate) struct SweepArguments {
    #[command(flatten)]
    problem: ProblemArguments,
    /// Steps in degrees, each for all revolute joints, one sweep per step [default: those with published counts, else the
    /// file's]
    #[arg(long, short, value_delimiter = ',', allow_hyphen_values = true)]
    step: Vec<String>,
}

pub(crate) fn run(arguments: &SweepArguments, screen: &mut Screen) -> Result<(), Failure> {
    let file = arguments.problem.problem(&[])?;
    let mut steps = arguments.step.clone();
    if steps.is_empty() {
        steps = file.published.iter().map(|published| published.step.to_degrees().to_string()).collect();
    }
    let problems = if steps.is_empty() {
        vec![(None, file)]
    } else {
        let with_step = |step: &String| {
            let problem = arguments.problem.problem(&[("sweep.step_deg", Some(step.clone()))])?;
            Ok((step.parse().ok().map(f64::to_radians), problem))
        };
        steps.iter().map(with_step).collect::<Result<Vec<_>, Failure>>()?
    };
    let mut rows = Vec::new();
    let mut counts = Vec::new();
    for (step, problem) in &problems {
        let start = Instant::now();
        let found = sweeping(screen, problem, |observe| {
            sweep(&problem.robot, &problem.target, &problem.space, problem.axis, observe)
        });
        let seconds = start.elapsed().as_secs_f64();
        let (views, rejected) = certain_views(problem, &problem.checks(), &found.candidates);
        let in_zone = found.inside + found.edge;
        let published = step
            .and_then(|step| problem.published.iter().find(|published| (published.step - step).abs() < 1e-9 * step));
        let degrees = step.map(|step| (step.to_degrees() * 1e9).round() / 1e9);
        let or_dash = |count: Option<usize>| count.map_or("-".into(), grouped);
        rows.push(
            [
                degrees.map_or("file's".into(), |step| step.to_string()),
                grouped(found.swept),
                grouped(found.inside),
                grouped(found.edge),
                grouped(in_zone),
            ]
            .into_iter()
            .chain([or_dash(published.map(|p| p.swept)), or_dash(published.map(|p| p.in_zone))])
            .chain([grouped(views.len()), format!("{:.1}", seconds * 1e3)])
            .collect(),
        );
        counts.push(SweepCounts::new(degrees, &found, published, views.len(), rejected, seconds));
    }
    let first = &problems[0].1;
    screen.document(&SweepDocument::new(first, counts))?;
    let header = ["step", "Q", "inside", "edge", "Q*", "publ. Q", "publ. Q*", "views", "ms"];
    let legend = "Q configurations swept; Q* of them point the camera at the board's zone, inside of it or at its edge; publ.: as \
                  published; views see the board.";
    screen.text(&format!("{}\n{}\n\n{}", first.name, wrapped(legend), table(&header, &rows)))
}
