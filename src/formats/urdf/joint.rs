//! Joints as a description states them, and what mimics what.

use nalgebra::{Unit, Vector3};

use super::element::Element;
use super::error::{UrdfError, UrdfFault};
use crate::robot::{Joint, JointKind, Limits, Motion};
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
    /// None if it is fixed.
    movement: Option<Movement<'a>>,
}

struct Movement<'a> {
    kind: JointKind,
    axis: Unit<Vector3<f64>>,
    limits: Limits,
    max_speed: Option<f64>,
    mimic: Option<Mimic<'a>>,
}

struct Mimic<'a> {
    element: Element<'a>,
    joint: &'a str,
    multiplier: f64,
    offset: f64,
}

impl<'a> UrdfJoint<'a> {
    pub(super) fn read(element: Element<'a>) -> Result<Self, UrdfError> {
        let name = element.name()?;
        let end = |tag| element.required_child(tag)?.required("link");
        let (parent, child) = (end("parent")?, end("child")?);
        let X_PJ = element.origin()?;
        let movement = match element.required("type")? {
            "fixed" => None,
            "revolute" => Some(Movement::read(element, JointKind::Revolute, stated_limits(element)?)?),
            "prismatic" => Some(Movement::read(element, JointKind::Prismatic, stated_limits(element)?)?),
            "continuous" => Some(Movement::read(element, JointKind::Revolute, Limits::FULL_TURN)?),
            found => return Err(element.error(UrdfFault::JointType { found: found.into() })),
        };
        Ok(Self { element, name, parent, child, X_PJ, movement })
    }

    /// Whether its value follows that of another joint.
    pub(super) fn mimics(&self) -> bool {
        self.movement.as_ref().is_some_and(|movement| movement.mimic.is_some())
    }
}

impl<'a> Movement<'a> {
    fn read(joint: Element<'a>, kind: JointKind, limits: Limits) -> Result<Self, UrdfError> {
        let mimic = match joint.child("mimic") {
            None => None,
            Some(element) => Some(Mimic {
                element,
                joint: element.required("joint")?,
                multiplier: element.number("multiplier")?.unwrap_or(1.0),
                offset: element.number("offset")?.unwrap_or(0.0),
            }),
        };
        Ok(Self { kind, axis: axis(joint)?, limits, max_speed: max_speed(joint)?, mimic })
    }
}

/// The limits of a joint that must have some.
fn stated_limits(joint: Element<'_>) -> Result<Limits, UrdfError> {
    let limit = joint.required_child("limit")?;
    let lower = limit.number("lower")?.unwrap_or(0.0);
    let upper = limit.number("upper")?.unwrap_or(0.0);
    if lower > upper {
        return Err(limit.error(UrdfFault::LimitsReversed { lower, upper }));
    }
    Ok(Limits { min: lower, max: upper })
}

/// The greatest speed; a file that writes 0 does not know it.
fn max_speed(joint: Element<'_>) -> Result<Option<f64>, UrdfError> {
    let Some(limit) = joint.child("limit") else { return Ok(None) };
    match limit.number("velocity")? {
        Some(value) if value < 0.0 => Err(limit.error(UrdfFault::Negative { what: "the velocity", value })),
        speed => Ok(speed.filter(|&speed| speed > 0.0)),
    }
}

fn axis(joint: Element<'_>) -> Result<Unit<Vector3<f64>>, UrdfError> {
    let Some(axis) = joint.child("axis") else { return Ok(Vector3::x_axis()) };
    axis.required("xyz")?;
    let xyz: [f64; 3] = axis.numbers("xyz")?.unwrap_or_default();
    let (unit, length) = Unit::new_and_get(Vector3::from(xyz));
    if length == 0.0 {
        Err(axis.error(UrdfFault::ZeroAxis))
    } else if (length - 1.0).abs() > UNIT_TOLERANCE {
        Err(axis.error(UrdfFault::AxisNotUnit { length, unit: unit.into_inner().into() }))
    } else {
        Ok(unit)
    }
}

/// The joints that mimic no other, and what each joint does.
pub(super) fn motions(joints: &[UrdfJoint<'_>]) -> Result<(Vec<Joint>, Vec<Motion>), UrdfError> {
    let free = |joint: &UrdfJoint| {
        let Movement { kind, limits, max_speed, .. } =
            *joint.movement.as_ref().filter(|movement| movement.mimic.is_none())?;
        Some(Joint { name: joint.name.into(), kind, limits, max_speed })
    };
    let free: Vec<Joint> = joints.iter().filter_map(free).collect();
    let motion = |joint: &UrdfJoint| {
        let Some(movement) = &joint.movement else { return Ok(Motion::Fixed) };
        let (leader, multiplier, offset) = leader(joints, joint)?;
        let joint = free.iter().position(|joint| joint.name == leader).unwrap_or_default();
        Ok(Motion::Driven { joint, kind: movement.kind, axis: movement.axis, multiplier, offset })
    };
    let motions = joints.iter().map(motion).collect::<Result<_, UrdfError>>()?;
    Ok((free, motions))
}

/// The joint at the end of what `follower` mimics, and how its value follows: multiplier and offset.
fn leader<'a>(joints: &[UrdfJoint<'a>], follower: &UrdfJoint<'a>) -> Result<(&'a str, f64, f64), UrdfError> {
    let (mut multiplier, mut offset) = (1.0, 0.0);
    let mut way = vec![follower.name];
    let mut at = follower;
    while let Some(mimic) = at.movement.as_ref().and_then(|movement| movement.mimic.as_ref()) {
        let name = mimic.joint;
        let Some(next) = joints.iter().find(|joint| joint.name == name) else {
            return Err(mimic.element.error(UrdfFault::MimicsUnknown { name: name.into() }));
        };
        if next.movement.is_none() {
            return Err(mimic.element.error(UrdfFault::MimicsFixed { name: name.into() }));
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
