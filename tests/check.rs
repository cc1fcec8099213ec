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
    let made = piaffe(&["import", &case("00-control-ok.urdf"), "--out", "dog"], folder.path());
    assert!(made.status.success(), "{}", words(&made));
    let checked = piaffe(&["check", "dog", "--svg", "dog.svg"], folder.path());
    assert!(
        checked.status.success() && words(&checked).contains("12.000 kg on 4 legs; gaits: bound, trot. It builds."),
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
    for (file, out, options) in [
        ("degrees.urdf", "biped", &[][..]),
        ("00-control-ok.urdf", "My-Dog", &[]),
        ("12-y-forward.urdf", "dog", &["--forward", "z"]),
    ] {
        let made = piaffe(&[&["import", &case(file), "--out", out], options].concat(), folder.path());
        assert!(!made.status.success(), "{}", words(&made));
        assert!(!folder.path().join(out).exists(), "{file}");
    }
    let made = piaffe(&["import", &case("12-y-forward.urdf"), "--out", "dog", "--forward", "-y"], folder.path());
    assert!(made.status.success(), "{}", words(&made));
}
