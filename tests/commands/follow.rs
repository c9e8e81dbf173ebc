//! `calipose follow` carries a plan out: by a person's answers, by a program's, and by the pictures that a detector finds.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use calipose::problem::Problem;
use calipose::verification::simulate;
use serde_json::Value;

use crate::desk::{Desk, is_ignored_here, signal, text};

/// How long an event may take on a busy machine.
const PATIENCE: Duration = Duration::from_mins(2);

/// A desk with a plan of nine poses, and an empty folder for detections.
fn desk() -> (Desk, Value) {
    let desk = Desk::new();
    desk.change("coarse.toml", &[("step_deg = 15", "step_deg = 20")]);
    std::fs::create_dir(desk.path("seen")).unwrap();
    let plan = desk.json("plan coarse.toml -k 9 --trials 0 -o out --json");
    (desk, plan)
}

/// A tour that is on, with what a robot's program has of it.
struct Tour<'a> {
    desk: &'a Desk,
    child: Child,
    stdin: Option<ChildStdin>,
    events: Receiver<Value>,
}

impl<'a> Tour<'a> {
    fn begin(desk: &'a Desk, options: &str) -> Self {
        let mut command = desk.command(&format!("follow out/plan.json --json {options}"));
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let (sender, events) = channel();
        std::thread::spawn(move || {
            for line in lines {
                drop(sender.send(serde_json::from_str(&line.unwrap()).unwrap()));
            }
        });
        let stdin = child.stdin.take();
        Self { desk, child, stdin, events }
    }

    fn next(&self) -> Value {
        self.events.recv_timeout(PATIENCE).unwrap()
    }

    /// The next event of that kind; those before it are of others that may come.
    fn until(&self, kind: &str) -> Value {
        loop {
            let event = self.next();
            assert_eq!(event["format"], "calipose.follow-event");
            if event["event"] == kind {
                return event;
            }
            assert!(["picture", "known", "unknown", "more"].contains(&event["event"].as_str().unwrap()), "{event}");
        }
    }

    fn answer(&mut self, line: &str) {
        writeln!(self.stdin.as_mut().unwrap(), "{line}").unwrap();
    }

    /// What a detector finds at a pose, in a file of its own.
    fn picture(&self, event: &Value, seed: u64) {
        let name = format!("{seed}.vnl");
        std::fs::write(self.desk.path("seen").join(name), corners(self.desk, &event["pose"], seed)).unwrap();
    }

    /// Its exit code and what it complains of.
    fn end(mut self) -> (Option<i32>, String) {
        drop(self.stdin.take());
        let output = self.child.wait_with_output().unwrap();
        (output.status.code(), text(&output.stderr))
    }
}

/// A table of the corners that the coarse problem's camera sees from a pose.
fn corners(desk: &Desk, pose: &Value, seed: u64) -> String {
    let problem = Problem::read(&desk.path("coarse.toml")).unwrap();
    let q: Vec<f64> = serde_json::from_value(pose["joints_rad"].clone()).unwrap();
    let X_CT = problem.robot.camera_pose(&q).inverse() * problem.target.X_BT;
    let seen = simulate(&problem.camera, &problem.target.board, &[X_CT], problem.noise, seed).unwrap();
    let mut table = String::from("# filename x y level\n");
    for corner in &seen.views()[0] {
        writeln!(table, "{seed}.png {} {} 0", corner.pixel.x, corner.pixel.y).unwrap();
    }
    table
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// What the program prints to a person who types these lines, and its exit code.
fn typed(desk: &Desk, line: &str, lines: &str) -> (String, Option<i32>) {
    let mut command = desk.command(line);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    (text(&output.stdout), output.status.code())
}

#[test]
fn a_person_goes_through_the_poses_by_enter() {
    let (desk, plan) = desk();
    let (said, code) = typed(&desk, "follow out/plan.json", "\nfoo\nskip\nback\nquit\n");
    assert_eq!(code, Some(4), "{said}");
    // How long it took differs from time to time.
    let said: String =
        said.lines().filter(|line| !line.starts_with("It took")).map(|line| format!("{line}\n")).collect();
    insta::assert_snapshot!(said);
    let state = read(&desk.path("out/follow.json"));
    assert_eq!((&state["format"], &state["place"]), (&"calipose.follow".into(), &1.into()));
    // On it goes, to the end; the order is that of the tour.
    let (said, code) = typed(&desk, "follow out/plan.json", "done\n\n\n\n\n\n\n\n");
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("The tour goes on at pose 2") && said.contains("9 of 9 poses taken"), "{said}");
    let places: Vec<usize> = plan["tour"]["order"]
        .as_array()
        .unwrap()
        .iter()
        .skip(1)
        .map(|id| said.find(&format!("(id {id})")).unwrap_or_else(|| panic!("{id} in {said}")))
        .collect();
    assert!(places.is_sorted());
    // Other commands do not mind the file, nor does the same plan made again; another plan takes it away.
    desk.json("verify out/plan.json -n 30 --json");
    desk.stdout("plan coarse.toml -k 9 --trials 0 -o out");
    assert!(desk.path("out/follow.json").exists());
    let said = desk.stdout("plan coarse.toml -k 10 --trials 0 -o out");
    assert!(said.contains("follow.json") && !desk.path("out/follow.json").exists(), "{said}");
}

#[test]
fn a_program_ends_the_tour_as_soon_as_the_pictures_reach_the_accuracy() {
    let (desk, plan) = desk();
    let limit = 2.0 * plan["map_error_px"].as_f64().unwrap();
    let options = format!("--watch seen --until map_error_px={limit} -o camera");
    let tour = Tour::begin(&desk, &options);
    let mut event = tour.next();
    let mut taken = 0;
    let ended = loop {
        assert_eq!(event["event"], "pose");
        assert_eq!(event["pose"]["id"], plan["tour"]["order"][taken]);
        assert_eq!(event["pose"]["visit"], taken + 1);
        assert!(event["pose"]["turns_rad"].is_array());
        tour.picture(&event, taken as u64);
        taken += 1;
        event = loop {
            let event = tour.next();
            if ["pose", "end"].contains(&event["event"].as_str().unwrap()) {
                break event;
            }
            if event["event"] == "known" {
                assert_eq!(event["known"]["views"], taken);
                let map_error = event["known"]["map_error_px"].as_f64().unwrap();
                assert_eq!(event["known"]["reached"] == true, map_error <= limit, "{event}");
            }
        };
        if event["event"] == "end" {
            break event["end"].clone();
        }
    };
    assert_eq!(tour.end(), (Some(0), String::new()));
    assert_eq!((&ended["why"], &ended["good"], &ended["output"]), (&"accuracy".into(), &true.into(), &"camera".into()));
    assert!(taken < 9 && ended["left"] == 9 - taken, "{ended}");
    // The calibration is that of its corners, by `calibrate`.
    let files = ["calibration.json", "corners.vnl", "camera.opencv.yaml"];
    assert!(files.iter().all(|file| desk.files("camera").contains(&(*file).to_owned())), "{:?}", desk.files("camera"));
    let mut ours = read(&desk.path("camera/calibration.json"));
    let line = format!("calibrate camera/corners.vnl --problem coarse.toml --map-error-px {limit} -o again --json");
    let mut again = desk.json(&line);
    for document in [&mut ours, &mut again] {
        document.as_object_mut().unwrap().remove("problem");
    }
    assert_eq!(ours, again);
    // Whoever asks once more is told at once; a better one takes more pictures.
    let tour = Tour::begin(&desk, &options);
    assert_eq!(tour.until("end")["end"]["why"], "accuracy");
    assert_eq!(tour.end().0, Some(0));
    let mut tour = Tour::begin(&desk, "--watch seen");
    assert_eq!(tour.until("pose")["pose"]["visit"], taken + 1);
    drop(tour.stdin.take());
    assert_eq!(tour.until("end")["end"]["why"], "closed");
}

#[test]
fn a_killed_tour_goes_on_and_an_interrupted_one_too() {
    let (desk, _) = desk();
    // Where the tests themselves run without SIGINT, as in the background of a script, so does what they start.
    let interrupt = if is_ignored_here(2) { "TERM" } else { "INT" };
    for (turn, name) in ["KILL", interrupt, "TERM"].into_iter().enumerate() {
        let mut tour = Tour::begin(&desk, "--watch seen");
        let event = tour.until("pose");
        assert_eq!(event["pose"]["visit"], turn + 1);
        tour.picture(&event, turn as u64);
        assert_eq!(tour.until("pose")["pose"]["visit"], turn + 2);
        signal(&tour.child, name);
        let status = tour.child.wait().unwrap();
        assert!([None, Some(130), Some(143)].contains(&status.code()), "{status}");
        let state = read(&desk.path("out/follow.json"));
        let pictures = state["visits"].as_array().unwrap().iter().filter(|visit| visit["pictures"][0].is_object());
        assert_eq!((pictures.count(), &state["place"]), (turn + 1, &(turn + 1).into()));
        let hidden = desk.files("out").into_iter().filter(|name| name.starts_with('.'));
        assert_eq!(hidden.count(), 0);
    }
    let tour = Tour::begin(&desk, "--watch seen");
    assert_eq!(tour.until("pose")["pose"]["visit"], 4);
    assert_eq!(tour.end().0, Some(4));
    let tour = Tour::begin(&desk, "--watch seen --restart");
    // The pictures are there before the pose is announced.
    assert_eq!(tour.next()["event"], "early");
    assert_eq!(tour.until("pose")["pose"]["visit"], 1);
}

#[test]
fn files_are_waited_for_until_they_are_whole() {
    let (desk, _) = desk();
    std::fs::write(desk.path("seen/old.vnl"), "no corners").unwrap();
    std::fs::write(desk.path("seen/notes.txt"), "no corners").unwrap();
    let mut tour = Tour::begin(&desk, "--watch seen");
    let old = tour.next();
    assert_eq!(old["event"], "unreadable");
    assert!(old["message"].as_str().unwrap().starts_with("old.vnl cannot be read"), "{old}");
    let event = tour.until("pose");
    // Half of a table, as a slow detector leaves it.
    let table = corners(&desk, &event["pose"], 7);
    let half: String = table.lines().take(20).map(|line| format!("{line}\n")).collect();
    std::fs::write(desk.path("seen/7.vnl"), half).unwrap();
    let unreadable = tour.next();
    assert_eq!(unreadable["event"], "unreadable");
    assert!(unreadable["message"].as_str().unwrap().starts_with("7.vnl cannot be read"), "{unreadable}");
    std::fs::write(desk.path("seen/7.vnl"), &table).unwrap();
    let picture = tour.until("picture");
    assert_eq!((&picture["picture"]["file"], &picture["picture"]["corners"]), (&"7.vnl".into(), &48.into()));
    assert_eq!(tour.until("pose")["pose"]["visit"], 2);
    // A board that was not found, and an answer that is none.
    std::fs::write(desk.path("seen/8.vnl"), "# filename x y level\n8.png - -\n").unwrap();
    let doubt = tour.next();
    assert_eq!((&doubt["event"], &doubt["picture"]["name"]), (&"doubt".into(), &"8.png".into()));
    assert_eq!(doubt["picture"]["doubts"][0], "the board was not found in it");
    tour.answer("yes");
    let refused = tour.next();
    assert_eq!(refused["event"], "refused");
    assert_eq!(refused["message"], "\"yes\" is no answer; answers are Enter or done, skip, back, again, quit.");
    tour.answer("done");
    assert!(tour.next()["message"].as_str().unwrap().contains("take another"));
    tour.answer("back");
    assert_eq!(tour.until("pose")["pose"]["taken"], 1);
    tour.answer("quit");
    assert_eq!(tour.until("end")["end"]["why"], "quit");
    assert_eq!(tour.end().0, Some(4));
}

#[test]
fn one_file_may_grow_and_poses_are_added() {
    let (desk, plan) = desk();
    let limit = 0.85 * plan["map_error_px"].as_f64().unwrap();
    let tour = Tour::begin(&desk, &format!("--detections seen/all.vnl --until map_error_px={limit} --more 2"));
    let mut all = String::new();
    let mut visits = Vec::new();
    let mut event = tour.next();
    let ended = loop {
        if event["event"] == "end" {
            break event["end"].clone();
        }
        if event["event"] == "pose" {
            let pose = &event["pose"];
            visits.push(pose["visits"].as_u64().unwrap());
            if pose["visit"].as_u64().unwrap() > 9 {
                assert!(pose["way"]["seconds"].as_f64().unwrap() > 0.0 && pose["from"].is_u64(), "{event}");
            }
            let table = corners(&desk, pose, visits.len() as u64);
            all += if all.is_empty() { &table } else { table.split_once('\n').unwrap().1 };
            std::fs::write(desk.path("seen/all.vnl"), &all).unwrap();
        }
        event = tour.next();
    };
    assert_eq!(visits[..9], [9; 9]);
    assert!((10..=11).contains(&visits.len()), "{visits:?}");
    let good = ended["why"] == "accuracy";
    assert_eq!(tour.end().0, Some(if good { 0 } else { 4 }), "{ended}");
    assert_eq!(
        read(&desk.path("out/follow.json"))["visits"][9]["added"]["pose"]["joints_rad"].as_array().unwrap().len(),
        4
    );
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let (desk, _) = desk();
    assert!(desk.complaint("follow none/plan.json", 3).contains("cannot use the plan none/plan.json"));
    assert!(desk.complaint("follow out/run.json", 3).contains("in a plan it is \"calipose.plan\""));
    insta::assert_snapshot!(desk.complaint("follow out/plan.json --watch none", 2));
    insta::assert_snapshot!(desk.complaint("follow out/plan.json --watch seen --until fz=1", 2));
    assert!(desk.complaint("follow out/plan.json --watch seen --until fx=-1", 2).contains("a positive number"));
    assert!(desk.complaint("follow out/plan.json --more 2", 2).contains("required"));
    assert!(desk.complaint("follow out/plan.json --detections seen", 2).contains("--watch seen"));
    assert!(desk.complaint("follow out/plan.json --detections a.vnl --watch seen", 2).contains("cannot be used with"));
    // A tour that was begun on another plan, whose file somebody kept.
    assert_eq!(desk.run("follow out/plan.json").status.code(), Some(4));
    std::fs::copy(desk.path("out/follow.json"), desk.path("kept.json")).unwrap();
    desk.stdout("plan coarse.toml -k 10 --trials 0 -o out");
    std::fs::copy(desk.path("kept.json"), desk.path("out/follow.json")).unwrap();
    insta::assert_snapshot!(desk.complaint("follow out/plan.json", 3));
    assert_eq!(desk.run("follow out/plan.json --restart").status.code(), Some(4));
    std::fs::write(desk.path("out/follow.json"), "{}").unwrap();
    assert!(desk.complaint("follow out/plan.json", 3).contains("must be \"calipose.follow\" and 1"));
    // A plan made before there were tours goes by its ids.
    let mut old = read(&desk.path("out/plan.json"));
    old.as_object_mut().unwrap().remove("tour");
    std::fs::create_dir(desk.path("old")).unwrap();
    std::fs::write(desk.path("old/plan.json"), old.to_string()).unwrap();
    let (said, code) = typed(&desk, "follow old/plan.json --problem coarse.toml", "\n");
    assert!(code == Some(4) && said.contains(&format!("(id {})", old["poses"][1]["id"])), "{said}");
    assert!(said.contains("The way to it is not planned"), "{said}");
}
