//! A robot by its files: `robot.toml` and `gaits/*.toml`.

use super::description::underived;
use super::gait::{Interpreted, Kernels, mechanism};
use super::tape::Unrunnable;
use piaffe_codegen::spec;
use piaffe_codegen::{Changes, RobotFiles, SpecFile, Specified, specified};
use piaffe_model::{Contradiction, Description, Specification};
use std::path::Path;

/// A robot as its files describe it; nothing has been derived yet.
#[derive(Clone, Debug)]
pub struct Robot {
    files: RobotFiles,
    specified: Specified,
    /// Gaits that a change has made impossible, and why.
    lost: Vec<(String, String)>,
}

/// Why there is no such robot, or no such gait of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unloadable {
    /// As a build says it: every mistake with its place and what to write instead.
    #[error("{0}")]
    Specification(String),
    #[error("the robot has no gait `{gait}`; it has {known}")]
    NoGait { gait: String, known: String },
    #[error("the {gait} cannot be derived with these numbers: {why}")]
    Gait { gait: String, why: Unrunnable },
}

/// What is said before the mistakes of a changed specification.
const NONE: &str = "with what is asked for, the robot is none";

impl Robot {
    /// The robot of a folder.
    ///
    /// # Errors
    /// What is missing, cannot be read, or is wrong with the specification.
    pub fn read(folder: impl AsRef<Path>) -> Result<Robot, Unloadable> {
        let files = RobotFiles::read(folder.as_ref()).map_err(Unloadable::Specification)?;
        Robot::new(RobotFiles { module: String::new(), ..files })
    }

    /// The robot of these files.
    ///
    /// # Errors
    /// What is wrong with the specification.
    pub fn new(files: RobotFiles) -> Result<Robot, Unloadable> {
        let mut robots = specified(std::slice::from_ref(&files)).map_err(Unloadable::Specification)?;
        let specified = robots.pop().ok_or_else(|| Unloadable::Specification("there is no robot".into()))?;
        Ok(Robot { files, specified, lost: Vec::new() })
    }

    /// The robot with another number where this one stands in its files: `links.thigh.mass`, `limits.friction`.
    ///
    /// # Errors
    /// If there is no such number, or it cannot be this one.
    pub fn with(&self, name: &str, value: f64) -> Result<Robot, Unloadable> {
        self.with_all([(name, value)])
    }

    /// The same with several numbers, of which only all together need make a robot.
    ///
    /// # Errors
    /// All names and numbers that are none; or what is wrong with the robot that these make.
    pub fn with_all<'n>(&self, numbers: impl IntoIterator<Item = (&'n str, f64)>) -> Result<Robot, Unloadable> {
        let mut files = self.files.clone();
        let wrong = files.set_all(numbers).err().into_iter().flatten();
        Robot::of_changed(files, wrong)
    }

    /// The robot with what is asked for beside its files: limits, stronger motors, a load.
    ///
    /// # Errors
    /// What is not there to be changed; or what is wrong with the robot that comes of it.
    pub fn changed(&self, changes: &Changes) -> Result<Robot, Unloadable> {
        let mut files = self.files.clone();
        let wrong = changes.apply(&mut files).err();
        Robot::of_changed(files, wrong)
    }

    /// The robot of files that were changed, unless that went wrong. A gait that is none any more stands in nobody's way who asks for another.
    fn of_changed(files: RobotFiles, wrong: impl IntoIterator<Item = String>) -> Result<Robot, Unloadable> {
        let robot = Robot::new(files.clone()).or_else(|why| Robot::without_lost(&files).ok_or(why));
        let none = robot.as_ref().err().map(|why| format!("{NONE}:\n{why}"));
        let wrong: Vec<String> = wrong.into_iter().chain(none).collect();
        if wrong.is_empty() { robot } else { Err(Unloadable::Specification(wrong.join("\n"))) }
    }

    /// The robot with those of the gaits that are some; `None` if none is.
    fn without_lost(files: &RobotFiles) -> Option<Robot> {
        let alone = |gait: &SpecFile| Robot::new(RobotFiles { gaits: vec![gait.clone()], ..files.clone() });
        let (mut kept, mut lost) = (RobotFiles { gaits: Vec::new(), ..files.clone() }, Vec::new());
        for file in &files.gaits {
            match alone(file) {
                Ok(_) => kept.gaits.push(file.clone()),
                Err(why) => lost.push((Path::new(&file.path).file_stem()?.to_str()?.into(), why.to_string())),
            }
        }
        Robot::new(kept).ok().filter(|robot| !robot.files.gaits.is_empty()).map(|robot| Robot { lost, ..robot })
    }

    /// The gait that a result carries with it, under its name there.
    ///
    /// # Errors
    /// What is wrong with the specification, or that it is of another gait.
    pub fn carried(specification: &Specification, key: &str) -> Result<Interpreted, Unloadable> {
        let (module, gait) = key.rsplit_once('/').unwrap_or(("", key));
        let file = |path: String, text: &str| SpecFile { path, text: text.into() };
        let robot = file("robot.toml".into(), &specification.robot);
        let gaits = vec![file(format!("{gait}.toml"), &specification.gait)];
        Robot::new(RobotFiles { module: module.into(), robot, gaits })?.gait(key)
    }

    /// As the specification calls it.
    pub fn name(&self) -> &str {
        &self.specified.robot.name
    }

    /// Its files, with the numbers that were changed.
    pub fn files(&self) -> &RobotFiles {
        &self.files
    }

    /// Names of its gaits, behind that of its module if it has one.
    pub fn gaits(&self) -> Vec<String> {
        let lost = self.lost.iter().map(|(name, _)| name);
        self.specified.gaits.iter().map(|gait| &gait.name).chain(lost).map(|name| self.key(name)).collect()
    }

    /// Whether a gait leaves the ground, if there is one of this name.
    pub fn flies(&self, name: &str) -> Option<bool> {
        self.find(name).map(|(gait, _)| gait.phases.list.iter().any(|phase| phase.stance.is_none()))
    }

    /// The gaits that are meant where none is named: those that never leave the ground, whose searches are ten times as short; where all
    /// fly, all.
    pub fn usual_gaits(&self) -> Vec<String> {
        let all = self.gaits();
        // Of one that a change has made impossible that is told where it is asked for.
        let walks: Vec<String> = all.iter().filter(|gait| self.flies(gait) != Some(true)).cloned().collect();
        if walks.is_empty() { all } else { walks }
    }

    /// How many phases a gait lists, if there is one of this name.
    pub fn phases(&self, name: &str) -> Option<usize> {
        self.find(name).map(|(gait, _)| gait.phases.list.len())
    }

    /// What a gait is derived from, if there is one of this name.
    pub fn specification(&self, name: &str) -> Option<Specification> {
        let (_, file) = self.find(name)?;
        let text = |file: &SpecFile| file.text.clone().into();
        Some(Specification { robot: text(&self.files.robot), gait: text(file) })
    }

    fn find(&self, name: &str) -> Option<(&spec::Gait, &SpecFile)> {
        self.specified.gaits.iter().zip(&self.files.gaits).find(|(gait, _)| self.key(&gait.name) == name)
    }

    fn key(&self, gait: &str) -> String {
        let module = &self.files.module;
        if module.is_empty() { gait.into() } else { format!("{module}/{gait}") }
    }

    /// Derives a gait.
    ///
    /// # Errors
    /// If there is none of this name, or the robot's numbers make some that are none.
    pub fn gait(&self, name: &str) -> Result<Interpreted, Unloadable> {
        let (gait, specification) = (self.specified_gait(name)?, self.known_specification(name)?);
        Interpreted::new(&self.specified.robot, gait, specification, name)
            .map_err(|why| Unloadable::Gait { gait: name.into(), why })
    }

    /// The limits of a gait to which no motion can keep, without deriving it.
    ///
    /// # Errors
    /// If there is none of this name, or the robot's numbers make some that are none.
    pub fn contradictions(&self, name: &str) -> Result<Vec<Contradiction>, Unloadable> {
        let mechanism = mechanism(&self.specified.robot, self.specified_gait(name)?)
            .map_err(|why| Unloadable::Gait { gait: name.into(), why })?;
        Ok(underived(&mechanism, name).contradictions())
    }

    /// A gait that was derived with others, with its own description and kernels.
    pub(crate) fn evaluated(
        &self,
        name: &str,
        description: Description,
        kernels: Kernels,
    ) -> Result<Interpreted, Unloadable> {
        let (gait, specification) = (self.specified_gait(name)?, self.known_specification(name)?);
        Ok(Interpreted::member(&self.specified.robot, gait, specification, description, kernels))
    }

    pub(crate) fn specified(&self) -> &spec::Robot {
        &self.specified.robot
    }

    pub(crate) fn specified_gait(&self, name: &str) -> Result<&spec::Gait, Unloadable> {
        self.find(name).map(|(gait, _)| gait).ok_or_else(|| self.unknown(name))
    }

    fn known_specification(&self, name: &str) -> Result<Specification, Unloadable> {
        self.specification(name).ok_or_else(|| self.unknown(name))
    }

    fn unknown(&self, gait: &str) -> Unloadable {
        if let Some((_, why)) = self.lost.iter().find(|(name, _)| self.key(name) == gait) {
            return Unloadable::Specification(format!("{NONE}:\n{why}"));
        }
        Unloadable::NoGait { gait: gait.into(), known: self.gaits().join(", ") }
    }
}
