//! Any two texts are a specification or a list of mistakes, each with its place and advice; and what is a
//! specification becomes code.

#![no_main]

use libfuzzer_sys::fuzz_target;
use piaffe_codegen::spec::{Axis, parse_gait, parse_robot};
use piaffe_codegen::{RobotFiles, SpecFile, generate};

/// Between the robot and the gait of an input.
const SEPARATOR: &str = "\n#####\n";

/// Derivation takes time that grows quickly with a chain in space: a plane and few joints say enough here.
const JOINTS: usize = 6;

fuzz_target!(|text: &str| {
    let (robot_text, gait_text) = text.split_once(SEPARATOR).unwrap_or((text, ""));
    let robot = match parse_robot("robot.toml", robot_text) {
        Ok(robot) => robot,
        Err(mistakes) => return all_are_told(&mistakes),
    };
    let gait = match parse_gait("gait.toml", gait_text, &robot) {
        Ok(gait) => gait,
        Err(mistakes) => return all_are_told(&mistakes),
    };
    let legs = robot.robot.legs.iter().map(|leg| &leg.chain);
    let simple = legs.clone().flatten().all(|s| s.joint.axis == Axis::Pitch) && !gait.rotation.is_spatial();
    if simple && legs.map(Vec::len).max().unwrap_or(0) * 2 <= JOINTS {
        let file = |path: &str, text: &str| SpecFile { path: path.into(), text: text.into() };
        let files = RobotFiles {
            module: String::new(),
            robot: file("robot.toml", robot_text),
            gaits: vec![file("gait.toml", gait_text)],
        };
        if let Err(message) = generate(&[files], Some("crate::model")) {
            assert!(message.contains("cannot be called"), "{message}");
        }
    }
});

fn all_are_told(mistakes: &[piaffe_codegen::spec::Diagnostic]) {
    assert!(!mistakes.is_empty());
    for mistake in mistakes {
        assert!(!mistake.title.is_empty() && !mistake.help.is_empty());
        assert!(mistake.render().contains(mistake.code.as_str()));
    }
}
