//! The arm as a Denavit–Hartenberg table, and the camera's mount.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::bodies::Links;
use super::{ANGLE, Check, LENGTH};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::schema::{MountName, Named};
use crate::problem::schema::{Numbers, Range, RangeOrSets, TextOrTable};
use crate::problem::text::KeyPath;
use crate::robot::dh;
use crate::robot::dh::{Convention, Row};
use crate::robot::{JointKind, Limits, Robot, Tree};
use crate::spatial::Pose;

impl Check<'_, '_> {
    /// The robot, or none if its limits cannot be swept.
    pub(crate) fn robot(&mut self, file: &schema::File) -> Option<Robot> {
        let schema::File { robot, camera, .. } = file;
        let faults = self.faults.len();
        let at = KeyPath::section("robot");
        if robot.joints.is_empty() {
            self.fault(&at.key("joints"), Reason::NoArm);
        }
        self.without_urdf(file);
        let mut rows: Vec<Row> = Vec::with_capacity(robot.joints.len());
        for (i, joint) in robot.joints.iter().enumerate() {
            let at = at.key("joints").at(i);
            if joint.name.trim().is_empty() {
                self.fault(&at.key("name"), Reason::Empty);
            } else if rows.iter().any(|row| row.name == joint.name) {
                self.fault(&at.key("name"), Reason::Duplicate { name: joint.name.clone() });
            }
            rows.push(self.row(&at, joint, robot.limits.as_deref()));
        }
        let in_sets = |limits: &Option<RangeOrSets>| matches!(limits, Some(RangeOrSets::Sets(_)));
        if robot.limits.is_some()
            && !robot.joints.iter().any(|joint| in_sets(&joint.limits_deg) || in_sets(&joint.limits_mm))
        {
            let to = "joints that give one range each".to_owned();
            self.fault(&at.key("limits"), Reason::NotApplicable { to, instead: "leave it out".into() });
        }
        let X_nF = robot.flange.as_ref().map_or_else(Pose::identity, |flange| self.pose(&at.key("flange"), flange));
        let X_FC = self.mount(&camera.mount);
        let convention = robot.convention.map_or(Convention::Standard, |named| named.0);
        let chain = dh::chain(&rows, convention, X_nF);
        let mut tree = dh::tree(&rows, convention, X_nF);
        let frames = rows.iter().enumerate().map(|(i, row)| (row.name.as_str(), dh::frame_link(i + 1)));
        let links = std::iter::once(("base", 0)).chain(frames).collect();
        let camera_link = tree.links.len() - 1;
        self.carried(file, X_FC, camera_link, &links, &mut tree);
        let obstacles = Vec::new();
        (self.faults.len() == faults).then_some(Robot { chain, X_FC, tree, board_link: 0, camera_link, obstacles })
    }

    /// Attaches what the problem file adds to the robot: bodies, masses, and the camera's housing.
    pub(crate) fn carried(
        &mut self,
        file: &schema::File,
        X_FC: Pose,
        camera_link: usize,
        links: &Links,
        tree: &mut Tree,
    ) {
        self.bodies(&file.robot.bodies, links, tree);
        self.masses(&file.robot.masses, links, tree);
        if let Some(housing) = &file.camera.housing {
            self.housing(housing, X_FC, camera_link, tree);
        }
    }

    /// Refuses what only a URDF gives a meaning to.
    fn without_urdf(&mut self, file: &schema::File) {
        let schema::Robot { srdf, package_folders, base_link, camera_link, .. } = &file.robot;
        let schema::Robot { joint_values_deg, joint_values_mm, limits_deg, limits_mm, .. } = &file.robot;
        let exceeding = !file.robot.exceed_urdf_limits.is_empty();
        let robot = KeyPath::section("robot");
        let to = "a robot without `urdf`";
        for (key, given) in [
            ("srdf", srdf.is_some()),
            ("package_folders", !package_folders.is_empty()),
            ("base_link", base_link.is_some()),
            ("camera_link", camera_link.is_some()),
            ("joint_values_deg", !joint_values_deg.is_empty()),
            ("joint_values_mm", !joint_values_mm.is_empty()),
            ("exceed_urdf_limits", exceeding),
        ] {
            self.refused(&robot.key(key), given, to, "leave it out");
        }
        for (key, given) in [("limits_deg", !limits_deg.is_empty()), ("limits_mm", !limits_mm.is_empty())] {
            self.refused(&robot.key(key), given, to, &format!("give `{key}` to each of `robot.joints`"));
        }
        let link = KeyPath::section("target").key("link");
        self.refused(&link, file.target.link.is_some(), to, "leave it out; the board is in the base frame");
    }

    fn row(&mut self, at: &KeyPath, joint: &schema::Joint, set: Option<&str>) -> Row {
        let speed = Allowed::positive(1e6);
        let (limits, max_speed) = match joint.kind.0 {
            JointKind::Revolute => {
                self.not_applicable(at, "limits_mm", joint.limits_mm.is_some(), "a revolute joint", "limits_deg");
                let speed_mm = joint.max_speed_mm_s.is_some();
                self.not_applicable(at, "max_speed_mm_s", speed_mm, "a revolute joint", "max_speed_deg_s");
                let Numbers([min, max]) = self.limits(&at.key("limits_deg"), joint.limits_deg.as_ref(), set, ANGLE);
                let speed_at = at.key("max_speed_deg_s");
                (
                    Limits { min: min.to_radians(), max: max.to_radians() },
                    joint.max_speed_deg_s.map(|v| self.angle(&speed_at, v, speed)),
                )
            }
            JointKind::Prismatic => {
                self.not_applicable(at, "limits_deg", joint.limits_deg.is_some(), "a prismatic joint", "limits_mm");
                let speed_deg = joint.max_speed_deg_s.is_some();
                self.not_applicable(at, "max_speed_deg_s", speed_deg, "a prismatic joint", "max_speed_mm_s");
                let Numbers([min, max]) = self.limits(&at.key("limits_mm"), joint.limits_mm.as_ref(), set, LENGTH);
                let speed_at = at.key("max_speed_mm_s");
                (
                    Limits { min: min / 1e3, max: max / 1e3 },
                    joint.max_speed_mm_s.map(|v| self.length(&speed_at, v, speed)),
                )
            }
        };
        Row {
            name: joint.name.clone(),
            kind: joint.kind.0,
            a: self.length(&at.key("a_mm"), joint.a_mm, LENGTH),
            alpha: self.angle(&at.key("alpha_deg"), joint.alpha_deg, ANGLE),
            d: self.length(&at.key("d_mm"), joint.d_mm, LENGTH),
            theta: self.angle(&at.key("theta_deg"), joint.theta_deg, ANGLE),
            limits,
            max_speed,
        }
    }

    fn not_applicable(&mut self, at: &KeyPath, key: &str, given: bool, to: &str, instead: &str) {
        self.refused(&at.key(key), given, to, &format!("use `{instead}`"));
    }

    pub(crate) fn refused(&mut self, path: &KeyPath, given: bool, to: &str, instead: &str) {
        if given {
            self.fault(path, Reason::NotApplicable { to: to.into(), instead: instead.into() });
        }
    }

    /// The range to use, in the file's unit.
    fn limits(&mut self, path: &KeyPath, limits: Option<&RangeOrSets>, set: Option<&str>, allowed: Allowed) -> Range {
        const NONE: Range = Numbers([0.0, 0.0]);
        match limits {
            None => {
                self.fault(path, Reason::Missing { allowed: Vec::new() });
                NONE
            }
            Some(&RangeOrSets::Range(range)) => self.range(path, range, allowed),
            Some(RangeOrSets::Sets(sets)) => {
                // The sets that are not used must be right too: another run may select them.
                for (name, &range) in sets {
                    self.range(&path.key(name), range, allowed);
                }
                let selector = KeyPath::section("robot").key("limits");
                let names: Vec<String> = sets.keys().cloned().collect();
                let reason = match set {
                    None => Reason::Missing { allowed: names },
                    Some(name) => match sets.get(name) {
                        Some(&range) => return range,
                        None => Reason::UnknownName { name: name.into(), allowed: names },
                    },
                };
                // Every joint would say the same.
                if !self.faults.iter().any(|fault| fault.key == selector.to_string()) {
                    self.fault(&selector, reason);
                }
                NONE
            }
        }
    }

    pub(crate) fn range(&mut self, path: &KeyPath, range: Range, allowed: Allowed) -> Range {
        let Numbers([min, max]) = range;
        self.number(&path.at(0), min, allowed);
        self.number(&path.at(1), max, allowed);
        if min > max {
            self.fault(path, Reason::Reversed { min, max });
        }
        range
    }

    pub(crate) fn mount(&mut self, mount: &TextOrTable<Named<MountName>, schema::Pose>) -> Pose {
        let name = match mount {
            TextOrTable::Text(Named(name)) => name,
            TextOrTable::Table(pose) => return self.pose(&KeyPath::section("camera").key("mount"), pose),
        };
        // Columns are x_C, y_C, z_C in F.
        let R_FC = match name {
            MountName::OpticalAxisZ | MountName::RosOptical => Matrix3::identity(),
            MountName::OpticalAxisX => Matrix3::new(
                0.0, 0.0, 1.0, //
                0.0, -1.0, 0.0, //
                1.0, 0.0, 0.0,
            ),
            MountName::RosBody => Matrix3::new(
                0.0, 0.0, 1.0, //
                -1.0, 0.0, 0.0, //
                0.0, -1.0, 0.0,
            ),
            MountName::OpenGl => Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)),
        };
        let R_FC = Rotation3::from_matrix_unchecked(R_FC);
        Pose::from_parts([0.0; 3].into(), UnitQuaternion::from_rotation_matrix(&R_FC))
    }
}
