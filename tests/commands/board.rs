//! The calibration target on paper: the right page, true scale, and nobody's file lost.

use std::fs;

use crate::desk::{Desk, text};

/// A zone that holds every board.
const ZONE: &str = "--set target.zone.width_mm=99999 --set target.zone.height_mm=99999";

/// A problem with squares of 20 mm, whose board fits on A4.
fn small(desk: &Desk) {
    desk.change("small.toml", &[("square_mm = 35", "square_mm = 20")]);
}

#[test]
fn the_board_is_drawn_on_the_smallest_page_in_both_formats() {
    let desk = Desk::new();
    fs::create_dir(desk.path("drawn")).unwrap();
    let said = desk.stdout("board coarse.toml -o drawn");
    assert_eq!(desk.files("drawn"), ["coarse-board.pdf", "coarse-board.svg"]);
    for words in [
        "8 × 6 inner corners, squares of 35 mm, 315 × 245 mm, on A3 (420 × 297 mm), with 26 mm of white around it",
        "Written to drawn/coarse-board.pdf, drawn/coarse-board.svg",
        "Print at 100 %",
        "measure the bar: 100 mm",
        "x points to the right and y up; corner 0 is the lower left inner corner",
    ] {
        assert!(said.contains(words), "{words:?} is missing from\n{said}");
    }
    assert!(!said.contains("--tile") && !said.contains("Cut the pages"));
    let svg = fs::read_to_string(desk.path("drawn/coarse-board.svg")).unwrap();
    assert!(svg.contains("width=\"420mm\" height=\"297mm\" viewBox=\"0 0 420 297\""));
    assert!(svg.contains(concat!("calipose ", env!("CARGO_PKG_VERSION"))));
    assert!(fs::read(desk.path("drawn/coarse-board.pdf")).unwrap().starts_with(b"%PDF-"));

    // In the working directory when nothing is said; the same bytes from the same file.
    desk.stdout("board coarse.toml --quiet");
    assert_eq!(svg, fs::read_to_string(desk.path("coarse-board.svg")).unwrap());
    assert!(fs::read(desk.path("drawn/coarse-board.pdf")).unwrap() == fs::read(desk.path("coarse-board.pdf")).unwrap());
}

#[test]
fn the_output_may_be_a_file_and_the_format_be_chosen() {
    let desk = Desk::new();
    desk.stdout("board coarse.toml -o new/target.PDF");
    assert_eq!(desk.files("new"), ["target.pdf"]);
    desk.stdout("board coarse.toml -o new/other.svg --format both");
    assert_eq!(desk.files("new"), ["other.pdf", "other.svg", "target.pdf"]);
    desk.stdout("board coarse.toml -o more --format svg");
    assert_eq!(desk.files("more"), ["coarse-board.svg"]);
    assert!(desk.complaint("board coarse.toml -o x.pdf --format svg", 2).contains("--format asks for another file"));
}

#[test]
fn a_pattern_too_large_for_its_page_is_spread_over_several() {
    let desk = Desk::new();
    let document = desk.json("board coarse.toml --tile -o tiles --json");
    assert_eq!(document["format"], "calipose.board");
    assert_eq!(document["page"]["name"], "A4");
    assert_eq!(document["pattern"]["size_mm"], serde_json::json!([315.0, 245.0]));
    assert_eq!([&document["tiles"]["rows"], &document["tiles"]["columns"]], [2, 2]);
    let svgs = ["row1-column1", "row1-column2", "row2-column1", "row2-column2"];
    let names = ["coarse-board.pdf".to_owned()].into_iter().chain(svgs.map(|at| format!("coarse-board-{at}.svg")));
    let files = document["files"].as_array().unwrap();
    for (file, name) in files.iter().zip(names) {
        assert_eq!(file["file"], format!("tiles/{name}"));
        assert!(desk.path("tiles").join(name).is_file());
    }
    assert_eq!([&files[4]["row"], &files[4]["column"], &files[2]["column"]], [2, 2, 2]);
    assert!(desk.stdout("board coarse.toml --tile -o tiles").contains("on 4 pages (2 × 2) of A4 (297 × 210 mm)"));
    // One page is enough for this one.
    small(&desk);
    assert!(desk.json("board small.toml --tile --json")["tiles"].is_null());
}

#[test]
fn a_pattern_too_large_for_every_page_gets_one_made_to_measure() {
    let desk = Desk::new();
    let said = desk.stdout(&format!("board coarse.toml --set target.square_mm=150 {ZONE} -o big"));
    assert!(said.contains("1350 × 1050 mm, on 1476 × 1150 mm, with 50 mm of white"), "{said}");
    assert!(said.contains("No page up to A0 is large enough") && said.contains("`--tile`"), "{said}");
    assert!(desk.complaint(&format!("board coarse.toml --set target.square_mm=900 {ZONE}"), 1).contains("--tile"));
}

#[test]
fn a_page_that_does_not_do_is_refused_with_one_that_does() {
    let desk = Desk::new();
    let too_small = desk.complaint("board coarse.toml --page a4", 2);
    for words in [
        "A4 (210 × 297 mm) is too small: the pattern has 315 × 245 mm",
        "17.5 mm of white",
        "it takes 376 × 280 mm",
        "take --page A3",
        "--tile",
    ] {
        assert!(too_small.contains(words), "{words:?} is missing from\n{too_small}");
    }
    assert!(desk.complaint("board coarse.toml --page letter", 2).contains("take --page ansi-c"));
    assert!(desk.complaint("board coarse.toml --page leter", 2).contains("did you mean letter?"));
    assert!(desk.complaint("board coarse.toml --page 0x300", 2).contains("from 50 to 5080 mm"));
    for margin in ["-1", "nan", "inf", "wide"] {
        let refused = desk.complaint(&format!("board coarse.toml --margin-mm {margin}"), 2);
        assert!(refused.contains("must be a number from 0 on"), "{refused}");
    }
    assert!(desk.complaint("board coarse.toml --page A5 --tile --margin-mm 70", 2).contains("smaller --margin-mm"));
    assert!(
        desk.complaint(&format!("board coarse.toml --page A5 --tile --set target.square_mm=5000 {ZONE}"), 2)
            .contains("larger --page")
    );
    small(&desk);
    assert!(desk.stdout("board small.toml --margin-mm 0 --page A4").contains("on A4 (297 × 210 mm)"));
    let error: serde_json::Value =
        serde_json::from_slice(&desk.run("board coarse.toml --page A4 --json").stderr).unwrap();
    assert_eq!(
        [&error["kind"], &error["help"]],
        ["page", "take --page A3, the next standard size, or spread it over several pages with --tile"]
    );
}

#[test]
fn pages_of_an_earlier_run_that_are_no_more_are_removed() {
    let desk = Desk::new();
    desk.stdout("board coarse.toml --tile --page A5 -o out -q");
    assert!(desk.files("out").contains(&"coarse-board-row2-column4.svg".to_owned()), "{:?}", desk.files("out"));
    // Somebody's own, and another board's.
    fs::write(desk.path("out/coarse-board-row9-column9.svg"), "<svg/>").unwrap();
    desk.stdout("board coarse.toml --page A3 -o out/coarse-board-2.svg -q");
    let others = ["coarse-board-2.svg", "coarse-board-row9-column9.svg"];
    desk.stdout("board coarse.toml --tile --format pdf -o out -q");
    assert!(desk.files("out").len() > 6, "no SVG was written in place of those: {:?}", desk.files("out"));
    desk.stdout("board coarse.toml --tile -o out -q");
    let tiles =
        [(1, 1), (1, 2), (2, 1), (2, 2)].map(|(row, column)| format!("coarse-board-row{row}-column{column}.svg"));
    let mut left: Vec<String> = others.into_iter().chain(["coarse-board.pdf"]).map(String::from).chain(tiles).collect();
    left.sort();
    assert_eq!(desk.files("out"), left);
    desk.stdout("board coarse.toml -o out -q");
    assert_eq!(desk.files("out"), [others[0], others[1], "coarse-board.pdf", "coarse-board.svg"]);
}

#[test]
fn files_of_others_are_not_replaced_and_those_of_this_command_are() {
    let desk = Desk::new();
    desk.stdout("board coarse.toml -o out");
    let before = fs::read_to_string(desk.path("out/coarse-board.svg")).unwrap();
    desk.stdout("board coarse.toml -o out --set target.square_mm=20");
    assert_ne!(before, fs::read_to_string(desk.path("out/coarse-board.svg")).unwrap());
    fs::write(desk.path("out/coarse-board.svg"), "<svg/>").unwrap();
    let pdf = fs::read(desk.path("out/coarse-board.pdf")).unwrap();
    let refused = desk.complaint("board coarse.toml -o out", 1);
    assert!(refused.contains("out/coarse-board.svg exists already"), "{refused}");
    assert!(pdf == fs::read(desk.path("out/coarse-board.pdf")).unwrap(), "nothing is written");
    fs::create_dir(desk.path("out/folder-board.pdf")).unwrap();
    desk.change("folder.toml", &[]);
    desk.complaint("board folder.toml -o out", 1);

    fs::write(desk.path("taken"), "").unwrap();
    let unwritable = desk.run("board coarse.toml -o taken/below");
    assert_eq!(unwritable.status.code(), Some(1));
    assert!(text(&unwritable.stderr).contains("cannot write taken/below"), "{}", text(&unwritable.stderr));
    assert!(desk.complaint("board none.toml", 3).contains("none.toml"));
}
