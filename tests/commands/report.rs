//! Reports and figures: whole pages that need nothing, made again as they were, and files fit for a paper.

use std::fs;

use calipose::plan::document::{Explanation, Plan, Review};
use calipose::report::{Disagreement, PlanDocuments, plan_drawings, plan_figures, plan_page};
use roxmltree::Document;
use serde_json::Value;

use crate::desk::{Desk, command, stdout, text};

fn planned() -> (Desk, Value) {
    let desk = Desk::new();
    let plan = desk.json("plan coarse.toml -k 8 --trials 40 -o out --json");
    (desk, plan)
}

fn ids(plan: &Value) -> Vec<u64> {
    plan["poses"].as_array().unwrap().iter().map(|pose| pose["id"].as_u64().unwrap()).collect()
}

#[test]
fn a_report_is_one_page_that_needs_nothing_else() {
    let (desk, plan) = planned();
    let page = fs::read_to_string(desk.path("out/report.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.len() < 3_000_000, "{}", page.len());
    for outward in ["src=\"http", "href=\"http", "src='http", "@import", "url(http"] {
        assert!(!page.contains(outward), "{outward}");
    }
    // The verdict is in the first line of the page's text, then what to do.
    let verdict = page.find("class=\"verdict good\"").unwrap();
    assert!(verdict < page.find("class=\"next\"").unwrap() && page.contains("Collision was not tested"));
    for id in ids(&plan) {
        for mark in [format!("data-pose=\"{id}\""), format!("data-pose-panel=\"{id}\""), format!("<title>pose {id}")] {
            assert!(page.contains(&mark), "{mark}");
        }
    }
    for figure in [
        "coverage-directions",
        "coverage-pictures",
        "error-by-poses",
        "error-over-image",
        "error-over-image-other",
        "sampled-sigma",
        "correlation",
        "rejections",
        "joints",
    ] {
        assert!(page.contains(&format!("id=\"{figure}\"")), "{figure}");
    }
    assert!(!page.contains("NaN") || !page.contains(">NaN<"));

    // Every plot and picture is an image with a name, as wide as its place; the tour is drawn for wide and for narrow ones.
    let images = page.matches("<svg viewBox=\"").count();
    assert_eq!((images, page.matches("role=\"img\" aria-label=\"").count()), (9 + 8 + 2, 9 + 8 + 2));

    // Written anew it is the same, byte by byte.
    let said = desk.stdout("report out/plan.json");
    assert!(said.contains("Written to out/report.html"), "{said}");
    assert!(page == fs::read_to_string(desk.path("out/report.html")).unwrap());
    desk.stdout("certify out/plan.json -q");
}

#[test]
fn a_report_draws_the_tour_in_time() {
    let (desk, plan) = planned();
    let page = fs::read_to_string(desk.path("out/report.html")).unwrap();
    let tour = &page[page.find("<section id=\"tour\">").unwrap()..page.find("<section id=\"picture\">").unwrap()];
    for joint in ["waist [°]", "shoulder [°]", "elbow [°]", "neck [°]", "time [s]"] {
        // Wide and narrow.
        assert_eq!(tour.matches(&format!(">{joint}</text>")).count(), 2, "{joint}");
    }
    for id in ids(&plan) {
        assert_eq!(tour.matches(&format!("<title>pose {id}: pictures at ")).count(), 2, "{id}");
    }
    assert!(tour.contains("nothing is tested, so nothing is known") && !tour.contains("Clearance"), "{tour}");
    assert!(tour.contains("In this order the moves take"));

    // With bodies, and a move that is not straight and one that is not safe.
    let problem = std::path::absolute("problems/servosila-engineer-bodies.toml").unwrap();
    desk.run(&format!("plan {} -q --set sweep.step_deg=15 -k 6 --trials 0 -o bodies", problem.display()));
    let mut plan: Plan = serde_json::from_str(&fs::read_to_string(desk.path("bodies/plan.json")).unwrap()).unwrap();
    let mut review: Review =
        serde_json::from_value(desk.json(&format!("report bodies/plan.json --problem {} --json", problem.display())))
            .unwrap();
    let explanation: Explanation = serde_json::from_str(
        &desk.stdout(&format!("explain bodies/plan.json --problem {} --most 1 --json", problem.display())),
    )
    .unwrap();
    let page = |plan: &Plan, review: &Review| {
        let documents = PlanDocuments::new(plan, review, &explanation, None).unwrap();
        let page = plan_page(&documents);
        page[page.find("<section id=\"tour\">").unwrap()..page.find("<section id=\"picture\">").unwrap()].to_owned()
    };
    let safe = page(&plan, &review);
    let timeline = review.timeline.as_mut().unwrap();
    for curve in timeline.curves() {
        let least = format!("{:.1} mm", 1e3 * curve.least_m());
        let time = format!("data-time=\"{}\"", timeline.measured_s[curve.least]);
        assert!(safe.contains(&format!("<strong>{least}</strong>")) && safe.contains(&time), "{least} {time}: {safe}");
    }
    for words in
        ["Clearance [mm]", "Tip-over margin [mm]", "required", "Nothing is measured in between", "Proven all along"]
    {
        assert!(safe.contains(words), "{words}");
    }
    assert!(!safe.contains("not proven safe.</strong>") && !safe.contains(": goes round about"), "{safe}");
    timeline.moves[1].safe = Some(false);
    let leg = timeline.moves[2].legs[0].clone();
    timeline.moves[2].legs.push(leg);
    plan.tour.as_mut().unwrap().moves[1].safe = Some(false);
    let marked = page(&plan, &review);
    for words in [
        "<title>move 2, from pose 2 to pose 3: not proven safe</title>",
        "<title>move 3, from pose 3 to pose 4: goes round about, with one turn</title>",
        "<strong>not proven safe</strong>",
        "round about, with one turn. ",
        "NOT SAFE",
    ] {
        assert!(marked.contains(words), "{words}: {marked}");
    }
}

#[test]
fn a_report_follows_what_is_known_of_the_plan() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 -o out");
    let page = fs::read_to_string(desk.path("out/report.html")).unwrap();
    assert!(page.contains("has not been tried in simulated calibrations") && !page.contains("id=\"sampled-sigma\""));
    // With the same plan's trials beside it.
    desk.stdout("plan coarse.toml -q -k 8 --trials 40 -o out");
    let tried = fs::read_to_string(desk.path("out/report.html")).unwrap();
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 -o out");
    assert!(
        tried.contains("id=\"sampled-sigma\"") && tried == fs::read_to_string(desk.path("out/report.html")).unwrap()
    );
    // Another plan's are not taken for its own.
    desk.stdout("plan coarse.toml -q -k 9 --trials 0 -o out");
    assert!(!fs::read_to_string(desk.path("out/report.html")).unwrap().contains("id=\"sampled-sigma\""));
    // What is not the map error has no bound on it.
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 --criterion d -o d");
    let page = fs::read_to_string(desk.path("d/report.html")).unwrap();
    assert!(
        page.contains("nothing is proven of this error") && !page.contains("no choice of these views can be below")
    );
}

#[test]
fn the_bound_on_other_numbers_of_poses_holds() {
    let (desk, plan) = planned();
    let review = desk.json("report out/plan.json --json");
    let explained = desk.json("explain out/plan.json --most 16 --json");
    let mut proven = 0;
    for point in review["curve"].as_array().unwrap() {
        let (Some(bound), count) = (point["bound_px"].as_f64(), point["count"].as_u64().unwrap()) else { continue };
        // What `explain` finds for so many, its own relaxation behind it.
        let other = explained["curve"].as_array().unwrap().iter().find(|other| other["count"] == count).unwrap();
        if let Some(found) = other["map_error_px"].as_f64() {
            assert!(bound <= found * (1.0 + 1e-9), "{count}: {bound} {found}");
            proven += 1;
        }
        if let Some(tight) = other["bound"].as_f64() {
            assert!(bound <= tight.sqrt() * (1.0 + 1e-6), "{count}: {bound} {tight}");
        }
        if count == plan["count"].as_u64().unwrap() {
            assert!((bound * bound / plan["bound"].as_f64().unwrap() - 1.0).abs() < 1e-9);
        }
    }
    assert!(proven > 6, "{proven}");
}

#[test]
fn what_is_no_plan_of_the_problem_has_no_report() {
    let (desk, mut plan) = planned();
    let before = desk.files("out");
    desk.change("changed.toml", &[("sigma_px = 0.3", "sigma_px = 0.4")]);
    for command in ["report", "figures"] {
        assert!(desk.complaint(&format!("{command} none.json"), 3).contains("none.json"));
        let changed = desk.complaint(&format!("{command} out/plan.json --problem changed.toml"), 3);
        assert!(changed.contains("another version"), "{changed}");
        plan["version"] = 2.into();
        fs::write(desk.path("old.json"), plan.to_string()).unwrap();
        assert!(desk.complaint(&format!("{command} old.json --problem coarse.toml"), 3).contains("make a new plan"));
        let whole = fs::read_to_string(desk.path("out/plan.json")).unwrap();
        fs::write(desk.path("cut.json"), &whole[..whole.len() / 2]).unwrap();
        assert!(desk.complaint(&format!("{command} cut.json --problem coarse.toml"), 3).contains("not a plan"));
    }
    assert_eq!(desk.files("out"), before);
}

#[test]
fn a_mesh_that_is_gone_is_named() {
    let desk = Desk::new();
    fs::create_dir(desk.path("urdf")).unwrap();
    // The hand's box as a mesh.
    let urdf = fs::read_to_string("problems/urdf/six-axis-rover.urdf").unwrap();
    let (before, hand) = urdf.split_at(urdf.find("<link name=\"hand\">").unwrap());
    let start =
        hand.find("<collision>").unwrap() + hand[hand.find("<collision>").unwrap()..].find("<geometry>").unwrap();
    let end = hand.find("</collision>").unwrap();
    let mesh = "<geometry><mesh filename=\"hand.obj\"/></geometry>";
    fs::write(desk.path("urdf/six-axis-rover.urdf"), [before, &hand[..start], mesh, &hand[end..]].concat()).unwrap();
    let corners: String = (0..8).map(|i| format!("v {} {} {}\n", i & 1, i >> 1 & 1, i >> 2)).collect();
    let small = corners.replace('1', "0.02");
    fs::write(desk.path("urdf/hand.obj"), format!("{small}f 1 2 4\nf 5 6 8\nf 1 5 7\nf 2 6 8\n")).unwrap();
    fs::copy("problems/six-axis-rover.toml", desk.path("rover.toml")).unwrap();
    desk.stdout("plan rover.toml -q --set sweep.sample=40000 --set sweep.refine=0 --set selection.off_grid=false -k 6 --trials 0 -o out");
    let page = fs::read_to_string(desk.path("out/report.html")).unwrap();
    assert!(page.contains("\"kind\":\"mesh\"") && page.contains("least clearance"));
    let before = desk.files("out");
    fs::remove_file(desk.path("urdf/hand.obj")).unwrap();
    for command in ["report", "figures"] {
        let told = desk.complaint(&format!("{command} out/plan.json"), 3);
        assert!(told.contains("hand.obj"), "{told}");
    }
    assert_eq!(desk.files("out"), before);
    assert!(page == fs::read_to_string(desk.path("out/report.html")).unwrap());
}

#[test]
fn a_picture_shows_what_hides_the_board() {
    let desk = Desk::new();
    let problem = std::path::absolute("problems/servosila-engineer-bodies.toml").unwrap();
    desk.run(&format!(
        "plan {} -q --set sweep.step_deg=15 -k 6 --trials 0 --set visibility.min_corners=20 -o out",
        problem.display()
    ));
    let review = desk.json(&format!("report out/plan.json --problem {} --json", problem.display()));
    let poses = review["poses"].as_array().unwrap();
    let [mut before, mut behind] = [0, 0];
    for pose in poses {
        let picture = &pose["picture"];
        for body in picture["bodies"].as_array().unwrap() {
            assert!(body["outline_px"].as_array().unwrap().len() >= 3, "{body}");
            *(if body["before_board"] == true { &mut before } else { &mut behind }) += 1;
        }
        let hidden = picture["hidden"].as_array().unwrap();
        let unseen = picture["unseen"].as_array().unwrap();
        assert!(hidden.iter().all(|corner| unseen.contains(corner)), "{picture}");
        let share = picture["image_share"].as_f64().unwrap();
        assert!((0.0..1.0).contains(&share), "of the corners seen: {share}");
        assert!(pose["nearest"]["distance_m"].as_f64().unwrap() >= 0.0, "{pose}");
    }
    assert!(before > 0 && behind > 0, "{before} {behind}");
}

#[test]
fn documents_that_do_not_agree_have_no_plots() {
    let (desk, plan) = planned();
    let explanation: Explanation = serde_json::from_str(&desk.stdout("explain out/plan.json --most 1 --json")).unwrap();
    let review = desk.json("report out/plan.json --json");
    let plan: Plan = serde_json::from_value(plan).unwrap();
    let figures = |review: &Value| -> Result<usize, Disagreement> {
        let review: Review = serde_json::from_value(review.clone()).unwrap();
        let documents = PlanDocuments::new(&plan, &review, &explanation, None)?;
        assert!(plan_page(&documents).len() > 100_000);
        Ok(plan_figures(&documents).len() + plan_drawings(&documents).len())
    };
    assert_eq!(figures(&review), Ok(12));
    for (pointer, disagreement) in [
        ("/views/tilt_deg/0", Disagreement::Lengths("views")),
        ("/views/positions_m/0", Disagreement::Lengths("views")),
        ("/poses/1/joints/0", Disagreement::Lengths("poses")),
        ("/correlation/0", Disagreement::Lengths("correlation")),
        ("/correlation/2/0", Disagreement::Lengths("correlation")),
        ("/error_map/error_px/0", Disagreement::Lengths("error_map")),
        ("/others/0/error_map/v_px/0", Disagreement::Lengths("error_map")),
        ("/joints/0", Disagreement::Lengths("poses")),
        ("/links/3", Disagreement::Names("links")),
        ("/timeline/start/0", Disagreement::Lengths("timeline")),
        ("/timeline/moves/1/legs/0/to/0", Disagreement::Lengths("timeline")),
        ("/timeline/pictures/0", Disagreement::Poses),
        ("/poses/0", Disagreement::Poses),
    ] {
        let mut changed = review.clone();
        let (list, index) = pointer.rsplit_once('/').unwrap();
        changed.pointer_mut(list).unwrap().as_array_mut().unwrap().remove(index.parse().unwrap());
        assert_eq!(figures(&changed), Err(disagreement), "{pointer}");
    }
    for (key, name) in [("camera_link", "camera_link"), ("base_link", "base_link")] {
        let mut changed = review.clone();
        changed[key] = 99.into();
        assert_eq!(figures(&changed), Err(Disagreement::Names(name)));
    }
}

#[test]
fn other_documents_have_pages_too() {
    let (desk, _) = planned();
    let page = |name: &str| fs::read_to_string(desk.path(name)).unwrap();
    desk.stdout("report out/verification.json -q");
    assert!(page("out/verification.html").contains("id=\"sampled-sigma\""));
    let compared = desk.stdout("compare coarse.toml -k 8 -k 10 --seeds 1 --limit 20 --trials 2 --json");
    fs::write(desk.path("compared.json"), compared).unwrap();
    assert!(desk.stdout("report compared.json").contains("Written to compared.html"));
    for method in ["best", "kmeans-joints", "random"] {
        assert!(page("compared.html").contains(&format!("<td>{method}</td>")), "{method}");
    }
    let corners = std::path::absolute("problems/examples/servosila-corners.vnl").unwrap();
    desk.run(&format!("calibrate {} --problem coarse.toml -o camera", corners.display()));
    let calibrated = page("camera/calibration.html");
    for part in ["id=\"residuals\"", "id=\"residuals-by-picture\"", "id=\"error-over-image\"", "id=\"pictures\""] {
        assert!(calibrated.contains(part), "{part}");
    }
    fs::remove_file(desk.path("camera/calibration.html")).unwrap();
    desk.stdout("report camera/calibration.json -q");
    assert_eq!(calibrated, page("camera/calibration.html"));

    assert!(desk.complaint("report out/run.json", 3).contains("\"calipose.run\"; pages are made of calipose.plan"));

    // Nobody's page is lost, and what this version would misread is refused.
    fs::write(desk.path("compared.html"), "<p>mine").unwrap();
    assert!(desk.complaint("report compared.json", 1).contains("compared.html"));
    assert_eq!(page("compared.html"), "<p>mine");
    let mut old: Value = serde_json::from_str(&page("out/verification.json")).unwrap();
    old["version"] = 1.into();
    fs::write(desk.path("old.json"), old.to_string()).unwrap();
    assert!(desk.complaint("report old.json", 3).contains("version 1 of calipose.verification"));
    old["version"] = 2.into();
    old.as_object_mut().unwrap().remove("trials");
    fs::write(desk.path("old.json"), old.to_string()).unwrap();
    assert!(desk.complaint("report old.json", 3).contains("trials"));
}

#[test]
fn figures_are_drawn_at_their_size() {
    let (desk, _) = planned();
    let all = desk.json("figures out/plan.json --format svg --width-mm 85 --font-pt 7 --json");
    let files = all["files"].as_array().unwrap();
    assert_eq!(files.len(), 14, "{all}");
    for file in files {
        let svg = fs::read_to_string(desk.path("out/figures").join(file["file"].as_str().unwrap())).unwrap();
        let drawing = Document::parse(&svg).unwrap();
        let width: f64 = drawing.root_element().attribute("width").unwrap().parse().unwrap();
        assert!((width - 85.0 / 25.4 * 96.0).abs() < 0.01, "{file}: {width}");
        assert!(!svg.contains("var(--"), "{file}: colours of a page");
    }
    // A picture of 100 dots an inch, two inches wide.
    desk.stdout("figures out/plan.json -q --format png --only joints,arm,tour --width-mm 50.8 --dpi 100 -o shots");
    assert_eq!(desk.files("shots"), ["arm.png", "joints.png", "tour.png"]);
    let png = fs::read(desk.path("shots/arm.png")).unwrap();
    assert_eq!(&png[1..4], b"PNG");
    assert_eq!(u32::from_be_bytes(png[16..20].try_into().unwrap()), 200);
    for (wrong, words) in [
        ("--only arms", "it has coverage-directions"),
        ("--width-mm 0", "from 20 to 2000"),
        ("--font-pt nan", "from 2 to 100"),
        ("--width-mm 2000 --dpi 2400", "take a smaller --dpi"),
    ] {
        let told = desk.complaint(&format!("figures out/plan.json {wrong}"), 2);
        assert!(told.contains(words), "{wrong}: {told}");
    }
}

#[test]
fn the_summary_fits_a_terminal_and_says_the_verdict_first() {
    let desk = Desk::new();
    let told = desk.stdout("plan coarse.toml -k 8 -o out");
    let second = told.lines().nth(1).unwrap();
    assert!(second.starts_with("Verdict: "), "{told}");
    let seven = "plan problems/seven-axis-carrier.toml --set sweep.sample=60000 --set selection.off_grid=false --trials 0 -k 6 -o";
    let folder = tempfile::tempdir().unwrap();
    let here = std::env::current_dir().unwrap();
    let seven = stdout(&here, &format!("{seven} {}", folder.path().display()));
    assert!(seven.contains("Joints: j1 "), "{seven}");
    let plan = format!("{}/plan.json", folder.path().display());
    let seven_axis = "problems/seven-axis-carrier.toml";
    let others = [
        format!("explain {plan} --most 2 --spares 2"),
        format!("reach {seven_axis} --distance-mm 400"),
        format!("check {seven_axis}"),
        "sweep problems/servosila-engineer.toml --step 10,20".into(),
        "reach problems/servosila-engineer-bodies.toml --position-mm 200,0,600 --rpy-deg 180,0,0".into(),
    ];
    let others: String = others.iter().map(|line| text(&command(&here, line).output().unwrap().stdout)).collect();
    for words in ["Joints: j1 joint_1, ", "Loss in %", "Collision: none.", "publ. Q"] {
        assert!(others.contains(words), "{words}: {others}");
    }
    for line in told
        .lines()
        .chain(seven.lines())
        .chain(others.lines())
        .filter(|line| !line.contains("Written to") && !line.starts_with('/'))
    {
        assert!(line.chars().count() <= 80, "{} columns: {line}", line.chars().count());
    }
    assert!(told.contains("██████ "), "{told}");
    let quiet = desk.run("plan coarse.toml -q -k 8 -o out");
    assert_eq!(text(&quiet.stdout), "");
}
