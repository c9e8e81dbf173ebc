//! `calipose diff`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::report::write_page;
use crate::cli::loaded_plan::read_plan;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, fixed, short, table, wrapped};
use crate::plan::assess::diff;
use crate::plan::document::{ComparedPlan, DiffDocument, LonePose};
use crate::plan::results::PLAN_FILE;
use crate::report::diff_page;

#[derive(Debug, Args)]
pub(crate) struct DiffArguments {
    /// plan.json of a plan, or its folder
    a: PathBuf,
    /// plan.json of another, or its folder
    b: PathBuf,
    /// Page to write of what differs, HTML
    #[arg(long, short, value_name = "FILE.html")]
    output: Option<PathBuf>,
}

pub(crate) fn run(arguments: &DiffArguments, screen: &mut Screen) -> Result<(), Failure> {
    if let Some(output) = &arguments.output
        && !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html"))
    {
        return Err(Failure::Usage(format!("--output is {}; it must end in .html", output.display())));
    }
    let (path_a, path_b) = (plan_file(&arguments.a), plan_file(&arguments.b));
    let (a, b) = (read_plan(&path_a)?, read_plan(&path_b)?);
    let document = diff((&path_a.display().to_string(), &a), (&path_b.display().to_string(), &b))
        .map_err(|error| Failure::PlanFile { path: path_b.clone(), reason: error.to_string() })?;
    if let Some(output) = &arguments.output {
        write_page(output, &diff_page(&document))?;
    }
    screen.document(&document)?;
    let written = arguments.output.iter().map(|output| format!("Written to {}.", output.display()));
    let sections: Vec<String> = text(&document).into_iter().chain(written).collect();
    screen.text(&sections.join("\n\n"))
}

/// The plan's file, where a folder is named.
fn plan_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(PLAN_FILE) } else { path.to_owned() }
}

fn text(diff: &DiffDocument) -> Vec<String> {
    let DiffDocument { a, b, same, moved, only_a, only_b, .. } = diff;
    let mut sections = vec![numbers(a, b)];
    if !diff.same_problem {
        sections.push(wrapped("The plans answer different problems: their values may not compare."));
    } else if !diff.comparable {
        sections.push(wrapped(
            "The plans are chosen by different criteria: their values do not compare; map errors and standard deviations do.",
        ));
    }
    let number = |value: Option<f64>| value.map_or("-".into(), short);
    let rows = diff.sigma.iter().map(|change| {
        let ratio = change.a.zip(change.b).map(|(a, b)| b / a);
        vec![change.name.clone(), number(change.a), number(change.b), number(ratio)]
    });
    sections.push(table(&["sigma", "A", "B", "B / A"], &rows.collect::<Vec<_>>()));
    sections.push(wrapped(&format!(
        "Poses: {} in both, {} moved, {} only in A, {} only in B.",
        same.len(),
        moved.len(),
        only_a.len(),
        only_b.len()
    )));
    if !moved.is_empty() {
        sections.push(format!("Moved, joint values of B less those of A in degrees (mm):\n\n{}", moved_table(diff)));
    }
    for (name, other, poses) in [("A", "B", only_a), ("B", "A", only_b)] {
        if !poses.is_empty() {
            sections.push(format!("Only in {name}, in degrees (mm):\n\n{}", lone_table(&diff.joints, other, poses)));
        }
    }
    sections
}

fn numbers(a: &ComparedPlan, b: &ComparedPlan) -> String {
    let seconds = |seconds: Option<f64>| seconds.map_or("-".into(), |seconds| fixed(seconds, 1));
    let row = |name: &str, of: &dyn Fn(&ComparedPlan) -> String| vec![name.to_owned(), of(a), of(b)];
    let mut rows = vec![
        row("problem", &|plan| plan.problem.name.clone()),
        row("problem file", &|plan| plan.problem.sha256.chars().take(12).collect()),
    ];
    if a.problem.set != b.problem.set {
        rows.push(row("set", &|plan| plan.problem.set.join(", ")));
    }
    rows.extend([
        row("criterion", &|plan| plan.criterion.clone()),
        row("method", &|plan| plan.method.clone()),
        row("poses", &|plan| plan.count.to_string()),
        row("pictures at each", &|plan| plan.pictures.to_string()),
        row("value", &|plan| short(plan.value)),
        row("bound", &|plan| short(plan.bound)),
        row("certified efficiency", &|plan| format!("{:.4}", plan.efficiency)),
        row("map error [px]", &|plan| short(plan.map_error_px)),
        row("moves [s]", &|plan| seconds(plan.moving_s)),
        row("moves and pictures [s]", &|plan| seconds(plan.total_s)),
    ]);
    format!("A is {}, B is {}.\n\n{}", a.file, b.file, table(&["", "A", "B"], &rows))
}

fn moved_table(diff: &DiffDocument) -> String {
    let header = ["A", "B"].into_iter().chain(diff.joints.iter().map(String::as_str)).chain(["distance [rad]"]);
    let rows = diff.moved.iter().map(|pose| {
        let changes = pose.joints_b_deg.iter().zip(&pose.joints_a_deg).map(|(b, a)| fixed(b - a, 2));
        let ids = [pose.id_a, pose.id_b].map(|id| id.to_string());
        ids.into_iter().chain(changes).chain([short(pose.distance_rad)]).collect()
    });
    table(&header.collect::<Vec<_>>(), &rows.collect::<Vec<Vec<String>>>())
}

fn lone_table(joints: &[String], other: &str, poses: &[LonePose]) -> String {
    let nearest = format!("nearest of {other}");
    let header = std::iter::once("pose").chain(joints.iter().map(String::as_str));
    let header = header.chain([nearest.as_str(), "distance [rad]"]);
    let rows = poses.iter().map(|pose| {
        let joints = pose.joints_deg.iter().map(|&q| fixed(q, 1));
        let nearest = [pose.nearest.to_string(), short(pose.distance_rad)];
        std::iter::once(pose.id.to_string()).chain(joints).chain(nearest).collect()
    });
    table(&header.collect::<Vec<_>>(), &rows.collect::<Vec<Vec<String>>>())
}
