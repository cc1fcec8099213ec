//! Folds of the objective: where a term of it changes its sign and counts on as its magnitude.
//!
//! An objective with terms |c(x)|, or with their integrals over something narrow, has a gradient and a Hessian that say nothing of the
//! other side of c = 0. Steps that trust them zigzag across it. So the subproblem is told: |c| is c + 2·max(0, −c), of which the
//! objective's own derivatives know the first part; the second is an elastic row of price 2, like a constraint that may give way
//! (Fletcher's Sℓ1QP, of the objective instead of the constraints). Where no step crosses a fold, nothing changes.

use super::Problem;
use super::problem::Undefined;
use super::qp::Place;
use super::scaled::Scaled;

/// What the slope changes by at a fold, in units of c.
const PRICE: f64 = 2.0;

/// The folds at the linearized point.
pub(super) struct Folds {
    /// c; no number where there is no such fold now.
    values: Vec<Option<f64>>,
    /// ∇c·d of the last step.
    pub(super) directions: Vec<f64>,
    /// Which have a row in the subproblem.
    pub(super) used: Vec<bool>,
    /// Where each stood in the last solution.
    pub(super) places: Vec<Place>,
    /// Whether the objective counts.
    pub(super) counted: bool,
}

impl Folds {
    pub(super) fn new(count: usize) -> Self {
        Self {
            values: vec![None; count],
            directions: vec![0.0; count],
            used: vec![false; count],
            places: vec![Place::Off; count],
            counted: true,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.values.len()
    }

    pub(super) fn linearize<P: Problem>(&mut self, view: &Scaled<P>) -> Result<(), Undefined> {
        for (k, value) in self.values.iter_mut().enumerate() {
            *value = view.fold(k)?;
        }
        self.used.fill(false);
        Ok(())
    }

    /// c.
    pub(super) fn value(&self, k: usize) -> f64 {
        self.values[k].unwrap_or_default()
    }

    /// Whether there is such a fold now, and the last step came to it.
    pub(super) fn was_met(&self, k: usize) -> bool {
        self.values[k].is_some() && self.places[k] != Place::Off
    }

    /// Of a step beyond a fold, per distance of c.
    pub(super) fn price(&self) -> f64 {
        if self.counted { PRICE } else { 0.0 }
    }

    /// What the last step adds to the objective, beyond this fold.
    pub(super) fn beyond(&self, k: usize) -> f64 {
        let Some(value) = self.values[k] else { return 0.0 };
        self.price() * (-(value + self.directions[k])).max(0.0)
    }
}
