//! Sweeps as a person runs them: interrupted, repeated with other settings, over damaged files.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn sweep(out: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_piaffe"));
    command.arg("sweep").args(arguments).arg("--out").arg(out).stdin(Stdio::null());
    command
}

fn run(out: &Path, arguments: &[&str]) -> Output {
    let output = sweep(out, arguments).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    output
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What stands in the JSON files of a folder, wall times aside.
fn contents(folder: &Path) -> BTreeMap<String, Vec<String>> {
    let timeless = |line: &&str| !line.trim_start().starts_with("\"seconds\":");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let json = files.filter(|path| path.extension().is_some_and(|e| e == "json"));
    json.map(|path| {
        let lines = std::fs::read_to_string(&path).unwrap().lines().filter(timeless).map(String::from).collect();
        (path.file_name().unwrap().to_string_lossy().into_owned(), lines)
    })
    .collect()
}

const SMALL: [&str; 8] = ["--gait", "trot", "--criterion", "torque", "--speeds", "0.5,0.6", "--starts", "1"];

#[test]
fn a_sweep_killed_again_and_again_ends_like_one_that_was_not() {
    let arguments = ["--gait", "trot", "--gait", "amble", "--speeds", "0.9..1.1:0.1", "--starts", "1"];
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    let told = text(&run(&whole, &arguments).stdout);
    assert!(told.contains("amble overtakes trot at 1.0"), "{told}");

    let broken = folder.path().join("broken");
    let mut rng = fastrand::Rng::with_seed(7);
    let mut kills = 0;
    loop {
        let mut child = sweep(&broken, &arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // Longer and longer, or a machine that is too slow would never end.
        std::thread::sleep(Duration::from_millis(rng.u64(0..=20 + 10 * kills * kills)));
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        assert!(!text(&output.stderr).contains("note:"), "{}", text(&output.stderr));
        if output.status.success() {
            let changed = told.replace(&whole.display().to_string(), &broken.display().to_string());
            assert_eq!(text(&output.stdout), changed);
            break;
        }
        kills += 1;
    }
    assert!(kills > 2, "the sweep was never killed");
    let (expected, found) = (contents(&whole), contents(&broken));
    assert!(expected.len() > 12, "{:?}", expected.keys());
    assert_eq!(expected, found);
}

#[test]
fn a_sweep_has_its_points_greatest_speeds_and_local_optima() {
    let folder = tempfile::tempdir().unwrap();
    let told = text(&run(folder.path(), &SMALL).stdout);
    assert!(told.contains("trot goes up to 1.0") && told.contains("what stops it: "), "{told}");
    let summary: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("sweep.json")).unwrap()).unwrap();
    let maximum = &summary["maximum_speeds"][0];
    let fastest = maximum["speed"].as_f64().unwrap();
    assert!((1.0..1.3).contains(&fastest), "{fastest}");
    assert!(!maximum["ended_by"].as_array().unwrap().is_empty());
    let points = summary["points"].as_array().unwrap();
    let speeds: Vec<f64> = points.iter().map(|p| p["speed"].as_f64().unwrap()).collect();
    assert_eq!(speeds, [0.5, 0.6, fastest]);
    for point in points {
        assert_eq!(point["status"], "optimal");
        assert_eq!(point["cost"], point["local_optima"][0]);
        assert!(folder.path().join(point["file"].as_str().unwrap()).exists());
    }
}

#[test]
fn what_a_sweep_says_follows_from_its_results() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &SMALL);
    let told = |command: &str, paths: &[PathBuf]| {
        let to: &[&str] = if command == "report" { &["--out", "report"] } else { &[] };
        let mut piaffe = Command::new(env!("CARGO_BIN_EXE_piaffe"));
        let out = piaffe.arg(command).args(paths).args(to).current_dir(folder.path()).output().unwrap();
        (out.status.code().unwrap(), text(&out.stdout) + &text(&out.stderr))
    };
    let overview = folder.path().join("sweep.json");
    let (code, words) = told("verify", &[folder.path().into()]);
    assert!(code == 0 && words.contains("sweep.json: a sweep's overview, confirmed"), "{words}");
    assert_eq!(words.matches(", confirmed").count(), 4, "{words}");

    let honest: Value = serde_json::from_slice(&std::fs::read(&overview).unwrap()).unwrap();
    let edits: [(&str, Value); 6] = [
        ("/maximum_speeds/0/speed", 99.0.into()),
        ("/points/0/cost", 1.0.into()),
        ("/points/1/status", "infeasible".into()),
        ("/points/1/speed", 0.7.into()),
        ("/points/2/durations/0", 0.5.into()),
        ("/points/0/local_optima/0", 1.0.into()),
    ];
    for (place, lie) in edits {
        let mut edited = honest.clone();
        *edited.pointer_mut(place).unwrap() = lie.clone();
        std::fs::write(&overview, edited.to_string()).unwrap();
        let (code, words) = told("verify", std::slice::from_ref(&overview));
        assert!(code == 4 && words.contains(&format!("stated {lie}, found ")), "{place}: {words}");
        for path in [&overview, folder.path()] {
            let (code, words) = told("report", &[path.into()]);
            assert!(code == 1 && words.contains(&format!("sweep.json states {lie} for ")), "{place}: {words}");
        }
    }
    // What only the search has seen is nobody's proof.
    let mut edited = honest.clone();
    edited["maximum_speeds"][0]["ended_by"] = serde_json::json!(["courage of the rider"]);
    std::fs::write(&overview, edited.to_string()).unwrap();
    let (_, words) = told("verify", std::slice::from_ref(&overview));
    assert!(words.contains("maximum_speeds.ended_by\n    not derivable"), "{words}");
    for file in ["../trot-torque-0.6000.json", "/etc/hostname", "..", "trot-torque-0.7000.json"] {
        let mut edited = honest.clone();
        edited["points"][1]["file"] = file.into();
        std::fs::write(&overview, edited.to_string()).unwrap();
        let (code, words) = told("verify", std::slice::from_ref(&overview));
        assert!(code == 1 && words.contains("sweep.json names "), "{file}: {words}");
    }

    std::fs::write(&overview, honest.to_string()).unwrap();
    assert_eq!(told("report", &[folder.path().into()]).0, 0);
}

/// At a greatest speed the active constraints nearly depend on each other, and multipliers are large.
#[test]
fn what_a_sweep_issues_at_the_greatest_speed_is_confirmed() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &["--gait", "amble", "--criterion", "torque", "--speeds", "1.4", "--starts", "2"]);
    let verify = Command::new(env!("CARGO_BIN_EXE_piaffe")).arg("verify").arg(folder.path()).output().unwrap();
    let words = text(&verify.stdout);
    assert!(verify.status.success() && words.matches(", confirmed").count() == 3, "{words}");
    let results = contents(folder.path());
    let optimal = results.values().filter(|lines| lines.iter().any(|line| line.contains(r#""status": "optimal""#)));
    assert!(optimal.count() >= 2, "{:?}", results.keys());
}

#[test]
fn speeds_that_differ_little_have_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let speeds = ["--gait", "trot", "--criterion", "torque", "--speeds", "0.60001,0.60002", "--starts", "1"];
    run(folder.path(), &speeds);
    for speed in [0.60001, 0.60002] {
        let file = folder.path().join(format!("trot-torque-{speed}.json"));
        let result: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
        assert_eq!(result["speed"], speed);
    }
}

#[test]
fn a_further_robot_has_its_page_too() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--gait", "rabbit/walk", "--criterion", "torque", "--speeds", "0.6..0.7:0.1", "--starts", "1"];
    let out = run(folder.path(), &arguments);
    assert!(out.status.success(), "{}", text(&out.stderr));
    for file in ["index.html", "figures/active-rabbit-walk-torque.svg"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
}

#[test]
fn damage_is_reported_and_repaired_from_the_journal() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &SMALL);
    let before = contents(folder.path());
    let file = folder.path().join("trot-torque-0.6000.json");
    let whole = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, &whole[..whole.floor_char_boundary(whole.len() / 2)]).unwrap();
    std::fs::remove_file(folder.path().join("trot-torque-0.5000.json")).unwrap();
    let told = text(&run(folder.path(), &SMALL).stderr);
    assert!(told.contains("trot-torque-0.6000.json is damaged") && told.contains("line "), "{told}");
    assert_eq!(whole, std::fs::read_to_string(&file).unwrap(), "the same to the wall time");
    assert_eq!(before, contents(folder.path()));

    // A line of the journal in the middle, and its end.
    let journal = folder.path().join("journal.jsonl");
    let text_before = std::fs::read_to_string(&journal).unwrap();
    let mut lines: Vec<&str> = text_before.lines().collect();
    let half = lines[1].floor_char_boundary(lines[1].len() / 2);
    lines[1] = &lines[1][..half];
    std::fs::write(&journal, format!("{}\n{{\"step\":\"cut", lines.join("\n"))).unwrap();
    let told = text(&run(folder.path(), &SMALL).stderr);
    assert!(told.contains("journal.jsonl:2: ") && !told.contains("journal.jsonl:3: "), "{told}");
    assert_eq!(before, contents(folder.path()));

    // A number that was changed is no number that was found.
    let text_before = std::fs::read_to_string(&journal).unwrap();
    let edited: Vec<String> = text_before.lines().map(|line| line.replacen("\"cost\":", "\"cost\":1", 1)).collect();
    std::fs::write(&journal, edited.join("\n") + "\n").unwrap();
    let told = text(&run(folder.path(), &SMALL).stderr);
    assert!(told.contains(": changed since it was written"), "{told}");
    assert_eq!(before, contents(folder.path()));
}

#[test]
fn another_search_is_announced_and_the_first_is_not_lost() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &SMALL);
    let file = folder.path().join("trot-torque-0.5000.json");
    let first = std::fs::read_to_string(&file).unwrap();
    let other: Vec<&str> = SMALL.iter().copied().chain(["--seed", "2"]).collect();
    let told = text(&run(folder.path(), &other).stderr);
    assert!(told.contains("had --seed 1 (now 2): what differs is searched anew"), "{told}");
    assert!(std::fs::read_to_string(&file).unwrap().contains("\"seed\": 2"));
    // The journal still knows, to the wall time.
    let told = text(&run(folder.path(), &SMALL).stderr);
    assert!(told.contains("had --seed 2 (now 1)"), "{told}");
    assert_eq!(first, std::fs::read_to_string(&file).unwrap());
}

#[test]
fn what_cannot_be_written_to_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let output = sweep(&file.join("inside"), &SMALL).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("cannot create"), "{}", text(&output.stderr));
}
