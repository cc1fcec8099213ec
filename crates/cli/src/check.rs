//! `piaffe check`: what a build would say of a robot's folder, and a drawing of the robot as it stands.

use super::digits::at_least;
use super::{built, input, output, whole};
use anyhow::anyhow;
use piaffe_codegen::spec::parse_robot;
use piaffe_codegen::{RobotFiles, check};
use piaffe_import::standing;
use piaffe_interpreter::Robot;
use std::path::Path;

pub fn run(folder: &Path, drawing: Option<&Path>) -> anyhow::Result<bool> {
    let mut files = input::robot(folder).map_err(|why| anyhow!("{why}"))?;
    let module = built::module_of(folder)?;
    files.module = module.clone().unwrap_or_default();
    check(std::slice::from_ref(&files)).map_err(|why| anyhow!("this would not build\n{why}"))?;
    let robot = parse_robot(&files.robot.path, &files.robot.text).map_err(|_| anyhow!("this would not build"))?.robot;
    let whole = Robot::new(RobotFiles { module: String::new(), ..files })?;
    let gaits = whole.gaits();
    let links = robot.legs.iter().flat_map(|leg| &leg.chain);
    let mass = robot.platform.mass + links.map(|segment| segment.link.mass).sum::<f64>();
    let verdict = if module.is_ok() { "It builds." } else { "It goes." };
    let (legs, named) = (robot.legs.len(), gaits.join(", "));
    output::say!("{}: {} kg on {legs} legs; gaits: {named}. {verdict}", robot.name, at_least(mass, 0, 4));
    if let Err(rename) = module {
        output::note(&rename);
    }
    if let Some(path) = drawing {
        whole::write(path, standing::svg(&robot).as_bytes())?;
        output::say!("drawn in {}", path.display());
    }
    let mut wrong = Vec::new();
    for gait in &gaits {
        wrong.extend(whole.contradictions(gait)?.iter().map(|contradiction| format!("{gait}: {contradiction}")));
    }
    if wrong.is_empty() { Ok(true) } else { Err(anyhow!("there is nothing to be found\n{}", wrong.join("\n"))) }
}
