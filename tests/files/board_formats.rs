//! Boards that other tools describe, and the errors of their files.

use std::path::Path;

use calipose::formats::{StatedBoard, read_board};
use calipose::problem::Problem;
use calipose::target::{Board, Feature};

const PROBLEM: &str = r#"
    [[robot.joints]]
    name = "turn"
    limits_deg = [-90, 90]
    [camera]
    width_px = 640
    height_px = 480
    fx_px = 500
    [target]
    KEYS
    pose = { position_mm = [300, 0, 0] }
    [sweep]
    step_deg = 1
"#;

fn problem(keys: &str) -> Problem {
    let text = PROBLEM.replace("KEYS", keys);
    Problem::parse(&text, Path::new("arm.toml")).map_err(|error| format!("{:?}", error.faults())).unwrap()
}

fn of_file(name: &str, beside: &str) -> Board {
    problem(&format!("file = \"tests/data/target-files/{name}\"\n{beside}")).target.board
}

#[test]
fn files_state_the_same_boards_as_keys() {
    for (file, beside, keys) in [
        ("kalibr-aprilgrid.yaml", "", "kind = \"aprilgrid\"\ncolumns = 6\nrows = 6\ntag_mm = 88\ntag_spacing = 0.3"),
        ("kalibr-checkerboard.yaml", "kind = \"checkerboard\"", "columns = 6\nrows = 7\nsquare_mm = 60"),
        (
            "kalibr-circlegrid.yaml",
            "diameter_mm = 15",
            "kind = \"asymmetric-circles\"\ncolumns = 6\nrows = 7\nspacing_mm = 40\ndiameter_mm = 15",
        ),
        (
            "opencv-charuco.json",
            "columns = 11\nrows = 8",
            "kind = \"charuco\"\ncolumns = 11\nrows = 8\nsquare_mm = 40\nmarker_mm = 30\ndictionary = \"DICT_5X5_50\"",
        ),
        (
            "points.csv",
            "",
            "kind = \"points\"\npoints_mm = [[0, 0, 1], [40, 0, 1], [40, 40, 1], [0, 40, 1], [120, 10], [200, 0, 2], [200, 80, 2]]",
        ),
    ] {
        assert_eq!(of_file(file, beside), problem(keys).target.board, "{file}");
    }
}

#[test]
fn boards_read_in_part_are_the_default_of_those_with_markers() {
    let grid = problem("file = \"tests/data/target-files/kalibr-aprilgrid.yaml\"");
    assert_eq!((grid.visibility.min_corners, grid.visibility.min_marker), (Some(16), 30.0));
    let charuco = problem("file = \"tests/data/target-files/opencv-charuco.json\"\ncolumns = 11\nrows = 8");
    assert_eq!((charuco.visibility.min_corners, charuco.visibility.min_marker), (Some(4), 21.0));
    let points = problem("file = \"tests/data/target-files/points.csv\"");
    assert_eq!((points.visibility.min_corners, points.visibility.min_marker), (None, 0.0));
    assert_eq!(points.target.board.feature(0), Feature::Point);
    assert_eq!(points.target.board.markers().len(), 2);
}

#[test]
fn mistakes_are_named_with_line_and_value() {
    let grid = "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n";
    let charuco = "{\"dictionary\": 4,\n\"square_size\": 0.04,\n\"marker_size\": 0.03}";
    let squares =
        "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\ncolSpacingMeters: 0.06\n";
    let mut told = String::new();
    for (text, from, to) in [
        (grid, "aprilgrid", "aprilgird"),
        (grid, "tagRows: 6\n", ""),
        (grid, "tagSpacing: 0.3", "tagSpacing: 26.4"),
        (grid, "tagCols: 6", "tagCols: 100"),
        (grid, "tagSize: 0.088", "tagSize: -1"),
        (squares, "rowSpacingMeters: 0.06", "rowSpacingMeters: 0.05"),
        (charuco, "\"dictionary\": 4", "\"dictionary\": 40"),
        (charuco, "0.04", "40"),
        (charuco, "\"marker_size\"", "\"marker\""),
        ("a: 1", "", ""),
        ("", "", ""),
        ("x_mm,y_mm,z_mm\n0,0,0", "", ""),
    ] {
        let error = read_board(&text.replacen(from, to, 1)).unwrap_err();
        told += &format!("{error}\n");
    }
    insta::assert_snapshot!(told);
    assert!(matches!(read_board(charuco), Ok(StatedBoard::Charuco { .. })));
}
