//! The robots that are shipped: those of the build, by their files.

use crate::robot::Robot;
use piaffe::gaits::GAITS;
use piaffe_codegen::{RobotFiles, SpecFile};
use pyo3::prelude::*;

/// All of them by name, in the build's order: that of their folder, or where they need none their own.
#[pyfunction]
pub fn built_in() -> PyResult<Vec<(String, Robot)>> {
    let file = |path: String, text: &str| SpecFile { path, text: text.into() };
    let mut robots: Vec<(String, RobotFiles)> = Vec::new();
    for gait in GAITS {
        let (d, Some(specification)) = (gait.description(), gait.specification()) else { continue };
        let (folder, name) = d.key.split_once('/').unwrap_or((d.robot, d.key));
        if !robots.iter().any(|(known, _)| known == folder) {
            let robot = file("robot.toml".into(), &specification.robot);
            robots.push((folder.into(), RobotFiles { module: String::new(), robot, gaits: Vec::new() }));
        }
        let own = robots.iter_mut().find(|(known, _)| known == folder);
        own.into_iter().for_each(|(_, files)| files.gaits.push(file(format!("{name}.toml"), &specification.gait)));
    }
    robots.into_iter().map(|(name, files)| Ok((name, Robot::of(files, Vec::new())?))).collect()
}
