//! The whole robot turning about its stance foot, in flight about its mass centre: angular momentum (eq. 8), its rate (eq. 9) and the balance (eq. 10).

use super::model::{Model, Origin};
use crate::expr::{Poly, Var};
use crate::mechanism::Mode;
use crate::spec::Rotation;

/// Momentum and moments about the stance foot or the mass centre, as expressions.
pub struct Turn {
    /// σ = f1 β̇ + f2 (eq. 8).
    pub sigma: Poly,
    pub f1: Poly,
    pub f2: Poly,
    /// Moment of gravity: σ̇ (eq. 9). In flight there is none.
    pub gravity_moment: Poly,
    /// Its lever arm c (eq. 9).
    pub c: Poly,
    /// Moment balance of the whole robot: zero in every motion (eq. 10).
    pub balance: Poly,
}

impl Turn {
    pub fn new(model: &mut Model, mode: Mode) -> Turn {
        let origin = Origin::from(mode);
        // The platform's rotation where it has one.
        let (sigma, balance) = match model.mechanism.rotation {
            Rotation::None => model.level_turn(origin),
            _ => {
                let theta = [model.coordinates.q[model.mechanism.joints.len()]];
                (model.momenta(origin, &theta).remove(0), model.generalized_forces(origin, &theta).remove(0))
            }
        };
        let beta_rate = model.unactuated(1);
        let f1 = model.ring.derivative(&sigma, beta_rate);
        let f2 = model.without(&sigma, &[beta_rate]);
        let still: Vec<Var> = [model.q(1), model.q(2)].concat();
        let gravity_moment = -&model.without(&balance, &still);
        let c = match mode {
            Mode::Stance(_) => {
                let com = model.centre_of_mass(origin);
                com[if model.mechanism.rotation == Rotation::Roll { 2 } else { 0 }].clone()
            }
            Mode::Flight => Poly::zero(),
        };
        Turn { sigma, f1, f2, gravity_moment, c, balance }
    }
}
