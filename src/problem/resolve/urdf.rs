//! The robot as a URDF file describes it.

use std::path::{Path, PathBuf};

use super::{ANGLE, Check, LENGTH, file_unit};
use crate::feasibility::{Simplified, simplify_hulls};
use crate::formats::{Description, StatedRange, UrdfError, read_srdf_file, read_urdf_file};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::schema::Numbers;
use crate::problem::text::KeyPath;
use crate::robot::{Assembly, Joint, JointKind, Limits, Mechanism, Robot};

impl Check<'_, '_> {
    /// The robot of the URDF file `urdf`, or none if something is wrong with it; `folder` is the problem file's.
    pub(crate) fn described_robot(&mut self, file: &schema::File, urdf: &str, folder: &Path) -> Option<Robot> {
        let robot = &file.robot;
        let faults = self.faults.len();
        let at = KeyPath::section("robot");
        for (key, given) in [
            ("convention", robot.convention.is_some()),
            ("limits", robot.limits.is_some()),
            ("flange", robot.flange.is_some()),
            ("joints", !robot.joints.is_empty()),
        ] {
            if given {
                self.fault(&at.key(key), Reason::Conflict { with: "robot.urdf".into() });
            }
        }
        let X_FC = self.mount(&file.camera.mount);
        let Description { mut mechanism, ranges, stuck, .. } = self.description(&at, robot, folder, urdf)?;
        let given = self.described_limits(&at, robot, &mut mechanism, &ranges);
        let held = self.held(&at, robot, &mechanism, &ranges, &given);
        let base_link = self.described_link(&at.key("base_link"), robot.base_link.as_deref(), &mechanism);
        let board_at = KeyPath::section("target").key("link");
        let board_link = self.described_link(&board_at, file.target.link.as_deref(), &mechanism);
        let camera_at = at.key("camera_link");
        let camera_link = match &robot.camera_link {
            None => {
                self.fault(&camera_at, Reason::Missing { allowed: link_names(&mechanism) });
                None
            }
            name => self.described_link(&camera_at, name.as_deref(), &mechanism),
        };
        if self.faults.len() > faults {
            return None;
        }
        let base_link = base_link.unwrap_or(0);
        let assembly =
            Assembly { base_link, board_link: board_link.unwrap_or(base_link), camera_link: camera_link?, X_FC, held };
        let way = mechanism.between(assembly.board_link, assembly.camera_link);
        self.stuck(&at, &folder.join(urdf), stuck, &way);
        if self.faults.len() > faults {
            return None;
        }
        let mut arm = mechanism.robot(&assembly);
        if arm.chain.joints.is_empty() {
            let name = |link: usize| mechanism.tree.links[link].name.clone();
            let (camera_link, board_link) = (name(assembly.camera_link), name(assembly.board_link));
            self.fault(&camera_at, Reason::NothingMoves { camera_link, board_link });
            return None;
        }
        self.limits_of_arm(&at, &arm.chain.joints, &mechanism, &ranges, &given);
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
    fn description(&mut self, at: &KeyPath, robot: &schema::Robot, folder: &Path, urdf: &str) -> Option<Description> {
        let packages: Vec<PathBuf> = robot.package_folders.iter().map(|package| folder.join(package)).collect();
        for (i, _) in packages.iter().enumerate().filter(|(_, package)| !package.is_dir()) {
            let name = robot.package_folders[i].clone();
            self.fault(&at.key("package_folders").at(i), Reason::NoFolder { name });
        }
        let path = folder.join(urdf);
        let mut description = match read_urdf_file(&path, &packages) {
            Ok(description) => description,
            Err(error) => {
                self.fault(&at.key("urdf"), Reason::RobotFile { path, error });
                return None;
            }
        };
        for note in &description.notes {
            self.note(&at.key("urdf"), note.to_string());
        }
        let Simplified { hulls, before, after, margin } = simplify_hulls(&mut description.mechanism.tree);
        if hulls > 0 {
            let margin = (margin * 1e6).round() / 1e3;
            let text = format!(
                "the convex hulls of {hulls} meshes have {after} corners in place of {before} points; they hold all of them and \
                 reach at most {margin} mm beyond"
            );
            self.note(&at.key("urdf"), text);
        }
        if let Some(srdf) = &robot.srdf {
            let path = folder.join(srdf);
            match read_srdf_file(&path, &description.mechanism.tree) {
                Ok((pairs, notes)) => {
                    description.mechanism.tree.disabled = pairs;
                    for note in notes {
                        self.note(&at.key("srdf"), note.to_string());
                    }
                }
                Err(error) => self.fault(&at.key("srdf"), Reason::RobotFile { path, error }),
            }
        }
        Some(description)
    }

    /// The link of that name, if one is given.
    fn described_link(&mut self, path: &KeyPath, name: Option<&str>, mechanism: &Mechanism) -> Option<usize> {
        let name = name?;
        let link = mechanism.link(name);
        if link.is_none() {
            self.fault(path, Reason::UnknownName { name: name.into(), allowed: link_names(mechanism) });
        }
        link
    }

    /// Puts the file's ranges in place of the description's, and returns for which joints it has one.
    fn described_limits(
        &mut self,
        at: &KeyPath,
        robot: &schema::Robot,
        mechanism: &mut Mechanism,
        ranges: &[StatedRange],
    ) -> Vec<bool> {
        let mut given = vec![false; ranges.len()];
        let mut exceeding = Vec::new();
        for (key, limits, kind, allowed) in [
            ("limits_deg", &robot.limits_deg, JointKind::Revolute, ANGLE),
            ("limits_mm", &robot.limits_mm, JointKind::Prismatic, LENGTH),
        ] {
            for (name, &range) in limits {
                let at = at.key(key).key(name);
                let Numbers([min, max]) = self.range(&at, range, allowed);
                let Some(joint) = self.described_joint(&at, name, kind, mechanism) else { continue };
                given[joint] = true;
                let mut limits = Limits { min: kind.in_si(min), max: kind.in_si(max) };
                let bounds = ranges[joint].bounds();
                // Forgiving what numbers lose that are written to a thousandth.
                let slack = kind.in_si(1e-3);
                if limits.min >= bounds.min - slack && limits.max <= bounds.max + slack {
                    limits = Limits { min: limits.min.max(bounds.min), max: limits.max.min(bounds.max) };
                } else {
                    let bounds = [bounds.min, bounds.max].map(|bound| file_unit(kind, bound));
                    if robot.exceed_urdf_limits.contains(name) {
                        let [low, high] = bounds;
                        self.note(
                            &at,
                            format!("goes beyond the URDF's range from {low} to {high}, as is said to be meant"),
                        );
                    } else {
                        let soft = ranges[joint].is_softened();
                        self.fault(&at, Reason::BeyondUrdf { joint: name.clone(), range: [min, max], bounds, soft });
                    }
                    exceeding.push(name);
                }
                mechanism.joints[joint].limits = limits;
            }
        }
        let at = at.key("exceed_urdf_limits");
        for (i, name) in robot.exceed_urdf_limits.iter().enumerate() {
            if mechanism.joint(name).is_none() {
                let allowed = mechanism.joints.iter().map(|joint| joint.name.clone()).collect();
                self.fault(&at.at(i), Reason::UnknownName { name: name.clone(), allowed });
            } else {
                let to = "a joint whose range does not go beyond the URDF's";
                self.refused(&at.at(i), !exceeding.contains(&name), to, "leave it out");
            }
        }
        given
    }

    /// Refuses links that do not move as they should where they are on the `way` from the board to the camera.
    fn stuck(&mut self, at: &KeyPath, path: &Path, stuck: Vec<(usize, UrdfError)>, way: &[usize]) {
        let mut told = Vec::new();
        for (link, error) in stuck {
            if !way.contains(&link) {
                self.note(&at.key("urdf"), format!("{error}. It is off the arm and stands as at 0"));
            } else if !told.contains(&error) {
                // A joint that mimics a stuck one is stuck for the same reason.
                let reason = Reason::RobotFile { path: path.to_owned(), error: error.clone().into() };
                self.fault(&at.key("urdf"), reason);
                told.push(error);
            }
        }
    }

    /// Refuses to sweep joints whose limits nobody states, and notes those that move less than their limits say.
    fn limits_of_arm(
        &mut self,
        at: &KeyPath,
        joints: &[Joint],
        mechanism: &Mechanism,
        ranges: &[StatedRange],
        given: &[bool],
    ) {
        let stated = |joint: &&Joint| mechanism.joint(&joint.name).filter(|&i| !given[i]).map(|i| ranges[i]);
        for (key, kind) in [("limits_deg", JointKind::Revolute), ("limits_mm", JointKind::Prismatic)] {
            let blank = |joint: &&Joint| joint.kind == kind && stated(joint).is_some_and(|range| range.is_blank());
            let blank: Vec<String> = joints.iter().filter(blank).map(|joint| joint.name.clone()).collect();
            if !blank.is_empty() {
                self.fault(&at.key(key), Reason::NoLimits { kind, joints: blank });
            }
        }
        for joint in joints {
            if let Some(range) = stated(&joint).filter(StatedRange::is_softened) {
                self.note(&at.key("urdf"), softened(joint, &range));
            }
        }
    }

    /// For each joint the value at which the file holds it.
    fn held(
        &mut self,
        at: &KeyPath,
        robot: &schema::Robot,
        mechanism: &Mechanism,
        ranges: &[StatedRange],
        given: &[bool],
    ) -> Vec<Option<f64>> {
        let mut held = vec![None; mechanism.joints.len()];
        for (key, values, kind, any) in [
            ("joint_values_deg", &robot.joint_values_deg, JointKind::Revolute, ANGLE),
            ("joint_values_mm", &robot.joint_values_mm, JointKind::Prismatic, LENGTH),
        ] {
            for (name, &value) in values {
                let at = at.key(key).key(name);
                if let Some(joint) = self.described_joint(&at, name, kind, mechanism) {
                    let unlimited = ranges[joint].is_blank() && !given[joint];
                    let allowed = if unlimited { any } else { allowed_values(&mechanism.joints[joint]) };
                    self.number(&at, value, allowed);
                    held[joint] = Some(kind.in_si(value));
                }
            }
        }
        held
    }

    /// The joint of that name, which must be of that kind and mimic no other.
    fn described_joint(&mut self, path: &KeyPath, name: &str, kind: JointKind, mechanism: &Mechanism) -> Option<usize> {
        let follows = mechanism.followers.iter().any(|follower| follower == name);
        self.refused(path, follows, "a joint that mimics another", "give it for the joint that it mimics");
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
        let other = mechanism.joints[joint].kind != kind;
        self.refused(path, other, found, instead);
        (!other).then_some(joint)
    }
}

fn link_names(mechanism: &Mechanism) -> Vec<String> {
    mechanism.tree.links.iter().map(|link| link.name.clone()).collect()
}

/// What the user should know of a joint that moves less than its limits say.
fn softened(joint: &Joint, range: &StatedRange) -> String {
    let unit = joint.kind.display_sign();
    let between = |Limits { min, max }: Limits| {
        format!("{}{unit} to {}{unit}", file_unit(joint.kind, min), file_unit(joint.kind, max))
    };
    let limit = range.limit.map(|limit| format!(", tighter than its limits from {}", between(limit)));
    let (name, limit) = (&joint.name, limit.unwrap_or_default());
    format!("joint \"{name}\" moves from {}, as its safety controller lets it{limit}", between(joint.limits))
}

/// The joint's limits in the file's unit, to a thousandth.
fn allowed_values(joint: &Joint) -> Allowed {
    let unit = joint.kind.to_display(1.0);
    // Forgiving a millionth of that, because ±180° is no binary fraction of a rad.
    let Limits { min, max } = joint.limits;
    Allowed::between((min * unit * 1e3 - 1e-6).ceil() / 1e3, (max * unit * 1e3 + 1e-6).floor() / 1e3)
}
