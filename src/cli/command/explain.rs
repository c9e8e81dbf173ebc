//! `calipose explain`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::number_of;
use crate::cli::output::failure::Failure;
use crate::cli::output::joint_table::{Heading, joint_table};
use crate::cli::output::{Screen, fixed, short, table, wrapped};
use crate::figures::grouped;
use crate::plan::assess::{ExplainSettings, explain};
use crate::plan::document::{CombinationTerm, Explanation, PoseExplanation, RobustnessPrice, TrialDocument};
use crate::problem::Problem;

#[derive(Debug, Args)]
pub(crate) struct ExplainArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one named in run.json beside the plan]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Greatest number of poses on the curve [default: twice the plan's number]
    #[arg(long, value_parser = number_of(false))]
    most: Option<usize>,
    /// Number of spares for each pose
    #[arg(long, default_value_t = 3, value_parser = number_of(true))]
    spares: usize,
}

/// Most poses on the curve; each costs a selection and a bound.
const MOST_POSES: usize = 1000;

/// Most spares of a pose.
const MOST_SPARES: usize = 1000;

pub(crate) fn run(arguments: &ExplainArguments, screen: &mut Screen) -> Result<(), Failure> {
    if arguments.most.is_some_and(|most| most > MOST_POSES) {
        return Err(Failure::Usage(format!("--most must be from 1 to {MOST_POSES}")));
    }
    if arguments.spares > MOST_SPARES {
        return Err(Failure::Usage(format!("--spares must be from 0 to {MOST_SPARES}")));
    }
    let loaded = LoadedPlan::read(&arguments.plan, arguments.problem.as_deref())?;
    let survey = loaded.survey(&arguments.plan, screen)?;
    let (chooser, selected) = loaded.locate(&arguments.plan, &survey)?;
    let most = arguments.most.unwrap_or(2 * selected.len()).min(survey.views.len());
    let settings = ExplainSettings { most, spares: arguments.spares };
    let bar = screen.progress("explaining", most);
    let explained = explain(&loaded.problem, &chooser, &selected, &settings, &|points| bar.inc(points as u64));
    bar.finish_and_clear();
    let explanation = explained?;
    screen.document(&explanation)?;
    screen.text(&text(&loaded.problem, &explanation))
}

fn text(problem: &Problem, explanation: &Explanation) -> String {
    let mut sections = vec![
        wrapped(&format!(
            "{}: {} poses, criterion `{}`: value {}, map error {} px.",
            explanation.problem.name,
            explanation.count,
            explanation.criterion,
            short(explanation.value),
            or_dash(explanation.map_error_px),
        )),
        format!(
            "{}\n\n{}",
            wrapped("What other numbers of poses would give, by the best sets found; no set can exceed the bound:"),
            curve_table(explanation)
        ),
        format!("What each pose contributes, and what is lost without it:\n\n{}", pose_table(&explanation.poses)),
    ];
    let open = explanation.poses.iter().filter(|pose| !pose.leaves_open.is_empty());
    let open = open.map(|pose| {
        wrapped(&format!("Without pose {} this combination is undetermined: {}.", pose.id, words(&pose.leaves_open)))
    });
    sections.push(open.collect::<Vec<_>>().join("\n"));
    if explanation.poses.iter().any(|pose| !pose.spares.is_empty()) {
        sections.push(format!("What could take each pose's place:\n\n{}", spare_table(problem, &explanation.poses)));
    }
    let least = &explanation.least_known;
    let size = match (least.sigma, least.moves_image_px) {
        (Some(sigma), Some(moves)) => format!(
            "Its standard deviation is {} such units; a change by this much moves the image by {} px.",
            short(sigma),
            short(moves)
        ),
        _ => "The plan leaves it undetermined.".into(),
    };
    sections.push(wrapped(&format!(
        "The least known combination is {}, in units that each alone move the image by 1 px. {size}",
        words(&least.combination),
    )));
    if let Some(price) = &explanation.robust {
        sections.push(format!(
            "{}\n\n{}",
            wrapped(&format!(
                "Where the set-up is not quite as stated, in {} set-ups drawn anew, beside the best plan of as many poses for the set-up \
                 as stated:",
                grouped(price.plan.set_ups)
            )),
            price_table(explanation.map_error_px, price)
        ));
    }
    sections.retain(|section| !section.is_empty());
    sections.join("\n\n")
}

fn curve_table(explanation: &Explanation) -> String {
    let row = |point: &crate::plan::document::CurvePoint| {
        let mark = if point.count == explanation.count { "plan" } else { "" };
        vec![
            point.count.to_string(),
            or_dash(point.value),
            or_dash(point.bound),
            point.efficiency.map_or("-".into(), |efficiency| format!("{efficiency:.4}")),
            or_dash(point.map_error_px),
            mark.into(),
        ]
    };
    let rows: Vec<Vec<String>> = explanation.curve.iter().map(row).collect();
    table(&["poses", "value", "bound", "efficiency", "map error [px]", ""], &rows)
}

fn pose_table(poses: &[PoseExplanation]) -> String {
    let row = |pose: &PoseExplanation| {
        let suffers = pose.suffers_most.as_ref();
        vec![
            pose.id.to_string(),
            percent(pose.loss),
            or_dash(pose.map_error_px),
            suffers.map_or("-".into(), |suffers| suffers.name.clone()),
            suffers.map_or("-".into(), |suffers| short(suffers.sigma)),
            suffers.map_or("-".into(), |suffers| short(suffers.sigma_without)),
        ]
    };
    let rows: Vec<Vec<String>> = poses.iter().map(row).collect();
    table(&["pose", "loss [%]", "map error [px]", "most affected", "sigma", "without it"], &rows)
}

/// Map errors of a robust plan and of one that is not.
fn price_table(map_error_px: Option<f64>, price: &RobustnessPrice) -> String {
    let row = |name: &str, map_error: Option<f64>, trial: &TrialDocument| {
        let TrialDocument { set_ups: _, seen, median_map_error_px, map_error_of_99_percent_px, worst_map_error_px } =
            trial;
        let least = seen.iter().copied().fold(1.0, f64::min);
        let map_errors = [map_error, *median_map_error_px, *map_error_of_99_percent_px, *worst_map_error_px];
        std::iter::once(name.into()).chain(map_errors.map(or_dash)).chain([percent(least)]).collect::<Vec<_>>()
    };
    let rows =
        [row("this", map_error_px, &price.plan), row("best as stated", price.map_error_as_stated_px, &price.as_stated)];
    let header = ["plan", "map error [px]", "in half of them", "in 99 %", "at worst", "pose is a view in [%]"];
    table(&header, &rows)
}

fn spare_table(problem: &Problem, poses: &[PoseExplanation]) -> String {
    let mut rows = Vec::new();
    for pose in poses {
        for (place, spare) in pose.spares.iter().enumerate() {
            let of = if place == 0 { pose.id.to_string() } else { String::new() };
            let joints = spare.joints_deg.iter().map(|q| fixed(*q, 1));
            let row = [of, spare.id.to_string()].into_iter().chain(joints);
            rows.push(row.chain([percent(spare.loss), or_dash(spare.map_error_px)]).collect());
        }
    }
    let same = |heading| Heading { full: heading, brief: heading };
    let after = [Heading { full: "loss [%]", brief: "loss" }, Heading { full: "map error [px]", brief: "error" }];
    let legend = "Loss in % of the information, map error in px.";
    joint_table(&problem.robot.chain.joints, &["pose", "spare"].map(same), &after, legend, &rows)
}

/// The terms of weight in words, the largest first: `0.93 cx - 0.35 p2`.
fn words(combination: &[CombinationTerm]) -> String {
    const LEAST: f64 = 0.1;
    let largest = combination.iter().map(|term| term.coefficient.abs()).fold(0.0, f64::max);
    let mut terms: Vec<_> = combination.iter().filter(|term| term.coefficient.abs() >= LEAST * largest).collect();
    terms.sort_by(|a, b| b.coefficient.abs().total_cmp(&a.coefficient.abs()));
    let mut text = String::new();
    for (i, CombinationTerm { name, coefficient }) in terms.into_iter().enumerate() {
        text += match (i, *coefficient < 0.0) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        text += &format!("{:.2} {name}", coefficient.abs());
    }
    text
}

fn percent(share: f64) -> String {
    format!("{:.2}", 100.0 * share)
}

fn or_dash(number: Option<f64>) -> String {
    number.map_or("-".into(), short)
}
