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
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::iter::successors;

/// Width to which a limiting speed is bisected, in the robot's unit of speed.
const BISECTION: f64 = 5e-4;
/// Width to which the greatest speed with an optimum is bisected, as a share of where there are motions alone: each step is a search.
const NARROWED: f64 = 1.0 / 32.0;
/// First step beyond the last speed that works, and where stepping ends, in the same unit.
const STEP: f64 = 0.06;
const FASTEST: f64 = 6.0;
/// Starts at a speed that may have no motion at all, where their number is not given.
const STARTS: usize = 4;

/// The same where an edge is bisected, where few have found nothing, and for what comes closest to a motion at the speed itself.
const FEW: usize = 3;
const WIDE: usize = 8;
const CLOSE: usize = 16;

/// Speeds on each side of a speed that are looked at from what comes closest to a motion there: the first is as far off as bisection
/// ends, each further one twice as far as the last.
const DOUBLINGS: i32 = 9;
/// Speeds, each further off than the one before, at which the question is asked again.
const ATTEMPTS: i32 = 8;
/// So often is the way halved between a speed without an answer and one that has it.
const HALVINGS: usize = 3;
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
    /// optimum is found any more: then the speed is bisected between that and the fastest optimum.
    pub fn optima(
        &mut self,
        gait: &dyn Gait,
        criteria: &[Criterion],
        results: &[Vec<GaitResult>],
        settings: &Settings,
        journal: &dyn Journal,
    ) -> Vec<GaitResult> {
        let optimal = results.iter().flatten().filter(|r| r.is_optimal());
        let fastest = optimal.max_by(|a, b| a.speed.total_cmp(&b.speed));
        let known = fastest.map_or(0.0, |r| r.speed);
        if self.speed <= known {
            return Vec::new();
        }
        let search = |at: &MaximumSpeed| -> Vec<GaitResult> {
            let of = |(c, line): (&Criterion, &Vec<GaitResult>)| at.optimum(gait, *c, line, settings, journal);
            criteria.iter().zip(results).map(of).collect()
        };
        let optima = search(self);
        if optima.iter().any(GaitResult::is_optimal) {
            return optima;
        }
        let (edge, unit) = (self.speed, Units::new(gait.description()).speed());
        self.ended_by = vec![BEYOND.into()];
        let theta = fastest.and_then(GaitResult::theta).unwrap_or_else(|| self.theta.clone());
        let mut slower = (MaximumSpeed { speed: known, theta, ..self.clone() }, Vec::new());
        let mut faster = edge;
        let narrow = |good: f64| if good > known { NARROWED * (edge - known) } else { 0.0 };
        while faster - slower.0.speed > narrow(slower.0.speed).max(BISECTION * unit) {
            self.speed = 0.5 * (slower.0.speed + faster);
            let name = format!("{} motion at {}", gait.description().key, self.speed);
            let nearby = || attempt(gait, self.speed, Some(&self.theta), settings).theta;
            self.theta = step(journal, &name, &(common(gait, settings), &self.theta), nearby).0;
            let optima = search(self);
            if optima.iter().any(GaitResult::is_optimal) {
                slower = (self.clone(), optima);
            } else {
                faster = self.speed;
            }
        }
        let optima;
        (*self, optima) = slower;
        optima
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

/// For a speed without a feasible motion the nearest one found at which the same question has an answer, as far as local searches can
/// tell. Looks for motions beside what comes closest to one at the speed itself, then from nothing at speeds ever further off on both
/// sides, and if there seem to be none for optima, which takes longer.
pub fn nearest_speed(gait: &dyn Gait, criterion: Criterion, speed: f64, settings: &Settings) -> Option<f64> {
    if !gait.description().contradictions().is_empty() {
        return None;
    }
    let starts = |most: usize| settings.starts.map_or(most, |asked| asked.min(most));
    let at_most = |most: usize| Settings { starts: Some(starts(most)), ..settings.clone() };
    let unit = Units::new(gait.description()).speed();
    // From beyond all speeds that are asked for the way begins at the last of them, and leads to one side alone.
    let asked = speed.clamp(SLOWEST * unit, FASTEST * unit);
    let attempts = if asked == speed { ATTEMPTS } else { 2 * ATTEMPTS };
    let question = Question { gait, criterion, asked, settings, few: at_most(FEW) };
    let closest = question.closest(starts(CLOSE));
    let (none, wide) = (at_most(0), at_most(WIDE));
    let found = |local: Local| local.status.is_optimal().then_some(local.theta);
    let beside = |speed: f64| found(attempt(gait, speed, closest.as_deref(), &none));
    let motion = |speed: f64| found(attempt(gait, speed, None, &question.few));
    let optimum = |speed: f64| {
        let optima = search(gait, criterion, speed, &wide, &|_| {}).optima;
        optima.into_iter().next().map(|optimum| optimum.local.theta)
    };
    let close = |k| BISECTION * unit * 2f64.powi(k);
    let near: Vec<_> = (0..DOUBLINGS).map(|k| [asked - close(k), asked + close(k)]).collect();
    let far: Vec<_> = (1..=attempts).map(|k| [-k, k].map(|k| asked * FURTHER.powi(k))).collect();
    let answer = |look, speeds| question.answer(look, speeds);
    answer(&beside, &near).or_else(|| answer(&motion, &far)).or_else(|| answer(&optimum, &far))
}

/// What has no answer at a speed.
struct Question<'a> {
    gait: &'a dyn Gait,
    criterion: Criterion,
    asked: f64,
    settings: &'a Settings,
    /// Where an edge is bisected.
    few: Settings,
}

impl Question<'_> {
    /// Of the starts the end of the one that comes closest to a motion.
    fn closest(&self, starts: usize) -> Option<Vec<f64>> {
        let task = Task { gait: self.gait, criterion: Criterion::Torque, speed: self.asked };
        let end = |k| {
            let start = start(self.gait, Criterion::Torque, self.asked, self.settings.seed, k);
            task.nearest_motion(&start, &mut |_| Control::Continue)
        };
        let ends: Vec<Local> = (0..starts).into_par_iter().map(end).collect();
        ends.into_iter().min_by(|a, b| a.kkt.violation.total_cmp(&b.kkt.violation)).map(|end| end.theta)
    }

    /// The nearest answer by one way of looking for motions, at pairs of speeds on both sides, each further off than the last.
    fn answer(&self, look: &dyn Fn(f64) -> Option<Vec<f64>>, speeds: &[[f64; 2]]) -> Option<f64> {
        let unit = Units::new(self.gait.description()).speed();
        let mut last = [self.asked; 2];
        for pair in speeds {
            for (candidate, last) in pair.iter().zip(last) {
                if !(SLOWEST * unit..=FASTEST * unit).contains(candidate) {
                    continue;
                }
                if let Some(theta) = look(*candidate)
                    && let Some(speed) = self.beyond(self.edge([*candidate, last], theta))
                {
                    return Some(speed);
                }
            }
            last = *pair;
        }
        None
    }

    /// Between a speed with this motion and one where none was found, the last that motions lead to.
    fn edge(&self, [mut good, mut bad]: [f64; 2], mut theta: Vec<f64>) -> f64 {
        while (bad - good).abs() > BISECTION * Units::new(self.gait.description()).speed() {
            let middle = 0.5 * (good + bad);
            let local = attempt(self.gait, middle, Some(&theta), &self.few);
            if local.status.is_optimal() {
                (good, theta) = (middle, local.theta);
            } else {
                bad = middle;
            }
        }
        good
    }

    /// From `good`, or further away, a speed at which a search finds an optimum whose receipt holds, with nothing known but the question.
    fn beyond(&self, good: f64) -> Option<f64> {
        let Question { gait, criterion, asked, settings, .. } = *self;
        let at = |distance: f64| {
            let speed = Some(legible(asked + distance, distance > 0.0)).filter(|v| *v > 0.0 && *v != asked)?;
            let found = search(gait, criterion, speed, settings, &|_| {});
            GaitResult::new(gait, criterion, speed, &found, settings, || 0.0).is_optimal().then_some(speed)
        };
        let first = good - asked;
        let mut distances = successors(Some(first), |last| Some(2.0 * last)).take(ATTEMPTS as usize);
        let (mut far, mut answer) = distances.find_map(|distance| Some((distance, at(distance)?)))?;
        if far == first {
            return Some(answer);
        }
        let mut near = 0.5 * far;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            match at(middle) {
                Some(speed) => (far, answer) = (middle, speed),
                None => near = middle,
            }
        }
        Some(answer)
    }
}
