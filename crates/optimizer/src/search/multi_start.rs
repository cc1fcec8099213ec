//! Many starts, all local optima: in parallel, with the same result for any number of threads.

use super::evidence::{Effort, LEAST};
use super::feasible::motions;
use super::guess::{Plan, walk};
use super::local::{Local, Task};
use super::watch::{Event, Watch, ended};
use crate::cycle::{Cycle, apart, scale, theta};
use crate::examine::Examination;
use piaffe_model::Gait;
use piaffe_model::motion::Criterion;
use piaffe_sqp::{Iteration, Problem, Values};
use rayon::prelude::*;

/// Costs within this share of each other belong to one optimum, if the motions agree too.
const SAME_COST: f64 = 1e-5;

/// Starts that run side by side, at least and at most; what they found decides whether more do.
const BATCH: usize = 8;
const WIDEST: usize = 16;

/// As many at first where they only confirm an optimum that neighbours let expect, and how many of them must end in one; or, of as many as a
/// search takes at least, in the best of several.
const CONFIRMING: usize = 4;
const AGREEING: usize = 3;
/// As many where neighbours let expect that there is no motion.
const IN_VAIN: usize = 2;

/// A motion that costs less by this share than the best optimum is told.
const CHEAPER: f64 = 1e-3;
/// So many descents that got lost below the best optimum are followed up.
const REPAIRED: usize = 4;

/// Walks drawn for each random start of the first batch, and at most for one of the later ones.
const DRAWS: usize = 3;
const MOST_DRAWS: usize = 8;

/// And so many where the dynamics admit none of them.
const DRAWS_IN_VAIN: usize = 64;

/// Violation (scaled, summed) of a walk beyond which its descent takes long and seldom ends in an optimum.
const HOPELESS: f64 = 300.0;

/// Starts after which a search ends whatever it has found.
const MOST: usize = 64;

/// After the first batch, every start of this many begins near the best optimum so far.
const HOP: usize = 4;

/// How widely to search, and how closely to look at what is found.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Number of starts, the first of which is the default walk; by default as many as the evidence asks for.
    pub starts: Option<usize>,
    /// Of the random starts.
    pub seed: u64,
    pub examination: Examination,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { starts: None, seed: 1, examination: Examination::default() }
    }
}

/// What the answers to neighbouring problems let expect of this one: agreement with them is evidence too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    Nothing,
    /// The optimum to which theirs lead, which so wide searches have found.
    Theirs(Effort),
    /// No motion, as with one of them.
    NoMotion,
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Found {
    /// Distinct local optima, best first.
    pub optima: Vec<Optimum>,
    /// Of the starts without an optimum, the one that came closest: its conflicts explain why.
    pub failure: Option<Local>,
    /// The cheapest motion within all limits that is known, where no optimum is as cheap.
    pub motion: Option<Local>,
    pub effort: Effort,
}

/// A local optimum and how many starts that knew of none led to it.
#[derive(Clone, Debug)]
pub struct Optimum {
    pub local: Local,
    pub reached: usize,
}

/// Where a start ended.
struct End {
    local: Local,
    /// Whether the start was from or near a motion that was known.
    informed: bool,
}

/// Searches from several starts. `done(k)` is told when start `k` has ended.
pub fn search(
    gait: &dyn Gait,
    criterion: Criterion,
    speed: f64,
    settings: &Settings,
    done: &(dyn Fn(usize) + Sync),
) -> Found {
    search_from(&Task { gait, criterion, speed }, settings, &[], Expected::Nothing, done)
}

/// The same, with further starts before those of the settings: optima of neighbouring problems, say. Where the settings leave the
/// number of starts open, fewer of them confirm what is `expected` than answer without it.
pub fn search_from(
    task: &Task,
    settings: &Settings,
    neighbours: &[Vec<f64>],
    expected: Expected,
    done: &(dyn Fn(usize) + Sync),
) -> Found {
    search_watched(task, settings, neighbours, expected, &ended(done))
}

/// The same, for who wants to know more of it or may end it.
pub fn search_watched(
    task: &Task,
    settings: &Settings,
    neighbours: &[Vec<f64>],
    expected: Expected,
    watch: Watch,
) -> Found {
    let criterion = task.criterion;
    if !task.gait.description().contradictions().is_empty() {
        // No start leads anywhere: that is known without one.
        return collect(task, &[]);
    }
    let follow = |theta: &Vec<f64>| End { local: task.follow(theta, &mut |_| watch(Event::Iterate)), informed: true };
    let run = |k: usize, best: Option<&Optimum>| {
        let end = begin(task, settings.seed, k, best, watch);
        watch(Event::Ended(k));
        end
    };
    let most = settings.starts.unwrap_or(MOST).max(1);
    let mut next = most.min(match expected {
        Expected::Theirs(_) if settings.starts.is_none() => CONFIRMING,
        Expected::NoMotion if settings.starts.is_none() => IN_VAIN,
        _ => BATCH,
    });
    let mut ends: Vec<End> =
        neighbours.par_iter().map(follow).chain((0..next).into_par_iter().map(|k| run(k, None))).collect();
    let mut found = collect(task, &ends);
    while next < most {
        let confirmed = || is_confirmed(task, expected, &found, &ends[..neighbours.len()]);
        if settings.starts.is_none() && (found.effort.is_enough() || confirmed()) {
            break;
        }
        // Side by side as many as are needed in any case.
        let batch = next..most.min(next + found.effort.missing().clamp(BATCH, WIDEST));
        next = batch.end;
        ends.par_extend(batch.into_par_iter().map(|k| run(k, found.optima.first())));
        found = collect(task, &ends);
    }
    let cheapest = |a: &Local, b: &Local| a.costs.of(criterion).total_cmp(&b.costs.of(criterion));
    if found.optima.is_empty() {
        // Descents may fail where there are motions: from these they have no limit to find their way to.
        let known = motions(task, settings.seed, found.effort.starts, neighbours, watch);
        let thetas: Vec<Vec<f64>> = known.iter().map(|local| local.theta.clone()).collect();
        ends.par_extend(thetas.par_iter().map(follow));
        found = collect(task, &ends);
        // Where there are motions there is an optimum: other starts may lead to it.
        while found.optima.is_empty() && !known.is_empty() && settings.starts.is_none() && next < most {
            let batch = next..most.min(next + WIDEST);
            next = batch.end;
            ends.par_extend(batch.into_par_iter().map(|k| run(k, None)));
            found = collect(task, &ends);
        }
        if found.optima.is_empty() {
            // Where a descent got lost is a motion by its own account only.
            let lost = || ends.iter().map(|e| e.local.clone()).filter(Local::is_motion).min_by(cheapest);
            found.motion = known.into_iter().min_by(cheapest).or_else(lost);
            return found;
        }
    }
    // Where descents got lost may be cheaper than where others arrived: then there is a better optimum, or none that smooth steps find.
    let Some(best) = found.optima.first().map(|best| best.local.costs.of(criterion)) else { return found };
    let cheaper_than = |best: f64| move |local: &Local| local.costs.of(criterion) < (1.0 - CHEAPER) * best;
    let cheaper = cheaper_than(best);
    let mut lost: Vec<&Local> = ends.iter().map(|end| &end.local).filter(|local| !local.status.is_optimal()).collect();
    lost.retain(|local| local.keeps_to_limits() && cheaper(local));
    lost.sort_by(|a, b| cheapest(a, b));
    lost.truncate(REPAIRED);
    let repaired = lost.par_iter().map(|local| task.nearest_motion(&local.theta, &mut |_| watch(Event::Iterate)));
    let repaired: Vec<Local> = repaired.filter(|local| local.is_motion() && cheaper(local)).collect();
    ends.par_extend(repaired.par_iter().map(|local| follow(&local.theta)));
    let mut found = collect(task, &ends);
    let best = found.optima.first().map_or(best, |best| best.local.costs.of(criterion));
    found.motion = repaired.into_iter().filter(cheaper_than(best)).min_by(cheapest);
    found
}

/// Whether a few starts of its own have confirmed what was expected of a search; `carried` are the ends of what neighbours gave.
fn is_confirmed(task: &Task, expected: Expected, so_far: &Found, carried: &[End]) -> bool {
    let Effort { starts, successes, .. } = so_far.effort;
    match expected {
        Expected::Nothing => false,
        Expected::NoMotion => starts >= IN_VAIN && so_far.optima.is_empty(),
        Expected::Theirs(looked) => {
            let Some(best) = so_far.optima.first() else { return false };
            let optima = so_far.optima.len();
            let theirs = carried.iter().any(|end| end.local.status.is_optimal() && same(task, &end.local, &best.local));
            // Where there are several optima, a few starts do not tell which is the best; with those of the neighbours they may, if
            // these have as many.
            let settled = optima == 1 || (optima <= looked.optima && so_far.effort.with(looked).is_enough());
            let few = starts >= CONFIRMING && successes >= AGREEING && theirs && settled;
            // What so many starts have found again and again is not passed by: what is found at other speeds comes here too.
            let some = starts >= LEAST && best.reached >= AGREEING;
            few || some
        }
    }
}

/// The k-th start of a seed, and where it leads.
fn begin(task: &Task, seed: u64, k: usize, best: Option<&Optimum>, watch: Watch) -> End {
    let observe = &mut |_: &Iteration| watch(Event::Iterate);
    if let (Some(best), 0) = (best, k % HOP) {
        return End { local: task.descend(&hop(task, seed, k, &best.local.theta), observe), informed: true };
    }
    let theta = start(task.gait, task.criterion, task.speed, seed, k);
    End { local: descend(task, &theta, k, watch), informed: false }
}

/// Where the k-th start leads. Every second one plunges: what is found must not depend on one way of beginning.
pub fn descend(task: &Task, theta: &[f64], k: usize, watch: Watch) -> Local {
    let way = if k % 2 == 1 { Task::plunge } else { Task::descend };
    way(task, theta, &mut |_: &Iteration| watch(Event::Iterate))
}

/// The k-th start of a seed: the default walk, then random ones.
pub fn start(gait: &dyn Gait, criterion: Criterion, speed: f64, seed: u64, k: usize) -> Vec<f64> {
    if k == 0 {
        return theta(&walk(gait, &Plan::default_for(gait.description()), speed));
    }
    let mut rng = stream(seed, k);
    let mut cycle = Cycle::new(gait, criterion, speed);
    let mut values = Values::zeros(cycle.equalities(), cycle.inequalities());
    let mut draw = || {
        let theta = theta(&walk(gait, &Plan::random(gait, &mut rng), speed));
        let violation = cycle.evaluate(&theta, &mut values).map_or(f64::INFINITY, |()| values.violation());
        (violation, theta)
    };
    // Of a few walks, the one that comes closest to satisfying the constraints is the safest start. But the safest lead to the
    // same few optima, so later starts take what comes, unless it is hopeless.
    let (draws, good) = if k < BATCH { (DRAWS, 0.0) } else { (MOST_DRAWS, HOPELESS) };
    let mut best = draw();
    for drawn in 1.. {
        let enough = drawn >= draws && best.0.is_finite();
        if best.0 <= good || enough || drawn == DRAWS_IN_VAIN {
            break;
        }
        let other = draw();
        if other.0 < best.0 {
            best = other;
        }
    }
    best.1
}

/// A random motion near `theta`: every variable moves by up to its natural size.
fn hop(task: &Task, seed: u64, k: usize, theta: &[f64]) -> Vec<f64> {
    let mut rng = stream(seed, k);
    theta.iter().zip(scale(task.gait.description())).map(|(x, scale)| x + scale * (2.0 * rng.f64() - 1.0)).collect()
}

/// Random numbers of the k-th start.
fn stream(seed: u64, k: usize) -> fastrand::Rng {
    // Streams of neighbouring seeds must not overlap: mix seed and number.
    fastrand::Rng::with_seed(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ k as u64)
}

fn collect(task: &Task, ends: &[End]) -> Found {
    let criterion = task.criterion;
    let (mut good, mut bad): (Vec<&End>, Vec<&End>) = ends.iter().partition(|e| e.local.status.is_optimal());
    // Stable sorts: ties keep the order of the starts.
    good.sort_by(|a, b| a.local.costs.of(criterion).total_cmp(&b.local.costs.of(criterion)));
    // A proof of infeasibility explains more than a search that got lost.
    let unproven = |e: &End| e.local.conflicts.is_empty();
    bad.sort_by(|a, b| unproven(a).cmp(&unproven(b)).then(a.local.kkt.violation.total_cmp(&b.local.kkt.violation)));
    let mut optima: Vec<Optimum> = Vec::new();
    for End { local, informed } in good {
        let reached = usize::from(!informed);
        match optima.iter_mut().find(|o| same(task, &o.local, local)) {
            Some(known) => known.reached += reached,
            None => optima.push(Optimum { local: local.clone(), reached }),
        }
    }
    let starts = ends.iter().filter(|e| !e.informed).count();
    let successes = optima.iter().map(|o| o.reached).sum();
    let effort = Effort { starts, successes, informed: ends.len() - starts, optima: optima.len() };
    Found { optima, failure: bad.first().map(|e| e.local.clone()), motion: None, effort }
}

/// How near two motions of one optimum are, in natural sizes of the variables.
const SAME_MOTION: f64 = 0.2;

/// Whether both are one optimum.
fn same(task: &Task, a: &Local, b: &Local) -> bool {
    let (ca, cb) = (a.costs.of(task.criterion), b.costs.of(task.criterion));
    (ca - cb).abs() <= SAME_COST * ca.abs().max(cb.abs())
        && apart(task.gait.description(), &a.theta, &b.theta) < SAME_MOTION
}
