//! `calipose polish`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::WRITING;
use super::collision::untested_text;
use super::failure::Failure;
use super::plan::pose_table;
use super::planned::Planned;
use super::screen::{Screen, short};
use crate::plan::{PolishSettings, PolishedPlan, polish, write_together};

#[derive(Debug, Args)]
pub(super) struct PolishArguments {
    /// Plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one that run.json beside the plan names]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Most cycles over all poses
    #[arg(long, default_value_t = PolishSettings::default().cycles)]
    cycles: usize,
}

pub(super) fn run(arguments: &PolishArguments, screen: &mut Screen) -> Result<(), Failure> {
    if arguments.cycles == 0 {
        return Err(Failure::Usage("--cycles must be at least 1".into()));
    }
    let planned = Planned::read(&arguments.plan, arguments.problem.as_deref())?;
    let survey = planned.survey(screen)?;
    let (chooser, selected) = planned.recall(&arguments.plan, &survey)?;
    let settings = PolishSettings { cycles: arguments.cycles, ..PolishSettings::default() };
    let bar = screen.spinner("polishing");
    let polished = polish(&planned.problem, &chooser, &selected, &settings, &mut |log_value| {
        bar.set_message(format!("value {}", short(chooser.natural(log_value))));
        bar.tick();
    });
    bar.finish_and_clear();
    let Planned { plan, problem, .. } = &planned;
    let found = PolishedPlan::new(problem, &chooser, plan, &polished?);

    let table = found.to_csv().map_err(|error| Failure::Table(error.to_string()))?;
    let files = [("polished.json", found.to_json().into_bytes()), ("polished.csv", table)];
    let folder = arguments.plan.parent().unwrap_or(Path::new(""));
    let writing = WRITING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    write_together(folder, &files, &[])?;
    drop(writing);

    screen.document(&found.to_json())?;
    let end = if found.converged { "" } else { ", where the limit ended them" };
    screen.text(&format!(
        "{}: {} poses polished in {} cycles{end}.\n\n\
         Criterion `{}`: value {} on the grid, {} off it: {:.2} % more information.\n\
         Map error: {} px on the grid, {} px off it.\n\
         Of the grid's bound {} the plan reached {:.4}, the polished poses {:.4}: {}.\n\n{}\n\n{}\
         Written to {}: polished.json, polished.csv.",
        found.problem.name,
        found.count,
        found.cycles,
        found.criterion,
        short(found.grid.value),
        short(found.value),
        100.0 * found.gain,
        short(found.grid.map_error_px),
        short(found.map_error_px),
        short(found.grid.bound),
        found.grid.efficiency,
        found.efficiency_by_grid_bound,
        found.proven,
        pose_table(problem, &found.poses),
        untested_text(problem).map(|line| format!("{line}\n")).unwrap_or_default(),
        if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.display(),
    ))
}
