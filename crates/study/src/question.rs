//! A study as it is written down: with it any machine can ask the same, and tell whether others did.

use crate::designs::{Designs, placeless};
use crate::row::Beyond;
use crate::study::{Search, Study};
use piaffe_codegen::{RobotFiles, SpecFile};
use piaffe_interpreter::{Robot, Unloadable};
use piaffe_model::motion::Criterion;
use serde::{Deserialize, Serialize};

/// All that the answers depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Question {
    pub version: String,
    /// [`Study::fingerprint`].
    pub fingerprint: String,
    pub specification: Files,
    /// What is varied, and each design's numbers.
    pub numbers: Vec<String>,
    pub designs: Vec<Vec<f64>>,
    pub gaits: Vec<String>,
    pub criteria: Vec<Criterion>,
    /// m/s.
    pub speeds: Vec<f64>,
    pub real_legs: bool,
    pub starts: Option<usize>,
    pub seed: u64,
    pub beyond: Vec<Beyond>,
}

/// What the base robot is read from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Files {
    /// Of its gaits.
    pub module: String,
    pub robot: File,
    pub gaits: Vec<File>,
}

/// A file of the specification.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct File {
    pub name: String,
    pub text: String,
}

/// Why what was written down cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unreadable {
    #[error(transparent)]
    Robot(#[from] Unloadable),
    #[error("{0}")]
    Designs(String),
    #[error("it was asked by piaffe {found}, and this is {own}: ask again")]
    Version { found: String, own: &'static str },
    #[error("its fingerprint is not that of what it asks: it was changed")]
    Changed,
}

impl From<&Study> for Question {
    fn from(study: &Study) -> Question {
        let files = placeless(study.robot.files());
        let file = |file: SpecFile| File { name: file.path, text: file.text };
        Question {
            version: env!("CARGO_PKG_VERSION").into(),
            fingerprint: study.fingerprint(),
            specification: Files {
                module: files.module,
                robot: file(files.robot),
                gaits: files.gaits.into_iter().map(file).collect(),
            },
            numbers: study.designs.names().to_vec(),
            designs: (0..study.designs.count()).map(|k| study.designs.numbers(k).to_vec()).collect(),
            gaits: study.gaits.clone(),
            criteria: study.criteria.clone(),
            speeds: study.speeds.clone(),
            real_legs: study.real_legs,
            starts: study.search.starts,
            seed: study.search.seed,
            beyond: study.beyond.iter().copied().collect(),
        }
    }
}

impl Question {
    /// The study that was written down.
    ///
    /// # Errors
    /// If it is of another version, or was changed.
    pub fn study(&self) -> Result<Study, Unreadable> {
        let own = env!("CARGO_PKG_VERSION");
        if self.version != own {
            return Err(Unreadable::Version { found: self.version.clone(), own });
        }
        let file = |file: &File| SpecFile { path: file.name.clone(), text: file.text.clone() };
        let Files { module, robot, gaits } = &self.specification;
        let files = RobotFiles { module: module.clone(), robot: file(robot), gaits: gaits.iter().map(file).collect() };
        let study = Study {
            robot: Robot::new(files)?,
            designs: Designs::listed(self.numbers.clone(), &self.designs).map_err(Unreadable::Designs)?,
            gaits: self.gaits.clone(),
            criteria: self.criteria.clone(),
            speeds: self.speeds.clone(),
            real_legs: self.real_legs,
            search: Search { starts: self.starts, seed: self.seed },
            beyond: self.beyond.iter().copied().collect(),
        };
        if study.fingerprint() != self.fingerprint || !study.faults().is_empty() {
            return Err(Unreadable::Changed);
        }
        Ok(study)
    }
}
