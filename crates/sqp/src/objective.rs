//! The constraints of one problem with an objective of one's own.

use super::dense::axpy;
use super::problem::{Problem, Undefined, Values};

/// What becomes of a problem's objective f: itself with something added, or something else.
pub trait Objective {
    /// The objective at `x`, where f is `own`.
    fn value(&self, x: &[f64], own: f64) -> f64;
    /// Makes the objective's gradient at `x` of ∇f.
    fn gradient(&self, x: &[f64], gradient: &mut [f64]);
    /// Writes the Hessian of the Lagrangian (see [`Problem::hessian`]), with what `own` knows of the problem's.
    fn hessian(&self, x: &[f64], own: &mut Own, hessian: &mut [f64]) -> bool;
}

/// Second derivatives of the problem whose objective is replaced, at its linearized point.
pub struct Own<'o> {
    problem: &'o mut dyn Problem,
    equality_multipliers: &'o [f64],
    inequality_multipliers: &'o [f64],
}

impl Own<'_> {
    /// Writes the Hessian of f − λᵀc_E − μᵀc_I; `false` if there is none.
    pub fn lagrangian(&mut self, hessian: &mut [f64]) -> bool {
        self.problem.hessian(self.equality_multipliers, self.inequality_multipliers, hessian)
    }

    /// Writes that of −λᵀc_E − μᵀc_I, as the difference of two that contain f; `false` if there is none.
    pub fn constraints(&mut self, hessian: &mut [f64]) -> bool {
        let [lambda, mu] = [self.equality_multipliers, self.inequality_multipliers].map(|m| vec![0.0; m.len()]);
        let mut objective = vec![0.0; hessian.len()];
        let exact = self.lagrangian(hessian) && self.problem.hessian(&lambda, &mu, &mut objective);
        axpy(-1.0, &objective, hessian);
        exact
    }
}

/// `problem` with `objective` in place of its own.
pub struct Redirected<'p, P, O> {
    problem: &'p mut P,
    objective: O,
    /// Where it is linearized.
    at: Vec<f64>,
}

impl<'p, P: Problem, O: Objective> Redirected<'p, P, O> {
    pub fn new(problem: &'p mut P, objective: O) -> Self {
        let at = vec![0.0; problem.variables()];
        Redirected { problem, objective, at }
    }
}

impl<P: Problem, O: Objective> Problem for Redirected<'_, P, O> {
    fn variables(&self) -> usize {
        self.problem.variables()
    }

    fn equalities(&self) -> usize {
        self.problem.equalities()
    }

    fn inequalities(&self) -> usize {
        self.problem.inequalities()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        self.problem.bounds(lower, upper);
    }

    fn strictness(&self, i: usize) -> f64 {
        self.problem.strictness(i)
    }

    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        self.problem.evaluate(x, out)?;
        out.objective = self.objective.value(x, out.objective);
        Ok(())
    }

    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        self.at.copy_from_slice(x);
        self.problem.linearize(x)
    }

    fn gradient(&self, gradient: &mut [f64]) {
        self.problem.gradient(gradient);
        self.objective.gradient(&self.at, gradient);
    }

    fn equality_row(&self, i: usize, row: &mut [f64]) {
        self.problem.equality_row(i, row);
    }

    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        self.problem.inequality_row(i, row);
    }

    fn directions(&self, d: &[f64], inequalities: &mut [f64], folds: &mut [f64]) {
        self.problem.directions(d, inequalities, folds);
    }

    fn hessian(&mut self, equality_multipliers: &[f64], inequality_multipliers: &[f64], hessian: &mut [f64]) -> bool {
        let Redirected { problem, objective, at } = self;
        let mut own = Own { problem: &mut **problem, equality_multipliers, inequality_multipliers };
        objective.hessian(at, &mut own, hessian)
    }
}
