//! `calipose check`.

mod lens;
mod notes;
mod sight;
mod tested;

use super::design::{self, is_design};
use super::plan::what_views_do;
use super::study::{self, is_study};
use crate::cli::arguments::ProblemArguments;
use crate::cli::memory::Memory;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, duration, grouped, wrapped};
use crate::plan::assess::{Forecast, forecast};
use crate::plan::choose::home_is_safe;
use crate::plan::survey::diagnose;
use crate::problem::{Accuracy, Goal, Least, Problem};
use crate::sweep::JointSpace;
use lens::lens_text;
use notes::notes_text;
use sight::sight_text;
use tested::tests_text;

/// Simulated calibrations that `plan` ends with when nothing else is asked for.
const TRIALS: usize = 100;

pub(crate) fn run(arguments: &ProblemArguments, screen: &mut Screen) -> Result<(), Failure> {
    if is_study(arguments.path()) {
        return study::check(arguments.path(), screen);
    }
    if is_design(arguments.path()) {
        return design::check(arguments.path(), screen);
    }
    let problem = arguments.problem(&[])?;
    home_is_safe(&problem)?;
    let Problem { robot, space, .. } = &problem;
    let checks = problem.checks();
    let total = space.len();
    let forecast = forecast(&problem, TRIALS);
    let Forecast { tried, views, seconds, bytes, .. } = forecast;
    // Fewer views than poses are worth a look, and so are hardly more.
    let is_scarce = forecast.count.is_some_and(|count| views < count) || views == 0;
    let diagnosis = is_scarce.then(|| diagnose(&problem));
    let memory = Memory::here().warning(bytes);
    let space_text = match space {
        JointSpace::Grid(grid) => {
            let counts: Vec<String> = grid.counts().into_iter().map(grouped).collect();
            format!("grid of {} = {} configurations", counts.join(" x "), grouped(total))
        }
        JointSpace::Sample(_) => format!("sample of {} configurations", grouped(total)),
    };
    let search_limit = problem.selection.goal.searches().then_some(problem.selection.time_limit.as_secs_f64());
    let document = forecast.document(&problem, checks.collision().links(), diagnosis.as_ref(), memory.clone());
    screen.document(&document)?;
    let mut text = format!(
        "{}: valid.\n{}{} joints, {space_text}.\n{}\n{}\n{}About {} of them {} (from {} tried).\n`calipose plan` would choose {}, \
         estimating {}, and write to {}.\nIt would take about {}{} and {} MB on this machine.",
        problem.name,
        notes_text(&problem),
        robot.chain.dof(),
        sight_text(&document.camera),
        lens_text(&problem.camera, &document.lens),
        tests_text(&problem, &checks, &document),
        grouped(views),
        what_views_do(&problem),
        grouped(tried),
        chosen(&problem, &forecast),
        problem.unknowns().names().join(" "),
        problem.output.display(),
        duration(seconds),
        search_limit
            .map_or(String::new(), |limit| { format!(", up to {} more to search for the proof,", duration(limit)) }),
        grouped((bytes / 1e6).ceil() as usize),
    );
    if let Some(diagnosis) = &diagnosis {
        let few = if views == 0 { "no views".to_owned() } else { format!("only about {} views", grouped(views)) };
        text += &format!("\n\nWarning: {few}. {diagnosis}");
    }
    if let Some(memory) = memory {
        text += &format!("\n\nWarning: {memory}.");
    }
    screen.text(&wrapped(&text))
}

/// What would be chosen, and how.
fn chosen(problem: &Problem, forecast: &Forecast) -> String {
    let goal = &problem.selection.goal;
    let names = problem.unknowns().names();
    let (accuracies, least) = match goal {
        Goal::Best { count, method, .. } => {
            return format!("{} poses by `{}` for criterion `{goal}`", grouped(*count), method.name());
        }
        Goal::Within { seconds, .. } => {
            return format!("as many poses as serve in {seconds} s, for criterion `{goal}`");
        }
        Goal::Fewest { accuracies, least } => (accuracies, least),
    };
    let requested = accuracies.iter().map(|&(accuracy, requested)| match accuracy {
        Accuracy::MapError => format!("map_error_px {requested}"),
        Accuracy::Intrinsic(j) => format!("{} {requested}", names[j]),
    });
    let count = match forecast.count {
        Some(count) => format!("about {}", grouped(count)),
        None => "perhaps more than there are views".into(),
    };
    let which = match least {
        Least::Poses => "the fewest poses that reach",
        Least::Time => "the poses of the shortest tour that reach",
    };
    format!("{which} {} ({count})", requested.collect::<Vec<_>>().join(", "))
}
