//! The direction of an iterate: one quadratic program, or a few where its constraints contradict each other.
//!
//! The first solve caps every multiplier at a price so high that a constraint gives way only if it must. If none does, the step
//! is that of the plain program. Otherwise its linear violation is (nearly) the best that any step can do, and the penalty is
//! *steered* (Byrd, Nocedal & Waltz 2008): starting from the present one, raised until the step achieves a fair share of it.

use super::dense::{axpy, dot, max_abs, multiply};
use super::merit::Promise;
use super::run::{Phase, Run};
use super::screening::Trouble;
use super::{Kind, Problem, Undefined};

/// Price of a violation, in units of ‖∇f‖∞, at which constraints give way only if they contradict each other.
const PROHIBITIVE: f64 = 1e6;
/// Share of the best possible relief that an elastic step must achieve.
const FAIR: f64 = 0.3;
/// If the best relief is a smaller share of the violation than this, the objective has to wait.
const HOPELESS: f64 = 0.1;

/// Rises of the objective that a subproblem solved to its tolerance may promise, relative to one and to its size.
const ROUNDING: f64 = 1e-9;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// `Run::d`, with its promise.
    Step,
    /// The iterate satisfies the optimality conditions of its phase with the new multipliers.
    Stationary,
    /// No descent direction was found.
    None,
}

impl<P: Problem> Run<'_, '_, P> {
    pub(super) fn direction(&mut self) -> Result<Direction, Trouble> {
        match self.phase {
            Phase::Optimality => self.towards_optimality(),
            Phase::Feasibility { from } => {
                let improved = self.point.violation <= 0.9 * from || self.kkt.violation <= self.options.feasibility;
                if improved && self.plain_step(true, self.prohibitive()).is_ok() && !self.subproblem.yielding {
                    // The linearized constraints agree again: the objective is back.
                    self.phase = Phase::Optimality;
                    return Ok(self.conclude(Kind::Exact));
                }
                self.towards_feasibility()
            }
        }
    }

    fn towards_optimality(&mut self) -> Result<Direction, Trouble> {
        let violation = self.point.violation;
        if self.elastic {
            // Constraints gave way last time: most likely they do again, and at the same price.
            self.plain_step(false, self.merit.high)?;
            if !self.subproblem.yielding {
                return Ok(self.conclude(Kind::Exact));
            }
            // The best relief is at most the violation itself, so this is a fair share of it for certain.
            if violation - self.subproblem.linear_violation >= FAIR * violation {
                return Ok(self.conclude(Kind::Elastic));
            }
            self.subproblem.cap(self.prohibitive(), true);
            self.subproblem.solve_again(&self.view)?;
        } else {
            self.plain_step(true, self.prohibitive())?;
        }
        if !self.subproblem.yielding {
            let direction = self.conclude(Kind::Exact);
            if !self.exact || self.distrust || direction != Direction::None {
                return Ok(direction);
            }
            // The convexification counted on constraints that turned out inactive.
            self.plain_step(false, self.prohibitive())?;
            if !self.subproblem.yielding {
                return Ok(self.conclude(Kind::Exact));
            }
        }
        let best = self.subproblem.linear_violation;
        let bounded = max_abs(&self.subproblem.step.d) >= 0.99 * self.radius;
        if self.kkt.violation > self.options.feasibility && violation - best <= HOPELESS * violation && !bounded {
            self.look_at_violation();
            return self.towards_feasibility();
        }
        let prohibitive = self.prohibitive();
        let mut penalty = self.merit.high;
        // Without counting on rows that give way.
        self.plain_step(false, penalty)?;
        loop {
            let relief = violation - self.subproblem.linear_violation;
            if !self.subproblem.yielding || relief >= FAIR * (violation - best) || penalty >= prohibitive {
                break;
            }
            penalty = (10.0 * penalty).min(prohibitive);
            self.subproblem.cap(penalty, true);
            self.subproblem.solve_again(&self.view)?;
        }
        self.merit.raise(penalty);
        Ok(self.conclude(Kind::Elastic))
    }

    /// Multipliers for the first exact Hessian: those of a subproblem that keeps near the iterate. Without them the constraints'
    /// curvature would be missing, and the first steps of a start near the optimum would lead away from it.
    pub(super) fn estimate_multipliers(&mut self) -> Result<(), Undefined> {
        self.distrust = true;
        let solved = self.plain_step(false, self.prohibitive());
        self.distrust = false;
        if solved.is_ok() && !self.subproblem.yielding {
            self.lambda.copy_from_slice(&self.subproblem.lambda);
            self.mu.copy_from_slice(&self.subproblem.mu);
        }
        self.subproblem.gather(&self.view, &self.point, &self.mu)
    }

    fn prohibitive(&self) -> f64 {
        PROHIBITIVE * max_abs(&self.gradient).max(1.0)
    }

    /// Solves the subproblem of the optimality phase at the given price of a violation. `augment`: see [`super::convexify`].
    fn plain_step(&mut self, augment: bool, price: f64) -> Result<(), Trouble> {
        self.set_bounds();
        self.subproblem.qp.gradient.copy_from_slice(&self.gradient);
        let newton = self.exact && !self.distrust && self.phase == Phase::Optimality;
        if newton && !self.hessian_known {
            // Once per iterate, before any trial point is evaluated.
            self.convexifier.forget();
            self.exact = self.view.hessian(&self.lambda, &self.mu, &mut self.hessian);
            self.hessian_known = self.exact;
        }
        if newton && self.exact {
            self.curvature.copy_from_slice(&self.hessian);
            let (model, qp) = (&self.lagrangian_model.b, &mut self.subproblem.qp);
            self.convexifier.convexify(&mut self.curvature, qp, model, augment);
        } else {
            self.curvature.copy_from_slice(&self.lagrangian_model.b);
            self.subproblem.qp.hessian.copy_from_slice(&self.curvature);
        }
        self.subproblem.cap(price, true);
        self.subproblem.solve(&self.view, &self.point)
    }

    /// The step that reduces the violation alone: a proximal ℓ1 model of it.
    fn towards_feasibility(&mut self) -> Result<Direction, Trouble> {
        self.set_bounds();
        self.subproblem.qp.gradient.fill(0.0);
        self.curvature.copy_from_slice(&self.violation_model.b);
        self.subproblem.qp.hessian.copy_from_slice(&self.curvature);
        if self.exact && !self.distrust && self.violation_multipliers && self.violation_hessian() {
            let (model, qp) = (&self.violation_model.b, &mut self.subproblem.qp);
            self.convexifier.convexify(&mut self.curvature, qp, model, false);
        }
        self.subproblem.cap(1.0, false);
        self.subproblem.solve(&self.view, &self.point)?;
        Ok(self.conclude(Kind::Feasibility))
    }

    /// The exact Hessian of −λᵀc_E − μᵀc_I, as the difference of two that contain f, into `curvature`.
    fn violation_hessian(&mut self) -> bool {
        if !self.hessian_known {
            self.convexifier.forget();
            let mut objective = std::mem::take(&mut self.curvature);
            self.hessian_known = self.view.hessian(&self.lambda, &self.mu, &mut self.hessian)
                && self.view.hessian(&self.zeros.0, &self.zeros.1, &mut objective);
            axpy(-1.0, &objective, &mut self.hessian);
            // A little proximity, where the constraints are straight.
            let prox = 1e-2 * self.proximity();
            self.hessian.iter_mut().step_by(self.d.len() + 1).for_each(|h| *h += prox);
            self.curvature = objective;
        }
        if self.hessian_known {
            self.curvature.copy_from_slice(&self.hessian);
        } else {
            self.curvature.copy_from_slice(&self.violation_model.b);
        }
        self.hessian_known
    }

    /// Whether a step raises the objective by more than the violation is worth at its own multipliers: the convexification counted on
    /// constraints that turned out inactive.
    fn misled(&self) -> bool {
        let values = &self.point.values;
        let equalities = self.lambda.iter().zip(&values.equalities).map(|(m, c)| (m * c).abs());
        let inequalities = self.mu.iter().zip(&values.inequalities).map(|(m, c)| m * (-c).max(0.0));
        let worth = equalities.chain(inequalities).sum::<f64>() + ROUNDING * values.objective.abs().max(1.0);
        let augmented = self.exact && !self.distrust && self.convexifier.is_augmented();
        augmented && self.promise.slope + 0.5 * self.promise.curvature > 2.0 * worth
    }

    fn set_bounds(&mut self) {
        let limit = self.options.step_limit.min(self.radius);
        let qp = &mut self.subproblem.qp;
        for (j, z) in self.point.z.iter().enumerate() {
            qp.lower[j] = (self.lower[j] - z).max(-limit).min(0.0);
            qp.upper[j] = (self.upper[j] - z).min(limit).max(0.0);
        }
    }

    /// Takes over the subproblem's step, multipliers and promise.
    fn conclude(&mut self, kind: Kind) -> Direction {
        self.kind = kind;
        self.elastic = kind == Kind::Elastic;
        self.d.copy_from_slice(&self.subproblem.step.d);
        multiply(&self.curvature, &self.d, &mut self.trial_gradient);
        let optimality = self.phase == Phase::Optimality;
        self.promise = Promise {
            slope: if optimality { dot(&self.gradient, &self.d) + self.subproblem.beyond_folds } else { 0.0 },
            curvature: dot(&self.d, &self.trial_gradient).max(0.0),
            relief: self.point.violation - self.subproblem.linear_violation,
        };
        self.adopt_multipliers();
        self.violation_multipliers = !optimality;
        if optimality {
            if self.optimal() {
                return Direction::Stationary;
            }
            if self.misled() {
                return Direction::None;
            }
            if kind == Kind::Exact {
                self.merit.relax(max_abs(&self.lambda).max(max_abs(&self.mu)));
            }
            self.merit.prepare(&self.promise);
            let descends = self.promise.reduction(self.merit.high) > 0.0;
            return if descends { Direction::Step } else { Direction::None };
        }
        let hopeless = self.promise.relief <= 0.01 * self.point.violation;
        if hopeless && self.kkt.stationarity <= self.options.tolerance && self.kkt.violation > self.options.feasibility
        {
            return Direction::Stationary;
        }
        if self.promise.reduction(1.0) > 0.0 { Direction::Step } else { Direction::None }
    }
}
