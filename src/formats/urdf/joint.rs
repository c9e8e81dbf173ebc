//! Joints as a description states them, and what mimics what.

use std::collections::HashMap;

use nalgebra::{Unit, Vector3};

use super::element::Element;
use super::error::{UrdfError, UrdfFault};
use super::note::{UrdfNote, UrdfRemark};
use super::range::StatedRange;
use crate::robot::{Joint, JointKind, Motion};
use crate::spatial::Pose;

/// Axes are unit vectors up to the digits that files are written with.
const UNIT_TOLERANCE: f64 = 1e-3;

/// A `<joint>`.
pub(super) struct UrdfJoint<'a> {
    pub(super) element: Element<'a>,
    pub(super) name: &'a str,
    pub(super) parent: &'a str,
    pub(super) child: &'a str,
    pub(super) X_PJ: Pose,
    /// None if it is fixed; why not if it moves in a way that cannot be followed.
    movement: Result<Option<Movement<'a>>, UrdfError>,
}

struct Movement<'a> {
    kind: JointKind,
    axis: Unit<Vector3<f64>>,
    range: StatedRange,
    max_speed: Option<f64>,
    mimic: Option<Mimic<'a>>,
}

struct Mimic<'a> {
    element: Element<'a>,
    joint: &'a str,
    multiplier: f64,
    offset: f64,
}

/// What the joints of a description do.
pub(super) struct Motions {
    /// The joints that mimic no other, and what is stated of their ranges.
    pub(super) free: Vec<(Joint, StatedRange)>,
    /// How each joint of the description moves.
    pub(super) of_joints: Vec<Motion>,
    /// The joints that cannot be followed, and why; their motion is fixed.
    pub(super) stuck: Vec<(usize, UrdfError)>,
}

impl<'a> UrdfJoint<'a> {
    pub(super) fn read(element: Element<'a>) -> Result<Self, UrdfError> {
        let name = element.name()?;
        let end = |tag| element.required_child(tag)?.required("link");
        let (parent, child) = (end("parent")?, end("child")?);
        let X_PJ = element.origin()?;
        let movement = match Movement::read(element) {
            // On a joint that nothing depends on, these do no harm.
            Err(error) if error.fault.is_of_motion() => Err(error),
            movement => Ok(movement?),
        };
        Ok(Self { element, name, parent, child, X_PJ, movement })
    }

    /// Whether its value follows that of another joint.
    pub(super) fn mimics(&self) -> bool {
        self.movement().is_some_and(|movement| movement.mimic.is_some())
    }

    /// What was put right in it.
    pub(super) fn note(&self) -> Option<UrdfNote> {
        let axis = self.element.child("axis").filter(|_| self.movement().is_some())?;
        let length = Vector3::from(axis.numbers("xyz").ok()??).norm();
        let normal = (length - 1.0).abs() <= UNIT_TOLERANCE;
        (!normal).then(|| axis.note(UrdfRemark::AxisNormalised { length }))
    }

    fn movement(&self) -> Option<&Movement<'a>> {
        self.movement.as_ref().ok().and_then(Option::as_ref)
    }
}

impl<'a> Movement<'a> {
    /// None for a fixed joint.
    fn read(joint: Element<'a>) -> Result<Option<Self>, UrdfError> {
        let (kind, bounded) = match joint.required("type")? {
            "fixed" => return Ok(None),
            "revolute" => (JointKind::Revolute, true),
            "prismatic" => (JointKind::Prismatic, true),
            "continuous" => (JointKind::Revolute, false),
            found => return Err(joint.error(UrdfFault::JointType { found: found.into() })),
        };
        let mimic = match joint.child("mimic") {
            None => None,
            Some(element) => Some(Mimic {
                element,
                joint: element.required("joint")?,
                multiplier: element.number("multiplier")?.unwrap_or(1.0),
                offset: element.number("offset")?.unwrap_or(0.0),
            }),
        };
        // The range of a joint that follows another is that one's.
        let range = if mimic.is_some() { StatedRange::default() } else { StatedRange::read(joint, bounded)? };
        Ok(Some(Self { kind, axis: axis(joint)?, range, max_speed: max_speed(joint)?, mimic }))
    }
}

/// The greatest speed; a file that writes 0 does not know it.
fn max_speed(joint: Element<'_>) -> Result<Option<f64>, UrdfError> {
    let Some(limit) = joint.child("limit") else { return Ok(None) };
    match limit.number("velocity")? {
        Some(value) if value < 0.0 => Err(limit.error(UrdfFault::Negative { what: "velocity", value })),
        speed => Ok(speed.filter(|&speed| speed > 0.0)),
    }
}

/// The axis, of whatever length it is given.
fn axis(joint: Element<'_>) -> Result<Unit<Vector3<f64>>, UrdfError> {
    let Some(axis) = joint.child("axis") else { return Ok(Vector3::x_axis()) };
    axis.required("xyz")?;
    let xyz: [f64; 3] = axis.numbers("xyz")?.unwrap_or_default();
    Unit::try_new(Vector3::from(xyz), 0.0).ok_or_else(|| axis.error(UrdfFault::ZeroAxis))
}

/// What the joints do.
pub(super) fn motions(joints: &[UrdfJoint<'_>]) -> Motions {
    let mut motions = Motions { free: Vec::new(), of_joints: Vec::new(), stuck: Vec::new() };
    let mut free: HashMap<&str, usize> = HashMap::new();
    let by_name: HashMap<&str, usize> = joints.iter().enumerate().map(|(i, joint)| (joint.name, i)).collect();
    for joint in joints {
        if let Some(&Movement { kind, range, max_speed, mimic: None, .. }) = joint.movement() {
            free.insert(joint.name, motions.free.len());
            let limits = range.limits();
            motions.free.push((Joint::free(joint.name.into(), kind, limits, max_speed), range));
        }
    }
    for (i, joint) in joints.iter().enumerate() {
        let motion = match &joint.movement {
            Ok(None) => Ok(Motion::Fixed),
            Ok(Some(Movement { kind, axis, .. })) => {
                leader(joints, &by_name, joint).map(|(leader, multiplier, offset)| {
                    let joint = free.get(leader).copied().unwrap_or_default();
                    Motion::Driven { joint, kind: *kind, axis: *axis, multiplier, offset }
                })
            }
            Err(error) => Err(error.clone()),
        };
        motions.of_joints.push(motion.unwrap_or_else(|error| {
            motions.stuck.push((i, error));
            Motion::Fixed
        }));
    }
    motions
}

/// The joint at the end of what `follower` mimics, and how its value follows: multiplier and offset.
fn leader<'a>(
    joints: &[UrdfJoint<'a>],
    by_name: &HashMap<&str, usize>,
    follower: &UrdfJoint<'a>,
) -> Result<(&'a str, f64, f64), UrdfError> {
    let (mut multiplier, mut offset) = (1.0, 0.0);
    let mut way = vec![follower.name];
    let mut at = follower;
    while let Some(mimic) = at.movement().and_then(|movement| movement.mimic.as_ref()) {
        let name = mimic.joint;
        let Some(next) = by_name.get(name).map(|&next| &joints[next]) else {
            return Err(mimic.element.error(UrdfFault::MimicsUnknown { name: name.into() }));
        };
        match &next.movement {
            Ok(Some(_)) => {}
            Ok(None) => return Err(mimic.element.error(UrdfFault::MimicsFixed { name: name.into() })),
            Err(error) => return Err(error.clone()),
        }
        let met = way.iter().position(|&before| before == name);
        way.push(name);
        if let Some(start) = met {
            let joints = way[start..].iter().map(|&name| name.into()).collect();
            return Err(mimic.element.error(UrdfFault::MimicLoop { joints }));
        }
        offset += multiplier * mimic.offset;
        multiplier *= mimic.multiplier;
        at = next;
    }
    Ok((at.name, multiplier, offset))
}
