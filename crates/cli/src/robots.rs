//! The robots that a run answers for: those of the build, those of `model-spec/` where its files have changed since, or the one of
//! a folder that was asked for; with numbers set for this run alone. What has no compiled code is derived when it is asked for.
//!
//! A result carries what its gait was derived from, and is read with that, whichever robots are here.

use super::built::{self, Changed};
use super::{input, output};
use anyhow::{Context, anyhow};
use piaffe_codegen::{Changes, RobotFiles, SpecFile};
use piaffe_interpreter::Robot;
use piaffe_model::{Gait, Specification};
use piaffe_optimizer::origin::{Foreign, is_of};
use piaffe_optimizer::result::GaitResult;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Until the program ends, like those that it was built with.
type Loaded = &'static dyn Gait;

/// A gait that can be asked for.
struct Choice {
    key: &'static str,
    origin: Origin,
    derived: OnceLock<Result<Loaded, String>>,
}

#[derive(Clone)]
enum Origin {
    Built(Loaded),
    /// A robot read from its files, or what is wrong with them.
    Files(Arc<Result<Robot, String>>),
}

/// Instead of the names of gaits: all of them.
pub use piaffe_codegen::spec::name::ALL;

/// Of this run; chosen once, when it starts.
static CHOICES: OnceLock<Vec<Choice>> = OnceLock::new();

fn choices() -> &'static [Choice] {
    CHOICES.get().map_or(&[], Vec::as_slice)
}

/// The robot of this folder if one is given, else those of the build or of `model-spec/`; with these changes.
///
/// # Errors
/// If the folder has no robot, or its files have mistakes.
pub fn choose(folder: Option<&Path>, changes: &Changes) -> anyhow::Result<()> {
    let chosen = match folder {
        Some(folder) => of_folder(folder, changes)?,
        None => here(changes),
    };
    CHOICES.get_or_init(|| chosen);
    Ok(())
}

/// The robots of the build, wherever the program runs.
pub fn choose_built() {
    let choice = |gait: &Loaded| Choice::new(gait.description().key, Origin::Built(*gait));
    CHOICES.get_or_init(|| built::gaits().iter().map(choice).collect());
}

fn of_folder(folder: &Path, changes: &Changes) -> anyhow::Result<Vec<Choice>> {
    let files = input::robot(folder).map_err(|why| anyhow!("{why}"))?;
    let robot = read(Ok(RobotFiles { module: String::new(), ..files }), changes).map_err(|why| anyhow!("{why}"))?;
    let origin = Origin::Files(Arc::new(Ok(robot.clone())));
    Ok(robot.gaits().into_iter().map(|key| Choice::new(key.leak(), origin.clone())).collect())
}

fn here(changes: &Changes) -> Vec<Choice> {
    let changed = built::changed();
    let of_build = built::gaits().iter().map(|gait| built::module(gait.description().key).to_string());
    let mut modules: Vec<String> = of_build.chain(changed.iter().map(|file| file.module.clone())).collect();
    let mut known = BTreeSet::new();
    modules.retain(|module| known.insert(module.clone()));
    let choices = modules.into_iter().flat_map(|module| {
        let built: Vec<Loaded> =
            built::gaits().iter().copied().filter(|g| built::module(g.description().key) == module).collect();
        let files = match changed.iter().any(|file| file.module == module) {
            true => built::files_of(&module),
            false if changes.is_empty() => {
                return built.iter().map(|g| Choice::new(g.description().key, Origin::Built(*g))).collect();
            }
            false => Ok(of_build_files(&module, &built)),
        };
        let robot = read(files, changes);
        let keys: Vec<&str> = match &robot {
            Ok(robot) => robot.gaits().into_iter().map(|key| &*key.leak()).collect(),
            // Who asks for one of these is told what is wrong.
            Err(_) => built.iter().map(|g| g.description().key).collect(),
        };
        let origin = Origin::Files(Arc::new(robot));
        keys.into_iter().map(|key| Choice::new(key, origin.clone())).collect::<Vec<_>>()
    });
    choices.collect()
}

/// The files from which the gaits of a robot were built.
fn of_build_files(module: &str, gaits: &[Loaded]) -> RobotFiles {
    let file = |path: String, text: &str| SpecFile { path, text: text.into() };
    let specifications = || gaits.iter().filter_map(|g| Some((g.description().gait, g.specification()?)));
    let robot = specifications().next().map_or("", |(_, specification)| &specification.robot);
    RobotFiles {
        module: module.into(),
        robot: file("robot.toml".into(), robot),
        gaits: specifications().map(|(name, of)| file(format!("{name}.toml"), &of.gait)).collect(),
    }
}

fn read(files: Result<RobotFiles, String>, changes: &Changes) -> Result<Robot, String> {
    // What is wrong with the files themselves is said before what is set.
    let robot = files.and_then(|files| Robot::new(files).map_err(|why| why.to_string()))?;
    robot.changed(changes).map_err(|why| why.to_string())
}

impl Choice {
    fn new(key: &'static str, origin: Origin) -> Choice {
        Choice { key, origin, derived: OnceLock::new() }
    }

    /// What the gait is derived from.
    fn specification(&self) -> Option<Specification> {
        match &self.origin {
            Origin::Built(gait) => gait.specification().cloned(),
            Origin::Files(robot) => robot.as_ref().as_ref().ok()?.specification(self.key),
        }
    }

    fn gait(&self) -> anyhow::Result<Loaded> {
        let robot = match &self.origin {
            Origin::Built(gait) => return Ok(*gait),
            Origin::Files(robot) => robot,
        };
        let derived = self.derived.get_or_init(|| match &**robot {
            Ok(robot) => robot.gait(self.key).map(kept).map_err(|why| why.to_string()),
            Err(why) => Err(why.clone()),
        });
        derived.clone().map_err(|why| anyhow!("{why}"))
    }
}

fn kept(gait: impl Gait + 'static) -> Loaded {
    Box::leak(Box::new(gait))
}

/// Names of all gaits, once the robots have been chosen.
pub fn keys() -> Option<Vec<&'static str>> {
    CHOICES.get().map(|choices| choices.iter().map(|choice| choice.key).collect())
}

/// The gait of this name.
///
/// # Errors
/// If there is none, or it cannot be derived.
pub fn by_name(name: &str) -> anyhow::Result<Loaded> {
    let choice = choices().iter().find(|choice| choice.key == name);
    choice.with_context(|| format!("there is no gait `{name}`"))?.gait()
}

/// The gaits of the robot that needs no name.
///
/// # Errors
/// If they cannot be derived.
pub fn first() -> anyhow::Result<Vec<Loaded>> {
    choices().iter().filter(|choice| !choice.key.contains('/')).map(Choice::gait).collect()
}

/// The gaits that are wanted, in the order in which they are named.
///
/// # Errors
/// If they cannot be derived.
pub fn wanted(wanted: &Wanted) -> anyhow::Result<Vec<Loaded>> {
    match wanted {
        Wanted::Usual => {
            let (walks, flights): (Vec<Loaded>, Vec<Loaded>) =
                first()?.into_iter().partition(|gait| !gait.description().flies());
            if walks.is_empty() {
                return Ok(flights);
            }
            note_left_out(flights.into_iter().map(|gait| gait.description().key.to_string()));
            Ok(walks)
        }
        Wanted::All => first(),
        Wanted::Named(names) => names.iter().map(|name| by_name(name)).collect(),
    }
}

/// Says which gaits were not meant, and how they are.
fn note_left_out(gaits: impl Iterator<Item = String>) {
    let names: Vec<String> = gaits.collect();
    if !names.is_empty() {
        output::note(&format!("left out, since they leave the ground: {}; name them, or `{ALL}`", names.join(", ")));
    }
}

/// The gaits of the robot of a module.
fn of_module(module: &str) -> impl Iterator<Item = &'static Choice> {
    choices().iter().filter(move |choice| built::module(choice.key) == module)
}

/// The gaits of the robot of this one, as far as they can be derived.
pub fn of_same_robot(key: &str) -> impl Iterator<Item = Loaded> {
    of_module(built::module(key)).filter_map(|choice| choice.gait().ok())
}

/// Which gaits are meant.
pub enum Wanted {
    /// Those that are meant where none is named ([`Robot::usual_gaits`]).
    Usual,
    All,
    Named(Vec<String>),
}

impl Wanted {
    /// By the names that were typed, each once.
    pub fn by(names: &[String]) -> Wanted {
        if names.is_empty() {
            return Wanted::Usual;
        }
        if names.iter().any(|name| name == ALL) {
            return Wanted::All;
        }
        let mut different: Vec<String> = Vec::new();
        for name in names {
            if !different.contains(name) {
                different.push(name.clone());
            }
        }
        Wanted::Named(different)
    }
}

/// The robot whose gaits are wanted, as its files describe it, and their names; of the robot that needs no name where none is named.
///
/// # Errors
/// If they are of several robots, or there are mistakes in its files.
pub fn robot_of(wanted: &Wanted) -> anyhow::Result<(Robot, Vec<String>)> {
    let names = if let Wanted::Named(names) = wanted { names.as_slice() } else { &[] };
    let modules: BTreeSet<&str> = names.iter().map(|name| built::module(name)).collect();
    let module = match Vec::from_iter(modules)[..] {
        [] => "",
        [module] => module,
        _ => return Err(anyhow!("a study is about one robot: {} are gaits of several", names.join(", "))),
    };
    let robot = match of_module(module).map(|choice| &choice.origin).next() {
        Some(Origin::Files(robot)) => (**robot).clone().map_err(|why| anyhow!("{why}"))?,
        _ => {
            let gaits: Vec<Loaded> = of_module(module)
                .filter_map(|choice| if let Origin::Built(gait) = choice.origin { Some(gait) } else { None })
                .collect();
            Robot::new(of_build_files(module, &gaits))?
        }
    };
    let names = match wanted {
        Wanted::Usual => {
            let usual = robot.usual_gaits();
            note_left_out(robot.gaits().into_iter().filter(|gait| !usual.contains(gait)));
            usual
        }
        Wanted::All => robot.gaits(),
        Wanted::Named(names) => names.clone(),
    };
    Ok((robot, names))
}

/// Says which files have changed since the build, so that they are used as they stand: of the robots of these gaits.
pub fn note_of<'k>(keys: impl IntoIterator<Item = &'k str>) {
    /// Files that are named.
    const SHOWN: usize = 3;
    let derived = |key: &str| {
        let choice = choices().iter().find(|choice| choice.key == key);
        choice.is_none_or(|choice| matches!(choice.origin, Origin::Files(_)))
    };
    let modules: BTreeSet<&str> = keys.into_iter().filter(|key| derived(key)).map(built::module).collect();
    let changed: Vec<&Changed> = built::changed().iter().filter(|file| modules.contains(&*file.module)).collect();
    if changed.is_empty() {
        return;
    }
    let mut which: Vec<String> = changed.iter().take(SHOWN).map(|file| format!("{} {}", file.path, file.how)).collect();
    if changed.len() > SHOWN {
        which.push(format!("and {} more", changed.len() - SHOWN));
    }
    output::note(&format!("{} since this program was built: it takes the files as they are now", which.join(", ")));
}

/// What was derived from the specification that a result carries, under its gait's name there.
struct Carried {
    key: String,
    specification: Specification,
    derived: Result<Loaded, String>,
}

/// Many results carry the same one.
static CARRIED: Mutex<Vec<Carried>> = Mutex::new(Vec::new());

/// Whether a result carries files that are those of no gait here.
pub fn is_of_others(result: &GaitResult) -> bool {
    result.specification.is_some() && of_same_files(result).is_none()
}

fn of_same_files(result: &GaitResult) -> Option<&'static Choice> {
    let here = choices().iter().find(|choice| choice.key == result.gait);
    here.filter(|choice| result.specification.is_some() && choice.specification() == result.specification)
}

/// The gait that a result is of: one that is here, or the one that the result carries with it. Not to be asked for from several threads
/// at once, which share the derivation.
///
/// # Errors
/// Why there is none.
pub fn of(result: &GaitResult) -> Result<Loaded, String> {
    let told = |choice: &Choice| choice.gait().map_err(|why| format!("{why:#}"));
    let Some(carried) = &result.specification else {
        let known = || choices().iter().map(|choice| choice.key).collect::<Vec<_>>().join(", ");
        let unknown = || Foreign::UnknownGait { gait: result.gait.clone(), known: known() }.to_string();
        return told(choices().iter().find(|choice| choice.key == result.gait).ok_or_else(unknown)?);
    };
    // What a result carries is read, also where its fingerprint is that of a gait here.
    let gait = of_same_files(result).map_or_else(|| of_carried(carried, &result.gait), told)?;
    let what = "the files that the result carries are those of another robot or gait (its fingerprint differs)";
    is_of(result, gait.description()).then_some(gait).ok_or_else(|| what.into())
}

fn of_carried(specification: &Specification, key: &str) -> Result<Loaded, String> {
    // Whoever panicked left whole entries behind.
    let mut all = CARRIED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = all.iter().find(|known| known.key == key && known.specification == *specification) {
        return known.derived.clone();
    }
    let derived = Robot::carried(specification, key).map(kept);
    let derived = derived.map_err(|why| format!("the files that the result carries are of no use: {why}"));
    all.push(Carried { key: key.into(), specification: specification.clone(), derived: derived.clone() });
    derived
}
