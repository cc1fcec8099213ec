//! The constraints of §4.2 and §6.1, one file each.
//!
//! A *path constraint* holds at every instant and is a formula in the quantities of an instant; an
//! *impact constraint* holds at the end of a half step. All read `value ≥ 0` after division by a
//! natural unit, so that 1e-6 means the same everywhere.

mod actuator;
mod ground;
mod impact;
mod range;
mod reaction;
mod swing;

pub use impact::ImpactConstraints;

use crate::instant::Quantities;
use crate::model::Description;

/// A constraint on the quantities of an instant: `value ≥ 0`.
#[derive(Clone, Debug)]
pub struct PathConstraint {
    /// In words, as reports show it.
    pub name: String,
    pub form: Form,
    /// Unit in which the value is measured.
    pub unit: f64,
    /// Whether it also is imposed at the first instant (a joint's range there is that of the last).
    pub at_start: bool,
}

/// The formula of a path constraint.
#[derive(Clone, Debug)]
pub enum Form {
    /// `offset + Σ coefficient · quantity`.
    Linear { offset: f64, terms: Vec<(usize, f64)> },
    /// `factor · normal − ‖tangential‖`.
    Cone { normal: usize, factor: f64, tangential: Vec<usize> },
}

/// All path constraints of a gait.
pub fn path_constraints(description: &Description) -> Vec<PathConstraint> {
    let y = Quantities::new(description);
    let mut list = actuator::constraints(description, &y);
    list.extend(reaction::constraints(description, &y));
    list.push(swing::constraint(description, &y));
    list.push(ground::constraint(description, &y));
    list.extend(range::constraints(description, &y));
    list
}

impl PathConstraint {
    fn linear(name: String, unit: f64, offset: f64, terms: Vec<(usize, f64)>) -> PathConstraint {
        PathConstraint { name, form: Form::Linear { offset, terms }, unit, at_start: true }
    }

    /// Scaled value for the quantities of an instant.
    #[inline]
    pub fn value(&self, y: &[f64]) -> f64 {
        let value = match &self.form {
            Form::Linear { offset, terms } => offset + terms.iter().map(|(q, c)| c * y[*q]).sum::<f64>(),
            Form::Cone { normal, factor, tangential } => factor * y[*normal] - norm(y, tangential),
        };
        value / self.unit
    }

    /// Calls `add(quantity, partial derivative)` for each quantity that the value depends on.
    #[inline]
    pub fn partials(&self, y: &[f64], mut add: impl FnMut(usize, f64)) {
        match &self.form {
            Form::Linear { terms, .. } => terms.iter().for_each(|(q, c)| add(*q, c / self.unit)),
            Form::Cone { normal, factor, tangential } => {
                add(*normal, factor / self.unit);
                let norm = norm(y, tangential).max(TINY);
                for q in tangential {
                    add(*q, -y[*q] / norm / self.unit);
                }
            }
        }
    }

    /// Calls `add(quantity, quantity, second derivative)`; only a cone has any.
    pub fn curvature(&self, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        let Form::Cone { tangential, .. } = &self.form else { return };
        let norm = norm(y, tangential).max(TINY);
        for a in tangential {
            for b in tangential {
                let unit = if a == b { 1.0 } else { 0.0 };
                add(*a, *b, (y[*a] * y[*b] / (norm * norm) - unit) / norm / self.unit);
            }
        }
    }
}

/// Below this a tangential force (N) has no direction.
const TINY: f64 = 1e-9;

fn norm(y: &[f64], quantities: &[usize]) -> f64 {
    quantities.iter().map(|q| y[*q] * y[*q]).sum::<f64>().sqrt()
}
