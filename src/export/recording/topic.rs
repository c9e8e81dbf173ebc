//! The topics of a recording: names, types and what a subscriber may expect.

/// A topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Topic {
    /// Values of the arm's joints.
    JointStates,
    /// Links that move.
    Transforms,
    /// Links that do not.
    StaticTransforms,
    /// The camera's intrinsics, at every picture.
    CameraInfo,
    /// The robot as URDF.
    RobotDescription,
    /// What the robot comes to: a pose by its name, a turn, home.
    Stops,
}

/// The definition of a type, and those that it is made of by their names.
struct Definition {
    own: &'static str,
    parts: &'static [(&'static str, &'static str)],
}

const TIME: (&str, &str) = ("builtin_interfaces/Time", include_str!("definitions/time.msg"));
const HEADER: (&str, &str) = ("std_msgs/Header", include_str!("definitions/header.msg"));
const REGION: (&str, &str) = ("sensor_msgs/RegionOfInterest", include_str!("definitions/region_of_interest.msg"));
const TRANSFORMS: [(&str, &str); 6] = [
    ("geometry_msgs/TransformStamped", include_str!("definitions/transform_stamped.msg")),
    HEADER,
    TIME,
    ("geometry_msgs/Transform", include_str!("definitions/transform.msg")),
    ("geometry_msgs/Vector3", include_str!("definitions/vector3.msg")),
    ("geometry_msgs/Quaternion", include_str!("definitions/quaternion.msg")),
];

impl Topic {
    /// Every topic.
    pub(super) const ALL: [Self; 6] = [
        Self::JointStates,
        Self::Transforms,
        Self::StaticTransforms,
        Self::CameraInfo,
        Self::RobotDescription,
        Self::Stops,
    ];

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::JointStates => "/joint_states",
            Self::Transforms => "/tf",
            Self::StaticTransforms => "/tf_static",
            Self::CameraInfo => "/camera_info",
            Self::RobotDescription => "/robot_description",
            Self::Stops => "/stops",
        }
    }

    /// Type of its messages.
    pub(super) fn kind(self) -> &'static str {
        match self {
            Self::JointStates => "sensor_msgs/msg/JointState",
            Self::Transforms | Self::StaticTransforms => "tf2_msgs/msg/TFMessage",
            Self::CameraInfo => "sensor_msgs/msg/CameraInfo",
            Self::RobotDescription | Self::Stops => "std_msgs/msg/String",
        }
    }

    /// The type's definition with those of all types in it, as ROS 2 has them in MCAP.
    pub(super) fn definition(self) -> String {
        let Definition { own, parts } = match self {
            Self::JointStates => {
                Definition { own: include_str!("definitions/joint_state.msg"), parts: &[HEADER, TIME] }
            }
            Self::Transforms | Self::StaticTransforms => {
                Definition { own: include_str!("definitions/tf_message.msg"), parts: &TRANSFORMS }
            }
            Self::CameraInfo => {
                Definition { own: include_str!("definitions/camera_info.msg"), parts: &[HEADER, TIME, REGION] }
            }
            Self::RobotDescription | Self::Stops => {
                Definition { own: include_str!("definitions/string.msg"), parts: &[] }
            }
        };
        let line = "=".repeat(80);
        let part = |(name, text): &(&str, &str)| format!("{line}\nMSG: {name}\n{text}");
        std::iter::once(own.to_owned()).chain(parts.iter().map(part)).collect()
    }

    /// The service that its publisher offers, as rosbag2 has it, its numbers those of rmw: reliable, and for what is told once kept for
    /// those who come later.
    pub(super) fn offered(self) -> String {
        let durability = match self {
            Self::StaticTransforms | Self::RobotDescription => 1,
            Self::JointStates | Self::Transforms | Self::CameraInfo | Self::Stops => 2,
        };
        let forever = "\n    sec: 9223372036\n    nsec: 854775807";
        format!(
            "- history: 1\n  depth: 10\n  reliability: 1\n  durability: {durability}\n  deadline:{forever}\n  lifespan:{forever}\n  \
             liveliness: 1\n  liveliness_lease_duration:{forever}\n  avoid_ros_namespace_conventions: false\n"
        )
    }
}
