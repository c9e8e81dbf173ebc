//! The tour as a recording of ROS 2's messages in MCAP, which Foxglove and rosbag2 read.
//!
//! ```text
//! Setup → moments (time, joint values) → messages (CDR) → MCAP
//! ```
//!
//! Joint states, transforms of all links, the camera's intrinsics at each picture, the robot's description, and the names of the places that
//! the robot comes to. Times are those of the tour and begin at 0: the same plan gives the same bytes.
//!
//! Sources: the `ros2` profile of MCAP's specification; the definitions of `common_interfaces`, `geometry2` and `rcl_interfaces`.

mod cdr;
mod message;
mod moment;
mod topic;

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};

use super::ExportFile;
use super::error::ExportError;
use super::model::{Assembly, ModelLink, Movement, Setup, description};
use super::text::file_name;
use message::{Time, Transform};
use moment::{Arrival, moments};
use topic::Topic;

/// The tour of `setup` as a recording.
///
/// # Errors
/// Where the tour makes no sense or is not the robot's.
pub(super) fn write(setup: &Setup) -> Result<ExportFile, ExportError> {
    setup.check()?;
    let assembly = Assembly::new(setup, &[])?;
    let bytes = recorded(setup, &assembly).map_err(|error| ExportError::Recording { message: error.to_string() })?;
    Ok(ExportFile { name: file_name(setup.program.name, "mcap"), bytes })
}

fn recorded(setup: &Setup, assembly: &Assembly) -> mcap::McapResult<Vec<u8>> {
    let mut recorder = Recorder::new()?;
    let camera = &assembly.links[assembly.camera].name;
    recorder.take(Topic::RobotDescription, Time(0), &message::text(&description(setup, assembly)))?;
    recorder.take(
        Topic::StaticTransforms,
        Time(0),
        &message::transforms(Time(0), &transforms(assembly, &[], false)),
    )?;
    let names = || setup.program.joints.iter().map(|joint| joint.name.as_str());
    for moment in moments(setup.program) {
        let time = Time::of(moment.time);
        recorder.take(Topic::JointStates, time, &message::joint_state(time, names(), &moment.q))?;
        let moving = transforms(assembly, &moment.q, true);
        recorder.take(Topic::Transforms, time, &message::transforms(time, &moving))?;
        let Some(Arrival { label, visit }) = moment.arrival else { continue };
        recorder.take(Topic::Stops, time, &message::text(label))?;
        if visit.is_some() {
            recorder.take(Topic::CameraInfo, time, &message::camera_info(time, camera, setup.camera))?;
        }
    }
    recorder.finish()
}

/// The links in their parents: those that move, at joint values `q`, or those that do not.
fn transforms<'a>(assembly: &'a Assembly, q: &[f64], moves: bool) -> Vec<Transform<'a>> {
    let links = assembly.links.iter().filter(|link| (link.movement != Movement::Fixed) == moves);
    let transform = |link: &'a ModelLink| {
        let parent = &assembly.links[link.parent?].name;
        Some(Transform { parent, child: &link.name, X_PC: link.pose(q) })
    };
    links.filter_map(transform).collect()
}

/// An MCAP file as it is written.
struct Recorder {
    writer: Writer<Cursor<Vec<u8>>>,
    /// The channel of each topic, and the number of its next message.
    channels: BTreeMap<Topic, (u16, u32)>,
}

impl Recorder {
    fn new() -> mcap::McapResult<Self> {
        let options = WriteOptions::new().compression(None).profile("ros2");
        let options = options.library(format!("calipose {}", env!("CARGO_PKG_VERSION")));
        let mut writer = options.create(Cursor::new(Vec::new()))?;
        let mut channels = BTreeMap::new();
        for topic in Topic::ALL {
            let schema = writer.add_schema(topic.kind(), "ros2msg", topic.definition().as_bytes())?;
            let offered = BTreeMap::from([("offered_qos_profiles".to_owned(), topic.offered())]);
            channels.insert(topic, (writer.add_channel(schema, topic.name(), "cdr", &offered)?, 0));
        }
        Ok(Self { writer, channels })
    }

    fn take(&mut self, topic: Topic, Time(time): Time, data: &[u8]) -> mcap::McapResult<()> {
        let Some((channel_id, sequence)) = self.channels.get_mut(&topic) else { return Ok(()) };
        let header = MessageHeader { channel_id: *channel_id, sequence: *sequence, log_time: time, publish_time: time };
        *sequence += 1;
        self.writer.write_to_known_channel(&header, data)
    }

    fn finish(mut self) -> mcap::McapResult<Vec<u8>> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::model::example::Example;

    #[test]
    fn the_recording_is_read_back_with_all_its_topics() {
        let example = Example::new();
        let program = example.program();
        let setup = example.setup(&program);
        let file = write(&setup).unwrap();
        assert_eq!(file.name, "lift_arm.mcap");
        assert_eq!(file, write(&setup).unwrap());
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        let mut last = 0;
        for message in mcap::MessageStream::new(&file.bytes).unwrap() {
            let message = message.unwrap();
            let schema = message.channel.schema.as_ref().unwrap();
            assert_eq!((schema.encoding.as_str(), message.channel.message_encoding.as_str()), ("ros2msg", "cdr"));
            assert!(message.log_time >= last);
            last = message.log_time;
            *counts.entry(message.channel.topic.clone()).or_default() += 1;
        }
        // Home, three moves of 2 s in steps of 0.05 s, and two stays of 1 s.
        let moments = 1 + 3 * 40 + 2 * 20;
        let of = |topic: &str| counts.get(topic).copied().unwrap_or_default();
        assert_eq!(last, 8_000_000_000);
        assert_eq!((of("/joint_states"), of("/tf"), of("/tf_static")), (moments, moments, 1));
        assert_eq!((of("/camera_info"), of("/stops"), of("/robot_description")), (2, 4, 1));
    }
}
