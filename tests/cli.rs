//! The program as a person runs it.

use serde_json::Value;
use std::io::Write;
use std::process::{Command, Output, Stdio};
use std::time::Instant;

fn piaffe(arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_piaffe"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn fixture(gait: &str) -> String {
    std::fs::read_to_string(format!("{}/tests/fixtures/dynamics_{gait}.json", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn dynamics_takes_a_fixture_file_and_prints_its_keys() {
    for gait in ["trot", "amble", "curvet"] {
        let out = piaffe(&["dynamics", gait, "-"], &fixture(gait));
        assert!(out.status.success(), "{}", text(&out.stderr));
        let found: Value = serde_json::from_slice(&out.stdout).unwrap();
        let expected: Value = serde_json::from_str(&fixture(gait)).unwrap();
        assert_eq!(found["gait"], gait);
        let (found, expected) = (&found["states"][0], &expected["states"][0]);
        for key in expected.as_object().unwrap().keys() {
            assert!(found.get(key).is_some(), "{gait}: `{key}` is missing");
        }
    }
}

#[test]
fn a_level_touchdown_of_the_amble_is_reported_as_singular() {
    let state =
        r#"{"states": [{"X": [0, 0.28, 0, 0.4, -0.8, -0.4, 0.8, 0], "Xdot": [0.5, 0, 0.1, 1, 0, -1, 0, 0.3]}]}"#;
    let out = piaffe(&["dynamics", "amble", "-"], state);
    let found: Value = serde_json::from_slice(&out.stdout).unwrap();
    let impact = &found["states"][0]["impact11"];
    assert!(impact["singular"].is_string() && impact.get("Xdot_plus").is_none(), "{impact}");
    assert!(found["states"][0]["impact12_leg1"]["Xdot_plus"].is_array());
}

#[test]
fn model_shows_what_was_generated() {
    for gait in ["trot", "amble", "curvet", "rabbit/walk", "a1/bound"] {
        let out = piaffe(&["model", gait, "--json", "-"], "");
        assert!(out.status.success(), "{}", text(&out.stderr));
        let model: Value = serde_json::from_slice(&out.stdout).unwrap();
        let unactuated = if gait == "trot" { "q1" } else { "theta" };
        assert_eq!(model["unactuated"], serde_json::json!([unactuated]), "{gait}");
        let bodies = model["bodies"].as_array().unwrap();
        let mass: f64 = bodies.iter().map(|b| b["mass"].as_f64().unwrap()).sum();
        assert!((mass - model["mass"].as_f64().unwrap()).abs() < 1e-12);
        let kernels = model["kernels"].as_array().unwrap();
        let sum = |key: &str| kernels.iter().map(|k| k[key].as_u64().unwrap()).sum::<u64>();
        assert!(sum("flops") < sum("derived") && sum("bytes") > 50_000, "{gait}");

        let table = text(&piaffe(&["model", gait], "").stdout);
        for kernel in kernels {
            let name = kernel["kernel"].as_str().unwrap();
            assert!(table.lines().any(|l| l.split_whitespace().next() == Some(name)), "{gait}: no {name} in {table}");
        }
        let latex = text(&piaffe(&["model", gait, "--latex"], "").stdout);
        assert!(latex.starts_with("\\documentclass") && latex.ends_with("\\end{document}\n"));
    }
}

#[test]
fn bad_input_is_named_with_its_place() {
    let out = piaffe(&["dynamics", "trot", "-"], "{\"states\": [\n  {\"X\": [0, 1,}\n]}");
    assert_eq!(out.status.code(), Some(1));
    assert!(text(&out.stderr).contains("standard input:2:"), "{}", text(&out.stderr));

    let out = piaffe(&["dynamics", "trot", "-"], r#"{"states": [{"X": [0, 1], "Xdot": [0]}]}"#);
    assert!(text(&out.stderr).contains("`X` has 2 numbers, the trot needs 6"), "{}", text(&out.stderr));

    let out = piaffe(&["dynamics", "trot", "/nonexistent.json"], "");
    assert!(text(&out.stderr).contains("cannot read /nonexistent.json"));

    let out = piaffe(&["optimize", "trott", "--speed", "0.6"], "");
    assert_eq!(out.status.code(), Some(2));
    assert!(text(&out.stderr).contains("trot"), "{}", text(&out.stderr));

    let out = piaffe(&["optimize", "trot", "--speed", "-1"], "");
    assert_eq!(out.status.code(), Some(2));
}

/// An option that would do nothing is refused, and not offered.
#[test]
fn options_mean_something_or_are_refused() {
    let changes = ["--set", "links.thigh.mass=1.2"];
    let robot = ["--robot", "model-spec"];
    for (command, takes_robot) in [
        (&["report", "x.json"][..], true),
        (&["diff", "a.json", "b.json"], true),
        (&["verify", "x.json"], true),
        (&["export", "x.json", "--format", "csv"], true),
        (&["lift", "x.json"], true),
        (&["merge", "part"], false),
        (&["check", "model-spec"], false),
        (&["completions", "bash"], false),
    ] {
        let out = piaffe(&[command, &changes].concat(), "");
        assert!(
            out.status.code() == Some(2) && text(&out.stderr).contains("--set"),
            "{command:?}: {}",
            text(&out.stderr)
        );
        assert_eq!(piaffe(&[command, &robot].concat(), "").status.code() == Some(2), !takes_robot, "{command:?}");
        let help = text(&piaffe(&[command[0], "--help"], "").stdout);
        assert!(!help.contains("--set") && help.contains("--robot") == takes_robot, "{help}");
    }
    let help = text(&piaffe(&["optimize", "--help"], "").stdout);
    assert!(help.contains("--set") && help.contains("--robot"), "{help}");
}

#[test]
fn optimize_writes_json_with_a_receipt() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trot.json");
    let out = piaffe(
        &[
            "optimize",
            "trot",
            "--criterion",
            "torque",
            "--speed",
            "0.6",
            "--starts",
            "2",
            "--json",
            file.to_str().unwrap(),
        ],
        "",
    );
    assert!(out.status.success(), "{}", text(&out.stderr));
    assert!(text(&out.stdout).contains("receipt"));
    let result: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    for key in ["gait", "criterion", "speed", "status", "cost", "durations", "step_length", "variables", "seconds"] {
        assert!(!result[key].is_null(), "`{key}` is missing");
    }
    for key in ["energy", "torque"] {
        assert!(result["costs"][key].is_f64());
    }
    for key in ["max_violation", "cycle_error", "kkt_residual", "active"] {
        assert!(!result["receipt"][key].is_null(), "receipt.{key} is missing");
    }
    assert_eq!(result["status"], "optimal");
    // Nothing but the result was left behind.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn how_closely_an_optimum_is_looked_at_is_a_choice() {
    let folder = tempfile::tempdir().unwrap();
    let entries = ["certificate", "sensitivities", "stability", "real_legs"];
    for (level, missing) in [("none", &entries[..]), ("quick", &["certificate", "real_legs"]), ("full", &[])] {
        let file = folder.path().join(format!("{level}.json"));
        let file = file.to_str().unwrap();
        let asked = ["optimize", "trot", "--speed", "0.6", "--starts", "1", "--examine", level, "--json", file];
        let out = piaffe(&asked, "");
        assert!(out.status.success(), "{}", text(&out.stderr));
        let result: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        let open: Vec<_> = result["not_examined"].as_array().into_iter().flatten().map(|open| &open["entry"]).collect();
        for entry in entries {
            let absent = missing.contains(&entry);
            assert_eq!(result.get(entry).is_none_or(Value::is_null), absent, "{level}: {entry}");
            assert_eq!(open.iter().any(|open| **open == entry), absent, "{level}: {open:?}");
        }
        let out = piaffe(&["verify", file], "");
        assert!(out.status.success(), "{level}: {}", text(&out.stdout));
    }
    // Who leaves something out without a word is not confirmed.
    let file = folder.path().join("none.json");
    let whole = std::fs::read_to_string(&file).unwrap();
    let mut result: Value = serde_json::from_str(&whole).unwrap();
    result.as_object_mut().unwrap().remove("not_examined");
    std::fs::write(&file, result.to_string()).unwrap();
    assert_eq!(piaffe(&["verify", file.to_str().unwrap()], "").status.code(), Some(4));
}

/// Whatever speed is typed: it is shown as it can be read, and where it is beyond all reason there is one that works.
#[test]
fn an_absurd_speed_is_said_in_a_few_characters() {
    for speed in ["1e-300", "1000", "1e300"] {
        let out = piaffe(&["optimize", "trot", "--speed", speed, "--starts", "2", "--examine", "none"], "");
        let told = text(&out.stdout);
        assert_eq!(out.status.code(), Some(3), "{told}");
        assert!(told.contains(&format!("at {speed} m/s: ")) && !told.contains("00000000"), "{told}");
        assert_eq!(told.contains("The nearest speed found to work is 1.08"), speed != "1e-300", "{told}");
    }
}

#[test]
fn an_infeasible_speed_is_said_and_fails() {
    let started = Instant::now();
    let out = piaffe(&["optimize", "trot", "--speed", "5", "--starts", "2", "--json", "-"], "");
    assert_eq!(out.status.code(), Some(3));
    let result: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(result["status"], "infeasible");
    assert!(result["cost"].is_null() && !result["conflicts"].as_array().unwrap().is_empty());
    let nearest = result["nearest_speed"].as_f64().unwrap();
    assert!((1.0..1.3).contains(&nearest), "{nearest}");
    // The time is that of all that was done, the search for this speed included.
    let (seconds, took) = (result["seconds"].as_f64().unwrap(), started.elapsed().as_secs_f64());
    assert!((0.7 * took..took).contains(&seconds), "{seconds} s of {took} s");
}

/// Twenty thousand threads would wait for each other for minutes.
#[test]
fn more_threads_than_cores_are_not_started() {
    let run = |threads: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_piaffe"));
        command.args(["optimize", "trot", "--speed", "0.6", "--starts", "2", "--examine", "none", "--json", "-"]);
        let out = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
        let result: Value = serde_json::from_slice(&out.stdout).unwrap();
        result["cost"].as_f64().unwrap()
    };
    let started = Instant::now();
    assert_eq!(run("20000"), run("1"));
    assert!(started.elapsed().as_secs() < 30, "{:?}", started.elapsed());
}

#[test]
fn a_gait_is_chosen_together_with_its_robot() {
    let out = piaffe(&["optimize", "rabbit/walk", "--speed", "0.6", "--starts", "2", "--json", "-"], "");
    assert!(out.status.success(), "{}", text(&out.stderr));
    let result: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((&result["gait"], &result["robot"]), (&"rabbit/walk".into(), &"RABBIT".into()));
    assert!(result["receipt"]["max_violation"].as_f64().unwrap() < 1e-6);

    let out = piaffe(&["optimize", "rabit/walk", "--speed", "0.6"], "");
    assert_eq!(out.status.code(), Some(2));
    assert!(text(&out.stderr).contains("'rabbit/walk'"), "{}", text(&out.stderr));
}

#[test]
fn quiet_runs_say_nothing_but_what_was_asked_for() {
    let out = piaffe(&["optimize", "trot", "--speed", "0.6", "--starts", "1", "--quiet"], "");
    assert!(out.status.success() && out.stdout.is_empty() && out.stderr.is_empty());
    let out = piaffe(&["-q", "optimize", "trot", "--speed", "0.6", "--starts", "1", "--json", "-"], "");
    assert!(serde_json::from_slice::<Value>(&out.stdout).unwrap()["cost"].is_f64());
    let out = piaffe(&["export", "/nonexistent.json", "--format", "csv", "--quiet"], "");
    assert!(text(&out.stderr).contains("cannot read /nonexistent.json"));
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let run = format!("{} optimize trot --speed 0.6 --starts 1 | head -n 1", env!("CARGO_BIN_EXE_piaffe"));
    let out = Command::new("sh").args(["-c", &run]).output().unwrap();
    assert!(text(&out.stdout).starts_with("trot") && out.stderr.is_empty(), "{}", text(&out.stderr));
}

#[cfg(unix)]
#[test]
fn a_pipe_or_a_link_is_written_to_and_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().unwrap();
    let [pipe, link, file] = ["pipe", "link", "file"].map(|name| folder.path().join(name));
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    let optimize = |to: &std::path::Path| {
        piaffe(&["optimize", "trot", "--speed", "0.6", "--starts", "1", "--json", to.to_str().unwrap()], "")
    };
    let cost = |json: &[u8]| serde_json::from_slice::<Value>(json).unwrap()["cost"].is_f64();

    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read(pipe).unwrap()
    });
    assert!(optimize(&pipe).status.success());
    assert!(pipe.symlink_metadata().unwrap().file_type().is_fifo(), "the pipe was replaced");
    assert!(cost(&reader.join().unwrap()));

    assert!(optimize(&link).status.success());
    assert!(link.symlink_metadata().unwrap().is_symlink(), "the link was replaced");
    assert!(cost(&std::fs::read(&file).unwrap()));
}

#[test]
fn shells_and_man_know_every_command() {
    let help = text(&piaffe(&["--help"], "").stdout);
    let bash = text(&piaffe(&["completions", "bash"], "").stdout);
    let folder = tempfile::tempdir().unwrap();
    assert!(piaffe(&["manual", "--out", folder.path().to_str().unwrap()], "").status.success());
    for command in ["dynamics", "optimize", "report", "export", "sweep"] {
        assert!(help.contains(command) && bash.contains(command));
        let page = std::fs::read_to_string(folder.path().join(format!("piaffe-{command}.1"))).unwrap();
        assert!(page.contains(".SH SYNOPSIS"), "{command}");
    }
    assert!(help.contains("Exit codes") && help.contains("Examples"));
}

#[test]
fn an_interrupted_job_leaves_whole_files() {
    for delay in [50, 250, 600] {
        let folder = tempfile::tempdir().unwrap();
        let mut job = Command::new(env!("CARGO_BIN_EXE_piaffe"))
            .args(["--quiet", "--out", folder.path().to_str().unwrap()])
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(delay));
        let _ = job.kill();
        job.wait().unwrap();
        for file in std::fs::read_dir(folder.path()).unwrap().map(|f| f.unwrap().path()) {
            if file.extension().is_some_and(|e| e == "json") {
                let text = std::fs::read_to_string(&file).unwrap();
                assert!(serde_json::from_str::<Value>(&text).unwrap()["status"].is_string(), "{}", file.display());
            }
        }
    }
}
