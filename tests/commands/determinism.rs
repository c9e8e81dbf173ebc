//! The same problem file and seed give the same plan, byte for byte, on any number of threads.

use std::path::Path;

use crate::desk::command;

const FILE: &str = "problems/servosila-engineer.toml";

/// `plan.json` by `method`, made on `threads` threads.
fn plan(method: &str, threads: usize, folder: &Path) -> Vec<u8> {
    let output = folder.join(format!("{method}-{threads}"));
    let run = command(Path::new("."), "")
        .env("RAYON_NUM_THREADS", threads.to_string())
        .args(["plan", FILE, "--quiet", "--set", "sweep.step_deg=12", "--trials", "0", "--method", method, "--output"])
        .arg(&output)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let told: serde_json::Value = serde_json::from_slice(&std::fs::read(output.join("run.json")).unwrap()).unwrap();
    assert_eq!(told["threads"], threads, "the run did not use {threads} threads");
    std::fs::read(output.join("plan.json")).unwrap()
}

#[test]
fn plans_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    for method in ["best", "kmeans-joints", "random"] {
        let on_one = plan(method, 1, folder.path());
        assert!(on_one == plan(method, 2, folder.path()), "{method} on two threads");
        assert!(on_one == plan(method, 3, folder.path()), "{method} on three threads");
        assert!(on_one == plan(method, 1, folder.path()), "{method} again, over the plan before");
    }
}

#[test]
fn another_seed_gives_another_random_plan() {
    let folder = tempfile::tempdir().unwrap();
    let with_seed = |seed: &str| {
        let output = folder.path().join(seed);
        let run = command(Path::new("."), "")
            .args([
                "plan",
                FILE,
                "--quiet",
                "--set",
                "sweep.step_deg=12",
                "--trials",
                "0",
                "--method",
                "random",
                "--seed",
                seed,
                "--output",
            ])
            .arg(&output)
            .status()
            .unwrap();
        assert!(run.success());
        let plan: serde_json::Value =
            serde_json::from_slice(&std::fs::read(output.join("plan.json")).unwrap()).unwrap();
        plan["poses"].as_array().unwrap().iter().map(|pose| pose["id"].as_u64().unwrap()).collect::<Vec<_>>()
    };
    assert_ne!(with_seed("1"), with_seed("2"));
}
