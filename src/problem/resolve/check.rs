//! Checks of single values, and the units of the file.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::problem::Note;
use crate::problem::fault::{Allowed, Fault, Reason};
use crate::problem::schema::{self, Range};
use crate::problem::text::{self, At, Document, KeyPath, Optional, key};
use crate::robot::JointKind;
use crate::spatial::Pose;

/// Lengths and positions in mm: a kilometre is a slip of the pen.
pub(crate) const LENGTH: Allowed = Allowed::between(-1e6, 1e6);
/// Sizes and distances in mm.
pub(crate) const SIZE: Allowed = Allowed::positive(1e6);
/// Lengths in mm and px that may be 0.
pub(crate) const NOT_NEGATIVE: Allowed = Allowed::between(0.0, 1e6);
/// Angles in degrees: ten turns.
pub(crate) const ANGLE: Allowed = Allowed::between(-3600.0, 3600.0);

/// The faults and notes found so far. A check returns its value in SI units even where it is wrong, so that the next can run.
pub(crate) struct Check<'d, 'a> {
    pub(crate) document: &'d Document<'a>,
    pub(crate) faults: Vec<Fault>,
    pub(crate) notes: Vec<Note>,
}

impl Check<'_, '_> {
    pub(crate) fn fault(&mut self, path: &KeyPath, reason: Reason) {
        self.faults.push(text::fault(self.document, path, reason));
    }

    /// What the user should know about the key at `path`, or the file it names.
    pub(crate) fn note(&mut self, path: &KeyPath, text: String) {
        self.notes.push(Note { key: path.to_string(), text });
    }

    /// A number that must be `allowed`.
    pub(crate) fn number(&mut self, number: &At<f64>, allowed: Allowed) -> f64 {
        self.within(&number.path, *number.value, allowed)
    }

    /// A whole number that must be `allowed`.
    pub(crate) fn count(&mut self, count: &At<impl Copy + Into<u64>>, allowed: Allowed) -> usize {
        self.within(&count.path, (*count.value).into() as f64, allowed) as usize
    }

    /// A length in mm, in m.
    pub(crate) fn length(&mut self, length: &At<f64>, allowed: Allowed) -> f64 {
        self.number(length, allowed) / 1e3
    }

    /// An angle in degrees, in rad.
    pub(crate) fn angle(&mut self, angle: &At<f64>, allowed: Allowed) -> f64 {
        self.number(angle, allowed).to_radians()
    }

    /// `value` of the key at `path`, which must be `allowed`.
    pub(crate) fn within(&mut self, path: &KeyPath, value: f64, allowed: Allowed) -> f64 {
        if !allowed.contains(value) {
            self.fault(path, Reason::OutOfRange { value, allowed });
        }
        value
    }

    /// A range in the file's unit.
    pub(crate) fn range(&mut self, range: &At<Range>, allowed: Allowed) -> [f64; 2] {
        let [min, max] = range.numbers().map(|end| self.number(&end, allowed));
        if min > max {
            self.fault(&range.path, Reason::Reversed { min, max });
        }
        [min, max]
    }

    pub(crate) fn pose(&mut self, pose: &At<schema::Pose>) -> Pose {
        let position = key!(pose, position_mm).numbers().map(|p| self.length(&p, LENGTH));
        let (rpy, quaternion) = (key!(pose, rpy_deg), key!(pose, quaternion_xyzw));
        if rpy.is_given() {
            self.excluded(&[&quaternion], rpy.path.name());
        }
        let rotation = match (rpy.given(), quaternion.given()) {
            (Some(rpy), None) => {
                let [roll, pitch, yaw] = rpy.numbers().map(|angle| self.angle(&angle, ANGLE));
                UnitQuaternion::from_euler_angles(roll, pitch, yaw)
            }
            (None, Some(quaternion)) => {
                let [x, y, z, w] = quaternion.value.0;
                let rotation = Quaternion::new(w, x, y, z);
                let norm = rotation.norm();
                // Files round; anything farther off is not meant as a rotation.
                if (norm - 1.0).abs() <= 1e-3 {
                    UnitQuaternion::new_normalize(rotation)
                } else {
                    self.fault(&quaternion.path, Reason::NotUnit { norm });
                    UnitQuaternion::identity()
                }
            }
            (None, None) | (Some(_), Some(_)) => UnitQuaternion::identity(),
        };
        Pose::from_parts(position.into(), rotation)
    }

    /// The value, which must be given: one of `allowed`, where these can be listed.
    pub(crate) fn required<'f, T>(&mut self, value: At<'f, Option<T>>, allowed: &[&str]) -> Option<At<'f, T>> {
        if !value.is_given() {
            self.fault(&value.path, Reason::Missing { allowed: owned(allowed) });
        }
        value.given()
    }

    /// Refuses `keys`, which the key called `by` excludes.
    pub(crate) fn excluded(&mut self, keys: &[&dyn Optional], by: &str) {
        for key in keys.iter().filter(|key| key.is_given()) {
            self.fault(key.path(), Reason::Conflict { with: by.into() });
        }
    }

    /// Refuses `keys`, which do not apply to `to`.
    pub(crate) fn refused(&mut self, keys: &[&dyn Optional], to: &str, instead: &str) {
        for key in keys.iter().filter(|key| key.is_given()) {
            self.not_applicable(key.path(), to, instead);
        }
    }

    pub(crate) fn not_applicable(&mut self, path: &KeyPath, to: &str, instead: &str) {
        self.fault(path, Reason::NotApplicable { to: to.into(), instead: instead.into() });
    }

    pub(crate) fn unknown(&mut self, path: &KeyPath, name: &str, allowed: &[&str]) {
        self.fault(path, Reason::UnknownName { name: name.into(), allowed: owned(allowed) });
    }
}

/// A joint value in rad or m in the file's unit, to a thousandth.
pub(crate) fn file_unit(kind: JointKind, value: f64) -> f64 {
    (kind.to_display(value) * 1e3).round() / 1e3 + 0.0
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}
