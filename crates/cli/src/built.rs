//! What this program was built with, and what became of the files since.

use super::harmless::line;
use super::{input, whole};
use piaffe_codegen::RobotFiles;
use piaffe_codegen::spec::unusable_as_folder;
use piaffe_model::motion::Criterion;
use piaffe_model::{Description, Gait};
use sha2::{Digest, Sha256};
use std::path::{MAIN_SEPARATOR, Path};
use std::sync::OnceLock;

/// What a build knows: the robots' gaits, and the specification that they come from.
#[derive(Clone, Copy)]
pub struct Build {
    /// The generated gaits.
    pub gaits: &'static [&'static dyn Gait],
    /// The folder of the specification, from the package's root.
    pub folder: &'static str,
    /// Its files when this was built, with their SHA-256.
    pub files: &'static [(&'static str, &'static str)],
    /// What others have published of these gaits.
    pub published: &'static [Published],
}

/// An optimum that was published.
#[derive(Clone, Copy, Debug)]
pub struct Published {
    /// [`Description::fingerprint`] of the gait: of another robot's gait of the same name it says nothing.
    pub fingerprint: &'static str,
    pub criterion: Criterion,
    /// m/s.
    pub speed: f64,
    /// In the criterion's unit.
    pub cost: f64,
    /// Of its phases, s, as they were published.
    pub durations: &'static str,
}

impl Published {
    pub fn is_of(&self, gait: &Description) -> bool {
        gait.fingerprint() == self.fingerprint
    }
}

/// Of this program; set once, when it starts.
static BUILD: OnceLock<Build> = OnceLock::new();

/// What this program was built with; the first that is said counts.
pub fn set(build: Build) {
    BUILD.get_or_init(|| build);
}

fn build() -> Build {
    BUILD.get().copied().unwrap_or(Build { gaits: &[], folder: "", files: &[], published: &[] })
}

/// The gaits of this program.
pub fn gaits() -> &'static [&'static dyn Gait] {
    build().gaits
}

/// What others have published of them.
pub fn published() -> &'static [Published] {
    build().published
}

/// The module that a build would make of a folder: one of its name, none of that of the specification itself. A name that no module
/// can have keeps nobody from the robot but a build: then that is told instead.
pub fn module_of(folder: &Path) -> std::io::Result<Result<String, String>> {
    let absolute = std::path::absolute(folder)?;
    let name = absolute.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if Path::new(build().folder).file_name() == absolute.file_name() {
        return Ok(Ok(String::new()));
    }
    let unusable = unusable_as_folder(&name).map(|why| {
        let name = line(&name);
        format!("for a build the folder `{name}` needs another name ({why}); --robot takes it as it is")
    });
    Ok(unusable.map_or(Ok(name), Err))
}

/// The robot's part of a gait's key; empty for the robot that needs no name.
pub fn module(key: &str) -> &str {
    key.split_once('/').map_or("", |(robot, _)| robot)
}

/// The same of a file's path in the specification.
fn module_of_file(file: &str) -> &str {
    let inside = file.strip_prefix(build().folder).unwrap_or(file).trim_start_matches('/');
    match inside.split_once('/') {
        Some((robot, _)) if robot != "gaits" => robot,
        _ => "",
    }
}

/// The files of a robot as they are now.
///
/// # Errors
/// What is missing or cannot be read.
pub fn files_of(module: &str) -> Result<RobotFiles, String> {
    let folder = Path::new(build().folder);
    // Joining nothing would end the path in a slash.
    let folder = if module.is_empty() { folder.to_path_buf() } else { folder.join(module) };
    Ok(RobotFiles { module: module.into(), ..input::robot(&folder)? })
}

/// A file of the specification that is not what it was when this program was built.
#[derive(Clone, Debug)]
pub struct Changed {
    pub path: String,
    /// The module of its robot.
    pub module: String,
    /// In words.
    pub how: &'static str,
}

/// All of these, where the folder of the specification is here: as they are when this is first asked.
pub fn changed() -> &'static [Changed] {
    static CHANGED: OnceLock<Vec<Changed>> = OnceLock::new();
    CHANGED.get_or_init(compare)
}

fn compare() -> Vec<Changed> {
    let now = files();
    now.iter().for_each(|file| whole::protect(Path::new(file)));
    if now.is_empty() {
        return Vec::new();
    }
    let changed = |path: &str, how| Changed { path: path.into(), module: module_of_file(path).into(), how };
    let of_build = build().files.iter().filter_map(|(file, built)| match std::fs::read(file) {
        Ok(text) if digest(&text) == *built => None,
        Ok(_) => Some(changed(file, "has changed")),
        Err(_) => Some(changed(file, "is gone")),
    });
    let known = |file: &String| build().files.iter().any(|(known, _)| known == file);
    let new = now.iter().filter(|file| !known(file)).map(|file| changed(file, "is new"));
    of_build.chain(new).collect()
}

/// What a build would read now, as it would be named there.
fn files() -> Vec<String> {
    let paths = RobotFiles::paths(Path::new(build().folder)).unwrap_or_default();
    paths.iter().map(|path| path.display().to_string().replace(MAIN_SEPARATOR, "/")).collect()
}

fn digest(text: &[u8]) -> String {
    Sha256::digest(text).iter().map(|b| format!("{b:02x}")).collect()
}
