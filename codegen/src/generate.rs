//! The whole of code generation as a pure function: texts of a specification → texts of source files.

use super::files::{RobotFiles, SpecFile, sha256};
use crate::emit;
use crate::mechanism::{Family, Mechanism, Whole, levers, select};
use crate::spec::diagnostic::visible;
use crate::spec::modules::{self, Named};
use crate::spec::{self, Diagnostic, Gait, Robot, Source};
use crate::turns::in_turn;
use crate::typeset::latex;
use std::path::Path;

/// A generated file: name and contents.
pub type Generated = (String, String);

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

/// The same for the families of robots that differ in `parameters` (see [`Config::parameter`](crate::Config::parameter)).
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
