//! `calipose export` writes a plan's poses in the order of its tour as files of robots' programs, and its robot as models.

use serde_json::Value;

use crate::desk::Desk;

/// Lines of a CSV file as cells.
fn rows(desk: &Desk, name: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(desk.path(name)).unwrap();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn column(rows: &[Vec<String>], name: &str) -> Vec<String> {
    let place = rows[0].iter().position(|heading| heading == name).unwrap_or_else(|| panic!("{name} in {:?}", rows[0]));
    rows[1..].iter().map(|row| row[place].clone()).collect()
}

fn seconds(desk: &Desk, name: &str) -> f64 {
    column(&rows(desk, name), "seconds").iter().map(|cell| cell.parse::<f64>().unwrap()).sum()
}

#[test]
fn every_format_of_the_robot_is_written_in_the_order_of_the_tour() {
    let desk = Desk::new();
    let plan = desk.json("plan coarse.toml -k 9 --trials 0 -o out --json");
    let formats = "ros2-goals,joint-trajectory,robot-calibration,moveit-calibration,rapid,krl,fanuc-ls,csv";
    let written = desk.json(&format!("export out/plan.json --to {formats} --json"));
    assert_eq!(written["format"], "calipose.export");
    let files: Vec<&str> =
        written["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    assert_eq!(files.len(), 8);
    for file in &files {
        let text = std::fs::read_to_string(desk.path("out/export").join(file)).unwrap();
        assert!(*file == "Servosila_Engineer.csv" || text.contains("calipose"), "{file}: {text}");
    }
    let table = rows(&desk, "out/export/Servosila_Engineer.csv");
    let order: Vec<String> = plan["tour"]["order"].as_array().unwrap().iter().map(|id| format!("pose {id}")).collect();
    assert_eq!(column(&table, "label"), order);
    // plan.csv has the same order.
    let ids = column(&rows(&desk, "out/plan.csv"), "id");
    assert_eq!(ids.iter().map(|id| format!("pose {id}")).collect::<Vec<_>>(), order);
    let moving = plan["tour"]["moving_s"].as_f64().unwrap();
    assert!((seconds(&desk, "out/export/Servosila_Engineer.csv") - moving).abs() < 1e-9);
}

#[test]
fn a_share_of_the_speed_and_a_dwell_take_the_place_of_the_problems() {
    let desk = Desk::new();
    desk.change(
        "home.toml",
        &[("[selection]", "[motion]\nhome = [0, 60, -100, 90]\nreturn_home = false\n\n[selection]")],
    );
    let plan = desk.json("plan home.toml -k 9 --trials 0 -o out --json");
    desk.json("export out/plan.json --to csv,joint-trajectory --json");
    let slow = desk.json("export out/plan.json --to csv --speed-percent 10 --dwell-s 2.5 -o slow --json");
    assert_eq!((slow["speed_percent"].clone(), slow["dwell_s"].clone()), (10.0.into(), 2.5.into()));
    // The least share that may be asked for is one that every format takes.
    let formats = "ros2-goals,joint-trajectory,robot-calibration,moveit-calibration,rapid,krl,fanuc-ls,csv";
    desk.json(&format!("export out/plan.json --to {formats} --speed-percent 0.1 -o slowest --json"));
    let said = desk.prose("export out/plan.json --to csv -o said");
    assert!(
        said.contains("were not tested for collision") && said.contains("The way to home is not planned."),
        "{said}"
    );
    let table = rows(&desk, "slow/Servosila_Engineer.csv");
    assert_eq!(column(&table, "label").len(), 10, "home and nine poses");
    assert_eq!(column(&table, "label")[0], "home");
    let ratio = seconds(&desk, "slow/Servosila_Engineer.csv") / seconds(&desk, "out/export/Servosila_Engineer.csv");
    let moving = plan["tour"]["moving_s"].as_f64().unwrap();
    assert!((seconds(&desk, "out/export/Servosila_Engineer.csv") - moving).abs() < 1e-9);
    assert!(ratio > 5.0 && ratio <= 10.0 + 1e-9, "{ratio}");
}

#[test]
fn what_cannot_be_exported_is_refused() {
    let desk = Desk::new();
    desk.json("plan coarse.toml -k 9 --trials 0 -o out --json");
    let complaint = desk.complaint("export out/plan.json --to urscript,csv", 2);
    assert!(complaint.contains("exactly 6 revolute joints") && complaint.contains("4 revolute"), "{complaint}");
    // All or nothing.
    assert!(!desk.path("out/export/Servosila_Engineer.csv").exists());
    let complaint = desk.complaint("export out/plan.json --to csv --speed-percent 0", 2);
    assert!(complaint.contains("--speed-percent is 0; it must be from 0.1 to 100"), "{complaint}");
    assert!(desk.complaint("export out/plan.json --to csv --dwell-s -1", 2).contains("--dwell-s is -1"));
    assert!(desk.complaint("export out/plan.json --to cnc", 2).contains("ros2-goals"));
    std::fs::write(desk.path("taken"), "").unwrap();
    assert!(desk.complaint("export out/plan.json --to csv -o taken", 1).contains("taken"));
    // A plan made before there were tours goes by its ids.
    let text = std::fs::read_to_string(desk.path("out/plan.json")).unwrap();
    let mut old: Value = serde_json::from_str(&text).unwrap();
    old.as_object_mut().unwrap().remove("tour");
    std::fs::write(desk.path("old.json"), old.to_string()).unwrap();
    desk.json("export old.json --problem coarse.toml --to csv -o old --json");
    let labels = column(&rows(&desk, "old/Servosila_Engineer.csv"), "label");
    assert!(labels.is_sorted() && labels.len() == 9, "{labels:?}");
}

#[test]
fn models_and_a_recording_lie_together_with_what_they_name() {
    let desk = Desk::new();
    desk.json("plan coarse.toml -k 9 --trials 0 -o out --json");
    let written = desk.json("export out/plan.json --to urdf,mjcf,sdf,mcap --dwell-s 0.5 --json");
    let files = written["files"].as_array().unwrap();
    let of = |format: &str| -> Vec<&str> {
        let own = files.iter().filter(|file| file["format"] == format);
        own.map(|file| file["file"].as_str().unwrap()).collect()
    };
    let board = ["obj", "mtl", "png"].map(|ending| format!("Servosila_Engineer.board.{ending}"));
    for (format, ending) in [("urdf", "urdf"), ("mjcf", "mjcf.xml"), ("sdf", "sdf")] {
        let model = format!("Servosila_Engineer.{ending}");
        assert_eq!(of(format)[0], model);
        assert_eq!(of(format)[1..], board);
        let text = std::fs::read_to_string(desk.path("out/export").join(model)).unwrap();
        let read = roxmltree::Document::parse(&text).unwrap();
        // The joints have the names of the robot's, and the links of the same names others.
        let named = |name: &str| read.descendants().filter(|node| node.attribute("name") == Some(name)).count();
        assert_eq!((named("waist"), named("waist_link"), named("camera_optical_frame")), (1, 1, 1), "{format}");
        assert!(text.contains(&board[0]), "{format}");
    }
    assert_eq!(of("mcap"), ["Servosila_Engineer.mcap"]);
    let bytes = |folder: &str| std::fs::read(desk.path(folder).join("Servosila_Engineer.mcap")).unwrap();
    assert!(bytes("out/export").starts_with(b"\x89MCAP0\r\n") && bytes("out/export").ends_with(b"\x89MCAP0\r\n"));
    desk.json("export out/plan.json --to mcap --dwell-s 0.5 -o again --json");
    assert_eq!(bytes("out/export"), bytes("again"));
    let longer = desk.prose("export out/plan.json --to mcap --dwell-s 5 -o longer");
    assert!(bytes("longer").len() > bytes("again").len());
    assert!(longer.contains("Try them in simulation first"), "{longer}");
    let said = desk.prose("export out/plan.json --to sdf,urdf -o models");
    let names = "Servosila_Engineer.board.mtl, Servosila_Engineer.board.obj, Servosila_Engineer.board.png, Servosila_Engineer.sdf, \
                 Servosila_Engineer.urdf";
    assert_eq!(said, format!("Written to models: {names}."));
}

#[test]
fn models_have_no_times() {
    let desk = Desk::new();
    desk.json("plan coarse.toml -k 9 --trials 0 -o out --json");
    let complaint = desk.complaint("export out/plan.json --to urdf,sdf --dwell-s 1", 2);
    assert!(
        complaint.contains("--dwell-s does not apply to urdf, sdf, without times and speeds; leave it out"),
        "{complaint}"
    );
    let complaint = desk.complaint("export out/plan.json --to mjcf --speed-percent 10", 2);
    assert!(complaint.contains("--speed-percent does not apply to mjcf, without times and speeds"), "{complaint}");
    assert!(!desk.path("out/export").exists());
    // Beside a file with the tour they are for that.
    desk.json("export out/plan.json --to mjcf,csv --speed-percent 10 --dwell-s 1 --json");
    let complaint = desk.complaint("export out/plan.json --to mjcf,mcap --dwell-s -1", 2);
    assert!(complaint.contains("--dwell-s is -1; it must be from 0 to 3600"), "{complaint}");
}

#[test]
fn names_that_a_format_keeps_for_itself_are_refused() {
    let desk = Desk::new();
    desk.change("colons.toml", &[("name = \"waist\"", "name = \"waist::yaw\"")]);
    desk.json("plan colons.toml -k 9 --trials 0 -o out --json");
    let complaint = desk.complaint("export out/plan.json --to urdf,sdf", 2);
    let expected = "the format \"sdf\" cannot have the name \"waist::yaw\": names must be without \"::\"";
    assert!(complaint.contains(expected), "{complaint}");
    assert!(!desk.path("out/export/Servosila_Engineer.urdf").exists());
    desk.json("export out/plan.json --to urdf,mjcf,mcap --json");
}
