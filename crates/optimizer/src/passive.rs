//! What acts at a joint besides its motor: a spring, −k (q − q₀), and friction, −d q̇ − c sign q̇.
//!
//! It acts between two links, so it moves nothing by itself: momentum, reactions and impacts of a prescribed motion do not know of it,
//! and no generated equation contains it. Torques of the motors, their power and their limits do: a motor gives what moves the robot
//! and overcomes this.

use piaffe_model::units::Units;
use piaffe_model::{Description, Joint, RESTING_RATE};
use piaffe_number::Scalar;

/// At a joint of a virtual leg: of all its real joints together.
#[derive(Clone, Copy, Debug)]
pub struct Passive<T = f64> {
    /// k, N·m/rad.
    pub stiffness: T,
    /// q₀, where the spring does nothing, rad.
    pub rest: T,
    /// d, N·m·s/rad.
    pub damping: T,
    /// c, N·m.
    pub coulomb: T,
    /// A joint slower than this is at rest, rad/s.
    pub at_rest: f64,
}

impl Passive {
    /// Of each joint that has something of it.
    pub fn all(d: &Description) -> Vec<Option<Passive>> {
        let joints = d.joints.iter().enumerate();
        joints.map(|(j, joint)| Passive::acts(joint).then(|| Passive::read(d, j, |number| number(d)))).collect()
    }

    /// Whether a joint has something of it.
    pub fn acts(joint: &Joint) -> bool {
        joint.has_spring() || joint.has_friction()
    }

    /// The sign of dry friction at this rate; 0 without any.
    pub fn side(&self, rate: f64) -> f64 {
        if self.coulomb == 0.0 { 0.0 } else { rate.side(self.at_rest) }
    }

    /// The same in numbers of another kind.
    pub fn cast<T: Scalar>(self) -> Passive<T> {
        let Passive { stiffness, rest, damping, coulomb, at_rest } = self;
        Passive {
            stiffness: stiffness.into(),
            rest: rest.into(),
            damping: damping.into(),
            coulomb: coulomb.into(),
            at_rest,
        }
    }

    /// That of one of several joints which share it.
    pub fn shared(self, joints: f64) -> Passive {
        let Passive { stiffness, damping, coulomb, .. } = self;
        Passive { stiffness: stiffness / joints, damping: damping / joints, coulomb: coulomb / joints, ..self }
    }
}

impl<T: Scalar> Passive<T> {
    /// Of a joint; `one` makes a scalar of a number of a description.
    pub fn read(d: &Description, joint: usize, one: impl Fn(&dyn Fn(&Description) -> f64) -> T) -> Passive<T> {
        Passive {
            stiffness: one(&|d| d.joints[joint].stiffness),
            rest: one(&|d| d.joints[joint].rest),
            damping: one(&|d| d.joints[joint].damping),
            coulomb: one(&|d| d.joints[joint].coulomb),
            at_rest: RESTING_RATE * Units::new(d).rate(),
        }
    }

    /// What the motor gives to overcome it at this angle and rate of the joint, N·m.
    #[inline]
    pub fn torque(&self, angle: T, rate: T) -> T {
        self.smooth(angle, rate) + self.coulomb * rate.side(self.at_rest)
    }

    /// The same without dry friction.
    #[inline]
    pub fn smooth(&self, angle: T, rate: T) -> T {
        self.stiffness * (angle - self.rest) + self.damping * rate
    }
}
