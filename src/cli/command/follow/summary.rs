//! What is shown of a pose to go to, and of a tour at its end.

use std::path::Path;

use crate::cli::command::calibrate::files;
use crate::cli::output::failure::Failure;
use crate::cli::output::joint_table::{Heading, joint_table};
use crate::cli::output::{duration, fixed, short, table, wrapped};
use crate::formats::{CameraFormat, Detections, write_vnl};
use crate::plan::assess::{Follow, Known, Stop};
use crate::plan::document::{CalibrationDocument, EstimatedIntrinsics, ProblemReference, joints_deg};
use crate::robot::{Chain, Joint};

/// The joint values of the turns on the way to a pose and of the pose, in a table.
pub(super) fn values(stop: &Stop, chain: &Chain) -> String {
    let joints: &[Joint] = &chain.joints;
    let row = |what: String, q: &[f64]| -> Vec<String> {
        std::iter::once(what).chain(joints_deg(chain, q).into_iter().map(|value| fixed(value, 2))).collect()
    };
    let turns = stop.way.iter().flat_map(|way| &way.via_rad).enumerate();
    let mut rows: Vec<Vec<String>> = turns.map(|(i, q)| row(format!("turn {}", i + 1), q)).collect();
    rows.push(row(format!("pose {}", stop.place + 1), &stop.pose.joints_rad));
    joint_table(joints, &[Heading { full: "go to", brief: "go to" }], &[], "", &rows)
}

/// What ends the pose, and what else may be answered.
pub(super) fn prompt(source: Option<&str>) -> String {
    match source {
        Some(source) => format!("Its picture is waited for in {source}; or answer skip, back, again, quit."),
        None => "Enter when it is taken; or answer skip, back, again, quit.".into(),
    }
}

/// The camera found and the time taken.
pub(super) fn text(follow: &Follow) -> String {
    let mut text = String::new();
    if let Some(Known { observations, calibration, assessment, .. }) = follow.known() {
        let EstimatedIntrinsics { names, values, sigma } = EstimatedIntrinsics::new(calibration);
        let rows = (0..names.len()).map(|i| vec![names[i].clone(), short(values[i]), short(sigma[i])]);
        text += &format!(
            "\n{}\n\n{}\n",
            table(&["intrinsic", "estimate", "sigma"], &rows.collect::<Vec<_>>()),
            wrapped(&format!("{} pictures. {}", observations.views().len(), assessment.verdict)),
        );
    }
    let took = duration(follow.state().seconds);
    let tour = follow.plan().tour.as_ref();
    let planned = tour.map(|tour| format!("; the plan's tour takes {}", duration(tour.total_s))).unwrap_or_default();
    text + &format!("It took {took}{planned}.")
}

/// Writes the calibration by the pictures to `folder`, as `calibrate` does, and their corners; says so.
pub(super) fn write(follow: &Follow, known: &Known, folder: &Path) -> Result<String, Failure> {
    let Known { observations, calibration, assessment, .. } = known;
    let corners = write_vnl(observations, &follow.names()).into_bytes();
    let detections = Detections { observations: observations.clone(), names: follow.names(), skipped: Vec::new() };
    let problem = Some(ProblemReference::new(follow.problem()));
    let document = CalibrationDocument::new(problem, &detections, calibration, assessment);
    files::write(folder, &document, &calibration.camera, (&CameraFormat::ALL, true), vec![("corners.vnl", corners)])
}
