//! What one process has derived serves the next: where it is kept, and that no bit of an answer depends on it.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::tempdir;

const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec");
/// A gait whose real legs are looked at too.
const AMBLE: &str = "optimize amble --speed 0.6 --starts 1 --json - --robot";

/// The program, which keeps what it derives where these variables say.
fn run(arguments: &str, variables: &[(&str, &Path)]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_piaffe"));
    for name in ["PIAFFE_CACHE", "XDG_CACHE_HOME", "HOME"] {
        command.env_remove(name);
    }
    let out = command.args(arguments.split(' ')).envs(variables.iter().copied()).output().unwrap();
    assert!(out.status.success(), "{arguments}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

/// A result without its wall time.
fn amble(options: &str, variables: &[(&str, &Path)]) -> Value {
    let mut result: Value = serde_json::from_str(&run(&format!("{AMBLE} {SHIPPED}{options}"), variables)).unwrap();
    result.as_object_mut().unwrap().remove("seconds");
    result
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn what_is_kept_changes_no_bit() {
    let folder = tempdir().unwrap();
    let kept = [("PIAFFE_CACHE", folder.path())];
    let without = amble("", &[("PIAFFE_CACHE", Path::new("off"))]);
    assert_eq!(amble("", &kept), without);
    let written = files(folder.path());
    assert_eq!(written.len(), 2, "the gait and the whole robot: {written:?}");
    assert_eq!(amble("", &kept), without, "of what was read");
    assert_eq!(files(folder.path()), written);

    // Whatever is wrong with the files.
    fs::write(&written[0], "no derivation").unwrap();
    let bytes = fs::read(&written[1]).unwrap();
    fs::write(&written[1], &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(amble("", &kept), without);
    assert_eq!(fs::read(&written[1]).unwrap(), bytes, "it was not written anew");

    // Limits have no part in what is derived, masses have.
    amble(" --friction 0.8 --torque-scale 1.1", &kept);
    assert_eq!(files(folder.path()), written);
    amble(" --set links.thigh.mass=1.5", &kept);
    assert_eq!(files(folder.path()).len(), 4);
}

#[test]
fn a_study_has_the_same_bytes() {
    let folder = tempdir().unwrap();
    let asked = |out: &str, kept: &Path| {
        let out = folder.path().join(out);
        let varied = "--vary links.thigh.mass=1.4,1.6 --vary limits.friction=0.7,0.9";
        let asked = format!("study trot --speed 0.6 {varied} --also slopes --robot {SHIPPED} --out {}", out.display());
        run(&asked, &[("PIAFFE_CACHE", kept)]);
        fs::read(out.join("study.csv")).unwrap()
    };
    let kept = folder.path().join("kept");
    let without = asked("without", Path::new("off"));
    assert_eq!(asked("first", &kept), without);
    let written = files(&kept);
    assert!(!written.is_empty());
    assert_eq!(asked("second", &kept), without);
    assert_eq!(files(&kept), written);
}

#[test]
fn the_users_folder_is_taken_and_none_is_needed() {
    let folder = tempdir().unwrap();
    let asked = format!("model trot --robot {SHIPPED}");
    run(&asked, &[("XDG_CACHE_HOME", folder.path())]);
    assert_eq!(files(&folder.path().join("piaffe")).len(), 1);
    run(&asked, &[("HOME", folder.path())]);
    assert_eq!(files(&folder.path().join(".cache/piaffe")).len(), 1);
    // Nothing can be made below a file.
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for name in ["HOME", "XDG_CACHE_HOME", "PIAFFE_CACHE"] {
        run(&asked, &[(name, &file)]);
    }
}
