//! Plans the robot poses that calibrate a camera best, and certifies how far from optimal they can be.
#![allow(non_snake_case, confusable_idents, mixed_script_confusables, uncommon_codepoints)]
#![allow(non_ascii_idents)]

pub mod calibration;
pub mod camera;
pub mod robot;
pub mod spatial;
pub mod target;
pub mod verification;
