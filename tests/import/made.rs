//! What an import makes of a text.

use super::given::given;
use piaffe::import::{Fault, Import, import};
use piaffe_codegen::spec::{Robot, parse_robot};

/// What is imported with these options, and the robot of it, which builds.
pub fn made(text: &str, options: &[(&str, &str)]) -> (Import, Robot) {
    let made = import(text, &given(options)).unwrap_or_else(|e| panic!("{options:?}: {e}"));
    let robot = parse_robot("robot.toml", &made.robot).unwrap_or_else(|e| panic!("{}", e[0])).robot;
    (made, robot)
}

pub fn refused(text: &str, options: &[(&str, &str)]) -> Vec<Fault> {
    let faults = import(text, &given(options)).expect_err("nothing is in the way").0;
    assert!(!faults.is_empty() && faults.iter().all(|f| !f.remedy.is_empty()), "{faults:#?}");
    faults
}

/// Whether it is said, on the screen and in the file.
pub fn says(made: &Import, words: &str) -> bool {
    made.notes.iter().any(|note| note.contains(words)) && made.robot.contains(words)
}
