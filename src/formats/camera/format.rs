//! What a camera format has to say of itself: how a camera is written in it, and how its files are told and read.

use thiserror::Error;

use super::stated::StatedCamera;
use crate::camera::Camera;
use crate::formats::error::ReadError;
use crate::formats::tree::Node;

/// A format that cameras are written in.
pub(super) struct Export {
    /// Name on the command line.
    pub(super) name: &'static str,
    /// Usual name of a file.
    pub(super) file_name: &'static str,
    /// The camera in this format, all digits kept.
    pub(super) write: fn(&Camera) -> Result<String, WriteError>,
}

/// A format that cameras are read from.
pub(super) struct Import {
    /// What its files are called, in the plural.
    pub(super) files: &'static str,
    /// Whether a file is of this format, if it is of none before.
    pub(super) recognises: fn(&Node) -> bool,
    /// The camera of such a file.
    pub(super) read: fn(&Node, &StatedCamera) -> Result<Camera, ReadError>,
}

/// Why a camera cannot be written in a format.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum WriteError {
    /// The format has no such lens model.
    #[error("the format \"{format}\" has no lens model \"{lens}\"")]
    Lens {
        /// Name of the format.
        format: &'static str,
        /// Name of the lens model.
        lens: &'static str,
    },
    /// The format has no place for the value of an intrinsic.
    #[error("the format \"{format}\" cannot hold {name} = {value}")]
    Intrinsic {
        /// Name of the format.
        format: &'static str,
        /// The intrinsic.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}
