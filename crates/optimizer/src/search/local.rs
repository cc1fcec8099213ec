//! One local optimum: from a start to a motion that satisfies every constraint between nodes too.

use super::nearest::{nearest, reach};
use super::refine::dips;
use crate::cycle::{AT_REST, Cycle, Halt, Label, Still, elements};
use crate::flow::Undefined;
use piaffe_model::Gait;
use piaffe_model::motion::{Costs, Criterion, Motion};
use piaffe_sqp as sqp;
use piaffe_sqp::{Control, KktResidual, Options, Solution, Status, multipliers};

/// Violation (scaled) that is none.
const FEASIBILITY: f64 = 1e-8;
/// Violation between nodes (scaled) at which refinement stops.
const DENSE: f64 = 1e-7;
/// Change of an active row between nodes at which it does (see `look`).
const SETTLED: f64 = 1e-8;
/// Violation (scaled) on a mesh twice as fine at which a mesh does not resolve the limits: where β is right at the ends of elements
/// it may not be within.
const UNRESOLVED: f64 = 5e-7;
/// Share of the tolerance that is asked for once rows between nodes are known.
const FIRM: f64 = 1e-2;
/// Rounds after which a mesh must do on which they go on changing.
const PATIENCE: usize = 5;
const ROUNDS: usize = 20;
/// Iterations after which a descent has got lost.
const ITERATIONS: usize = 400;

/// What is asked for: the cheapest motion of a gait at a mean speed (m/s).
#[derive(Clone, Copy)]
pub struct Task<'a> {
    pub gait: &'a dyn Gait,
    pub criterion: Criterion,
    pub speed: f64,
}

/// Where a descent ended.
#[derive(Clone, Debug)]
pub struct Local {
    pub status: Status,
    pub theta: Vec<f64>,
    pub motion: Motion,
    pub costs: Costs,
    pub kkt: KktResidual,
    /// Largest violation (scaled) on the optimizer's own fine grid.
    pub violation: f64,
    pub iterations: usize,
    /// With `Status::Infeasible`: what contradicts what, worst first.
    pub conflicts: Vec<Conflict>,
}

impl Local {
    /// Whether there is nothing left to try.
    fn is_settled(&self) -> bool {
        matches!(self.status, Status::Optimal | Status::Stopped)
    }

    /// Whether it keeps to all limits, optimum or not.
    pub fn is_motion(&self) -> bool {
        self.keeps_to_limits() && self.violation <= DENSE
    }

    /// The same at the instants of its descent, not between them.
    pub fn keeps_to_limits(&self) -> bool {
        self.kkt.violation <= FEASIBILITY
    }
}

/// A constraint that takes part in a contradiction.
#[derive(Clone, Debug)]
pub struct Conflict {
    pub label: Label,
    /// By how much it is violated (scaled); 0 for one that holds but is in the way of others.
    pub violation: f64,
    /// Its weight in the proof that the violation cannot be reduced.
    pub weight: f64,
}

/// The kinks of |power| are rounded off first, by this much in the robot's unit of power: far from the
/// optimum a kink tells a step more than is true.
const SMOOTHING: f64 = 0.028;

/// Iterations that a descent gets among kinks as they are, where it may creep from one to the next.
const AMONG_KINKS: usize = 60;
/// After these they are rounded off once more, by less and less of what they were at first: from the optimum with the last of these
/// it is not far to that with kinks.
const LESS_AND_LESS: [f64; 3] = [0.2, 0.04, 0.008];

/// Largest component of the first step from what is nearly an optimum, in natural sizes of the variables.
const CAUTION: f64 = 0.05;

/// Joints slower than this, in parts of the fastest joint's rate, may be about to come to rest, where the criterion has kinks.
const SLOW: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// Options of the solver for a problem of this kind.
pub fn options(cycle: &Cycle) -> Options {
    Options {
        tolerance: 1e-6,
        feasibility: FEASIBILITY,
        iteration_limit: ITERATIONS,
        step_limit: 1.0,
        estimate_multipliers: true,
        scale: Some(cycle.scale()),
        ..Options::default()
    }
}

/// Options of the solver where an approximate solution will do.
fn rough(options: &Options) -> Options {
    Options { tolerance: 5e-2, feasibility: 1e-3, ..options.clone() }
}

/// Options of the solver where kinks are rounded off more sharply than at first.
fn rounded(options: &Options) -> Options {
    Options { tolerance: 5e-4, feasibility: 1e-5, iteration_limit: 150, ..options.clone() }
}

/// Called at every iteration; can stop the search.
type Observer<'o> = &'o mut dyn FnMut(&sqp::Iteration) -> Control;

impl Task<'_> {
    /// Minimizes from `start`, which may be far from any motion: the nearest motion first, then an approximate optimum on
    /// a coarse mesh, then the optimum.
    pub fn descend(&self, start: &[f64], observe: Observer) -> Local {
        let mut cycle = self.coarse();
        let options = options(&cycle);
        let nearest = nearest(&mut cycle, start, &options, observe);
        let local = self.approach(cycle, &nearest.x, &options, observe);
        Local { iterations: nearest.iterations + local.iterations, ..local }
    }

    /// Minimizes from `start` at once and with steps of any length. It gets lost more often than [`Task::descend`], and ends
    /// in optima that [`Task::descend`] never sees.
    pub fn plunge(&self, start: &[f64], observe: Observer) -> Local {
        let cycle = self.cycle();
        let options = Options { step_limit: f64::INFINITY, ..options(&cycle) };
        self.approach(cycle, start, &options, observe)
    }

    /// Minimizes from the optimum of a neighbouring problem: directly, or as from anywhere if that leads nowhere.
    pub fn follow(&self, start: &[f64], observe: Observer) -> Local {
        let local = self.carry(start, observe);
        if local.is_settled() {
            return local;
        }
        self.descend(start, observe)
    }

    /// Minimizes directly from the optimum of a neighbouring problem, and from nowhere else if that leads nowhere.
    pub fn carry(&self, start: &[f64], observe: Observer) -> Local {
        self.polish(start, observe)
    }

    /// The motion nearest to `start` that keeps to all limits, whatever it costs.
    pub fn nearest_motion(&self, start: &[f64], observe: Observer) -> Local {
        let mut cycle = self.cycle();
        let options = options(&cycle);
        let found = between_nodes(&mut cycle, start, |cycle, theta, _| reach(cycle, theta, &options, observe));
        finish(&mut cycle, found.solution, found.violation).local
    }

    fn cycle(&self) -> Cycle<'_> {
        Cycle::new(self.gait, self.criterion, self.speed)
    }

    /// On few elements, which do where it is not about the last digits.
    fn coarse(&self) -> Cycle<'_> {
        Cycle::with_elements(self.gait, self.criterion, self.speed, elements(self.gait.description()) / 2)
    }

    /// An approximate optimum of `cycle`, then the optimum.
    fn approach(&self, mut cycle: Cycle, start: &[f64], options: &Options, observe: Observer) -> Local {
        if self.criterion == Criterion::Energy {
            cycle.smoothing = SMOOTHING;
        }
        let solution = sqp::minimize(&mut cycle, start, &rough(options), observe);
        let local = self.polish(&solution.x, observe);
        Local { iterations: solution.iterations + local.iterations, ..local }
    }

    /// The optimum near `start`. Where smooth steps lead to none, joints may have to be held still.
    fn polish(&self, start: &[f64], observe: Observer) -> Local {
        // What already holds joints still is an optimum of a neighbouring problem, or near one.
        let mut held = self.slow(start, AT_REST);
        let mut iterations = 0;
        if !held.is_empty() {
            let local = self.rest(start, held.clone(), observe);
            if local.is_settled() {
                return local;
            }
            iterations += local.iterations;
        }
        let mut free = self.free(start, observe);
        iterations += free.iterations;
        let theta = free.theta.clone();
        for share in SLOW {
            if free.is_settled() {
                break;
            }
            let slow = self.slow(&theta, share);
            if slow.is_empty() || slow == held {
                continue;
            }
            held = slow;
            let local = self.rest(&theta, held.clone(), observe);
            iterations += local.iterations;
            if local.is_settled() {
                free = local;
            }
        }
        if !free.is_settled() {
            let local = self.halting(&free.theta, observe);
            iterations += local.as_ref().map_or(0, |local| local.iterations);
            free = local.filter(Local::is_settled).unwrap_or(free);
        }
        Local { iterations, ..free }
    }

    /// The optimum near `start` with no joint held, however many kinks are on the way.
    fn free(&self, start: &[f64], observe: Observer) -> Local {
        if self.criterion != Criterion::Energy {
            return self.solve(start, &Way::FREE, observe).local;
        }
        let local = self.solve(start, &Way { iteration_limit: AMONG_KINKS, ..Way::FREE }, observe).local;
        if local.status != Status::IterationLimit {
            return local;
        }
        let (mut theta, mut iterations) = (local.theta, local.iterations);
        let mut cycle = self.cycle();
        let options = rounded(&options(&cycle));
        for share in LESS_AND_LESS {
            cycle.smoothing = share * SMOOTHING;
            let solution = sqp::minimize(&mut cycle, &theta, &options, observe);
            iterations += solution.iterations;
            theta = solution.x;
        }
        let local = self.solve(&theta, &Way::CAREFUL, observe).local;
        Local { iterations: iterations + local.iterations, ..local }
    }

    /// The optimum near `start` whose joints do not turn around where they nearly do, if there are any.
    fn halting(&self, start: &[f64], observe: Observer) -> Option<Local> {
        let mut found: Option<Local> = None;
        let mut kept: Vec<Halt> = Vec::new();
        let mut iterations = 0;
        for share in SLOW {
            let theta = found.as_ref().map_or(start, |local| &local.theta).to_vec();
            let mut cycle = self.cycle();
            cycle.simulate(&theta).ok()?;
            let more: Vec<Halt> =
                cycle.halts(share).into_iter().filter(|halt| kept.iter().all(|known| !known.is(halt))).collect();
            if more.is_empty() {
                continue;
            }
            kept.extend(more);
            let mut start = theta;
            let local = loop {
                let Solved { local, overpaid, .. } = self.solve(&start, &Way { halts: &kept, ..Way::CAREFUL }, observe);
                iterations += local.iterations;
                if overpaid.is_empty() {
                    break local;
                }
                // Where a turn costs less than to avoid it.
                kept.retain(|halt| !overpaid.contains(halt));
                start = local.theta;
            };
            let settled = local.is_settled();
            found = Some(Local { iterations, ..local });
            if settled {
                break;
            }
        }
        found
    }

    /// The optimum near `start` with these joints held still, or with fewer: those whose power would be less in motion are let
    /// go.
    fn rest(&self, start: &[f64], mut held: Vec<Still>, observe: Observer) -> Local {
        let mut start = start.to_vec();
        let mut iterations = 0;
        loop {
            let Solved { local, loose, .. } = self.solve(&start, &Way { still: &held, ..Way::CAREFUL }, observe);
            iterations += local.iterations;
            let Some(loose) = loose else { return Local { iterations, ..local } };
            held.retain(|still| !loose.joints.contains(still));
            start = loose.start;
        }
    }

    /// Joints that hardly move, by this share of the fastest one's rate.
    fn slow(&self, theta: &[f64], share: f64) -> Vec<Still> {
        if self.criterion != Criterion::Energy {
            return Vec::new();
        }
        let mut cycle = self.coarse();
        if cycle.simulate(theta).is_ok() { cycle.still(share) } else { Vec::new() }
    }

    /// The optimum near `start`, on a mesh that resolves it.
    fn solve(&self, start: &[f64], way: &Way, observe: Observer) -> Solved {
        let go_on = |cycle: &mut Cycle, theta: &[f64]| {
            if !way.halts.is_empty() && cycle.simulate(theta).is_ok() {
                cycle.keep_going(way.halts);
            }
        };
        let mut cycle = self.cycle();
        cycle.hold(way.still);
        go_on(&mut cycle, start);
        let mut found = settle(&mut cycle, start, way, observe);
        while found.solution.status.is_optimal()
            && let Some(mut finer) =
                if found.settled { unresolved(&cycle, &found.solution.x) } else { cycle.twice_as_fine() }
        {
            go_on(&mut finer, &found.solution.x);
            let mut better = settle(&mut finer, &found.solution.x, &Way::CAREFUL, observe);
            if !better.solution.status.is_optimal() {
                // What does not become an optimum there stays what it is: its receipt tells.
                found.solution.iterations += better.solution.iterations;
                break;
            }
            better.solution.iterations += found.solution.iterations;
            (found, cycle) = (better, finer);
        }
        let mut overpaid = Vec::new();
        if found.solution.status.is_optimal() && !way.halts.is_empty() {
            // Of the rows that there are now: some came in after the solution.
            let scale = cycle.scale();
            if let Ok(priced) = multipliers(&mut cycle, &found.solution.x, scale) {
                overpaid = cycle.overpaid(way.halts, &priced.inequalities);
            }
        }
        Solved { overpaid, ..finish(&mut cycle, found.solution, found.violation) }
    }
}

/// How an optimum is sought from a start.
#[derive(Clone, Copy)]
struct Way<'w> {
    /// Joints that are held still.
    still: &'w [Still],
    /// Joints that go on where they nearly turn around.
    halts: &'w [Halt],
    first_step_limit: f64,
    iteration_limit: usize,
}

impl Way<'static> {
    /// With nothing held, and steps of any length.
    const FREE: Way<'static> =
        Way { still: &[], halts: &[], first_step_limit: f64::INFINITY, iteration_limit: ITERATIONS };
    /// With a short first step.
    const CAREFUL: Way<'static> = Way { first_step_limit: CAUTION, ..Way::FREE };
}

impl Way<'_> {
    fn options(&self, options: &Options) -> Options {
        let Way { first_step_limit, iteration_limit, .. } = *self;
        Options { first_step_limit, iteration_limit, ..options.clone() }
    }
}

/// A solution with constraints imposed between nodes.
struct Settled {
    solution: Solution,
    /// What violation (scaled) is left there.
    violation: f64,
    /// Whether the rows between nodes no longer changed.
    settled: bool,
}

/// Imposes constraints between nodes where they dip in a solution. Tells what violation (scaled) is there, and by how much rows
/// that there were have changed: scaled, and where a row's price is high by what that does to the criterion.
fn look(cycle: &mut Cycle, solution: &Solution) -> Result<(f64, f64), Undefined> {
    cycle.simulate(&solution.x)?;
    let found = dips(cycle)?;
    let multipliers = cycle.dip_multipliers(&solution.inequality_multipliers);
    let changes = found.impose(cycle)?;
    let size = solution.objective.abs().max(1.0);
    let pairs = changes.iter().flatten().zip(multipliers.iter().flatten());
    let change = pairs.map(|(change, multiplier)| change * (multiplier / size).max(1.0)).fold(0.0, f64::max);
    Ok((found.violation, change))
}

/// The optimum near `start`, with constraints imposed between nodes where they dip.
fn settle(cycle: &mut Cycle, start: &[f64], way: &Way, observe: Observer) -> Settled {
    let options = options(cycle);
    between_nodes(cycle, start, |cycle, theta, round| {
        if round == 0 {
            return sqp::minimize(cycle, theta, &way.options(&options), observe);
        }
        // With rows that have moved a little the conditions may hold to the tolerance at the old place still, though not as well
        // with any other multipliers; a step further they do.
        let firm = Options { tolerance: FIRM * options.tolerance, ..options.clone() };
        let mut solution = sqp::minimize(cycle, theta, &firm, observe);
        let kkt = &solution.kkt;
        if solution.status == Status::NoProgress
            && kkt.optimality() <= options.tolerance
            && kkt.violation <= options.feasibility
        {
            solution.status = Status::Optimal;
        }
        solution
    })
}

/// The problem with twice as many elements, if these do not resolve the last simulated motion, which is `theta`, or its limits.
fn unresolved<'a>(cycle: &Cycle<'a>, theta: &[f64]) -> Option<Cycle<'a>> {
    cycle.finer().or_else(|| {
        let mut finer = cycle.twice_as_fine()?;
        let broken = finer.simulate(theta).and_then(|()| dips(&finer)).is_ok_and(|seen| seen.violation > UNRESOLVED);
        broken.then_some(finer)
    })
}

/// What `solve` makes of `start`, again and again with constraints imposed between nodes where they dip.
///
/// The rows between nodes are known only at a solution, so it is sought again until they no longer change.
fn between_nodes(
    cycle: &mut Cycle,
    start: &[f64],
    mut solve: impl FnMut(&mut Cycle, &[f64], usize) -> Solution,
) -> Settled {
    let mut solution = solve(cycle, start, 0);
    let mut last: Option<Settled> = None;
    for round in 0.. {
        let Ok((violation, change)) = look(cycle, &solution) else { break };
        if !solution.status.is_optimal() {
            // What was found with nearly these rows is better than nothing: its verdict tells.
            return last.unwrap_or(Settled { solution, violation, settled: true });
        }
        let settled = violation <= DENSE && change <= SETTLED;
        if settled || round == ROUNDS || (violation <= DENSE && round >= PATIENCE) {
            return Settled { solution, violation, settled };
        }
        if violation <= DENSE {
            last = Some(Settled { solution: solution.clone(), violation, settled });
        }
        let iterations = solution.iterations;
        solution = solve(cycle, &solution.x, round + 1);
        solution.iterations += iterations;
    }
    Settled { solution, violation: f64::INFINITY, settled: true }
}

fn finish(cycle: &mut Cycle, mut solution: Solution, violation: f64) -> Solved {
    let mut loose = None;
    if solution.status.is_optimal() && cycle.held().next().is_some() {
        // An optimum among motions that hold these joints; whether among all, their power decides.
        cycle.let_go();
        let scale = cycle.scale();
        match multipliers(cycle, &solution.x, scale.clone()) {
            Ok(found) if found.kkt.optimality() <= options(cycle).tolerance => solution.kkt = found.kkt,
            Ok(found) => {
                solution.status = Status::NoProgress;
                loose = Loose::new(cycle, &solution.x, &found.step, &scale);
            }
            Err(_) => solution.status = Status::NoProgress,
        }
    }
    // The motion and its labels are those of the last point simulated: make that the solution.
    let defined = cycle.simulate(&solution.x).is_ok();
    let conflicts = if defined { conflicts(cycle, &solution) } else { Vec::new() };
    let local = Local {
        status: if defined { solution.status } else { Status::Undefined },
        motion: cycle.motion(),
        costs: cycle.costs(),
        theta: solution.x,
        kkt: solution.kkt,
        violation,
        iterations: solution.iterations,
        conflicts,
    };
    Solved { local, loose, overpaid: Vec::new() }
}

/// Where a problem with joints held still, or kept from turning around, ended.
struct Solved {
    local: Local,
    loose: Option<Loose>,
    /// Joints that had better turn around.
    overpaid: Vec<Halt>,
}

/// Held joints that had better move, and a motion in which they begin to.
struct Loose {
    joints: Vec<Still>,
    start: Vec<f64>,
}

impl Loose {
    /// Those that a step down from the linearized motion sets in motion. `scale`: natural sizes of the variables.
    fn new(cycle: &Cycle, theta: &[f64], step: &[f64], scale: &[f64]) -> Option<Loose> {
        let joints = cycle.set_in_motion(step);
        let reach = step.iter().zip(scale).map(|(step, scale)| (step / scale).abs()).fold(0.0, f64::max);
        let share = (CAUTION / reach).min(1.0);
        let start = theta.iter().zip(step).map(|(x, step)| x + share * step).collect();
        (!joints.is_empty()).then_some(Loose { joints, start })
    }
}

fn conflicts(cycle: &Cycle, solution: &Solution) -> Vec<Conflict> {
    let Some(proof) = &solution.conflict else { return Vec::new() };
    let mut list: Vec<Conflict> = Vec::new();
    let mut add = |label: Label, violation: f64, weight: f64| {
        // Neighbouring instants of one constraint are one participant: its worst.
        match list
            .iter_mut()
            .find(|c| (c.label.limit, &c.label.of, c.label.phase) == (label.limit, &label.of, label.phase))
        {
            Some(known) if known.violation >= violation => known.weight += weight,
            Some(known) => *known = Conflict { label, violation, weight: known.weight + weight },
            None => list.push(Conflict { label, violation, weight }),
        }
    };
    for i in proof.conflicting_equalities() {
        add(cycle.equality_label(i), solution.values.equalities[i].abs(), proof.equalities[i].abs());
    }
    for i in proof.conflicting_inequalities() {
        add(cycle.label(i), (-solution.values.inequalities[i]).max(0.0), proof.inequalities[i]);
    }
    for i in proof.conflicting_bounds() {
        add(cycle.bound_label(i), 0.0, proof.bounds[i].abs());
    }
    list.sort_by(|a, b| b.violation.total_cmp(&a.violation).then(b.weight.total_cmp(&a.weight)));
    list
}
