//! The whole robot: a platform that is free in space, with every real leg. The build generates one per robot.
//!
//! Its speeds are u = [velocity of the platform's mass centre, angular velocity of the platform, q̇], the first two in
//! the platform's axes; u̇ = [acceleration of that point, angular acceleration, q̈] in the same axes; q are the joints of
//! all legs. With the torques Γ of the joints, Sᵀ putting them where q̇ is, and the reactions F on all feet,
//!
//! ```text
//! A(q) u̇ + H = Sᵀ Γ + D F,      ḋ = Dᵀ u,      d̈ = Dᵀ u̇ + h
//! ```
//!
//! H takes the vertical (a unit vector, up) and the angular velocity in the platform's axes: no angles of the platform
//! are needed, and there is none that is singular. Forces are in N in the platform's axes too.

use super::{Body, shape};
use std::borrow::Cow;
use std::ops::Range;

/// What a whole robot is made of, in numbers.
#[derive(Clone, Debug)]
pub struct Description {
    pub robot: &'static str,
    /// m/s².
    pub gravity: f64,
    /// Parents precede children; body 0 is the platform.
    pub bodies: Cow<'static, [Body]>,
    pub joints: Cow<'static, [Joint]>,
    pub legs: Cow<'static, [Leg]>,
    /// Where everything stands in what the kernels give.
    pub shapes: Shapes,
}

shape::all! {
    /// Shapes of the kernels that give more than one thing.
    Shapes { inertia_and_bias: InertiaAndBias, feet: Feet }
}

/// A joint of a real leg.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Its own in the robot, as [`Member::joints`](super::Member::joints) has it.
    pub name: &'static str,
    /// Seen at the joint, kg·m².
    pub rotor_inertia: f64,
}

/// A real leg.
#[derive(Clone, Debug)]
pub struct Leg {
    pub name: &'static str,
    /// In q.
    pub joints: Range<usize>,
    pub foot_body: usize,
    /// Foot from the joint of `foot_body`, m.
    pub foot: [f64; 3],
}

impl Description {
    /// Number of speeds u.
    pub fn speeds(&self) -> usize {
        6 + self.joints.len()
    }

    /// Number of components of the reactions on all feet.
    pub fn reactions(&self) -> usize {
        3 * self.legs.len()
    }

    pub fn total_mass(&self) -> f64 {
        self.bodies.iter().map(|b| b.mass).sum()
    }
}

/// Generated dynamics of a whole robot. Outputs go one after another and row-major into `out`, as those of
/// [`Gait`](super::Gait).
pub trait Whole: Sync {
    fn description(&self) -> &Description;
    /// A (n × n for n speeds), then H. `up` and `omega` (rad/s) are in the platform's axes.
    fn inertia_and_bias(&self, up: &[f64], omega: &[f64], q: &[f64], qd: &[f64], out: &mut [f64]);
    /// Feet from the platform's mass centre (3 per leg), then D (n × 3 per leg); platform's axes.
    fn feet(&self, q: &[f64], out: &mut [f64]);
    /// h (3 per leg): the feet's accelerations from velocities alone.
    fn feet_bias(&self, omega: &[f64], q: &[f64], qd: &[f64], out: &mut [f64]);
}
