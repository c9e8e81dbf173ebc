//! Every mistake in a problem file is drawn under its line with what is allowed and a hint. One snapshot a mistake.

use std::path::Path;

use calipose::problem::{Problem, ProblemError};
use miette::{GraphicalReportHandler, GraphicalTheme};

/// A right file; each case changes it in one place.
const RIGHT: &str = r#"name = "Two joints"

[robot]
limits = "wide"

[[robot.joints]]
name = "turn"
a_mm = 300
limits_deg = { narrow = [-10, 10], wide = [-90, 90] }

[[robot.joints]]
name = "slide"
kind = "prismatic"
alpha_deg = 180
limits_mm = [400, 600]

[camera]
width_px = 640
height_px = 480
fx_px = 500

[camera.distortion]
model = "brown-conrady"
k1 = -0.1

[target]
columns = 8
rows = 6
square_mm = 20
pose = { position_mm = [300, 0, 0], rpy_deg = [0, 0, 0] }

[target.zone]
width_mm = 200
height_mm = 150

[sweep]
step_deg = 5
step_mm = 20

[visibility]
margin_px = 5
max_distance_mm = 2000

[noise]
sigma_px = 0.3

[estimate]
intrinsics = ["fx", "fy", "cx", "cy"]

[selection]
count = 10
"#;

/// Name, what to replace (must occur), and the replacement.
const WRONG: &[(&str, &str, &str)] = &[
    ("not_toml", "fx_px = 500", "fx_px = = 500"),
    ("unclosed_text", "name = \"Two joints\"", "name = \"Two joints"),
    ("key_given_twice", "fx_px = 500", "fx_px = 500\nfx_px = 501"),
    ("unknown_key", "fx_px = 500", "fx = 500"),
    ("unknown_key_without_likeness", "sigma_px = 0.3", "zzz = 0.3"),
    ("unknown_section", "[sweep]", "[sweeep]"),
    ("unknown_key_in_a_joint", "a_mm = 300", "r_mm = 300"),
    ("unknown_key_in_an_inline_table", "rpy_deg = [0, 0, 0]", "rpy = [0, 0, 0]"),
    ("unknown_choice", "kind = \"prismatic\"", "kind = \"prismatc\""),
    ("unknown_mount", "[camera]", "[camera]\nmount = \"optical-axis-y\""),
    ("unknown_criterion", "count = 10", "criterion = \"x\""),
    ("unknown_method", "count = 10", "method = \"kmeans\""),
    ("unknown_kind", "[target]\n", "[target]\nkind = \"charucco\"\n"),
    ("key_of_another_kind", "square_mm = 20", "square_mm = 20\nmarker_mm = 15"),
    (
        "charuco_without_dictionary",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"charuco\"\ncolumns = 9\nrows = 7\nsquare_mm = 20\nmarker_mm = 15",
    ),
    (
        "unknown_dictionary",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"charuco\"\ncolumns = 9\nrows = 7\nsquare_mm = 20\nmarker_mm = 15\ndictionary = \"DICT_5X5_60\"",
    ),
    (
        "markers_larger_than_squares",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"charuco\"\ncolumns = 9\nrows = 7\nsquare_mm = 20\nmarker_mm = 21\ndictionary = \"DICT_5X5_50\"",
    ),
    (
        "more_markers_than_the_dictionary_has",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"charuco\"\ncolumns = 9\nrows = 7\nsquare_mm = 20\nmarker_mm = 15\ndictionary = \"DICT_APRILTAG_16h5\"",
    ),
    (
        "more_tags_than_there_are",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"aprilgrid\"\ncolumns = 30\nrows = 20\ntag_mm = 5\ntag_spacing = 0.3",
    ),
    (
        "tag_spacing_in_mm",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"aprilgrid\"\ncolumns = 3\nrows = 2\ntag_mm = 30\ntag_spacing = 9",
    ),
    (
        "circles_that_touch",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"asymmetric-circles\"\ncolumns = 4\nrows = 5\nspacing_mm = 20\ndiameter_mm = 15",
    ),
    ("points_of_nothing", "columns = 8\nrows = 6\nsquare_mm = 20", "kind = \"points\""),
    (
        "points_twice",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"points\"\npoints_mm = [[0, 0], [10, 0], [10, 10], [0, 10], [10, 0]]",
    ),
    (
        "points_on_a_line",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"points\"\npoints_mm = [[0, 0], [10, 0], [20, 0], [30, 0], [10, 10]]",
    ),
    (
        "point_of_one_number",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"points\"\npoints_mm = [[0, 0], [10], [10, 10], [0, 10]]",
    ),
    (
        "group_of_a_fraction",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"points\"\npoints_mm = [[0, 0, 1.5], [10, 0], [10, 10], [0, 10]]",
    ),
    (
        "negative_marker",
        "square_mm = 20",
        "kind = \"charuco\"\nsquare_mm = 20\nmarker_mm = -15\ndictionary = \"DICT_4X4_50\"",
    ),
    ("markers_of_a_checkerboard", "margin_px = 5", "margin_px = 5\nmin_marker_px = 20"),
    (
        "target_file_that_is_none",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "file = \"tests/data/target-files/none.yaml\"",
    ),
    (
        "target_file_of_a_camera",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "file = \"tests/data/camera-files/kalibr-camchain.yaml\"",
    ),
    (
        "target_file_of_another_kind",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"charuco\"\nfile = \"tests/data/target-files/kalibr-aprilgrid.yaml\"",
    ),
    (
        "target_file_beside_its_keys",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "file = \"tests/data/target-files/kalibr-checkerboard.yaml\"\nsquare_mm = 20",
    ),
    (
        "target_file_without_the_squares",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "file = \"tests/data/target-files/opencv-charuco.json\"",
    ),
    (
        "target_file_with_nan",
        "columns = 8\nrows = 6\nsquare_mm = 20",
        "kind = \"points\"\nfile = \"tests/data/target-files/nan.csv\"",
    ),
    ("missing_key", "fx_px = 500\n", ""),
    (
        "missing_section",
        "[camera]\nwidth_px = 640\nheight_px = 480\nfx_px = 500\n\n[camera.distortion]\nmodel = \"brown-conrady\"\nk1 = -0.1\n",
        "",
    ),
    ("missing_limits", "limits_mm = [400, 600]\n", ""),
    ("text_for_a_number", "fx_px = 500", "fx_px = \"500\""),
    ("number_for_a_text", "model = \"brown-conrady\"", "model = 5"),
    ("fraction_for_a_count", "count = 10", "count = 10.5"),
    ("negative_count", "count = 10", "count = -1"),
    ("width_beyond_u32", "width_px = 640", "width_px = 99999999999"),
    ("table_for_a_number", "k1 = -0.1", "k1 = { value = 1 }"),
    ("text_for_a_step", "step_deg = 5", "step_deg = \"5\""),
    ("list_too_short", "position_mm = [300, 0, 0]", "position_mm = [300, 0]"),
    ("list_too_long", "position_mm = [300, 0, 0]", "position_mm = [300, 0, 0, 0]"),
    ("text_in_a_list", "position_mm = [300, 0, 0]", "position_mm = [300, \"0\", 0]"),
    ("number_for_a_mount", "[camera]", "[camera]\nmount = 3"),
    ("range_of_three", "limits_mm = [400, 600]", "limits_mm = [400, 500, 600]"),
    ("not_a_number", "fx_px = 500", "fx_px = nan"),
    ("infinite", "position_mm = [300, 0, 0]", "position_mm = [300, 0, inf]"),
    ("negative_length", "square_mm = 20", "square_mm = -20"),
    ("zero_focal_length", "fx_px = 500", "fx_px = 0"),
    ("absurd_length", "a_mm = 300", "a_mm = 3e300"),
    ("absurd_noise", "sigma_px = 0.3", "sigma_px = 1e-300"),
    ("board_bent_to_a_bow", "square_mm = 20", "square_mm = 20\nwarp_mm = 300"),
    ("board_that_is_flatter_than_any", "square_mm = 20", "square_mm = 20\nwarp_mm = 0"),
    ("no_picture_at_a_pose", "count = 10", "count = 10\npictures = 0"),
    ("accuracy_of_no_size", "count = 10", "accuracy = { map_error_px = 1e-300 }"),
    ("prior_that_leaves_nothing_open", "\"cx\", \"cy\"]", "\"cx\", \"cy\"]\nprior_sigma = { fx = 1e-300, cx = 20 }"),
    ("lens_by_the_name_of_ros", "\"brown-conrady\"", "\"plumb_bob\""),
    ("lens_by_the_name_of_opencv", "\"brown-conrady\"", "\"fisheye\""),
    ("zero_noise", "sigma_px = 0.3", "sigma_px = 0"),
    ("noise_of_no_model", "sigma_px = 0.3", "sigma_px = 0.3\nmodel = \"edge\""),
    ("window_of_constant_noise", "sigma_px = 0.3", "sigma_px = 0.3\nmodel = \"constant\"\nwindow_px = 5"),
    ("window_of_no_size", "sigma_px = 0.3", "sigma_px = 0.3\nmodel = \"edges\"\nwindow_px = 0"),
    ("focus_without_aperture", "sigma_px = 0.3", "sigma_px = 0.3\nfocus_mm = 500"),
    ("aperture_without_focus", "sigma_px = 0.3", "sigma_px = 0.3\naperture_mm = 2"),
    ("aperture_of_no_size", "sigma_px = 0.3", "sigma_px = 0.3\nfocus_mm = 500\naperture_mm = 0"),
    ("focus_behind_the_camera", "sigma_px = 0.3", "sigma_px = 0.3\nfocus_mm = -500\naperture_mm = 2"),
    ("exposure_at_rest", "sigma_px = 0.3", "sigma_px = 0.3\nexposure_ms = 10"),
    ("speed_without_exposure", "sigma_px = 0.3", "sigma_px = 0.3\nmoving_mm_s = 20"),
    ("speed_that_is_none", "sigma_px = 0.3", "sigma_px = 0.3\nexposure_ms = 10\nturning_deg_s = nan"),
    (
        "blur_of_constant_noise",
        "sigma_px = 0.3",
        "sigma_px = 0.3\nmodel = \"constant\"\nfocus_mm = 500\nexposure_ms = 10",
    ),
    ("limits_reversed", "limits_mm = [400, 600]", "limits_mm = [600, 400]"),
    ("unused_limits_reversed", "narrow = [-10, 10]", "narrow = [10, -10]"),
    ("unknown_set_of_limits", "limits = \"wide\"", "limits = \"wild\""),
    ("no_set_of_limits_selected", "limits = \"wide\"", ""),
    ("set_selected_but_none_given", "{ narrow = [-10, 10], wide = [-90, 90] }", "[-90, 90]"),
    ("limits_of_the_wrong_kind", "limits_mm = [400, 600]", "limits_deg = [40, 60]"),
    ("joint_name_twice", "name = \"slide\"", "name = \"turn\""),
    ("joint_without_name", "name = \"slide\"", "name = \"\""),
    ("two_orientations", "rpy_deg = [0, 0, 0]", "rpy_deg = [0, 0, 0], quaternion_xyzw = [0, 0, 0, 1]"),
    ("quaternion_without_direction", "rpy_deg = [0, 0, 0]", "quaternion_xyzw = [0, 0, 0, 0]"),
    ("principal_point_outside", "fx_px = 500", "fx_px = 500\ncx_px = 640"),
    ("coefficient_of_another_model", "k1 = -0.1", "k4 = -0.1"),
    ("coefficient_of_no_model", "model = \"brown-conrady\"", "model = \"none\""),
    ("distortion_folds_back", "k1 = -0.1", "k1 = -2"),
    ("board_beyond_zone", "width_mm = 200", "width_mm = 170"),
    ("edge_margin_fills_zone", "height_mm = 150", "height_mm = 150\nedge_margin_mm = 75"),
    ("one_row", "rows = 6", "rows = 1"),
    ("step_zero", "step_deg = 5", "step_deg = 0"),
    ("step_negative_in_a_list", "step_deg = 5", "step_deg = [-5]"),
    ("too_many_steps", "step_deg = 5", "step_deg = [5, 5]"),
    ("step_missing_for_a_kind", "step_mm = 20\n", ""),
    ("grid_and_sample", "step_deg = 5", "step_deg = 5\nsample = 100"),
    ("empty_sample", "step_deg = 5\nstep_mm = 20", "sample = 0"),
    ("absurd_sample", "step_deg = 5\nstep_mm = 20", "sample = 1_000_000_000_000"),
    ("absurd_grid", "step_deg = 5\nstep_mm = 20", "step_deg = 0.001\nstep_mm = 0.001"),
    ("incidence_beyond_the_plane", "margin_px = 5", "max_incidence_deg = 91"),
    ("distances_reversed", "margin_px = 5", "min_distance_mm = 3000"),
    ("unknown_intrinsic", "\"cx\", \"cy\"]", "\"cx\", \"k4\"]"),
    ("intrinsic_twice", "\"cx\", \"cy\"]", "\"cx\", \"cx\"]"),
    ("no_intrinsics", "[\"fx\", \"fy\", \"cx\", \"cy\"]", "[]"),
    ("no_poses", "count = 10", "count = 0"),
    ("body_without_shape", "[sweep]", "[[robot.bodies]]\nlink = \"turn\"\n[sweep]"),
    (
        "body_with_two_shapes",
        "[sweep]",
        "[[robot.bodies]]\nlink = \"turn\"\nsphere_mm = 5\nbox_mm = [1, 2, 3]\n[sweep]",
    ),
    ("body_without_link", "[sweep]", "[[robot.bodies]]\nsphere_mm = 5\n[sweep]"),
    ("body_on_an_unknown_link", "[sweep]", "[[robot.bodies]]\nlink = \"slid\"\nsphere_mm = 5\n[sweep]"),
    (
        "body_on_a_link_of_two",
        "[[robot.joints]]\nname = \"turn\"",
        "[[robot.bodies]]\nlink = \"base\"\nsphere_mm = 5\n[[robot.joints]]\nname = \"base\"",
    ),
    ("body_of_negative_size", "[sweep]", "[[robot.bodies]]\nlink = \"turn\"\ncapsule_mm = [-5, 10]\n[sweep]"),
    ("housing_on_a_link", "[sweep]", "[camera.housing]\nlink = \"turn\"\nsphere_mm = 5\n[sweep]"),
    ("obstacle_without_name", "[sweep]", "[[scene.bodies]]\nsphere_mm = 5\n[sweep]"),
    ("obstacle_without_shape", "[sweep]", "[[scene.bodies]]\nname = \"table\"\n[sweep]"),
    ("obstacle_named_like_a_link", "[sweep]", "[[scene.bodies]]\nname = \"turn\"\nsphere_mm = 5\n[sweep]"),
    ("obstacle_named_like_the_board", "[sweep]", "[[scene.bodies]]\nname = \"board\"\nsphere_mm = 5\n[sweep]"),
    ("obstacle_on_a_link", "[sweep]", "[[scene.bodies]]\nname = \"table\"\nlink = \"base\"\nsphere_mm = 5\n[sweep]"),
    ("board_without_thickness", "square_mm = 20", "square_mm = 20\nthickness_mm = 0"),
    ("negative_mass", "[sweep]", "[[robot.masses]]\nlink = \"turn\"\nmass_kg = -1\n[sweep]"),
    ("mass_on_an_unknown_link", "[sweep]", "[[robot.masses]]\nlink = \"trun\"\nmass_kg = 1\n[sweep]"),
    ("negative_clearance", "[sweep]", "[collision]\nclearance_mm = -1\n[sweep]"),
    ("ignored_triple", "[sweep]", "[collision]\nignore = [[\"turn\", \"slide\", \"board\"]]\n[sweep]"),
    (
        "ignored_link_without_body",
        "[sweep]",
        "[collision]\nignore = [[\"turn\", \"board\"]]\n[[robot.bodies]]\nlink = \"slide\"\nsphere_mm = 5\n[sweep]",
    ),
    ("stability_without_masses", "[sweep]", "[stability]\nsupport_mm = [[0, 0], [1, 0], [0, 1]]\n[sweep]"),
    (
        "support_of_two_points",
        "[sweep]",
        "[[robot.masses]]\nlink = \"base\"\nmass_kg = 1\n[stability]\nsupport_mm = [[0, 0], [1, 0]]\n[sweep]",
    ),
    (
        "support_on_a_line",
        "[sweep]",
        "[[robot.masses]]\nlink = \"base\"\nmass_kg = 1\n[stability]\nsupport_mm = [[0, 0], [1, 1], [2, 2]]\n[sweep]",
    ),
    (
        "vertical_slope",
        "[sweep]",
        "[[robot.masses]]\nlink = \"base\"\nmass_kg = 1\n[stability]\nsupport_mm = [[0, 0], [1, 1], [2, 0]]\npitch_deg = 90\n[sweep]",
    ),
    ("three_corners_make_no_view", "margin_px = 5", "min_corners = 3"),
    ("more_corners_than_there_are", "margin_px = 5", "min_corners = 49"),
    ("more_poses_than_configurations", "count = 10", "count = 408"),
    ("tolerance_zero", "count = 10", "tolerance = 0"),
    ("unknown_criterion_of_several", "count = 10", "criterion = { v = 0.8, f = 0.2 }"),
    ("no_criteria", "count = 10", "criterion = {}"),
    ("share_zero", "count = 10", "criterion = { v = 1, d = 0 }"),
    ("accuracy_of_nothing", "count = 10", "accuracy = { map_error = 0.2 }"),
    ("accuracy_zero", "count = 10", "accuracy = { fx = 0 }"),
    ("no_accuracy", "count = 10", "accuracy = {}"),
    (
        "accuracy_beside_criterion_and_count",
        "count = 10",
        "count = 10\ncriterion = \"d\"\naccuracy = { map_error_px = 2 }",
    ),
    ("negative_time", "count = 10", "time_limit_s = -1"),
    ("prior_of_what_is_not_estimated", "\"cx\", \"cy\"]", "\"cx\", \"cy\"]\nprior_sigma = { k1 = 0.1 }"),
    ("required_and_forbidden", "[selection]", "[constraints]\nrequire = [3]\nforbid = [1, 3]\n\n[selection]"),
    ("captured_with_too_few_joints", "[selection]", "[constraints]\ncaptured = [[10]]\n\n[selection]"),
    (
        "region_of_an_unknown_joint",
        "[selection]",
        "[constraints]\nkeep_out = [{ joints = { trun = [0, 1] } }]\n\n[selection]",
    ),
    ("region_reversed", "[selection]", "[constraints]\nkeep_out = [{ joints = { turn = [1, 0] } }]\n\n[selection]"),
    ("region_of_no_joint", "[selection]", "[constraints]\nkeep_out = [{ joints = {} }]\n\n[selection]"),
    (
        "group_twice",
        "[selection]",
        "[constraints]\ngroups = [{ name = \"a\", joints = { turn = [0, 1] }, most = 1 }, { name = \"a\", joints = { turn = [2, 3] }, most = 1 }]\n\n[selection]",
    ),
    ("separation_negative", "[selection]", "[constraints]\njoint_separation_deg = -5\n\n[selection]"),
    ("pictures_apart_by_less_than_nothing", "[selection]", "[constraints]\npicture_separation_px = -1\n\n[selection]"),
    ("constraints_of_a_baseline", "count = 10", "method = \"random\"\n\n[constraints]\nforbid = [3]"),
    ("nothing_uncertain", "[selection]", "[robust]\nscenarios = 4\n\n[selection]"),
    ("one_scenario", "[selection]", "[robust]\nmount_rotation_deg = 1\nscenarios = 1\n\n[selection]"),
    ("negative_deviation", "[selection]", "[robust]\nmount_translation_mm = -1\n\n[selection]"),
    ("deviation_that_is_no_number", "[selection]", "[robust]\nfocal_length_percent = nan\n\n[selection]"),
    ("more_often_than_always", "[selection]", "[robust]\njoint_zero_deg = 1\nseen_share = 99\n\n[selection]"),
    ("deviation_of_an_unknown_intrinsic", "[selection]", "[robust]\nintrinsics = { k7 = 0.1 }\n\n[selection]"),
    (
        "mean_of_accuracies",
        "count = 10",
        "accuracy = { map_error_px = 2 }\n\n[robust]\njoint_zero_deg = 1\ngoal = \"mean\"",
    ),
    ("no_time", "[selection]\ncount = 10", "[selection]\ntime = { most_s = 0 }"),
    ("time_and_count", "[selection]", "[selection]\ntime = { most_s = 60 }"),
    ("least_of_nothing", "[selection]", "[selection]\nleast = \"time\""),
    ("least_of_something_else", "[selection]", "[selection]\naccuracy = { fx = 1 }\nleast = \"money\""),
    ("tour_of_clusters", "[selection]", "[selection]\nmethod = \"kmeans-joints\"\ntour_tolerance = 0.05"),
    (
        "tour_tolerance_beside_a_time",
        "[selection]\ncount = 10",
        "[selection]\ntime = { most_s = 60 }\ntour_tolerance = 0.05",
    ),
    ("home_of_one_joint", "[selection]", "[motion]\nhome = [0]\n\n[selection]"),
    ("home_beyond_a_limit", "[selection]", "[motion]\nhome = [0, 700]\n\n[selection]"),
    ("faster_than_the_robot", "[selection]", "[motion]\nspeed_percent = 120\n\n[selection]"),
    ("no_time_at_all", "[selection]", "[motion]\ndwell_s = -1\n\n[selection]"),
    ("acceleration_zero", "[selection]", "[motion]\nmax_acceleration_deg_s2 = { turn = 0 }\n\n[selection]"),
    ("acceleration_in_another_unit", "[selection]", "[motion]\nmax_acceleration_deg_s2 = { slide = 5 }\n\n[selection]"),
    ("acceleration_of_no_joint", "[selection]", "[motion]\nmax_acceleration_mm_s2 = { slid = 5 }\n\n[selection]"),
    ("jerk_zero", "[selection]", "[motion]\nmax_jerk_mm_s3 = { slide = 0 }\n\n[selection]"),
    ("jerk_in_another_unit", "[selection]", "[motion]\nmax_jerk_mm_s3 = { turn = 5 }\n\n[selection]"),
    ("empty_name", "name = \"Two joints\"", "name = \" \""),
    ("empty_folder", "[selection]", "[output]\nfolder = \"\"\n\n[selection]"),
];

fn draw(error: &ProblemError) -> String {
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
        .with_width(110)
        .without_syntax_highlighting();
    let mut drawing = String::new();
    handler.render_report(&mut drawing, error).unwrap();
    drawing
}

fn parse(text: &str) -> Result<Problem, ProblemError> {
    Problem::parse(text, Path::new("arm.toml"))
}

#[test]
fn the_file_that_the_cases_change_is_right() {
    let problem = parse(RIGHT).map_err(|error| draw(&error)).unwrap();
    assert_eq!(problem.space.len(), 37 * 11);
}

#[test]
fn every_mistake_has_its_drawing() {
    for (name, right, wrong) in WRONG {
        assert_eq!(RIGHT.matches(right).count(), 1, "{name}");
        let error = parse(&RIGHT.replace(right, wrong)).expect_err(name);
        for fault in error.faults() {
            assert!(fault.line > 0 && fault.column > 0, "{name}");
        }
        insta::assert_snapshot!(*name, draw(&error));
    }
}

#[test]
fn all_that_is_wrong_is_told_at_once() {
    let text =
        RIGHT.replace("fx_px = 500", "fx_px = -1").replace("rows = 6", "rows = 0").replace("k1 = -0.1", "k4 = 1");
    insta::assert_snapshot!(draw(&parse(&text).unwrap_err()));
}

#[test]
fn seventeen_joints_cannot_be_sampled() {
    let joint = |i: usize| format!("[[robot.joints]]\nname = \"j{i}\"\nlimits_deg = [0, 1]\n");
    let start = RIGHT.find("[[robot").unwrap();
    let end = RIGHT.find("[camera]").unwrap();
    let joints: String = (0..17).map(joint).collect();
    let text = RIGHT.replace(&RIGHT[start..end], &joints).replace("limits = \"wide\"", "");
    let text = text.replace("step_deg = 5\nstep_mm = 20", "sample = 1000");
    insta::assert_snapshot!(draw(&parse(&text).unwrap_err()));
}

/// What the user did not write is not laid to them.
#[test]
fn a_default_that_does_not_fit_is_called_one() {
    let text = RIGHT.replace("count = 10\n", "").replace("step_deg = 5\nstep_mm = 20", "step_deg = 90\nstep_mm = 200");
    insta::assert_snapshot!(draw(&parse(&text).unwrap_err()));
}

#[test]
fn names_in_other_letters_are_recognised() {
    for (right, wrong, name) in [
        ("kind = \"prismatic\"", "kind = \"Prismatic\"", "prismatic"),
        ("model = \"brown-conrady\"", "model = \"BROWN_CONRADY\"", "brown-conrady"),
        ("[selection]", "[selection]\nmethod = \"KMeans Joints\"", "kmeans-joints"),
    ] {
        let error = draw(&parse(&RIGHT.replace(right, wrong)).unwrap_err());
        assert!(error.contains(&format!("did you mean `{name}`")), "{error}");
    }
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let error =
        |path: &Path| draw(&Problem::read(path).unwrap_err()).replace(&*folder.path().to_string_lossy(), "FOLDER");
    insta::assert_snapshot!("missing_file", error(&folder.path().join("none.toml")));
    insta::assert_snapshot!("folder_for_a_file", error(folder.path()));
    let latin = folder.path().join("latin1.toml");
    std::fs::write(&latin, b"# one\nname = \"\xE4\"\n").unwrap();
    insta::assert_snapshot!("not_utf8", error(&latin));
}

/// Whatever number stands where a number is expected: an answer, never a panic.
#[test]
fn extreme_numbers_do_no_harm() {
    let numbers =
        ["0", "-0.0", "-1", "1e308", "-1e308", "5e-324", "nan", "-inf", "9223372036854775807", "0.5", "4294967295"];
    let mut replaced = 0;
    for (start, _) in RIGHT.match_indices(['=', '[', ',']) {
        let rest = RIGHT[start + 1..].trim_start();
        let length = rest.find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-')).unwrap_or(rest.len());
        let from = RIGHT.len() - rest.len();
        for number in numbers.iter().filter(|_| length > 0) {
            let text = format!("{}{number}{}", &RIGHT[..from], &RIGHT[from + length..]);
            if let Err(error) = parse(&text) {
                assert!(draw(&error).contains("arm.toml"));
            }
            replaced += 1;
        }
    }
    assert!(replaced > 200, "{replaced}");
}

/// Cutting a file short anywhere gives an answer too.
#[test]
fn files_cut_short_do_no_harm() {
    for end in (0..RIGHT.len()).step_by(3) {
        if let Err(error) = parse(&RIGHT[..end]) {
            draw(&error);
        }
    }
}
