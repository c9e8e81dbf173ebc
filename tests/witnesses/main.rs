//! Our numbers against those of other programs.

#![allow(clippy::print_stdout, clippy::unwrap_used, mixed_script_confusables, non_snake_case, reason = "tests")]

mod calibration_against_opencv;
mod projection_against_opencv;
mod urdf_against_pinocchio;
