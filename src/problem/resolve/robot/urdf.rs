//! The robot as a URDF file describes it.

use std::path::{Path, PathBuf};

use crate::feasibility::{Simplified, simplify_hulls};
use crate::formats::{Description, StatedRange, UrdfError, read_srdf_file, read_urdf_file};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::resolve::check::{ANGLE, Check, LENGTH, file_unit};
use crate::problem::schema;
use crate::problem::text::{At, KeyPath, key};
use crate::robot::{Assembly, Joint, JointKind, Limits, Mechanism, Robot};

impl Check<'_, '_> {
    /// The robot of the URDF file `urdf`, or none if something is wrong with it; `folder` is the problem file's.
    pub(super) fn urdf_robot(&mut self, file: &At<schema::File>, urdf: &At<String>, folder: &Path) -> Option<Robot> {
        let faults = self.faults.len();
        let robot = &key!(file, robot);
        self.excluded(
            &[&key!(robot, convention), &key!(robot, limits), &key!(robot, flange), &key!(robot, joints)],
            &urdf.path.to_string(),
        );
        let X_FC = self.mount(&key!(file, camera));
        let Description { mut mechanism, ranges, stuck, .. } = self.description(robot, urdf, folder)?;
        let given = self.described_limits(robot, &mut mechanism, &ranges);
        let held = self.held(robot, &mechanism, &ranges, &given);
        let base_link = self.described_link(key!(robot, base_link).given(), &mechanism);
        let board_link = self.described_link(key!(file, target.link).given(), &mechanism);
        let camera_link = self.required(key!(robot, camera_link), &link_names(&mechanism));
        let camera_link = self.described_link(camera_link, &mechanism);
        if self.faults.len() > faults {
            return None;
        }
        let base_link = base_link.unwrap_or(0);
        let assembly =
            Assembly { base_link, board_link: board_link.unwrap_or(base_link), camera_link: camera_link?, X_FC, held };
        let way = mechanism.between(assembly.board_link, assembly.camera_link);
        self.stuck(urdf, &folder.join(urdf.value), stuck, &way);
        if self.faults.len() > faults {
            return None;
        }
        let mut arm = mechanism.robot(&assembly);
        if arm.chain.joints.is_empty() {
            let name = |link: usize| mechanism.tree.links[link].name.clone();
            let (camera_link, board_link) = (name(assembly.camera_link), name(assembly.board_link));
            self.fault(&key!(robot, camera_link).path, Reason::NothingMoves { camera_link, board_link });
            return None;
        }
        self.limits_of_arm(robot, &urdf.path, &arm.chain.joints, &mechanism, &ranges, &given);
        if self.faults.len() > faults {
            return None;
        }
        let mut tree = std::mem::take(&mut arm.tree);
        let names: Vec<String> = tree.links.iter().map(|link| link.name.clone()).collect();
        let links = names.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
        self.carried(file, arm.X_FC, arm.camera_link, &links, &mut tree);
        Some(Robot { tree, ..arm })
    }

    /// The description of the robot, with the pairs of links that its SRDF names.
    fn description(&mut self, robot: &At<schema::Robot>, urdf: &At<String>, folder: &Path) -> Option<Description> {
        let mut packages: Vec<PathBuf> = Vec::new();
        for package in key!(robot, package_folders).elements() {
            let path = folder.join(package.value);
            if !path.is_dir() {
                self.fault(&package.path, Reason::NoFolder { name: package.value.clone() });
            }
            packages.push(path);
        }
        let path = folder.join(urdf.value);
        let mut description = match read_urdf_file(&path, &packages) {
            Ok(description) => description,
            Err(error) => {
                self.fault(&urdf.path, Reason::RobotFile { path, error });
                return None;
            }
        };
        for note in &description.notes {
            self.note(&urdf.path, note.to_string());
        }
        let Simplified { hulls, before, after, margin } = simplify_hulls(&mut description.mechanism.tree);
        if hulls > 0 {
            let margin = (margin * 1e6).round() / 1e3;
            let text = format!(
                "the convex hulls of {hulls} meshes have {after} corners in place of {before} points; they hold all of them and \
                 reach at most {margin} mm beyond"
            );
            self.note(&urdf.path, text);
        }
        if let Some(srdf) = key!(robot, srdf).given() {
            let path = folder.join(srdf.value);
            match read_srdf_file(&path, &description.mechanism.tree) {
                Ok((pairs, notes)) => {
                    description.mechanism.tree.disabled = pairs;
                    for note in notes {
                        self.note(&srdf.path, note.to_string());
                    }
                }
                Err(error) => self.fault(&srdf.path, Reason::RobotFile { path, error }),
            }
        }
        Some(description)
    }

    /// The link of that name, if one is given.
    fn described_link(&mut self, name: Option<At<String>>, mechanism: &Mechanism) -> Option<usize> {
        let name = name?;
        let link = mechanism.link(name.value);
        if link.is_none() {
            self.unknown(&name.path, name.value, &link_names(mechanism));
        }
        link
    }

    /// Puts the file's ranges in place of the description's, and returns for which joints it has one.
    fn described_limits(
        &mut self,
        robot: &At<schema::Robot>,
        mechanism: &mut Mechanism,
        ranges: &[StatedRange],
    ) -> Vec<bool> {
        let mut given = vec![false; ranges.len()];
        let exceed = key!(robot, exceed_urdf_limits);
        let mut exceeding = Vec::new();
        for (limits, kind, allowed) in [
            (key!(robot, limits_deg), JointKind::Revolute, ANGLE),
            (key!(robot, limits_mm), JointKind::Prismatic, LENGTH),
        ] {
            for (name, range) in limits.entries() {
                let [min, max] = self.range(&range, allowed);
                let Some(joint) = self.described_joint(&range.path, name, kind, mechanism) else { continue };
                given[joint] = true;
                let mut limits = Limits { min: kind.in_si(min), max: kind.in_si(max) };
                let bounds = ranges[joint].bounds();
                // Forgiving what numbers lose that are written to a thousandth.
                let slack = kind.in_si(1e-3);
                if limits.min >= bounds.min - slack && limits.max <= bounds.max + slack {
                    limits = Limits { min: limits.min.max(bounds.min), max: limits.max.min(bounds.max) };
                } else {
                    let bounds = [bounds.min, bounds.max].map(|bound| file_unit(kind, bound));
                    if exceed.value.contains(name) {
                        let [low, high] = bounds;
                        let text = format!(
                            "goes beyond the URDF's range from {low} to {high}, as `exceed_urdf_limits` allows"
                        );
                        self.note(&range.path, text);
                    } else {
                        let (joint, soft) = (name.clone(), ranges[joint].is_softened());
                        self.fault(&range.path, Reason::BeyondUrdf { joint, range: [min, max], bounds, soft });
                    }
                    exceeding.push(name);
                }
                mechanism.joints[joint].limits = limits;
            }
        }
        for At { value: name, path } in exceed.elements() {
            if mechanism.joint(name).is_none() {
                let names: Vec<&str> = mechanism.joints.iter().map(|joint| joint.name.as_str()).collect();
                self.unknown(&path, name, &names);
            } else if !exceeding.contains(&name) {
                self.not_applicable(&path, "a joint whose range does not go beyond the URDF's", "leave it out");
            }
        }
        given
    }

    /// Refuses links that do not move as they should where they are on the `way` from the board to the camera.
    fn stuck(&mut self, urdf: &At<String>, path: &Path, stuck: Vec<(usize, UrdfError)>, way: &[usize]) {
        let mut told = Vec::new();
        for (link, error) in stuck {
            if !way.contains(&link) {
                self.note(&urdf.path, format!("{error}. It is off the arm and is held at 0"));
            } else if !told.contains(&error) {
                // A joint that mimics a stuck one is stuck for the same reason.
                let reason = Reason::RobotFile { path: path.to_owned(), error: error.clone().into() };
                self.fault(&urdf.path, reason);
                told.push(error);
            }
        }
    }

    /// Refuses to sweep joints whose limits nobody states, and notes those that move less than their limits say.
    fn limits_of_arm(
        &mut self,
        robot: &At<schema::Robot>,
        urdf: &KeyPath,
        joints: &[Joint],
        mechanism: &Mechanism,
        ranges: &[StatedRange],
        given: &[bool],
    ) {
        let stated = |joint: &&Joint| mechanism.joint(&joint.name).filter(|&i| !given[i]).map(|i| ranges[i]);
        for (limits, kind) in
            [(key!(robot, limits_deg), JointKind::Revolute), (key!(robot, limits_mm), JointKind::Prismatic)]
        {
            let blank = |joint: &&Joint| joint.kind == kind && stated(joint).is_some_and(|range| range.is_blank());
            let blank: Vec<String> = joints.iter().filter(blank).map(|joint| joint.name.clone()).collect();
            if !blank.is_empty() {
                self.fault(&limits.path, Reason::NoLimits { kind, joints: blank });
            }
        }
        for joint in joints {
            if let Some(range) = stated(&joint).filter(StatedRange::is_softened) {
                self.note(urdf, softened(joint, &range));
            }
        }
    }

    /// For each joint the value at which the file holds it.
    fn held(
        &mut self,
        robot: &At<schema::Robot>,
        mechanism: &Mechanism,
        ranges: &[StatedRange],
        given: &[bool],
    ) -> Vec<Option<f64>> {
        let mut held = vec![None; mechanism.joints.len()];
        for (values, kind, any) in [
            (key!(robot, joint_values_deg), JointKind::Revolute, ANGLE),
            (key!(robot, joint_values_mm), JointKind::Prismatic, LENGTH),
        ] {
            for (name, value) in values.entries() {
                if let Some(joint) = self.described_joint(&value.path, name, kind, mechanism) {
                    let unlimited = ranges[joint].is_blank() && !given[joint];
                    let allowed = if unlimited { any } else { allowed_values(&mechanism.joints[joint]) };
                    held[joint] = Some(kind.in_si(self.number(&value, allowed)));
                }
            }
        }
        held
    }

    /// The joint of that name, which must be of that kind and mimic no other.
    fn described_joint(&mut self, path: &KeyPath, name: &str, kind: JointKind, mechanism: &Mechanism) -> Option<usize> {
        let follows = mechanism.followers.iter().any(|follower| follower == name);
        if follows {
            self.not_applicable(path, "a joint that mimics another", "give it for the joint that it mimics");
        }
        let Some(joint) = mechanism.joint(name) else {
            if !follows {
                let allowed = mechanism.joints.iter().map(|joint| joint.name.clone()).collect();
                self.fault(path, Reason::UnknownKey { allowed });
            }
            return None;
        };
        let (found, instead) = match mechanism.joints[joint].kind {
            JointKind::Revolute => ("a revolute joint", "use the key that ends in `_deg`"),
            JointKind::Prismatic => ("a prismatic joint", "use the key that ends in `_mm`"),
        };
        if mechanism.joints[joint].kind != kind {
            self.not_applicable(path, found, instead);
            return None;
        }
        Some(joint)
    }
}

fn link_names(mechanism: &Mechanism) -> Vec<&str> {
    mechanism.tree.links.iter().map(|link| link.name.as_str()).collect()
}

/// What the user should know of a joint that moves less than its limits say.
fn softened(joint: &Joint, range: &StatedRange) -> String {
    let unit = joint.kind.display_sign();
    let between = |Limits { min, max }: Limits| {
        format!("{}{unit} to {}{unit}", file_unit(joint.kind, min), file_unit(joint.kind, max))
    };
    let limit = range.limit.map(|limit| format!(", which are tighter than its limits from {}", between(limit)));
    let (name, limit) = (&joint.name, limit.unwrap_or_default());
    format!("joint \"{name}\" moves from {}, the soft limits of its safety controller{limit}", between(joint.limits))
}

/// The joint's limits in the file's unit, to a thousandth.
fn allowed_values(joint: &Joint) -> Allowed {
    let unit = joint.kind.to_display(1.0);
    // Forgiving a millionth of that, because ±180° is no binary fraction of a rad.
    let Limits { min, max } = joint.limits;
    Allowed::between((min * unit * 1e3 - 1e-6).ceil() / 1e3, (max * unit * 1e3 + 1e-6).floor() / 1e3)
}
