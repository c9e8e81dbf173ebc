//! The command line: commands, exit codes, what is printed where.
//!
//! Results go to stdout, progress and errors to stderr. Exit codes: 0 done; 1 the command failed; 2 the command line was
//! wrong; 3 the problem file, plan or file of observations was refused; 4 done, but the result is bad; 70 a bug in calipose;
//! 130, 143, 129 interrupted by Ctrl-C, a termination or a hang-up.

mod arguments;
mod command;
mod interrupt;
mod known;
mod loaded_plan;
mod long_work;
mod memory;
mod output;
mod own_files;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};

use arguments::ProblemArguments;
use command::{
    board, calibrate, certify, check, compare, completions, design, diff, explain, export, figures, follow, init, next,
    noise, plan, polish, reach, render, report, score, study, sweep, verify,
};
use output::Screen;
use output::failure::Failure;
use output::verdict::Verdict;

/// Plans the best robot poses for calibrating a camera, with a certificate of how far from optimal they can be
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done, 1 failed, 2 wrong command line, 3 input file refused, 4 done but the result is bad, 70 bug, \
                  130 interrupted (143 terminated, 129 hung up)."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    output: OutputArguments,
}

impl Arguments {
    /// The command line that describes them. A negative number after an option is its value.
    fn commands() -> clap::Command {
        let numbers = |argument: clap::Arg| {
            let is_value = argument.get_action().takes_values() && !argument.is_positional();
            if is_value { argument.allow_negative_numbers(true) } else { argument }
        };
        Self::command().mut_subcommands(|command| command.mut_args(numbers))
    }

    /// Those of the process; ends it with what is wrong with them, or with the help asked for.
    fn typed() -> Result<Self, clap::Error> {
        Self::from_arg_matches(&Self::commands().try_get_matches()?)
    }
}

#[derive(Debug, Clone, Copy, Args)]
struct OutputArguments {
    /// Print only errors (and, with --json, the document)
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Print one JSON document on stdout instead of text
    #[arg(long, global = true)]
    json: bool,
    /// Number of threads to work on [default: one for each core]
    #[arg(long, value_name = "N", global = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Make a plan: sweep, select, certify, write
    Plan(plan::PlanArguments),
    /// Compare every selection method at several numbers of poses
    Compare(compare::CompareArguments),
    /// Judge a list of poses, or of pictures taken, against what the problem could have had
    Score(score::ScoreArguments),
    /// Show what differs between two plans
    Diff(diff::DiffArguments),
    /// Calibrate a camera from detected corners
    Calibrate(calibrate::CalibrateArguments),
    /// Explain a plan: what more poses would bring, what each pose contributes, what could replace it
    Explain(explain::ExplainArguments),
    /// Move a plan's poses off the grid, to better joint values nearby
    Polish(polish::PolishArguments),
    /// Show a plan, simulated calibrations, a comparison or a calibration on a page
    Report(report::ReportArguments),
    /// Draw the plots of a plan, each as a file fit for a paper
    Figures(figures::FiguresArguments),
    /// Write a plan's poses, in their order, as files that robots' programs read, as a recording, or its robot as a model
    Export(export::ExportArguments),
    /// Measure how far corners scatter, from repeated pictures of still scenes
    Noise(noise::NoiseArguments),
    /// Render the picture that each pose of a plan should give
    Render(render::RenderArguments),
    /// Count configurations, candidates and views, at one or several steps
    Sweep(sweep::SweepArguments),
    /// Simulate calibrations from a plan's poses and compare them with the prediction
    Verify(verify::VerifyArguments),
    /// Recompute every field of a plan from its poses, its matrix and the problem file
    Certify(certify::CertifyArguments),
    /// Re-estimate the camera from the views taken so far and propose the next best poses
    Next(next::NextArguments),
    /// Carry a plan out pose by pose, and end as soon as the pictures reach the accuracy
    Follow(follow::FollowArguments),
    /// Find joint values that bring the camera to a requested pose
    Reach(reach::ReachArguments),
    /// Run experiments that are stated in a file
    #[command(subcommand)]
    Study(study::StudyCommand),
    /// Find the best set-up: the board's place and size, the camera's turn, or whatever else is free
    Design(design::DesignArguments),
    /// Draw the calibration target at true scale, as PDF and SVG
    Board(board::BoardArguments),
    /// Validate a problem file and say what a run would do
    Check(ProblemArguments),
    /// Write a commented starter problem file, or one drafted from a robot's URDF
    Init {
        /// Where to write it [default: problem.toml, or the URDF's name with .toml]
        file: Option<PathBuf>,
        /// URDF of the robot, from which the file is filled in, with guesses to check
        #[arg(long, value_name = "URDF")]
        urdf: Option<PathBuf>,
    },
    /// Print the JSON Schema of problem, study or design files, for editors, or of a document that the program writes
    Schema {
        /// What to describe: a kind of file that users write, or of document
        #[arg(long = "for", value_name = "KIND", default_value = init::PROBLEM, value_parser = schema_name())]
        kind: String,
    },
    /// Print a completion script for a shell
    Completions {
        /// Shell to complete commands and options in
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write one for each command
    Man {
        /// Folder for the pages of all commands [default: print the page of calipose itself]
        folder: Option<PathBuf>,
    },
}

/// Parses one of `all` by its name.
fn by_name<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl clap::builder::TypedValueParser<Value = T> {
    use clap::builder::TypedValueParser;
    clap::builder::PossibleValuesParser::new(all.iter().map(|&value| name(value)))
        .try_map(move |text| all.iter().copied().find(|&value| name(value) == text).ok_or("unknown name"))
}

/// Parser of the names that schemas have.
fn schema_name() -> impl clap::builder::TypedValueParser<Value = String> {
    clap::builder::PossibleValuesParser::new(init::schema_names())
}

/// File format of the candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TableFormat {
    Csv,
    #[cfg(feature = "parquet")]
    Parquet,
}

/// Runs the program with the process's arguments.
pub fn main() -> ExitCode {
    interrupt::handle();
    // Known before the command line is, which may be wrong.
    let json = std::env::args_os().any(|argument| argument == "--json");
    std::panic::set_hook(Box::new(move |panic| {
        Screen::report_bug(&panic.to_string(), json);
    }));
    match std::panic::catch_unwind(|| {
        let arguments = match Arguments::typed() {
            Ok(arguments) => arguments,
            Err(error) if json && error.use_stderr() => {
                Screen::refuse(&error);
                return ExitCode::from(2);
            }
            Err(error) => error.exit(),
        };
        if let Some(threads) = arguments.output.threads {
            // The only call, before any work: it cannot have been made before.
            drop(rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global());
        }
        let mut screen = Screen::new(arguments.output.quiet, arguments.output.json);
        match run(&arguments.command, &mut screen) {
            Ok(verdict) => verdict.exit_code(),
            Err(failure) => {
                screen.fail(&failure);
                ExitCode::from(failure.exit_code())
            }
        }
    }) {
        Ok(code) => code,
        Err(_) => ExitCode::from(70),
    }
}

fn run(command: &Command, screen: &mut Screen) -> Result<Verdict, Failure> {
    // What these do is done or fails; there is nothing to judge.
    let good = |()| Verdict::Good;
    match command {
        Command::Plan(arguments) => plan::run(arguments, screen),
        Command::Compare(arguments) => compare::run(arguments, screen).map(good),
        Command::Score(arguments) => score::run(arguments, screen),
        Command::Diff(arguments) => diff::run(arguments, screen).map(good),
        Command::Calibrate(arguments) => calibrate::run(arguments, screen),
        Command::Explain(arguments) => explain::run(arguments, screen).map(good),
        Command::Polish(arguments) => polish::run(arguments, screen).map(good),
        Command::Report(arguments) => report::run(arguments, screen).map(good),
        Command::Figures(arguments) => figures::run(arguments, screen).map(good),
        Command::Export(arguments) => export::run(arguments, screen).map(good),
        Command::Render(arguments) => render::run(arguments, screen).map(good),
        Command::Noise(arguments) => noise::run(arguments, screen).map(good),
        Command::Sweep(arguments) => sweep::run(arguments, screen).map(good),
        Command::Verify(arguments) => verify::run(arguments, screen),
        Command::Certify(arguments) => certify::run(arguments, screen).map(good),
        Command::Next(arguments) => next::run(arguments, screen),
        Command::Follow(arguments) => follow::run(arguments, screen),
        Command::Reach(arguments) => reach::run(arguments, screen).map(good),
        Command::Study(command) => study::run(command, screen).map(good),
        Command::Design(arguments) => design::run(arguments, screen).map(good),
        Command::Board(arguments) => board::run(arguments, screen).map(good),
        Command::Check(arguments) => check::run(arguments, screen).map(good),
        Command::Init { file, urdf } => init::run(file.as_deref(), urdf.as_deref(), screen).map(good),
        Command::Schema { kind } => init::schema(kind).map(good),
        Command::Completions { shell } => completions::completions(*shell).map(good),
        Command::Man { folder } => completions::manual(folder.as_deref(), screen).map(good),
    }
}

/// Parser of a whole number from 1, or from 0 where `none` may be asked for.
fn number_of(none: bool) -> impl Fn(&str) -> Result<usize, String> + Clone + Send + Sync {
    move |text| {
        let number = text.replace(['_', ' '], "").parse().ok().filter(|&number| none || number > 0);
        number.ok_or_else(|| format!("must be a whole number, at least {}", u8::from(!none)))
    }
}

/// Parser of `--trials`: none, or enough for a standard deviation and few enough for memory. A million tell it to 0.1 %.
fn trials() -> impl clap::builder::TypedValueParser<Value = usize> {
    use clap::builder::TypedValueParser;
    clap::value_parser!(u64).range(0..=1_000_000).try_map(|trials| {
        if trials == 1 { Err("one trial has no scatter; give 0 or at least 2") } else { Ok(trials as usize) }
    })
}
