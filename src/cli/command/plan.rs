//! `calipose plan`.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::report::{REPORT_FILE, Reported};
use super::verify::verdict;
use crate::cli::arguments::{ProblemArguments, SelectionArguments, method};
use crate::cli::interrupt::writing;
use crate::cli::long_work::{bounding, searching, sweeping};
use crate::cli::memory::hold_against_memory;
use crate::cli::output::collision::{close_text, tested_text};
use crate::cli::output::failure::Failure;
use crate::cli::output::pose_table::pose_table;
use crate::cli::output::verdict::Verdict;
use crate::cli::output::{Screen, grouped, short, table, wrapped};
use crate::cli::{TableFormat, trials};
use crate::plan::assess::{KMEANS_RUNS, median_choice, verify};
use crate::plan::choose::{Chooser, decide, home_is_safe, plan_survey};
use crate::plan::document::{
    Document, Plan, RobustnessDocument, Run, RunSeconds, TrialDocument, Verification, WorstLoss, views_csv,
};
use crate::plan::results::{PLAN_FILE, RUN_FILE, add_results, owner, probe, write_results};
use crate::plan::survey::Survey;
use crate::problem::{Method, Problem};
use crate::report::{on_the_way, outcome, plan_page};
use crate::verification::{Disturbance, Judgement, MonteCarlo, Weighing};

#[derive(Debug, Args)]
pub(crate) struct PlanArguments {
    #[command(flatten)]
    problem: ProblemArguments,
    #[command(flatten)]
    selection: SelectionArguments,
    /// Number of poses [default: the file's]
    #[arg(long, short = 'k')]
    count: Option<String>,
    /// How to choose the poses [default: the file's]
    #[arg(long, value_parser = method())]
    method: Option<String>,
    /// Folder for the plan [default: the file's]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Replace the plan of another problem file
    #[arg(long)]
    force: bool,
    /// Number of simulated calibrations that check the plan; 0 for none
    #[arg(long, default_value_t = 100, value_parser = trials())]
    trials: usize,
    /// Also write all views that the poses were chosen from
    #[arg(long, value_name = "FORMAT")]
    views: Option<TableFormat>,
}

pub(crate) fn run(arguments: &PlanArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    let start = Instant::now();
    let problem = arguments.problem()?;
    // What would stop the writing is found before the work.
    arguments.may_write(&problem)?;

    home_is_safe(&problem)?;
    hold_against_memory(&problem, screen)?;
    let survey = sweeping(screen, &problem, |observe| plan_survey(&problem, observe))?;
    let survey_time = start.elapsed();

    let chooser = Chooser::new(&problem, &survey)?;
    let decision = searching(screen, &problem, |observe| decide(&chooser, observe))?;
    let bound =
        bounding(screen, &problem, |observe| chooser.continuum(&decision.choice, &decision.certificate, observe))?;
    let plan = Plan::new(&chooser, &decision)?;
    let plan = match &bound {
        Some(bound) => plan.within_continuum(&chooser, &decision, bound),
        None => plan,
    };

    // The plan is safe before its simulated calibrations, which may take long, are looked at.
    let seconds = RunSeconds {
        survey: survey_time.as_secs_f64(),
        selection: start.elapsed().saturating_sub(survey_time).as_secs_f64(),
        total: start.elapsed().as_secs_f64(),
    };
    let mut run = Run::new(&problem, &arguments.problem.file, seconds);
    let files = arguments.files(&problem, &survey, &plan)?;
    let mut written: Vec<&str> = files.iter().rev().map(|(name, _)| *name).collect();
    let mut removed = writing(|| write_results(&problem.output, &mut run, &files))?;

    let bar = screen.progress("verifying", arguments.trials);
    let verified = verified(&problem, &plan, arguments.trials, &|_| bar.inc(1));
    bar.finish_and_clear();
    let verified = verified?;
    let verification = verified
        .as_ref()
        .map(|found| Verification::new(&plan, found, &Judgement::new(found), Weighing::default(), plan.seed));
    // Without trials those of the same plan, if they are still there.
    let known = verification.clone().or_else(|| Verification::read(&problem.output, &plan));
    let reported = Reported::new(&plan, &chooser, &decision.choice.selected, known)?;
    let report = plan_page(&reported.documents(&plan)?);
    let checked = verification.iter().map(|found| ("verification.json", found.to_json().into_bytes()));
    let files: Vec<(&str, Vec<u8>)> = checked.chain([(REPORT_FILE, report.into_bytes())]).collect();
    run.seconds.total = start.elapsed().as_secs_f64();
    let path = problem.output.join(PLAN_FILE);
    writing(|| add_results(&path, plan.to_json().as_bytes(), Some(&run), &files))?;
    written.extend(files.iter().map(|(name, _)| *name));
    removed.retain(|name| !written.contains(name));

    screen.document(&plan)?;
    let verdict = verified.as_ref().map_or(Verdict::Good, |found| verdict(&Judgement::new(found)));
    if screen.shows_text() {
        let removed = if removed.is_empty() {
            String::new()
        } else {
            format!("\nRemoved, because made from the previous plan: {}.", removed.join(", "))
        };
        let written = format!(
            "Written to {}: {}, {RUN_FILE}, in {:.2} s.{removed}",
            problem.output.display(),
            written.join(", "),
            start.elapsed().as_secs_f64(),
        );
        screen.text(&format!(
            "{}\n\n{}\n{}\n\n{}",
            wrapped(&headline(&plan, verified.as_ref())),
            summary(&problem, &survey, &chooser, &plan, &reported, verified.as_ref())?,
            collision(&problem, &survey, &plan),
            wrapped(&written),
        ))?;
    }
    Ok(verdict)
}

impl PlanArguments {
    /// The file's problem with what the command line says instead.
    fn problem(&self) -> Result<Problem, Failure> {
        let own = [("selection.count", self.count.clone()), ("selection.method", self.method.clone())];
        let mut problem = self.problem.problem(&[self.selection.options(), own].concat())?;
        if let Some(output) = &self.output {
            problem.output.clone_from(output);
        }
        Ok(problem)
    }

    /// That the plan can be written, and replaces none of another problem.
    fn may_write(&self, problem: &Problem) -> Result<(), Failure> {
        let file = &self.problem.file;
        match owner(&problem.output, problem, file) {
            Some(theirs) if !self.force => Err(Failure::OtherPlan {
                path: problem.output.join(PLAN_FILE),
                theirs,
                ours: format!("{} (\"{}\")", file.display(), problem.name),
            }),
            _ => Ok(probe(&problem.output)?),
        }
    }

    /// The files to write, the plan last.
    fn files(&self, problem: &Problem, survey: &Survey, plan: &Plan) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
        let table = match self.views {
            Some(TableFormat::Csv) => Some(("views.csv", views_csv(problem, &survey.views).map_err(in_memory)?)),
            #[cfg(feature = "parquet")]
            Some(TableFormat::Parquet) => {
                let table = crate::plan::document::views_parquet(problem, &survey.views).map_err(in_memory)?;
                Some(("views.parquet", table))
            }
            None => None,
        };
        let poses = plan.to_csv(&problem.robot.chain.joints).map_err(in_memory)?;
        Ok(table.into_iter().chain([("plan.csv", poses), (PLAN_FILE, plan.to_json().into_bytes())]).collect())
    }
}

/// The plan's simulated calibrations, unless none were asked for.
fn verified(
    problem: &Problem,
    plan: &Plan,
    trials: usize,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<Option<MonteCarlo>, Failure> {
    if trials == 0 {
        return Ok(None);
    }
    let configurations: Vec<Vec<f64>> = plan.poses.iter().map(|pose| pose.joints_rad.clone()).collect();
    Ok(Some(verify(
        problem,
        &configurations,
        &Disturbance::default(),
        Weighing::default(),
        trials,
        plan.seed,
        observe,
    )?))
}

/// What the plan is worth, and whether it does what it predicts.
fn headline(plan: &Plan, verified: Option<&MonteCarlo>) -> String {
    let judged = match verified {
        Some(found) => Judgement::new(found).to_string(),
        None => "Verdict: none, because no calibration was simulated.".into(),
    };
    format!(
        "{}: {} poses, predicted map error {} px RMS over the image.\n{judged}",
        plan.problem.name,
        plan.count,
        short(plan.map_error_px)
    )
}

/// What the poses were tested against, in lines of their own.
fn collision(problem: &Problem, survey: &Survey, plan: &Plan) -> String {
    let tested = plan.collision.as_ref().map(|document| tested_text(problem, document));
    let close = Some(close_text(problem, &survey.links)).filter(|text| !text.is_empty());
    tested.into_iter().chain(close).map(|line| wrapped(&line)).collect::<Vec<_>>().join("\n")
}

/// What the trials showed, in one line.
fn sentence(found: &MonteCarlo) -> String {
    let failed = if found.failures.is_empty() {
        "all converged".to_owned()
    } else {
        format!("{} of them failed", found.failures.len())
    };
    format!(
        "{} simulated calibrations, {failed}: map error {} px measured.",
        found.count,
        short(found.map_error.measured)
    )
}

fn in_memory(error: impl std::fmt::Display) -> Failure {
    Failure::Table(error.to_string())
}

fn summary(
    problem: &Problem,
    survey: &Survey,
    chooser: &Chooser,
    plan: &Plan,
    reported: &Reported,
    verified: Option<&MonteCarlo>,
) -> Result<String, Failure> {
    let counts = &plan.survey;
    let mut found = format!(
        "{} configurations swept, {} axes in the zone ({} of them on its edge), {} {}.",
        grouped(counts.swept),
        grouped(counts.axis_inside + counts.axis_edge),
        grouped(counts.axis_edge),
        grouped(counts.views),
        what_views_do(problem),
    );
    if counts.refined > 0 {
        found += &format!(
            " These include views among {} more configurations, tried around picked poses.",
            grouped(counts.refined)
        );
    }
    let rejected: Vec<String> = counts
        .rejected
        .iter()
        .filter(|&(_, &count)| count > 0)
        .map(|(reason, &count)| format!("{} {}", reason.replace('_', " "), grouped(count)))
        .collect();
    if !rejected.is_empty() {
        found += &format!("\nCandidates rejected, by reason: {}.", rejected.join(", "));
    }

    let intrinsics = &plan.intrinsics;
    let rows: Vec<Vec<String>> = (0..intrinsics.names.len())
        .map(|i| vec![intrinsics.names[i].clone(), short(intrinsics.nominal[i]), short(intrinsics.sigma[i])])
        .collect();

    let swept = survey.views.len() - survey.off_grid;
    let compared = if plan.count > swept {
        String::new()
    } else {
        let on_joints = reported.of_kmeans_on_joints().unwrap_or(f64::INFINITY);
        let (on_positions, _) = median_choice(chooser, Method::KMeansPositions, plan.count, plan.seed, KMEANS_RUNS)?;
        format!(
            "{} k-means poses of {} views: map error {} px (clustered on joints), {} px (on camera positions{}).",
            plan.count,
            grouped(swept),
            short(on_joints),
            short(on_positions.map_error),
            if problem.constraints.allow_all() { "" } else { "; constraints aside" },
        )
    };
    let toured = plan.tour.as_ref().map(|tour| format!("{}\n", on_the_way(tour))).unwrap_or_default();
    let tried = verified.map(|found| format!("{}\n", sentence(found))).unwrap_or_default();
    let unweighted = plan.unweighted.as_ref().map(|unweighted| {
        let map_error = short(unweighted.map_error_px);
        let flat = if problem.target.warp.is_some() { " that takes the board for flat" } else { "" };
        format!("A calibration without weights{flat}, such as OpenCV's: map error {map_error} px predicted.\n")
    });
    let unweighted = unweighted.unwrap_or_default();
    let what = if plan.pictures == 1 { "a picture is" } else { "all pictures of a pose are" };
    let lost = plan.worst_loss.as_ref().map(|WorstLoss { id, map_error_px }| match map_error_px {
        Some(map_error) => {
            format!("If {what} lost: map error {} px at worst, without pose {id}.\n", short(*map_error))
        }
        None => format!("No picture may be lost: without pose {id} an intrinsic is undetermined.\n"),
    });
    let lost = lost.unwrap_or_default();
    let withstood = plan.robust.as_ref().map(withstood).unwrap_or_default();
    let repeated = match plan.pictures {
        1 => String::new(),
        pictures => format!("Predicted with {pictures} pictures taken at each pose.\n"),
    };
    Ok(format!(
        "{}\n\n{}\n\n{}\n\n{}\n\n{}",
        wrapped(&outcome(plan)),
        pose_table(problem, &plan.in_order()),
        table(&["intrinsic", "nominal", "predicted sigma"], &rows),
        wrapped(&format!("{toured}{repeated}{tried}{unweighted}{lost}{withstood}{compared}")),
        wrapped(&found),
    ))
}

/// What becomes of the poses where the set-up is not quite as stated.
fn withstood(robust: &RobustnessDocument) -> String {
    let TrialDocument { set_ups, seen, median_map_error_px, map_error_of_99_percent_px, worst_map_error_px } =
        &robust.trial;
    let least = seen.iter().copied().fold(1.0, f64::min);
    let or_none = |map_error: &Option<f64>| map_error.map_or("none".into(), |px| format!("{} px", short(px)));
    format!(
        "In {} other set-ups, drawn from what is stated of their deviations: each pose is a view in {} % or more; map error at most {} in \
         half of them, {} in 99 %, {} at worst.\n",
        grouped(*set_ups),
        short(100.0 * least),
        or_none(median_map_error_px),
        or_none(map_error_of_99_percent_px),
        or_none(worst_map_error_px),
    )
}

/// What the configurations do that are views.
pub(crate) fn what_views_do(problem: &Problem) -> &'static str {
    let tested = problem.stability.is_some() || problem.robot.has_bodies();
    match (problem.visibility.min_corners, tested) {
        (None, false) => "see the whole board",
        (None, true) => "can be taken and see the whole board",
        (Some(_), false) => "see enough of the board",
        (Some(_), true) => "can be taken and see enough of the board",
    }
}
