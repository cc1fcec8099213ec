//! Optima over speeds (§6.5): continuation both ways, from the other criterion, and restarts; the
//! greatest speed of a gait and what ends it; where one gait overtakes another.
//!
//! Continuation alone stays in its basin, so every speed also gets starts of its own; and what is
//! found there is carried to the neighbours until nothing improves.

use super::local::{Conflict, Local, descend};
use super::multi_start::{Settings, search_from, start};
use crate::cycle::Cycle;
use crate::model::Gait;
use crate::motion::Criterion;
use crate::result::GaitResult;
use crate::sqp::Control;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Passes over the speeds in which optima spread to their neighbours.
const PASSES: usize = 3;
/// Width to which a greatest speed is bisected, m/s.
const BISECTION: f64 = 2e-3;
/// First step beyond the last speed that works, m/s, and where stepping ends.
const STEP: f64 = 0.1;
const FASTEST: f64 = 10.0;

/// What a sweep tells about its progress, and what it may already know.
pub trait Journal: Sync {
    /// A result of an earlier run.
    fn known(&self, gait: &dyn Gait, criterion: Criterion, speed: f64) -> Option<GaitResult>;
    /// A new or better result.
    fn record(&self, result: &GaitResult);
    /// One of the points of the first pass is done.
    fn advance(&self);
}

/// Optima of one gait at all speeds (ascending), criterion by criterion.
pub fn sweep(
    gait: &dyn Gait,
    criteria: &[Criterion],
    speeds: &[f64],
    settings: &Settings,
    journal: &dyn Journal,
) -> Vec<Vec<GaitResult>> {
    let mut lines: Vec<Vec<GaitResult>> = criteria.iter().map(|_| Vec::new()).collect();
    for (k, &speed) in speeds.iter().enumerate() {
        for (c, &criterion) in criteria.iter().enumerate() {
            let result = journal.known(gait, criterion, speed).unwrap_or_else(|| {
                let started = Instant::now();
                // The speed before, and the other criterion at this one.
                let mut neighbours: Vec<Vec<f64>> = Vec::new();
                neighbours.extend(k.checked_sub(1).and_then(|b| theta(gait, &lines[c][b])));
                neighbours.extend(lines[..c].iter().filter_map(|line| theta(gait, &line[k])));
                let found = search_from(gait, criterion, speed, settings, &neighbours, &|_| {});
                let result =
                    GaitResult::new(gait, criterion, speed, &found, settings.seed, || started.elapsed().as_secs_f64());
                journal.record(&result);
                result
            });
            lines[c].push(result);
            journal.advance();
        }
    }
    for _ in 0..PASSES {
        let mut better = false;
        for k in (0..speeds.len()).rev().chain(0..speeds.len()) {
            for c in 0..criteria.len() {
                better |= spread(gait, &mut lines, c, k, journal);
            }
        }
        if !better {
            break;
        }
    }
    lines
}

/// Tries the optima of the neighbouring speeds and of the other criteria at a point.
fn spread(gait: &dyn Gait, lines: &mut [Vec<GaitResult>], c: usize, k: usize, journal: &dyn Journal) -> bool {
    let mut sources = Vec::new();
    let count = lines[c].len();
    sources.extend(k.checked_sub(1).into_iter().chain((k + 1 < count).then_some(k + 1)).map(|n| (c, n)));
    sources.extend((0..lines.len()).filter(|o| *o != c).map(|o| (o, k)));
    let mut better = false;
    for (line, at) in sources {
        let Some(theta) = theta(gait, &lines[line][at]) else { continue };
        let (criterion, speed) = (lines[c][k].criterion, lines[c][k].speed);
        let local = descend(gait, criterion, speed, &theta, &mut |_| Control::Continue);
        if lines[c][k].improve(gait, &local) {
            journal.record(&lines[c][k]);
            better = true;
        }
    }
    better
}

/// Variables of a result's motion.
fn theta(gait: &dyn Gait, result: &GaitResult) -> Option<Vec<f64>> {
    result.motion().map(|m| Cycle::new(gait, result.criterion, result.speed).theta(&m))
}

/// How fast a gait goes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MaximumSpeed {
    pub gait: String,
    /// The greatest speed with a feasible motion, to 0.002 m/s, as far as local searches can tell.
    pub speed: f64,
    /// What conflicts just above it, weightiest first.
    pub ended_by: Vec<String>,
}

/// Steps beyond the fastest of these results, then bisects.
pub fn maximum_speed(gait: &dyn Gait, results: &[&GaitResult], settings: &Settings) -> Option<MaximumSpeed> {
    let fastest = results.iter().filter(|r| r.is_optimal()).max_by(|a, b| a.speed.total_cmp(&b.speed))?;
    let mut good = fastest.speed;
    let mut from = theta(gait, fastest)?;
    let mut conflicts: Vec<Conflict> = Vec::new();
    let mut bad = None;
    while bad.is_none_or(|b| b - good > BISECTION) {
        let speed = bad.map_or(good + STEP, |b| 0.5 * (good + b));
        if speed > FASTEST {
            return None;
        }
        let local = attempt(gait, speed, Some(&from), settings);
        if local.status.is_optimal() {
            good = speed;
            from = local.theta;
        } else {
            bad = Some(speed);
            conflicts = local.conflicts;
        }
    }
    // What the speed itself and the cycle demand is the question; the answer is what stands against it.
    let structural = ["mean speed", "closure of β", "closure of σ", "touchdown height"];
    conflicts.retain(|c| !structural.contains(&c.label.name.as_str()));
    conflicts.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let ended_by = conflicts.iter().map(|c| format!("{} (half step {})", c.label.name, c.label.half_step)).collect();
    Some(MaximumSpeed { gait: gait.description().gait.into(), speed: good, ended_by })
}

/// A feasible motion at a speed, or the attempt that came closest.
///
/// Feasibility does not depend on the criterion; the smooth one is quicker.
fn attempt(gait: &dyn Gait, speed: f64, from: Option<&[f64]>, settings: &Settings) -> Local {
    let of = |theta: &[f64]| descend(gait, Criterion::Torque, speed, theta, &mut |_| Control::Continue);
    let mut best = from.map(of);
    for k in 0..settings.starts {
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

/// For a speed without a feasible motion the nearest one with one, to 0.002 m/s, as far as local
/// searches can tell. Tries speeds ever further off on both sides, then bisects.
pub fn nearest_speed(gait: &dyn Gait, speed: f64, settings: &Settings) -> Option<f64> {
    let settings = Settings { starts: settings.starts.min(3), ..settings.clone() };
    let feasible = |v: f64| attempt(gait, v, None, &settings).status.is_optimal();
    let (mut slower, mut faster) = (speed, speed);
    for _ in 0..12 {
        for (candidate, last) in [(0.8 * slower, slower), (1.25 * faster, faster)] {
            if candidate > FASTEST || !feasible(candidate) {
                continue;
            }
            let (mut good, mut bad) = (candidate, last);
            while (bad - good).abs() > BISECTION {
                let middle = 0.5 * (good + bad);
                if feasible(middle) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            return Some(good);
        }
        (slower, faster) = (0.8 * slower, 1.25 * faster);
    }
    None
}

/// Where the cheaper of two gaits changes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Crossover {
    pub criterion: Criterion,
    /// Cheaper below and above.
    pub slower: String,
    pub faster: String,
    /// Interpolated between the speeds of the sweep, m/s.
    pub speed: f64,
}

/// Crossovers between two gaits' costs over the same speeds.
pub fn crossovers(a: &[GaitResult], b: &[GaitResult]) -> Vec<Crossover> {
    let gaps: Vec<(f64, f64)> = a.iter().zip(b).filter_map(|(x, y)| Some((x.speed, x.cost? - y.cost?))).collect();
    let (Some(first), Some(second)) = (a.first(), b.first()) else { return Vec::new() };
    let crossing = |w: &[(f64, f64)]| {
        let ((v0, g0), (v1, g1)) = (w[0], w[1]);
        (g0 * g1 < 0.0).then(|| {
            let speed = v0 + (v1 - v0) * g0 / (g0 - g1);
            let (slower, faster) = if g0 < 0.0 { (first, second) } else { (second, first) };
            Crossover { criterion: first.criterion, slower: slower.gait.clone(), faster: faster.gait.clone(), speed }
        })
    };
    gaps.windows(2).filter_map(crossing).collect()
}
