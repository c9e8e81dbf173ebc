//! Plans the robot poses that calibrate a camera best, and certifies how far from optimal they can be.
//!
//! # The pipeline
//!
//! ```text
//! problem file → models → sweep → feasibility → information → selection → motion → plan
//! ```
//!
//! 1. [`sweep`]: forward kinematics of every joint configuration; which optical axes meet the marker zone.
//! 2. [`feasibility`]: from which of them the camera sees the board, and which the robot can take.
//! 3. [`information`]: what each view would teach about the camera's intrinsics (Fisher information).
//! 4. [`selection`]: the k views that together teach most, and a certificate that bounds every other choice.
//! 5. [`motion`]: the order in which the arm takes them in least time.
//! 6. [`mod@plan`]: the poses, their predicted accuracy, and the files.
//!
//! ```
//! use std::path::Path;
//!
//! use calipose::plan::choose::Chooser;
//! use calipose::plan::survey::survey;
//! use calipose::problem::{Overrides, Problem};
//!
//! let coarse = Overrides::new().set("sweep.step_deg=20")?;
//! let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &coarse)?;
//! let survey = survey(&problem, &|_| {})?;
//! let (choice, certificate) = Chooser::new(&problem, &survey)?.best(10, 0)?;
//! assert_eq!(choice.selected.len(), 10);
//! assert!(certificate.efficiency(choice.log_value) > 0.9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! - **Frames**: B robot base (of a board on a moving link that link's frame), F flange, C camera (x right, y down, z forward, as in
//!   OpenCV), T target (origin at the board's centre, x along its columns, y along its rows, z out of its printed side), L a link, G a
//!   body on it. `X_AB` is the pose of B in A and maps
//!   B's coordinates to A's; adjacent letters cancel: `X_CT = X_BC⁻¹ · X_BT`.
//! - **Units**: metres, radians and pixels inside. Problem files have their units in the keys; they are converted in
//!   `problem` alone.
//! - **Pixels**: (0, 0) is the centre of the top-left pixel.
//! - **Intrinsics** θ: `fx fy cx cy`, then the lens's coefficients in OpenCV's order.
//! - **Tangents**: rotation first, `(ω, v)`; see [`spatial::perturb`].
//! - **Determinism**: the same problem file and seed give the same plan, byte for byte, on any number of threads.
//!
//! # Modules
//!
//! A module imports only from those before it: [`figures`], [`spatial`], [`selection`], [`camera`], [`target`], [`robot`],
//! [`print`](mod@print), [`sweep`], [`feasibility`], [`motion`], [`export`], [`information`], [`continuum`], [`calibration`], [`verification`], [`render`],
//! [`formats`],
//! [`problem`], [`mod@plan`], [`experiment`], [`report`], [`cli`]. The stages up to `verification` know no files and no command line; `selection`
//! knows no robots and no cameras either.
#![allow(
    non_snake_case,
    mixed_script_confusables,
    uncommon_codepoints,
    confusable_idents,
    reason = "mathematics reads like its source: X_CT, M_i, θ"
)]

pub mod calibration;
pub mod camera;
#[cfg(feature = "cli")]
pub mod cli;
pub mod continuum;
pub mod experiment;
pub mod export;
pub mod feasibility;
pub mod figures;
pub mod formats;
pub mod information;
mod lanes;
pub mod motion;
pub mod plan;
pub mod print;
pub mod problem;
pub mod render;
pub mod report;
pub mod robot;
pub mod selection;
pub mod spatial;
pub mod sweep;
pub mod target;
pub mod verification;
