//! Plans ten poses for an arm that is described by a URDF file, without a problem file: `cargo run --release --example
//! plan_from_rust`.
#![allow(clippy::print_stdout, reason = "an example talks")]

use std::ops::ControlFlow;

use calipose::camera::{Camera, Lens};
use calipose::information::Criterion;
use calipose::plan::choose::{Chooser, decide};
use calipose::plan::survey::survey;
use calipose::problem::Problem;
use calipose::spatial::Pose;
use calipose::target::Board;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Problem::builder("arm on a rover")
        .urdf("problems/urdf/six-axis-rover.urdf", "camera_optical_frame")
        .camera(&Camera::new(Lens::Pinhole, 1280, 960, &[950.0, 950.0, 639.5, 479.5])?)
        .board(Board::checkerboard(9, 6, 0.03), Pose::translation(-0.22, 0.0, 0.12))
        .board_link("chassis")
        .sample(200_000)
        .best(10, &[(Criterion::V, 1.0)])
        .build()?;
    let survey = survey(&problem, &|_| {})?;
    let decision = decide(&Chooser::new(&problem, &survey)?, &mut |_| ControlFlow::Continue(()))?;
    for &view in &decision.choice.selected {
        println!("{:.3?}", survey.views[view].q);
    }
    let efficiency = 100.0 * decision.certificate.efficiency(decision.choice.log_value);
    println!("map error {:.3} px, at least {efficiency:.1} % of the best possible", decision.choice.map_error);
    Ok(())
}
