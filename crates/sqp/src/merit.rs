//! The ℓ1 merit function φ_ρ = f + ρ·v, v = Σ violations, with a flexible penalty (Curtis & Nocedal 2008): a step is good if
//! it sufficiently reduces φ_ρ for *some* ρ of an interval [low, high]. φ is linear in ρ, so the two ends decide. Large ρ
//! keeps every subproblem's step a descent direction; small ρ lets the objective speak early, as a filter would; the interval
//! shrinks towards `high` whenever only `high` would do, so that in the end one merit function governs and no cycle survives.

/// Fraction of the model's reduction that the functions must deliver.
const SUFFICIENT: f64 = 1e-4;
/// Share of the linearized violation's decrease that the model of φ must show.
const SHARE: f64 = 0.1;
/// How often the penalty may come down. A finite number, so that one merit function governs in the end.
const LOWERINGS: usize = 40;

/// Violation, in units of the first point's (or one), that no step may reach from below (as in Wächter & Biegler 2006).
const RUNAWAY: f64 = 1e4;

#[derive(Clone, Debug)]
pub(super) struct Merit {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Violation above which only the high end may let it grow: what low penalties buy must not run away.
    pub(super) ceiling: f64,
    /// How many more times the penalty may be lowered.
    lowerings: usize,
}

/// What the subproblem promises for its full step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Promise {
    /// ∇fᵀd, and what folds of f add.
    pub(super) slope: f64,
    /// dᵀHd ≥ 0.
    pub(super) curvature: f64,
    /// v(z) − v_linear(z + d).
    pub(super) relief: f64,
}

impl Promise {
    /// Reduction of the model of φ_ρ.
    pub(super) fn reduction(&self, penalty: f64) -> f64 {
        -self.slope - 0.5 * self.curvature + penalty * self.relief
    }
}

impl Merit {
    pub(super) fn new(penalty: f64) -> Self {
        let high = if penalty.is_finite() && penalty > 0.0 { penalty } else { 1.0 };
        Self { low: 1e-3 * high, high, ceiling: 0.0, lowerings: LOWERINGS }
    }

    /// Raises the penalty until the promised reduction of φ is at least a share of ρ times the promised relief
    /// (Nocedal & Wright eq. 18.36). `needed` never exceeds the largest multiplier by much.
    pub(super) fn prepare(&mut self, promise: &Promise) {
        if promise.relief > 0.0 {
            let needed = (promise.slope + 0.5 * promise.curvature) / ((1.0 - SHARE) * promise.relief);
            if needed.is_finite() && needed > self.high {
                self.high = 1.5 * needed;
            }
        }
    }

    /// The merit function of the violation alone.
    pub(super) fn of_violation() -> Self {
        Self { low: 1.0, high: 1.0, ceiling: 0.0, lowerings: 0 }
    }

    /// Lowers a penalty that a bad spell has driven far beyond the largest multiplier: it would tie the iterates to every
    /// bend of the constraints.
    pub(super) fn relax(&mut self, largest_multiplier: f64) {
        let enough = (2.0 * largest_multiplier).max(1.0);
        if self.lowerings > 0 && self.high > 2.0 * enough {
            self.high = enough;
            self.low = self.low.min(enough);
            self.lowerings -= 1;
        }
    }

    pub(super) fn raise(&mut self, penalty: f64) {
        self.high = self.high.max(penalty);
    }

    /// Whether going from (f, v) to (f⁺, v⁺) keeps enough of the promise.
    pub(super) fn accepts(&mut self, promise: &Promise, from: (f64, f64), to: (f64, f64)) -> bool {
        let keeps = |penalty: f64| {
            let promised = promise.reduction(penalty);
            // Changes below the functions' own rounding must not block the last steps.
            let rounding = 1e-15 * (from.0.abs() + penalty * from.1).max(1e-300) * 10.0;
            let change = (to.0 - from.0) + penalty * (to.1 - from.1);
            promised >= -rounding && change <= -SUFFICIENT * promised.max(0.0) + rounding
        };
        if to.1 > RUNAWAY * self.ceiling.max(1.0) && to.1 > from.1 {
            // The objective has no floor out there, and the penalty is too low to provide one.
            self.raise(10.0 * self.high);
            return false;
        }
        let tame = to.1 <= self.ceiling.max(from.1);
        let (by_low, by_high) = (tame && promise.reduction(self.low) > 0.0 && keeps(self.low), keeps(self.high));
        if by_high && !by_low && to.1 < from.1 {
            // The price of violation at which this step breaks even.
            let price = (to.0 - from.0) / (from.1 - to.1);
            self.low = self.high.min(self.low + (0.1 * (price - self.low)).max(1e-4 * self.high));
        }
        by_low || by_high
    }

    /// Which share of the promised reduction going from (f, v) to (f⁺, v⁺) delivers, by the end of the interval that sees more of it.
    pub(super) fn kept(&self, promise: &Promise, from: (f64, f64), to: (f64, f64)) -> f64 {
        let by = |penalty: f64| {
            let promised = promise.reduction(penalty);
            if promised > 0.0 { ((from.0 - to.0) + penalty * (from.1 - to.1)) / promised } else { 0.0 }
        };
        by(self.low).max(by(self.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_penalty_makes_the_step_a_descent_direction() {
        let mut merit = Merit::new(1.0);
        let promise = Promise { slope: 5.0, curvature: 1.0, relief: 0.1 };
        merit.prepare(&promise);
        assert!(promise.reduction(merit.high) >= SHARE * merit.high * promise.relief);
    }

    #[test]
    fn what_was_promised_and_came_is_kept() {
        let merit = Merit { low: 0.1, high: 10.0, ceiling: 1.0, lowerings: 0 };
        let promise = Promise { slope: -1.0, curvature: 0.5, relief: 0.1 };
        let [from, to] = [(0.0, 0.1), (-0.375, 0.1)];
        // The low end was promised 0.76, the high one 1.75, of which 0.375 came.
        assert!((merit.kept(&promise, from, to) - 0.375 / 0.76).abs() < 1e-12);
    }

    #[test]
    fn either_end_of_the_interval_may_accept() {
        let mut merit = Merit { low: 0.01, high: 10.0, ceiling: 1.0, lowerings: 0 };
        // Less f for more v: good for the low end only.
        let promise = Promise { slope: -1.0, curvature: 0.5, relief: 0.1 };
        assert!(merit.accepts(&promise, (0.0, 0.1), (-0.7, 0.3)));
        // More of both is good for neither.
        assert!(!merit.accepts(&promise, (0.0, 0.1), (0.1, 0.3)));
    }
}
