//! Camera files keep every digit, look as the other tools' own, and say what is wrong with them.

use std::path::Path;
use std::process::Command;

use calipose::camera::{Camera, Lens};
use calipose::feasibility::{Rejection, feasible_views};
use calipose::formats::{CameraFormat, ReadError, StatedCamera};
use calipose::problem::{Problem, STARTER};
use miette::{GraphicalReportHandler, GraphicalTheme};

fn read_camera(text: &str) -> Result<Camera, ReadError> {
    calipose::formats::read_camera(text, &StatedCamera::default())
}

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
                    let expected = match (format, lens) {
                        (CameraFormat::Mrcal, Lens::KannalaBrandt) => {
                            "the format \"mrcal\" has no lens model \"kannala-brandt\""
                        }
                        (CameraFormat::Kalibr, Lens::Rational) => {
                            "the format \"kalibr\" has no lens model \"rational\""
                        }
                        (CameraFormat::Kalibr, Lens::BrownConrady) => {
                            "the format \"kalibr\" cannot hold k3 = 0.3333333333333333"
                        }
                        other => panic!("{other:?}"),
                    };
                    assert_eq!(error.to_string(), expected);
                }
            }
        }
    }
}

#[test]
fn kalibr_holds_a_brown_conrady_lens_without_k3() {
    let θ = [1000.0, 2999.0 / 3.0, 641.25, 359.5, -0.2, 0.05, 1.0 / 3000.0, -1e-7, 0.0];
    let camera = Camera::new(Lens::BrownConrady, 1280, 720, &θ).unwrap();
    let text = CameraFormat::Kalibr.write(&camera).unwrap();
    assert_eq!(read_camera(&text).unwrap(), camera);
    insta::assert_snapshot!("kalibr_brown-conrady", text);
    // Kalibr itself refuses a principal point left of the first pixel's centre.
    let outside = camera.with_intrinsics(&[&θ[..2], &[-0.25], &θ[3..]].concat()).unwrap();
    let error = CameraFormat::Kalibr.write(&outside).unwrap_err();
    assert_eq!(error.to_string(), "the format \"kalibr\" cannot hold cx = -0.25");
}

/// The file in tests/data/camera-files.
fn file(name: &str) -> String {
    std::fs::read_to_string(Path::new("tests/data/camera-files").join(name)).unwrap()
}

#[test]
fn files_as_other_people_have_them_are_read() {
    let read = |name: &str| {
        let camera = read_camera(&file(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        (camera.lens(), [camera.width(), camera.height()], camera.intrinsics().to_vec())
    };
    // A message as `ros2 topic echo` prints it, its plumb_bob filled up with zeros.
    let coefficients = [
        -0.030605049803853035,
        0.03520144522190094,
        -0.0001380552421323955,
        -0.0001458827027818188,
        -0.012040487490594387,
    ];
    let θ = [&[691.0, 691.0, 639.0, 401.0], &coefficients[..]].concat();
    assert_eq!(read("topic-echo-plumb-bob-8.yaml"), (Lens::BrownConrady, [1280, 800], θ));
    // Without k3, with rows as lists, and with a skew that is rounding.
    let θ = |k1, k2, p1, p2, k3| vec![915.0, 915.0, 640.5, 360.5, k1, k2, p1, p2, k3];
    let expected = (Lens::BrownConrady, [1280, 720], θ(-0.05, 0.02, 0.001, -0.001, 0.0));
    for name in ["plumb-bob-4.yaml", "rows-nested.yaml", "skew-tiny.yaml"] {
        assert_eq!(read(name), expected, "{name}");
    }
    let rational = [915.0, 915.0, 640.5, 360.5, 0.1, -0.05, 0.001, -0.001, 0.01, 0.2, 0.01, 0.001];
    assert_eq!(read("rational-14-trailing-zeros.yaml"), (Lens::Rational, [1280, 720], rational.to_vec()));
    let kalibr = [
        461.487246372674,
        460.1113992557959,
        356.39105303227853,
        231.15719697054647,
        -0.0016509958435871643,
        0.02437222940989351,
        -0.03582816956989852,
        0.019860839087717054,
    ];
    assert_eq!(read("kalibr-camchain.yaml"), (Lens::KannalaBrandt, [752, 480], kalibr.to_vec()));
    let xml = [
        3067.0601055435177,
        3073.7503993310925,
        541.6838478012354,
        536.91339052892795,
        -0.16114330409319458,
        0.0,
        -2.2729685301187963e-3,
        -3.6581288200174624e-3,
        0.0,
    ];
    assert_eq!(read("opencv.xml"), (Lens::BrownConrady, [1080, 1080], xml.to_vec()));
}

#[test]
fn a_stereo_file_has_two_cameras_and_no_image_size() {
    let text = file("opencv-stereo-without-size.yml");
    let read = |image, name: Option<&str>| {
        calipose::formats::read_camera(&text, &StatedCamera { image, name: name.map(str::to_owned) })
    };
    let left = read(Some([640, 480]), None).unwrap();
    assert_eq!(
        left.intrinsics()[..5],
        [534.8032684505131, 534.8032684505131, 335.68643204394891, 240.66183054066337, 0.29589439552724328]
    );
    assert_eq!(read(Some([640, 480]), Some("M1")).unwrap(), left);
    let right = read(Some([640, 480]), Some("M2")).unwrap();
    assert_eq!(right.intrinsics()[2..5], [334.55744527912015, 242.053245733766, -0.16916358306948096]);
    let message = |found: Result<Camera, ReadError>| found.unwrap_err().to_string();
    assert_eq!(
        message(read(None, None)),
        "line 2: this format does not state the image size; it must be given separately"
    );
    assert_eq!(message(read(Some([640, 480]), Some("M3"))), "line 2: there is no camera \"M3\"; the file has M1, M2");
}

#[test]
fn a_chain_of_several_cameras_needs_a_name() {
    let one = file("kalibr-camchain.yaml");
    let two = format!("{one}{}", one.replace("cam0", "cam1").replace("752", "640"));
    let read = |text: &str, name: &str| {
        calipose::formats::read_camera(text, &StatedCamera { image: None, name: Some(name.to_owned()) })
    };
    assert_eq!(
        read_camera(&two).unwrap_err().to_string(),
        "line 1: the file has the cameras cam0, cam1; name one of them"
    );
    assert_eq!(read(&two, "cam1").unwrap().width(), 640);
    assert_eq!(read(&one, "cam0").unwrap(), read_camera(&one).unwrap());
    let ros = CameraFormat::Ros.write(&camera(Lens::Pinhole)).unwrap();
    assert_eq!(
        read(&ros, "cam1").unwrap_err().to_string(),
        "line 1: there is no camera \"cam1\"; the file has a single camera, which needs no name"
    );
}

#[test]
fn messages_of_ros_1_and_2_and_euroc_files_are_read() {
    let ros1 = "header: \n  seq: 0\n  frame_id: \"camera\"\nheight: 480\nwidth: 640\ndistortion_model: \"rational_polynomial\"\nD: \
                [0.1, -0.05, 0.001, -0.001, 0.01]\nK: [500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0]\nbinning_x: 1\nroi: \n  \
                x_offset: 0\n  height: 480\n  width: 640\n---\nheader: \n  seq: 1\n";
    let camera = read_camera(ros1).unwrap();
    assert_eq!(camera.lens(), Lens::Rational);
    assert_eq!(camera.intrinsics(), [500.0, 501.0, 320.0, 240.0, 0.1, -0.05, 0.001, -0.001, 0.01, 0.0, 0.0, 0.0]);
    let binned = read_camera(&ros1.replace("binning_x: 1", "binning_x: 2")).unwrap_err().to_string();
    assert!(binned.starts_with("line 9: `binning_x` is 2: the images are not those"), "{binned}");
    let cut = read_camera(&ros1.replace("  width: 640", "  width: 320")).unwrap_err().to_string();
    assert!(cut.starts_with("line 13: `roi.width` is 320: the images are not those"), "{cut}");
    let euroc = "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1]\nresolution: [752, 480]\ncamera_model: \
                 pinhole\nintrinsics: [458.654, 457.296, 367.215, 248.375]\ndistortion_model: radial-tangential\n\
                 distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]\n";
    let camera = read_camera(euroc).unwrap();
    assert_eq!(camera.intrinsics(), [458.654, 457.296, 367.215, 248.375, -0.28, 0.07, 0.0002, 0.00002, 0.0]);
}

/// A message whose model and coefficients are to be replaced.
const MESSAGE: &str =
    "height: 480\nwidth: 640\ndistortion_model: MODEL\nd: LIST\nk: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n";

#[test]
fn what_cannot_be_read_is_named_with_what_to_do() {
    let kalibr = file("kalibr-camchain.yaml");
    let projection = file("projection-parameters.yaml");
    let message = |model: &str, list: &str| MESSAGE.replace("MODEL", model).replace("LIST", list);
    let rational = CameraFormat::OpenCv.write(&camera(Lens::Rational)).unwrap();
    let mrcal = CameraFormat::Mrcal.write(&camera(Lens::Pinhole)).unwrap();
    let texts = [
        file("commas-missing.yaml"),
        message("plumb_bob", "0.1 0.2 0 0 0"),
        message("plumb_bob", "[0.1, 0.2, 0.0 0.0]"),
        file("videre.ini"),
        projection.clone(),
        projection.replace("PINHOLE", "KANNALA_BRANDT"),
        projection.replace("PINHOLE", "MEI"),
        "%YAML:1.0\nCamera.type: \"PinHole\"\nCamera.fx: 500.0\n".into(),
        "{\"value0\": {\"intrinsics\": [{\"camera_type\": \"ds\"}]}}".into(),
        "%YAML:1.0\n---\nK: [500, 0, 320, 0, 500, 240, 0, 0, 1]\nD: [0, 0, 0, 0]\nxi: 1.5\n".into(),
        file("opencv.xml").replace("</opencv_storage>", "<xi>1.5</xi></opencv_storage>"),
        kalibr.replace("camera_model: pinhole", "camera_model: omni"),
        kalibr.replace("camera_model: pinhole", "camera_model: ds"),
        kalibr.replace("camera_model: pinhole", "camera_model: eucm"),
        kalibr.replace("distortion_model: equidistant", "distortion_model: fov"),
        message("double_sphere", "[]"),
        message("made_up", "[]"),
        message("plumb_bob", "[0.1, 0, 0, 0, 0, 0.2, 0, 0]"),
        message("plumb_bob", "[0.1, 0]"),
        message("equidistant", "[0.1, 0, 0, 0, 0.2]"),
        message("none", "[0.1, 0, 0, 0]"),
        rational.replace("cols: 8", "cols: 12").replace("0.1]", "0.1, 0.003, 0, 0, 0]"),
        mrcal.replace("LENSMODEL_PINHOLE", "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18_fov_x_deg=150"),
        mrcal.replace("LENSMODEL_PINHOLE", "LENSMODEL_OPENCV12"),
        message("plumb_bob", "[]").replace("[500, 0,", "[500, 0.5,"),
        file("opencv.xml").replace("opencv_storage", "calibration"),
        file("opencv.xml").replace("<rows>3", "<rows>4"),
        file("opencv.xml").replace("5.4168384780123540e+02", "5.4e+03"),
        file("opencv.xml").replace("</opencv_storage>", ""),
    ];
    let errors: Vec<String> = texts.iter().map(|text| read_camera(text).unwrap_err().to_string()).collect();
    insta::assert_snapshot!(errors.join("\n"));
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
    // A fisheye as OpenCV 5.0.0 writes it in XML.
    let xml = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<calibration_time>\"Wed Nov 25\"</calibration_time>\n\
               <image_width>640</image_width>\n<image_height>480</image_height>\n<fisheye_model>1</fisheye_model>\n<camera_matrix \
               type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n  <data>\n    300.5 0. 320.25 0. 301. \
               240. 0. 0. 1.</data></camera_matrix>\n<distortion_coefficients type_id=\"opencv-matrix\">\n  <rows>4</rows>\n  \
               <cols>1</cols>\n  <dt>d</dt>\n  <data>\n    0.01 -0.002 0.00033333333333333332 \
               -9.9999999999999995e-08</data></distortion_coefficients>\n<img_points type_id=\"opencv-matrix\">\n  \
               <rows>1</rows>\n  <cols>2</cols>\n  <dt>\"2f\"</dt>\n  <data>\n    1. 1. 1. 1.</data></img_points>\n</opencv_storage>\n";
    let camera = read_camera(xml).unwrap();
    assert_eq!(camera.lens(), Lens::KannalaBrandt);
    assert_eq!(camera.intrinsics(), [300.5, 301.0, 320.25, 240.0, 0.01, -0.002, 1.0 / 3000.0, -1e-7]);
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
        let text = format.write(&camera(Lens::Pinhole)).unwrap();
        for end in 0..text.len() {
            let _ = read_camera(&text[..end]);
        }
    }
    let xml = file("opencv.xml");
    for end in 0..xml.len() {
        assert!(read_camera(&xml[..end]).is_err() || xml[end..].trim().is_empty());
    }
}

/// The problem with another camera.
fn with_camera(problem: &str, camera_section: &str) -> String {
    let (start, end) = (problem.find("[camera]").unwrap(), problem.find("[target]").unwrap());
    format!("{}{camera_section}\n{}", &problem[..start], &problem[end..])
}

/// The starter with its camera in a file beside it.
fn problem_with(folder: &Path, camera_section: &str) -> Result<Problem, String> {
    let text = with_camera(STARTER, camera_section);
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
        let lens = if format == CameraFormat::Kalibr { Lens::KannalaBrandt } else { Lens::Rational };
        std::fs::write(folder.path().join("camera"), format.write(&camera(lens)).unwrap()).unwrap();
        let problem = problem_with(folder.path(), "[camera]\nfile = \"camera\"\n").unwrap();
        assert_eq!(problem.camera, camera(lens));
        assert_eq!(problem.estimated.len(), lens.parameter_names().len());
    }
}

#[test]
fn what_a_camera_file_leaves_open_stands_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let kalibr = file("kalibr-camchain.yaml");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("stereo", &file("opencv-stereo-without-size.yml"));
    write("chain", &format!("{kalibr}{}", kalibr.replace("cam0", "cam1").replace("752", "640")));
    write("one", &CameraFormat::Ros.write(&camera(Lens::BrownConrady)).unwrap());
    let read = |section: &str| problem_with(folder.path(), &format!("[camera]\n{section}\n"));
    let right = read("file = \"stereo\"\nfile_camera = \"M2\"\nwidth_px = 640\nheight_px = 480").unwrap().camera;
    assert_eq!((right.width(), right.height(), right.intrinsics()[2]), (640, 480, 334.55744527912015));
    assert_eq!(read("file = \"chain\"\nfile_camera = \"cam1\"").unwrap().camera.width(), 640);
    assert_eq!(read("file = \"one\"\nwidth_px = 1280\nheight_px = 720").unwrap().camera, camera(Lens::BrownConrady));
    let sections = [
        "file = \"stereo\"",
        "file = \"stereo\"\nwidth_px = 640",
        "file = \"chain\"",
        "file = \"chain\"\nfile_camera = \"left\"",
        "file = \"one\"\nwidth_px = 640\nheight_px = 480",
        "file_camera = \"cam0\"\nwidth_px = 640\nheight_px = 480\nfx_px = 500",
    ];
    let drawings = sections.map(|section| read(section).unwrap_err());
    insta::assert_snapshot!(drawings.join("\n"));
}

/// The share of the picture that the camera of the problem reaches.
fn coverage(folder: &Path, section: &str) -> f64 {
    problem_with(folder, section).unwrap().camera.coverage()
}

#[test]
fn lenses_whose_image_ends_inside_the_picture_are_cameras() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("circle"), file("fisheye-circle-inside-image.yaml")).unwrap();
    let from_file = problem_with(folder.path(), "[camera]\nfile = \"circle\"\n").unwrap();
    let (camera, fold) = (&from_file.camera, from_file.camera.fold().unwrap());
    // The circle's radii: f times the image of the fold, where the polynomial of the angle is greatest.
    let [k1, k2, k3, k4] = [-0.04156829922631219, 0.003148064508982229, -0.002398270284813955, 2.382178188003908e-05];
    let image = |θ: f64| θ * (1.0 + θ * θ * (k1 + θ * θ * (k2 + θ * θ * (k3 + θ * θ * k4))));
    let greatest = (0..314_159).map(|i| image(f64::from(i) * 1e-5)).fold(0.0, f64::max);
    assert!((image(fold) - greatest).abs() < 1e-9);
    let ellipse = |u: f64, v: f64| ((u - 481.33979) / 304.34908).hypot((v - 316.46477) / 324.77726) <= greatest;
    let pixels = (0..960 * 640).filter(|i| ellipse(f64::from(i % 960), f64::from(i / 960)));
    let share = pixels.count() as f64 / (960.0 * 640.0);
    assert!((0.5..0.95).contains(&share), "{share}");
    assert!((camera.coverage() - share).abs() < 0.01, "{} {share}", camera.coverage());
    // The same stated by the problem file, and a lens of the perspective kind that folds back before the picture's corners.
    let stated = "[camera]\nwidth_px = 960\nheight_px = 640\nfx_px = 304.3\nfy_px = 324.8\n[camera.distortion]\nmodel = \
                  \"kannala-brandt\"\nk1 = -0.0416\nk2 = 0.00315\nk3 = -0.0024\n";
    assert!((coverage(folder.path(), stated) - share).abs() < 0.02);
    // The program says so.
    std::fs::write(folder.path().join("stated.toml"), with_camera(&STARTER.replace("200_000", "300"), stated)).unwrap();
    let check = Command::new(env!("CARGO_BIN_EXE_calipose"))
        .arg("check")
        .arg(folder.path().join("stated.toml"))
        .output()
        .unwrap();
    let told = String::from_utf8(check.stdout).unwrap();
    let percent = format!(
        "Lens: kannala-brandt, 960 x 640 px, and reaches {:.0} % of the picture, up to",
        100.0 * coverage(folder.path(), stated)
    );
    assert!(told.contains(&percent), "{told}");
    let barrel = "[camera]\nwidth_px = 1280\nheight_px = 960\nfx_px = 700\n[camera.distortion]\nmodel = \"brown-conrady\"\nk1 = -0.3\n";
    let share = coverage(folder.path(), barrel);
    assert!((0.6..0.8).contains(&share), "{share}");
}

#[test]
fn problem_files_with_a_wrong_camera_file_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| std::fs::write(folder.path().join(name), text).unwrap();
    let fisheye = CameraFormat::Ros.write(&camera(Lens::KannalaBrandt)).unwrap();
    let ros = CameraFormat::Ros.write(&camera(Lens::BrownConrady)).unwrap();
    write("good", ros.as_bytes());
    write("bad", ros.replace("1280", "-1280").as_bytes());
    write("folds", ros.replace("[-0.2", "[-20").as_bytes());
    write("small circle", fisheye.replace("[0.01, -0.002,", "[-30, -0.002,").as_bytes());
    write("bytes", b"a\n\xff");
    let sections = [
        "[camera]\nfile = \"none\"\n",
        "[camera]\nfile = \"bad\"\n",
        "[camera]\nfile = \"folds\"\n",
        "[camera]\nfile = \"small circle\"\n",
        "[camera]\nfile = \"bytes\"\n",
        "[camera]\nfile = \".\"\n",
        "[camera]\nfile = \"good\"\nfx_px = 500\n[camera.distortion]\nmodel = \"none\"\n",
        "[camera]\n",
    ];
    let drawings = sections.map(|section| problem_with(folder.path(), section).unwrap_err());
    insta::assert_snapshot!(drawings.join("\n"));
}

#[test]
fn no_view_has_corners_beyond_the_image_circle() {
    // Folds back at √(1 / 1.2) = 52.3°, whose circle has a radius of two thirds of that: 365 of the 480 px to the nearest border.
    let section = "[camera]\nwidth_px = 1280\nheight_px = 960\nfx_px = 600\n[camera.distortion]\nmodel = \"kannala-brandt\"\nk1 = \
                   -0.4\n";
    let text = with_camera(&STARTER.replace("200_000", "20_000"), section);
    let problem = Problem::parse(&text, Path::new("arm.toml")).unwrap();
    let fold = (1.0f64 / 1.2).sqrt();
    assert!((problem.camera.fold().unwrap() - fold).abs() < 1e-9);
    let all = (0..problem.space.len()).collect();
    let (views, rejected) = feasible_views(&problem.checks(), &problem.space, &all);
    assert!(views.len() > 100 && rejected[Rejection::BeyondLens as usize] > 100, "{} {rejected:?}", views.len());
    for view in &views {
        for corner in problem.target.board.corners() {
            let p = view.X_CT * corner;
            assert!(p.x.hypot(p.y).atan2(p.z) <= fold);
            let pixel = problem.camera.project(&p).unwrap();
            assert!((pixel.x - 639.5).hypot(pixel.y - 479.5) <= 600.0 * fold * 2.0 / 3.0 + 1e-6);
        }
    }
}

#[test]
fn a_circular_fisheye_that_is_calibrated_here_is_a_camera_here() {
    let folder = tempfile::tempdir().unwrap();
    let vnl = std::fs::canonicalize("tests/data/circular-fisheye.vnl").unwrap();
    let calibrate = Command::new(env!("CARGO_BIN_EXE_calipose"))
        .current_dir(&folder)
        .args(["calibrate", "--board", "7x6", "--square-mm", "25", "--image", "1280x1024", "--lens", "kannala-brandt"])
        .arg(vnl)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&calibrate.stdout);
    assert!(told.contains("RMS 0.3088"), "{told} {}", String::from_utf8_lossy(&calibrate.stderr));
    for name in ["camera_info.yaml", "camchain.yaml", "camera.opencv.yaml"] {
        let section = format!("[camera]\nfile = \"calibration/{name}\"\n");
        let problem = problem_with(folder.path(), &section).unwrap();
        assert!((0.2..0.9).contains(&problem.camera.coverage()), "{}", problem.camera.coverage());
    }
}
