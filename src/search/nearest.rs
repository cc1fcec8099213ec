//! The motion nearest to a walk that nearly satisfies the constraints.
//!
//! A walk drawn from geometry knows nothing of forces. Descending from it at once lets the criterion pull
//! while hardly a constraint holds, and the search ends in corners from which it must find back. So the
//! walk is first moved as little as possible, in units of the variables' natural sizes, until it
//! almost is a motion: a few steps of Gauss and Newton, which need no second derivatives.

use crate::cycle::Cycle;
use crate::sqp::{Control, Iteration, Options, Problem, Solution, Undefined, Values, minimize};

/// Violation (scaled) that is left to the descent.
const VIOLATION: f64 = 0.05;
/// Steps after which the descent has to cope with what is there.
const LIMIT: usize = 12;

/// Moves `start` towards the constraints of `cycle`.
pub fn nearest(
    cycle: &mut Cycle,
    start: &[f64],
    options: &Options,
    observe: &mut dyn FnMut(&Iteration) -> Control,
) -> Solution {
    let weights = cycle.scale().iter().map(|s| 1.0 / (s * s)).collect();
    let options =
        Options { tolerance: f64::INFINITY, feasibility: VIOLATION, iteration_limit: LIMIT, ..options.clone() };
    minimize(&mut Distance { cycle, from: start.to_vec(), at: start.to_vec(), weights }, start, &options, observe)
}

/// The constraints of a cycle, with half the weighted square of the distance as the objective.
struct Distance<'c, 'a> {
    cycle: &'c mut Cycle<'a>,
    from: Vec<f64>,
    /// Where it is linearized.
    at: Vec<f64>,
    weights: Vec<f64>,
}

impl Problem for Distance<'_, '_> {
    fn variables(&self) -> usize {
        self.cycle.variables()
    }

    fn equalities(&self) -> usize {
        self.cycle.equalities()
    }

    fn inequalities(&self) -> usize {
        self.cycle.inequalities()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        self.cycle.bounds(lower, upper);
    }

    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        self.cycle.evaluate(x, out)?;
        let square = |((x, from), weight): ((&f64, &f64), &f64)| weight * (x - from) * (x - from);
        out.objective = 0.5 * x.iter().zip(&self.from).zip(&self.weights).map(square).sum::<f64>();
        Ok(())
    }

    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        self.at.copy_from_slice(x);
        self.cycle.linearize(x)
    }

    fn gradient(&self, gradient: &mut [f64]) {
        for (((g, x), from), weight) in gradient.iter_mut().zip(&self.at).zip(&self.from).zip(&self.weights) {
            *g = weight * (x - from);
        }
    }

    fn equality_row(&self, i: usize, row: &mut [f64]) {
        self.cycle.equality_row(i, row);
    }

    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        self.cycle.inequality_row(i, row);
    }

    fn inequality_directions(&self, d: &[f64], out: &mut [f64]) {
        self.cycle.inequality_directions(d, out);
    }

    /// Of the distance alone.
    fn hessian(&mut self, _: &[f64], _: &[f64], hessian: &mut [f64]) -> bool {
        hessian.fill(0.0);
        for (diagonal, weight) in hessian.iter_mut().step_by(self.weights.len() + 1).zip(&self.weights) {
            *diagonal = *weight;
        }
        true
    }
}
