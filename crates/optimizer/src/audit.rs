//! What a result states, derived anew: from the question and the motion's variables alone.
//!
//! An audit says of each statement whether it was confirmed, with both numbers where it was not, or why it could not be
//! checked. A statement that must be there and is not is one that does not hold.

use crate::optimize::Unaskable;
use crate::origin::{gait_of, under_its_limits};
use crate::result::{GaitResult, Status, impossible};
use piaffe_model::digits::digits;
use piaffe_model::motion::Motion;
use piaffe_model::{Gait, limit};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Numbers agree that differ by less than this share of them: versions may round differently.
const RELATIVE: f64 = 1e-9;
/// Nor do they disagree below this.
const ABSOLUTE: f64 = 1e-13;

/// What is asked of a result: it is what the rest is derived from.
const GIVEN: [&str; 7] =
    ["gait", "criterion", "speed", "variables", "fingerprint", "specification", "limits_at_real_legs"];
/// How it was found. That says nothing about the motion, and cannot be seen from it.
const HISTORY: [&str; 8] =
    ["cheaper_motion", "local_optima", "virtual_cost", "conflicts", "nearest_speed", "search", "seconds", "version"];
/// What is absent, which is compared with what is.
const ABSENT: &str = "not_examined";
/// What an optimum may leave open, if it says so: what takes longest of its verdict, and what is told beyond it.
const MAY_BE_ABSENT: [&str; 4] = ["certificate", "sensitivities", "stability", "real_legs"];

/// The optimum is among those that were found, whose costs older versions took from the optimizer: they agree to such a share.
const SAME_OPTIMUM: f64 = 1e-4;

/// Of a result that has no motion.
const NONE_FOUND: &str = "there is no motion: that none was found is a statement about the search";

/// Of one whose gait can have none.
const NO_MOTION: &str = "there is no motion: that follows from the limits, without a search";

/// What became of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    Confirmed,
    NotConfirmed,
    NotChecked,
    /// It is of how the motion was found, which does not follow from the motion.
    NotDerivable,
}

/// A statement of a result: an entry of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statement {
    /// The entry's key.
    pub entry: String,
    pub verdict: Verdict,
    /// Why it could not be checked, or what it is confirmed or refuted by as a whole.
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
    /// Checks all that a result says about its motion.
    pub fn of(result: &GaitResult, gaits: &[&dyn Gait]) -> Audit {
        Audit::new(&serde_json::to_value(result).unwrap_or_default(), result, gaits)
    }

    /// The same, where `stated` is the file that `result` was read from: it may have entries that no result has.
    pub fn new(stated: &Value, result: &GaitResult, gaits: &[&dyn Gait]) -> Audit {
        Audit::against(stated, result, derived(result, gaits).as_ref())
    }

    /// The same, where it is known already what the motion makes ([`derived`]).
    pub fn against(stated: &Value, result: &GaitResult, found: Result<&GaitResult, &Refusal>) -> Audit {
        let none = serde_json::Map::new();
        let entries = stated.as_object().unwrap_or(&none);
        let (history, claims): (Vec<_>, Vec<_>) = entries
            .iter()
            .filter(|(key, value)| !GIVEN.contains(&key.as_str()) && key.as_str() != ABSENT && !is_empty(value))
            .partition(|(key, _)| HISTORY.contains(&key.as_str()));
        let mut statements: Vec<Statement> = match found {
            Ok(found) => {
                let derived = serde_json::to_value(found).unwrap_or_default();
                let compared = claims.iter().map(|(key, value)| Statement::compared(key, value, found, &derived));
                compared.chain(missing(entries, result, &derived)).collect()
            }
            Err(Refusal::NoMotion(built)) => {
                claims.iter().map(|(key, value)| Statement::of_search(key, value, result, built)).collect()
            }
            Err(Refusal::Because(verdict, reason)) => {
                claims.iter().map(|(key, _)| Statement::whole(key, *verdict, reason.clone())).collect()
            }
        };
        let of_search = "how it was found, which a motion does not show";
        // What the motion costs, if that is known: a cost that is wrong is refuted by itself.
        let cost = found.ok().and_then(|found| found.cost).or(result.cost);
        statements.extend(history.iter().map(|(key, _)| match contradicted(key, result, cost) {
            Some(reason) => Statement::whole(key, Verdict::NotConfirmed, reason),
            None => Statement::not_derivable(key, of_search),
        }));
        statements.extend(misread(entries, result));
        statements.extend(said_absent(entries, result));
        Audit { name: result.name(), statements }
    }

    /// Whether everything that is stated about the motion was confirmed.
    pub fn is_confirmed(&self) -> bool {
        let mut of_motion = self.statements.iter().filter(|s| s.verdict != Verdict::NotDerivable).peekable();
        of_motion.peek().is_some() && of_motion.all(|s| s.verdict == Verdict::Confirmed)
    }

    /// Whether it is of a search that found no motion, and says so.
    pub fn is_of_no_motion(&self) -> bool {
        self.statements.iter().any(|s| s.entry == "status" && s.verdict == Verdict::NotDerivable)
    }

    /// The first statement that was not confirmed, in words.
    pub fn objection(&self) -> Option<String> {
        if self.is_confirmed() {
            return None;
        }
        let open = |s: &&Statement| !matches!(s.verdict, Verdict::Confirmed | Verdict::NotDerivable);
        let Some(statement) = self.statements.iter().find(open) else {
            return Some("it states nothing about its motion".into());
        };
        let difference = statement.differences.first();
        Some(match (&statement.reason, difference) {
            (Some(reason), _) => format!("`{}`: {reason}", statement.entry),
            (None, Some(d)) => format!("it states {} for {}, but its motion gives {}", d.stated, d.place, d.found),
            (None, None) => format!("`{}`", statement.entry),
        })
    }
}

fn is_empty(value: &Value) -> bool {
    value.is_null() || value.as_array().is_some_and(Vec::is_empty)
}

/// Statements that a result of such a motion makes and this one does not: each must be there, or be said to be absent.
fn missing<'a>(
    stated: &'a serde_json::Map<String, Value>,
    result: &'a GaitResult,
    derived: &'a Value,
) -> impl Iterator<Item = Statement> + 'a {
    let excused = |key: &str| MAY_BE_ABSENT.contains(&key) && result.not_examined.iter().any(|open| open.entry == key);
    let entries = derived.as_object().into_iter().flatten();
    entries
        .filter(|(key, value)| !GIVEN.contains(&key.as_str()) && !HISTORY.contains(&key.as_str()) && !is_empty(value))
        .filter(move |(key, _)| key.as_str() != ABSENT && stated.get(*key).is_none_or(is_empty) && !excused(key))
        .map(|(key, _)| Statement::whole(key, Verdict::NotConfirmed, "it is missing, without a word of why".into()))
}

/// What is asked, where the file says it otherwise than it was read: with numbers that nothing here has.
fn misread(stated: &serde_json::Map<String, Value>, result: &GaitResult) -> Vec<Statement> {
    let read = serde_json::to_value(result).unwrap_or_default();
    let asked = GIVEN.iter().filter_map(|key| Some(Statement::of(key, stated.get(*key)?, &read[*key])));
    asked.filter(|statement| statement.verdict != Verdict::Confirmed).collect()
}

/// Entries that are said to be absent, and are not.
fn said_absent<'a>(
    stated: &'a serde_json::Map<String, Value>,
    result: &'a GaitResult,
) -> impl Iterator<Item = Statement> + 'a {
    let there = |entry: &str| stated.get(entry).is_some_and(|value| !is_empty(value));
    let reason = |entry: &str| format!("`{entry}` is there, and said not to have been examined");
    let said = result.not_examined.iter().filter(move |open| there(&open.entry));
    said.map(move |open| Statement::whole(ABSENT, Verdict::NotConfirmed, reason(&open.entry)))
}

/// What is wrong with the search's account, as far as the result itself shows it.
fn contradicted(entry: &str, result: &GaitResult, cost: Option<f64>) -> Option<String> {
    let found = &result.local_optima;
    let effort = &result.search.effort;
    let near = |a: f64, b: f64| (a - b).abs() <= SAME_OPTIMUM * a.abs().max(b.abs());
    match (entry, cost) {
        ("local_optima", _) if result.variables.is_empty() => Some("there is no motion, and these were found".into()),
        ("local_optima", Some(cost)) if found.iter().all(|optimum| !near(optimum.cost, cost)) => {
            Some(format!("the optimum, which costs {}, is none of those that were found", digits(cost)))
        }
        ("local_optima", Some(cost)) if found.iter().any(|optimum| optimum.cost < (1.0 - SAME_OPTIMUM) * cost) => {
            let least = found.iter().map(|optimum| optimum.cost).fold(f64::INFINITY, f64::min);
            Some(format!("one that costs {} was found, and the result costs {}", digits(least), digits(cost)))
        }
        ("local_optima", _) if found.iter().map(|optimum| optimum.reached).sum::<usize>() > effort.starts => {
            Some(format!("more than the {} starts of the search led to them", effort.starts))
        }
        ("cheaper_motion", Some(cost)) if result.cheaper_motion.is_some_and(|cheaper| cheaper >= cost) => {
            Some(format!("it costs no less than the result, {}", digits(cost)))
        }
        ("search", _) if effort.successes > effort.starts => {
            Some(format!("{} of {} starts led to an optimum", effort.successes, effort.starts))
        }
        _ => None,
    }
}

/// Why there is nothing to compare a result with.
#[derive(Clone, Debug)]
pub enum Refusal {
    /// It has no motion: what can be said of it is about the search, and the gait, as it was built.
    NoMotion(Built),
    /// The verdict on all that is stated, and the reason.
    Because(Verdict, String),
}

/// What a result without a motion tells of its gait.
#[derive(Clone, Debug)]
pub struct Built {
    robot: &'static str,
    polynomial_order: usize,
    /// Why it has no motion, where that is known without a search.
    impossible: Option<String>,
}

/// The result that the variables of another one make.
///
/// # Errors
/// Why there is none.
pub fn derived(result: &GaitResult, gaits: &[&dyn Gait]) -> Result<GaitResult, Refusal> {
    let gait = gait_of(result, gaits).map_err(|foreign| Refusal::Because(Verdict::NotChecked, foreign.to_string()))?;
    let refuted = |reason: String| Refusal::Because(Verdict::NotConfirmed, reason);
    if Unaskable::of(result.speed).is_some() {
        return Err(refuted(format!("{} m/s is no speed to walk at", digits(result.speed))));
    }
    if result.variables.is_empty() {
        let d = gait.description();
        let (robot, polynomial_order, impossible) = (d.robot, d.polynomial_order, impossible(d));
        return Err(Refusal::NoMotion(Built { robot, polynomial_order, impossible }));
    }
    let motion = Motion { phases: result.variables.clone() };
    under_its_limits(result, gait, |gait| GaitResult::of_motion(gait, result.criterion, result.speed, &motion))
        .map_err(refuted)?
        .map_err(|error| refuted(format!("its motion cannot be derived anew: {error}")))
}

impl Statement {
    /// An entry beside what it should be.
    pub fn of(entry: &str, stated: &Value, found: &Value) -> Statement {
        let mut differences = Vec::new();
        compare(entry, stated, found, &mut differences);
        let verdict = if differences.is_empty() { Verdict::Confirmed } else { Verdict::NotConfirmed };
        Statement { entry: entry.into(), verdict, reason: None, differences }
    }

    /// An entry of a result without a motion. That there is none may follow from the limits, that none was found from nothing; what the
    /// gait is, from the build; all else would be about a motion that is not there.
    fn of_search(entry: &str, stated: &Value, result: &GaitResult, built: &Built) -> Statement {
        match entry {
            "robot" => Statement::of(entry, stated, &built.robot.into()),
            "polynomial_order" => Statement::of(entry, stated, &built.polynomial_order.into()),
            "status" if built.impossible.is_some() => {
                let found = Statement::of(entry, stated, &Status::Infeasible.name().into());
                if found.verdict == Verdict::Confirmed { Statement::known(entry) } else { found }
            }
            // Older versions knew of fewer contradictions, and told what a search met.
            "message" if built.impossible.is_some() && stated.as_str() == built.impossible.as_deref() => {
                Statement::known(entry)
            }
            "message" => Statement::not_derivable(entry, NONE_FOUND),
            "status" if !result.is_optimal() => Statement::not_derivable(entry, NONE_FOUND),
            _ => Statement::whole(entry, Verdict::NotConfirmed, "there is no motion that it could be of".into()),
        }
    }

    /// An entry that follows from nothing that is here, and why.
    pub fn not_derivable(entry: &str, reason: &str) -> Statement {
        Statement::whole(entry, Verdict::NotDerivable, reason.into())
    }

    /// An entry that says of the limits what they say themselves.
    fn known(entry: &str) -> Statement {
        Statement::whole(entry, Verdict::Confirmed, NO_MOTION.into())
    }

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
        Statement::of(entry, stated, found)
    }
}

/// Notes where two values differ.
fn compare(place: &str, stated: &Value, found: &Value, differences: &mut Vec<Difference>) {
    match (stated, found) {
        (Value::Object(a), Value::Object(b)) => {
            // What only one of them has differs from nothing.
            let stated =
                a.iter().map(|(key, value)| (current(key), value, b.get(current(key)).unwrap_or(&Value::Null)));
            let found = b.iter().map(|(key, value)| (key.as_str(), &Value::Null, value));
            let missing = found.filter(|(key, ..)| a.keys().all(|stated| current(stated) != *key));
            for (key, a, b) in stated.chain(missing) {
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
    // What something costs has a unit: of a tiny robot all of it may be less.
    let absolute = if place.starts_with("cost") { 0.0 } else { ABSOLUTE };
    match (stated.as_f64(), found.as_f64()) {
        (Some(a), Some(b)) => (a - b).abs() <= absolute + RELATIVE * a.abs().max(b.abs()),
        _ => stated == found || stated.as_str().is_some_and(|words| found == &limit::current(words)),
    }
}

/// A key as this build writes it; older ones called phases half steps.
fn current(key: &str) -> &str {
    match key {
        "half_step" => "phase",
        "half_steps" => "phases",
        _ => key,
    }
}
