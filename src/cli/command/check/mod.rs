//! `calipose check`.

mod lens;
mod notes;
mod sight;
mod tested;

use std::path::Path;

use super::plan::what_views_do;
use crate::cli::memory::Memory;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, grouped};
use crate::plan::document::CheckDocument;
use crate::plan::survey::{Forecast, diagnose, forecast};
use crate::problem::Method;
use crate::problem::{Accuracy, Problem};
use crate::sweep::JointSpace;
use lens::lens_text;
use notes::notes_text;
use sight::sight_text;
use tested::tests_text;

/// Simulated calibrations that `plan` ends with when nothing else is asked for.
const TRIALS: usize = 100;

pub(crate) fn run(file: &Path, screen: &mut Screen) -> Result<(), Failure> {
    let problem = Problem::read(file)?;
    let Problem { robot, space, .. } = &problem;
    let checks = problem.checks();
    let total = space.len();
    let forecast = forecast(&problem, TRIALS);
    let Forecast { tried, views, seconds, bytes, .. } = forecast;
    // Fewer views than poses are worth a look, and so are hardly more.
    let is_scarce = views < forecast.count.unwrap_or(problem.selection.count);
    let diagnosis = is_scarce.then(|| diagnose(&problem));
    let memory = Memory::here().warning(bytes);
    let space_text = match space {
        JointSpace::Grid(grid) => {
            let counts: Vec<String> = grid.counts().into_iter().map(grouped).collect();
            format!("grid of {} = {} configurations", counts.join(" x "), grouped(total))
        }
        JointSpace::Sample(_) => format!("sample of {} configurations", grouped(total)),
    };
    let search_limit = searches(&problem).then_some(problem.selection.time_limit.as_secs_f64());
    let document = CheckDocument::new(
        &problem,
        checks.collision().links(),
        &forecast,
        search_limit,
        diagnosis.as_ref(),
        memory.clone(),
    );
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
        problem.estimated_names().join(" "),
        problem.output.display(),
        duration(seconds),
        search_limit.map_or(String::new(), |limit| {
            format!(", up to {} more for the search for the proof,", duration(limit))
        }),
        grouped((bytes / 1e6).ceil() as usize),
    );
    if let Some(diagnosis) = &diagnosis {
        let few = if views == 0 { "no views".to_owned() } else { format!("only about {} views", grouped(views)) };
        text += &format!("\n\nWarning: {few}. {diagnosis}");
    }
    if let Some(memory) = memory {
        text += &format!("\n\nWarning: {memory}.");
    }
    screen.text(&text)
}

/// Whether a search follows that its time limit ends.
fn searches(problem: &Problem) -> bool {
    let selection = &problem.selection;
    selection.method == Method::Exact || !selection.accuracies.is_empty()
}

/// What would be chosen, and how.
fn chosen(problem: &Problem, forecast: &Forecast) -> String {
    let selection = &problem.selection;
    let names = problem.estimated_names();
    if selection.accuracies.is_empty() {
        let method = selection.method.name();
        return format!("{} poses by `{method}` for criterion `{}`", grouped(selection.count), selection.criterion());
    }
    let wished = selection.accuracies.iter().map(|&(accuracy, wished)| match accuracy {
        Accuracy::MapError => format!("map_error_px {wished}"),
        Accuracy::Intrinsic(j) => format!("{} {wished}", names[j]),
    });
    let count = match forecast.count {
        Some(count) => format!("about {}", grouped(count)),
        None => "perhaps more than there are".into(),
    };
    format!("the fewest poses that reach {} ({count})", wished.collect::<Vec<_>>().join(", "))
}

/// A time as one would say it.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{} days", grouped((s / 86_400.0) as usize)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_in_their_units() {
        assert_eq!(
            [0.52, 33.2, 119.0, 150.0, 8000.0, 1e6].map(duration),
            ["0.5 s", "33 s", "119 s", "2 min", "2.2 h", "11 days"]
        );
    }
}
