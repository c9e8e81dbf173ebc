//! Writes tours in every format, for `tests/cross_check/exports.py`, which reads them with other programs.
//!
//!     cargo run --example exports -- FOLDER
//!
//! A folder a tour, in it the files, and `tour.json` with what they must say and which formats refuse the tour.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

use calipose::export::{Home, Program, ProgramFormat, ProgramJoint, Stop};
use calipose::robot::JointKind;
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(env::args().nth(1).ok_or("which folder?")?);
    let plain: Vec<String> = (1..=6).map(|i| format!("joint_{i}")).collect();
    let odd = ["yes", "1e3", "a: \"b\" # c", "日本\n- é", " 'x\\y' ", "null\u{2028}\u{7f}"].map(str::to_owned);
    let arm = |names: &[String]| names.iter().map(|name| joint(name, JointKind::Revolute)).collect::<Vec<_>>();
    let mut tracked = arm(&plain);
    tracked.insert(0, joint("track", JointKind::Prismatic));
    let mut seven = arm(&plain);
    seven.push(joint("joint_7", JointKind::Revolute));
    write(&folder, "six", "Servosila Engineer", &arm(&plain), 12, true)?;
    write(&folder, "odd", "while \"x\"\nEND\nmovej(0) ; é", &arm(&odd), 3, false)?;
    write(&folder, "tracked", "日本 on a track", &tracked, 5, true)?;
    write(&folder, "four", "4 joints", &arm(&plain[..4]), 4, false)?;
    write(&folder, "seven", "seven", &seven, 2, false)?;
    let eased: Vec<ProgramJoint> = arm(&plain).into_iter().map(|joint| ProgramJoint { jerk: 3.0, ..joint }).collect();
    write(&folder, "eased", "eased", &eased, 9, true)
}

fn joint(name: &str, kind: JointKind) -> ProgramJoint {
    ProgramJoint { name: name.to_owned(), kind, speed: 2.0, acceleration: 4.0, jerk: f64::INFINITY }
}

/// Writes a tour of so many stops with values that have all their digits.
fn write(
    folder: &Path,
    case: &str,
    name: &str,
    joints: &[ProgramJoint],
    stops: usize,
    has_home: bool,
) -> Result<(), Box<dyn Error>> {
    let folder = folder.join(case);
    fs::create_dir_all(&folder)?;
    let value = |i: usize, j: usize| 3.1 * ((7 * i + 3 * j + 1) as f64 * 0.739_085).sin();
    let stops: Vec<Stop> = (0..stops)
        .map(|i| Stop {
            label: format!("pose {}", (i * 37) % 101),
            q: (0..joints.len()).map(|j| value(i, j)).collect(),
            seconds: 1.0 + 27.7 * (i as f64 * 0.618_034).fract(),
            // A robot turns there, on its way.
            picture: i % 5 != 3,
        })
        .collect();
    let home = has_home.then(|| Home { q: vec![0.0; joints.len()], back: Some(6.0) });
    let tour = Program { name, joints, stops: &stops, home, dwell: 1.25, share: 0.3 };
    let mut files = serde_json::Map::new();
    for format in ProgramFormat::ALL {
        let said = match format.write(&tour) {
            Ok(text) => {
                fs::write(folder.join(format.file_name(&tour)), text)?;
                json!({ "file": format.file_name(&tour) })
            }
            Err(error) => json!({ "refused": error.to_string() }),
        };
        files.insert(format.name().to_owned(), said);
    }
    Ok(fs::write(folder.join("tour.json"), serde_json::to_string_pretty(&described(&tour, &files))?)?)
}

fn described(tour: &Program, files: &serde_json::Map<String, Value>) -> Value {
    let is_prismatic = |joint: &ProgramJoint| joint.kind == JointKind::Prismatic;
    json!({
        "name": tour.name,
        "joints": tour.joints.iter().map(|joint| json!({ "name": joint.name, "prismatic": is_prismatic(joint),
            "speed": joint.speed, "acceleration": joint.acceleration,
            "jerk": joint.jerk.is_finite().then_some(joint.jerk) })).collect::<Vec<_>>(),
        "stops": tour.stops.iter().map(|stop| json!({ "label": stop.label, "q": stop.q,
            "seconds": stop.seconds, "picture": stop.picture })).collect::<Vec<_>>(),
        "home": tour.home.as_ref().map(|home| json!({ "q": home.q, "seconds": home.back })),
        "dwell": tour.dwell,
        "share": tour.share,
        "files": files,
    })
}
