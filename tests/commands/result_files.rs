//! Result files belong together, whatever ends a run: they are of one run, or readers say that they are not.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::desk::{Desk, is_ignored_here, signal, text};

/// Polls until `done`.
fn wait_for(what: &str, done: impl Fn() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < Duration::from_mins(2), "{what} did not come");
        std::thread::sleep(Duration::from_micros(100));
    }
}

fn spawn(desk: &Desk, line: &str) -> Child {
    desk.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// A problem that is solved at once.
fn small() -> Desk {
    let desk = Desk::new();
    desk.change("coarse.toml", &[("step_deg = 15", "step_deg = 20")]);
    desk
}

/// Names of temporary files in a folder; none while the folder is not there, which the run being watched makes and takes away.
fn hidden(desk: &Desk, folder: &str) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(desk.path(folder)) else { return Vec::new() };
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.filter(|name| name.starts_with('.')).collect();
    names.sort();
    names
}

#[test]
fn a_killed_run_leaves_the_files_of_one_run_or_it_is_found_out() {
    let desk = small();
    let mut torn = 0;
    for shot in 0..8 {
        let before = hidden(&desk, "out");
        let mut child = spawn(&desk, &format!("plan coarse.toml -q --trials 0 -o out -k {}", 8 + shot % 2));
        let ended = std::cell::Cell::new(false);
        let child_cell = std::cell::RefCell::new(&mut child);
        wait_for("a temporary file", || {
            ended.set(child_cell.borrow_mut().try_wait().unwrap().is_some());
            let now = hidden(&desk, "out");
            ended.get() || !now.is_empty() && now != before
        });
        std::thread::sleep(Duration::from_micros(700 * shot));
        let _ = child.kill();
        child.wait().unwrap();
        let plan = desk.path("out/plan.json");
        if !plan.exists() {
            continue;
        }
        // Poses in the table and in the document are the same number, or readers refuse them.
        let mixed = calipose::plan::results::check_results(&plan);
        let document: serde_json::Value = serde_json::from_slice(&std::fs::read(&plan).unwrap()).unwrap();
        let rows = std::fs::read_to_string(desk.path("out/plan.csv")).unwrap().lines().count() as u64 - 1;
        if mixed.is_empty() {
            assert_eq!(document["count"], rows);
        } else {
            torn += 1;
            let complaint = desk.complaint("verify out/plan.json -n 2", 3);
            assert!(complaint.contains("not from one run"), "{complaint}");
        }
    }
    // The next run makes it good, and clears up.
    desk.stdout("plan coarse.toml -q --trials 0 -o out -k 8");
    assert_eq!(desk.files("out"), ["plan.csv", "plan.json", "report.html", "run.json"], "after {torn} torn sets");
    desk.stdout("verify out/plan.json -n 2");
}

#[test]
fn every_reader_refuses_files_of_two_runs() {
    let desk = small();
    desk.stdout("plan coarse.toml -q --trials 0 -o out -k 9");
    std::fs::copy(desk.path("out/plan.csv"), desk.path("nine.csv")).unwrap();
    desk.stdout("plan coarse.toml -q --trials 2 -o out -k 8");
    desk.stdout("certify out/plan.json");
    std::fs::copy(desk.path("nine.csv"), desk.path("out/plan.csv")).unwrap();
    for command in ["certify", "verify", "explain", "polish"] {
        let complaint = desk.complaint(&format!("{command} out/plan.json"), 3);
        assert!(complaint.contains("not from one run: plan.csv does not match run.json"), "{complaint}");
        assert!(complaint.contains("make the plan again"), "{complaint}");
    }
    // The plan alone is as good as ever.
    std::fs::create_dir(desk.path("alone")).unwrap();
    std::fs::copy(desk.path("out/plan.json"), desk.path("alone/plan.json")).unwrap();
    desk.stdout("certify alone/plan.json --problem coarse.toml");
}

#[test]
fn the_plan_of_another_problem_is_replaced_only_by_force() {
    let desk = small();
    std::fs::create_dir(desk.path("b")).unwrap();
    desk.change("a.toml", &[]);
    desk.change("b/a.toml", &[("sigma_px = 0.3", "sigma_px = 0.4")]);
    desk.change("other.toml", &[("sigma_px = 0.3", "sigma_px = 0.5")]);
    desk.stdout("plan a.toml -q --trials 0 -o out");
    let before = std::fs::read(desk.path("out/plan.json")).unwrap();
    // A board out of sight would be complained of later.
    desk.change("far.toml", &[("position_mm = [232.875, 72.75, -98]", "position_mm = [90000, 0, 2000]")]);
    for file in ["b/a.toml", "other.toml", "far.toml"] {
        let complaint = desk.complaint(&format!("plan {file} -o out"), 1);
        assert!(complaint.contains("out/plan.json is the plan of") && complaint.contains("a.toml"), "{complaint}");
        assert!(complaint.contains(&format!("not of {file}")) && complaint.contains("--force"), "{complaint}");
    }
    assert!(before == std::fs::read(desk.path("out/plan.json")).unwrap());
    desk.stdout("plan other.toml -q --trials 0 -o out --force");
    // The same file, changed, replaces its own plan; so does one that was moved, by its name.
    desk.change("other.toml", &[("sigma_px = 0.3", "sigma_px = 0.6")]);
    desk.stdout("plan other.toml -q --trials 0 -o out");
    std::fs::rename(desk.path("other.toml"), desk.path("b/moved.toml")).unwrap();
    desk.stdout("plan b/moved.toml -q --trials 0 -o out");
    // What is no plan of calipose's is nobody's to replace.
    std::fs::create_dir(desk.path("web")).unwrap();
    std::fs::write(desk.path("web/plan.json"), "{}").unwrap();
    assert!(desk.complaint("plan a.toml -o web", 1).contains("--force"));
}

#[test]
fn robots_from_init_have_plans_of_their_own() {
    let desk = Desk::new();
    for name in ["my-robot", "other"] {
        desk.stdout(&format!("init {name}.toml"));
        let text = std::fs::read_to_string(desk.path(&format!("{name}.toml"))).unwrap();
        std::fs::write(desk.path(&format!("{name}.toml")), text.replace("sample = 200_000", "sample = 20_000"))
            .unwrap();
        desk.stdout(&format!("plan {name}.toml -q --trials 0 --set selection.off_grid=false"));
    }
    assert_eq!(desk.files("plans"), ["my-robot", "other"]);
    desk.stdout("certify plans/my-robot/plan.json");
}

#[test]
fn a_folder_that_cannot_be_written_is_found_before_the_work() {
    let desk = small();
    std::fs::write(desk.path("taken"), "a file").unwrap();
    desk.change("far.toml", &[("position_mm = [232.875, 72.75, -98]", "position_mm = [90000, 0, 2000]")]);
    let complaint = desk.complaint("plan far.toml -o taken/out", 1);
    assert!(
        complaint.contains("cannot write taken/out") && complaint.contains("nothing was overwritten"),
        "{complaint}"
    );
    assert_eq!(complaint.matches("os error").count(), 1, "{complaint}");
    assert!(desk.complaint("plan far.toml -o new/out", 1).contains("target zone"));
    assert!(!desk.path("new").exists(), "looked for, and not left behind");
}

#[cfg(unix)]
#[test]
fn files_are_as_private_as_the_user_makes_files() {
    use std::os::unix::fs::PermissionsExt;
    let desk = small();
    let mode = |name: &str| desk.path(name).metadata().unwrap().permissions().mode() & 0o777;
    for (umask, expected) in [("077", 0o600), ("022", 0o644), ("002", 0o664)] {
        let line = format!("umask {umask}; {} init {umask}.toml -q", env!("CARGO_BIN_EXE_calipose"));
        assert!(Command::new("sh").arg("-c").arg(line).current_dir(desk.path("")).status().unwrap().success());
        assert_eq!(mode(&format!("{umask}.toml")), expected, "umask {umask}");
    }
}

#[cfg(unix)]
#[test]
fn a_termination_or_hang_up_keeps_what_there_is() {
    let desk = small();
    // The plan is written before its simulated calibrations.
    let signals = [("TERM", 15), ("HUP", 1), ("INT", 2)];
    // What is ignored here, as HUP under `nohup` and INT in the background of a script, the program ignores too.
    for (name, number) in signals.into_iter().filter(|&(_, number)| !is_ignored_here(number)) {
        let child = spawn(&desk, &format!("plan coarse.toml -q --trials 1000000 -o {name}"));
        wait_for("the plan", || desk.path(&format!("{name}/plan.json")).exists());
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(128 + number), "{name}: {}", text(&output.stderr));
        assert_eq!(desk.files(name), ["plan.csv", "plan.json", "run.json"]);
        desk.stdout(&format!("verify {name}/plan.json -n 2"));
    }
}

/// `nohup calipose … &`, and the terminal is closed.
#[cfg(target_os = "linux")]
#[test]
fn a_hang_up_that_the_user_has_ignored_stays_so() {
    let desk = small();
    let line = format!("trap '' HUP; exec {} plan coarse.toml -q --trials 300 -o out", env!("CARGO_BIN_EXE_calipose"));
    let child = Command::new("sh").arg("-c").arg(line).current_dir(desk.path("")).spawn().unwrap();
    wait_for("the plan", || desk.path("out/plan.json").exists());
    signal(&child, "HUP");
    let output = child.wait_with_output().unwrap();
    assert!(matches!(output.status.code(), Some(0 | 4)), "{output:?}");
    assert!(desk.path("out/verification.json").exists());
}

#[cfg(unix)]
#[test]
fn what_has_no_end_is_not_read_to_it() {
    let desk = small();
    assert!(desk.complaint("check /dev/zero", 3).contains("larger than"));
    assert!(desk.complaint("verify /dev/zero", 3).contains("larger than"));
    assert!(desk.complaint("verify out/plan.json -n 10000000", 2).contains("1000000"));
    // Pipes are read as files are.
    let line = format!("cat coarse.toml | {} check /dev/stdin -q", env!("CARGO_BIN_EXE_calipose"));
    assert!(Command::new("sh").arg("-c").arg(line).current_dir(desk.path("")).status().unwrap().success());
}

#[test]
fn endless_faults_are_counted_and_the_first_drawn() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(desk.path("coarse.toml")).unwrap();
    let wrong = format!("\n[constraints]\ncaptured = [{}]\n", "[1],\n".repeat(500));
    std::fs::write(desk.path("wrong.toml"), text + &wrong).unwrap();
    let complaint = desk.complaint("check wrong.toml", 3);
    assert!(complaint.contains("has 500 errors; the first 50"), "{}", &complaint[..200]);
    assert_eq!(complaint.matches("one for each").count(), 50);
}

#[test]
fn errors_are_documents_under_json() {
    let desk = small();
    let error = |line: &str, code: i32| -> serde_json::Value {
        let output = desk.run(&format!("{line} --json"));
        assert_eq!((output.status.code(), text(&output.stdout).as_str()), (Some(code), ""), "{line}: {output:?}");
        let document: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
        assert_eq!((&document["format"], &document["version"]), (&"calipose.error".into(), &1.into()));
        assert_eq!(document["exit_code"], code);
        document
    };
    desk.change("typo.toml", &[("width_px", "widht_px")]);
    desk.change("far.toml", &[("position_mm = [232.875, 72.75, -98]", "position_mm = [90000, 0, 2000]")]);
    desk.change("noise.toml", &[("sigma_px = 0.3", "sigma_px = -0.3")]);
    let typo = error("check typo.toml", 3);
    assert_eq!(typo["kind"], "problem-file");
    let fault = &typo["faults"][0];
    assert_eq!((&fault["file"], &fault["key"]), (&"typo.toml".into(), &"camera.widht_px".into()));
    assert!(fault["line"].as_u64().unwrap() > 1 && fault["column"].as_u64().unwrap() == 1, "{fault}");
    assert!(fault["allowed"].as_array().unwrap().contains(&"width_px".into()), "{fault}");
    assert!(fault["hint"].as_str().unwrap().contains("did you mean"), "{fault}");
    let noise = &error("check noise.toml", 3)["faults"][0];
    assert_eq!((&noise["value"], &noise["key"]), (&(-0.3).into(), &"noise.sigma_px".into()));
    assert!(noise["allowed"].as_str().unwrap().starts_with("from 1e-6"), "{noise}");
    assert_eq!(error("check missing.toml", 3)["faults"][0]["file"], "missing.toml");
    assert_eq!(error("plan far.toml", 1)["kind"], "no-plan");
    assert_eq!(error("plan", 2)["kind"], "command-line");
    assert_eq!(error("plan coarse.toml --trials ten", 2)["kind"], "command-line");
    assert_eq!(error("plan coarse.toml --count ten", 3)["faults"][0]["key"], "selection.count");
    std::fs::write(desk.path("taken"), "a file").unwrap();
    let unwritable = error("plan coarse.toml -o taken/out", 1);
    assert_eq!(unwritable["kind"], "cannot-write");
    assert!(unwritable["message"].as_str().unwrap().contains("os error"), "{unwritable}");
}
