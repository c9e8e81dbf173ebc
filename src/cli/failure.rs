//! Why a command failed, and the exit code that says so.

use miette::Diagnostic;
use thiserror::Error;

use crate::plan::{FileError, PlanError, SurveyError, VerifyError};
use crate::problem::ProblemError;

/// Anything a command can fail with.
#[derive(Debug, Error, Diagnostic)]
pub(super) enum Failure {
    #[error(transparent)]
    #[diagnostic(transparent)]
    Problem(#[from] ProblemError),
    #[error(transparent)]
    #[diagnostic(help("{}", plan_help(.0)))]
    Plan(#[from] PlanError),
    #[error(transparent)]
    #[diagnostic(help("check that the folder exists, is writable and has room; nothing was overwritten"))]
    File(#[from] FileError),
    #[error("cannot use the plan {}: {reason}", path.display())]
    PlanFile { path: std::path::PathBuf, reason: String },
    #[error(transparent)]
    Verify(#[from] VerifyError),
    #[error("{} exists already", .0.display())]
    #[diagnostic(help("give another name, or remove the file first"))]
    Exists(std::path::PathBuf),
    #[error("{0}")]
    Usage(String),
    #[error("cannot write the candidates: {0}")]
    Table(String),
    #[error("cannot write to stdout: {0}")]
    Stdout(#[from] std::io::Error),
}

impl Failure {
    pub(super) fn exit_code(&self) -> u8 {
        match self {
            Failure::Problem(_) | Failure::PlanFile { .. } => 3,
            Failure::Usage(_) => 2,
            _ => 1,
        }
    }
}

impl From<SurveyError> for Failure {
    fn from(error: SurveyError) -> Self {
        Failure::Plan(error.into())
    }
}

fn plan_help(error: &PlanError) -> &'static str {
    match error {
        PlanError::Survey(SurveyError::NoCandidates { .. }) => {
            "check the target's pose and zone and the camera's mount, or sweep with a finer step; `axis = \"any\"` drops \
             the axis test"
        }
        PlanError::Survey(SurveyError::NoViews { .. }) => {
            "the reasons above tell which limit of [visibility] to loosen; a smaller board is seen whole from nearer"
        }
        PlanError::Survey(SurveyError::PoseUndetermined { .. }) => "use a board with more corners",
        PlanError::TooFewViews { .. } => {
            "ask for fewer poses, sweep with a finer step, or loosen the limits of [visibility]"
        }
        PlanError::Unobservable { .. } => {
            "ask for more poses, or take a parameter of the combination out of [estimate]"
        }
        PlanError::Selection(_) | PlanError::Clustering(_) => "this is probably a bug; please report it",
    }
}
