//! Validity of the impact (§4.2, eq. 12): the impulse pushes and does not slide, the other foot leaves.
//!
//! Impulse upward; tangential impulse at most μ times it; vertical velocity of the leaving foot ≥ 0.

use crate::model::Description;

/// Formulas on the results of a touchdown kernel.
#[derive(Clone, Debug)]
pub struct ImpactConstraints {
    friction: f64,
    lateral: bool,
    /// Unit of an impulse: total mass times 1 m/s.
    unit: f64,
    components: usize,
}

impl ImpactConstraints {
    pub fn new(description: &Description) -> ImpactConstraints {
        ImpactConstraints {
            friction: description.limits.friction,
            lateral: description.lateral,
            unit: description.total_mass(),
            components: description.positions(),
        }
    }

    pub fn names(&self) -> Vec<&'static str> {
        let mut names = vec!["impulse upward", "friction of the impulse", "friction of the impulse", "lift-off of the other foot"];
        if self.lateral {
            names.remove(1);
        }
        names
    }

    /// Scaled values from the impulse and the leaving foot's vertical velocity.
    pub fn values(&self, impulse: &[f64], leaving: f64, out: &mut Vec<f64>) {
        let mu = self.friction;
        out.push(impulse[1] / self.unit);
        if self.lateral {
            out.push((mu * impulse[1] - impulse[0].hypot_pinned(impulse[2])) / self.unit);
        } else {
            out.push((mu * impulse[1] + impulse[0]) / self.unit);
            out.push((mu * impulse[1] - impulse[0]) / self.unit);
        }
        out.push(leaving);
    }

    /// Partial derivatives of value `i` in (impulse…, leaving).
    pub fn partials(&self, i: usize, impulse: &[f64]) -> Vec<f64> {
        let mut row = vec![0.0; self.components + 1];
        let mu = self.friction;
        match (i, self.lateral) {
            (0, _) => row[1] = 1.0 / self.unit,
            (1, true) => {
                let norm = impulse[0].hypot_pinned(impulse[2]).max(1e-12);
                row[0] = -impulse[0] / norm / self.unit;
                row[2] = -impulse[2] / norm / self.unit;
                row[1] = mu / self.unit;
            }
            (1, false) | (2, false) => {
                row[1] = mu / self.unit;
                row[0] = if i == 1 { 1.0 } else { -1.0 } / self.unit;
            }
            _ => row[self.components] = 1.0,
        }
        row
    }
}

/// Euclidean norm by the square root, which is exact on every machine.
trait Pinned {
    fn hypot_pinned(self, other: f64) -> f64;
}

impl Pinned for f64 {
    fn hypot_pinned(self, other: f64) -> f64 {
        (self * self + other * other).sqrt()
    }
}
