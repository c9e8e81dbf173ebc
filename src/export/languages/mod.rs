//! Programs of robots' controllers: ASCII, joint-interpolated moves, exact stops.

mod axes;
mod fanuc_ls;
mod krl;
mod rapid;
mod urscript;

pub(super) use fanuc_ls::FANUC_LS;
pub(super) use krl::KRL;
pub(super) use rapid::RAPID;
pub(super) use urscript::URSCRIPT;

use super::program::{Leg, Program};
use super::text::{header, plain};

/// Longest label shown to the operator.
const LABEL: usize = 40;

/// The sentences at the beginning of a program, as controllers show them.
fn beginning(program: &Program, notes: &[String]) -> Vec<String> {
    let jerk = program.limits_jerk().then_some("Limits of jerk are NOT in this file: the controller has its own.");
    header(program, notes).iter().map(String::as_str).chain(jerk).map(plain).collect()
}

/// What the operator reads when the robot sets out: "pose 7 (2 of 12)".
fn announcement(program: &Program, leg: &Leg) -> String {
    let label: String = plain(leg.label).chars().take(LABEL).collect();
    match leg.visit {
        Some(visit) => format!("{label} ({visit} of {})", program.visits().count()),
        None => label,
    }
}

/// The share of the speeds in whole percent, rounded down, 1 at least.
fn percent(program: &Program) -> u32 {
    ((100.0 * program.share + 1e-9).floor() as u32).max(1)
}
