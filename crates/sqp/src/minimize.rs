//! The main loop: measure, learn, find a direction, try it.
//!
//! Two phases share it. *Optimality*: L = f − λᵀc_E − μᵀc_I and the merit function f + ρ·v. *Feasibility*: the same with f left
//! out and ρ = 1, entered where the linearized constraints cannot be made (much) less violated and left as soon as they can; if
//! that phase converges instead, the violation is stationary and the problem is (locally) infeasible.

use super::dense::max_abs;
use super::direction::Direction;
use super::run::{Phase, Run};
use super::scaled::Scaled;
use super::screening::Trouble;
use super::{Control, Iteration, KktResidual, Options, Problem, Solution, Status, Values};

/// Consecutive steps that change nothing before the solver admits it.
const STALLS: usize = 4;
/// Iterations in which the violation alone must fall by a hundredth.
const PATIENCE: usize = 40;

/// Minimizes the problem from `x0` (moved into the bounds first). The observer sees every iterate and may stop the run.
///
/// Deterministic, single-threaded, never panics on what the problem's functions return; the solution's status is
/// [`Status::Optimal`] only if [`Solution::kkt`] meets the tolerances.
pub fn minimize<P: Problem>(
    problem: &mut P,
    x0: &[f64],
    options: &Options,
    observer: &mut dyn FnMut(&Iteration) -> Control,
) -> Solution {
    let (n, equalities, inequalities) = (problem.variables(), problem.equalities(), problem.inequalities());
    let Some(view) = Scaled::new(problem, x0, options) else {
        return Solution {
            x: x0.to_vec(),
            objective: f64::NAN,
            values: Values::zeros(equalities, inequalities),
            equality_multipliers: vec![0.0; equalities],
            inequality_multipliers: vec![0.0; inequalities],
            bound_multipliers: vec![0.0; n],
            status: Status::Invalid,
            iterations: 0,
            evaluations: 0,
            linearizations: 0,
            interior_solves: 0,
            kkt: KktResidual::UNKNOWN,
            conflict: None,
        };
    };
    Run::new(view, options).go(x0, observer)
}

impl<P: Problem> Run<'_, '_, P> {
    fn go(mut self, x0: &[f64], observer: &mut dyn FnMut(&Iteration) -> Control) -> Solution {
        if self.start(x0).is_err() {
            return self.end(Status::Undefined, 0);
        }
        for k in 0.. {
            if self.measure().is_err() {
                return self.end(Status::Undefined, k);
            }
            if observer(&self.report(k)) == Control::Stop {
                return self.end(Status::Stopped, k);
            }
            if self.optimal() {
                return self.end(Status::Optimal, k);
            }
            if k == self.options.iteration_limit {
                return self.end(Status::IterationLimit, k);
            }
            self.learn();
            // A direction that leads nowhere is replaced by a humbler one: first without the model's memory, then without
            // the objective.
            let mut humility = 0;
            self.distrust = false;
            self.hessian_known = false;
            loop {
                let direction = match self.direction() {
                    Ok(direction) => direction,
                    Err(Trouble::Undefined) => return self.end(Status::Undefined, k),
                    Err(Trouble::Unsolved(_)) => Direction::None,
                };
                match direction {
                    Direction::Stationary if self.phase == Phase::Optimality => return self.end(Status::Optimal, k),
                    Direction::Stationary => return self.end(Status::Infeasible, k),
                    Direction::Step if self.attempt() => break,
                    // The radius has shrunk.
                    Direction::Step if self.radius > 1e-12 * (1.0 + max_abs(&self.point.z)) => continue,
                    Direction::Step | Direction::None => {}
                }
                self.radius = f64::INFINITY;
                humility += 1;
                if !self.humble(humility) {
                    return self.end(Status::NoProgress, k);
                }
            }
            self.advance();
            if self.subproblem.gather(&self.view, &self.point, &self.mu).is_err() {
                return self.end(Status::Undefined, k + 1);
            }
            if self.phase != Phase::Optimality && self.record.1 >= PATIENCE {
                if self.measure().is_err() {
                    return self.end(Status::Undefined, k + 1);
                }
                let proven = self.kkt.stationarity <= 1e3 * self.options.tolerance;
                return self.end(if proven { Status::Infeasible } else { Status::NoProgress }, k + 1);
            }
            if self.stalls >= STALLS {
                let k = k + 1;
                return match self.measure() {
                    Ok(()) if self.optimal() => self.end(Status::Optimal, k),
                    _ => self.end(Status::NoProgress, k),
                };
            }
        }
        let limit = self.options.iteration_limit;
        self.end(Status::IterationLimit, limit)
    }

    /// A second (and third) attempt at the same iterate. `false` when there is nothing left to try.
    fn humble(&mut self, attempt: usize) -> bool {
        match self.phase {
            Phase::Optimality if self.exact && !self.distrust => {
                self.distrust = true;
                true
            }
            Phase::Optimality if attempt <= 2 && !self.lagrangian_model.fresh => {
                self.forget();
                true
            }
            Phase::Optimality if attempt <= 3 && self.kkt.violation > self.options.feasibility => {
                self.look_at_violation();
                true
            }
            Phase::Feasibility { .. } if self.exact && !self.distrust => {
                self.distrust = true;
                true
            }
            Phase::Feasibility { .. } if attempt <= 5 && !self.violation_model.fresh => {
                self.forget();
                true
            }
            _ => false,
        }
    }
}
