//! The robot of `model-spec` with friction in its joints, as its file would say.

use piaffe::Robot;
use piaffe_codegen::RobotFiles;
use std::path::Path;

/// Viscous, N·m·s/rad, and dry friction, N·m, of haunches and knees.
#[derive(Clone, Copy, Debug)]
pub struct Friction {
    pub damping: [f64; 2],
    pub coulomb: [f64; 2],
}

/// About as much as in motors with gears of 50.
pub const GEARED: Friction = Friction { damping: [0.1, 0.05], coulomb: [0.3, 0.2] };

/// What the keys say; those of no friction too.
pub fn with(friction: Friction) -> Robot {
    let model = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec"));
    let mut files = RobotFiles::read(model).unwrap();
    for (k, joint) in ["haunch", "knee"].iter().enumerate() {
        let (damping, coulomb) = (friction.damping[k], friction.coulomb[k]);
        let table = format!("[joints.{joint}]\n");
        let keys = format!("{table}damping = {damping:?}\ncoulomb = {coulomb:?}\n");
        assert!(files.robot.text.contains(&table));
        files.robot.text = files.robot.text.replace(&table, &keys);
    }
    Robot::new(RobotFiles { module: String::new(), ..files }).unwrap()
}
