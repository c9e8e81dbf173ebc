//! Plans: which views there are, which are chosen, and what is proven of them.

#![allow(clippy::print_stdout, clippy::result_large_err, clippy::unwrap_used, non_snake_case, reason = "tests")]

mod baseline;
mod certificate;
mod collision;
#[allow(dead_code, reason = "the part that is used here")]
#[path = "../commands/desk.rs"]
mod desk;
mod feasible_poses;
mod noise;
mod off_grid;
mod pictures;
mod robust;
mod sweep_table_iii;
mod tampered_plans;
mod timed;
mod timeline;
mod tour;
mod warp;
