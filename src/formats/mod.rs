//! The files of other tools: detected corners and poses in, cameras in and out.
//!
//! | file | module | read | written |
//! |---|---|---|---|
//! | mrcal's corners, vnl | `detections::vnl` | yes | yes |
//! | calipose's own observations, JSON | `detections::observations` | yes | |
//! | Kalibr's targets, YAML | `board::kalibr` | yes | |
//! | OpenCV's ChArUco boards, JSON | `board::opencv` | yes | |
//! | tables of points, CSV | `board::points` | yes | |
//! | ROS `camera_info`, YAML | `camera::ros` | yes | yes |
//! | OpenCV `FileStorage`, YAML and JSON | `camera::opencv` | yes | yes |
//! | the same, XML | `camera::opencv_xml` | yes | |
//! | mrcal's cameramodel | `camera::mrcal` | yes | yes |
//! | Kalibr's camchain, YAML | `camera::kalibr` | yes | yes |
//! | poses of `robot_calibration`, `MoveIt` Calibration, `JointTrajectory`, `easy_handeye2`, YAML | `pose_list` | yes | |
//! | the same, CSV | `pose_list::table` | yes | |
//! | robots, URDF and SRDF | `urdf` | yes | |
//! | meshes, STL, OBJ and COLLADA | `mesh` | yes | |
//!
//! Each is a function from text to models or back. YAML holds JSON and, but for byte strings, the Python literals of mrcal: one
//! parser reads them all and remembers the lines for [`ReadError`].

mod board;
mod camera;
mod detections;
mod disk;
mod error;
mod file;
mod image_size;
mod mesh;
mod number;
mod pose_list;
mod tree;
mod urdf;
mod xml;

pub use board::{StatedBoard, read_board, read_points};
pub use camera::{CameraFormat, StatedCamera, WriteError, read_camera};
pub use detections::{DetectedImage, Detections, Known, read_detections, read_images, write_vnl};
pub use disk::DiskError;
pub(crate) use disk::read_at_most;
pub use error::{ReadError, ReadFault};
pub use file::{
    FileReadError, outline_urdf_file, read_board_file, read_camera_file, read_detections_file, read_images_file,
    read_srdf_file, read_text_file, read_urdf_file,
};
pub use mesh::{MeshError, read_mesh};
pub use pose_list::{ListedPose, PoseList, PoseListFormat, StatedPlace, read_poses};
pub use urdf::{
    Description, Outline, StatedRange, UrdfError, UrdfFault, UrdfNote, UrdfRemark, outline_urdf, read_srdf, read_urdf,
};
