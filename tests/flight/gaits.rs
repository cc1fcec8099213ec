//! Gaits that fly, of the robot of `model-spec`.

use piaffe::Robot;
use piaffe::interpreter::Interpreted;
use piaffe::model::Gait;
use piaffe::motion::{Criterion, Motion};
use piaffe::search::multi_start::{Settings, search};
use piaffe_codegen::{RobotFiles, SpecFile};
use std::path::Path;

const LIMITS: &str = "
    [limits]
    friction = 0.9
    min_vertical_force = 12.0
    swing_clearance = 0.006
";

const RUNNING_TROT: &str = r#"
    virtual_legs = [["fore_left", "hind_right"], ["fore_right", "hind_left"]]
    platform = { moves = ["x", "y"], rotates = "none" }
    unactuated = "leg1.haunch"
    phases = [{ stance = ["leg1"], duration = [0.05, 2.0] }, { stance = [], duration = [0.03, 0.5] }]
    [cycle]
    then = "mirrored"
"#;

const BOUND: &str = r#"
    virtual_legs = [["hind_left", "hind_right"], ["fore_left", "fore_right"]]
    platform = { moves = ["x", "y"], rotates = "pitch" }
    unactuated = "platform"
    phases = [
        { stance = ["leg1"], duration = [0.05, 0.5] },
        { stance = ["leg2"], duration = [0.05, 0.5] },
        { stance = [], duration = [0.03, 0.5] },
    ]
    [cycle]
    then = "repeat"
"#;

fn flying(text: &str) -> Interpreted {
    let model = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec"));
    let files = RobotFiles::read(model).unwrap();
    let own = SpecFile { path: "gaits/flying.toml".into(), text: format!("{text}{LIMITS}") };
    Robot::new(RobotFiles { module: String::new(), gaits: vec![own], ..files }).unwrap().gait("flying").unwrap()
}

fn optimum(gait: &dyn Gait, criterion: Criterion) -> Motion {
    let settings = Settings { starts: Some(2), ..Settings::default() };
    search(gait, criterion, 1.0, &settings, &|_| {}).optima[0].local.motion.clone()
}

/// All of them with an optimum each.
pub fn optima() -> Vec<(Interpreted, Motion)> {
    [RUNNING_TROT, BOUND]
        .map(|text| {
            let gait = flying(text);
            let motion = optimum(&gait, Criterion::Torque);
            (gait, motion)
        })
        .into()
}
