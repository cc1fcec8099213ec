//! The quadratic subproblem of an iterate, with only the rows that matter.
//!
//! Of thousands of sampled inequalities a few are active. The subproblem starts with the equalities, last time's active rows
//! and what is violated or as near to it as last time's step was long. Its solution d is then put to *all* linearized
//! constraints at once (J_I·d is one call); rows it violates are added and the dual method goes on from where it stands. When
//! none is left, d solves the full subproblem: screening costs rounds, never exactness. The objective's folds are screened likewise.

use super::Problem;
use super::dense::dot;
use super::folds::Folds;
use super::options::Subproblems;
use super::problem::Undefined;
use super::qp::active_set::ActiveSet;
use super::qp::{Failure, Place, Quadratic, Step, interior};
use super::scaled::{Point, Scaled};

/// Up to this many inequalities, screening is not worth its rounds.
const FEW: usize = 48;
/// Rounds in which only the worst of each run of neighbouring violated rows is added; after that, all of them.
const GENTLE_ROUNDS: usize = 8;
const NONE: usize = usize::MAX;

/// Why there is no step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    Undefined,
    Unsolved(Failure),
}

impl From<Undefined> for Trouble {
    fn from(_: Undefined) -> Self {
        Self::Undefined
    }
}

pub(super) struct Subproblem {
    pub(super) qp: Quadratic,
    solver: ActiveSet,
    method: Subproblems,
    /// What each row of `qp` after the equalities is.
    ids: Vec<Id>,
    /// Row of `qp` of each inequality, or `NONE`.
    row_of: Vec<usize>,
    /// Where bounds, equalities and inequalities stood in the last solution.
    bound_places: Vec<Place>,
    equality_places: Vec<Place>,
    inequality_places: Vec<Place>,
    /// |J_I·d| of the last step: how far each constraint tends to move.
    reach: Vec<f64>,
    equality_constants: Vec<f64>,
    inequality_constants: Vec<f64>,
    folds: Folds,
    limit: f64,
    row: Vec<f64>,
    scratch: Vec<f64>,

    // The solution.
    pub(super) step: Step,
    pub(super) lambda: Vec<f64>,
    pub(super) mu: Vec<f64>,
    /// J_E·d and J_I·d.
    pub(super) equality_directions: Vec<f64>,
    pub(super) inequality_directions: Vec<f64>,
    /// Σ of the violations of the linearized constraints at d.
    pub(super) linear_violation: f64,
    /// What the folds that d crosses add to the objective.
    pub(super) beyond_folds: f64,
    /// Some constraint gave way: its multiplier is at the limit.
    pub(super) yielding: bool,
    /// Number of active constraints and bounds.
    pub(super) active: usize,
    pub(super) interior_solves: usize,
}

/// How the active-set method starts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    Hints,
    Restart,
    Resume,
}

/// What a row of the subproblem is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Id {
    Inequality(usize),
    Fold(usize),
}

impl Subproblem {
    pub(super) fn new(n: usize, equalities: usize, inequalities: usize, folds: usize, method: Subproblems) -> Self {
        let rows = equalities + inequalities + folds;
        Self {
            qp: Quadratic::new(n, rows),
            solver: ActiveSet::new(n, rows),
            method,
            ids: Vec::with_capacity(inequalities + folds),
            row_of: vec![NONE; inequalities],
            bound_places: vec![Place::Off; 2 * n],
            equality_places: vec![Place::Working; equalities],
            inequality_places: vec![Place::Off; inequalities],
            reach: vec![0.0; inequalities],
            equality_constants: vec![0.0; equalities],
            inequality_constants: vec![0.0; inequalities],
            folds: Folds::new(folds),
            limit: f64::INFINITY,
            row: vec![0.0; n],
            scratch: vec![0.0; n],
            step: Step::with_room(n, rows),
            lambda: vec![0.0; equalities],
            mu: vec![0.0; inequalities],
            equality_directions: vec![0.0; equalities],
            inequality_directions: vec![0.0; inequalities],
            linear_violation: 0.0,
            beyond_folds: 0.0,
            yielding: false,
            active: 0,
            interior_solves: 0,
        }
    }

    /// Number of inequality rows in use.
    pub(super) fn rows(&self) -> usize {
        self.ids.len()
    }

    /// Linearizes at `point`: the rows to start with, and those with a multiplier in `mu`.
    pub(super) fn gather<P: Problem>(&mut self, view: &Scaled<P>, point: &Point, mu: &[f64]) -> Result<(), Undefined> {
        self.row_of.fill(NONE);
        self.ids.clear();
        self.qp.clear();
        self.equality_constants.copy_from_slice(&point.values.equalities);
        self.inequality_constants.copy_from_slice(&point.values.inequalities);
        let bounds = self.bound_places.len();
        self.qp.hints[..bounds].copy_from_slice(&self.bound_places);
        for i in 0..view.equalities {
            view.equality_row(i, &mut self.row)?;
            self.qp.push(&self.row, self.equality_constants[i], true, f64::INFINITY);
            self.qp.hints[bounds + i] = self.equality_places[i];
        }
        let c = &point.values.inequalities;
        let few = c.len() <= FEW;
        for i in 0..c.len() {
            let near = || {
                // A run of neighbouring samples is represented by its lowest member.
                (c[i] < 0.0 || c[i] < 0.5 * self.reach[i])
                    && (i == 0 || c[i] <= c[i - 1])
                    && (i + 1 == c.len() || c[i] <= c[i + 1])
            };
            if few || self.inequality_places[i] != Place::Off || mu[i] != 0.0 || near() {
                self.add(view, i)?;
            }
        }
        self.folds.linearize(view)?;
        for k in 0..self.folds.count() {
            if self.folds.was_met(k) {
                self.add_fold(view, k)?;
            }
        }
        Ok(())
    }

    fn add_fold<P: Problem>(&mut self, view: &Scaled<P>, k: usize) -> Result<(), Undefined> {
        view.fold_row(k, &mut self.row)?;
        self.ids.push(Id::Fold(k));
        self.folds.used[k] = true;
        self.qp.push(&self.row, self.folds.value(k), false, self.folds.price());
        if let Some(hint) = self.qp.hints.last_mut() {
            *hint = self.folds.places[k];
        }
        Ok(())
    }

    fn add<P: Problem>(&mut self, view: &Scaled<P>, i: usize) -> Result<(), Undefined> {
        view.inequality_row(i, &mut self.row)?;
        self.row_of[i] = view.equalities + self.ids.len();
        self.ids.push(Id::Inequality(i));
        self.qp.push(&self.row, self.inequality_constants[i], false, self.limit);
        if let Some(hint) = self.qp.hints.last_mut() {
            *hint = self.inequality_places[i];
        }
        Ok(())
    }

    /// out ← out − J_Eᵀλ − J_Iᵀμ; every inequality with a multiplier must have a row.
    pub(super) fn subtract_forces(&self, lambda: &[f64], mu: &[f64], out: &mut [f64]) {
        for (i, lambda) in lambda.iter().enumerate() {
            super::dense::axpy(-lambda * self.qp.norms[i], self.qp.row(i), out);
        }
        for (row, i) in self.inequality_rows().filter(|(_, i)| mu[*i] != 0.0) {
            super::dense::axpy(-mu[i] * self.qp.norms[row], self.qp.row(row), out);
        }
    }

    /// The largest ‖λᵢ·aᵢ‖₂ of all constraints.
    pub(super) fn largest_force(&self, lambda: &[f64], mu: &[f64]) -> f64 {
        let equalities = lambda.iter().zip(&self.qp.norms).map(|(m, norm)| m.abs() * norm);
        let rows = self.inequality_rows().map(|(row, i)| mu[i] * self.qp.norms[row]);
        equalities.chain(rows).fold(0.0, f64::max)
    }

    /// Rows of `qp` that are inequalities, and which.
    fn inequality_rows(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let rows = self.ids.iter().enumerate().map(|(k, id)| (self.lambda.len() + k, *id));
        rows.filter_map(|(row, id)| if let Id::Inequality(i) = id { Some((row, i)) } else { None })
    }

    /// Caps all multipliers of the constraints as they are: the price of violating them. Without the objective its folds have none.
    pub(super) fn cap(&mut self, limit: f64, objective: bool) {
        self.limit = limit;
        self.folds.counted = objective;
        for (own, norm) in self.qp.limits.iter_mut().zip(&self.qp.norms) {
            *own = limit * norm;
        }
        let price = self.folds.price();
        for (row, _) in (self.lambda.len()..).zip(&self.ids).filter(|(_, id)| matches!(id, Id::Fold(_))) {
            self.qp.limits[row] = price * self.qp.norms[row];
        }
    }

    /// Solves with the Hessian, the gradient and the bounds that the caller put into `qp`.
    pub(super) fn solve<P: Problem>(&mut self, view: &Scaled<P>, point: &Point) -> Result<(), Trouble> {
        self.equality_constants.copy_from_slice(&point.values.equalities);
        self.inequality_constants.copy_from_slice(&point.values.inequalities);
        self.set_row_constants();
        self.screen(view, Start::Hints)
    }

    /// Solves again after [`cap`](Self::cap).
    pub(super) fn solve_again<P: Problem>(&mut self, view: &Scaled<P>) -> Result<(), Trouble> {
        self.screen(view, Start::Restart)
    }

    /// Solves again with the constraints' values replaced by c(z + d) − J·d, which makes up for their curvature along d: the
    /// second-order correction in the form of Nocedal & Wright eq. 18.35-36, over all constraints rather than the active ones.
    pub(super) fn correct<P: Problem>(&mut self, view: &Scaled<P>, trial: &Point) -> Result<(), Trouble> {
        for (i, constant) in self.equality_constants.iter_mut().enumerate() {
            *constant = trial.values.equalities[i] - self.equality_directions[i];
        }
        for (i, constant) in self.inequality_constants.iter_mut().enumerate() {
            *constant = trial.values.inequalities[i] - self.inequality_directions[i];
        }
        self.set_row_constants();
        self.screen(view, Start::Restart)
    }

    fn set_row_constants(&mut self) {
        let equalities = self.equality_constants.len();
        for row in 0..self.qp.len() {
            let constant = if row < equalities {
                self.equality_constants[row]
            } else {
                match self.ids[row - equalities] {
                    Id::Inequality(i) => self.inequality_constants[i],
                    Id::Fold(k) => self.folds.value(k),
                }
            };
            self.qp.constants[row] = constant / self.qp.norms[row];
        }
    }

    fn screen<P: Problem>(&mut self, view: &Scaled<P>, start: Start) -> Result<(), Trouble> {
        let mut start = start;
        for round in 0.. {
            start = self.solve_rows(start)?;
            let (inequalities, folds) = (&mut self.inequality_directions, &mut self.folds.directions);
            view.directions(&self.step.d, &mut self.scratch, inequalities, folds)?;
            if !self.add_violated(view, round)? {
                break;
            }
        }
        self.collect();
        Ok(())
    }

    /// Solves with the present rows; returns how to go on when there are more.
    fn solve_rows(&mut self, start: Start) -> Result<Start, Trouble> {
        if self.method == Subproblems::ActiveSet {
            let outcome = match start {
                Start::Hints => self.solver.solve(&self.qp),
                Start::Restart => self.solver.restart(&self.qp),
                Start::Resume => self.solver.resume(&self.qp),
            };
            match outcome {
                Ok(step) => {
                    self.step.copy(step);
                    self.qp.hints.copy_from_slice(self.solver.places());
                    return Ok(Start::Resume);
                }
                Err(Failure::NotConvex) => return Err(Trouble::Unsolved(Failure::NotConvex)),
                Err(_) => {}
            }
        }
        self.interior_solves += 1;
        self.step = interior::solve(&self.qp).map_err(Trouble::Unsolved)?;
        self.read_places();
        Ok(Start::Hints)
    }

    /// The active set of an interior-point solution, and an exact zero for the multipliers outside it.
    fn read_places(&mut self) {
        let n = self.qp.n;
        let size = 1e-7
            * self.step.multipliers.iter().chain(&self.step.bound_multipliers).fold(1e-12, |m: f64, y| m.max(y.abs()));
        for (j, nu) in self.step.bound_multipliers.iter_mut().enumerate() {
            if nu.abs() <= size {
                *nu = 0.0;
            }
            let place = |active| if active { Place::Working } else { Place::Off };
            self.qp.hints[j] = place(*nu > 0.0);
            self.qp.hints[n + j] = place(*nu < 0.0);
        }
        for (i, y) in self.step.multipliers.iter_mut().enumerate() {
            if y.abs() <= size {
                *y = 0.0;
            }
            self.qp.hints[2 * n + i] = if *y >= self.qp.limits[i] {
                Place::Full
            } else if self.qp.equality[i] && *y <= -self.qp.limits[i] {
                Place::Empty
            } else if self.qp.equality[i] || *y > 0.0 {
                Place::Working
            } else {
                Place::Off
            };
        }
    }

    fn add_violated<P: Problem>(&mut self, view: &Scaled<P>, round: usize) -> Result<bool, Undefined> {
        let before = self.ids.len();
        let first_new = self.lambda.len() + before;
        let count = self.row_of.len();
        let linear = |this: &Self, i: usize| this.inequality_constants[i] + this.inequality_directions[i];
        for i in 0..count {
            if self.row_of[i] != NONE {
                continue;
            }
            let value = linear(self, i);
            if value >= -1e-11 - 1e-10 * self.inequality_constants[i].abs() {
                continue;
            }
            // Compared with the neighbours that have no row yet (or only since a moment ago).
            let lowest = |j: usize| self.row_of[j] < first_new || value <= linear(self, j);
            if round >= GENTLE_ROUNDS || ((i == 0 || lowest(i - 1)) && (i + 1 == count || lowest(i + 1))) {
                self.add(view, i)?;
            }
        }
        for k in 0..self.folds.count() {
            if !self.folds.used[k] && self.folds.beyond(k) > 0.0 {
                self.add_fold(view, k)?;
            }
        }
        Ok(self.ids.len() > before)
    }

    fn collect(&mut self) {
        let (n, equalities) = (self.qp.n, self.lambda.len());
        self.mu.fill(0.0);
        self.inequality_places.fill(Place::Off);
        self.bound_places.copy_from_slice(&self.qp.hints[..2 * n]);
        let places = &self.qp.hints[2 * n..];
        self.active = self.qp.hints.iter().filter(|place| **place != Place::Off).count();
        self.yielding = false;
        self.linear_violation = 0.0;
        for i in 0..equalities {
            self.lambda[i] = self.qp.multiplier(&self.step, i);
            self.equality_places[i] = places[i];
            self.yielding |= matches!(places[i], Place::Full | Place::Empty);
            self.equality_directions[i] = self.qp.norms[i] * dot(self.qp.row(i), &self.step.d);
            self.linear_violation += (self.equality_constants[i] + self.equality_directions[i]).abs();
        }
        self.folds.places.fill(Place::Off);
        for (row, id) in (equalities..).zip(&self.ids) {
            match *id {
                Id::Inequality(i) => {
                    self.mu[i] = self.qp.multiplier(&self.step, row);
                    self.inequality_places[i] = places[row];
                    self.yielding |= places[row] == Place::Full;
                }
                Id::Fold(k) => self.folds.places[k] = places[row],
            }
        }
        self.beyond_folds = (0..self.folds.count()).map(|k| self.folds.beyond(k)).sum();
        for i in 0..self.reach.len() {
            let direction = self.inequality_directions[i];
            self.reach[i] = direction.abs();
            self.linear_violation += (-(self.inequality_constants[i] + direction)).max(0.0);
        }
    }
}
