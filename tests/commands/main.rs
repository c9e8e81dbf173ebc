//! The program, tried as its users try it.

#![allow(clippy::unwrap_used, non_snake_case, reason = "tests")]

mod board;
mod calibrate_command;
mod command_line;
mod design;
mod desk;
mod determinism;
mod diff;
mod documents;
mod explain_and_polish;
mod export;
mod follow;
mod next_poses;
mod noise;
mod off_grid;
mod overrides;
mod reach;
mod render;
mod report;
mod result_files;
mod score;
mod selection_commands;
mod studies;
