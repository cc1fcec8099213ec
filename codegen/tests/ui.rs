//! What the user sees: every `ui/*.toml` is a broken spec beside the messages that it must give.
//!
//! `robot_*.toml` are robots, `gait_*.toml` are gaits of the shipped robot, or of the one that a first line
//! `# robot: robots/<file>` names. `BLESS=1 cargo test --test ui` writes the expected messages anew.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use piaffe_codegen::spec::{Code, Diagnostic, RobotFile, parse_gait, parse_robot};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ui")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn file_name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).expect("names of cases are plain text")
}

fn cases() -> Vec<PathBuf> {
    let mut cases: Vec<_> = fs::read_dir(folder())
        .expect("the folder of cases")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    cases.sort();
    cases
}

/// The robot that a gait names, or the shipped one.
fn robot_of(gait: &str) -> RobotFile {
    let named = gait.lines().next().and_then(|line| line.strip_prefix("# robot: "));
    let path = match named {
        Some(name) => folder().join(name.trim()),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../model-spec/robot.toml"),
    };
    let parsed = parse_robot(file_name(&path), &read(&path));
    parsed.unwrap_or_else(|found| panic!("{}:\n{}", path.display(), rendered(&found)))
}

fn rendered(found: &[Diagnostic]) -> String {
    found.iter().map(|d| d.render() + "\n").collect::<Vec<_>>().join("\n")
}

/// The mistakes in one case.
fn found_in(case: &Path) -> Vec<Diagnostic> {
    let (name, text) = (file_name(case), read(case));
    let found = match name.split_once('_') {
        Some(("robot", _)) => parse_robot(name, &text).err(),
        Some(("gait", _)) => parse_gait(name, &text, &robot_of(&text)).err(),
        _ => panic!("{name}: call it robot_… or gait_…"),
    };
    found.unwrap_or_else(|| panic!("{name}: nothing is wrong with it"))
}

#[test]
fn messages() {
    let bless = std::env::var_os("BLESS").is_some();
    let mut changed = Vec::new();
    for case in cases() {
        let messages = rendered(&found_in(&case));
        let expected = case.with_extension("stderr");
        if bless {
            fs::write(&expected, &messages).expect("written");
        } else if fs::read_to_string(&expected).unwrap_or_default() != messages {
            changed.push(format!("==== {}\n{messages}", file_name(&case)));
        }
    }
    assert!(changed.is_empty(), "{}\nBLESS=1 accepts these messages", changed.join("\n"));
}

#[test]
fn every_code_has_a_case() {
    let seen: BTreeSet<Code> = cases().iter().flat_map(|case| found_in(case)).map(|d| d.code).collect();
    let unseen: Vec<_> = Code::ALL.iter().filter(|code| !seen.contains(code)).collect();
    assert!(unseen.is_empty(), "{unseen:?}");
}

#[test]
fn every_message_says_where_and_what_instead() {
    for case in cases() {
        for d in found_in(&case) {
            let name = file_name(&case);
            assert!(!d.title.is_empty() && !d.primary.text.is_empty() && !d.help.is_empty(), "{name}: {d:?}");
            assert!(d.primary.span.end <= d.primary.source.text().len(), "{name}: {d:?}");
            assert!(d.render().contains(&format!("error[{}]", d.code)), "{name}: {d}");
        }
    }
}
