//! The step is tried in full; refused, it is corrected; refused again, the next subproblem gets a smaller radius.
//!
//! Near a solution the full step d may increase both f and v through the constraints' curvature alone (the Maratos effect). The
//! correction solves the subproblem again with c(z + d) − J·d in the place of c(z); the corrected step is longer by O(‖d‖²) only,
//! so the fast local convergence survives.
//!
//! A radius (a box around the iterate, in the subproblem's bounds) instead of a search along d: a new subproblem costs
//! microseconds and points somewhere better, where a shorter d costs an evaluation and points to the same bend.

use super::Problem;
use super::dense::{dot, max_abs};
use super::merit::Merit;
use super::options::Kind;
use super::run::{Phase, Run};
use super::scaled::Point;

/// Corrections of one step.
const CORRECTIONS: usize = 2;
/// Radius after a refused step, relative to the step; and its growth after a step that filled it and kept so much of its promise.
const SHRINK: f64 = 0.3;
const GROW: f64 = 3.0;
const KEPT: f64 = 0.5;

impl<P: Problem> Run<'_, '_, P> {
    /// Tries `d`, then its corrections. With `true` the trial point is acceptable and linearized; with `false` the iterate
    /// stands, with its derivatives, and the radius has shrunk.
    pub(super) fn attempt(&mut self) -> bool {
        let from = self.worth(&self.point);
        let reach = max_abs(&self.d);
        self.place_trial(false);
        if self.view.evaluate(&mut self.trial).is_ok() {
            let to = self.worth(&self.trial);
            let accepted =
                if self.accepts(from, to) { self.land() } else { self.correction_pays(from, to) && self.correct(from) };
            if accepted {
                if reach > 0.5 * self.radius {
                    let kept = self.merit().kept(&self.promise, from, self.worth(&self.trial));
                    self.radius *= if kept > KEPT { GROW } else { 1.0 };
                } else if reach < 0.1 * self.radius {
                    self.radius = f64::INFINITY;
                }
                return true;
            }
        }
        self.radius = SHRINK * reach;
        false
    }

    /// Whether the trial point would be acceptable without its violation. To first order the multipliers tell what becomes of f when
    /// that is made up for; where f itself has refused the step, at a kink say, no correction helps.
    fn correction_pays(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        if to.1 <= 0.0 || self.phase != Phase::Optimality {
            return to.1 > 0.0;
        }
        let values = &self.trial.values;
        let violated = values.inequalities.iter().zip(&self.mu).filter(|(c, _)| **c < 0.0);
        let price = dot(&self.lambda, &values.equalities) + violated.map(|(c, mu)| mu * c).sum::<f64>();
        self.merit.clone().accepts(&self.promise, from, (to.0 - price, 0.0))
    }

    fn correct(&mut self, from: (f64, f64)) -> bool {
        let mut violation = self.trial.violation;
        for _ in 0..CORRECTIONS {
            if self.subproblem.correct(&self.view, &self.trial).is_err() {
                return false;
            }
            self.place_trial(true);
            if self.view.evaluate(&mut self.trial).is_err() {
                return false;
            }
            let to = self.worth(&self.trial);
            if self.accepts(from, to) {
                if self.kind != Kind::Feasibility {
                    self.kind = Kind::Corrected;
                }
                return self.land();
            }
            // A further correction is worth its evaluation only while corrections work.
            if to.1 > 0.5 * violation {
                return false;
            }
            violation = to.1;
        }
        false
    }

    /// Linearizes at the trial point. Where that fails (defined, but not differentiable), the derivatives of the iterate,
    /// which the problem may have lost, are restored.
    fn land(&mut self) -> bool {
        if self.view.linearize(&mut self.trial_gradient).is_ok() {
            return true;
        }
        if self.view.evaluate(&mut self.point).is_ok() {
            let _ = self.view.linearize(&mut self.trial_gradient);
        }
        false
    }

    /// (f, v), or (0, v) where only the violation counts.
    fn worth(&self, point: &Point) -> (f64, f64) {
        match self.phase {
            Phase::Optimality => (point.values.objective, point.violation),
            Phase::Feasibility { .. } => (0.0, point.violation),
        }
    }

    fn accepts(&mut self, from: (f64, f64), to: (f64, f64)) -> bool {
        match self.phase {
            Phase::Optimality => self.merit.accepts(&self.promise, from, to),
            Phase::Feasibility { .. } => Merit::of_violation().accepts(&self.promise, from, to),
        }
    }

    fn merit(&self) -> Merit {
        match self.phase {
            Phase::Optimality => self.merit.clone(),
            Phase::Feasibility { .. } => Merit::of_violation(),
        }
    }

    fn place_trial(&mut self, corrected: bool) {
        let d = if corrected { &self.subproblem.step.d } else { &self.d };
        for (j, d) in d.iter().enumerate() {
            self.trial.z[j] = (self.point.z[j] + d).max(self.lower[j]).min(self.upper[j]);
        }
    }
}
