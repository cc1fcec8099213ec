//! Which specification this program answers for: the one that it was built from, whatever became of the files since.

use super::output;
use piaffe_model::Gait;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::OnceLock;

/// What a build knows: the robots' gaits, and the specification that they come from.
#[derive(Clone, Copy)]
pub struct Build {
    /// The generated gaits; the command line needs at least one.
    pub gaits: &'static [&'static dyn Gait],
    /// The folder of the specification, from the package's root.
    pub folder: &'static str,
    /// Its files when this was built, with their SHA-256.
    pub files: &'static [(&'static str, &'static str)],
}

/// Of this program; set once, when it starts.
static BUILD: OnceLock<Build> = OnceLock::new();

/// What this program was built with; the first that is said counts.
pub fn set(build: Build) {
    BUILD.get_or_init(|| build);
}

fn build() -> Build {
    BUILD.get().copied().unwrap_or(Build { gaits: &[], folder: "", files: &[] })
}

/// The gaits of this program.
pub fn gaits() -> &'static [&'static dyn Gait] {
    build().gaits
}

/// The module that a build would make of a folder: one of its name, none of that of the specification itself.
pub fn module_of(folder: &Path) -> std::io::Result<String> {
    let absolute = std::path::absolute(folder)?;
    let name = absolute.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(if Path::new(build().folder).file_name() == absolute.file_name() { String::new() } else { name })
}

/// Files that are named.
const SHOWN: usize = 3;

/// Says what differs, where the folder of the specification is here: of the robots of these gaits.
pub fn note_of(gaits: &[&dyn Gait]) {
    let modules: BTreeSet<&str> = gaits.iter().map(|g| module(g.description().key)).collect();
    note(|file| modules.contains(robot_of(file)));
}

/// The same of all robots.
pub fn note_of_all() {
    note(|_| true);
}

fn note(concerns: impl Fn(&str) -> bool) {
    let differences: Vec<(String, &str)> =
        differences(Path::new(".")).into_iter().filter(|(file, _)| concerns(file)).collect();
    let Some((first, _)) = differences.first() else { return };
    let robot = robot_of(first);
    let whose = match gaits().iter().map(|g| g.description()).find(|d| module(d.key) == robot) {
        Some(d) if differences.iter().all(|(file, _)| robot_of(file) == robot) => format!("the robot {}", d.robot),
        _ => "the robots".into(),
    };
    let mut which: Vec<String> = differences.iter().take(SHOWN).map(|(file, how)| format!("{file} {how}")).collect();
    if differences.len() > SHOWN {
        which.push(format!("and {} more", differences.len() - SHOWN));
    }
    output::note(&format!(
        "this program answers for {whose} as it was built, but {}: `cargo build` brings it up to date",
        which.join(", ")
    ));
}

/// The robot's part of a gait's key; empty for the robot that needs no name.
fn module(key: &str) -> &str {
    key.split_once('/').map_or("", |(robot, _)| robot)
}

/// The same of a file's path in the specification.
fn robot_of(file: &str) -> &str {
    let inside = file.strip_prefix(build().folder).unwrap_or(file).trim_start_matches('/');
    match inside.split_once('/') {
        Some((robot, _)) if robot != "gaits" => robot,
        _ => "",
    }
}

/// Files of the specification that are not what they were when this program was built, and how they differ.
fn differences(root: &Path) -> Vec<(String, &'static str)> {
    let mut list = Vec::new();
    let now = files(root);
    if now.is_empty() {
        return list;
    }
    for (file, built) in build().files {
        match std::fs::read(root.join(file)) {
            Ok(text) if digest(&text) == *built => {}
            Ok(_) => list.push((file.to_string(), "has changed")),
            Err(_) => list.push((file.to_string(), "is gone")),
        }
    }
    let known = |file: &String| build().files.iter().any(|(known, _)| known == file);
    list.extend(now.into_iter().filter(|file| !known(file)).map(|file| (file, "is new")));
    list
}

/// What a build would read now.
fn files(root: &Path) -> Vec<String> {
    let names = |folder: &str| -> Vec<String> {
        let entries = std::fs::read_dir(root.join(folder)).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        names.sort();
        names
    };
    let folder = build().folder;
    let mut folders = vec![folder.to_string()];
    folders.extend(names(folder).into_iter().map(|name| format!("{folder}/{name}")));
    let mut files = Vec::new();
    for folder in folders {
        let robot = format!("{folder}/robot.toml");
        if root.join(&robot).exists() {
            files.push(robot);
            let gaits = names(&format!("{folder}/gaits")).into_iter().filter(|name| name.ends_with(".toml"));
            files.extend(gaits.map(|name| format!("{folder}/gaits/{name}")));
        }
    }
    files
}

fn digest(text: &[u8]) -> String {
    Sha256::digest(text).iter().map(|b| format!("{b:02x}")).collect()
}
