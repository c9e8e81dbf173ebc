//! Modules import only from those above them, and file formats and the terminal stay out of the mathematics.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::reading::{House, files_below, in_circles, is_word, without_comments};

/// The modules; each may use those above it.
const ORDER: [&str; 23] = [
    "figures",
    "lanes",
    "spatial",
    "selection",
    "camera",
    "target",
    "robot",
    "print",
    "sweep",
    "feasibility",
    "motion",
    "export",
    "information",
    "continuum",
    "calibration",
    "verification",
    "render",
    "formats",
    "problem",
    "plan",
    "experiment",
    "report",
    "cli",
];

/// The files and rooms in a room; each may use those before it, and all may use the room's own `mod.rs`.
const ROOMS: [(&str, &[&str]); 53] = [
    (
        "selection",
        &[
            "matrices",
            "group",
            "error",
            "highest",
            "function",
            "instance",
            "certificate",
            "greedy",
            "exchange",
            "influence",
            "relaxation",
            "best",
            "best_first",
            "search",
        ],
    ),
    ("selection::matrices", &["packed", "lanes", "information_set"]),
    ("selection::function", &["soft_minimum", "curvature", "eliminated"]),
    ("selection::instance", &["constraints", "packing", "value", "part"]),
    ("selection::search", &["node", "fewest"]),
    (
        "target",
        &[
            "error",
            "feature",
            "dictionary",
            "layout",
            "checkerboard",
            "charuco",
            "aprilgrid",
            "circles",
            "points",
            "board",
            "warp",
        ],
    ),
    ("robot", &["joint", "tree", "chain", "dh", "mechanism", "turn", "inverse"]),
    ("render", &["bodies"]),
    ("print", &["paper", "error", "artwork", "pattern", "layout", "svg", "pdf"]),
    ("print::artwork", &["text", "checkerboard", "modules", "charuco", "aprilgrid", "circles"]),
    ("print::layout", &["strip", "sheet", "tiles"]),
    ("sweep", &["candidates", "axes", "joints"]),
    (
        "feasibility",
        &[
            "rejection",
            "visibility",
            "shortfall",
            "solid",
            "hull",
            "travel",
            "collision",
            "occlusion",
            "stability",
            "views",
        ],
    ),
    (
        "information",
        &[
            "criterion",
            "unknowns",
            "image_area",
            "map_error",
            "weakest",
            "blur",
            "noise",
            "elimination",
            "view",
            "unweighted",
            "zhang",
            "diversity",
        ],
    ),
    ("motion", &["limits", "timing", "tour", "way", "safety", "journey", "course"]),
    ("motion::way", &["margins", "straight", "tree", "scout", "connect", "shorten", "search"]),
    (
        "export",
        &[
            "error",
            "program",
            "example",
            "text",
            "csv",
            "ros",
            "languages",
            "format",
            "model",
            "recording",
            "export_format",
        ],
    ),
    (
        "export::model",
        &["setup", "assembly", "example", "element", "placement", "assets", "note", "urdf", "mjcf", "sdf", "format"],
    ),
    ("export::model::assets", &["mesh", "hull", "plate"]),
    ("export::recording", &["cdr", "message", "moment", "topic"]),
    ("export::text", &["number", "comment", "name"]),
    ("export::ros", &["yaml", "goals", "joint_trajectory", "moveit_calibration", "robot_calibration"]),
    ("export::languages", &["axes", "urscript", "rapid", "krl", "fanuc_ls"]),
    ("motion::tour", &["costs", "bound", "circuit", "cycle", "exact", "search"]),
    (
        "continuum",
        &["taylor", "twist", "quadratic", "image", "frustum", "sight", "score", "pictures", "cell", "search"],
    ),
    (
        "calibration",
        &[
            "observations",
            "ties",
            "loss",
            "factor",
            "homography",
            "zhang",
            "start",
            "normal_equations",
            "observability",
            "refinement",
            "estimate",
            "coverage",
            "order",
            "robust",
            "scatter",
            "assessment",
        ],
    ),
    (
        "formats",
        &[
            "number",
            "error",
            "disk",
            "xml",
            "tree",
            "image_size",
            "mesh",
            "urdf",
            "board",
            "camera",
            "detections",
            "pose_list",
            "file",
        ],
    ),
    ("formats::board", &["kalibr", "opencv", "points"]),
    (
        "formats::pose_list",
        &[
            "listed",
            "joint_names",
            "table",
            "format",
            "plan",
            "robot_calibration",
            "moveit_calibration",
            "joint_trajectory",
            "easy_handeye2",
        ],
    ),
    (
        "problem",
        &[
            "note",
            "method",
            "disturbance",
            "robust",
            "motion",
            "constraints",
            "fault",
            "error",
            "diagnostic",
            "goal",
            "draft",
            "schema",
            "text",
            "resolve",
            "builder",
        ],
    ),
    ("plan", &["survey", "choose", "document", "results", "assess"]),
    ("plan::survey", &["contacts", "scenarios", "trial", "refine", "listed", "smell", "diagnosis", "continuum"]),
    (
        "plan::choose",
        &[
            "baseline",
            "choice",
            "constraints",
            "error",
            "home",
            "objective",
            "chooser",
            "refined_survey",
            "off_grid",
            "dual",
            "continuum",
            "tours",
            "plan_survey",
            "decide",
        ],
    ),
    ("plan::choose::tours", &["times", "swaps", "bound", "pulls", "spares", "timed"]),
    ("plan::choose::off_grid", &["local_search", "poses", "columns"]),
    ("plan::choose::baseline", &["points", "centres", "lloyd", "kmeans", "random"]),
    (
        "plan::document",
        &[
            "header",
            "error_grid",
            "plan",
            "views",
            "problem",
            "answers",
            "follow",
            "review",
            "study",
            "design",
            "refusal",
            "kind",
        ],
    ),
    ("plan::document::review", &["picture", "accuracy", "scene", "timeline", "space"]),
    (
        "plan::assess",
        &[
            "locate", "compare", "explain", "verify", "forecast", "polish", "next", "follow", "reach", "review",
            "certify", "score", "diff",
        ],
    ),
    (
        "plan::assess::follow",
        &[
            "answer",
            "until",
            "ways",
            "picture",
            "mismatch",
            "knowledge",
            "doubt",
            "announcement",
            "further",
            "tour",
            "events",
        ],
    ),
    ("plan::document::follow", &["state", "event"]),
    ("plan::assess::score", &["why", "pose", "swaps"]),
    ("plan::document::study", &["cell", "summary", "work"]),
    ("experiment", &["file", "reading", "base", "factor", "stages", "study", "engine", "codesign"]),
    ("experiment::file", &["factor", "study", "design"]),
    ("experiment::codesign", &["read", "evaluate", "sensitivity", "problem_file", "search"]),
    ("experiment::engine", &["quoting", "work", "job", "local", "slurm", "hyperqueue"]),
    ("experiment::study", &["table", "read", "cell", "store", "run", "statistics", "summary", "forecast"]),
    ("report", &["documents", "outcome", "figure", "drawing", "plots", "page"]),
    ("report::drawing", &["style", "strips"]),
    (
        "report::page",
        &[
            "facts",
            "head",
            "table",
            "picture",
            "space",
            "tour",
            "plan",
            "verification",
            "comparison",
            "diff",
            "calibration",
            "study",
            "design",
        ],
    ),
    (
        "report::plots",
        &["coverage", "accuracy", "poses", "tour", "space", "calibration", "comparison", "study", "design"],
    ),
    (
        "cli",
        &["interrupt", "own_files", "output", "arguments", "known", "memory", "long_work", "loaded_plan", "command"],
    ),
];

/// Crates that read files or talk to people, and the modules that may.
const OUTWARD: [&str; 6] = ["serde", "toml", "saphyr_parser", "roxmltree", "clap", "indicatif"];
const OUTWARD_MODULES: [&str; 5] = ["formats", "problem", "plan", "experiment", "cli"];

/// A source file, and the module at the crate's root that it belongs to.
struct Source {
    path: PathBuf,
    module: String,
    code: String,
}

fn sources() -> Vec<Source> {
    let root = Path::new("src");
    let source = |path: PathBuf| {
        let first = path.strip_prefix(root).unwrap().components().next().unwrap();
        let module = Path::new(first.as_os_str()).file_stem().unwrap().to_string_lossy().into_owned();
        Source { module, code: without_comments(&std::fs::read_to_string(&path).unwrap()), path }
    };
    let sources: Vec<Source> = files_below(root).into_iter().map(source).collect();
    assert!(sources.len() > 20, "the sources were not found");
    sources.into_iter().filter(|source| !["lib", "main"].contains(&source.module.as_str())).collect()
}

/// The modules that `code` names after `crate::`, also as in `crate::{a, b::c}`.
fn imported(code: &str) -> BTreeSet<String> {
    let first_word = |text: &str| text.trim_start().chars().take_while(|&c| is_word(c)).collect::<String>();
    let mut found = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        if code[..at].ends_with(is_word) || code[..at].ends_with('$') {
            continue;
        }
        let rest = &code[at + "crate::".len()..];
        let Some(group) = rest.strip_prefix('{') else {
            found.insert(first_word(rest));
            continue;
        };
        let mut depth = 0;
        for item in group.split_inclusive([',', '{', '}']) {
            if depth == 0 {
                found.insert(first_word(item));
            }
            match item.chars().last() {
                Some('{') => depth += 1,
                Some('}') if depth == 0 => break,
                Some('}') => depth -= 1,
                _ => {}
            }
        }
    }
    found.remove("");
    found
}

fn place(module: &str) -> Option<usize> {
    ORDER.iter().position(|&other| other == module)
}

#[test]
fn imports_are_found_in_all_their_forms() {
    let code = "use crate::camera::{Camera, Lens};\nuse crate::{spatial::{Pose, skew}, target, robot::dh};\n\
                let x: crate::sweep::Sweep; use other_crate::plan; macro!($crate::study);";
    let expected = ["camera", "robot", "spatial", "sweep", "target"];
    assert_eq!(imported(code).iter().map(String::as_str).collect::<Vec<_>>(), expected);
    assert_eq!(without_comments("a // crate::cli\n/// b\nc"), "a \n\nc");
}

#[test]
fn every_module_has_its_place() {
    for source in sources() {
        assert!(place(&source.module).is_some(), "{} belongs to no module of the order", source.path.display());
    }
}

#[test]
fn modules_import_only_from_those_above() {
    for source in sources() {
        for import in imported(&source.code) {
            let Some(above) = place(&import) else {
                panic!("{} names crate::{import}, which is no module of the order", source.path.display());
            };
            let own = place(&source.module).unwrap();
            assert!(above <= own, "{}: `{}` may not use `{import}`", source.path.display(), source.module);
        }
    }
}

#[test]
fn circles_are_found() {
    let module = |name: &str| vec![name.to_owned()];
    let edges = |arrows: &[(&str, &str)]| {
        let mut edges: BTreeMap<Vec<String>, BTreeSet<Vec<String>>> = BTreeMap::new();
        for (from, to) in arrows {
            edges.entry(module(from)).or_default().insert(module(to));
            edges.entry(module(to)).or_default();
        }
        edges
    };
    assert!(in_circles(edges(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    assert_eq!(in_circles(edges(&[("a", "b"), ("b", "c"), ("c", "b"), ("c", "d")])), ["b -> c", "c -> b"]);
    // What a room hands on is led to the file that holds it.
    let taken = &House::read().edges()[&["plan", "assess", "polish"].map(String::from).to_vec()];
    assert!(taken.contains(&["plan", "choose", "chooser"].map(String::from).to_vec()), "{taken:?}");
}

#[test]
fn no_files_take_from_each_other_in_a_circle() {
    let circles = in_circles(House::read().edges());
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn inside_a_room_files_take_only_from_those_before_them() {
    let house = House::read();
    let edges = house.edges();
    for (room, order) in ROOMS {
        let room: Vec<String> = room.split("::").map(String::from).collect();
        let stated: BTreeSet<String> = order.iter().map(|&file| file.to_owned()).collect();
        assert_eq!(stated, house.in_room(&room), "files of {}", room.join("::"));
        let place = |module: &[String]| {
            let file = module.get(room.len()).map_or("mod", String::as_str);
            order.iter().position(|&other| other == file)
        };
        for (from, targets) in edges.iter().filter(|(from, _)| from.starts_with(&room)) {
            for to in targets.iter().filter(|to| to.starts_with(&room)) {
                assert!(place(to) <= place(from), "{} takes from {}", from.join("::"), to.join("::"));
            }
        }
    }
}

/// A plan is certified by its own reading of the definitions, or a mistake in them would confirm itself.
#[test]
fn certify_shares_nothing_with_what_it_certifies() {
    let root = Path::new("src/plan/assess/certify");
    let files = files_below(root);
    assert!(files.len() > 3, "{files:?}");
    for path in files {
        let code = without_comments(&std::fs::read_to_string(&path).unwrap());
        for word in ["selection", "choose", "Chooser", "PlanError", "SelectionError"] {
            // What the problem asks for is called its selection, too.
            let asked = ["goal", "seed", "pictures", "continuum", "leaves_grid", "tour_tolerance"]
                .map(|key| format!("problem.selection.{key}"));
            let own = asked.iter().fold(code.clone(), |code, key| code.replace(key, ""));
            assert!(!own.split(|c| !is_word(c)).any(|other| other == word), "{} names `{word}`", path.display());
        }
    }
}

#[test]
fn the_mathematics_knows_neither_files_nor_terminals() {
    for source in sources() {
        if OUTWARD_MODULES.contains(&source.module.as_str()) {
            continue;
        }
        let words = source.code.split(|c| !is_word(c));
        for word in words {
            // serde_json and toml_edit are as little welcome as serde and toml.
            let outward = OUTWARD.iter().find(|&&name| word == name || word.starts_with(&format!("{name}_")));
            assert!(outward.is_none(), "{} mentions {word}", source.path.display());
        }
    }
}
