//! The robot's own units: its mass, the length of its leg, and the time in which gravity makes of them a pendulum.
//!
//! The problem is solved and its solution judged in these. Robots of one shape, whatever their size and weight, are then one
//! problem: speeds are Froude numbers, forces parts of the weight, and no number in the optimizer has a unit.
//! The verifier has units of its own (`piaffe_verify::margins`).

use crate::Description;
use crate::motion::Criterion;

/// A unit of each dimension; all others are products of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Of the whole robot, kg.
    pub mass: f64,
    /// Of a straight leg, m.
    pub length: f64,
    /// √(length/gravity), s.
    pub time: f64,
}

/// A walk's mean power as a part of weight · √(gravity · length): criteria of common gaits are then numbers from ten to some hundred.
const POWER: f64 = 1.0 / 400.0;
/// The same of the sum of its squared torques as a part of (weight · length)².
const SQUARED_TORQUE: f64 = 1.0 / 3000.0;

impl Units {
    pub fn new(d: &Description) -> Units {
        let length = d.leg_length();
        Units { mass: d.total_mass(), length, time: (length / d.gravity).sqrt() }
    }

    /// √(gravity · length), m/s.
    pub fn speed(&self) -> f64 {
        self.length / self.time
    }

    /// Of joints, rad/s.
    pub fn rate(&self) -> f64 {
        1.0 / self.time
    }

    /// The weight, N.
    pub fn force(&self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }

    /// N·s.
    pub fn impulse(&self) -> f64 {
        self.mass * self.speed()
    }

    /// kg·m².
    pub fn inertia(&self) -> f64 {
        self.mass * self.length * self.length
    }

    /// kg·m²/s.
    pub fn angular_momentum(&self) -> f64 {
        self.inertia() / self.time
    }

    /// W.
    pub fn power(&self) -> f64 {
        self.force() * self.speed()
    }

    /// Of a criterion's integrand (§4.3): W or N²·m².
    pub fn integrand(&self, criterion: Criterion) -> f64 {
        let torque = self.force() * self.length;
        match criterion {
            Criterion::Energy => POWER * self.power(),
            Criterion::Torque => SQUARED_TORQUE * torque * torque,
        }
    }
}
