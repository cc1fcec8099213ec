//! How an optimization ended, and with what.

use super::Values;

/// Why the solver returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The optimality conditions hold to the tolerances.
    Optimal,
    /// A stationary point of the constraint violation that is not feasible; [`Solution::conflict`] says what conflicts, and how
    /// stationary the violation is: to the tolerance, or where the last digits come too slowly to a thousand times that.
    /// The multipliers and [`Solution::kkt`] are then those of the violation.
    Infeasible,
    /// No further progress is possible at the precision of the functions; [`Solution::kkt`] says how close this is.
    NoProgress,
    /// [`Options::iteration_limit`](super::Options::iteration_limit) reached.
    IterationLimit,
    /// The functions or their derivatives are not defined at the first point (or, derivatives, at the last).
    Undefined,
    /// The observer asked to stop.
    Stopped,
    /// The problem contradicts itself before any function is called: crossed bounds, lengths or scales that make no sense.
    Invalid,
}

impl Status {
    /// Whether the tolerances were met.
    #[must_use]
    pub fn is_optimal(self) -> bool {
        self == Self::Optimal
    }
}

/// Residuals of the optimality conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KktResidual {
    /// ‖∇f − J_Eᵀλ − J_Iᵀμ − ν‖∞ / max(1, ‖∇f‖∞), in scaled variables.
    pub stationarity: f64,
    /// max |μᵢ·cᵢ| / max(1, ‖∇f‖∞).
    pub complementarity: f64,
    /// max(|c_E|, −c_I, 0), unscaled.
    pub violation: f64,
}

impl KktResidual {
    /// How far from optimal, whatever the violation.
    pub fn optimality(&self) -> f64 {
        self.stationarity.max(self.complementarity)
    }

    pub(super) const UNKNOWN: Self =
        Self { stationarity: f64::INFINITY, complementarity: f64::INFINITY, violation: f64::INFINITY };
}

/// What [`minimize`](super::minimize) returns. All quantities are in the problem's own units.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The last iterate.
    pub x: Vec<f64>,
    /// f(x).
    pub objective: f64,
    /// The values of all functions at x.
    pub values: Values,
    /// λ of c_E(x) = 0, of the Lagrangian f − λᵀc_E − μᵀc_I − νᵀx.
    pub equality_multipliers: Vec<f64>,
    /// μ ≥ 0 of c_I(x) ≥ 0.
    pub inequality_multipliers: Vec<f64>,
    /// ν of the bounds: positive at a lower bound, negative at an upper one.
    pub bound_multipliers: Vec<f64>,
    /// Why the solver returned.
    pub status: Status,
    /// Number of iterations.
    pub iterations: usize,
    /// Number of calls of `evaluate`.
    pub evaluations: usize,
    /// Number of calls of `linearize`.
    pub linearizations: usize,
    /// Number of subproblems that went to Clarabel.
    pub interior_solves: usize,
    /// Residuals of the optimality conditions at x.
    pub kkt: KktResidual,
    /// With [`Status::Infeasible`]: which constraints contradict each other.
    pub conflict: Option<Conflict>,
}

/// Multipliers of the problem "minimize the sum of the violations": the proof that x cannot be made less infeasible, to first
/// order. A violated constraint has weight one; a satisfied one with a positive weight is in the way of the violated ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// Weights of the equalities, in [−1, 1].
    pub equalities: Vec<f64>,
    /// Weights of the inequalities, in [0, 1].
    pub inequalities: Vec<f64>,
    /// Weights of the bounds, positive at a lower bound.
    pub bounds: Vec<f64>,
    /// ‖Σ weights · gradients‖∞: how stationary the violation is.
    pub stationarity: f64,
}

impl Conflict {
    /// Equalities that take part, in order.
    pub fn conflicting_equalities(&self) -> impl Iterator<Item = usize> + '_ {
        participants(&self.equalities)
    }

    /// Inequalities that take part, in order.
    pub fn conflicting_inequalities(&self) -> impl Iterator<Item = usize> + '_ {
        participants(&self.inequalities)
    }

    /// Variables whose bounds take part, in order.
    pub fn conflicting_bounds(&self) -> impl Iterator<Item = usize> + '_ {
        participants(&self.bounds)
    }
}

fn participants(weights: &[f64]) -> impl Iterator<Item = usize> + '_ {
    weights.iter().enumerate().filter(|(_, weight)| weight.abs() > 1e-6).map(|(i, _)| i)
}
