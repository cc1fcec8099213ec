//! `piaffe merge`: the parts of a study as a whole, with the bytes of one that was never parted.

use super::study::{ASKED, Asked, step, write};
use super::{input, journal, output};
use anyhow::{Context, bail};
use piaffe_study::{Answers, Row, Shard, Study};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Missing parts that are named.
const MISSING_SHOWN: usize = 20;

/// A part, and what is known of it.
struct Part {
    name: String,
    asked: Asked,
    rows: BTreeMap<usize, Row>,
}

pub fn run(parts: &[PathBuf], path: &Path) -> anyhow::Result<bool> {
    let parts = read(parts)?;
    let Some(first) = parts.first() else { bail!("there are no parts") };
    let study = first.asked.question.study().with_context(|| first.name.clone())?;
    let faults = faults(&parts, &study);
    if !faults.is_empty() {
        bail!("these parts are no whole:\n{}", faults.join("\n"));
    }
    let question = first.asked.question.clone();
    let rows: BTreeMap<usize, Row> = parts.into_iter().flat_map(|part| part.rows).collect();
    let rows: Vec<Row> = rows.into_values().collect();
    std::fs::create_dir_all(path).with_context(|| format!("cannot create {}", input::name(path)))?;
    output::write_json(&path.join(ASKED), &Asked { shard: Shard::WHOLE, question })?;
    write(&study, Shard::WHOLE, &Answers::new(&study), &rows, path)
}

/// The parts in these folders, or everything that keeps some from being read.
fn read(folders: &[PathBuf]) -> anyhow::Result<Vec<Part>> {
    let (parts, faults): (Vec<_>, Vec<_>) = folders.iter().map(|folder| part(folder)).partition(Result::is_ok);
    let faults: Vec<String> = faults.into_iter().filter_map(|fault| Some(format!("{:#}", fault.err()?))).collect();
    if !faults.is_empty() {
        bail!("not all parts can be read:\n{}", faults.join("\n"));
    }
    Ok(parts.into_iter().filter_map(Result::ok).collect())
}

fn part(folder: &Path) -> anyhow::Result<Part> {
    let name = input::name(folder);
    let asked: Asked =
        input::read_json(&folder.join(ASKED)).with_context(|| format!("{name} is no part of a study"))?;
    let study = asked.question.study().with_context(|| name.clone())?;
    let found = journal::found(folder)?;
    let row = |point: usize| {
        let known = found.get(&step(&asked.question.fingerprint, point))?;
        Some((point, serde_json::from_value::<Row>(known.clone()).ok()?))
    };
    let rows = asked.shard.points(&study).into_iter().filter_map(row).collect();
    Ok(Part { name, rows, asked })
}

/// What keeps these from being a whole: parts of another study, parts that are missing, not complete, or given twice.
fn faults(parts: &[Part], study: &Study) -> Vec<String> {
    let mut faults = Vec::new();
    let [first, others @ ..] = parts else { return faults };
    for other in others {
        if other.asked.question != first.asked.question {
            faults.push(format!("{} is a part of another study than {}", other.name, first.name));
        } else if other.asked.shard.count() != first.asked.shard.count() {
            let (a, b) = (first.asked.shard, other.asked.shard);
            faults.push(format!(
                "{} is part {a}, and {} part {b}: of as many parts they must be",
                first.name, other.name
            ));
        }
    }
    if !faults.is_empty() {
        return faults;
    }
    let given: BTreeSet<Shard> = parts.iter().map(|part| part.asked.shard).collect();
    let missing = first.asked.shard.count() - given.len();
    let shown = first.asked.shard.all().filter(|shard| !given.contains(shard)).take(MISSING_SHOWN);
    faults.extend(shown.map(|shard| format!("part {shard} is missing")));
    if missing > MISSING_SHOWN {
        faults.push(format!("and {} more parts are missing", missing - MISSING_SHOWN));
    }
    for (k, part) in parts.iter().enumerate() {
        let shard = part.asked.shard;
        if let Some(known) = parts[..k].iter().find(|known| known.asked.shard == shard) {
            faults.push(format!("{} and {} are both part {shard}", known.name, part.name));
        }
        let missing = shard.points(study).len() - part.rows.len();
        if missing > 0 {
            faults.push(format!(
                "{} lacks {missing} rows: run its study again, which goes on where it stopped",
                part.name
            ));
        }
    }
    faults
}
