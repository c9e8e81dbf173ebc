//! calipose's own documents that list poses: plans, polished plans, and poses proposed to be taken next.

use super::format::{Import, PoseListFormat};
use super::joint_names::JointOrder;
use super::listed::{ListedPose, PoseList, StatedPlace};
use crate::formats::error::ReadError;
use crate::formats::tree::{Content, Node};
use crate::robot::Joint;

pub(super) const IMPORT: Import = Import {
    format: PoseListFormat::Plan,
    recognises: |root| match root.get("format").map(|format| &format.content) {
        Some(Content::Quoted(format)) => format.starts_with("calipose."),
        _ => false,
    },
    read,
};

fn read(root: &Node, joints: &[Joint]) -> Result<PoseList, ReadError> {
    let order = JointOrder::read(root.require("", "joints")?, "joints", joints)?;
    let poses = root.require("", "poses")?.list(&"poses")?.iter().enumerate();
    let pose = |(i, pose): (usize, &Node)| {
        let within = format!("poses[{i}].");
        let name = pose.require(&within, "id")?.text(&format_args!("{within}id"))?.to_owned();
        let q = order.values(pose.require(&within, "joints_rad")?, &format!("{within}joints_rad"))?;
        Ok(ListedPose { name, place: StatedPlace::Joints(q) })
    };
    Ok(PoseList { poses: poses.map(pose).collect::<Result<_, ReadError>>()?, passed: 0 })
}

#[cfg(test)]
mod tests {
    use crate::formats::pose_list::listed::{joints, values};
    use crate::formats::pose_list::{PoseListFormat, read_poses};

    #[test]
    fn poses_have_their_ids() {
        let text = "{\"format\": \"calipose.plan\", \"joints\": [\"slide\", \"joint_3\", \"waist\"],\n\"poses\": [{\"id\": 77, \
                    \"joints_rad\": [0.1, 0.2, 0.3]}]}";
        let list = read_poses(text, PoseListFormat::Plan, &joints()).unwrap();
        assert_eq!((list.poses[0].name.as_str(), values(&list)), ("77", vec![vec![0.3, 0.1, 0.2]]));
        let short = read_poses(&text.replace(", 0.3", ""), PoseListFormat::Plan, &joints()).unwrap_err().to_string();
        assert_eq!(short, "line 2: `poses[0].joints_rad` has 2 entries; it must have 3, one for each joint");
    }
}
