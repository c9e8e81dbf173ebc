//! The robot, from a table or a URDF file, with what the problem file puts on it and around it.

mod bodies;
mod dh_table;
mod poses;
mod scene;
mod urdf;

use std::path::Path;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::check::{ANGLE, Check};
use crate::problem::schema::{self, MountName, Named, TextOrTable};
use crate::problem::text::{At, key};
use crate::robot::{Robot, Tree};
use crate::spatial::Pose;
use bodies::Links;

impl Check<'_, '_> {
    /// The robot of `file`, or none if something is wrong with it; other files are sought from `folder`.
    pub(super) fn robot(&mut self, file: &At<schema::File>, folder: &Path) -> Option<Robot> {
        match key!(file, robot.urdf).given() {
            Some(urdf) => self.urdf_robot(file, &urdf, folder),
            None => self.table_robot(file),
        }
    }

    /// Attaches what the problem file adds to the robot: bodies, masses, and the camera's housing.
    fn carried(&mut self, file: &At<schema::File>, X_FC: Pose, camera_link: usize, links: &Links, tree: &mut Tree) {
        self.bodies(&key!(file, robot.bodies), links, tree);
        self.masses(&key!(file, robot.masses), links, tree);
        if let Some(housing) = key!(file, camera.housing).given() {
            self.housing(&housing, X_FC, camera_link, tree);
        }
    }

    /// Pose of the camera on the flange, `X_FC`.
    fn mount(&mut self, camera: &At<schema::Camera>) -> Pose {
        let mount = key!(camera, mount);
        let X_FM = match mount.value {
            TextOrTable::Text(Named(name)) => named_mount(*name),
            TextOrTable::Table(pose) => self.pose(&mount.with(pose)),
        };
        let roll = self.angle(&key!(camera, roll_deg), ANGLE);
        if roll == 0.0 { X_FM } else { X_FM * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), roll) }
    }
}

/// The mount of that name: pose of the camera on the flange.
fn named_mount(name: MountName) -> Pose {
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::problem::{Overrides, Problem};

    #[test]
    fn a_positive_roll_turns_the_cameras_right_towards_its_down() {
        let mounted = |roll: &str| {
            let overrides = Overrides::new().set(&format!("camera.roll_deg={roll}")).unwrap();
            Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap().robot.X_FC.rotation
        };
        let (level, turned) = (mounted("0"), mounted("90"));
        assert!((turned * Vector3::x() - level * Vector3::y()).norm() < 1e-12);
        assert!((turned * Vector3::z() - level * Vector3::z()).norm() < 1e-12);
        assert!((mounted("30") * Vector3::x()).dot(&(level * Vector3::y())) > 0.49);
    }
}
