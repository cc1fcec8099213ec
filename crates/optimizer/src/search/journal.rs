//! Long searches in steps that need to be taken once: a search that was interrupted goes on where it stopped.
//!
//! A step is a pure function. Its outcome is kept under a name with a hash of all that it depends on, so
//! what an earlier run found serves exactly where it would be found again: with another robot, seed or
//! neighbour the name is another one.

use crate::result::GaitResult;
use crate::search::multi_start::Settings;
use piaffe_model::{Gait, hash};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fmt::Debug;

/// What a search tells while it runs, and what it may already know.
pub trait Journal: Sync {
    /// The outcome of the step of this name.
    fn known(&self, step: &str) -> Option<Value>;
    /// A step was taken.
    fn record(&self, step: &str, outcome: Value);
    /// A new or better result.
    fn point(&self, result: &GaitResult);
    /// One more visit to a point of this gait; whether it took a step that was not known.
    fn visited(&self, gait: &dyn Gait, fresh: bool);
}

/// The outcome of a step, known or found now, and whether it was found now.
pub fn step<T: Serialize + DeserializeOwned>(
    journal: &dyn Journal,
    name: &str,
    inputs: &impl Debug,
    take: impl FnOnce() -> T,
) -> (T, bool) {
    let name = format!("{name} {:016x}", hash(&format!("{inputs:?}")));
    if let Some(outcome) = journal.known(&name).and_then(|known| serde_json::from_value(known).ok()) {
        return (outcome, false);
    }
    let outcome = take();
    // What JSON cannot hold is found again next time.
    if let Ok(value) = serde_json::to_value(&outcome) {
        journal.record(&name, value);
    }
    (outcome, true)
}

/// What every step depends on besides its own inputs.
pub fn common<'a>(gait: &dyn Gait, settings: &'a Settings) -> (String, &'static str, &'a Settings) {
    (gait.description().fingerprint(), env!("CARGO_PKG_VERSION"), settings)
}
