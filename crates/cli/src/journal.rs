//! The folder of a sweep or a study: what was found as files, and `journal.jsonl`, a line per step that was taken.
//!
//! The journal is only ever appended to. An end that was cut off is dropped, a line that is damaged or was changed is
//! reported; either step is taken again. What was found with other settings stays: with these settings
//! it serves again.

use super::output::{self, note};
use super::progress::Progress;
use super::{input, whole};
use anyhow::{Context, bail};
use piaffe_model::motion::Criterion;
use piaffe_model::{Gait, hash};
use piaffe_optimizer::cycle::Variables;
use piaffe_optimizer::result::{GaitResult, file_name};
use piaffe_optimizer::search::journal::Journal;
use piaffe_optimizer::search::multi_start::Settings;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A line of the journal.
#[derive(Serialize, Deserialize)]
struct Entry {
    step: String,
    outcome: Value,
    /// Of the step and its outcome together.
    #[serde(default)]
    hash: String,
}

impl Entry {
    fn new(step: &str, outcome: Value) -> Entry {
        let hash = Entry::hash(step, &outcome);
        Entry { step: step.into(), outcome, hash }
    }

    /// Whether it is as it was written. Its numbers are written with the shortest digits that are read as the same.
    fn is_whole(&self) -> bool {
        self.hash == Entry::hash(&self.step, &self.outcome)
    }

    fn hash(step: &str, outcome: &Value) -> String {
        format!("{:016x}", hash(&format!("{step} {outcome}")))
    }
}

/// Name of the journal in its folder.
const JOURNAL: &str = "journal.jsonl";

/// A folder that a sweep or a study writes to, and knows from earlier runs.
pub struct Folder {
    path: PathBuf,
    pub bar: Progress,
    state: Mutex<State>,
}

struct State {
    journal: File,
    known: HashMap<String, Value>,
    failure: Option<anyhow::Error>,
}

impl Folder {
    /// Opens or makes the folder. Damage is told on the bar's stream.
    ///
    /// # Errors
    /// If it cannot be written to, or another run is doing so.
    pub fn open(path: &Path, bar: Progress) -> anyhow::Result<Folder> {
        std::fs::create_dir_all(path).with_context(|| format!("cannot create {}", input::name(path)))?;
        let name = file_in(path)?;
        let cannot = || format!("cannot use {}", input::name(&name));
        let mut journal = OpenOptions::new().read(true).append(true).create(true).open(&name).with_context(cannot)?;
        if let Err(TryLockError::WouldBlock) = journal.try_lock() {
            bail!("another run is writing to {}: wait for it, or give another --out", input::name(path));
        }
        whole::tidy(path);
        let mut bytes = Vec::new();
        journal.read_to_end(&mut bytes).with_context(cannot)?;
        let whole = whole_lines(&bytes);
        if whole.len() < bytes.len() {
            journal.set_len(whole.len() as u64).with_context(cannot)?;
        }
        let known = entries(&name, whole);
        Ok(Folder { path: path.into(), bar, state: Mutex::new(State { journal, known, failure: None }) })
    }

    /// Says in what the last run in this folder was another one, and which of these points cannot be read.
    pub fn compare(&self, gaits: &[&dyn Gait], criteria: &[Criterion], speeds: &[f64], settings: &Settings) {
        let earlier: Option<Run> = self.known(RUN).and_then(|outcome| serde_json::from_value(outcome).ok());
        let run = Run::new(gaits, settings, earlier.as_ref());
        for difference in earlier.iter().flat_map(|earlier| run.differences(earlier)) {
            let folder = input::name(&self.path);
            note(&format!("the last run in {folder} had {difference}: what differs is searched anew"));
        }
        if let (true, Ok(outcome)) = (earlier.as_ref() != Some(&run), serde_json::to_value(&run)) {
            self.record(RUN, outcome);
        }
        for (gait, criterion) in gaits.iter().flat_map(|g| criteria.iter().map(move |c| (g, *c))) {
            let d = gait.description();
            for speed in speeds {
                let path = self.path.join(file_name(d.key, criterion, *speed, d.limits.real_legs));
                let damage = match std::fs::read_to_string(&path) {
                    Ok(text) => serde_json::from_str::<GaitResult>(&text).err().map(|error| error.to_string()),
                    Err(error) => (error.kind() != ErrorKind::NotFound).then(|| error.to_string()),
                };
                if let Some(damage) = damage {
                    note(&format!("{} is damaged ({damage}): it is written anew", input::name(&path)));
                }
            }
        }
    }

    /// Writes a result to its file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, result: &GaitResult) -> anyhow::Result<()> {
        output::write_json(&self.path.join(result.file_name()), result)
    }

    /// The first failure to write, if there was one.
    pub fn failure(&self) -> Option<anyhow::Error> {
        self.state().failure.take()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Whoever panicked left whole entries behind.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What another run has found in a folder, which is only read.
///
/// # Errors
/// If its journal cannot be read.
pub fn found(folder: &Path) -> anyhow::Result<HashMap<String, Value>> {
    let name = file_in(folder)?;
    let bytes = std::fs::read(&name).with_context(|| format!("cannot read {}", input::name(&name)))?;
    Ok(entries(&name, whole_lines(&bytes)))
}

/// The journal of a folder, a file if it is there.
fn file_in(folder: &Path) -> anyhow::Result<PathBuf> {
    let name = folder.join(JOURNAL);
    if name.metadata().is_ok_and(|there| !there.is_file()) {
        bail!("cannot use {}: it is no file", input::name(&name));
    }
    Ok(name)
}

/// Without an end that was cut off.
fn whole_lines(bytes: &[u8]) -> &[u8] {
    &bytes[..bytes.iter().rposition(|b| *b == b'\n').map_or(0, |last| last + 1)]
}

/// The steps of a journal with their outcomes. Damage is told.
fn entries(name: &Path, bytes: &[u8]) -> HashMap<String, Value> {
    let (mut known, mut changed) = (HashMap::new(), Vec::new());
    for (n, line) in bytes.split(|b| *b == b'\n').enumerate().filter(|(_, line)| !line.is_empty()) {
        match serde_json::from_slice::<Entry>(line) {
            Ok(entry) if entry.is_whole() => drop(known.insert(entry.step, entry.outcome)),
            Ok(_) => changed.push(n + 1),
            Err(error) => note(&format!("{}:{}: {error}; this step is taken again", input::name(name), n + 1)),
        }
    }
    if let [first, ..] = changed[..] {
        let (name, lines) = (input::name(name), changed.len());
        note(&format!(
            "{name}:{first}: changed since it was written ({lines} such lines): these steps are taken again"
        ));
    }
    known
}

/// The step that says how a run was set up.
const RUN: &str = "run";

/// What the results of a run depend on.
#[derive(PartialEq, Serialize, Deserialize)]
struct Run {
    version: String,
    starts: Option<usize>,
    seed: u64,
    /// Of the gaits that this run or one before was about.
    fingerprints: BTreeMap<String, String>,
}

impl Run {
    fn new(gaits: &[&dyn Gait], settings: &Settings, earlier: Option<&Run>) -> Run {
        let mut fingerprints = earlier.map(|e| e.fingerprints.clone()).unwrap_or_default();
        fingerprints.extend(gaits.iter().map(|g| (g.description().key.into(), g.description().fingerprint())));
        Run { version: env!("CARGO_PKG_VERSION").into(), starts: settings.starts, seed: settings.seed, fingerprints }
    }

    /// In words, of the earlier run.
    fn differences(&self, earlier: &Run) -> Vec<String> {
        let mut list = Vec::new();
        if self.version != earlier.version {
            list.push(format!("version {} (now {})", earlier.version, self.version));
        }
        if self.starts != earlier.starts {
            let number = |starts: Option<usize>| starts.map_or("as many as needed".into(), |n| n.to_string());
            list.push(format!("--starts {} (now {})", number(earlier.starts), number(self.starts)));
        }
        if self.seed != earlier.seed {
            list.push(format!("--seed {} (now {})", earlier.seed, self.seed));
        }
        for (gait, fingerprint) in &earlier.fingerprints {
            if self.fingerprints.get(gait) != Some(fingerprint) {
                list.push(format!("another specification of the {gait}"));
            }
        }
        list
    }
}

impl Journal for Folder {
    fn known(&self, step: &str) -> Option<Value> {
        self.state().known.get(step).cloned()
    }

    fn record(&self, step: &str, outcome: Value) {
        let entry = Entry::new(step, outcome);
        let mut state = self.state();
        let written = serde_json::to_string(&entry).map_err(anyhow::Error::from).and_then(|line| {
            let length = state.journal.metadata()?.len();
            // One call: a run that is killed leaves whole lines or one that is cut off.
            let written = state.journal.write_all(format!("{line}\n").as_bytes());
            if written.is_err() {
                // The next line must not be the end of this one.
                state.journal.set_len(length)?;
            }
            Ok(written?)
        });
        if let Err(error) = written {
            state.failure.get_or_insert(error.context("cannot write the journal"));
        }
        state.known.insert(entry.step, entry.outcome);
    }

    fn point(&self, result: &GaitResult) {
        if let Err(error) = self.write(result) {
            self.state().failure.get_or_insert(error);
        }
    }

    fn visited(&self, gait: &dyn Gait, fresh: bool) {
        self.bar.inc(effort(gait));
        if !fresh {
            // What was known already says nothing about the pace.
            self.bar.reset_eta();
        }
    }
}

/// How long a point of this gait takes, relative to others: the solver's work grows like the cube of the variables.
pub fn effort(gait: &dyn Gait) -> u64 {
    Variables::new(gait.description()).total().pow(3) as u64
}
