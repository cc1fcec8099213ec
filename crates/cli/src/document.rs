//! What a file holds: a result, several of them, or what a sweep says of its results.

use super::{input, robots, study};
use anyhow::{Context, anyhow, bail};
use piaffe_model::Gait;
use piaffe_optimizer::readback::Readback;
use piaffe_optimizer::result::GaitResult;
use piaffe_report::overview::Overview;
use piaffe_report::{Record, Standing};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A result beside the file that says so.
pub struct Stated {
    /// How to call it: the file, and which of its results if it has several.
    pub name: String,
    pub value: Value,
    pub result: GaitResult,
}

/// A sweep's overview with the results that it is about.
pub struct Sweep {
    pub name: String,
    pub value: Value,
    pub overview: Overview,
    pub results: Vec<Stated>,
}

/// What a file holds.
pub enum Document {
    /// Results, those that cannot be read with the reason.
    Results(Vec<anyhow::Result<Stated>>),
    Sweep(Box<Sweep>),
}

/// Name of a sweep's overview in its folder.
pub const OVERVIEW: &str = "sweep.json";

/// Reads a file, or standard input for `-`, and tells what it holds.
///
/// # Errors
/// If it is no JSON, or holds something else.
pub fn read(file: &Path) -> anyhow::Result<Document> {
    let name = input::name(file);
    let text = input::read_text(file)?;
    let value: Value = input::parse_json(file, &text)?;
    let has = |key: &str| value.get(key).is_some();
    if let Value::Array(items) = value {
        if items.is_empty() {
            bail!("{name} holds no results: its list is empty");
        }
        let results = items.into_iter().enumerate();
        return Ok(Document::Results(results.map(|(k, value)| stated(format!("{name}[{k}]"), value)).collect()));
    }
    if has("points") && has("maximum_speeds") {
        let overview = input::parse_json(file, &text)?;
        return Ok(Document::Sweep(Box::new(sweep(file, name, value, overview)?)));
    }
    if !has("gait") || !has("criterion") || !has("fingerprint") {
        let keys: Vec<&str> = value.as_object().into_iter().flat_map(|map| map.keys().map(String::as_str)).collect();
        let keys = if keys.is_empty() { "no keys".into() } else { format!("the keys {}", some(&keys)) };
        bail!("{name} is no result: it has {keys}; results are what `piaffe optimize --json` and `piaffe sweep` write");
    }
    let result = input::parse_json(file, &text)?;
    Ok(Document::Results(vec![Ok(Stated { name, value, result })]))
}

/// The one result in a file.
///
/// # Errors
/// If it cannot be read, or is not the only one.
fn read_one(file: &Path) -> anyhow::Result<Stated> {
    match read(file)? {
        Document::Sweep(sweep) => {
            bail!("{} is a sweep's overview: give one of the results beside it", sweep.name)
        }
        Document::Results(mut results) => match (results.pop(), results.len()) {
            (Some(only), 0) => only,
            (_, more) => bail!("{} holds {} results: give one of them", input::name(file), more + 1),
        },
    }
}

/// The one result in a file, derived anew.
///
/// # Errors
/// If it cannot be read, is of no gait that can be had, or states what its motion does not do.
pub fn readback(file: &Path) -> anyhow::Result<Readback<'static>> {
    let result = read_one(file)?.result;
    let gait = robots::of(&result).map_err(|why| anyhow!("{why}"))?;
    Ok(Readback::new(result, &[gait])?)
}

/// The one result in a file, with its specification: of an optimum what was derived anew, of what is none what it states, if
/// nothing refutes that; and its gait.
///
/// # Errors
/// If it cannot be read, is of no gait that can be had, or states what its motion does not do.
pub fn confirmed(file: &Path) -> anyhow::Result<(GaitResult, &'static dyn Gait)> {
    let name = input::name(file);
    let stated = read_one(file)?.result;
    let gait = robots::of(&stated).map_err(|why| anyhow!("{name}: {why}"))?;
    let Record { result: confirmed, standing, .. } = Record::read(stated, &[gait]);
    if let Standing::NotConfirmed(why) = standing {
        bail!("{name}: {why}");
    }
    let specification = confirmed.specification.or_else(|| gait.specification().cloned());
    Ok((GaitResult { specification, ..confirmed }, gait))
}

/// The files in a folder that may hold results: all JSON; of a study its walks.
///
/// # Errors
/// If the folder cannot be read or has none.
pub fn files(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let walks = folder.join(study::WALKS);
    let of_study = folder.join(study::ASKED).is_file() && walks.is_dir();
    let folder = if of_study { walks.as_path() } else { folder };
    let cannot = || format!("cannot read the folder {}", input::name(folder));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(cannot)? {
        let file = entry.with_context(cannot)?.path();
        files.extend(file.extension().is_some_and(|e| e == "json").then_some(file));
    }
    files.sort();
    if files.is_empty() {
        bail!("{} has no results (*.json); `piaffe sweep --out {0}` makes some", input::name(folder));
    }
    Ok(files)
}

fn stated(name: String, value: Value) -> anyhow::Result<Stated> {
    let result = typed(&value).with_context(|| format!("{name} is no result"))?;
    Ok(Stated { name, value, result })
}

fn typed<T: DeserializeOwned>(value: &Value) -> anyhow::Result<T> {
    Ok(serde_json::from_value(value.clone())?)
}

/// An overview with the results that it names.
fn sweep(file: &Path, name: String, value: Value, overview: Overview) -> anyhow::Result<Sweep> {
    if input::is_standard(file) {
        bail!("a sweep's overview is about the results beside it: give the file, not its text");
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut results = Vec::new();
    for point in &overview.points {
        // Only what stands beside it is its own.
        let beside = Path::new(&point.file);
        if beside.file_name() != Some(beside.as_os_str()) {
            bail!("{name} names `{}`, which is no file beside it", point.file);
        }
        let beside = folder.join(beside);
        match read_beside(&beside) {
            Ok(stated) => results.push(stated),
            Err(error) => return Err(error.context(format!("{name} names a result that cannot be read"))),
        }
    }
    Ok(Sweep { name, value, overview, results })
}

fn read_beside(file: &Path) -> anyhow::Result<Stated> {
    let text = input::read_text(file)?;
    let (value, result) = (input::parse_json(file, &text)?, input::parse_json(file, &text)?);
    Ok(Stated { name: input::name(file), value, result })
}

/// The first few of many names.
fn some(names: &[&str]) -> String {
    const SHOWN: usize = 5;
    let more = if names.len() > SHOWN { ", …" } else { "" };
    names[..names.len().min(SHOWN)].iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ") + more
}
