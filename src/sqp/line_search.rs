//! The search along the direction: full step, then its second-order corrections, then shorter steps.
//!
//! Near a solution the full step d may increase both f and v through the constraints' curvature alone (the Maratos effect). The
//! correction solves the subproblem again with c(z + d) − J·d in the place of c(z); the corrected step is longer by O(‖d‖²) only,
//! so the fast local convergence survives.

use super::Problem;
use super::dense::max_abs;
use super::merit::Merit;
use super::minimize::{Phase, Run};
use super::options::Kind;
use super::scaled::Point;

/// Corrections of one step.
const CORRECTIONS: usize = 2;
/// Step lengths per direction; after that a new subproblem with a smaller radius points somewhere better, at no evaluation.
const TRIALS: usize = 1;

impl<P: Problem> Run<'_, '_, P> {
    /// Finds an acceptable point along `d` and linearizes there. `false` if there is none; the iterate then stands, with
    /// its derivatives.
    pub(super) fn search(&mut self) -> bool {
        let from = self.worth(&self.point);
        let mut alpha = 1.0;
        let mut rows_are_valid = true;
        for _ in 0..TRIALS {
            self.place_trial(alpha);
            if self.view.evaluate(&mut self.trial).is_err() {
                alpha *= 0.25;
                continue;
            }
            let to = self.worth(&self.trial);
            if self.accepts(alpha, from, to) {
                if self.view.linearize(&mut self.trial_gradient).is_ok() {
                    self.took(alpha);
                    return true;
                }
                // Defined here, but not differentiable: as bad as undefined, and the rows of the iterate are gone.
                rows_are_valid = false;
                alpha *= 0.25;
                continue;
            }
            if alpha == 1.0 && rows_are_valid && to.1 > 0.0 && self.corrected_step(from) {
                self.took(1.0);
                self.kind = Kind::Corrected;
                return true;
            }
            alpha = self.phase_merit().interpolate(&self.promise, alpha, from, to);
        }
        if !rows_are_valid {
            self.relinearize();
        }
        self.radius = 0.3 * max_abs(&self.d);
        false
    }

    fn corrected_step(&mut self, from: (f64, f64)) -> bool {
        let mut violation = self.trial.violation;
        for _ in 0..CORRECTIONS {
            if self.subproblem.correct(&self.view, &self.trial).is_err() {
                return false;
            }
            self.place_corrected_trial();
            if self.view.evaluate(&mut self.trial).is_err() {
                return false;
            }
            let to = self.worth(&self.trial);
            if self.accepts(1.0, from, to) {
                if self.view.linearize(&mut self.trial_gradient).is_ok() {
                    return true;
                }
                self.relinearize();
                return false;
            }
            // A further correction is worth its evaluation only while corrections work.
            if to.1 > 0.5 * violation {
                return false;
            }
            violation = to.1;
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

    fn phase_merit(&self) -> Merit {
        match self.phase {
            Phase::Optimality => self.merit.clone(),
            Phase::Feasibility { .. } => Merit::of_violation(),
        }
    }

    fn accepts(&mut self, alpha: f64, from: (f64, f64), to: (f64, f64)) -> bool {
        let mut merit = self.phase_merit();
        let accepted = merit.accepts(&self.promise, alpha, from, to);
        if self.phase == Phase::Optimality {
            self.merit = merit;
        }
        accepted
    }

    fn place_trial(&mut self, alpha: f64) {
        for j in 0..self.d.len() {
            let z = self.point.z[j] + alpha * self.d[j];
            self.trial.z[j] = z.max(self.lower[j]).min(self.upper[j]);
        }
    }

    fn place_corrected_trial(&mut self) {
        for j in 0..self.d.len() {
            let z = self.point.z[j] + self.subproblem.step.d[j];
            self.trial.z[j] = z.max(self.lower[j]).min(self.upper[j]);
        }
    }

    /// Restores the derivatives at the iterate, where they were defined before.
    fn relinearize(&mut self) {
        if self.view.evaluate(&mut self.point).is_ok() {
            let _ = self.view.linearize(&mut self.trial_gradient);
        }
    }
}
