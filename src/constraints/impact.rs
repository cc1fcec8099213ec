//! Validity of the impact (§4.2, eq. 12): the impulse pushes and does not slide, the other foot leaves.
//!
//! Impulse upward; tangential impulse at most μ times it; vertical velocity of the leaving foot ≥ 0.

use crate::model::Description;
use crate::verify::scalar::Scalar;

/// Formulas on the results of a touchdown kernel.
#[derive(Clone, Debug)]
pub struct ImpactConstraints<T = f64> {
    friction: T,
    lateral: bool,
    /// Unit of an impulse: total mass times 1 m/s.
    unit: f64,
    components: usize,
}

impl<T: Scalar> ImpactConstraints<T> {
    /// With this coefficient of friction.
    pub fn with(description: &Description, friction: T) -> ImpactConstraints<T> {
        ImpactConstraints {
            friction,
            lateral: description.lateral,
            unit: description.total_mass(),
            components: description.positions(),
        }
    }

    pub fn name(&self, i: usize) -> &'static str {
        match (i, self.lateral) {
            (0, _) => "vertical impulse",
            (1, _) | (2, false) => "friction of the impulse",
            _ => "leaving foot",
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        if self.lateral { 3 } else { 4 }
    }

    /// Scaled value `i` from (impulse…, leaving velocity).
    pub fn value(&self, i: usize, y: &[T]) -> T {
        let (mu, unit) = (self.friction, T::from(self.unit));
        match (i, self.lateral) {
            (0, _) => y[1] / unit,
            (1, true) => (mu * y[1] - norm(y)) / unit,
            (1, false) => (mu * y[1] + y[0]) / unit,
            (2, false) => (mu * y[1] - y[0]) / unit,
            _ => y[self.components],
        }
    }
}

impl ImpactConstraints {
    pub fn new(description: &Description) -> ImpactConstraints {
        ImpactConstraints::with(description, description.limits.friction)
    }

    /// Calls `add(index in (impulse…, leaving), partial derivative)` for value `i`.
    pub fn partials(&self, i: usize, y: &[f64], mut add: impl FnMut(usize, f64)) {
        let mu = self.friction / self.unit;
        match (i, self.lateral) {
            (0, _) => add(1, 1.0 / self.unit),
            (1, true) => {
                let norm = norm(y).max(TINY);
                add(0, -y[0] / norm / self.unit);
                add(2, -y[2] / norm / self.unit);
                add(1, mu);
            }
            (1, false) | (2, false) => {
                add(1, mu);
                add(0, if i == 1 { 1.0 } else { -1.0 } / self.unit);
            }
            _ => add(self.components, 1.0),
        }
    }

    /// Calls `add(index, index, second derivative)` for value `i`.
    pub fn curvature(&self, i: usize, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        if !(self.lateral && i == 1) {
            return;
        }
        let norm = norm(y).max(TINY);
        for a in [0, 2] {
            for b in [0, 2] {
                let unit = if a == b { 1.0 } else { 0.0 };
                add(a, b, (y[a] * y[b] / (norm * norm) - unit) / norm / self.unit);
            }
        }
    }
}

/// Below this a tangential impulse (N·s) has no direction.
const TINY: f64 = 1e-12;

/// Norm of the tangential part of an impulse in space.
fn norm<T: Scalar>(y: &[T]) -> T {
    (y[0] * y[0] + y[2] * y[2]).sqrt()
}
