//! The formats of models.

use super::assembly::Assembly;
use super::assets::Assets;
use super::setup::Setup;
use super::{mjcf, sdf, urdf};
use crate::export::ExportFile;
use crate::export::error::ExportError;
use crate::export::text::file_name;

/// File format of a robot with its camera and board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ModelFormat {
    /// Unified Robot Description Format, of ROS.
    Urdf,
    /// `MuJoCo`'s XML.
    Mjcf,
    /// Simulation Description Format, of Gazebo.
    Sdf,
}

impl ModelFormat {
    /// Every format.
    pub const ALL: [Self; 3] = [Self::Urdf, Self::Mjcf, Self::Sdf];

    /// Name of the format, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
            Self::Sdf => "sdf",
        }
    }

    /// What a file's name ends in.
    fn ending(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf.xml",
            Self::Sdf => "sdf",
        }
    }

    /// The model in this format, and the files that it names, which belong beside it.
    ///
    /// # Errors
    /// Where the tour makes no sense or is not the robot's, or the format has no such robots.
    pub fn write(self, setup: &Setup) -> Result<Vec<ExportFile>, ExportError> {
        setup.check()?;
        let reserved: &[&str] = match self {
            Self::Urdf => &[],
            Self::Mjcf | Self::Sdf => &["world"],
        };
        let assembly = Assembly::new(setup, reserved)?;
        let assets = Assets::new(setup, &assembly);
        let text = match self {
            Self::Urdf => urdf::write(setup, &assembly, &assets),
            Self::Mjcf => mjcf::write(setup, &assembly, &assets),
            Self::Sdf => sdf::write(setup, &assembly, &assets)?,
        };
        let name = file_name(setup.program.name, self.ending());
        let model = ExportFile { name, bytes: text.into_bytes() };
        Ok(std::iter::once(model).chain(assets.files).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Lens};
    use crate::export::model::example::{Example, assert_agrees};
    use crate::target::{Board, Points};

    fn text(files: &[ExportFile]) -> &str {
        std::str::from_utf8(&files[0].bytes).unwrap()
    }

    #[test]
    fn models_are_those_written_by_hand() {
        let example = Example::new();
        let program = example.program();
        let setup = example.setup(&program);
        for (format, expected) in [
            (ModelFormat::Urdf, include_str!("expected/lift_arm.urdf")),
            (ModelFormat::Mjcf, include_str!("expected/lift_arm.mjcf.xml")),
            (ModelFormat::Sdf, include_str!("expected/lift_arm.sdf")),
        ] {
            let files = format.write(&setup).unwrap();
            assert_agrees(text(&files), expected);
            let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
            let assets = ["board.obj", "board.mtl", "board.png", "hull-1.obj"].map(|end| format!("lift_arm.{end}"));
            assert_eq!(names[1..], assets);
        }
    }

    #[test]
    fn lenses_that_a_format_has_not_are_left_out_with_a_word() {
        let mut example = Example::new();
        for (lens, coefficients, in_mjcf, in_sdf, words) in [
            (Lens::Pinhole, vec![], true, true, ["", ""]),
            (Lens::Rational, vec![0.1; 8], true, true, ["MuJoCo has no distortion", "SDF has no rational distortion"]),
            (Lens::KannalaBrandt, vec![0.0; 4], false, false, ["MuJoCo has no fisheye", "SDF has no fisheye"]),
        ] {
            let θ = [vec![600.0, 600.0, 320.0, 240.0], coefficients].concat();
            example.camera = Camera::new(lens, 640, 480, &θ).unwrap();
            let program = example.program();
            let written = |format: ModelFormat| format.write(&example.setup(&program)).unwrap();
            let (mjcf, sdf) = (written(ModelFormat::Mjcf), written(ModelFormat::Sdf));
            assert_eq!(text(&mjcf).contains("<camera "), in_mjcf);
            assert_eq!(text(&sdf).contains("<sensor "), in_sdf);
            assert!(!text(&sdf).contains("<distortion>"));
            assert!(text(&mjcf).contains(words[0]) && text(&sdf).contains(words[1]), "{}", text(&sdf));
        }
    }

    #[test]
    fn a_board_without_a_pattern_is_a_plain_plate() {
        let mut example = Example::new();
        let points = [([0.0, 0.0], None), ([0.1, 0.0], None), ([0.1, 0.1], None), ([0.0, 0.1], None)];
        example.target.board = Board::Points(Points::new(&points).unwrap());
        let program = example.program();
        let files = ModelFormat::Mjcf.write(&example.setup(&program)).unwrap();
        assert!(files.iter().all(|file| !file.name.ends_with("png")));
        assert!(!text(&files).contains("texture") && text(&files).contains("mesh=\"board\""));
    }

    #[test]
    fn tours_of_other_robots_and_names_of_sdfs_own_are_refused() {
        let example = Example::new();
        let program = example.program();
        let mut joints = program.joints.to_vec();
        joints[1].name = "elbow".into();
        let other = crate::export::Program { joints: &joints, ..program.clone() };
        let error = ModelFormat::Urdf.write(&example.setup(&other)).unwrap_err();
        assert_eq!(error.to_string(), "the tour's joints are not those of the robot");
        let mut example = Example::new();
        example.robot.chain.joints[1].name = "a::b".into();
        joints[1].name = "a::b".into();
        let program = example.program();
        let colons = crate::export::Program { joints: &joints, ..program.clone() };
        assert!(ModelFormat::Mjcf.write(&example.setup(&colons)).is_ok());
        let error = ModelFormat::Sdf.write(&example.setup(&colons)).unwrap_err();
        let expected = "the format \"sdf\" cannot have the name \"a::b\": names must be without \"::\", not \"world\", and not between \
                        \"__\" and \"__\"";
        assert_eq!(error.to_string(), expected);
    }
}
