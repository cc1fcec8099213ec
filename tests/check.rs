//! `piaffe import` and `piaffe check` as a person runs them.

use std::path::Path;
use std::process::{Command, Output};

fn piaffe(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_piaffe")).args(arguments).current_dir(folder).output().unwrap()
}

fn words(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn case(name: &str) -> String {
    format!("{}/tests/import/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn what_is_imported_passes_the_check_and_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let made = piaffe(&["import", &case("00-control-ok.urdf"), "--out", "dog", "--untried"], folder.path());
    assert!(made.status.success(), "{}", words(&made));
    let checked = piaffe(&["check", "dog", "--svg", "dog.svg"], folder.path());
    assert!(
        checked.status.success() && words(&checked).contains("12.00 kg on 4 legs; gaits: bound, trot. It builds."),
        "{}",
        words(&checked)
    );
    let drawing = std::fs::read_to_string(folder.path().join("dog.svg")).unwrap();
    assert!(roxmltree::Document::parse(&drawing).is_ok());
    // A second import does not write over the first.
    let again = piaffe(&["import", &case("00-control-ok.urdf"), "--out", "dog"], folder.path());
    assert!(!again.status.success() && words(&again).contains("exists already"));
    let robot = folder.path().join("dog/robot.toml");
    let text = std::fs::read_to_string(&robot).unwrap();
    std::fs::write(&robot, text.replacen("mass = 8.0", "mass = -8.0", 1)).unwrap();
    let checked = piaffe(&["check", "dog"], folder.path());
    assert!(!checked.status.success() && words(&checked).contains("robot.toml:") && words(&checked).contains("S006"));
}

#[test]
fn what_cannot_be_imported_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    for (file, out, options) in [("degrees.urdf", "biped", &[][..]), ("12-y-forward.urdf", "dog", &["--forward", "z"])]
    {
        let made = piaffe(&[&["import", &case(file), "--out", out], options].concat(), folder.path());
        assert!(!made.status.success(), "{}", words(&made));
        assert!(!folder.path().join(out).exists(), "{file}");
    }
    let made =
        piaffe(&["import", &case("12-y-forward.urdf"), "--out", "dog", "--forward", "-y", "--untried"], folder.path());
    assert!(made.status.success(), "{}", words(&made));
}

/// A gait that builds may ask for what no robot can do: that is told with the numbers, of all gaits at once.
#[test]
fn limits_to_which_no_motion_keeps_are_told() {
    let folder = tempfile::tempdir().unwrap();
    piaffe(&["import", &case("00-control-ok.urdf"), "--out", "dog", "--untried"], folder.path());
    let change = |gait: &str, from: &str, to: &str| {
        let file = folder.path().join(format!("dog/gaits/{gait}.toml"));
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{text}");
        std::fs::write(file, text.replacen(from, to, 1)).unwrap();
    };
    change("trot", "min_vertical_force = ", "min_vertical_force = 1000 # ");
    change("bound", "min_vertical_force = ", "min_platform_height = 2\nmin_vertical_force = ");
    let checked = piaffe(&["check", "dog"], folder.path());
    let told = words(&checked);
    assert_eq!(checked.status.code(), Some(1), "{told}");
    for part in [
        "It builds.",
        "trot: no motion keeps to limits.min_vertical_force = 1000 N",
        "117.7 N",
        "bound: no motion keeps to limits.min_platform_height = 2 m",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let optimized = piaffe(&["optimize", "trot", "--robot", "dog", "--speed", "0.5"], folder.path());
    assert!(optimized.status.code() == Some(3) && words(&optimized).contains("= 1000 N"), "{}", words(&optimized));
}

/// A name that no module can have keeps nobody from the robot but a build.
#[test]
fn a_folder_may_be_called_as_it_likes() {
    let folder = tempfile::tempdir().unwrap();
    let made = piaffe(&["import", &case("00-control-ok.urdf"), "--out", "My-Dog", "--untried"], folder.path());
    let checked = piaffe(&["check", "My-Dog"], folder.path());
    assert!(words(&checked).contains("It goes."), "{}", words(&checked));
    for told in [made, checked] {
        assert!(
            told.status.success() && words(&told).contains("the folder `My-Dog` needs another name"),
            "{}",
            words(&told)
        );
    }
}

/// From a file to a page, by the commands that the import itself gives.
#[test]
fn what_is_imported_has_been_tried_and_goes() {
    let folder = tempfile::tempdir().unwrap();
    let made = piaffe(&["import", &case("sensor_foot.urdf"), "--out", "biped"], folder.path());
    assert!(made.status.success(), "{}", words(&made));
    let told = words(&made);
    let commands: Vec<Vec<&str>> =
        told.lines().filter_map(|line| Some(line.strip_prefix("  piaffe ")?.split(' ').collect())).collect();
    assert_eq!(commands.len(), 2, "{told}");
    for command in commands {
        let out = piaffe(&command, folder.path());
        assert!(out.status.success(), "{command:?}: {}", words(&out));
    }
    let text = std::fs::read_to_string(folder.path().join("biped/gaits/walk.toml")).unwrap();
    assert!(
        text.contains("# Least torque that a short search found") && text.contains("# It found nothing at"),
        "{text}"
    );
    // What is said of the gait holds: it is found again.
    let (_, costs) = text.split_once("(local optima): ").unwrap();
    let (cost, rest) = costs.split_once(" at ").unwrap();
    let (speed, _) = rest.split_once(" m/s").unwrap();
    let again = ["optimize", "walk", "--robot", "biped", "--criterion", "torque", "--speed", speed, "--json", "-"];
    let again: serde_json::Value = serde_json::from_slice(&piaffe(&again, folder.path()).stdout).unwrap();
    let (known, again): (f64, f64) = (cost.parse().unwrap(), again["cost"].as_f64().unwrap());
    assert!(again < known * (1.0 + 1e-4), "{again} {known}");
}
