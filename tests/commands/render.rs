//! `calipose render` writes the picture of every pose of a plan, polished or not, the same for the same seed.

use std::path::Path;

use serde_json::Value;

use crate::desk::Desk;

/// Width, height and grey values of a PNG.
fn picture(path: &Path) -> (u32, u32, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut grey = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut grey).unwrap();
    (info.width, info.height, grey)
}

#[test]
fn every_pose_has_its_picture() {
    let desk = Desk::new();
    // A quarter of the camera is a sixteenth of the work.
    let quarter = [
        ("width_px = 1280", "width_px = 320"),
        ("height_px = 720", "height_px = 180"),
        ("fx_px = 1000", "fx_px = 250"),
        ("fy_px = 1000", "fy_px = 250"),
    ];
    desk.change("quarter.toml", &quarter);
    let plan = desk.json("plan quarter.toml -k 9 --trials 0 -o out --json");
    let found = desk.json("render out/plan.json --supersampling 2 --json");
    let of = |document: &Value, key: &str, list: &str| -> Vec<Value> {
        document[list].as_array().unwrap().iter().map(|entry| entry[key].clone()).collect()
    };
    assert_eq!(&of(&found, "pose", "pictures"), plan["tour"]["order"].as_array().unwrap());
    let pictures: Vec<_> = of(&found, "file", "pictures")
        .iter()
        .map(|file| picture(&desk.path("out/pictures").join(file.as_str().unwrap())))
        .collect();
    for (width, height, grey) in &pictures {
        assert_eq!((*width, *height), (320, 180));
        let share = |range: std::ops::RangeInclusive<u8>| {
            grey.iter().filter(|&grey| range.contains(grey)).count() as f64 / grey.len() as f64
        };
        // Black squares, white ones and paper, and what is around.
        assert!(share(30..=55) > 0.01 && share(180..=220) > 0.02 && share(95..=125) > 0.2);
    }
    // Noise of its own in each, and the same again.
    assert_ne!(pictures[0].2[..50], pictures[1].2[..50]);
    desk.json("render out/plan.json --supersampling 2 --threads 1 -o again --json");
    assert_eq!(picture(&desk.path("again/pose-01.png")), pictures[0]);
}

#[test]
fn polished_poses_are_rendered_where_they_are() {
    let desk = Desk::new();
    let plan = desk.json("plan coarse.toml -k 9 --trials 0 -o out --json");
    let polished = desk.json("polish out/plan.json --cycles 1 --json");
    let render = |what: &str, folder: &str| {
        desk.json(&format!("render out/{what}.json --supersampling 1 --noise 0 -o {folder} --json"))["pictures"].clone()
    };
    let (on_grid, off_grid) = (render("plan", "on"), render("polished", "off"));
    let poses = plan["poses"].as_array().unwrap().iter().zip(polished["poses"].as_array().unwrap());
    let mut moved = 0;
    // The plan's in the order of its tour, the polished ones by the ids of the poses that they started from.
    let pictured = |pictures: &Value, folder: &str, id: &Value| {
        let entry = pictures.as_array().unwrap().iter().find(|entry| entry["pose"] == *id).unwrap();
        picture(&desk.path(folder).join(entry["file"].as_str().unwrap()))
    };
    for (before, after) in poses {
        let is_still = before["joints_rad"] == after["joints_rad"];
        let [on, off] =
            [(&on_grid, "on"), (&off_grid, "off")].map(|(list, folder)| pictured(list, folder, &before["id"]));
        assert_eq!(on == off, is_still, "{}", before["id"]);
        moved += usize::from(!is_still);
    }
    assert!(moved > 0);
}

#[test]
fn what_cannot_be_rendered_is_refused() {
    let desk = Desk::new();
    desk.json("plan coarse.toml -k 9 --trials 0 -o out --json");
    for (options, what) in [
        ("--blur-px -1", "--blur-px is -1; it must be from 0 to 50"),
        ("--supersampling 0", "--supersampling is 0; it must be from 1 to 32"),
        ("--noise NaN", "--noise is NaN"),
    ] {
        let output = desk.run(&format!("render out/plan.json {options}"));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(what), "{error}");
    }
    assert_eq!(desk.run("render none/plan.json").status.code(), Some(3));
    // Neither a plan nor a polished one.
    let error = desk.complaint("render out/run.json", 3);
    assert!(error.contains("in a plan it is \"calipose.plan\" or \"calipose.polished\""), "{error}");
}
