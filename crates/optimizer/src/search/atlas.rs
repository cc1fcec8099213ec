//! Optima over speeds (§6.5): continuation both ways, from the other criterion, and restarts.
//!
//! Continuation alone stays in its basin, so every speed also gets starts of its own; and what is
//! found there is carried to the neighbours until nothing improves, and to gaits that differ in their flights alone. To a speed
//! without an optimum those of all criteria are carried, from the speeds on both sides and by small steps.

use super::evidence::Effort;
use super::journal::{Journal, common, step};
use super::local::{Local, Task};
use super::multi_start::{Expected, Settings, search_from};
use super::relative::related;
use crate::cycle::theta;
use crate::result::{GaitResult, Status};
use piaffe_model::motion::Criterion;
use piaffe_model::units::Units;
use piaffe_model::{Description, Gait};
use piaffe_sqp::Control;
use std::collections::HashSet;
use std::time::Instant;

/// Rounds, each down and up the speeds, in which optima are carried to their neighbours.
const ROUNDS: usize = 4;

/// Shortest step towards a speed without an optimum, as a share of the way.
const SHORTEST: f64 = 0.1;

/// How often a point is visited at least: once to search, twice to carry optima to it.
pub const VISITS: u64 = 3;

/// Where a sweep begins, in the robot's unit of speed: motions are many there and optima few, and they lead on to both sides.
const BEGINNING: f64 = 0.25;

/// Optima of one gait at all speeds (ascending), criterion by criterion.
///
/// Each speed comes after its neighbour towards the beginning, and at each speed the smooth criterion comes first: whether there are motions
/// does not depend on the criterion, and by that one it is soon told.
pub fn sweep(
    gait: &dyn Gait,
    criteria: &[Criterion],
    speeds: &[f64],
    settings: &Settings,
    journal: &dyn Journal,
) -> Vec<Vec<GaitResult>> {
    let mut found: Vec<Vec<Option<GaitResult>>> = vec![vec![None; speeds.len()]; criteria.len()];
    let mut order: Vec<usize> = (0..criteria.len()).collect();
    order.sort_by_key(|c| criteria[*c] != Criterion::Torque);
    for (k, way) in outwards(gait.description(), speeds) {
        for (place, &c) in order.iter().enumerate() {
            let task = Task { gait, criterion: criteria[c], speed: speeds[k] };
            let near = way.first().and_then(|before| found[c][*before].as_ref());
            let others = || order[..place].iter().filter_map(|other| found[*other][k].as_ref());
            let neighbours: Vec<Vec<f64>> = near.into_iter().chain(others()).filter_map(GaitResult::theta).collect();
            let no_motion = |r: &GaitResult| r.status == Status::Infeasible;
            let expected = match near {
                _ if others().any(no_motion) => Expected::NoMotion,
                Some(near) if no_motion(near) => Expected::NoMotion,
                Some(near) if near.is_optimal() => {
                    Expected::Theirs(looked(way.iter().filter_map(|k| found[c][*k].as_ref())))
                }
                _ => Expected::Nothing,
            };
            let (result, fresh) = search_at(&task, settings, &neighbours, expected, journal);
            if fresh {
                journal.point(&result);
            }
            found[c][k] = Some(result);
            journal.visited(gait, fresh);
        }
    }
    let mut lines: Vec<Vec<GaitResult>> = found.into_iter().map(|line| line.into_iter().flatten().collect()).collect();
    carry_on(gait, &mut lines, settings, journal);
    lines
}

/// The speeds (ascending) from where a sweep begins upwards, then downwards; each with those between it and the beginning, the nearest
/// first.
fn outwards(d: &Description, speeds: &[f64]) -> impl Iterator<Item = (usize, Vec<usize>)> {
    let beginning = BEGINNING * Units::new(d).speed();
    let count = speeds.len();
    let first = speeds.partition_point(|speed| *speed < beginning).min(count.saturating_sub(1));
    let up = (first..count).map(move |k| (k, (first..k).rev().collect()));
    let down = (0..first).rev().map(move |k| (k, (k + 1..=first).collect()));
    up.chain(down)
}

/// Speeds before one whose searches count as evidence for it.
const NEAR: usize = 3;

/// How widely was searched at the nearest of these speeds, as far as there are optima without a gap.
pub(super) fn looked<'r>(nearest_first: impl Iterator<Item = &'r GaitResult>) -> Effort {
    let near = nearest_first.take(NEAR).take_while(|result| result.is_optimal());
    near.fold(Effort::default(), |sum, result| sum.with(result.search.effort))
}

/// What has been brought where, bit by bit: to which point (criterion, speed), whether it had an optimum by then, and from which variables.
/// A second time would lead to the same.
type Brought = HashSet<([usize; 2], bool, Vec<u64>)>;

/// Carries optima to their neighbours until nothing improves.
fn carry_on(gait: &dyn Gait, lines: &mut [Vec<GaitResult>], settings: &Settings, journal: &dyn Journal) {
    let speeds = lines.first().map_or(0, Vec::len);
    let mut brought = Brought::new();
    for round in 0..ROUNDS {
        let mut better = false;
        for k in (0..speeds).rev().chain(0..speeds) {
            for c in 0..lines.len() {
                let (improved, fresh) = carry(gait, lines, [c, k], &mut brought, settings, journal);
                better |= improved;
                if round == 0 {
                    journal.visited(gait, fresh);
                }
            }
        }
        if !better {
            break;
        }
    }
}

/// A gait's optima, criterion by criterion, at the same speeds as those of others.
pub struct Line<'g> {
    pub gait: &'g dyn Gait,
    pub results: Vec<Vec<GaitResult>>,
}

/// Gives the optima of each gait to those that differ from it in their flights alone, and on to their neighbours.
pub fn share(lines: &mut [Line], settings: &Settings, journal: &dyn Journal) {
    for to in 0..lines.len() {
        let mut better = false;
        for from in (0..lines.len()).filter(|from| *from != to) {
            let known = std::mem::take(&mut lines[from].results);
            let of = lines[from].gait.description();
            better |= take_over(&mut lines[to], of, &known, settings, journal);
            lines[from].results = known;
        }
        if better {
            let Line { gait, results } = &mut lines[to];
            carry_on(*gait, results, settings, journal);
        }
    }
}

/// Starts from the optima of a relative at the same speeds; tells whether any point became better.
fn take_over(
    line: &mut Line,
    of: &Description,
    known: &[Vec<GaitResult>],
    settings: &Settings,
    journal: &dyn Journal,
) -> bool {
    let gait = line.gait;
    let mut better = false;
    for (point, known) in line.results.iter_mut().flatten().zip(known.iter().flatten()) {
        let motion = known.motion().and_then(|motion| related(of, &motion, gait.description()));
        let Some(theta) = motion.as_ref().map(theta) else { continue };
        better |= bring(gait, point, known.speed, &theta, settings, journal).0;
    }
    better
}

/// Searches at one speed, from these neighbours too; tells whether the result is new to the journal.
pub fn search_at(
    task: &Task,
    settings: &Settings,
    neighbours: &[Vec<f64>],
    expected: Expected,
    journal: &dyn Journal,
) -> (GaitResult, bool) {
    let Task { gait, criterion, speed } = *task;
    let name = format!("{} {} {speed} searched", gait.description().key, criterion.name());
    step(journal, &name, &(common(gait, settings), neighbours, expected), || {
        let started = Instant::now();
        let found = search_from(task, settings, neighbours, expected, &|_| {});
        GaitResult::new(gait, criterion, speed, &found, settings, || started.elapsed().as_secs_f64())
    })
}

/// Carries the optima of the neighbouring speeds and of the other criteria to a point; tells whether it
/// became better, and whether that was new to the journal.
fn carry(
    gait: &dyn Gait,
    lines: &mut [Vec<GaitResult>],
    [c, k]: [usize; 2],
    brought: &mut Brought,
    settings: &Settings,
    journal: &dyn Journal,
) -> (bool, bool) {
    let count = lines[c].len();
    // To a speed without an optimum those of all criteria are carried; further ones come by way of its neighbours.
    let next_door = || k.checked_sub(1).into_iter().chain((k + 1 < count).then_some(k + 1));
    let wanted = |line: &usize| *line == c || !lines[c][k].is_optimal();
    let mut sources: Vec<(usize, usize)> = Vec::new();
    for line in (c..lines.len()).chain(0..c).filter(wanted) {
        sources.extend(next_door().map(|at| (line, at)));
    }
    sources.extend((0..lines.len()).filter(|other| *other != c).map(|other| (other, k)));
    let (mut better, mut any_fresh) = (false, false);
    for (line, at) in sources {
        let Some(theta) = lines[line][at].theta() else { continue };
        if !brought.insert(([c, k], lines[c][k].is_optimal(), theta.iter().map(|x| x.to_bits()).collect())) {
            continue;
        }
        let from = lines[line][at].speed;
        let (improved, fresh) = bring(gait, &mut lines[c][k], from, &theta, settings, journal);
        better |= improved;
        any_fresh |= fresh;
    }
    (better, any_fresh)
}

/// Brings an optimum of a neighbouring problem, at the speed `from`, to a point; tells whether the point became better, and whether
/// that was new to the journal.
fn bring(
    gait: &dyn Gait,
    point: &mut GaitResult,
    from: f64,
    theta: &[f64],
    settings: &Settings,
    journal: &dyn Journal,
) -> (bool, bool) {
    let task = Task { gait, criterion: point.criterion, speed: point.speed };
    let name = format!("{} {} {} carried to", gait.description().key, task.criterion.name(), task.speed);
    let inputs = (common(gait, settings), &point.local_optima, theta);
    let (changed, fresh) = step(journal, &name, &inputs, || {
        let local = match point.is_optimal() {
            true => task.follow(theta, &mut |_| Control::Continue),
            false => walk(&task, from, theta),
        };
        let mut result = point.clone();
        result.join(gait, &local, settings.examination).then_some(result)
    });
    let Some(changed) = changed else { return (false, fresh) };
    if fresh {
        journal.point(&changed);
    }
    let better = changed.cost != point.cost;
    *point = changed;
    (better, fresh)
}

/// From the optimum of a neighbouring problem, at this or another speed, to that of the task, by steps of the speed that lead from optimum to
/// optimum.
fn walk(task: &Task, mut from: f64, theta: &[f64]) -> Local {
    let (whole, mut theta) = (task.speed - from, theta.to_vec());
    let mut step = whole;
    loop {
        let last = step.abs() >= (task.speed - from).abs();
        let speed = if last { task.speed } else { from + step };
        let local = Task { speed, ..*task }.follow(&theta, &mut |_| Control::Continue);
        if local.status.is_optimal() && !last {
            (from, theta) = (speed, local.theta);
            continue;
        }
        step *= 0.5;
        if local.status.is_optimal() || step.abs() <= SHORTEST * whole.abs() {
            return local;
        }
    }
}
