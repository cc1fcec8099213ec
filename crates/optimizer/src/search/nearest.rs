//! The motion nearest to a walk that nearly satisfies the constraints.
//!
//! A walk drawn from geometry knows nothing of forces. Descending from it at once lets the criterion pull
//! while hardly a constraint holds, and the search ends in corners from which it must find back. So the
//! walk is first moved as little as possible, in units of the variables' natural sizes, until it
//! almost is a motion: a few steps of Gauss and Newton, which need no second derivatives. To come all the way, or to see that there is none,
//! takes Newton's.

use crate::cycle::Cycle;
use piaffe_sqp::{Control, Iteration, Objective, Options, Own, Redirected, Solution, minimize};

/// Violation (scaled) that is left to the descent.
const VIOLATION: f64 = 0.05;
/// Steps after which the descent has to cope with what is there.
const LIMIT: usize = 12;

/// Moves `start` towards the constraints of `cycle`, roughly.
pub fn nearest(
    cycle: &mut Cycle,
    start: &[f64],
    options: &Options,
    observe: &mut dyn FnMut(&Iteration) -> Control,
) -> Solution {
    let options = Options { feasibility: VIOLATION, iteration_limit: LIMIT, ..options.clone() };
    approach(cycle, start, &options, Constraints::Straight, observe)
}

/// Moves `start` until it satisfies the constraints of `cycle` to the feasibility of `options`.
pub fn reach(
    cycle: &mut Cycle,
    start: &[f64],
    options: &Options,
    observe: &mut dyn FnMut(&Iteration) -> Control,
) -> Solution {
    approach(cycle, start, options, Constraints::Curved, observe)
}

fn approach(
    cycle: &mut Cycle,
    start: &[f64],
    options: &Options,
    constraints: Constraints,
    observe: &mut dyn FnMut(&Iteration) -> Control,
) -> Solution {
    let weights = cycle.scale().iter().map(|s| 1.0 / (s * s)).collect();
    let options = Options { tolerance: f64::INFINITY, ..options.clone() };
    let distance = Distance { from: start.to_vec(), weights, constraints };
    minimize(&mut Redirected::new(cycle, distance), start, &options, observe)
}

/// Half the weighted square of the distance.
struct Distance {
    from: Vec<f64>,
    weights: Vec<f64>,
    constraints: Constraints,
}

/// What a step takes constraints for: their tangents, or with their curvature.
#[derive(Clone, Copy)]
enum Constraints {
    Straight,
    Curved,
}

impl Objective for Distance {
    fn value(&self, x: &[f64], _: f64) -> f64 {
        let square = |((x, from), weight): ((&f64, &f64), &f64)| weight * (x - from) * (x - from);
        0.5 * x.iter().zip(&self.from).zip(&self.weights).map(square).sum::<f64>()
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) {
        for (((g, x), from), weight) in gradient.iter_mut().zip(x).zip(&self.from).zip(&self.weights) {
            *g = weight * (x - from);
        }
    }

    fn hessian(&self, _: &[f64], own: &mut Own, hessian: &mut [f64]) -> bool {
        let exact = match self.constraints {
            Constraints::Straight => {
                hessian.fill(0.0);
                true
            }
            Constraints::Curved => own.constraints(hessian),
        };
        for (diagonal, weight) in hessian.iter_mut().step_by(self.weights.len() + 1).zip(&self.weights) {
            *diagonal += *weight;
        }
        exact
    }
}
