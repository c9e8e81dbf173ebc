//! The views as a table: all that the paper stores of each configuration.

#[cfg(feature = "parquet")]
mod parquet;

#[cfg(feature = "parquet")]
pub use parquet::views_parquet;

use super::plan::{Pose, joint_columns};
use crate::feasibility::View;
use crate::problem::Problem;
use crate::robot::JointKind;

/// Columns of numbers beside the id: joint values (rad or m), camera position (m) and orientation, intersection of the
/// optical axis with the target's plane (m, NaN where there is none), tilt (deg), distance (m); the tip-over margin (m) where
/// stability is tested, and the number of corners seen where not all must be.
struct Table {
    names: Vec<String>,
    ids: Vec<i64>,
    columns: Vec<Vec<f64>>,
}

impl Table {
    fn new(problem: &Problem, views: &[View]) -> Self {
        let joints = &problem.robot.chain.joints;
        let fixed = [
            "camera_x_m",
            "camera_y_m",
            "camera_z_m",
            "camera_qx",
            "camera_qy",
            "camera_qz",
            "camera_qw",
            "target_x_m",
            "target_y_m",
            "target_z_m",
            "tilt_deg",
            "distance_m",
        ];
        let names = joint_columns(joints, JointKind::unit).chain(fixed.map(String::from));
        let margin = problem.stability.as_ref().map(|_| "stability_margin_m".to_owned());
        let corners = problem.visibility.min_corners.map(|_| "corners".to_owned());
        let names: Vec<String> = names.chain(margin).chain(corners).collect();
        let mut columns = vec![Vec::with_capacity(views.len()); names.len()];
        for view in views {
            let pose = Pose::new(&view.X_BC);
            let target = view.target_point().map_or([f64::NAN; 3], |p| p.coords.into());
            let row = view.q.iter().copied().chain(pose.position_m).chain(pose.quaternion_xyzw).chain(target);
            let row = row.chain([view.tilt().to_degrees(), view.distance()]).chain(view.stability_margin);
            let seen = || view.seen.indices(problem.target.board.corner_count()).len() as f64;
            let row = row.chain(problem.visibility.min_corners.map(|_| seen()));
            for (column, number) in columns.iter_mut().zip(row) {
                column.push(number);
            }
        }
        Self { names, ids: views.iter().map(|view| view.id.cast_signed() as i64).collect(), columns }
    }
}

/// The views as CSV, one a line under a header.
///
/// # Errors
/// Never in practice: the writer writes to memory.
pub fn views_csv(problem: &Problem, views: &[View]) -> Result<Vec<u8>, csv::Error> {
    let table = Table::new(problem, views);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(std::iter::once("id").chain(table.names.iter().map(String::as_str)))?;
    for (i, id) in table.ids.iter().enumerate() {
        let numbers = table.columns.iter().map(|column| column[i].to_string());
        writer.write_record(std::iter::once(id.to_string()).chain(numbers))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}
