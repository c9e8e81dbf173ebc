//! The files of other tools: detected corners in, cameras in and out.
//!
//! | file | module | read | written |
//! |---|---|---|---|
//! | mrcal's corners, vnl | `vnl` | yes | |
//! | calipose's own observations, JSON | `observations` | yes | |
//! | ROS `camera_info`, YAML | `ros` | yes | yes |
//! | OpenCV `FileStorage`, YAML and JSON | `opencv` | yes | yes |
//! | mrcal's cameramodel | `mrcal` | yes | yes |
//!
//! Each is a function from text to models or back. YAML holds JSON and, but for byte strings, the Python literals of mrcal: one
//! parser reads them all and remembers the lines for [`ReadError`].

mod camera;
mod detections;
mod error;
mod file;
mod matrix;
mod mrcal;
mod number;
mod observations;
mod opencv;
mod ros;
mod tree;
mod vnl;

pub use camera::{CameraFormat, WriteError, read_camera};
pub use detections::{Detections, Stated, read_detections};
pub use error::{ReadError, ReadFault};
pub use file::{FileReadError, read_camera_file, read_detections_file};
