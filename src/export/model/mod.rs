//! The robot with its camera and its board as files of models, which simulators and viewers read.
//!
//! ```text
//! Setup → Assembly (links and joints with names of their own, camera and board among them) → URDF, MJCF, SDF
//!       → Assets (hulls and the board's plate as OBJ, its picture as PNG), which they name
//! ```
//!
//! All three have the same links. Joint frames, axes, solids and masses are the problem's with all their digits; what a format wants and no
//! problem knows (inertias, efforts) stands in the file's comments.

mod assembly;
mod assets;
mod element;
mod format;
mod mjcf;
mod note;
mod placement;
mod sdf;
mod setup;
mod urdf;

#[cfg(test)]
pub(super) mod example;

pub(super) use assembly::{Assembly, ModelLink, Movement};
pub use format::ModelFormat;
pub use setup::Setup;
pub(super) use urdf::description;
