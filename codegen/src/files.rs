//! The files of a specification: which there are, what is in them, and how a number in them is changed. Nothing is written.

use crate::spec;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Names of no number that are told one by one.
const UNKNOWN_SHOWN: usize = 10;

/// No specification file is larger, in bytes; without an end, a device would fill the memory.
const LARGEST: u64 = 1 << 24;

/// A specification file: its path as shown in messages and its text.
#[derive(Clone, Debug)]
pub struct SpecFile {
    pub path: String,
    pub text: String,
}

/// A robot's file with those of its gaits.
#[derive(Clone, Debug)]
pub struct RobotFiles {
    /// Module of its gaits; empty for a robot whose gaits need none.
    pub module: String,
    pub robot: SpecFile,
    pub gaits: Vec<SpecFile>,
}

impl RobotFiles {
    /// The robots of a folder, as a build finds them: its own first, whose gaits need no module, then those of the folders in it.
    ///
    /// # Errors
    /// What is missing or cannot be read.
    pub fn of_folder(folder: &Path) -> Result<Vec<RobotFiles>, String> {
        robots(Path::new(""), folder)
    }

    /// The paths of all that a build reads in a folder of robots, whatever is in the files.
    ///
    /// # Errors
    /// If a folder cannot be read.
    pub fn paths(folder: &Path) -> Result<Vec<PathBuf>, String> {
        let mut paths = Vec::new();
        for folder in with_robots(Path::new(""), folder)? {
            paths.push(folder.join("robot.toml"));
            paths.extend(gait_files(Path::new(""), &folder)?);
        }
        Ok(paths)
    }

    /// Changes a number where it stands: in the robot's file, or else in those of the gaits that have it. A name with braces,
    /// `links.{left,right}_shin.mass`, changes several: each becomes the value, those of opposite signs stay so. Nothing else changes.
    ///
    /// # Errors
    /// If there is none of this name, which there are.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), String> {
        self.set_all([(name, value)]).map_err(|faults| faults.join("\n"))
    }

    /// Changes several numbers at once, whatever their order.
    ///
    /// # Errors
    /// All names that are none, and numbers that cannot be what is wanted of them; the others are changed all the same.
    pub fn set_all<'n>(&mut self, numbers: impl IntoIterator<Item = (&'n str, f64)>) -> Result<(), Vec<String>> {
        let (wanted, mut faults) = self.wanted(numbers);
        let set_in = |file: &mut SpecFile, wanted: &[(&str, f64)]| {
            let (text, known) = spec::set_all(&file.text, wanted);
            file.text = text;
            known
        };
        let mut rest: Vec<(&str, f64)> = wanted.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let in_robot = set_in(&mut self.robot, &rest);
        rest = rest.into_iter().zip(in_robot).filter_map(|(wanted, known)| (!known).then_some(wanted)).collect();
        let mut known = vec![false; rest.len()];
        for gait in &mut self.gaits {
            known.iter_mut().zip(set_in(gait, &rest)).for_each(|(any, own)| *any |= own);
        }
        let unknown: Vec<&str> =
            rest.iter().zip(known).filter_map(|((name, _), known)| (!known).then_some(*name)).collect();
        faults.extend(unknown.iter().take(UNKNOWN_SHOWN).map(|name| spec::unknown(name, self.texts())));
        if unknown.len() > UNKNOWN_SHOWN {
            faults.push(format!("and there are no {} more of these numbers", unknown.len() - UNKNOWN_SHOWN));
        }
        if faults.is_empty() { Ok(()) } else { Err(faults) }
    }

    /// What single numbers are to become, and what is wrong with that.
    pub(crate) fn wanted<'n>(
        &self,
        numbers: impl IntoIterator<Item = (&'n str, f64)>,
    ) -> (BTreeMap<String, f64>, Vec<String>) {
        let old: BTreeMap<String, f64> = self.numbers().into_iter().collect();
        let old = |name: &str| old.get(name).copied().unwrap_or(0.0);
        let (mut wanted, mut faults) = (BTreeMap::new(), Vec::new());
        for (name, value) in numbers {
            if !value.is_finite() {
                faults.push(format!("`{name}` cannot be {value}: give a number"));
                continue;
            }
            let names = spec::alternatives(name);
            let first = names.iter().map(|name| old(name)).find(|old| *old != 0.0).unwrap_or(0.0);
            for name in names {
                let value = if old(&name) * first < 0.0 { -value } else { value };
                match wanted.get(&name) {
                    Some(other) if *other != value => {
                        faults.push(clash(&name, *other, value));
                    }
                    _ => drop(wanted.insert(name, value)),
                }
            }
        }
        (wanted, faults)
    }

    /// The number of this name, in the robot's file or else in the first gait's that has it; of a name with braces the first.
    pub fn number(&self, name: &str) -> Option<f64> {
        let names = spec::alternatives(name);
        let name = names.first()?;
        let mut texts = std::iter::once(&self.robot).chain(&self.gaits);
        texts.find_map(|file| spec::number(&file.text, name))
    }

    /// All numbers by their names, those of the robot's file first. What several gaits have is that of the first.
    pub fn numbers(&self) -> Vec<(String, f64)> {
        let texts = std::iter::once(&self.robot).chain(&self.gaits);
        let mut known = BTreeSet::new();
        let all = texts.flat_map(|file| spec::numbers(&file.text)).filter(|number| known.insert(number.name.clone()));
        all.map(|number| (number.name, number.value)).collect()
    }

    fn texts(&self) -> impl Iterator<Item = &str> {
        self.gaits.iter().chain([&self.robot]).map(|file| file.text.as_str())
    }

    /// Reads a robot's folder: `robot.toml` and `gaits/*.toml`. Its module is called like the folder.
    ///
    /// # Errors
    /// What is missing or cannot be read.
    pub fn read(folder: &Path) -> Result<RobotFiles, String> {
        let name =
            std::path::absolute(folder).ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
        robot_files(Path::new(""), folder, name.unwrap_or_default())
    }
}

/// What to say of a number that is to be two things at once.
pub(crate) fn clash(name: &str, one: f64, other: f64) -> String {
    format!("`{name}` cannot be both {one:?} and {other:?}: give it once")
}

/// The robots of a folder: its own first, then those of the folders in it, by name.
pub(crate) fn robots(root: &Path, folder: &Path) -> Result<Vec<RobotFiles>, String> {
    let robot = |path: &PathBuf| {
        let module = if path == folder { "".into() } else { path.file_name().unwrap_or_default().to_string_lossy() };
        robot_files(root, path, module.into_owned())
    };
    let robots: Vec<RobotFiles> = with_robots(root, folder)?.iter().map(robot).collect::<Result<_, _>>()?;
    if robots.is_empty() {
        let own = folder.join("robot.toml");
        return Err(format!("there is no robot in {}: write {}", folder.display(), own.display()));
    }
    Ok(robots)
}

/// The folder itself and those in it, as far as they have a robot.
fn with_robots(root: &Path, folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut folders = vec![folder.to_path_buf()];
    folders.extend(entries(root, folder)?);
    folders.retain(|path| root.join(path).join("robot.toml").exists());
    Ok(folders)
}

/// The files of a robot's gaits, by name.
fn gait_files(root: &Path, folder: &Path) -> Result<Vec<PathBuf>, String> {
    let gaits = folder.join("gaits");
    let mut files = if root.join(&gaits).exists() { entries(root, &gaits)? } else { Vec::new() };
    files.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    Ok(files)
}

fn robot_files(root: &Path, folder: &Path, module: String) -> Result<RobotFiles, String> {
    if !root.join(folder).is_dir() {
        return Err(format!("there is no folder {}: a robot's has robot.toml and gaits/*.toml", folder.display()));
    }
    let files: Vec<SpecFile> =
        gait_files(root, folder)?.iter().map(|path| read(root, path)).collect::<Result<_, _>>()?;
    if files.is_empty() {
        return Err(format!(
            "there is no gait in {}: write one, for example {0}/trot.toml; or set the robot aside: rename {}",
            folder.join("gaits").display(),
            folder.join("robot.toml").display()
        ));
    }
    Ok(RobotFiles { module, robot: read(root, &folder.join("robot.toml"))?, gaits: files })
}

/// What is in a folder, by name; hidden files, such as an editor's locks, are nobody's.
fn entries(root: &Path, folder: &Path) -> Result<Vec<PathBuf>, String> {
    let failed = |e: io::Error| format!("cannot read the folder {}: {e}", folder.display());
    let mut entries = Vec::new();
    for entry in fs::read_dir(root.join(folder)).map_err(failed)? {
        let name = entry.map_err(failed)?.file_name();
        if !name.to_string_lossy().starts_with('.') {
            entries.push(folder.join(name));
        }
    }
    entries.sort();
    Ok(entries)
}

fn read(root: &Path, path: &Path) -> Result<SpecFile, String> {
    let cannot = |why: &dyn std::fmt::Display| format!("cannot read the specification {}: {why}", path.display());
    let mut text = String::new();
    let file = fs::File::open(root.join(path)).map_err(|e| cannot(&e))?;
    let length = file.take(LARGEST + 1).read_to_string(&mut text).map_err(|e| match e.kind() {
        io::ErrorKind::InvalidData => cannot(&"it is no text in UTF-8: save it as that"),
        _ => cannot(&e),
    })?;
    if length as u64 > LARGEST {
        return Err(cannot(&format!("it has more than {} MB", LARGEST >> 20)));
    }
    Ok(SpecFile { path: path.display().to_string(), text })
}

/// Of files one after the other.
pub(crate) fn sha256(files: &[&SpecFile]) -> String {
    let mut hash = Sha256::new();
    files.iter().for_each(|file| hash.update(file.text.as_bytes()));
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}
