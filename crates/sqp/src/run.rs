//! The state of one optimization and how an iteration changes it: measure the iterate, learn its curvature, take the multipliers
//! of a subproblem, move.

use super::convexify::Convexifier;
use super::dense::{axpy, max_abs, norm};
use super::kkt;
use super::merit::{Merit, Promise};
use super::quasi_newton::QuasiNewton;
use super::scaled::{Point, Scaled};
use super::screening::Subproblem;
use super::{Conflict, Iteration, Kind, KktResidual, Options, Problem, Solution, Status, Undefined};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    Optimality,
    /// Entered at this violation.
    Feasibility {
        from: f64,
    },
}

/// All state of one optimization; nothing is allocated after `new` except by Clarabel.
pub(super) struct Run<'a, 'p, P: Problem> {
    pub(super) options: &'a Options,
    pub(super) view: Scaled<'p, P>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) subproblem: Subproblem,
    pub(super) merit: Merit,
    pub(super) phase: Phase,

    /// The iterate, ∇f there, and the next candidate.
    pub(super) point: Point,
    pub(super) gradient: Vec<f64>,
    pub(super) trial: Point,
    pub(super) trial_gradient: Vec<f64>,

    /// Multipliers: of the Lagrangian, or in the feasibility phase of the violation.
    pub(super) lambda: Vec<f64>,
    pub(super) mu: Vec<f64>,
    pub(super) nu: Vec<f64>,
    pub(super) kkt: KktResidual,

    /// The subproblem's step and promise.
    pub(super) d: Vec<f64>,
    pub(super) promise: Promise,
    pub(super) kind: Kind,
    /// Largest component of the next step; see `trial`.
    pub(super) radius: f64,
    /// The last subproblem of the optimality phase gave way.
    pub(super) elastic: bool,
    active: usize,

    /// Curvature of the Lagrangian, of the violation, and of the Lagrangian by exact second derivatives.
    pub(super) lagrangian_model: QuasiNewton,
    pub(super) violation_model: QuasiNewton,
    pub(super) exact: bool,
    /// At this iterate the exact Hessian has led nowhere.
    pub(super) distrust: bool,
    pub(super) hessian: Vec<f64>,
    pub(super) hessian_known: bool,
    /// The multipliers are those of the violation.
    pub(super) violation_multipliers: bool,
    pub(super) zeros: (Vec<f64>, Vec<f64>),
    pub(super) convexifier: Convexifier,
    pub(super) curvature: Vec<f64>,

    /// ∇L at the former iterate with the present multipliers; pending until ∇L is known at the new one.
    former: Vec<f64>,
    s: Vec<f64>,
    y: Vec<f64>,
    pending: bool,
    pub(super) stalls: usize,
    /// The violation that counts as progress in the feasibility phase, and the iterations since it was reached.
    pub(super) record: (f64, usize),
}

impl<'a, 'p, P: Problem> Run<'a, 'p, P> {
    pub(super) fn new(view: Scaled<'p, P>, options: &'a Options) -> Self {
        let (n, equalities, inequalities) = (view.n, view.equalities, view.inequalities);
        let (lower, upper) = view.bounds();
        let zeros = || vec![0.0; n];
        Self {
            options,
            lower,
            upper,
            subproblem: Subproblem::new(n, equalities, inequalities, view.folds(), options.subproblems),
            merit: Merit::new(options.penalty),
            phase: Phase::Optimality,
            point: Point::new(n, equalities, inequalities),
            gradient: zeros(),
            trial: Point::new(n, equalities, inequalities),
            trial_gradient: zeros(),
            lambda: vec![0.0; equalities],
            mu: vec![0.0; inequalities],
            nu: zeros(),
            kkt: KktResidual::UNKNOWN,
            d: zeros(),
            promise: Promise::default(),
            kind: Kind::Start,
            radius: options.first_step_limit,
            elastic: false,
            active: 0,
            lagrangian_model: QuasiNewton::new(n),
            violation_model: QuasiNewton::new(n),
            exact: options.exact_hessian,
            distrust: false,
            hessian: vec![0.0; n * n],
            hessian_known: false,
            violation_multipliers: false,
            zeros: (vec![0.0; equalities], vec![0.0; inequalities]),
            convexifier: Convexifier::new(n),
            curvature: vec![0.0; n * n],
            former: zeros(),
            s: zeros(),
            y: zeros(),
            pending: false,
            stalls: 0,
            record: (f64::INFINITY, 0),
            view,
        }
    }

    /// The first point, its values and its derivatives.
    pub(super) fn start(&mut self, x0: &[f64]) -> Result<(), Undefined> {
        self.view.enter(x0, &mut self.point.z);
        self.view.evaluate(&mut self.point)?;
        self.view.linearize(&mut self.gradient)?;
        if self.options.scale_rows {
            self.view.weigh_rows()?;
            self.view.weigh(&mut self.point);
        }
        self.merit.ceiling = self.point.violation;
        self.forget();
        self.subproblem.gather(&self.view, &self.point, &self.mu)?;
        if self.exact && self.options.estimate_multipliers { self.estimate_multipliers() } else { Ok(()) }
    }

    /// Curvature before any is known: the unconstrained step has the length of `Options::initial_step`.
    pub(super) fn forget(&mut self) {
        let size = norm(&self.gradient) / self.options.initial_step;
        self.lagrangian_model.reset(if size > 0.0 { size } else { 1.0 });
        self.violation_model.reset(self.proximity());
        self.pending = false;
    }

    /// Curvature of the violation before any is known: a step of the initial length costs a tenth of what it could gain.
    pub(super) fn proximity(&self) -> f64 {
        let step = self.options.initial_step;
        (0.1 * self.point.violation / (step * step)).max(1e-6)
    }

    /// ∇L and the optimality residuals at the iterate; the rows of the multipliers are there already.
    pub(super) fn measure(&mut self) -> Result<(), Undefined> {
        self.y.fill(0.0);
        if self.phase == Phase::Optimality {
            self.y.copy_from_slice(&self.gradient);
        }
        self.subproblem.subtract_forces(&self.lambda, &self.mu, &mut self.y);
        // `y` now is ∇L; `trial_gradient` is free between attempts.
        self.trial_gradient.copy_from_slice(&self.y);
        kkt::project(&self.point.z, &self.lower, &self.upper, &mut self.trial_gradient, &mut self.nu);
        self.kkt = kkt::residual(&self.view, &self.point, self.size(), &self.trial_gradient, &self.mu);
        if self.y.iter().all(|y| y.is_finite()) { Ok(()) } else { Err(Undefined) }
    }

    /// What stationarity is measured against.
    fn size(&self) -> f64 {
        match self.phase {
            Phase::Optimality => max_abs(&self.gradient).max(1.0),
            Phase::Feasibility { .. } => self.subproblem.largest_force(&self.lambda, &self.mu).max(1.0),
        }
    }

    pub(super) fn optimal(&self) -> bool {
        self.phase == Phase::Optimality
            && self.kkt.stationarity <= self.options.tolerance
            && self.kkt.complementarity <= self.options.tolerance
            && self.kkt.violation <= self.options.feasibility
    }

    /// Updates the quasi-Newton model of the phase with the step that led here; `measure` left ∇L in `y`.
    pub(super) fn learn(&mut self) {
        if self.pending {
            axpy(-1.0, &self.former, &mut self.y);
            match self.phase {
                Phase::Optimality => self.lagrangian_model.update(&self.s, &self.y),
                Phase::Feasibility { .. } => self.violation_model.update(&self.s, &self.y),
            }
            self.pending = false;
        }
    }

    /// Takes the multipliers of the subproblem and measures the iterate with them. Leaves ∇L in `former` for `learn`.
    pub(super) fn adopt_multipliers(&mut self) {
        self.lambda.copy_from_slice(&self.subproblem.lambda);
        self.mu.copy_from_slice(&self.subproblem.mu);
        self.former.fill(0.0);
        if self.phase == Phase::Optimality {
            self.former.copy_from_slice(&self.gradient);
        }
        self.subproblem.subtract_forces(&self.lambda, &self.mu, &mut self.former);
        self.trial_gradient.copy_from_slice(&self.former);
        kkt::project(&self.point.z, &self.lower, &self.upper, &mut self.trial_gradient, &mut self.nu);
        self.kkt = kkt::residual(&self.view, &self.point, self.size(), &self.trial_gradient, &self.mu);
        self.active = self.subproblem.active;
    }

    pub(super) fn look_at_violation(&mut self) {
        self.phase = Phase::Feasibility { from: self.point.violation };
        self.pending = false;
        self.hessian_known = false;
        self.record = (self.point.violation, 0);
        self.violation_model.reset(self.proximity());
    }

    /// Moves to the accepted trial point, whose derivatives are ready.
    pub(super) fn advance(&mut self) {
        for ((s, new), old) in self.s.iter_mut().zip(&self.trial.z).zip(&self.point.z) {
            *s = new - old;
        }
        let still = self.s.iter().zip(&self.point.z).all(|(s, z)| s.abs() <= 1e-14 * (1.0 + z.abs()));
        self.stalls = if still { self.stalls + 1 } else { 0 };
        self.pending = true;
        if self.phase != Phase::Optimality {
            let progress = self.trial.violation < 0.99 * self.record.0;
            self.record = if progress { (self.trial.violation, 0) } else { (self.record.0, self.record.1 + 1) };
        }
        std::mem::swap(&mut self.point, &mut self.trial);
        // `attempt` put the new gradient into `trial_gradient`.
        std::mem::swap(&mut self.gradient, &mut self.trial_gradient);
    }

    pub(super) fn report(&self, k: usize) -> Iteration {
        Iteration {
            k,
            objective: self.point.values.objective,
            violation: self.kkt.violation,
            stationarity: self.kkt.stationarity,
            step: if k == 0 { 0.0 } else { max_abs(&self.s) },
            radius: self.radius,
            penalty: self.merit.high,
            active: self.active,
            rows: self.subproblem.rows(),
            kind: self.kind,
        }
    }

    /// The solution is made of the run's own memory: the end allocates nothing either, whatever there is to tell.
    pub(super) fn end(self, status: Status, iterations: usize) -> Solution {
        let Run { view, mut point, trial, lambda, mu, nu, .. } = self;
        let times = |mut to: Vec<f64>, from: &[f64], w: &[f64]| {
            to.iter_mut().zip(from.iter().zip(w)).for_each(|(to, (m, w))| *to = m * w);
            to
        };
        let equalities = times(trial.values.equalities, &lambda, &view.equality_weights);
        let inequalities = times(trial.values.inequalities, &mu, &view.inequality_weights);
        let mut bounds = self.d;
        bounds.iter_mut().zip(nu.iter().zip(&view.scale)).for_each(|(b, (nu, s))| *b = nu / s);
        let conflict = (status == Status::Infeasible).then(|| {
            let mut same = nu;
            same.copy_from_slice(&bounds);
            Conflict { equalities: lambda, inequalities: mu, bounds: same, stationarity: self.kkt.stationarity }
        });
        let mut x = trial.z;
        view.leave(&point.z, &mut x);
        view.unweigh(&mut point);
        let values = point.values;
        Solution {
            x,
            objective: values.objective,
            values,
            equality_multipliers: equalities,
            inequality_multipliers: inequalities,
            bound_multipliers: bounds,
            status,
            iterations,
            evaluations: view.evaluations,
            linearizations: view.linearizations,
            interior_solves: self.subproblem.interior_solves,
            kkt: self.kkt,
            conflict,
        }
    }
}
