//! `calipose score`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::by_name;
use crate::cli::known::{known_by, read_detections};
use crate::cli::long_work::sweeping;
use crate::cli::output::failure::Failure;
use crate::cli::output::joint_table::{Heading, joint_table};
use crate::cli::output::verdict::Verdict;
use crate::cli::output::{Screen, fixed, grouped, short, table, wrapped};
use crate::figures::trimmed;
use crate::formats::{FileReadError, PoseListFormat, read_poses, read_text_file};
use crate::plan::assess::{PosesToScore, score};
use crate::plan::document::{BestOfAsMany, ScoreDocument, ScoredPose, ScoredSet, ScoredSwap, lists_poses};
use crate::problem::{Overrides, Problem};
use crate::robot::Joint;

#[derive(Debug, Args)]
pub(crate) struct ScoreArguments {
    /// List of poses (YAML or CSV of other tools, or a plan), or file of corners detected in pictures taken already
    file: PathBuf,
    /// Problem file that says what the poses are for
    #[arg(long)]
    problem: PathBuf,
    /// Format of the list [default: what its content is]
    #[arg(long, value_name = "FORMAT", value_parser = by_name(&PoseListFormat::ALL, PoseListFormat::name))]
    format: Option<PoseListFormat>,
    /// Of detected corners use only images whose names match, with `*` for any text, as in '*cam0*'
    #[arg(long, value_name = "PATTERN")]
    images: Option<String>,
    /// Replace the value of a key of the problem file, by its path, as in `camera.fx_px=900`; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

pub(crate) fn run(arguments: &ScoreArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    let problem = arguments.problem()?;
    let (format, list, passed) = arguments.poses(&problem)?;
    let document = sweeping(screen, &problem, |observe| score(&problem, format.name(), &list, passed, observe))?;
    screen.document(&document)?;
    screen.text(&text(&problem, &arguments.file, &document).join("\n\n"))?;
    // Poses that leave something open calibrate nothing.
    Ok(Verdict::good_if(document.set.as_ref().is_some_and(|set| set.map_error_px.is_some())))
}

impl ScoreArguments {
    fn problem(&self) -> Result<Problem, Failure> {
        let overrides = self.set.iter().try_fold(Overrides::new(), |overrides, text| overrides.set(text));
        let overrides = overrides.map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(Problem::read_with(&self.problem, &overrides)?)
    }

    /// The format of the list, its poses, and how many places it only passes.
    fn poses(&self, problem: &Problem) -> Result<(PoseListFormat, PosesToScore, usize), Failure> {
        let path = &self.file;
        let refused = |error: FileReadError| Failure::PoseList { path: path.clone(), error };
        let text = read_text_file(path).map_err(refused)?;
        let told = || PoseListFormat::of(&text).map_err(|error| refused(error.into()));
        let format = self.format.map_or_else(told, Ok)?;
        if format == PoseListFormat::Detections {
            let detections = read_detections(path, &known_by(problem, self.images.clone()))?;
            return Ok((format, PosesToScore::detected(problem, &detections), 0));
        }
        if self.images.is_some() {
            return Err(Failure::Usage(format!(
                "--images is for detections; {} is read as {}",
                path.display(),
                format.name()
            )));
        }
        if format == PoseListFormat::Plan {
            lists_poses(&text).map_err(|error| Failure::PlanFile { path: path.clone(), reason: error.to_string() })?;
        }
        let poses = read_poses(&text, format, &problem.robot.chain.joints).map_err(|error| refused(error.into()))?;
        Ok((format, PosesToScore::listed(problem, &poses), poses.passed))
    }
}

fn text(problem: &Problem, file: &Path, score: &ScoreDocument) -> Vec<String> {
    let joints = &problem.robot.chain.joints;
    let mut sections = vec![wrapped(&counted(file, score))];
    let unusable: Vec<&ScoredPose> = score.poses.iter().filter(|pose| pose.reason.is_some()).collect();
    if !unusable.is_empty() {
        let said = unusable.iter().map(|pose| wrapped(&unusable_text(pose)));
        sections.push(format!("Not usable:\n\n{}", said.collect::<Vec<_>>().join("\n")));
    }
    let Some(set) = &score.set else { return sections };
    sections.push(wrapped(&worth(score, set)));
    if let Some(best) = &score.best {
        sections.push(wrapped(&held_against_best(score, best)));
    }
    if let Some(reason) = &score.no_best {
        let best =
            if score.count == 1 { "pose to hold it".to_owned() } else { format!("{} poses to hold them", score.count) };
        sections.push(wrapped(&format!("No best {best} against: {reason}.")));
    }
    sections.extend(excluded(score).map(|text| wrapped(&text)));
    if !set.sigma.is_empty() {
        sections.push(sigma_table(set, score.best.as_ref()));
    }
    sections.push(format!("What is lost without each pose:\n\n{}", pose_table(joints, score)));
    sections.push(wrapped(&redundant(score, set)));
    if !score.swaps.is_empty() {
        let swaps = swap_table(joints, &score.swaps);
        sections.push(format!("{}\n\n{swaps}", wrapped("The swaps of one pose that gain most:")));
    }
    if score.exchange.len() > 1 {
        let exchange = swap_table(joints, &score.exchange);
        let gains = wrapped("Swaps one after the other, with what is gained up to each:");
        sections.push(format!("{gains}\n\n{exchange}"));
    }
    if score.swaps.is_empty() && score.best.is_some() {
        sections.push("No swap of one pose gains anything.".into());
    }
    sections
}

fn counted(file: &Path, score: &ScoreDocument) -> String {
    let ScoreDocument { listed, count, passed, read_as, .. } = score;
    let usable = match (count, listed) {
        (0, _) => "none of which can be used".to_owned(),
        (count, listed) if count == listed => "all of which can be used".to_owned(),
        (1, _) => "1 of which can be used".to_owned(),
        (count, _) => format!("{count} of which can be used"),
    };
    let passed = match passed {
        0 => String::new(),
        1 => " 1 place without a stop or a picture is passed.".to_owned(),
        passed => format!(" {passed} places without a stop or a picture are passed."),
    };
    let name = &score.problem.name;
    format!("{name}: {} read as {read_as}, {}, {usable}.{passed}", file.display(), poses(*listed))
}

fn poses(count: usize) -> String {
    if count == 1 { "1 pose".to_owned() } else { format!("{} poses", grouped(count)) }
}

fn unusable_text(pose: &ScoredPose) -> String {
    let reason = pose.reason.as_deref().unwrap_or_default().replace('_', " ");
    format!("- {}: {reason}: {}", pose.name, pose.why.as_deref().unwrap_or_default())
}

fn worth(score: &ScoreDocument, set: &ScoredSet) -> String {
    let those = if score.count == 1 { "This pose".to_owned() } else { format!("These {} poses", score.count) };
    let pictures = match score.pictures {
        1 => String::new(),
        pictures => format!(", with {pictures} pictures at each"),
    };
    let Some(map_error) = set.map_error_px else {
        let combination: Vec<String> = set
            .undetermined
            .iter()
            .filter(|term| term.coefficient.abs() > 0.1)
            .map(|term| format!("{} {}", fixed(term.coefficient, 2), term.name))
            .collect();
        let (leave, open) =
            (if score.count == 1 { "leaves" } else { "leave" }, combination.join(" + ").replace("+ -", "- "));
        return format!("{those}{pictures} {leave} a combination of the intrinsics open: {open}.");
    };
    let value = set.value.map_or("-".into(), short);
    format!(
        "{those}{pictures}: criterion `{}`: value {value}, predicted map error {} px RMS over the image.",
        score.criterion,
        short(map_error)
    )
}

fn held_against_best(score: &ScoreDocument, best: &BestOfAsMany) -> String {
    let ScoreDocument { count, efficiency, equal_best_count, .. } = score;
    let number = |number: Option<f64>| number.map_or("-".into(), short);
    let found = format!(
        "The best {count} found have a map error of {} px (value {}, bound {}).",
        number(best.map_error_px),
        number(best.value),
        number(best.bound)
    );
    let views = grouped(best.views);
    let proven = match efficiency {
        Some(efficiency) if *efficiency > 1.0 + 1e-9 => format!(
            "Certified efficiency {efficiency:.4}: the poses are worth more than any {count} of the {views} views that the certificate is \
             over; some of them lie between these views, or are not allowed together."
        ),
        Some(efficiency) => format!(
            "Certified efficiency {efficiency:.4}: at least this share of the most information that any {count} of {views} views can \
             give, those of the list among them as far as a plan could have them."
        ),
        None => String::new(),
    };
    let equal = match equal_best_count {
        Some(equal) if equal < count => format!(" They are worth {equal} of the best poses."),
        _ => String::new(),
    };
    format!("{found} {proven}{equal}")
}

/// Which usable poses no plan could have.
fn excluded(score: &ScoreDocument) -> Option<String> {
    let why = |name: &str| match name {
        "axis" => "optical axis misses the target's zone",
        "limit_margin" => "nearer to a joint limit than `robot.limit_margin_deg`",
        "keep_out" => "in a region of `constraints.keep_out`",
        "uncertain" => "a view in too few of the set-ups of `robust`",
        "repeated" => "listed before",
        _ => "",
    };
    let named = score.poses.iter().filter_map(|pose| {
        let why = why(pose.excluded.as_deref()?);
        (!why.is_empty()).then(|| format!("{} ({why})", pose.name))
    });
    let named: Vec<String> = named.collect();
    (!named.is_empty()).then(|| format!("Usable, but no plan of this problem would have them: {}.", named.join(", ")))
}

fn sigma_table(set: &ScoredSet, best: Option<&BestOfAsMany>) -> String {
    let of_best = |name: &str| {
        let sigma = best?.sigma.iter().find(|(other, _)| other == name)?;
        Some(sigma.1)
    };
    let rows = set
        .sigma
        .iter()
        .map(|(name, sigma)| vec![name.clone(), short(*sigma), of_best(name).map_or("-".into(), short)]);
    table(&["intrinsic", "sigma", "of the best"], &rows.collect::<Vec<_>>())
}

const POSE: Heading = Heading { full: "pose", brief: "pose" };
const ERROR: Heading = Heading { full: "map error [px]", brief: "error" };

fn pose_table(joints: &[Joint], score: &ScoreDocument) -> String {
    let usable = score.poses.iter().filter(|pose| pose.reason.is_none());
    let row = |pose: &ScoredPose| {
        let loss = pose.loss.map_or("-".into(), |loss| fixed(100.0 * loss, 1));
        let error = pose.map_error_without_px.map_or("-".into(), short);
        let mark = if pose.redundant { "redundant" } else { "" };
        let values = pose.joints_deg.iter().flatten().map(|&q| fixed(q, 1));
        std::iter::once(pose.name.clone()).chain(values).chain([loss, error, mark.into()]).collect::<Vec<String>>()
    };
    let rows: Vec<Vec<String>> = usable.map(row).collect();
    let loss = Heading { full: "loss [%]", brief: "loss" };
    let mark = Heading { full: "", brief: "" };
    // Of pictures the joint values are not known.
    let shown = if score.poses.iter().any(|pose| pose.joints_deg.is_some()) { joints } else { &[] };
    joint_table(shown, &[POSE], &[loss, ERROR, mark], "Loss in % of the information, map error in px.", &rows)
}

fn redundant(score: &ScoreDocument, set: &ScoredSet) -> String {
    let redundant = score.poses.iter().filter(|pose| pose.redundant).count();
    let least = trimmed(100.0 * set.redundant_below, 2);
    match (redundant, set.map_error_without_redundant_px) {
        (0, _) => format!("None is redundant: without any of them, {least} % of the information or more is lost."),
        (1, Some(map_error)) => format!(
            "1 is redundant: without it less than {least} % of the information is lost, and the map error is {} px.",
            short(map_error)
        ),
        (redundant, map_error) => format!(
            "{redundant} are redundant, each alone: less than {least} % of the information is lost without it. Without all of them the map \
             error is {}.",
            map_error.map_or("not determined".into(), |map_error| format!("{} px", short(map_error)))
        ),
    }
}

fn swap_table(joints: &[Joint], swaps: &[ScoredSwap]) -> String {
    let row = |swap: &ScoredSwap| {
        let values = swap.joints_deg.iter().map(|&q| fixed(q, 1));
        let gain = swap.gain.map_or("-".into(), |gain| fixed(100.0 * gain, 1));
        let error = swap.map_error_px.map_or("-".into(), short);
        std::iter::once(swap.out.clone()).chain(values).chain([gain, error]).collect::<Vec<String>>()
    };
    let rows: Vec<Vec<String>> = swaps.iter().map(row).collect();
    let out = Heading { full: "out, for", brief: "out, for" };
    let gain = Heading { full: "gain [%]", brief: "gain" };
    joint_table(joints, &[out], &[gain, ERROR], "Gain in % of the information, map error in px.", &rows)
}
