//! The constraints of §4.2 and §6.1, one file each.
//!
//! A *path constraint* holds at every instant of a phase and is a formula in the quantities of an instant; an
//! *impact constraint* holds where a foot lands. All read `value ≥ 0` after division by a
//! natural unit, so that 1e-6 means the same everywhere.

mod actuator;
mod going;
mod ground;
mod impact;
mod limits;
mod range;
mod reaction;
pub mod sharing;
mod swing;

pub use impact::ImpactConstraints;
pub use limits::{JointLimits, Limits};

use crate::instant::Quantities;
use crate::passive::Passive;
use crate::swing::swings;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;
use sharing::Share;

/// A constraint on the quantities of an instant: `value ≥ 0`.
#[derive(Clone, Debug)]
pub struct PathConstraint<T = f64> {
    pub limit: Limit,
    /// The joint, leg or point that it is of, as reports show it; empty where there is but one.
    pub of: String,
    pub form: Form<T>,
    /// Unit in which the value is measured.
    pub unit: f64,
    /// Whether it also is imposed at the first instant (a joint's range there is that of the last).
    pub at_start: bool,
    /// Whether it is imposed only where somebody asks for it (`Cycle::keep_going`).
    pub on_demand: bool,
}

/// The formula of a path constraint.
#[derive(Clone, Debug)]
pub enum Form<T = f64> {
    /// `offset + Σ coefficient · quantity`.
    Linear { offset: T, terms: Vec<(usize, T)> },
    /// `factor · normal − ‖tangential‖`.
    Cone { normal: usize, factor: T, tangential: Vec<usize> },
    /// A limit on one of the real legs.
    Share(Share<T>),
    /// `offset + by_torque · Γ + by_rate · q̇`, where Γ is that of a motor with something to overcome; quantities with these factors.
    /// `side`: with dry friction as if the joint turned that way, −1 or 1; else as it turns.
    Motor { offset: T, torque: (usize, T), angle: usize, rate: (usize, T), passive: Passive<T>, side: Option<f64> },
}

/// All path constraints of phase `k` of a gait.
pub fn path_constraints(description: &Description, k: usize) -> Vec<PathConstraint> {
    path_constraints_of(description, &Limits::new(description), k)
}

/// The same with limits that are numbers of any kind; units are the description's.
pub fn path_constraints_of<T: Scalar>(
    description: &Description,
    limits: &Limits<T>,
    k: usize,
) -> Vec<PathConstraint<T>> {
    let mode = description.phases[k].mode;
    let y = Quantities::new(description, mode);
    let mut list = actuator::constraints(description, limits, &y);
    if mode.stance().is_some() {
        list.extend(reaction::constraints(description, limits, &y));
    }
    list.extend(swing::constraints(description, limits, &y, &swings(description, k)));
    list.extend(ground::constraints(description, limits, &y));
    list.extend(range::constraints(description, limits, &y));
    if let Some(leg) = mode.stance() {
        list.extend(sharing::constraints(description, limits, &y, leg));
    }
    list.extend(going::constraints(description, &y));
    list
}

impl<T: Scalar> PathConstraint<T> {
    /// Imposed at every instant.
    fn new(limit: Limit, unit: f64, form: Form<T>) -> PathConstraint<T> {
        PathConstraint { limit, of: String::new(), form, unit, at_start: true, on_demand: false }
    }

    fn linear(limit: Limit, unit: f64, offset: T, terms: Vec<(usize, T)>) -> PathConstraint<T> {
        PathConstraint::new(limit, unit, Form::Linear { offset, terms })
    }

    /// Whether it is imposed at this node of a phase.
    pub fn is_imposed(&self, node: usize) -> bool {
        !self.on_demand && (node > 0 || self.at_start)
    }

    fn of(self, what: impl Into<String>) -> PathConstraint<T> {
        PathConstraint { of: what.into(), ..self }
    }

    /// Scaled value for the quantities of an instant.
    #[inline]
    pub fn value(&self, y: &[T]) -> T {
        let value = match &self.form {
            Form::Linear { offset, terms } => *offset + terms.iter().fold(T::zero(), |sum, (q, c)| sum + *c * y[*q]),
            Form::Cone { normal, factor, tangential } => *factor * y[*normal] - norm(y, tangential),
            Form::Share(share) => share.value(y),
            Form::Motor { offset, torque, angle, rate, passive, side } => {
                let motor = y[torque.0]
                    + match side {
                        Some(side) => passive.smooth(y[*angle], y[rate.0]) + passive.coulomb.scale(*side),
                        None => passive.torque(y[*angle], y[rate.0]),
                    };
                *offset + rate.1 * y[rate.0] + torque.1 * motor
            }
        };
        value / T::from(self.unit)
    }
}

impl PathConstraint {
    /// Of a limit of a motor that overcomes dry friction: which quantity the joint's rate is, and for which side it is meant, if for one.
    pub fn dry(&self) -> Option<(usize, Option<f64>)> {
        match &self.form {
            Form::Motor { rate, passive, side, .. } if passive.coulomb != 0.0 => Some((rate.0, *side)),
            _ => None,
        }
    }

    /// Calls `add(quantity, partial derivative)` for each quantity that the value depends on.
    #[inline]
    pub fn partials(&self, y: &[f64], mut add: impl FnMut(usize, f64)) {
        match &self.form {
            Form::Linear { terms, .. } => terms.iter().for_each(|(q, c)| add(*q, c / self.unit)),
            Form::Cone { normal, factor, tangential } => {
                add(*normal, factor / self.unit);
                let norm = norm(y, tangential).max(TINY * self.unit);
                for q in tangential {
                    add(*q, -y[*q] / norm / self.unit);
                }
            }
            Form::Share(share) => share.partials(y, |q, partial| add(q, partial / self.unit)),
            // Where the rate changes its sign the limit jumps (`side`).
            Form::Motor { torque, angle, rate, passive, .. } => {
                add(torque.0, torque.1 / self.unit);
                add(*angle, torque.1 * passive.stiffness / self.unit);
                add(rate.0, (rate.1 + torque.1 * passive.damping) / self.unit);
            }
        }
    }

    /// Calls `add(quantity, quantity, second derivative)`.
    pub fn curvature(&self, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        let tangential = match &self.form {
            Form::Linear { .. } | Form::Motor { .. } => return,
            Form::Share(share) => return share.curvature(y, |a, b, second| add(a, b, second / self.unit)),
            Form::Cone { tangential, .. } => tangential,
        };
        let norm = norm(y, tangential).max(TINY * self.unit);
        for a in tangential {
            for b in tangential {
                let unit = if a == b { 1.0 } else { 0.0 };
                add(*a, *b, (y[*a] * y[*b] / (norm * norm) - unit) / norm / self.unit);
            }
        }
    }
}

/// Below this share of its unit a tangential force has no direction.
const TINY: f64 = 1e-11;

fn norm<T: Scalar>(y: &[T], quantities: &[usize]) -> T {
    quantities.iter().fold(T::zero(), |sum, q| sum + y[*q] * y[*q]).sqrt()
}
