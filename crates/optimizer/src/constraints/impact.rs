//! Validity of the impact (§4.2, eq. 12): the impulse pushes and does not slide, the other foot leaves.
//!
//! Impulse upward; tangential impulse at most μ times it; vertical velocity of the leaving foot ≥ 0.

use super::sharing::{applies, first, length, offsets, second};
use piaffe_model::units::Units;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

/// Formulas on the results of a touchdown kernel.
#[derive(Clone, Debug)]
pub struct ImpactConstraints<T = f64> {
    friction: T,
    lateral: bool,
    /// The robot's units of an impulse and of a velocity.
    unit: f64,
    speed: f64,
    components: usize,
    /// The real feet that land, from the virtual foot along Xf, if their limits count.
    feet: Vec<f64>,
}

impl<T: Scalar> ImpactConstraints<T> {
    /// With this coefficient of friction.
    pub fn with(description: &Description, friction: T) -> ImpactConstraints<T> {
        let units = Units::new(description);
        ImpactConstraints {
            friction,
            lateral: description.lateral,
            unit: units.impulse(),
            speed: units.speed(),
            components: description.positions(),
            feet: if applies(description) { offsets(description) } else { Vec::new() },
        }
    }

    /// Which limit value `i` is.
    pub fn limit(&self, i: usize) -> Limit {
        match (i, self.lateral) {
            (0, _) => Limit::VerticalImpulse,
            (1, _) | (2, false) => Limit::ImpulseFriction,
            _ if i < self.of_virtual_leg() => Limit::Leaving,
            _ => Limit::ImpulseFrictionOfFoot,
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        self.of_virtual_leg() + self.feet.len()
    }

    fn of_virtual_leg(&self) -> usize {
        if self.lateral { 3 } else { 4 }
    }

    /// `μ I_y − |(I_x, I_z)|` of a real foot from the results of a touchdown; see `sharing`.
    fn friction_of_foot<S: Scalar>(&self, friction: S, foot: usize, y: impl Fn(usize) -> S) -> S {
        let over = 0.5 / self.feet[foot];
        let vertical = y(1).scale(0.5) + y(3).scale(over);
        let lateral = y(2).scale(0.5) + y(4).scale(over);
        friction * vertical - length([y(0).scale(0.5), lateral], self.unit)
    }

    /// Where impulse and couple stand among a touchdown's results.
    fn index(&self, k: usize) -> usize {
        if k < self.components { k } else { k + 2 }
    }

    /// Scaled value `i` from (impulse…, leaving, landing, couple…).
    pub fn value(&self, i: usize, y: &[T]) -> T {
        let (mu, unit) = (self.friction, T::from(self.unit));
        if let Some(foot) = i.checked_sub(self.of_virtual_leg()) {
            return self.friction_of_foot(mu, foot, |k| y[self.index(k)]) / unit;
        }
        match (i, self.lateral) {
            (0, _) => y[1] / unit,
            (1, true) => (mu * y[1] - norm(y)) / unit,
            (1, false) => (mu * y[1] + y[0]) / unit,
            (2, false) => (mu * y[1] - y[0]) / unit,
            _ => y[self.components] / T::from(self.speed),
        }
    }
}

impl ImpactConstraints {
    pub fn new(description: &Description) -> ImpactConstraints {
        ImpactConstraints::with(description, description.limits.friction)
    }

    /// Calls `add(index in (impulse…, leaving, landing, couple…), partial derivative)` for value `i`.
    pub fn partials(&self, i: usize, y: &[f64], mut add: impl FnMut(usize, f64)) {
        if let Some(foot) = i.checked_sub(self.of_virtual_leg()) {
            let own: [f64; 5] = std::array::from_fn(|k| y[self.index(k)]);
            let gradient = first(&own, |v| self.friction_of_foot(self.friction.into(), foot, |k| v[k]));
            return (0..5).for_each(|k| add(self.index(k), gradient[k] / self.unit));
        }
        let mu = self.friction / self.unit;
        match (i, self.lateral) {
            (0, _) => add(1, 1.0 / self.unit),
            (1, true) => {
                let norm = norm(y).max(TINY * self.unit);
                add(0, -y[0] / norm / self.unit);
                add(2, -y[2] / norm / self.unit);
                add(1, mu);
            }
            (1, false) | (2, false) => {
                add(1, mu);
                add(0, if i == 1 { 1.0 } else { -1.0 } / self.unit);
            }
            _ => add(self.components, 1.0 / self.speed),
        }
    }

    /// Calls `add(index, index, second derivative)` for value `i`.
    pub fn curvature(&self, i: usize, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        if let Some(foot) = i.checked_sub(self.of_virtual_leg()) {
            let own: [f64; 5] = std::array::from_fn(|k| y[self.index(k)]);
            let hessian = second(&own, |v| self.friction_of_foot(self.friction.into(), foot, |k| v[k]));
            for (a, row) in hessian.iter().enumerate() {
                row.iter().enumerate().for_each(|(b, x)| add(self.index(a), self.index(b), x / self.unit));
            }
            return;
        }
        if !(self.lateral && i == 1) {
            return;
        }
        let norm = norm(y).max(TINY * self.unit);
        for a in [0, 2] {
            for b in [0, 2] {
                let unit = if a == b { 1.0 } else { 0.0 };
                add(a, b, (y[a] * y[b] / (norm * norm) - unit) / norm / self.unit);
            }
        }
    }
}

/// Below this share of its unit a tangential impulse has no direction.
const TINY: f64 = 1e-13;

/// Norm of the tangential part of an impulse in space.
fn norm<T: Scalar>(y: &[T]) -> T {
    (y[0] * y[0] + y[2] * y[2]).sqrt()
}
