//! How fast a gait goes: the greatest speed and what ends it, and the nearest speed that works.

use super::atlas::{looked, search_at};
use super::journal::{Journal, common, step};
use super::local::{Conflict, Local, Task};
use super::multi_start::{Expected, Settings, search, start};
use crate::result::GaitResult;
use piaffe_model::Gait;
use piaffe_model::digits::legible;
use piaffe_model::motion::Criterion;
use piaffe_model::units::Units;
use piaffe_sqp::Control;
use serde::{Deserialize, Serialize};

/// Width to which a limiting speed is bisected, in the robot's unit of speed.
const BISECTION: f64 = 5e-4;
/// First step beyond the last speed that works, and where stepping ends, in the same unit.
const STEP: f64 = 0.06;
const FASTEST: f64 = 6.0;
/// Starts at a speed that may have no motion at all, where their number is not given.
const STARTS: usize = 4;

/// Starts at a speed where few have found nothing.
const WIDE: usize = 8;

/// Speeds, each further off than the one before, at which the question is asked again.
const ATTEMPTS: usize = 8;
/// By so much is each further off than the last.
const FURTHER: f64 = 1.5;
/// No robot is asked to go slower, in its unit of speed.
const SLOWEST: f64 = 0.01;

/// Whether no robot like this is asked to go so fast.
pub fn is_too_fast(gait: &dyn Gait, speed: f64) -> bool {
    speed > FASTEST * Units::new(gait.description()).speed()
}

/// What ends a gait where motions go on but optima do not.
const BEYOND: &str = "finding an optimum among the motions that there are";

/// How fast a gait goes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MaximumSpeed {
    /// The greatest speed with a feasible motion, as far as local searches can tell; after [`MaximumSpeed::optima`] one with an optimum.
    pub speed: f64,
    /// What conflicts just above it, weightiest first.
    #[serde(deserialize_with = "piaffe_model::limit::names")]
    pub ended_by: Vec<String>,
    /// A motion at this speed, as variables Θ; of no criterion.
    theta: Vec<f64>,
}

/// Steps beyond the fastest of these results, then bisects. `None` if none is an optimum or there is no end.
pub fn maximum_speed(
    gait: &dyn Gait,
    results: &[GaitResult],
    settings: &Settings,
    journal: &dyn Journal,
) -> Option<MaximumSpeed> {
    let fastest = results.iter().filter(|r| r.is_optimal()).max_by(|a, b| a.speed.total_cmp(&b.speed))?;
    let from = fastest.theta()?;
    let name = format!("{} greatest speed", gait.description().key);
    step(journal, &name, &(common(gait, settings), fastest.speed, &from), || {
        climb(gait, fastest.speed, &from, settings)
    })
    .0
}

fn climb(gait: &dyn Gait, speed: f64, from: &[f64], settings: &Settings) -> Option<MaximumSpeed> {
    let mut good = speed;
    let mut theta = from.to_vec();
    let mut conflicts: Vec<Conflict> = Vec::new();
    let mut bad = None;
    let unit = Units::new(gait.description()).speed();
    while bad.is_none_or(|b| b - good > BISECTION * unit) {
        let speed = bad.map_or(good + STEP * unit, |b| 0.5 * (good + b));
        if speed > FASTEST * unit {
            return None;
        }
        let local = attempt(gait, speed, Some(&theta), settings);
        if local.status.is_optimal() {
            good = speed;
            theta = local.theta;
        } else {
            bad = Some(speed);
            conflicts = local.conflicts;
        }
    }
    // The answer is what stands against the question.
    conflicts.retain(|c| !c.label.limit.is_asked());
    conflicts.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let ended_by = conflicts.iter().map(|c| format!("{} (phase {})", c.label.name(), c.label.phase)).collect();
    Some(MaximumSpeed { speed: good, ended_by, theta })
}

impl MaximumSpeed {
    /// The optima at the greatest speed; `results` are those at other speeds (ascending), criterion by criterion. Motions may go on where no
    /// optimum is found any more: as long as no criterion has one, the speed is lowered towards the fastest optimum.
    pub fn optima(
        &mut self,
        gait: &dyn Gait,
        criteria: &[Criterion],
        results: &[Vec<GaitResult>],
        settings: &Settings,
        journal: &dyn Journal,
    ) -> Vec<GaitResult> {
        let known = results.iter().flatten().filter(|r| r.is_optimal()).map(|r| r.speed).fold(0.0, f64::max);
        while self.speed > known {
            let at = |(c, line): (&Criterion, &Vec<GaitResult>)| self.optimum(gait, *c, line, settings, journal);
            let optima: Vec<_> = criteria.iter().zip(results).map(at).collect();
            if optima.iter().any(GaitResult::is_optimal) {
                return optima;
            }
            let slower = 0.5 * (known + self.speed);
            self.speed =
                if slower - known > BISECTION * Units::new(gait.description()).speed() { slower } else { known };
            self.ended_by = vec![BEYOND.into()];
            let name = format!("{} motion at {}", gait.description().key, self.speed);
            let slower = || attempt(gait, self.speed, Some(&self.theta), settings).theta;
            self.theta = step(journal, &name, &(common(gait, settings), &self.theta), slower).0;
        }
        Vec::new()
    }

    fn optimum(
        &self,
        gait: &dyn Gait,
        criterion: Criterion,
        line: &[GaitResult],
        settings: &Settings,
        journal: &dyn Journal,
    ) -> GaitResult {
        let task = Task { gait, criterion, speed: self.speed };
        let slower = line.iter().rev().skip_while(|r| r.speed >= self.speed);
        let near = slower.clone().next().filter(|r| r.is_optimal());
        let expected = near.map_or(Expected::Nothing, |_| Expected::Theirs(looked(slower)));
        let neighbours: Vec<Vec<f64>> =
            near.and_then(GaitResult::theta).into_iter().chain([self.theta.clone()]).collect();
        search_at(&task, settings, &neighbours, expected, journal).0
    }
}

/// A feasible motion at a speed, or the attempt that came closest.
///
/// Feasibility does not depend on the criterion.
fn attempt(gait: &dyn Gait, speed: f64, from: Option<&[f64]>, settings: &Settings) -> Local {
    let task = Task { gait, criterion: Criterion::Torque, speed };
    let of = |theta: &[f64]| task.nearest_motion(theta, &mut |_| Control::Continue);
    let mut best = from.map(of);
    for k in 0..settings.starts.unwrap_or(STARTS) {
        if best.as_ref().is_some_and(|b| b.status.is_optimal()) {
            break;
        }
        let other = of(&start(gait, Criterion::Torque, speed, settings.seed, k));
        let better = |b: &Local| other.status.is_optimal() || other.kkt.violation < b.kkt.violation;
        if best.as_ref().is_none_or(better) {
            best = Some(other);
        }
    }
    best.unwrap_or_else(|| of(&start(gait, Criterion::Torque, speed, settings.seed, 0)))
}

/// For a speed without a feasible motion the nearest one at which the same question has an answer, as far as
/// local searches can tell. Looks for motions at speeds ever further off on both sides, and if there seem to be none for optima, which
/// takes longer; then bisects from what was found, and asks there.
pub fn nearest_speed(gait: &dyn Gait, criterion: Criterion, speed: f64, settings: &Settings) -> Option<f64> {
    if !gait.description().contradictions().is_empty() {
        return None;
    }
    let few = Settings { starts: Some(settings.starts.unwrap_or(STARTS).min(3)), ..settings.clone() };
    let wide = Settings { starts: Some(settings.starts.unwrap_or(WIDE).min(WIDE)), ..settings.clone() };
    let motion = |speed: f64| Some(attempt(gait, speed, None, &few)).filter(|local| local.status.is_optimal());
    let optimum =
        |speed: f64| search(gait, criterion, speed, &wide, &|_| {}).optima.into_iter().next().map(|found| found.local);
    nearest_by(&motion, gait, criterion, speed, settings)
        .or_else(|| nearest_by(&optimum, gait, criterion, speed, settings))
}

/// The same by one way of looking for motions at a speed.
fn nearest_by(
    look: &dyn Fn(f64) -> Option<Local>,
    gait: &dyn Gait,
    criterion: Criterion,
    speed: f64,
    settings: &Settings,
) -> Option<f64> {
    let none = Settings { starts: Some(0), ..settings.clone() };
    let unit = Units::new(gait.description()).speed();
    // From beyond all speeds that are asked for the way begins at the last of them, and leads to one side alone.
    let beginning = speed.clamp(SLOWEST * unit, FASTEST * unit);
    let attempts = if beginning == speed { ATTEMPTS } else { 2 * ATTEMPTS };
    let (mut slower, mut faster) = (beginning, beginning);
    for _ in 0..attempts {
        for (candidate, last) in [(slower / FURTHER, slower), (faster * FURTHER, faster)] {
            if !(SLOWEST * unit..=FASTEST * unit).contains(&candidate) {
                continue;
            }
            let Some(found) = look(candidate) else { continue };
            let (mut good, mut bad, mut theta) = (candidate, last, found.theta);
            while (bad - good).abs() > BISECTION * unit {
                let middle = 0.5 * (good + bad);
                let local = attempt(gait, middle, Some(&theta), &none);
                if local.status.is_optimal() {
                    (good, theta) = (middle, local.theta);
                } else {
                    bad = middle;
                }
            }
            if let Some(answered) = answered(gait, criterion, [beginning, good], settings) {
                return Some(answered);
            }
        }
        (slower, faster) = (slower / FURTHER, faster * FURTHER);
    }
    None
}

/// From `good`, or further away from `asked`, the first speed at which a search finds an optimum whose receipt holds, with
/// nothing known but the question.
fn answered(gait: &dyn Gait, criterion: Criterion, [asked, good]: [f64; 2], settings: &Settings) -> Option<f64> {
    let mut distance = good - asked;
    for _ in 0..ATTEMPTS {
        let speed = legible(asked + distance, distance > 0.0);
        if speed > 0.0 && speed != asked {
            let found = search(gait, criterion, speed, settings, &|_| {});
            if GaitResult::new(gait, criterion, speed, &found, settings, || 0.0).is_optimal() {
                return Some(speed);
            }
        }
        distance *= 2.0;
    }
    None
}
