//! What a result states, derived anew: from the specification and the motion's variables alone.
//!
//! [`Readback`](crate::readback::Readback) refuses what contradicts itself; an audit says of each statement whether it was
//! confirmed, with both numbers where it was not, or why it could not be checked.

use crate::altered::Altered;
use crate::model::Gait;
use crate::motion::Motion;
use crate::readback::gait_of;
use crate::result::{GaitResult, KKT_RESIDUAL};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Numbers agree that differ by less than this share of them: versions may round differently.
const RELATIVE: f64 = 1e-9;
/// Nor do they disagree below this.
const ABSOLUTE: f64 = 1e-13;

/// What is asked of a result: it is what the rest is derived from.
const GIVEN: [&str; 6] = ["gait", "criterion", "speed", "variables", "fingerprint", "limits_at_real_legs"];
/// How it was found. That says nothing about the motion, and cannot be seen from it.
const HISTORY: [&str; 7] =
    ["local_optima", "virtual_cost", "conflicts", "nearest_speed", "search", "seconds", "version"];

/// What became of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    Confirmed,
    NotConfirmed,
    NotChecked,
}

/// A statement of a result: an entry of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statement {
    /// The entry's key.
    pub entry: String,
    pub verdict: Verdict,
    /// Why it could not be checked, or by what it is refuted as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub differences: Vec<Difference>,
}

/// Where what is stated is not what was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// As in `receipt.findings[0].margin`.
    pub place: String,
    pub stated: Value,
    pub found: Value,
}

/// The statements of one result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Audit {
    pub name: String,
    pub statements: Vec<Statement>,
}

impl Audit {
    /// Checks all that a result says about its motion. `stated` is its file, `result` what was read from it.
    pub fn new(stated: &Value, result: &GaitResult, gaits: &[&dyn Gait]) -> Audit {
        let entries = stated.as_object().into_iter().flatten();
        let claims = entries.filter(|(key, value)| {
            let empty = value.is_null() || value.as_array().is_some_and(Vec::is_empty);
            !GIVEN.contains(&key.as_str()) && !HISTORY.contains(&key.as_str()) && !empty
        });
        let statements = match derived(result, gaits) {
            Ok(found) => {
                let entries = serde_json::to_value(&found).unwrap_or_default();
                claims.map(|(key, value)| Statement::compared(key, value, &found, &entries)).collect()
            }
            Err((verdict, reason)) => {
                let alike = |(key, _): (&String, &Value)| Statement::whole(key, verdict, reason.clone());
                claims.map(alike).collect()
            }
        };
        Audit { name: result.name(), statements }
    }

    /// Whether everything that is stated about the motion was confirmed.
    pub fn is_confirmed(&self) -> bool {
        !self.statements.is_empty() && self.statements.iter().all(|s| s.verdict == Verdict::Confirmed)
    }
}

/// The result that the variables make, or why there is none.
fn derived(result: &GaitResult, gaits: &[&dyn Gait]) -> Result<GaitResult, (Verdict, String)> {
    let gait = gait_of(result, gaits).map_err(|unusable| (Verdict::NotChecked, unusable.to_string()))?;
    if result.variables.is_empty() {
        let reason = "there is no motion: that none was found is a statement about the search";
        return Err((Verdict::NotChecked, reason.into()));
    }
    let motion = Motion { half_steps: result.variables.clone() };
    let altered;
    let mut gait = gait;
    if result.limits_at_real_legs {
        altered = Altered::at_real_legs(gait).map_err(|obstacle| (Verdict::NotConfirmed, obstacle))?;
        gait = &altered;
    }
    GaitResult::of_motion(gait, result.criterion, result.speed, &motion)
        .map_err(|error| (Verdict::NotConfirmed, format!("its motion cannot be derived anew: {error}")))
}

impl Statement {
    fn whole(entry: &str, verdict: Verdict, reason: String) -> Statement {
        Statement { entry: entry.into(), verdict, reason: Some(reason), differences: Vec::new() }
    }

    fn compared(entry: &str, stated: &Value, result: &GaitResult, found: &Value) -> Statement {
        let Some(found) = found.get(entry).filter(|found| !found.is_null()) else {
            return if result.is_optimal() {
                let reason = "this version derives nothing like it from the motion";
                Statement::whole(entry, Verdict::NotChecked, reason.into())
            } else {
                let reason = format!("the motion is no optimum, and has none ({})", result.message);
                Statement::whole(entry, Verdict::NotConfirmed, reason)
            };
        };
        let mut differences = Vec::new();
        compare(entry, stated, found, &mut differences);
        let verdict = if differences.is_empty() { Verdict::Confirmed } else { Verdict::NotConfirmed };
        Statement { entry: entry.into(), verdict, reason: None, differences }
    }
}

/// Notes where two values differ.
fn compare(place: &str, stated: &Value, found: &Value, differences: &mut Vec<Difference>) {
    match (stated, found) {
        (Value::Object(a), Value::Object(b)) => {
            // What only one of them has differs from nothing.
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            for key in keys {
                let [a, b] = [a, b].map(|map| map.get(key).unwrap_or(&Value::Null));
                compare(&format!("{place}.{key}"), a, b, differences);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            for i in 0..a.len().max(b.len()) {
                let [a, b] = [a, b].map(|list| list.get(i).unwrap_or(&Value::Null));
                compare(&format!("{place}[{i}]"), a, b, differences);
            }
        }
        _ if agree(place, stated, found) => {}
        _ => differences.push(Difference { place: place.into(), stated: stated.clone(), found: found.clone() }),
    }
}

fn agree(place: &str, stated: &Value, found: &Value) -> bool {
    match (stated.as_f64(), found.as_f64()) {
        // The optimizer's own residual, and one with multipliers that are fitted anew: both must be small enough.
        (Some(a), Some(b)) if place == "receipt.kkt_residual" => a.max(b) <= KKT_RESIDUAL,
        (Some(a), Some(b)) => (a - b).abs() <= ABSOLUTE + RELATIVE * a.abs().max(b.abs()),
        _ => stated == found,
    }
}
