//! `piaffe import`: a URDF becomes a folder with a specification.

use super::{input, output, whole};
use anyhow::{Context, bail};
use piaffe::import::{Options, import};
use std::path::{Path, PathBuf};

pub fn run(file: &Path, folder: Option<PathBuf>, locked: Vec<String>) -> anyhow::Result<bool> {
    let text = input::read_text(file)?;
    let made = import(&text, &Options { locked }).with_context(|| format!("cannot import {}", input::name(file)))?;
    let folder = folder.unwrap_or_else(|| Path::new("model-spec").join(&made.folder));
    let mut files = vec![(folder.join("robot.toml"), made.robot)];
    files.extend(made.gaits.into_iter().map(|(name, text)| (folder.join("gaits").join(name), text)));
    if let Some((known, _)) = files.iter().find(|(path, _)| path.exists()) {
        bail!("{} exists already: give another folder (--out), or remove it", known.display());
    }
    let gaits = folder.join("gaits");
    std::fs::create_dir_all(&gaits).with_context(|| format!("cannot create {}", gaits.display()))?;
    for (path, text) in &files {
        whole::write(path, text.as_bytes())?;
        output::say!("written to {}", path.display());
    }
    output::say!("");
    for note in &made.notes {
        output::say!("- {note}");
    }
    output::say!(
        "\nThe build reads every folder of model-spec/ that has a robot.toml: build again, and its gaits are there."
    );
    Ok(true)
}
