//! Files of users and of other programs: what is read, and how what is wrong is told.

#![allow(
    clippy::excessive_precision,
    clippy::expect_used,
    clippy::unreadable_literal,
    clippy::unwrap_used,
    mixed_script_confusables,
    non_snake_case,
    reason = "tests"
)]

mod board_formats;
mod board_svg;
mod camera_formats;
mod problem_errors;
mod problem_files;
mod robot_files;
