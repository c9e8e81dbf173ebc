//! Camera files keep every digit, look as the other tools' own, and say what is wrong with them.
#![allow(clippy::unwrap_used, reason = "a test")]

use std::path::Path;

use calipose::camera::{Camera, Lens};
use calipose::formats::{CameraFormat, read_camera};
use calipose::problem::{Problem, STARTER};
use miette::{GraphicalReportHandler, GraphicalTheme};

fn camera(lens: Lens) -> Camera {
    let coefficients: &[f64] = match lens {
        Lens::Pinhole => &[],
        Lens::BrownConrady => &[-0.2, 0.05, 1.0 / 3000.0, -1e-7, 1.0 / 3.0],
        Lens::Rational => &[-0.2, 0.05, 1e-3, -1e-7, 0.01, 0.02, -1e-20, 0.1],
        Lens::KannalaBrandt => &[0.01, -0.002, 1.0 / 3000.0, -1e-7],
    };
    let intrinsics = [&[1000.0, 2999.0 / 3.0, 641.25, 359.5], coefficients].concat();
    Camera::new(lens, 1280, 720, &intrinsics).unwrap()
}

#[test]
fn every_camera_survives_every_format_that_has_its_lens() {
    for lens in Lens::ALL {
        for format in CameraFormat::ALL {
            let name = format!("{}_{}", format.name(), lens.name());
            match format.write(&camera(lens)) {
                Ok(text) => {
                    assert_eq!(read_camera(&text).unwrap(), camera(lens), "{name}");
                    assert_eq!(read_camera(&text.replace('\n', "\r\n")).unwrap(), camera(lens), "{name}");
                    insta::assert_snapshot!(name, text);
                }
                Err(error) => {
                    assert_eq!((format, lens), (CameraFormat::Mrcal, Lens::KannalaBrandt));
                    assert_eq!(error.to_string(), "the format \"mrcal\" has no lens model \"kannala-brandt\"");
                }
            }
        }
    }
}

#[test]
fn files_of_the_tools_themselves_are_read() {
    // As OpenCV's calibration sample writes it.
    let opencv = "%YAML:1.0\n---\ncalibration_time: \"Mon Nov  2\"\nnr_of_frames: 5\nimage_width: 640\nimage_height: 480\n\
                  fisheye_model: 0\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ \
                  6.5746697810243404e+02, 0., 3.1950000000000000e+02, 0.,\n       6.5746697810243404e+02, \
                  2.3950000000000000e+02, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   \
                  dt: d\n   data: [ -4.1802327018241026e-01, 5.0715243805833121e-01, 0., 0.,\n       \
                  -5.7843596847939704e-01 ]\n";
    let camera = read_camera(opencv).unwrap();
    assert_eq!(camera.intrinsics()[..4], [657.466_978_102_434, 657.466_978_102_434, 319.5, 239.5]);
    assert_eq!(camera.intrinsics()[8], -0.578_435_968_479_397);
    // As mrcal writes it, with the solve it came from.
    let mrcal = "# generated\n{\n    'lensmodel':  'LENSMODEL_OPENCV4',\n\n    'intrinsics': [ 1761.1, 1761.2, 1965.7, \
                 1087.5, -0.01, 0.03, -0.0002, 0.0005,],\n    'extrinsics': [ 0, 0, 0, 0, 0, 0,],\n    'imagersize': [ \
                 4000, 2200,],\n    'icam_intrinsics': 0,\n    'optimization_inputs': b'P)h>@6aWAK}{#2m$~A',\n}\n";
    let camera = read_camera(mrcal).unwrap();
    assert_eq!(camera.lens(), Lens::BrownConrady);
    assert_eq!(camera.intrinsics(), [1761.1, 1761.2, 1965.7, 1087.5, -0.01, 0.03, -0.0002, 0.0005, 0.0]);
    // OpenCV's rational model with the zeros of the models beyond it.
    let json = CameraFormat::OpenCvJson.write(&self::camera(Lens::Rational)).unwrap();
    let longer = json.replace("\"cols\": 8", "\"cols\": 14").replace("0.1]", "0.1, 0, 0, 0, 0, 0, 0]");
    assert_eq!(read_camera(&longer).unwrap(), self::camera(Lens::Rational));
}

/// Format, what to replace (must occur), and the replacement.
const WRONG: &[(CameraFormat, &str, &str)] = &[
    (CameraFormat::Ros, "image_width: 1280", "image_width: wide"),
    (CameraFormat::Ros, "image_width: 1280", "image_width: 1280.5"),
    (CameraFormat::Ros, "image_width: 1280", "image_width: 0"),
    (CameraFormat::Ros, "image_width: 1280", "image_width: 1e12"),
    (CameraFormat::Ros, "image_width: 1280\n", ""),
    (CameraFormat::Ros, "image_width: 1280", "image_width: 1280\nimage_width: 1280"),
    (CameraFormat::Ros, "plumb_bob", "thin_prism"),
    (CameraFormat::Ros, "plumb_bob", "equidistant"),
    (CameraFormat::Ros, "[1000.0, 0.0", "[-1000.0, 0.0"),
    (CameraFormat::Ros, "[1000.0, 0.0", "[nan, 0.0"),
    (CameraFormat::Ros, "[1000.0, 0.0", "[\"1000\", 0.0"),
    (CameraFormat::Ros, "[1000.0, 0.0", "[1000.0, 0.5"),
    (CameraFormat::Ros, "641.25", "1281.25"),
    (CameraFormat::Ros, "-0.2", "-2e300"),
    (CameraFormat::OpenCv, "cols: 5", "cols: 4"),
    (CameraFormat::OpenCv, "dt: d\n   data: [-0.2, ", "dt: d\n   data: [-0.2, 1, "),
    (CameraFormat::OpenCv, "image_width", "fisheye_model: 1\nimage_width"),
    (CameraFormat::OpenCv, "camera_matrix", "K"),
    (CameraFormat::OpenCvJson, "}\n}\n", "}\n"),
    (CameraFormat::OpenCvJson, "}\n}\n", "}\n}}\n"),
    (CameraFormat::Mrcal, "LENSMODEL_OPENCV5", "LENSMODEL_CAHVOR"),
    (CameraFormat::Mrcal, "LENSMODEL_OPENCV5", "LENSMODEL_OPENCV8"),
    (CameraFormat::Mrcal, "[1280, 720]", "[1280]"),
    (CameraFormat::Mrcal, "[1280, 720]", "1280"),
];

#[test]
fn mistakes_are_named_with_line_and_value() {
    let mut messages = vec![read_camera("").unwrap_err().to_string(), read_camera("text").unwrap_err().to_string()];
    for (format, right, wrong) in WRONG {
        let text = format.write(&camera(Lens::BrownConrady)).unwrap();
        assert!(text.contains(right), "{right}");
        let error = read_camera(&text.replacen(right, wrong, 1)).unwrap_err();
        messages.push(format!("{}: {right:?} → {wrong:?}\n    {error}", format.name()));
    }
    insta::assert_snapshot!(messages.join("\n"));
}

#[test]
fn files_cut_short_give_an_answer() {
    for format in CameraFormat::ALL {
        let text = format.write(&camera(Lens::BrownConrady)).unwrap();
        for end in 0..text.len() {
            let _ = read_camera(&text[..end]);
        }
    }
}

/// The starter with its camera in a file beside it.
fn problem_with(folder: &Path, camera_section: &str) -> Result<Problem, String> {
    let start = STARTER.find("[camera]").unwrap();
    let end = STARTER.find("[target]").unwrap();
    let text = format!("{}{camera_section}\n{}", &STARTER[..start], &STARTER[end..]);
    Problem::parse(&text, &folder.join("arm.toml")).map_err(|error| {
        let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
            .with_width(110)
            .without_syntax_highlighting();
        let mut drawing = String::new();
        handler.render_report(&mut drawing, &error).unwrap();
        drawing.replace(&*folder.to_string_lossy(), "FOLDER")
    })
}

#[test]
fn problem_files_take_their_camera_from_a_file_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    for format in CameraFormat::ALL {
        std::fs::write(folder.path().join("camera"), format.write(&camera(Lens::Rational)).unwrap()).unwrap();
        let problem = problem_with(folder.path(), "[camera]\nfile = \"camera\"\n").unwrap();
        assert_eq!(problem.camera, camera(Lens::Rational));
        assert_eq!(problem.estimated.len(), 12);
    }
}

#[test]
fn problem_files_with_a_wrong_camera_file_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| std::fs::write(folder.path().join(name), text).unwrap();
    let ros = CameraFormat::Ros.write(&camera(Lens::BrownConrady)).unwrap();
    write("good", ros.as_bytes());
    write("bad", ros.replace("1280", "-1280").as_bytes());
    write("folds", ros.replace("[-0.2", "[-20").as_bytes());
    write("bytes", b"a\n\xff");
    let sections = [
        "[camera]\nfile = \"none\"\n",
        "[camera]\nfile = \"bad\"\n",
        "[camera]\nfile = \"folds\"\n",
        "[camera]\nfile = \"bytes\"\n",
        "[camera]\nfile = \".\"\n",
        "[camera]\nfile = \"good\"\nfx_px = 500\n[camera.distortion]\nmodel = \"none\"\n",
        "[camera]\n",
    ];
    let drawings = sections.map(|section| problem_with(folder.path(), section).unwrap_err());
    insta::assert_snapshot!(drawings.join("\n"));
}
