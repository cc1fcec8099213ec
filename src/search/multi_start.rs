//! Many starts, all local optima: in parallel, with the same result for any number of threads.

use super::guess::{Plan, walk};
use super::local::{Local, Task};
use crate::cycle::Cycle;
use crate::model::Gait;
use crate::motion::Criterion;
use crate::sqp::{Control, Problem, Values};
use rayon::prelude::*;

/// Costs within this share of each other belong to one optimum, if the motions agree too.
const SAME_COST: f64 = 1e-5;

/// Walks drawn for each random start.
const DRAWS: usize = 6;

/// How widely to search.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Number of starts; the first is the default walk.
    pub starts: usize,
    /// Of the random starts.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { starts: 8, seed: 1 }
    }
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Found {
    /// Distinct local optima, best first.
    pub optima: Vec<Optimum>,
    /// Of the starts without an optimum, the one that came closest: its conflicts explain why.
    pub failure: Option<Local>,
    pub starts: usize,
}

/// A local optimum and how often it was reached.
#[derive(Clone, Debug)]
pub struct Optimum {
    pub local: Local,
    pub reached: usize,
}

/// Searches from several starts. `done(k)` is told when start `k` has ended.
pub fn search(
    gait: &dyn Gait,
    criterion: Criterion,
    speed: f64,
    settings: &Settings,
    done: &(dyn Fn(usize) + Sync),
) -> Found {
    search_from(gait, criterion, speed, settings, &[], done)
}

/// The same, with further starts before those of the settings: optima of neighbouring problems, say.
pub fn search_from(
    gait: &dyn Gait,
    criterion: Criterion,
    speed: f64,
    settings: &Settings,
    neighbours: &[Vec<f64>],
    done: &(dyn Fn(usize) + Sync),
) -> Found {
    let task = Task { gait, criterion, speed };
    let locals: Vec<Local> = (0..neighbours.len() + settings.starts.max(1))
        .into_par_iter()
        .map(|k| {
            let local = match neighbours.get(k) {
                Some(theta) => task.follow(theta, &mut |_| Control::Continue),
                None => {
                    // Every second start plunges: what is found must not depend on one way of beginning.
                    let k = k - neighbours.len();
                    let theta = start(gait, criterion, speed, settings.seed, k);
                    let way = if k % 2 == 1 { Task::plunge } else { Task::descend };
                    way(&task, &theta, &mut |_| Control::Continue)
                }
            };
            done(k);
            local
        })
        .collect();
    collect(criterion, locals)
}

/// The k-th start of a seed: the default walk, then random ones.
pub fn start(gait: &dyn Gait, criterion: Criterion, speed: f64, seed: u64, k: usize) -> Vec<f64> {
    let d = gait.description();
    let mut cycle = Cycle::new(gait, criterion, speed);
    if k == 0 {
        return cycle.theta(&walk(gait, &Plan::default_for(d), speed));
    }
    // Streams of neighbouring seeds must not overlap: mix seed and number.
    let mut rng = fastrand::Rng::with_seed(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ k as u64);
    // Drawing is cheap beside descending: of a few walks, the one that comes closest to satisfying the constraints.
    let mut values = Values::zeros(cycle.equalities(), cycle.inequalities());
    let drawn = (0..DRAWS).map(|_| {
        let theta = cycle.theta(&walk(gait, &Plan::random(d, &mut rng), speed));
        let violation = cycle.evaluate(&theta, &mut values).map_or(f64::INFINITY, |()| values.violation());
        (violation, theta)
    });
    drawn.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Vec::new, |(_, theta)| theta)
}

fn collect(criterion: Criterion, locals: Vec<Local>) -> Found {
    let starts = locals.len();
    let (mut good, mut bad): (Vec<Local>, Vec<Local>) = locals.into_iter().partition(|l| l.status.is_optimal());
    // Stable sorts: ties keep the order of the starts.
    good.sort_by(|a, b| a.costs.of(criterion).total_cmp(&b.costs.of(criterion)));
    // A proof of infeasibility explains more than a search that got lost.
    let unproven = |l: &Local| l.conflicts.is_empty();
    bad.sort_by(|a, b| unproven(a).cmp(&unproven(b)).then(a.kkt.violation.total_cmp(&b.kkt.violation)));
    let mut optima: Vec<Optimum> = Vec::new();
    for local in good {
        match optima.iter_mut().find(|o| same(criterion, &o.local, &local)) {
            Some(known) => known.reached += 1,
            None => optima.push(Optimum { local, reached: 1 }),
        }
    }
    Found { optima, failure: bad.into_iter().next(), starts }
}

fn same(criterion: Criterion, a: &Local, b: &Local) -> bool {
    let (ca, cb) = (a.costs.of(criterion), b.costs.of(criterion));
    let apart = a.theta.iter().zip(&b.theta).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    (ca - cb).abs() <= SAME_COST * ca.abs().max(cb.abs()) && apart < 0.5
}
