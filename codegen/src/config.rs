//! The cargo façade: the one place that reads the environment, writes files and prints.

use crate::emit;
use crate::mechanism::{Family, Mechanism, Whole, levers, select};
use crate::spec::diagnostic::visible;
use crate::spec::modules::{self, Named};
use crate::spec::{self, Diagnostic, Gait, Robot, Source};
use crate::turns::in_turn;
use crate::typeset::latex;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Names of no number that are told one by one.
const UNKNOWN_SHOWN: usize = 10;

/// No specification file is larger, in bytes; without an end, a device would fill the memory.
const LARGEST: u64 = 1 << 24;

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

/// A generated file: name and contents.
pub type Generated = (String, String);

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

/// Of files one after the other.
fn sha256(files: &[&SpecFile]) -> String {
    let mut hash = Sha256::new();
    files.iter().for_each(|file| hash.update(file.text.as_bytes()));
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
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

/// The robots of a folder: its own first, then those of the folders in it, by name.
fn robots(root: &Path, folder: &Path) -> Result<Vec<RobotFiles>, String> {
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

/// What [`generate`] says of specifications before it derives anything: in milliseconds.
///
/// # Errors
/// The rendered diagnostics, if the specification has mistakes.
pub fn check(robots: &[RobotFiles]) -> Result<(), String> {
    parse(robots).map(|_| ())
}

/// A robot with its gaits, as its files describe it.
#[derive(Clone, Debug)]
pub struct Specified {
    pub robot: Robot,
    /// In the order of their files.
    pub gaits: Vec<Gait>,
}

/// The robots that these files describe.
///
/// # Errors
/// The rendered diagnostics, if the specification has mistakes.
pub fn specified(robots: &[RobotFiles]) -> Result<Vec<Specified>, String> {
    let specified = |robot: Parsed| {
        let gaits = robot.gaits.into_iter().map(|(gait, _)| gait).collect();
        Specified { robot: robot.spec, gaits }
    };
    Ok(parse(robots)?.into_iter().map(specified).collect())
}

/// The whole of code generation as a pure function: specification texts → source files.
///
/// `runtime` is the path of the module that has the `Gait` trait; without it there are functions only.
///
/// # Errors
/// The rendered diagnostics, if the specification has mistakes.
pub fn generate(robots: &[RobotFiles], runtime: Option<&str>) -> Result<Vec<Generated>, String> {
    let parsed = parse(robots)?;
    let moved = parsed.iter().map(Parsed::moved).collect::<Result<Vec<_>, _>>()?;
    let gait_files = |robot: &Parsed, number: usize, alike: &[Moved]| {
        let files: Vec<&SpecFile> = std::iter::once(&robot.files.robot).chain(alike.iter().map(|m| m.file)).collect();
        let together =
            alike.iter().skip(1).fold(alike[0].mechanism.clone(), |m, other| m.with_those_of(&other.mechanism));
        let embedding = emit::Embedding::new(&together);
        let beside = |m: &Moved| (levers(&robot.spec, m.gait), latex(&robot.spec, m.gait, &m.mechanism));
        let (functions, beside) =
            rayon::join(|| embedding.functions(), || alike.iter().map(beside).collect::<Vec<_>>());
        let cannot_write = |e: emit::Unwritable| robot.cannot_write(&alike[0].gait.name, &e);
        let (functions, name) = (functions.map_err(cannot_write)?, emit::embedding_module(number));
        let source = emit::embedding_source(&functions, runtime, &origin(&files)).map_err(cannot_write)?;
        let mut generated = vec![(emit::file_name(&robot.files.module, &name), source)];
        for (m, (levers, latex)) in alike.iter().zip(&beside) {
            let files = [&robot.files.robot, m.file];
            let specification = files.map(|file| file.text.as_str());
            let beside = emit::Beside { levers, latex, specification };
            let whole = robot.wholes().iter().position(|angles| **angles == m.gait.locked).unwrap_or_default();
            let whole = emit::whole_module(whole);
            let modules = emit::Modules { robot: &robot.files.module, embedding: &name, whole: &whole };
            let source =
                emit::gait_source(&m.mechanism, &embedding, &functions, &beside, &modules, runtime, &origin(&files));
            let source = source.map_err(|e| robot.cannot_write(&m.gait.name, &e))?;
            generated.push((emit::file_name(&robot.files.module, &m.gait.name), source));
        }
        Ok(generated)
    };
    let whole_file = |robot: &Parsed, number: usize, angles: &Angles| {
        let whole = Whole::new(&locked(&robot.spec, angles)?);
        let source = emit::whole_source(&whole, runtime, &origin(&[&robot.files.robot]));
        let source = source.map_err(|e| robot.cannot_write("whole robot", &e))?;
        Ok(vec![(emit::file_name(&robot.files.module, &emit::whole_module(number)), source)])
    };
    // Whole robots first: they have the kernel that takes longest.
    let mut jobs: Vec<Job> = Vec::new();
    for robot in &parsed {
        for (number, angles) in robot.wholes().into_iter().enumerate() {
            jobs.push(Box::new(move || whole_file(robot, number, angles)));
        }
    }
    for (robot, embeddings) in parsed.iter().zip(&moved) {
        for (number, alike) in embeddings.iter().enumerate() {
            jobs.push(Box::new(move || gait_files(robot, number, alike)));
        }
    }
    let mut files = together(jobs)?;
    let counts = parsed
        .iter()
        .zip(&moved)
        .map(|(robot, embeddings)| emit::Together { embeddings: embeddings.len(), wholes: robot.wholes().len() });
    let counts: Vec<_> = counts.collect();
    let registry = emit::registry_source(&all_modules(&parsed), &counts, runtime, &origin_of_all(robots));
    files.push(("gaits.rs".into(), registry.map_err(|e| e.to_string())?));
    files.push(math());
    Ok(files)
}

/// The same for the families of robots that differ in `parameters` (see [`Config::parameter`]).
///
/// # Errors
/// The rendered diagnostics, if the specification has mistakes; what is wrong with the parameters else.
pub fn generate_families(
    robots: &[RobotFiles],
    parameters: &[String],
    runtime: &str,
) -> Result<Vec<Generated>, String> {
    let parsed = parse(robots)?;
    let select =
        |robot: &Parsed| select(&robot.spec, parameters).map_err(|e| format!("{}: {e}", robot.files.robot.path));
    let chosen = parsed.iter().map(select).collect::<Result<Vec<_>, _>>()?;
    let file = |robot: &Parsed, gait: &Gait, file: &SpecFile| {
        let origin = origin(&[&robot.files.robot, file]);
        let family = Family::new(&robot.spec, gait, select(robot)?)?;
        let latex = latex(&robot.spec, gait, &family.mechanism);
        let source = emit::family_source(&family, &robot.files.module, &latex, runtime, &origin);
        let source = source.map_err(|e| robot.cannot_write(&gait.name, &e))?;
        Ok((emit::family_file_name(&robot.files.module, &gait.name), source))
    };
    let mut files = together(for_each_gait(&parsed, &file))?;
    let registry = emit::families_source(&all_modules(&parsed), &chosen, runtime, &origin_of_all(robots));
    files.push(("families.rs".into(), registry.map_err(|e| e.to_string())?));
    files.push(math());
    Ok(files)
}

/// The file with the elementary functions.
fn math() -> Generated {
    (emit::MATH_FILE.into(), emit::MATH.into())
}

/// A robot with its gaits and their files.
struct Parsed<'f> {
    files: &'f RobotFiles,
    source: Source,
    spec: Robot,
    gaits: Vec<(Gait, &'f SpecFile)>,
}

impl Parsed<'_> {
    fn named(&self) -> Named<'_> {
        let gaits = self.gaits.iter().map(|(gait, file)| (gait.name.as_str(), Source::new(&file.path, &file.text)));
        let gaits = gaits.collect();
        Named { folder: &self.files.module, file: &self.source, gaits }
    }

    /// What a number or a name of the robot did to the generated code.
    fn cannot_write(&self, what: &str, why: &emit::Unwritable) -> String {
        format!("{}: the {what} cannot be derived with these numbers: {why}", visible(&self.files.robot.path, false))
    }

    /// The different ways in which the gaits lock joints: for each there is a whole robot.
    fn wholes(&self) -> Vec<&Angles> {
        let mut different: Vec<&Angles> = Vec::new();
        for (gait, _) in &self.gaits {
            if !different.contains(&&gait.locked) {
                different.push(&gait.locked);
            }
        }
        different
    }

    /// Its gaits, those together that move it alike.
    fn moved(&self) -> Result<Vec<Vec<Moved<'_>>>, String> {
        let mut embeddings: Vec<Vec<Moved>> = Vec::new();
        for (gait, file) in &self.gaits {
            let mechanism = Mechanism::new(&locked(&self.spec, &gait.locked)?, gait);
            let moved = Moved { gait, file, mechanism };
            match embeddings.iter_mut().find(|alike| alike[0].mechanism.moves_like(&moved.mechanism)) {
                Some(alike) => alike.push(moved),
                None => embeddings.push(vec![moved]),
            }
        }
        Ok(embeddings)
    }
}

/// A gait with the mechanism that it makes of its robot.
struct Moved<'p> {
    gait: &'p Gait,
    file: &'p SpecFile,
    mechanism: Mechanism,
}

/// Joints by name, with the angles at which they are held, rad.
type Angles = Vec<(String, f64)>;

fn locked(robot: &Robot, angles: &Angles) -> Result<Robot, String> {
    robot.locked(angles).map_err(|t| format!("`{}` is tilted", t.joint))
}

fn parse(robots: &[RobotFiles]) -> Result<Vec<Parsed<'_>>, String> {
    let mut mistakes = Vec::new();
    let mut parsed = Vec::new();
    for files in robots {
        let robot = match spec::parse_robot(&files.robot.path, &files.robot.text) {
            Ok(robot) => robot,
            Err(e) => {
                mistakes.extend(e);
                mistakes.extend(files.gaits.iter().flat_map(|file| spec::gait_mistakes(&file.path, &file.text)));
                continue;
            }
        };
        let mut gaits = Vec::new();
        for file in &files.gaits {
            match spec::parse_gait(&file.path, &file.text, &robot) {
                Ok(gait) => gaits.push((gait, file)),
                Err(e) => mistakes.extend(e),
            }
        }
        parsed.push(Parsed { files, source: robot.source().clone(), spec: robot.robot, gaits });
    }
    mistakes.extend(modules::mistakes(&parsed.iter().map(Parsed::named).collect::<Vec<_>>()));
    if !mistakes.is_empty() {
        return Err(render(&mistakes));
    }
    Ok(parsed)
}

/// What makes files and knows of no others.
type Job<'j> = Box<dyn FnOnce() -> Result<Vec<Generated>, String> + Send + 'j>;

fn for_each_gait<'j>(
    robots: &'j [Parsed],
    file: &'j (impl Fn(&Parsed, &Gait, &SpecFile) -> Result<Generated, String> + Sync),
) -> Vec<Job<'j>> {
    let gaits = robots.iter().flat_map(|robot| robot.gaits.iter().map(move |(gait, own)| (robot, gait, own)));
    gaits.map(|(robot, gait, own)| Box::new(move || Ok(vec![file(robot, gait, own)?])) as Job).collect()
}

/// The files, in order; the first mistake if there is any.
fn together(jobs: Vec<Job>) -> Result<Vec<Generated>, String> {
    let files: Vec<_> = in_turn(jobs, |_| (), || (), |_, job| job()).into_iter().collect::<Result<_, _>>()?;
    Ok(files.into_iter().flatten().collect())
}

/// Names of the robots' modules and of their gaits.
fn all_modules<'p>(robots: &'p [Parsed]) -> Vec<(&'p str, Vec<String>)> {
    let names = |robot: &Parsed| robot.gaits.iter().map(|(gait, _)| gait.name.clone()).collect();
    robots.iter().map(|robot| (robot.files.module.as_str(), names(robot))).collect()
}

fn origin_of_all(robots: &[RobotFiles]) -> String {
    origin(&robots.iter().flat_map(|r| std::iter::once(&r.robot).chain(&r.gaits)).collect::<Vec<_>>())
}

/// The first mistakes in words, and how many more were found.
fn render(diagnostics: &[Diagnostic]) -> String {
    const SHOWN: usize = 40;
    let mut texts: Vec<String> = diagnostics.iter().take(SHOWN).map(Diagnostic::render).collect();
    if diagnostics.len() > SHOWN {
        texts.push(format!("and {} more mistakes: correct these first", diagnostics.len() - SHOWN));
    }
    texts.join("\n\n")
}

/// Header of a generated file, one line. File names only: the same bytes on every machine.
fn origin(files: &[&SpecFile]) -> String {
    let mut names = Vec::new();
    for file in files {
        let name = Path::new(&file.path).file_name().unwrap_or_default().to_string_lossy();
        names.push(visible(&name, false));
    }
    let digest = sha256(files);
    format!("@generated by piaffe-codegen {} from {} (sha256 {digest})", env!("CARGO_PKG_VERSION"), names.join(", "))
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
