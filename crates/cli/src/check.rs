//! `piaffe check`: what a build would say of a robot's folder, and a drawing of the robot as it stands.

use super::{built, input, output, whole};
use anyhow::anyhow;
use piaffe_codegen::check;
use piaffe_codegen::spec::{parse_gait, parse_robot};
use piaffe_import::standing;
use std::path::Path;

pub fn run(folder: &Path, drawing: Option<&Path>) -> anyhow::Result<bool> {
    let mut files = input::robot(folder).map_err(|why| anyhow!("{why}"))?;
    files.module = built::module_of(folder)?;
    check(std::slice::from_ref(&files)).map_err(|why| anyhow!("this would not build\n{why}"))?;
    let robot = parse_robot(&files.robot.path, &files.robot.text).map_err(|_| anyhow!("this would not build"))?;
    let gaits = files.gaits.iter().filter_map(|file| parse_gait(&file.path, &file.text, &robot).ok());
    let gaits: Vec<String> = gaits.map(|gait| gait.name).collect();
    let robot = robot.robot;
    let links = robot.legs.iter().flat_map(|leg| &leg.chain);
    let mass = robot.platform.mass + links.map(|segment| segment.link.mass).sum::<f64>();
    output::say!("{}: {mass:.3} kg on {} legs; gaits: {}. It builds.", robot.name, robot.legs.len(), gaits.join(", "));
    if let Some(path) = drawing {
        whole::write(path, standing::svg(&robot).as_bytes())?;
        output::say!("drawn in {}", path.display());
    }
    Ok(true)
}
