//! Two results beside each other: what differs between their questions and their answers, and how much of the cost's difference
//! follows from what differs between the robots.

use piaffe_codegen::spec::{default_of, numbers, words};
use piaffe_model::motion::Criterion;
use piaffe_model::{Description, Gait, Specification};
use piaffe_optimizer::origin::under_its_limits;
use piaffe_optimizer::result::{GaitResult, SearchEntry, Status};
use piaffe_optimizer::search::branch::{carried_to, same};
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::sensitivity::{Sensitivities, Sensitivity};
use serde::Serialize;
use std::collections::BTreeSet;

/// Costs that differ by less than this share differ by rounding.
const ROUNDING: f64 = 1e-9;

/// A result, and the gait that it is of.
#[derive(Clone, Copy)]
pub struct Side<'a> {
    pub result: &'a GaitResult,
    pub gait: &'a dyn Gait,
}

/// A value of both.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pair<T> {
    pub a: T,
    pub b: T,
}

/// What differs, and what does not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Whether both results carry their specifications; if not, nothing is known of their numbers.
    pub specified: bool,
    /// Numbers of the specification that are not the same in both, by their names.
    pub numbers: Vec<Changed<f64>>,
    /// What else of it is not: names, words, lists of them.
    pub words: Vec<Changed<String>>,
    /// Whether robot and gait, with their limits, are the same in both after all.
    pub same_gait: bool,
    pub kinship: Kinship,
    pub measures: Pair<Measures>,
    pub limits_at_real_legs: Pair<bool>,
    pub search: Pair<SearchEntry>,
    pub version: Pair<String>,
    pub robot: Pair<String>,
    pub gait: Pair<String>,
    pub criterion: Pair<Criterion>,
    /// m/s.
    pub speed: Pair<f64>,
    pub status: Pair<Status>,
    pub message: Pair<String>,
    /// The criterion's, where there is an optimum.
    pub cost: Pair<Option<f64>>,
    /// Of each phase, s.
    pub durations: Pair<Vec<f64>>,
    pub limits: Vec<Room>,
    /// Of two questions alike, least in the same criterion: others' have nothing to do with each other.
    pub slopes: Vec<Slope>,
    pub verdicts: Pair<Verdicts>,
    pub prediction: Option<Prediction>,
    /// What A's motion becomes at B's question, and B's at A's, where one can be carried to the other.
    pub carried: Option<Pair<Carried>>,
}

/// What two questions are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kinship {
    /// They differ in numbers: slopes of one say something of the other.
    Alike,
    /// Their gaits move the robot differently.
    OtherGait,
    /// Their robots are made of other parts.
    OtherRobot,
    /// Not both say what they are of.
    Unknown,
}

/// A robot in short.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measures {
    /// kg.
    pub mass: f64,
    /// N.
    pub weight: f64,
    /// m.
    pub leg_length: f64,
}

/// A motion that was carried to another question.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Carried {
    /// Of the optimum in which it ends there; none where it ends in none.
    pub cost: Option<f64>,
    /// Whether that is the motion that was found there.
    pub is_found: bool,
}

/// An entry of the specification. What a file leaves out is what it means; none where that is nothing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Changed<T> {
    pub name: String,
    pub values: Pair<Option<T>>,
    /// Whether it stands in the files.
    pub given: Pair<bool>,
}

/// A limit that is active in one of both or both: its margin, scaled, where it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Room {
    pub constraint: String,
    /// 1-based.
    pub phase: usize,
    pub margins: Pair<Option<f64>>,
}

/// Slope of the least criterion in a parameter, the criterion's unit per the parameter's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Slope {
    pub parameter: String,
    pub unit: String,
    pub slopes: Pair<f64>,
}

/// How sure each is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdicts {
    pub max_violation: Option<f64>,
    pub cycle_error: Option<f64>,
    pub kkt_residual: Option<f64>,
    pub certificate: Option<&'static str>,
}

/// What the slopes let expect of the cost's difference, to first order. Both must be least in the same criterion, and alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Prediction {
    /// By each parameter that differs, the largest first.
    pub parts: Vec<Part>,
    /// Their sums: with the slopes at A, at B, and the means of both, which are right to second order.
    pub at_a: f64,
    pub at_b: f64,
    pub mean: f64,
    /// The cost's difference, B's less A's.
    pub difference: f64,
    /// Numbers that differ and have no slope: the gait does not depend on them, or it is not known how. What they do is in no sum.
    pub without_slope: Vec<String>,
}

/// What a parameter adds: its slope times its change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    pub parameter: String,
    pub unit: String,
    pub change: f64,
    pub at_a: f64,
    pub at_b: f64,
}

impl Difference {
    pub fn new(of_a: Side, of_b: Side) -> Difference {
        let (a, b) = (of_a.result, of_b.result);
        let specifications = a.specification.as_ref().zip(b.specification.as_ref());
        let numbers = specifications.map_or(Vec::new(), |(a, b)| changed(a, b));
        let words = specifications.map_or(Vec::new(), |(a, b)| reworded(a, b));
        let same_gait = a.fingerprint == b.fingerprint;
        let kinship = match specifications {
            _ if same_gait => Kinship::Alike,
            Some((a, b)) => Kinship::of([a, b], [of_a, of_b].map(|side| side.gait.description()), &words),
            None => Kinship::Unknown,
        };
        let comparable = !matches!(kinship, Kinship::OtherGait | Kinship::OtherRobot) && a.criterion == b.criterion;
        Difference {
            prediction: comparable.then(|| Prediction::new(a, b, specifications.map(|_| &numbers))).flatten(),
            carried: comparable.then(|| carried(of_a, of_b)).flatten(),
            specified: specifications.is_some(),
            numbers,
            words,
            same_gait,
            kinship,
            measures: Pair { a: Measures::of(of_a.gait), b: Measures::of(of_b.gait) },
            limits_at_real_legs: pair(a, b, |r| r.limits_at_real_legs),
            search: pair(a, b, |r| r.search),
            version: pair(a, b, |r| r.version.clone()),
            robot: pair(a, b, |r| r.robot.clone()),
            gait: pair(a, b, |r| r.gait.clone()),
            criterion: pair(a, b, |r| r.criterion),
            speed: pair(a, b, |r| r.speed),
            status: pair(a, b, |r| r.status),
            message: pair(a, b, |r| r.message.clone()),
            cost: pair(a, b, |r| r.cost),
            durations: pair(a, b, |r| r.durations.clone()),
            limits: limits(a, b),
            slopes: if comparable { slopes(a, b) } else { Vec::new() },
            verdicts: pair(a, b, Verdicts::of),
        }
    }

    /// B's cost over A's, where both have one of the same criterion. What differs by rounding is the same.
    pub fn ratio(&self) -> Option<f64> {
        let ratio = self.cost.b? / self.cost.a?;
        let ratio = if (ratio - 1.0).abs() < ROUNDING { 1.0 } else { ratio };
        (self.criterion.a == self.criterion.b).then_some(ratio)
    }
}

impl Kinship {
    /// `reworded` is what differs in words.
    fn of([a, b]: [&Specification; 2], moves: [&Description; 2], reworded: &[Changed<String>]) -> Kinship {
        let in_robots = |name: &str| [a, b].into_iter().any(|s| words(&s.robot).iter().any(|word| word.name == name));
        // What a robot is called makes no difference.
        let built = reworded.iter().any(|word| word.name != "name" && in_robots(&word.name));
        if built || parts(&a.robot) != parts(&b.robot) {
            return Kinship::OtherRobot;
        }
        let [a, b] = moves;
        let members = |d: &Description| {
            d.legs.clone().map(|leg| leg.members.iter().map(|member| member.name).collect::<BTreeSet<_>>())
        };
        let modes = |d: &Description| d.phases.iter().map(|phase| phase.mode).collect::<Vec<_>>();
        let joints = |d: &Description| d.joints.iter().map(|joint| joint.name).collect::<Vec<_>>();
        let platform = |d: &Description| (d.rotation, d.unactuated, d.then);
        let alike =
            platform(a) == platform(b) && members(a) == members(b) && modes(a) == modes(b) && joints(a) == joints(b);
        if alike { Kinship::Alike } else { Kinship::OtherGait }
    }
}

/// What a file has to say: its links, joints, legs, …
fn parts(text: &str) -> BTreeSet<String> {
    let names =
        numbers(text).into_iter().map(|number| number.name).chain(words(text).into_iter().map(|word| word.name));
    let part = |name: String| match name.split('.').collect::<Vec<_>>()[..] {
        [table, part, _, ..] => format!("{table}.{part}"),
        _ => name,
    };
    names.filter(|name| default_of(name).is_none()).map(part).collect()
}

impl Measures {
    fn of(gait: &dyn Gait) -> Measures {
        let d = gait.description();
        Measures { mass: d.total_mass(), weight: d.weight(), leg_length: d.leg_length() }
    }
}

/// Each motion at the other's question, if it has as many variables.
fn carried(a: Side, b: Side) -> Option<Pair<Carried>> {
    let (from_a, from_b) = (a.result.theta()?, b.result.theta()?);
    let fit = from_a.len() == from_b.len() && a.result.durations.len() == b.result.durations.len();
    fit.then(|| Some(Pair { a: Carried::to(b, &from_a)?, b: Carried::to(a, &from_b)? })).flatten()
}

impl Carried {
    fn to(question: Side, theta: &[f64]) -> Option<Carried> {
        let Side { result, gait } = question;
        let arrive = |gait: &dyn Gait| {
            let task = Task { gait, criterion: result.criterion, speed: result.speed };
            let found = carried_to(&task, theta);
            let cost = found.as_ref().map(|found| found.costs.of(result.criterion));
            Carried { cost, is_found: found.is_some_and(|found| same(&found, result)) }
        };
        under_its_limits(result, gait, arrive).ok()
    }
}

fn pair<T>(a: &GaitResult, b: &GaitResult, of: impl Fn(&GaitResult) -> T) -> Pair<T> {
    Pair { a: of(a), b: of(b) }
}

/// The numbers that differ between two specifications.
pub fn changed(a: &Specification, b: &Specification) -> Vec<Changed<f64>> {
    let all = |text: &str| numbers(text).into_iter().map(|number| (number.name, number.value)).collect();
    differing(a, b, all, |default| default.parse().ok())
}

/// What else does: names, words, lists of them.
fn reworded(a: &Specification, b: &Specification) -> Vec<Changed<String>> {
    let all = |text: &str| words(text).into_iter().map(|word| (word.name, word.value)).collect();
    differing(a, b, all, |default| Some(default.into()))
}

/// Whether the robot and the gait are the same, wherever their limits hold.
pub fn same_robot(a: &GaitResult, b: &GaitResult) -> bool {
    match (&a.specification, &b.specification) {
        // Where limits hold is a part of a fingerprint.
        (Some(of_a), Some(of_b)) if a.limits_at_real_legs != b.limits_at_real_legs => {
            changed(of_a, of_b).is_empty() && reworded(of_a, of_b).is_empty()
        }
        _ => a.fingerprint == b.fingerprint,
    }
}

/// Entries that differ. What one leaves out is the same as its default in the other.
fn differing<T: Clone + PartialEq>(
    a: &Specification,
    b: &Specification,
    all: impl Fn(&str) -> Vec<(String, T)>,
    default: impl Fn(&str) -> Option<T>,
) -> Vec<Changed<T>> {
    let of = |s: &Specification| -> Vec<(String, T)> { all(&s.robot).into_iter().chain(all(&s.gait)).collect() };
    let (of_a, of_b) = (of(a), of(b));
    let value = |entries: &[(String, T)], name: &str| {
        entries.iter().find(|(other, _)| other == name).map(|(_, value)| value.clone())
    };
    let only_b = of_b.iter().filter(|(name, _)| value(&of_a, name).is_none());
    let names = of_a.iter().chain(only_b).map(|(name, _)| name);
    let entry = |name: &String| {
        let written = Pair { a: value(&of_a, name), b: value(&of_b, name) };
        let given = Pair { a: written.a.is_some(), b: written.b.is_some() };
        let absent = || default_of(name).and_then(&default);
        let values = Pair { a: written.a.or_else(absent), b: written.b.or_else(absent) };
        (values.a != values.b).then(|| Changed { name: name.clone(), values, given })
    };
    names.filter_map(entry).collect()
}

/// Limits that are active in one of both, with the phase.
fn limits(a: &GaitResult, b: &GaitResult) -> Vec<Room> {
    let findings = |r: &GaitResult| r.receipt.as_ref().map_or(Vec::new(), |receipt| receipt.findings.clone());
    let mut limits: Vec<Room> = Vec::new();
    for (own, in_b) in [(findings(a), false), (findings(b), true)] {
        for finding in own {
            let known = |room: &Room| (&room.constraint, room.phase) == (&finding.constraint, finding.phase);
            let place = limits.iter().position(known).unwrap_or_else(|| {
                let (constraint, phase) = (finding.constraint.clone(), finding.phase);
                limits.push(Room { constraint, phase, margins: Pair { a: None, b: None } });
                limits.len() - 1
            });
            let margins = &mut limits[place].margins;
            *(if in_b { &mut margins.b } else { &mut margins.a }) = Some(finding.margin);
        }
    }
    limits
}

/// Each slope of one result beside that of the other.
fn both<'r>(a: &'r GaitResult, b: &'r GaitResult) -> impl Iterator<Item = (&'r Sensitivity, &'r Sensitivity)> {
    let of = |r: &'r GaitResult| r.sensitivities.as_ref().map_or(&[][..], |s: &Sensitivities| &s.slopes);
    let (of_a, of_b) = (of(a), of(b));
    of_a.iter().filter_map(move |slope| Some((slope, of_b.iter().find(|other| other.parameter == slope.parameter)?)))
}

fn slopes(a: &GaitResult, b: &GaitResult) -> Vec<Slope> {
    let some = both(a, b).filter(|(a, b)| a.slope != 0.0 || b.slope != 0.0);
    some.map(|(a, b)| Slope {
        parameter: a.parameter.clone(),
        unit: a.unit.clone(),
        slopes: Pair { a: a.slope, b: b.slope },
    })
    .collect()
}

impl Verdicts {
    fn of(result: &GaitResult) -> Verdicts {
        let receipt = result.receipt.as_ref();
        Verdicts {
            max_violation: receipt.map(|receipt| receipt.max_violation),
            cycle_error: receipt.map(|receipt| receipt.cycle_error),
            kkt_residual: receipt.and_then(|receipt| receipt.kkt_residual),
            certificate: result.certificate.as_ref().map(|certificate| certificate.standing.name()),
        }
    }
}

impl Prediction {
    /// `changed` are the numbers that differ, where that is known.
    fn new(a: &GaitResult, b: &GaitResult, changed: Option<&Vec<Changed<f64>>>) -> Option<Prediction> {
        let difference = b.cost? - a.cost?;
        let known = a.sensitivities.is_some() && b.sensitivities.is_some();
        if !known {
            return None;
        }
        let (specified, changed) = (changed.is_some(), changed.map_or(&[][..], Vec::as_slice));
        // Of numbers that stay alike, all change by the same share.
        let together = |of_a: &Sensitivity, of_b: &Sensitivity| {
            let share = |name: &String| {
                let values = changed.iter().find(|number| number.name == *name)?.values;
                Some((values.a? * of_b.value - values.b? * of_a.value).abs() <= 1e-9 * (of_a.value * of_b.value).abs())
            };
            !specified || of_a.parameter == "speed" || of_a.numbers.iter().all(|name| share(name) == Some(true))
        };
        let part = |(a, b): (&Sensitivity, &Sensitivity)| {
            let change = b.value - a.value;
            (change != 0.0 && together(a, b)).then(|| Part {
                parameter: a.parameter.clone(),
                unit: a.unit.clone(),
                change,
                at_a: a.slope * change,
                at_b: b.slope * change,
            })
        };
        let mut parts: Vec<Part> = both(a, b).filter_map(part).collect();
        parts.sort_by(|a, b| b.at_a.abs().total_cmp(&a.at_a.abs()));
        let sum = |of: fn(&Part) -> f64| parts.iter().map(of).sum::<f64>();
        let (at_a, at_b) = (sum(|part| part.at_a), sum(|part| part.at_b));
        let has_slope =
            |name: &str| both(a, b).any(|(a, b)| a.numbers.iter().any(|number| number == name) && together(a, b));
        let without = changed.iter().filter(|number| !has_slope(&number.name));
        let without_slope = without.map(|number| number.name.clone()).collect();
        Some(Prediction { parts, at_a, at_b, mean: 0.5 * (at_a + at_b), difference, without_slope })
    }
}
