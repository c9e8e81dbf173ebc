//! What is asked of a plan once there is one.

mod certify;
mod compare;
mod diff;
mod explain;
mod follow;
mod forecast;
mod locate;
mod next;
mod polish;
mod reach;
mod review;
mod score;
mod verify;

pub use certify::{BrokenConstraint, CertifyError, Confirmed, Unchecked, certify};
pub use compare::{BestOffGrid, Comparison, Equivalent, Row, best_off_grid, compare, equivalent_kmeans, median_choice};
pub use diff::{DiffError, diff};
pub use explain::{ExplainSettings, explain};
pub use follow::{
    Announcement, Answer, Doubt, End, Follow, Input, Known, Mismatch, Refusal, Standing, Stop, UnknownAccuracy,
    UnknownAnswer, Until,
};
pub use forecast::{Forecast, forecast, forecast_bytes};
pub use locate::LocateError;
pub use next::{Proposal, Rehearsal, Request, next};
pub use polish::{Polished, polish};
pub use reach::reach_starts;
pub use review::{KMEANS_RUNS, review};
pub use score::{PoseToScore, PosesToScore, Unusable, score};
pub use verify::{VerifyError, verify};
