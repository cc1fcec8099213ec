//! The robots that are shipped, by their files.

use crate::robot::Robot;
use piaffe_codegen::{RobotFiles, SpecFile};
use pyo3::prelude::*;

/// A robot of `model-spec/` with its gaits there and in `runs/`.
macro_rules! robot {
    ($name:literal, $folder:literal, [$($gait:literal),*], [$($run:literal),*]) => {
        ($name, include_str!(concat!("../../model-spec/", $folder, "robot.toml")), &[
            $(($gait, include_str!(concat!("../../model-spec/", $folder, "gaits/", $gait, ".toml"))),)*
            $(($run, include_str!(concat!("../../runs/", $name, "/gaits/", $run, ".toml"))),)*
        ])
    };
}

/// A name, `robot.toml`, and its gaits.
type Files = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

const ROBOTS: [Files; 3] = [
    robot!("quadruped", "", ["amble", "curvet", "trot"], ["bound", "bound_two_flights", "running_trot"]),
    robot!("rabbit", "rabbit/", ["walk"], ["run"]),
    robot!("a1", "a1/", ["bound"], ["flying_bound", "running_trot"]),
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
