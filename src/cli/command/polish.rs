//! `calipose polish`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::interrupt::writing;
use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::output::collision::untested_text;
use crate::cli::output::failure::Failure;
use crate::cli::output::pose_table::pose_table;
use crate::cli::output::{Screen, short, wrapped};
use crate::plan::assess::polish;
use crate::plan::choose::PolishSettings;
use crate::plan::document::Document;
use crate::plan::results::{add_results, probe};
use crate::report::on_the_way;

#[derive(Debug, Args)]
pub(crate) struct PolishArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one named in run.json beside the plan]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Maximum number of cycles over all poses
    #[arg(long, default_value_t = PolishSettings::default().cycles)]
    cycles: usize,
}

/// What is written beside the plan; what was there before is of no account.
const FILES: [&str; 2] = ["polished.json", "polished.csv"];

pub(crate) fn run(arguments: &PolishArguments, screen: &mut Screen) -> Result<(), Failure> {
    if arguments.cycles == 0 {
        return Err(Failure::Usage("--cycles must be at least 1".into()));
    }
    let loaded = LoadedPlan::read_to_add(&arguments.plan, arguments.problem.as_deref(), &FILES)?;
    let folder = arguments.plan.parent().unwrap_or(Path::new(""));
    probe(folder)?;
    let survey = loaded.survey(&arguments.plan, screen)?;
    let (chooser, selected) = loaded.locate(&arguments.plan, &survey)?;
    let settings = PolishSettings { cycles: arguments.cycles, ..PolishSettings::default() };
    let bar = screen.spinner("polishing");
    let polished = polish(&loaded.problem, &chooser, &selected, &settings, &mut |log_value| {
        bar.set_message(format!("value {}", short(chooser.natural(log_value))));
        bar.tick();
    });
    bar.finish_and_clear();
    let LoadedPlan { plan, problem, text, .. } = &loaded;
    let found = polished?.document(problem, &chooser, plan);

    let table = found.to_csv(&problem.robot.chain.joints).map_err(|error| Failure::Table(error.to_string()))?;
    let [document, poses] = FILES;
    let files = [(poses, table), (document, found.to_json().into_bytes())];
    writing(|| add_results(&arguments.plan, text.as_bytes(), None, &files))?;

    screen.document(&found)?;
    let end = if found.converged { "" } else { ", which is the limit" };
    screen.text(&format!(
        "{}: {} poses polished in {} cycles{end}.\n\n\
         Criterion `{}`: value {} on the grid, {} off it: {:.2} % more information.\n\
         Map error: {} px on the grid, {} px off it.\n\
         Share of the grid's bound {}: {:.4} by the plan, {:.4} by the polished poses; {}.\n\n{}\n\n{}{}\
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
        pose_table(problem, &found.in_order()),
        found.tour.as_ref().map(|tour| wrapped(&format!("{}\n", on_the_way(tour)))).unwrap_or_default(),
        untested_text(problem).map(|line| format!("{line}\n")).unwrap_or_default(),
        if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.display(),
    ))
}
