//! The constraints of one problem with an objective of one's own.

use super::problem::{Problem, Undefined, Values};

/// What becomes of a problem's objective f: itself with something added, or something else.
pub trait Objective {
    /// The objective at `x`, where f is `own`.
    fn value(&self, x: &[f64], own: f64) -> f64;
    /// Makes the objective's gradient at `x` of ∇f.
    fn gradient(&self, x: &[f64], gradient: &mut [f64]);
    /// Writes the Hessian of the Lagrangian (see [`Problem::hessian`]); `own` writes that of the problem's own.
    fn hessian(&self, x: &[f64], own: &mut dyn FnMut(&mut [f64]) -> bool, hessian: &mut [f64]) -> bool;
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
        let mut own = |out: &mut [f64]| problem.hessian(equality_multipliers, inequality_multipliers, out);
        objective.hessian(at, &mut own, hessian)
    }
}
