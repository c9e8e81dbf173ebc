//! From the problem file's schema to the models: every check, and every conversion of units.

mod bodies;
mod camera;
mod dh_table;
mod scene;
mod selection;
mod sweep;
mod target;
mod urdf;

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use nalgebra::{Quaternion, UnitQuaternion};

use super::fault::{Allowed, Fault, Reason};
use super::schema::Numbers;
use super::text::{self, Document, KeyPath};
use super::{Note, Overrides, Problem, schema};
use crate::calibration::FEWEST_CORNERS;
use crate::camera::{Camera, Lens};
use crate::feasibility::VisibilityLimits;
use crate::robot::JointKind;
use crate::spatial::Pose;

/// Lengths and positions in mm: a kilometre is a slip of the pen.
const LENGTH: Allowed = Allowed::between(-1e6, 1e6);
/// Sizes and distances in mm.
const SIZE: Allowed = Allowed::positive(1e6);
/// Standard deviations of a corner in px: from that of no detector to the size of a picture.
const NOISE: Allowed = Allowed::between(1e-6, 1e3);
/// Angles in degrees: ten turns.
const ANGLE: Allowed = Allowed::between(-3600.0, 3600.0);

/// The problem that `file` states, or everything found wrong with it. `path` names a problem that has no name, and is where
/// other files are sought from.
pub(super) fn resolve(document: &Document, file: &schema::File, path: &Path) -> Result<Problem, Vec<Fault>> {
    let mut check = Check { document, faults: Vec::new(), notes: Vec::new() };
    let stem = path.file_stem().map(std::ffi::OsStr::to_string_lossy).unwrap_or_default();
    let name = check.name(file.name.as_deref(), &stem);
    let output = check.output(&file.output, &name);
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut robot = match &file.robot.urdf {
        Some(urdf) => check.described_robot(file, urdf, folder),
        None => check.robot(file),
    };
    check.scene(&file.scene, robot.as_mut());
    let camera = check.camera(&file.camera, folder);
    let target = check.target(&file.target);
    let thickness = check.length(&KeyPath::section("target").key("thickness_mm"), file.target.thickness_mm, SIZE);
    if let (Some(robot), Some(target)) = (&mut robot, &target) {
        Check::board(target, thickness, robot.board_link, &mut robot.tree);
    }
    let clearance = check.collision(&file.collision, robot.as_mut().map(|robot| &mut robot.tree));
    let stability = check.stability(file.stability.as_ref(), robot.as_ref().map(|robot| &robot.tree));
    let visibility = check.visibility(&file.visibility, u64::from(file.target.columns) * u64::from(file.target.rows));
    let noise = check.number(&KeyPath::section("noise").key("sigma_px"), file.noise.sigma_px, NOISE);
    // Without its camera file the names of the lens's intrinsics are not known.
    let lens = camera.as_ref().map(Camera::lens).or_else(|| file.camera.stated_lens());
    let estimated = lens.map(|lens| check.estimated(&file.estimate, lens)).unwrap_or_default();
    let names: Vec<&str> =
        lens.map(|lens| estimated.iter().map(|&i| lens.parameter_names()[i]).collect()).unwrap_or_default();
    let prior_sigma = check.prior_sigma(&file.estimate, camera.as_ref(), &estimated, &names, noise);
    let selection = check.selection(&file.selection, &names);
    let joints = robot.as_ref().map(|robot| robot.chain.joints.as_slice()).unwrap_or_default();
    let constraints = check.constraints(&file.constraints, joints);
    check.unconstrained_method(selection.goal.method(), &constraints);
    // The size of the sweep means something only once the limits do.
    let space = robot.as_ref().and_then(|robot| check.space(&file.sweep, robot));
    let published = check.published(&file.sweep);
    let joints = robot.as_ref().map(|robot| robot.chain.joints.as_slice()).unwrap_or_default();
    let refinement = check.refinement(&file.sweep, joints);
    if let (Some(space), Some(count)) = (&space, selection.goal.count()) {
        let path = KeyPath::section("selection").key("count");
        check.number(&path, count as f64, Allowed::between(1.0, space.len() as f64));
    }
    match (robot, camera, target, space) {
        (Some(robot), Some(camera), Some(target), Some(space)) if check.faults.is_empty() => Ok(Problem {
            name,
            sha256: String::new(),
            overrides: Overrides::new(),
            robot,
            camera,
            target,
            space,
            refinement,
            published,
            axis: file.sweep.axis.0,
            visibility,
            clearance,
            stability,
            noise,
            estimated,
            prior_sigma,
            selection,
            constraints,
            output,
            notes: check.notes,
        }),
        _ => Err(check.faults),
    }
}

/// The faults and notes found so far. A check returns its value in SI units even where it is wrong, so that the next can run.
struct Check<'d, 'a> {
    document: &'d Document<'a>,
    faults: Vec<Fault>,
    notes: Vec<Note>,
}

impl Check<'_, '_> {
    fn fault(&mut self, path: &KeyPath, reason: Reason) {
        self.faults.push(text::fault(self.document, path, reason));
    }

    /// What the user should know about the key at `path`, or the file it names.
    fn note(&mut self, path: &KeyPath, text: String) {
        self.notes.push(Note { key: path.to_string(), text });
    }

    /// `value`, which must be `allowed`.
    fn number(&mut self, path: &KeyPath, value: f64, allowed: Allowed) -> f64 {
        if !allowed.contains(value) {
            self.fault(path, Reason::OutOfRange { value, allowed });
        }
        value
    }

    /// `value` in mm as m.
    fn length(&mut self, path: &KeyPath, value: f64, allowed: Allowed) -> f64 {
        self.number(path, value, allowed) / 1e3
    }

    /// `value` in degrees as rad.
    fn angle(&mut self, path: &KeyPath, value: f64, allowed: Allowed) -> f64 {
        self.number(path, value, allowed).to_radians()
    }

    fn pose(&mut self, path: &KeyPath, pose: &schema::Pose) -> Pose {
        let at = path.key("position_mm");
        let mut position = pose.position_mm.0;
        for (i, p) in position.iter_mut().enumerate() {
            *p = self.length(&at.at(i), *p, LENGTH);
        }
        let rotation = match (pose.rpy_deg, pose.quaternion_xyzw) {
            (None, None) => UnitQuaternion::identity(),
            (Some(Numbers(rpy)), None) => {
                let at = path.key("rpy_deg");
                let mut angle = |i: usize| self.angle(&at.at(i), rpy[i], ANGLE);
                let (roll, pitch, yaw) = (angle(0), angle(1), angle(2));
                UnitQuaternion::from_euler_angles(roll, pitch, yaw)
            }
            (None, Some(Numbers([x, y, z, w]))) => {
                let quaternion = Quaternion::new(w, x, y, z);
                let norm = quaternion.norm();
                // Files round; anything farther off is not meant as a rotation.
                if (norm - 1.0).abs() <= 1e-3 {
                    UnitQuaternion::new_normalize(quaternion)
                } else {
                    self.fault(&path.key("quaternion_xyzw"), Reason::NotUnit { norm });
                    UnitQuaternion::identity()
                }
            }
            (Some(_), Some(_)) => {
                self.fault(&path.key("quaternion_xyzw"), Reason::Conflict { with: "rpy_deg".into() });
                UnitQuaternion::identity()
            }
        };
        Pose::from_parts(position.into(), rotation)
    }

    fn name(&mut self, name: Option<&str>, stem: &str) -> String {
        let name = name.unwrap_or(stem).trim();
        if name.is_empty() {
            self.fault(&KeyPath::section("name"), Reason::Empty);
        }
        name.to_owned()
    }

    fn output(&mut self, output: &schema::Output, name: &str) -> PathBuf {
        match &output.folder {
            Some(folder) => {
                if folder.trim().is_empty() {
                    self.fault(&KeyPath::section("output").key("folder"), Reason::Empty);
                }
                PathBuf::from(folder)
            }
            None => PathBuf::from("plans").join(slug(name)),
        }
    }

    fn visibility(&mut self, visibility: &schema::Visibility, corners: u64) -> VisibilityLimits {
        let at = KeyPath::section("visibility");
        let fewest = Allowed::between(FEWEST_CORNERS as f64, corners as f64);
        let min_corners = visibility.min_corners.map(u64::from);
        if let Some(least) = min_corners {
            self.number(&at.key("min_corners"), least as f64, fewest);
        }
        let max_distance = &at.key("max_distance_mm");
        let min_distance = self.length(&at.key("min_distance_mm"), visibility.min_distance_mm, NOT_NEGATIVE);
        let allowed = Allowed::between(visibility.min_distance_mm.max(0.0), 1e6);
        VisibilityLimits {
            margin: self.number(&at.key("margin_px"), visibility.margin_px, NOT_NEGATIVE),
            max_incidence: self
                .angle(&at.key("max_incidence_deg"), visibility.max_incidence_deg, Allowed::positive(90.0))
                .min(PI / 2.0),
            max_tilt: self
                .angle(&at.key("max_tilt_deg"), visibility.max_tilt_deg, Allowed::positive(90.0))
                .min(PI / 2.0),
            min_distance,
            max_distance: self.length(max_distance, visibility.max_distance_mm, allowed),
            min_corner_spacing: self.number(
                &at.key("min_corner_spacing_px"),
                visibility.min_corner_spacing_px,
                NOT_NEGATIVE,
            ),
            min_corners: min_corners.filter(|&least| least < corners).map(|least| least as usize),
        }
    }

    /// Indices of the intrinsics to estimate, ascending.
    fn estimated(&mut self, estimate: &schema::Estimate, lens: Lens) -> Vec<usize> {
        let all = lens.parameter_names();
        let Some(names) = &estimate.intrinsics else {
            return (0..all.len()).collect();
        };
        let path = KeyPath::section("estimate").key("intrinsics");
        if names.is_empty() {
            self.fault(&path, Reason::Empty);
        }
        let mut estimated = Vec::new();
        for (i, name) in names.iter().enumerate() {
            match all.iter().position(|known| known == name) {
                Some(index) if estimated.contains(&index) => {
                    self.fault(&path.at(i), Reason::Duplicate { name: name.clone() });
                }
                Some(index) => estimated.push(index),
                None => self.fault(&path.at(i), Reason::UnknownName { name: name.clone(), allowed: owned(all) }),
            }
        }
        estimated.sort_unstable();
        estimated
    }
}

/// Lengths in mm and px that may be 0.
const NOT_NEGATIVE: Allowed = Allowed::between(0.0, 1e6);

/// A joint value in rad or m in the file's unit, to a thousandth.
fn file_unit(kind: JointKind, value: f64) -> f64 {
    (kind.to_display(value) * 1e3).round() / 1e3 + 0.0
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

/// `name` as a folder: lower-case letters and digits, everything else a hyphen.
fn slug(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let slug = words.map(str::to_lowercase).collect::<Vec<_>>().join("-");
    if slug.is_empty() { "plan".into() } else { slug }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_safe_folder_names() {
        assert_eq!(slug("Servosila Engineer, 4-DoF"), "servosila-engineer-4-dof");
        assert_eq!(slug("../../etc"), "etc");
        assert_eq!(slug("°!"), "plan");
    }
}
