//! `calipose compare`.

use clap::Args;

use crate::cli::arguments::{ProblemArguments, SelectionArguments};
use crate::cli::long_work::sweeping;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, short, table};
use crate::cli::{number_of, trials};
use crate::plan::assess::{BestOffGrid, Equivalent, Row, best_off_grid, compare, equivalent_kmeans, verify};
use crate::plan::choose::{Choice, Chooser, refined_survey};
use crate::plan::survey::Survey;
use crate::problem::{Method, Problem};
use crate::verification::{Disturbance, MonteCarlo, Weighing};

/// Number of poses where none is asked for.
const COUNT: usize = 10;

#[derive(Debug, Args)]
pub(crate) struct CompareArguments {
    #[command(flatten)]
    problem: ProblemArguments,
    #[command(flatten)]
    selection: SelectionArguments,
    /// Numbers of poses to compare [default: the file's number, 1.5 times and twice as many]
    #[arg(long, short = 'k', value_delimiter = ',', value_parser = number_of(false), allow_hyphen_values = true)]
    counts: Vec<usize>,
    /// Number of seeds for the methods that depend on one; medians are shown
    #[arg(long, default_value_t = 5, value_parser = number_of(false))]
    seeds: usize,
    /// Number of simulated calibrations per row for the measured columns; 0 for none
    #[arg(long, default_value_t = 50, value_parser = trials())]
    trials: usize,
    /// Maximum number of poses when looking for the k-means that equals the plan
    #[arg(long, default_value_t = 400, value_parser = number_of(false))]
    limit: usize,
}

pub(crate) fn run(arguments: &CompareArguments, screen: &mut Screen) -> Result<(), Failure> {
    if arguments.seeds > 1000 {
        return Err(Failure::Usage("--seeds must be from 1 to 1000".into()));
    }
    let options = arguments.selection.options();
    let stated = arguments.problem.problem(&options)?;
    // All methods are compared on the sweep's views, which the baselines never leave.
    let on_grid = ("selection.off_grid", Some("false".to_owned()));
    let problem = arguments.problem.problem(&[&options[..], &[on_grid]].concat())?;
    let survey = sweeping(screen, &problem, |observe| refined_survey(&problem, observe))?;

    let k = problem.selection.goal.count().unwrap_or(COUNT);
    let counts = if arguments.counts.is_empty() {
        let mut counts = vec![k, k + k.div_ceil(2), 2 * k];
        counts.retain(|&count| count == k || count <= survey.views.len());
        counts
    } else {
        arguments.counts.clone()
    };
    // A number of poses is compared by criteria; accuracies would set it.
    let chooser = Chooser::new(&problem, &survey)?.by(&problem.selection.goal.criteria())?;
    // The exact search may take minutes, and chooses what `best` does or a little better.
    let methods: Vec<Method> = Method::ALL.into_iter().filter(|&method| method != Method::Exact).collect();
    let bar = screen.progress("comparing", methods.len() * counts.len());
    let compared = compare(&chooser, &methods, &counts, problem.selection.seed, arguments.seeds, &mut || bar.inc(1));
    bar.finish_and_clear();
    let mut comparison = compared?;

    let bar = screen.progress("k-means", 2 * counts.len());
    let plan = |&count: &usize| {
        let best = comparison.rows.iter().find(|row| row.method == Method::Best && row.choice.selected.len() == count);
        (count, best.map_or(f64::INFINITY, |row| row.choice.map_error))
    };
    let plans: Vec<(usize, f64)> = counts.iter().map(plan).collect();
    let equivalent = |method: Method| {
        let (limit, seed, seeds) = (arguments.limit, problem.selection.seed, arguments.seeds);
        equivalent_kmeans(&chooser, method, &plans, limit, seed, seeds, &mut || bar.inc(1))
    };
    let (joints, positions) = (equivalent(Method::KMeansJoints)?, equivalent(Method::KMeansPositions)?);
    let of_each = counts.iter().zip(joints.into_iter().zip(positions));
    let equivalents: Vec<(usize, Equivalent)> =
        of_each.flat_map(|(&count, (joints, positions))| [(count, joints), (count, positions)]).collect();
    bar.finish_and_clear();

    let bar = screen.progress("measuring", comparison.rows.len());
    let mut measured: Vec<Option<MonteCarlo>> = comparison
        .rows
        .iter()
        .map(|row| {
            bar.inc(1);
            measure(&problem, &survey, &row.choice, arguments.trials)
        })
        .collect();
    bar.finish_and_clear();
    if stated.selection.leaves_grid() {
        let swept = refined_survey(&stated, &|_| {})?;
        for &count in counts.iter().filter(|&&count| count <= swept.views.len()) {
            // What is possible on the grid may not be at a distance from limits and from each other.
            let Ok(BestOffGrid { survey, row }) = best_off_grid(&stated, &swept, count) else { continue };
            measured.push(measure(&stated, &survey, &row.choice, arguments.trials));
            comparison.rows.push(row);
        }
    }

    screen.document(&comparison.document(&problem, &chooser, &measured, &equivalents))?;
    let rows = comparison.rows.iter().zip(&measured);
    let rows: Vec<Vec<String>> =
        rows.map(|(row, measured)| text_row(&problem, &chooser, row, measured.as_ref())).collect();
    let focal: Vec<String> = principal(&problem).into_iter().map(|(_, name)| format!("sigma {name}")).collect();
    let header: Vec<&str> = ["method", "poses", "value", "map error [px]", "measured", "failed"]
        .into_iter()
        .chain(focal.iter().map(String::as_str))
        .chain(["efficiency", "time [ms]"])
        .collect();
    let sentences: Vec<String> = equivalents.iter().map(|(count, equivalent)| sentence(*count, equivalent)).collect();
    screen.text(&format!(
        "{}: criterion `{}`, {} views; medians over {} seeds; measured in {} simulated calibrations.\n\n{}\n\n{}",
        problem.name,
        chooser.criterion(),
        survey.views.len(),
        comparison.seeds,
        arguments.trials,
        table(&header, &rows),
        sentences.join("\n"),
    ))
}

/// Those of fx, fy, cx and cy that are estimated: place in the choice's list, and name.
fn principal(problem: &Problem) -> Vec<(usize, &'static str)> {
    problem.unknowns().names().into_iter().enumerate().filter(|(i, _)| problem.estimated[*i] < 4).collect()
}

/// Simulated calibrations of a choice; `None` if none were asked for or nothing is predicted for it.
fn measure(problem: &Problem, survey: &Survey, choice: &Choice, trials: usize) -> Option<MonteCarlo> {
    if trials == 0 {
        return None;
    }
    let configurations: Vec<Vec<f64>> = choice.selected.iter().map(|&i| survey.views[i].q.clone()).collect();
    verify(
        problem,
        &configurations,
        &Disturbance::default(),
        Weighing::default(),
        trials,
        problem.selection.seed,
        &|_| {},
    )
    .ok()
}

fn text_row(problem: &Problem, chooser: &Chooser, row: &Row, measured: Option<&MonteCarlo>) -> Vec<String> {
    let sigma = |i: usize| row.choice.sigma.get(i).map_or("-".into(), |&s| short(s));
    [row.name(), row.choice.selected.len().to_string()]
        .into_iter()
        .chain([short(chooser.natural(row.choice.log_value)), short(row.choice.map_error)])
        .chain([
            measured.map_or("-".into(), |found| short(found.map_error.measured)),
            measured.map_or("-".into(), |found| found.failures.len().to_string()),
        ])
        .chain(principal(problem).into_iter().map(|(i, _)| sigma(i)))
        .chain([format!("{:.4}", row.efficiency), format!("{:.1}", row.time.as_secs_f64() * 1e3)])
        .collect()
}

fn sentence(count: usize, equivalent: &Equivalent) -> String {
    let feature = if equivalent.method == Method::KMeansJoints { "joints" } else { "camera positions" };
    match equivalent.poses {
        Some(poses) => format!("k-means on {feature} needs {poses} poses to match this plan with {count}."),
        None => format!(
            "k-means on {feature} does not match this plan with {count} poses, even with {} poses.",
            equivalent.tried
        ),
    }
}
