//! Friction of a joint, d q̇ + c sign q̇: what its motor gives besides the torque that moves the robot.
//!
//! It acts between two links, so it moves nothing: momentum, reactions and impacts do not know of it, and no generated equation
//! contains it. Torques of the motors, their power and their limits do.

use piaffe_model::units::Units;
use piaffe_model::{Description, RESTING_RATE};
use piaffe_number::Scalar;

/// That of a joint of a virtual leg: of all its real joints together.
#[derive(Clone, Copy, Debug)]
pub struct Friction<T = f64> {
    /// d, N·m·s/rad.
    pub damping: T,
    /// c, N·m.
    pub coulomb: T,
    /// A joint slower than this is at rest, rad/s.
    pub at_rest: f64,
}

impl Friction {
    /// Of each joint that has some.
    pub fn all(d: &Description) -> Vec<Option<Friction>> {
        (0..d.joints()).map(|j| Friction::read(d, j, |number| number(d))).collect()
    }

    /// The sign of dry friction at this rate; 0 without any.
    pub fn side(&self, rate: f64) -> f64 {
        if self.coulomb == 0.0 { 0.0 } else { rate.side(self.at_rest) }
    }

    /// The same in numbers of another kind.
    pub fn cast<T: Scalar>(self) -> Friction<T> {
        Friction { damping: self.damping.into(), coulomb: self.coulomb.into(), at_rest: self.at_rest }
    }

    /// That of one of several joints which share it.
    pub fn shared(self, joints: f64) -> Friction {
        Friction { damping: self.damping / joints, coulomb: self.coulomb / joints, ..self }
    }
}

impl<T: Scalar> Friction<T> {
    /// Of a joint, if it has some; `one` makes a scalar of a number of a description.
    pub fn read(d: &Description, joint: usize, one: impl Fn(&dyn Fn(&Description) -> f64) -> T) -> Option<Friction<T>> {
        d.joints[joint].has_friction().then(|| Friction {
            damping: one(&|d| d.joints[joint].damping),
            coulomb: one(&|d| d.joints[joint].coulomb),
            at_rest: RESTING_RATE * Units::new(d).rate(),
        })
    }

    /// N·m, at this rate of the joint, rad/s.
    #[inline]
    pub fn torque(&self, rate: T) -> T {
        self.damping * rate + self.coulomb * rate.side(self.at_rest)
    }
}
