//! `piaffe import`: a URDF or MJCF becomes a folder with a specification that builds.

use super::progress::{Counted, Progress};
use super::{built, input, output, whole};
use anyhow::{Context, bail};
use piaffe_codegen::{RobotFiles, SpecFile, check};
use piaffe_import::{Direction, FootPoint, Found, Import, Lock, Options, Setting, Stops, import};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub struct Arguments {
    /// The URDF or MJCF; `-` reads standard input.
    #[arg(value_name = "FILE|-")]
    file: PathBuf,
    /// Folder for the specification; model-spec/ with the robot's name if it is not given.
    #[arg(long = "out", value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Joint that is held still, at an angle of the file (rad; of a slide m) or the one nearest to zero; `*` and `?` match several, a `/` at
    /// the end all joints below it too. May be given several times, as all that name joints.
    #[arg(long, value_name = "JOINT[=ANGLE]")]
    lock: Vec<Lock>,
    /// Link that touches the ground, with the point of it that does, in its frame, m; makes a leg of its limb.
    #[arg(long, value_name = "LINK[=X,Y,Z]")]
    foot: Vec<FootPoint>,
    /// Greatest torque of a joint, N·m; without a name, of all that have none.
    #[arg(long, value_name = "[JOINT=]TORQUE")]
    effort: Vec<Setting>,
    /// Greatest speed of a joint, rad/s; without a name, of all that have none.
    #[arg(long, value_name = "[JOINT=]SPEED")]
    velocity: Vec<Setting>,
    /// Motor turns per turn of a joint; without a name, of all that have none.
    #[arg(long, value_name = "[JOINT=]RATIO")]
    gear: Vec<Setting>,
    /// Inertia of a rotor at the motor, kg·m²; without a name, of all that have none.
    #[arg(long, value_name = "[JOINT=]INERTIA")]
    rotor: Vec<Setting>,
    /// Stops of a joint, rad.
    #[arg(long, value_name = "JOINT=LOW,HIGH", allow_hyphen_values = true)]
    range: Vec<Stops>,
    /// Axis of the root link that points forward: x, y, z, -x, -y, -z.
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    forward: Option<Direction>,
    /// Axis of the root link that points up.
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    up: Option<Direction>,
    /// Legs whose numbers differ by no more than this share are made alike.
    #[arg(long, value_name = "SHARE", default_value_t = 1e-3, value_parser = share)]
    alike: f64,
    /// Take the nearest possible inertia also where the file would be refused for one that no body has.
    #[arg(long)]
    mend: bool,
    /// Write gaits that legs like these have without a trial whether the robot can do them.
    #[arg(long)]
    untried: bool,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=0.5).contains(&x) => Ok(x),
        Ok(_) => Err("must be between 0 and 0.5".into()),
        Err(_) => Err("is not a number; write for example 0.001".into()),
    }
}

pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let Arguments { file, folder, lock, foot, effort, velocity, gear, rotor, range, forward, up, alike, mend, untried } =
        arguments;
    let options = Options {
        locks: lock,
        feet: foot,
        efforts: effort,
        velocities: velocity,
        gears: gear,
        rotors: rotor,
        ranges: range,
        forward,
        up,
        alike,
        mend,
    };
    let text = input::read_text(&file)?;
    let made = import(&text, &options).with_context(|| format!("cannot import {}", input::name(&file)))?;
    let folder = folder.unwrap_or_else(|| Path::new("model-spec").join(&made.folder));
    let gaits = folder.join("gaits");
    let known = [folder.join("robot.toml"), gaits.clone()].into_iter().find(|path| path.exists());
    if let Some(known) = known {
        bail!("{} exists already: give another folder (--out), or remove it", known.display());
    }
    let files = |made: &Import| -> Vec<(PathBuf, String)> {
        let gaits = made.gaits.iter().map(|(name, text)| (gaits.join(name), text.clone()));
        [(folder.join("robot.toml"), made.robot.clone())].into_iter().chain(gaits).collect()
    };
    builds(&folder, &files(&made))?;
    let made = if untried { made } else { tried(made) };
    let files = files(&made);
    builds(&folder, &files)?;
    std::fs::create_dir_all(&gaits).with_context(|| format!("cannot create {}", gaits.display()))?;
    for (path, text) in &files {
        whole::write(path, text.as_bytes())?;
        output::say!("written to {}", path.display());
    }
    output::say!("");
    for note in &made.notes {
        output::say!("- {note}");
    }
    output::say!("");
    if let Some((gait, speed)) = to_begin_with(&made.found) {
        let folder = folder.display();
        output::say!("To see it go:");
        output::say!("  piaffe optimize {gait} --robot {folder} --speed {speed} --json {gait}.json");
        output::say!("  piaffe report {gait}.json --out {gait}");
    }
    match built::module_of(&folder)? {
        Ok(_) => output::say!("The next build has the gaits too, if the folder is in model-spec/."),
        Err(rename) => output::note(&rename),
    }
    Ok(true)
}

/// The gait that goes at most speeds, and one of them, m/s.
fn to_begin_with(found: &[Found]) -> Option<(&str, f64)> {
    let best = found.iter().rev().max_by_key(|found| found.speeds.len())?;
    Some((&best.gait, *best.speeds.get(best.speeds.len() / 2)?))
}

/// With the gaits that the robot can do.
fn tried(made: Import) -> Import {
    let bar = Progress::new(Counted::Starts(None));
    let made = made.tried(&|gait| {
        bar.set_message(format!("trying {gait}"));
        true
    });
    bar.finish_and_clear();
    made
}

/// The last word before anything is written: what a build would say of these files in this folder.
fn builds(folder: &Path, files: &[(PathBuf, String)]) -> anyhow::Result<()> {
    let module = built::module_of(folder)?.unwrap_or_default();
    let file = |(path, text): &(PathBuf, String)| SpecFile { path: path.display().to_string(), text: text.clone() };
    let robot = RobotFiles { module, robot: file(&files[0]), gaits: files[1..].iter().map(file).collect() };
    check(&[robot]).map_err(|why| anyhow::anyhow!("this would not build: {why}"))
}
