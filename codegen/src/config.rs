//! The cargo façade: the one place that reads the environment, writes files and prints.

use crate::emit;
use crate::mechanism::Mechanism;
use crate::spec::{self, Diagnostic};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// What a build script asks for: a robot, its gaits, and where the generated code will live.
///
/// ```no_run
/// piaffe_codegen::Config::new("model-spec/robot.toml").gait("model-spec/gaits/trot.toml").compile();
/// ```
#[derive(Clone, Debug)]
pub struct Config {
    robot: PathBuf,
    gaits: Vec<PathBuf>,
    runtime: String,
}

/// A specification file: its path as shown in messages and its text.
#[derive(Clone, Debug)]
pub struct SpecFile {
    pub path: String,
    pub text: String,
}

/// A generated file: name and contents.
pub type Generated = (String, String);

impl Config {
    /// Paths are relative to the package's root.
    pub fn new(robot: impl Into<PathBuf>) -> Config {
        Config { robot: robot.into(), gaits: Vec::new(), runtime: "::piaffe::model".into() }
    }

    pub fn gait(mut self, path: impl Into<PathBuf>) -> Config {
        self.gaits.push(path.into());
        self
    }

    /// Path of the module that has the `Gait` trait, as seen from the generated code.
    pub fn runtime(mut self, path: &str) -> Config {
        self.runtime = path.into();
        self
    }

    /// Generates into `OUT_DIR`: `gaits.rs`, to be included, and one file per gait.
    ///
    /// Mistakes in the specification are reported through cargo, so that they are the last thing a
    /// person sees; nothing is written then.
    pub fn compile(&self) {
        if let Err(message) = self.try_compile() {
            for line in message.lines() {
                println!("cargo::error={line}");
            }
        }
    }

    fn try_compile(&self) -> Result<(), String> {
        let root = PathBuf::from(
            env::var_os("CARGO_MANIFEST_DIR").ok_or("CARGO_MANIFEST_DIR is not set: run this from a build script")?,
        );
        let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: run this from a build script")?);
        for path in self.gaits.iter().chain([&self.robot]) {
            println!("cargo::rerun-if-changed={}", path.display());
        }
        let started = std::time::Instant::now();
        let robot = read(&root, &self.robot)?;
        let gaits = self.gaits.iter().map(|p| read(&root, p)).collect::<Result<Vec<_>, _>>()?;
        for (name, source) in generate(&robot, &gaits, &self.runtime)? {
            write_if_changed(&out.join(&name), &source).map_err(|e| format!("cannot write {name}: {e}"))?;
        }
        println!("piaffe-codegen: {} gaits in {:.0} ms", gaits.len(), started.elapsed().as_secs_f64() * 1e3);
        Ok(())
    }
}

/// The whole of code generation as a pure function: specification texts → source files.
///
/// # Errors
/// The rendered diagnostics, if the specification has mistakes.
pub fn generate(robot: &SpecFile, gaits: &[SpecFile], runtime: &str) -> Result<Vec<Generated>, String> {
    let robot_file = spec::parse_robot(&robot.path, &robot.text).map_err(|e| render(&e))?;
    let mut mistakes = Vec::new();
    let mut parsed = Vec::new();
    for file in gaits {
        match spec::parse_gait(&file.path, &file.text, &robot_file) {
            Ok(gait) => parsed.push((file, gait)),
            Err(e) => mistakes.extend(e),
        }
    }
    if !mistakes.is_empty() {
        return Err(render(&mistakes));
    }
    // Gaits do not know of each other: one thread each, joined in order.
    let robot_spec = &robot_file.robot;
    let sources: Vec<Result<String, String>> = std::thread::scope(|scope| {
        let running: Vec<_> = parsed
            .iter()
            .map(|(file, gait)| {
                scope.spawn(move || {
                    let robot_spec = robot_spec.locked(&gait.locked).map_err(|t| format!("`{}` is tilted", t.joint))?;
                    emit::gait_source(&Mechanism::new(&robot_spec, gait), runtime, &origin(&[robot, file]))
                })
            })
            .collect();
        let stopped = |_| Err("the generator stopped: a defect of piaffe-codegen".to_string());
        running.into_iter().map(|thread| thread.join().unwrap_or_else(stopped)).collect()
    });
    let mut files = Vec::new();
    for ((_, gait), source) in parsed.iter().zip(sources) {
        files.push((format!("{}.rs", emit::module_name(&gait.name)), source?));
    }
    let names: Vec<String> = parsed.into_iter().map(|(_, gait)| gait.name).collect();
    let all: Vec<&SpecFile> = std::iter::once(robot).chain(gaits).collect();
    files.push(("gaits.rs".into(), emit::registry_source(&names, runtime, &origin(&all))));
    Ok(files)
}

fn render(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(Diagnostic::render).collect::<Vec<_>>().join("\n\n")
}

/// Header of a generated file. File names only: the same bytes on every machine.
fn origin(files: &[&SpecFile]) -> String {
    let mut hash = Sha256::new();
    let mut names = Vec::new();
    for file in files {
        hash.update(file.text.as_bytes());
        names.push(Path::new(&file.path).file_name().unwrap_or_default().to_string_lossy().into_owned());
    }
    let digest: String = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
    format!("@generated by piaffe-codegen {} from {} (sha256 {digest})", env!("CARGO_PKG_VERSION"), names.join(", "))
}

fn read(root: &Path, path: &Path) -> Result<SpecFile, String> {
    let text = fs::read_to_string(root.join(path))
        .map_err(|e| format!("cannot read the specification {}: {e}", path.display()))?;
    Ok(SpecFile { path: path.display().to_string(), text })
}

/// Cargo goes by modification times: an unchanged file must not be touched.
fn write_if_changed(path: &Path, contents: &str) -> io::Result<()> {
    if fs::read(path).is_ok_and(|old| old == contents.as_bytes()) {
        return Ok(());
    }
    fs::write(path, contents)
}
