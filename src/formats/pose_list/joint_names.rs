//! Which of a file's values is which joint's.

use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::{Located, Node};
use crate::robot::Joint;

/// The places of the robot's joints, in the robot's order, in a file's list of values.
pub(super) struct JointOrder(Vec<usize>);

impl JointOrder {
    /// By the names that `node` lists under `key`: all of the robot's joints, each once.
    pub(super) fn read(node: &Node, key: &str, joints: &[Joint]) -> Result<Self, ReadError> {
        let mut places = vec![None; joints.len()];
        for (place, entry) in node.list(&key)?.iter().enumerate() {
            let name = entry.text(&format_args!("{key}[{place}]"))?;
            let joint = joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
                let joints = joints.iter().map(|joint| joint.name.clone()).collect();
                ReadFault::UnknownJoint { name: name.to_owned(), joints }.at(entry.line)
            })?;
            if places[joint].replace(place).is_some() {
                return Err(ReadFault::Repeated { name: name.to_owned() }.at(entry.line));
            }
        }
        complete(places, joints, "").map(Self).map_err(|fault| fault.at(node.line))
    }

    /// The joint values among those that `node` lists under `key`, in the robot's order.
    pub(super) fn values(&self, node: &Node, key: &str) -> Result<Vec<f64>, ReadError> {
        let values: Vec<Located> = node.numbers(&key)?;
        if values.len() != self.0.len() {
            let expected = format!("{}, one for each joint", self.0.len());
            return Err(ReadFault::Length { key: key.to_owned(), found: values.len(), expected }.at(node.line));
        }
        Ok(self.0.iter().map(|&place| values[place].value).collect())
    }
}

/// What was found for every one of the `joints`, or which have nothing, and what to do `instead`.
pub(super) fn complete<T>(found: Vec<Option<T>>, joints: &[Joint], instead: &'static str) -> Result<Vec<T>, ReadFault> {
    let missing = joints.iter().zip(&found).filter(|(_, found)| found.is_none());
    let missing: Vec<String> = missing.map(|(joint, _)| joint.name.clone()).collect();
    if missing.is_empty() {
        Ok(found.into_iter().flatten().collect())
    } else {
        Err(ReadFault::MissingJoints { joints: missing, instead })
    }
}
