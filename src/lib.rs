//! Plans the robot poses that calibrate a camera best, and certifies how far from optimal they can be.
#![allow(non_snake_case, mixed_script_confusables, uncommon_codepoints, confusable_idents)]

pub mod calibration;
pub mod camera;
pub mod cli;
pub mod feasibility;
pub mod information;
pub mod plan;
pub mod problem;
pub mod robot;
pub mod selection;
pub mod spatial;
pub mod sweep;
pub mod target;
pub mod verification;
