//! The program and the files that it reads and writes, on a file system and with contents that mean no good.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::{TempDir, tempdir};

const PIAFFE: &str = env!("CARGO_BIN_EXE_piaffe");

fn piaffe(arguments: &[&str]) -> Output {
    Command::new(PIAFFE).args(arguments).output().unwrap()
}

/// The same with a path behind the arguments.
fn piaffe_on(arguments: &[&str], path: &Path) -> Output {
    Command::new(PIAFFE).args(arguments).arg(path).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Writes something of ours to a path, in no time.
fn write_to(path: &Path) -> Output {
    piaffe_on(&["model", "trot", "--quiet", "--json"], path)
}

fn is_written(path: &Path) -> bool {
    std::fs::read(path).is_ok_and(|bytes| serde_json::from_slice::<Value>(&bytes).unwrap()["gait"] == "trot")
}

/// Exit code 1, with these words on standard error.
#[track_caller]
fn refused(out: &Output, words: &str) {
    let told = text(&out.stderr);
    assert!(out.status.code() == Some(1) && told.contains(words), "{:?}: {told}", out.status);
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::fs::Permissions;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        path.metadata().unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn a_new_file_is_as_private_as_umask_says_and_an_old_one_as_it_was() {
        let folder = tempdir().unwrap();
        for (umask, expected) in [("022", 0o644), ("077", 0o600), ("002", 0o664), ("027", 0o640)] {
            let file = folder.path().join(umask);
            let run = format!("umask {umask}; {PIAFFE} model trot --quiet --json {}", file.display());
            assert!(Command::new("sh").args(["-c", &run]).output().unwrap().status.success());
            assert!(is_written(&file));
            assert_eq!(mode(&file), expected, "umask {umask}");
        }
        for kept in [0o600, 0o640, 0o666, 0o755] {
            let file = folder.path().join("old");
            std::fs::write(&file, "old").unwrap();
            std::fs::set_permissions(&file, Permissions::from_mode(kept)).unwrap();
            assert!(write_to(&file).status.success());
            assert!(is_written(&file));
            assert_eq!(mode(&file), kept);
        }
    }

    #[test]
    fn links_are_written_through_wherever_they_lead() {
        let folder = tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("inside")).unwrap();
        symlink("second", at("first")).unwrap();
        symlink("inside/file.json", at("second")).unwrap();
        for _ in 0..2 {
            // Nowhere yet, then to a file.
            assert!(write_to(&at("first")).status.success());
            assert!(is_written(&at("inside/file.json")) && at("first").is_symlink() && at("second").is_symlink());
        }
        symlink("nowhere/file.json", at("lost")).unwrap();
        refused(&write_to(&at("lost")), "there is no folder");
        symlink("round", at("round")).unwrap();
        refused(&write_to(&at("round")), "cannot write");
        assert!(at("lost").is_symlink() && at("round").is_symlink());
        assert_eq!(entries(&at("inside")), ["file.json"]);
    }

    #[test]
    fn what_may_not_be_written_to_is_not_replaced() {
        let folder = tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "old").unwrap();
        std::fs::set_permissions(&file, Permissions::from_mode(0o444)).unwrap();
        if std::fs::OpenOptions::new().write(true).open(&file).is_ok() {
            return; // whoever may do anything is refused nothing
        }
        refused(&write_to(&file), "Permission denied");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "old");
        std::fs::set_permissions(folder.path(), Permissions::from_mode(0o555)).unwrap();
        refused(&write_to(&folder.path().join("new")), "must be writable");
        std::fs::set_permissions(folder.path(), Permissions::from_mode(0o755)).unwrap();
    }

    #[test]
    fn a_full_disk_is_a_failure() {
        if !Path::new("/dev/full").exists() {
            return;
        }
        refused(&write_to(Path::new("/dev/full")), "cannot write /dev/full");
        for command in ["model trot", "model trot --json -", "completions bash", "verify /dev/null --json -"] {
            let run = format!("{PIAFFE} {command} > /dev/full");
            let out = Command::new("sh").args(["-c", &run]).output().unwrap();
            refused(&out, "cannot write to standard output");
        }
    }

    #[test]
    fn names_of_files_are_shown_and_not_obeyed() {
        let folder = tempdir().unwrap();
        let odd = folder.path().join("a\u{1b}[2J\nerror: b.json");
        let out = piaffe_on(&["verify"], &odd);
        refused(&out, "a\\u{1b}[2J\\u{a}error: b.json");
        std::fs::write(&odd, "{\"x\": \"\\u001b[31m\"").unwrap();
        let told = text(&piaffe_on(&["verify"], &odd).stderr);
        assert!(!told.contains('\u{1b}') && told.contains("\\u{1b}[2J"), "{told}");
        assert!(write_to(&odd).status.success() && is_written(&odd));
    }

    #[test]
    fn a_device_without_end_is_no_input() {
        if !Path::new("/dev/zero").exists() {
            return;
        }
        refused(&piaffe(&["verify", "/dev/zero"]), "more than 256 MB");
    }
}

#[test]
fn what_a_killed_run_left_is_cleared_away() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("file.json");
    let draft = |n: usize| folder.path().join(format!(".file.json.{n}.piaffe-draft"));
    std::fs::write(draft(0), "{\"half\":").unwrap();
    assert!(write_to(&file).status.success());
    assert_eq!(entries(folder.path()), ["file.json"]);

    // One that another run is writing is left alone.
    let busy = std::fs::File::create(draft(0)).unwrap();
    busy.lock().unwrap();
    assert!(write_to(&file).status.success() && is_written(&file));
    assert_eq!(entries(folder.path()), [".file.json.0.piaffe-draft", "file.json"]);
}

#[test]
fn a_target_that_is_none_is_named() {
    let folder = tempdir().unwrap();
    refused(&write_to(folder.path()), "this is a folder");
    refused(&write_to(&folder.path().join("a/b.json")), "there is no folder");
    refused(&piaffe(&["model", "trot", "--json", ""]), "cannot write");
    let long = folder.path().join("x".repeat(250));
    assert!(write_to(&long).status.success() && is_written(&long));
    refused(&write_to(&folder.path().join("x".repeat(300))), "cannot write");
}

/// What a run is given to read is there afterwards, whatever it is called.
#[test]
fn what_was_read_is_not_written_over() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("own.json");
    std::fs::copy(&TROT.1, &file).unwrap();
    let (own, by_another_way) = (file.to_str().unwrap(), folder.path().join("./own.json"));
    for arguments in [
        vec!["verify", own, "--json", own],
        vec!["verify", own, "--json", by_another_way.to_str().unwrap()],
        vec!["export", own, "--format", "json", "--out", own],
        vec!["lift", own, "--format", "json", "--out", own],
        vec!["diff", TROT.1.to_str().unwrap(), own, "--json", own],
    ] {
        refused(&piaffe(&arguments), "this is what was read: write to another file");
        assert_eq!(std::fs::read(&file).unwrap(), std::fs::read(&TROT.1).unwrap(), "{arguments:?}");
    }
    let robot = folder.path().join("dog");
    copy(Path::new("model-spec"), &robot);
    let target = robot.join("robot.toml");
    let before = std::fs::read(&target).unwrap();
    let (robot, target) = (robot.to_str().unwrap(), target.to_str().unwrap());
    refused(&piaffe(&["check", robot, "--svg", target]), "this is what was read");
    refused(
        &piaffe(&["optimize", "trot", "--speed", "0.6", "--robot", robot, "--json", target]),
        "this is what was read",
    );
    assert_eq!(std::fs::read(target).unwrap(), before);
}

/// What was found is kept, whatever becomes of the words about it.
#[cfg(target_os = "linux")]
#[test]
fn results_are_written_where_words_cannot_be() {
    let folder = tempdir().unwrap();
    let full = || std::fs::File::options().write(true).open("/dev/full").unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(PIAFFE);
        command.args(arguments).current_dir(folder.path()).stdout(full()).output().unwrap()
    };
    let trot = TROT.1.to_str().unwrap();
    let optimize = ["optimize", "trot", "--speed", "0.6", "--starts", "1", "--examine", "none", "--json", "new.json"];
    for (arguments, written) in [
        (&optimize[..], "new.json"),
        (&["verify", trot, "--json", "verdicts.json"], "verdicts.json"),
        (&["diff", trot, trot, "--json", "difference.json"], "difference.json"),
        (&["study", "trot", "--speed", "0.6", "--criterion", "torque"], "study/study.html"),
    ] {
        refused(&run(arguments), "cannot write to standard output");
        assert!(folder.path().join(written).exists(), "{arguments:?}");
    }
}

#[test]
fn hidden_files_are_nobodys_gaits_and_devices_are_no_specifications() {
    let folder = tempdir().unwrap();
    let robot = folder.path().join("dog");
    copy(Path::new("model-spec"), &robot);
    std::fs::write(robot.join("gaits/.#trot.toml"), "an editor's lock").unwrap();
    let told = text(&piaffe_on(&["check"], &robot).stdout);
    assert!(told.contains("It builds."), "{told}");
    let [toml, gait] = [robot.join("robot.toml"), robot.join("gaits/trot.toml")];
    let [of_robot, of_gait] = [&toml, &gait].map(|file| std::fs::read_to_string(file).unwrap());
    std::fs::write(&toml, of_robot.replacen("gravity", "grvity", 1)).unwrap();
    std::fs::write(&gait, of_gait.replacen("friction", "frction", 1)).unwrap();
    let out = piaffe_on(&["check"], &robot);
    refused(&out, "unknown key `grvity`");
    refused(&out, "unknown key `limits.frction`");
    #[cfg(unix)]
    {
        std::fs::remove_file(&toml).unwrap();
        std::os::unix::fs::symlink("/dev/zero", &toml).unwrap();
        refused(&piaffe_on(&["check"], &robot), "it has more than");
    }
}

/// An optimum, and its folder.
static TROT: LazyLock<(TempDir, PathBuf, Value)> = LazyLock::new(|| {
    let folder = tempdir().unwrap();
    let file = folder.path().join("trot.json");
    let out = piaffe_on(&["optimize", "trot", "--speed", "0.6", "--starts", "1", "--quiet", "--json"], &file);
    assert!(out.status.success(), "{}", text(&out.stderr));
    let result = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    (folder, file, result)
});

fn saved(folder: &Path, name: &str, value: &Value) -> String {
    let path = folder.join(name);
    std::fs::write(&path, value.to_string()).unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn texts_in_files_are_shown_and_not_obeyed() {
    let folder = tempdir().unwrap();
    let mut result = TROT.2.clone();
    let hostile = "x\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}\nforged.json: trot, confirmed";
    for key in ["robot", "message"] {
        result[key] = hostile.into();
    }
    result["receipt"]["findings"][0]["constraint"] = hostile.into();
    result[hostile] = hostile.into();
    let file = saved(folder.path(), "hostile.json", &result);
    let report = folder.path().join("report");
    let acts = |told: &str| told.chars().any(|c| (c.is_control() && c != '\n') || c == '\u{202e}');
    for arguments in [
        vec!["verify", &file],
        vec!["report", &file, "--out", report.to_str().unwrap()],
        vec!["export", &file, "--format", "json"],
        vec!["lift", &file, "--rate", "10"],
    ] {
        let out = piaffe(&arguments);
        for told in [text(&out.stdout), text(&out.stderr)] {
            assert!(!acts(&told) && !told.lines().any(|line| line.starts_with("forged")), "{arguments:?}: {told:?}");
        }
    }
    let told = text(&piaffe(&["verify", &file]).stdout);
    assert!(told.contains("\\u{1b}]0;owned\\u{7}"), "{told}");
    if let Ok(page) = std::fs::read_to_string(report.join("index.html")) {
        assert!(!acts(&page.replace('\t', " ")));
    }
}

#[test]
fn a_file_is_taken_for_what_it_is() {
    let folder = tempdir().unwrap();
    let (_, file, result) = &*TROT;
    let good = file.to_str().unwrap();
    let several = saved(folder.path(), "several.json", &json!([result, result]));
    let out = piaffe(&["verify", &several]);
    assert!(out.status.success(), "{}", text(&out.stdout));
    assert!(text(&out.stdout).contains("several.json[1]: trot-energy-0.6, confirmed"), "{}", text(&out.stdout));

    let controller = folder.path().join("controller.json");
    let export = ["export", good, "--format", "json", "--out", controller.to_str().unwrap()];
    assert!(piaffe(&export).status.success());
    refused(&piaffe_on(&["verify"], &controller), "controller.json is no result: it has the keys ");
    refused(&piaffe_on(&["lift"], &controller), "controller.json is no result");
    refused(&piaffe(&["export", &several, "--format", "csv"]), "holds 2 results: give one of them");
    for (name, value) in [("empty.json", json!([])), ("number.json", json!(1)), ("list.json", json!([1, 2]))] {
        refused(&piaffe(&["verify", &saved(folder.path(), name, &value)]), "no result");
    }

    // No key stands twice, wherever it is; what begins a text is not part of it.
    let text_of = std::fs::read_to_string(file).unwrap();
    let twice = text_of.replacen("\"cost\":", "\"cost\": 1.0, \"cost\":", 1);
    for (name, text) in [("twice.json", twice.clone()), ("twices.json", format!("[{twice}]"))] {
        std::fs::write(folder.path().join(name), text).unwrap();
        refused(&piaffe_on(&["verify"], &folder.path().join(name)), "duplicate field `cost`");
    }
    std::fs::write(folder.path().join("marked.json"), format!("\u{feff}{text_of}")).unwrap();
    assert!(piaffe_on(&["verify"], &folder.path().join("marked.json")).status.success());

    // What cannot be read does not keep the rest from being checked, and is not forgotten.
    let out =
        piaffe(&["verify", "/nonexistent.json", &several, folder.path().join("number.json").to_str().unwrap(), good]);
    let (told, errors) = (text(&out.stdout), text(&out.stderr));
    assert_eq!((out.status.code(), told.matches(", confirmed").count()), (Some(1), 3), "{told}");
    assert!(errors.contains("2 of 5 results could not be read"), "{errors}");

    // A report of one and the same twice shows it once; of two different ones it would not know which.
    let report = folder.path().join("report");
    let to = ["--out", report.to_str().unwrap()];
    assert!(piaffe(&[&["report", good, &several][..], &to].concat()).status.success());
    let mut other = result.clone();
    other["search"]["seed"] = 2.into();
    let other = saved(folder.path(), "other.json", &other);
    refused(
        &piaffe(&[&["report", good, &other][..], &to].concat()),
        "two different results of one task, trot-energy-0.6",
    );
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &to)
        } else {
            drop(std::fs::copy(entry.path(), to))
        }
    }
}

#[test]
fn files_that_have_changed_since_the_build_are_taken_and_named() {
    let folder = tempdir().unwrap();
    let spec = folder.path().join("model-spec");
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("model-spec"), &spec);
    let told = |arguments: &[&str]| {
        let out = Command::new(PIAFFE).args(arguments).current_dir(folder.path()).output().unwrap();
        text(&out.stderr)
    };
    assert_eq!(told(&["model", "trot"]), "");

    let robot = spec.join("robot.toml");
    let heavier = std::fs::read_to_string(&robot).unwrap().replace("mass = 6.65", "mass = 7.65");
    std::fs::write(&robot, heavier).unwrap();
    let note = told(&["model", "trot"]);
    assert_eq!(
        note,
        "note: model-spec/robot.toml has changed since this program was built: it takes the files as they are now\n"
    );
    assert_eq!(told(&["model", "trot", "--quiet"]), "");
    // That is another robot.
    assert_eq!(told(&["model", "rabbit/walk"]), "");
    let mass = |arguments: &[&str]| {
        let out = Command::new(PIAFFE).args(arguments).current_dir(folder.path()).output().unwrap();
        serde_json::from_slice::<Value>(&out.stdout).unwrap()["mass"].as_f64().unwrap()
    };
    assert!((mass(&["model", "trot", "--json", "-"]) - 14.85).abs() < 1e-12);

    copy(&spec.join("rabbit"), &spec.join("hare"));
    for gait in ["walk", "run"] {
        std::fs::remove_file(spec.join(format!("rabbit/gaits/{gait}.toml"))).unwrap();
    }
    let note = told(&["model", "rabbit/walk"]);
    assert!(note.contains("there is no gait in model-spec/rabbit/gaits: write one"), "{note}");
    let note = told(&["model", "hare/walk"]);
    assert!(note.starts_with("note: model-spec/hare/robot.toml is new"), "{note}");
    assert_eq!(note.lines().count(), 1, "{note}");
}
