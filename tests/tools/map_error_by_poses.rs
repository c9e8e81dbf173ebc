//! Draws the README's figure, map error against number of poses: `cargo run --release --example map_error_by_poses >
//! docs/src/map-error-by-poses.svg`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a tool of the book")]

use std::fmt::Write;
use std::path::Path;

use calipose::plan::assess::compare;
use calipose::plan::choose::Chooser;
use calipose::plan::survey::survey;
use calipose::problem::{Method, Problem};

const PLAN: [usize; 14] = [8, 9, 10, 12, 15, 20, 25, 30, 40, 60, 80, 100, 150, 200];
const CLUSTERED: [usize; 12] = [8, 10, 12, 15, 20, 30, 40, 60, 80, 100, 150, 200];
const SEEDS: usize = 5;

/// The plot's area and the ranges of its logarithmic axes.
const LEFT: f64 = 64.0;
const TOP: f64 = 16.0;
const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 280.0;
const POSES: [f64; 2] = [8.0, 200.0];
const MAP_ERROR: [f64; 2] = [0.3, 30.0];

/// Colours that the colour-blind tell apart, on light and on dark ground.
const COLOURS: [&str; 4] = ["#0072b2", "#7f7f7f", "#d55e00", "#cc79a7"];

fn x(poses: f64) -> f64 {
    LEFT + WIDTH * (poses / POSES[0]).ln() / (POSES[1] / POSES[0]).ln()
}

fn y(map_error: f64) -> f64 {
    TOP + HEIGHT * (1.0 - (map_error / MAP_ERROR[0]).ln() / (MAP_ERROR[1] / MAP_ERROR[0]).ln())
}

fn main() {
    let problem = Problem::read(Path::new("problems/servosila-engineer.toml")).unwrap();
    let survey = survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let (mut plan, mut bound) = (vec![], vec![]);
    for count in PLAN {
        let (choice, certificate) = chooser.best(count, 0).unwrap();
        plan.push((count, choice.map_error));
        // For `v` the bound is on the mean variance.
        bound.push((count, chooser.natural(certificate.log_bound).sqrt()));
    }
    let clustered = |method| {
        let compared = compare(&chooser, &[method], &CLUSTERED, 0, SEEDS, &mut || {}).unwrap();
        compared.rows.iter().map(|row| (row.choice.selected.len(), row.choice.map_error)).collect::<Vec<_>>()
    };
    let curves = [
        ("this plan", plan),
        ("no set can be below", bound),
        ("k-means on joints", clustered(Method::KMeansJoints)),
        ("k-means on camera positions", clustered(Method::KMeansPositions)),
    ];
    println!("{}", svg(&curves));
}

fn svg(curves: &[(&str, Vec<(usize, f64)>)]) -> String {
    let (right, bottom) = (LEFT + WIDTH, TOP + HEIGHT);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#7f7f7f\">\n\
         <title>Expected map error against number of poses, Servosila Engineer</title>\n",
        right + 16.0,
        bottom + 48.0
    );
    for poses in [8, 10, 20, 50, 100, 200] {
        let x = x(f64::from(poses));
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {TOP}V{bottom}\" stroke=\"#7f7f7f\" stroke-opacity=\".25\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{poses}</text>",
            bottom + 18.0
        );
    }
    for map_error in [0.3, 1.0, 3.0, 10.0, 30.0] {
        let y = y(map_error);
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {y:.1}H{right}\" stroke=\"#7f7f7f\" stroke-opacity=\".25\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{map_error}</text>",
            LEFT - 8.0,
            y + 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">poses</text>\
         <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">map error, px RMS over the image</text>",
        LEFT + WIDTH / 2.0,
        bottom + 38.0,
        TOP + HEIGHT / 2.0
    );
    for (i, ((name, points), colour)) in curves.iter().zip(COLOURS).enumerate() {
        let shown = points.iter().filter(|(_, map_error)| *map_error <= MAP_ERROR[1]);
        let points: Vec<String> =
            shown.map(|&(poses, map_error)| format!("{:.1},{:.1}", x(poses as f64), y(map_error))).collect();
        let dashes = if i == 1 { " stroke-dasharray=\"4 3\"" } else { "" };
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{dashes}/>\
             <path d=\"M{:.1} {:.1}h24\" stroke=\"{colour}\" stroke-width=\"2\"{dashes}/>\
             <text x=\"{:.1}\" y=\"{:.1}\">{name}</text>",
            points.join(" "),
            right - 232.0,
            TOP + 14.0 + 18.0 * i as f64,
            right - 202.0,
            TOP + 18.0 + 18.0 * i as f64
        );
    }
    svg + "</svg>"
}
