//! What the criteria sum over: the joints of the virtual legs, or where limits hold at each real leg, the real joints.
//!
//! The paper counts the torques of virtual joints. Of n joints that share one as equals each has Γ/n, so that n Σ Γᵢ² is Γ² and
//! Σ |Γᵢ q̇| is |Γ q̇|: counted like this, a gait whose legs share as equals costs as much on its real joints as on its virtual
//! ones, and unequal shares cost more.
//!
//! Where there is a spring or friction the motor gives more or less than what moves the robot. Dry friction has a sign, that of the rate, and jumps with
//! it: whoever asks says on which `side`, −1 or 1, or 0 for all but dry friction.

use crate::constraints::sharing::{Share, applies, torques};
use crate::instant::Quantities;
use crate::lgl::NODES;
use crate::passive::Passive;
use piaffe_model::{Description, Mode};
use smallvec::SmallVec;

/// The torque of a joint as a function of an instant's quantities, its angle and its rate.
#[derive(Clone, Debug)]
pub struct Drive {
    torque: Torque,
    angle: usize,
    rate: usize,
    passive: Option<Passive>,
    /// The virtual leg's joint that it is, or is one of.
    pub joint: usize,
    /// How many joints do together what the virtual leg's does.
    pub sharing: f64,
}

#[derive(Clone, Debug)]
enum Torque {
    /// That of a virtual leg's joint, a quantity itself.
    Virtual(usize),
    /// That of a joint of a real leg in support.
    Real(Share),
}

/// A gradient with few entries: quantities with partial derivatives.
pub type Partials = SmallVec<[(usize, f64); 12]>;

impl Drive {
    /// All of a mode of a gait. Real legs that swing do the same, so that the virtual leg's joints stand for them.
    pub fn all(d: &Description, mode: Mode) -> Vec<Drive> {
        let y = Quantities::new(d, mode);
        let passive = Passive::all(d);
        let of = |joint: usize, torque: Torque, sharing: f64| {
            let passive = passive[joint].map(|passive| passive.shared(sharing));
            Drive { torque, angle: y.angle(joint), rate: y.rate(joint), passive, joint, sharing }
        };
        let of_virtual = |j: usize| of(j, Torque::Virtual(y.torque(j)), 1.0);
        let Some(stance) = mode.stance().filter(|_| applies(d)) else {
            return (0..d.joints()).map(of_virtual).collect();
        };
        let leg = &d.legs[stance];
        let sharing = leg.members.len() as f64;
        let standing = torques(d, &y, stance).into_iter();
        let standing = standing.map(|(j, share)| of(j, Torque::Real(share), sharing));
        let swinging = (0..d.joints()).filter(|j| !(leg.first_joint..leg.end_joint).contains(j)).map(of_virtual);
        standing.chain(swinging).collect()
    }

    /// How many numbers a gradient of its power, and a matrix of second derivatives without those that are there twice, can have.
    pub fn most(&self) -> (usize, usize) {
        let entries = match &self.torque {
            Torque::Virtual(_) => 2 + usize::from(self.passive.is_some()),
            Torque::Real(_) => Partials::new().inline_size(),
        };
        // An element in which the joint turns around has a part on each side.
        let parts = if self.coulomb() == 0.0 { 1 } else { NODES };
        (parts * entries, parts * entries * (entries + 1))
    }

    /// Which quantity its rate is.
    pub fn rate(&self) -> usize {
        self.rate
    }

    /// Dry friction, N·m.
    pub fn coulomb(&self) -> f64 {
        self.passive.map_or(0.0, |passive| passive.coulomb)
    }

    /// Below this rate there is none, rad/s.
    pub fn at_rest(&self) -> f64 {
        self.passive.map_or(0.0, |passive| passive.at_rest)
    }

    /// N·m.
    #[inline]
    pub fn torque(&self, y: &[f64], side: f64) -> f64 {
        let moving = match &self.torque {
            Torque::Virtual(quantity) => y[*quantity],
            Torque::Real(share) => share.value(y),
        };
        match self.passive {
            Some(passive) => moving + passive.smooth(y[self.angle], y[self.rate]) + passive.coulomb * side,
            None => moving,
        }
    }

    /// W.
    #[inline]
    pub fn power(&self, y: &[f64], side: f64) -> f64 {
        self.torque(y, side) * y[self.rate]
    }

    /// The same on either side.
    pub fn torque_partials(&self, y: &[f64]) -> Partials {
        let mut partials = self.moving_partials(y);
        if let Some(passive) = self.passive {
            partials.extend([(self.angle, passive.stiffness), (self.rate, passive.damping)]);
        }
        partials
    }

    /// Of the torque that moves the robot.
    fn moving_partials(&self, y: &[f64]) -> Partials {
        let mut partials = Partials::new();
        match &self.torque {
            Torque::Virtual(quantity) => partials.push((*quantity, 1.0)),
            Torque::Real(share) => share.partials(y, |quantity, partial| partials.push((quantity, partial))),
        }
        partials
    }

    pub fn power_partials(&self, y: &[f64], side: f64) -> Partials {
        let mut partials = self.moving_partials(y);
        partials.iter_mut().for_each(|(_, partial)| *partial *= y[self.rate]);
        let mut by_rate = self.torque(y, side);
        if let Some(passive) = self.passive {
            partials.push((self.angle, passive.stiffness * y[self.rate]));
            by_rate += passive.damping * y[self.rate];
        }
        partials.push((self.rate, by_rate));
        partials
    }

    /// Calls `add(quantity, quantity, second derivative)` with each unordered pair once.
    pub fn torque_curvature(&self, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        if let Torque::Real(share) = &self.torque {
            share.curvature(y, |a, b, second| {
                if a <= b {
                    add(a, b, second);
                }
            });
        }
    }

    /// The same of the power, which is the same on either side.
    pub fn power_curvature(&self, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        for (quantity, partial) in self.moving_partials(y) {
            add(quantity, self.rate, partial);
        }
        if let Some(passive) = self.passive {
            add(self.angle, self.rate, passive.stiffness);
            add(self.rate, self.rate, 2.0 * passive.damping);
        }
        self.torque_curvature(y, |a, b, second| add(a, b, y[self.rate] * second));
    }
}
