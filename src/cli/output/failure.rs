//! Why a command failed, and the exit code that says so.

use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

use super::collision::contacts_text;
use super::short;
use crate::calibration::{CalibrationError, ScatterError};
use crate::experiment::{CodesignError, RunError, StoreError};
use crate::export::ExportError;
use crate::formats::{FileReadError, ReadError, ReadFault};
use crate::plan::assess::{CertifyError, VerifyError};
use crate::plan::choose::{ConstraintError, PlanError};
use crate::plan::results::{FileError, RUN_FILE};
use crate::plan::survey::SurveyError;
use crate::print::{Paper, PrintError};
use crate::problem::{DraftError, ProblemError};
use crate::report::Disagreement;
use crate::selection::SelectionError;

/// Views that are named at most.
const MOST_NAMED: usize = 8;

/// Anything a command can fail with.
#[derive(Debug, Error, Diagnostic)]
pub(crate) enum Failure {
    #[error(transparent)]
    #[diagnostic(transparent)]
    Problem(#[from] ProblemError),
    #[error(transparent)]
    #[diagnostic(help("{}", plan_help(.0)))]
    Plan(#[from] PlanError),
    #[error(transparent)]
    #[diagnostic(help("{}", file_help(.0)))]
    File(#[from] FileError),
    #[error("{}: {error}", path.display())]
    #[diagnostic(help("{}", observations_help(error)))]
    Observations { path: PathBuf, error: FileReadError },
    #[error("{}: {error}", path.display())]
    #[diagnostic(help("{}", pose_list_help(error)))]
    PoseList { path: PathBuf, error: FileReadError },
    #[error("cannot use the target {}: {error}", path.display())]
    TargetFile { path: PathBuf, error: FileReadError },
    #[error("{}: {error}", path.display())]
    #[diagnostic(help("{}", calibration_help(error, names, *fits)))]
    Calibration {
        path: PathBuf,
        error: Box<CalibrationError>,
        names: Vec<String>,
        /// Another lens that fits, and the RMS of its residuals in px.
        fits: Option<(&'static str, f64)>,
    },
    #[error("cannot use the plan {}: {reason}", path.display())]
    PlanFile { path: PathBuf, reason: String },
    #[error("cannot use the document {}: {reason}", path.display())]
    Document { path: PathBuf, reason: String },
    #[error("the plan {} and the files beside it are not from one run: {} {} not match {RUN_FILE}", path.display(),
        files.join(", "), if files.len() == 1 { "does" } else { "do" })]
    #[diagnostic(help(
        "a run was ended while it wrote, or a file was changed; make the plan again (or polish it again), or move the plan alone \
         to another folder and name its problem file with --problem"
    ))]
    Mixed { path: PathBuf, files: Vec<String> },
    #[error("{} is the plan of {theirs}, not of {ours}", path.display())]
    #[diagnostic(help(
        "give the problem another `name`, choose another folder with --output, or replace the plan with --force"
    ))]
    OtherPlan { path: PathBuf, theirs: String, ours: String },
    #[error("the plan {} does not hold: {error}", path.display())]
    #[diagnostic(help("it was changed, or made by a faulty program; make a new plan"))]
    Certify { path: PathBuf, error: Box<CertifyError> },
    #[error(transparent)]
    Verify(#[from] VerifyError),
    #[error(
        "no configuration found within the joint limits takes the pose; the nearest is {} mm and {}° off",
        short(position_error * 1e3),
        short(angle_error.to_degrees())
    )]
    #[diagnostic(help("{}", unreached_help(*joints)))]
    Unreached { position_error: f64, angle_error: f64, joints: usize },
    #[error("{}: {error}", path.display())]
    #[diagnostic(help("{}", draft_help(error)))]
    Draft { path: PathBuf, error: DraftError },
    #[error("{} exists already", .0.display())]
    #[diagnostic(help("choose another name, or remove the file first"))]
    Exists(PathBuf),
    #[error(transparent)]
    #[diagnostic(help("{}", print_help(.0)))]
    Print(#[from] PrintError),
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error(transparent)]
    Report(#[from] Disagreement),
    #[error("the run would take {needed} of memory; this machine has {total}")]
    #[diagnostic(help("{remedy}"))]
    Memory { needed: String, total: String, remedy: &'static str },
    #[error(transparent)]
    #[diagnostic(help(
        "give wider ranges or a larger `surface`, or check by `calipose plan --set KEY=VALUE` what stands in the way at one set-up"
    ))]
    Design(#[from] CodesignError),
    #[error("{} is of the design \"{theirs}\"", path.display())]
    #[diagnostic(help("choose another folder with --output, or replace its results with --force"))]
    OtherDesign { path: PathBuf, theirs: String },
    #[error(transparent)]
    #[diagnostic(help("{}", store_help(.0)))]
    Store(#[from] StoreError),
    #[error("{missing} of the study's {cells} cells are not in {}: {named}", folder.display())]
    #[diagnostic(help("{}", incomplete_help(*others)))]
    Incomplete { folder: PathBuf, cells: usize, missing: usize, named: String, others: bool },
    #[error(transparent)]
    #[diagnostic(help(
        "take ten or more pictures of each scene, with neither the camera nor the board touched, and detect the corners in each"
    ))]
    Scatter(#[from] ScatterError),
    #[error(transparent)]
    #[diagnostic(help("{}", run_help(.0)))]
    Run(#[from] RunError),
    #[error("{what} failed:\n{said}")]
    #[diagnostic(help(
        "the other processes were ended; the cells computed so far are kept, and when it is submitted again only those that are \
         missing are computed"
    ))]
    Process { what: String, said: String },
    #[error("the engine {engine} is not here: {missing} is not found")]
    #[diagnostic(help("{}", no_engine_help(engine)))]
    NoEngine { engine: &'static str, missing: String },
    #[error("the engine {engine} refused `{command}`:\n{said}")]
    #[diagnostic(help("{}", engine_help(engine, before)))]
    Engine { engine: &'static str, command: String, said: String, before: String },
    #[error("{0}")]
    Usage(String),
    #[error("cannot write the table: {0}")]
    Table(String),
    #[error("cannot write to stdout")]
    Stdout(#[from] std::io::Error),
}

impl Failure {
    /// Name of what failed, for programs.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Failure::Problem(_) => "problem-file",
            Failure::Memory { .. } => "memory",
            Failure::Draft { .. } => "robot-file",
            Failure::Plan(_) => "no-plan",
            Failure::File(_)
            | Failure::Table(_)
            | Failure::Stdout(_)
            | Failure::Store(StoreError::File(_))
            | Failure::Run(_) => "cannot-write",
            Failure::Observations { .. } | Failure::Scatter(_) => "observations",
            Failure::PoseList { .. } => "pose-list",
            Failure::TargetFile { .. } => "target-file",
            Failure::Calibration { .. } => "no-calibration",
            Failure::PlanFile { .. } => "plan-file",
            Failure::Document { .. } | Failure::Report(_) => "document",
            Failure::Mixed { .. } => "mixed-files",
            Failure::OtherPlan { .. } => "other-plan",
            Failure::Certify { .. } => "certificate",
            Failure::Unreached { .. } => "unreached",
            Failure::Exists(_) => "exists",
            Failure::Print(_) => "page",
            Failure::Export(_) => "export",
            Failure::Usage(_) => "command-line",
            Failure::Design(_) => "no-design",
            Failure::OtherDesign { .. } => "other-design",
            Failure::Store(StoreError::Busy { .. }) => "busy",
            Failure::Store(StoreError::Other { .. }) => "other-study",
            Failure::Incomplete { .. } => "incomplete",
            Failure::Process { .. } => "process",
            Failure::NoEngine { .. } => "no-engine",
            Failure::Engine { .. } => "engine",
            Failure::Verify(_) => "no-verification",
        }
    }

    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            // A file that does not state its board needs the options that do.
            Failure::Usage(_)
            | Failure::Observations {
                error:
                    FileReadError::Content(ReadError {
                        fault: ReadFault::NotStated { .. } | ReadFault::Cameras { .. } | ReadFault::NoImage { .. },
                        ..
                    }),
                ..
            }
            // Another format helps.
            | Failure::Export(_)
            // Another page or margin helps.
            | Failure::Print(
                PrintError::TooSmall { .. }
                | PrintError::NoRoom { .. }
                | PrintError::TooManyPages { .. }
                | PrintError::Margin { .. },
            ) => 2,
            // The nearest configuration was shown.
            Failure::Unreached { .. } => 4,
            Failure::Problem(_)
            | Failure::Draft { .. }
            | Failure::PlanFile { .. }
            | Failure::Document { .. }
            | Failure::Mixed { .. }
            | Failure::TargetFile { .. }
            | Failure::PoseList { .. }
            | Failure::Observations { .. } => 3,
            _ => 1,
        }
    }
}

impl From<SurveyError> for Failure {
    fn from(error: SurveyError) -> Self {
        Failure::Plan(error.into())
    }
}

fn store_help(error: &StoreError) -> String {
    match error {
        StoreError::File(error) => file_help(error),
        StoreError::Busy { .. } => {
            "wait for it, or choose another folder with --output; several machines share a study by `calipose study cell --shard`"
                .into()
        }
        StoreError::Other { .. } => {
            "choose another folder with --output, or replace its tables, figures and page with --force".into()
        }
    }
}

fn incomplete_help(others: bool) -> &'static str {
    if others {
        "`calipose study run` computes those that are missing; cells of the study as it was, or of another version of calipose, do \
         not count"
    } else {
        "`calipose study run` computes those that are missing"
    }
}

fn run_help(error: &RunError) -> String {
    match error {
        RunError::File(error) => {
            format!("{}; the cells computed so far are kept, and the next run goes on from them", file_help(error))
        }
        RunError::Threads(_) => "use fewer with --threads".into(),
    }
}

fn unreached_help(joints: usize) -> String {
    if joints < 6 {
        format!(
            "an arm with {joints} joints takes few poses exactly; the configuration shown is the best approximation found"
        )
    } else {
        "the configuration shown is the best approximation found; request a pose nearer to the arm".into()
    }
}

fn no_engine_help(engine: &str) -> &'static str {
    match engine {
        "slurm" => {
            "submit it on a machine of the cluster that has Slurm's commands; `--dry-run` only writes the job, and `--engine local` \
             runs it here"
        }
        _ => {
            "install it, as by `pip install hyperqueue`, and activate the environment that has it; `--dry-run` only writes the job, and \
             `--engine local` runs it here"
        }
    }
}

fn engine_help(engine: &str, before: &str) -> String {
    match (engine, before) {
        ("slurm", "") => "is this a machine of the cluster? give what the cluster asks for by --option, as in --option=--partition=short".into(),
        ("slurm", before) => format!(
            "job {before}, the cells, was submitted before: end it by `scancel {before}`, or let it go on and merge them by hand"
        ),
        _ => "start a server by `hq server start` and a worker by `hq worker start`; a server in another folder than ~/.hq-server is \
              found by HQ_SERVER_DIR"
            .into(),
    }
}

fn file_help(error: &FileError) -> String {
    let advice = "check that the folder exists, is writable and has space";
    if error.done.is_empty() {
        return format!("{advice}; nothing was overwritten");
    }
    let done: Vec<String> = error.done.iter().map(|path| path.display().to_string()).collect();
    format!(
        "{advice}, and run it again: replaced or removed already, so that the files do not belong together now: {}",
        done.join(", ")
    )
}

fn plan_help(error: &PlanError) -> String {
    let help = match error {
        // They passed every test before this one.
        PlanError::Survey(SurveyError::NoViews { contacts, .. }) if !contacts.is_empty() => {
            return contacts_text(contacts);
        }
        PlanError::Survey(SurveyError::NoCandidates { diagnosis, .. } | SurveyError::NoViews { diagnosis, .. }) => {
            return diagnosis.to_string();
        }
        PlanError::Survey(SurveyError::NothingCertain { .. } | SurveyError::BlindScenario { .. }) => {
            "state smaller deviations in [robust], lower robust.seen_share, or relax the limits of [visibility]"
        }
        PlanError::Survey(SurveyError::PoseUndetermined { .. }) => "use a board with more corners",
        PlanError::TooFewViews { .. } => {
            "ask for fewer poses, sweep with a finer step, or relax the limits of [visibility]"
        }
        PlanError::UnsafeHome { .. } => {
            "give joint values at which the robot stands free; `calipose reach` and the report show where its links are"
        }
        PlanError::NoTime { .. } => {
            "allow more time in selection.time, take a home nearer to the poses, or raise the speeds of [motion] or lower its dwell_s"
        }
        PlanError::NoRoom { .. } => "lower the separations of [constraints], relax its groups, or ask for fewer poses",
        PlanError::Unobservable { count, views, .. } if count == views => {
            "more poses do not help, because there are no other views: sweep with a finer step or relax [visibility] for views that \
             differ more, state what is known in `estimate.prior_sigma`, or take a parameter of the combination out of [estimate]"
        }
        PlanError::Unobservable { .. } | PlanError::HardlyObservable { .. } => {
            "ask for more poses, or take a parameter of the combination out of [estimate]"
        }
        PlanError::Covariance => {
            "the views taken hardly determine one combination of the intrinsics; take more of the plan's poses first"
        }
        PlanError::Constraints(ConstraintError::NotAView { .. }) => {
            "take ids from plan.json or views.csv (`--views csv`), made with the same [sweep] and [visibility]"
        }
        PlanError::Constraints(ConstraintError::KeptOut { .. }) => {
            "take the pose out of `constraints.require`, or narrow the region"
        }
        PlanError::Constraints(ConstraintError::CapturedUnseen { .. }) => {
            "correct the joint values in `constraints.captured`, or leave the view out"
        }
        PlanError::Inaccurate { .. } => {
            "request less accuracy, sweep with a finer step, relax [visibility] or [constraints], or lower the noise"
        }
        PlanError::Selection(
            SelectionError::Allowed { .. }
            | SelectionError::RequiredAndForbidden { .. }
            | SelectionError::RequiredAboveCap { .. }
            | SelectionError::RequiredTooClose { .. },
        ) => "relax [constraints], or ask for another number of poses",
        PlanError::Selection(_) | PlanError::Clustering(_) => "this is probably a bug; please report it",
    };
    help.into()
}

fn print_help(error: &PrintError) -> String {
    match error {
        PrintError::TooSmall { next: Some(Paper { name: Some(name), .. }), .. } => {
            format!("take --page {name}, the next standard size, or spread it over several pages with --tile")
        }
        PrintError::TooSmall { .. } => {
            "spread it over several pages with --tile, or leave --page out for one made to measure".into()
        }
        PrintError::NoRoom { .. } => "take a larger --page, or a smaller --margin-mm".into(),
        PrintError::TooManyPages { .. } => "take a larger --page".into(),
        PrintError::TooLarge { .. } => "spread it over several pages with --tile".into(),
        PrintError::Margin { .. } => "give the border that the printer leaves white".into(),
        PrintError::Board { .. } => "correct `target` in the problem file".into(),
        PrintError::NoPattern => "print it with the program that its points are from".into(),
    }
}

fn draft_help(error: &DraftError) -> &'static str {
    match error {
        DraftError::File(FileReadError::Robot(error)) if !error.is_of_another_file() => "correct the file at that line",
        DraftError::File(_) => "--urdf takes the robot's URDF file; expand a xacro file first",
        DraftError::Still => "all joints of the URDF are fixed; name the file of the whole robot",
    }
}

fn observations_help(error: &FileReadError) -> &'static str {
    let FileReadError::Content(ReadError { fault, .. }) = error else {
        return "give a file of detected corners: mrcal's vnl, or calipose's JSON";
    };
    match fault {
        ReadFault::NotStated { what: "board" } => "give --board 8x6 --square-mm 35, --target FILE or --problem FILE",
        ReadFault::NotStated { .. } => "give --image 1280x720, or --problem FILE",
        ReadFault::CornerCount { .. } => {
            "list every corner of the board, undetected ones as - or null; columns and rows of a checkerboard count its inner corners"
        }
        ReadFault::Cameras { .. } => {
            "choose the images of one camera with --images, as in --images '*cam0*'; '*' takes all"
        }
        ReadFault::NoImage { .. } => "`*` stands for any text and `?` for one character; quote the pattern",
        ReadFault::Mismatch { .. } => "leave the options out, or correct the file",
        _ => "the book's page \"Calibration\" describes both formats",
    }
}

fn pose_list_help(error: &FileReadError) -> &'static str {
    let FileReadError::Content(ReadError { fault, .. }) = error else {
        return "give a list of poses: YAML, CSV, a plan, or a file of detected corners";
    };
    match fault {
        ReadFault::NoPoseList { .. } => {
            "say which it is with --format, or write a table with a column for each joint, as in elbow_deg"
        }
        ReadFault::UnknownJoint { .. } | ReadFault::MissingJoints { .. } => {
            "list a value for every joint of the problem's robot, and for no others, under the names that the problem file has"
        }
        _ => "the book's page \"File formats\" describes lists of poses",
    }
}

fn calibration_help(error: &CalibrationError, names: &[String], fits: Option<(&'static str, f64)>) -> String {
    use CalibrationError as E;
    let named = |views: &[usize]| {
        let known: Vec<String> = views.iter().filter_map(|&view| names.get(view)).map(|n| format!("\"{n}\"")).collect();
        let more = known.len().saturating_sub(MOST_NAMED);
        let end = if more > 0 { format!(" and {more} more") } else { String::new() };
        known[..known.len().min(MOST_NAMED)].join(", ") + &end
    };
    let other = fits.map(|(lens, rms)| {
        format!("the lens {lens} fits these corners, with an RMS of {} px: use `--lens {lens}`", short(rms))
    });
    match error {
        E::FoldedLens { lens, view, .. } => {
            let other = other.map_or(String::new(), |other| format!("{other}; or "));
            let last = if *lens == "rational" { "k3,k6" } else { "k3" };
            format!("{other}estimate fewer coefficients, as in `--fix {last}`; view {view} is {}", named(&[*view]))
        }
        E::SwappedOrder { views, of, columns, rows } if views.len() == *of => format!(
            "give --board {rows}x{columns}, or swap columns and rows where the file of corners or the problem file states the board"
        ),
        E::SwappedOrder { views, of, columns, rows } if 2 * views.len() > *of => {
            let others = match of - views.len() {
                1 => "one other view".to_owned(),
                others => format!("{others} other views"),
            };
            format!("give --board {rows}x{columns}, and swap columns and rows in the {others}")
        }
        E::SwappedOrder { views, columns, .. } => format!(
            "list the corners of {} along the board's rows of {columns} as in the other views, or leave these views out",
            named(views)
        ),
        E::Disordered { views, .. } => {
            format!("look at {}: were their corners found on this board, and are they listed row by row?", named(views))
        }
        E::NoStart { view } => match other {
            Some(other) => other,
            None => format!("view {view} is {}; look at its corners, or leave it out", named(&[*view])),
        },
        E::TooFewViews { .. } | E::TooFewMeasurements { .. } => {
            "take more images of the board, or estimate less, as in `--fix cx,cy` or `--tie fx=fy`".into()
        }
        E::ParallelBoards { .. } => "take images with the board tilted by 20° to 50° in all directions".into(),
        E::Parameters { .. } | E::Tied { .. } | E::Setting { .. } | E::ImageSize { .. } | E::PoseCount { .. } => {
            "check the options".into()
        }
        E::Unobservable { combination } => {
            let held = combination.iter().find(|(name, _)| name.starts_with('k')).map_or("fx=900", |_| "k3=0");
            let other = other.map_or(String::new(), |other| format!("; {other}"));
            format!(
                "add views, tilted differently and all over the image, or estimate less, as in `--fix {held}`{other}"
            )
        }
        E::UnobservablePose | E::Camera(_) => other.unwrap_or_else(|| {
            "add views, tilted differently and all over the image, or choose a lens model with fewer parameters".into()
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_is_sent_for_poses_that_do_not_exist() {
        let open = |count| PlanError::Unobservable { count, views: 21, combination: vec![("fx".into(), 1.0)] };
        assert!(open(21).to_string().starts_with("all 21 views together cannot determine all intrinsics"));
        assert!(plan_help(&open(21)).contains("more poses do not help"));
        assert!(plan_help(&open(20)).contains("ask for more poses"));
    }
}
