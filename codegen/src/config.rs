//! The façade for cargo: the one place that reads the environment, writes files and prints.

use super::files::{RobotFiles, robots, sha256};
use super::generate::{check, generate, generate_families};
use crate::emit;
use crate::spec::diagnostic::visible;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// What a build script asks for: a folder with a robot and its gaits, and where the generated code will live.
///
/// The folder holds `robot.toml` and `gaits/*.toml`. Folders in it that hold the same are further robots; each is
/// known by its folder's name. Every file there is compiled: a new robot or gait needs no other change.
///
/// ```no_run
/// piaffe_codegen::Config::new("model-spec").compile();
/// ```
///
/// The code is included where the package wants it to be, `include!(concat!(env!("OUT_DIR"), "/gaits.rs"));`.
#[derive(Clone, Debug)]
pub struct Config {
    folder: PathBuf,
    left_out: Vec<String>,
    parameters: Vec<String>,
    runtime: Option<String>,
}

impl Config {
    /// The folder's path is relative to the package's root.
    pub fn new(folder: impl Into<PathBuf>) -> Config {
        let runtime = Some("::piaffe::model".into());
        Config { folder: folder.into(), left_out: Vec::new(), parameters: Vec::new(), runtime }
    }

    /// Leaves out the further robot in the folder of this name.
    pub fn without(mut self, robot: &str) -> Config {
        self.left_out.push(robot.into());
        self
    }

    /// Keeps numbers of the robots symbolic: those under a table of the specification, such as `links` or
    /// `links.thigh`, or single ones, such as `links.thigh.mass` and `gravity`. What is generated are then
    /// the families of all robots that differ in them, and `families.rs` instead of `gaits.rs`.
    ///
    /// Without parameters all numbers are folded into the code, which saves about a tenth of its operations.
    pub fn parameter(mut self, name: &str) -> Config {
        self.parameters.push(name.into());
        self
    }

    /// Path of the module that has the `Gait` trait, as seen from the generated code.
    pub fn runtime(mut self, path: &str) -> Config {
        self.runtime = Some(path.into());
        self
    }

    /// Functions over arrays and nothing else: the code then needs neither `std` nor the crate `piaffe`.
    pub fn functions_only(mut self) -> Config {
        self.runtime = None;
        self
    }

    /// Generates into `OUT_DIR`: `gaits.rs` or `families.rs`, to be included, and one file per gait.
    ///
    /// Mistakes in the specification are reported through cargo, so that they are the last thing a
    /// person sees; nothing is written then.
    pub fn compile(&self) {
        if let Err(message) = self.try_compile() {
            for line in message.lines() {
                println!("cargo::error={}", visible(line, false));
            }
        }
    }

    fn try_compile(&self) -> Result<(), String> {
        let root = PathBuf::from(
            env::var_os("CARGO_MANIFEST_DIR").ok_or("CARGO_MANIFEST_DIR is not set: run this from a build script")?,
        );
        let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: run this from a build script")?);
        println!("cargo::rerun-if-changed={}", self.folder.display());
        let started = std::time::Instant::now();
        let mut robots = robots(&root, &self.folder)?;
        for name in &self.left_out {
            let known = robots.iter().position(|robot| robot.module == *name && !name.is_empty());
            robots.remove(known.ok_or_else(|| format!("there is no robot `{name}` in {}", self.folder.display()))?);
        }
        let files = match (&self.parameters[..], self.runtime.as_deref()) {
            ([], runtime) => generate(&robots, runtime),
            (parameters, Some(runtime)) => generate_families(&robots, parameters, runtime),
            (_, None) => return Err("a family of robots is no use without its runtime: drop functions_only()".into()),
        };
        let mut files = files.map_err(|why| why + &how_to_set_aside(&self.folder, &robots))?;
        files.push((emit::SPECIFICATION_FILE.into(), specification(&self.folder, &robots)?));
        for (name, source) in files {
            write_if_changed(&out.join(&name), &source).map_err(|e| format!("cannot write {name}: {e}"))?;
        }
        let gaits: usize = robots.iter().map(|r| r.gaits.len()).sum();
        println!("piaffe-codegen: {gaits} gaits in {:.0} ms", started.elapsed().as_secs_f64() * 1e3);
        Ok(())
    }
}

/// What a program needs to see whether it was built from what is there now: the folder, and its files with their SHA-256.
fn specification(folder: &Path, robots: &[RobotFiles]) -> Result<String, String> {
    let slashes = |path: &str| path.replace(std::path::MAIN_SEPARATOR, "/");
    let files = robots.iter().flat_map(|r| std::iter::once(&r.robot).chain(&r.gaits));
    let files: Vec<_> = files.map(|file| (slashes(&file.path), sha256(&[file]))).collect();
    emit::specification_source(&slashes(&folder.display().to_string()), &files).map_err(|e| e.to_string())
}

/// Of the further robots, those that keep all others from being built, and how to do without them.
fn how_to_set_aside(folder: &Path, robots: &[RobotFiles]) -> String {
    let mut advice = String::new();
    for robot in robots.iter().filter(|robot| !robot.module.is_empty() && robots.len() > 1) {
        if check(std::slice::from_ref(robot)).is_err() {
            let path = folder.join(&robot.module).display().to_string();
            advice += &format!(
                "\n\nno robot is built as long as {path} has mistakes; to set it aside: mv {path}/robot.toml {path}/robot.toml.aside"
            );
        }
    }
    advice
}

/// Cargo goes by modification times: an unchanged file must not be touched.
fn write_if_changed(path: &Path, contents: &str) -> io::Result<()> {
    if fs::read(path).is_ok_and(|old| old == contents.as_bytes()) {
        return Ok(());
    }
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    fs::write(path, contents)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::SpecFile;

    #[test]
    fn a_robot_that_is_in_the_way_is_named_with_how_to_do_without_it() {
        let file = |text: &str| SpecFile { path: "robot.toml".into(), text: text.into() };
        let robot = |module: &str| RobotFiles { module: module.into(), robot: file("name = 1"), gaits: Vec::new() };
        let folder = Path::new("model-spec");
        let advice = how_to_set_aside(folder, &[robot(""), robot("dog")]);
        assert!(advice.contains("mv model-spec/dog/robot.toml model-spec/dog/robot.toml.aside"), "{advice}");
        assert_eq!(how_to_set_aside(folder, &[robot("dog")]), "");
    }
}
