//! The robots that are shipped, by their files.

use crate::robot::Robot;
use piaffe_codegen::{RobotFiles, SpecFile};
use pyo3::prelude::*;

/// A robot of `model-spec/` with its gaits.
macro_rules! robot {
    ($name:literal, $folder:literal, [$($gait:literal),*]) => {
        ($name, include_str!(concat!("../../model-spec/", $folder, "robot.toml")), &[
            $(($gait, include_str!(concat!("../../model-spec/", $folder, "gaits/", $gait, ".toml"))),)*
        ])
    };
}

/// A name, `robot.toml`, and its gaits.
type Files = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

const ROBOTS: [Files; 3] = [
    robot!("quadruped", "", ["amble", "bound", "bound_two_flights", "curvet", "running_trot", "trot"]),
    robot!("rabbit", "rabbit/", ["run", "walk"]),
    robot!("a1", "a1/", ["bound", "flying_bound", "running_trot"]),
];

/// All of them by name.
#[pyfunction]
pub fn built_in() -> PyResult<Vec<(&'static str, Robot)>> {
    let file = |path: String, text: &str| SpecFile { path, text: text.into() };
    let read = |(name, robot, gaits): Files| {
        let gaits = gaits.iter().map(|(gait, text)| file(format!("{gait}.toml"), text)).collect();
        let files = RobotFiles { module: String::new(), robot: file("robot.toml".into(), robot), gaits };
        Ok((name, Robot::of(files, Vec::new())?))
    };
    ROBOTS.into_iter().map(read).collect()
}
