//! What the criteria sum over: the joints of the virtual legs, or where limits hold at each real leg, the real joints.
//!
//! The paper counts the torques of virtual joints. Of n joints that share one as equals each has Γ/n, so that n Σ Γᵢ² is Γ² and
//! Σ |Γᵢ q̇| is |Γ q̇|: counted like this, a gait whose legs share as equals costs as much on its real joints as on its virtual
//! ones, and unequal shares cost more.

use crate::constraints::sharing::{Share, applies, torques};
use crate::instant::Quantities;
use piaffe_model::{Description, Mode};
use smallvec::SmallVec;

/// The torque of a joint as a function of an instant's quantities, and its rate.
#[derive(Clone, Debug)]
pub struct Drive {
    torque: Torque,
    rate: usize,
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
        let of_virtual = |j: usize| Drive { torque: Torque::Virtual(y.torque(j)), rate: y.rate(j), sharing: 1.0 };
        if mode == Mode::Flight || !applies(d) {
            return (0..d.joints()).map(of_virtual).collect();
        }
        let leg = &d.legs[0];
        let sharing = leg.members.len() as f64;
        let standing = torques(d, &y).into_iter();
        let standing = standing.map(|(j, share)| Drive { torque: Torque::Real(share), rate: y.rate(j), sharing });
        let swinging = (0..d.joints()).filter(|j| !(leg.first_joint..leg.end_joint).contains(j)).map(of_virtual);
        standing.chain(swinging).collect()
    }

    /// How many numbers a gradient of its power, and a matrix of second derivatives without those that are there twice, can have.
    pub fn most(&self) -> (usize, usize) {
        let entries = match &self.torque {
            Torque::Virtual(_) => 2,
            Torque::Real(_) => Partials::new().inline_size(),
        };
        (entries, entries * (entries + 1))
    }

    /// Which quantity its rate is.
    pub fn rate(&self) -> usize {
        self.rate
    }

    /// N·m.
    #[inline]
    pub fn torque(&self, y: &[f64]) -> f64 {
        match &self.torque {
            Torque::Virtual(quantity) => y[*quantity],
            Torque::Real(share) => share.value(y),
        }
    }

    /// W.
    #[inline]
    pub fn power(&self, y: &[f64]) -> f64 {
        self.torque(y) * y[self.rate]
    }

    pub fn torque_partials(&self, y: &[f64]) -> Partials {
        let mut partials = Partials::new();
        match &self.torque {
            Torque::Virtual(quantity) => partials.push((*quantity, 1.0)),
            Torque::Real(share) => share.partials(y, |quantity, partial| partials.push((quantity, partial))),
        }
        partials
    }

    pub fn power_partials(&self, y: &[f64]) -> Partials {
        let mut partials = self.torque_partials(y);
        partials.iter_mut().for_each(|(_, partial)| *partial *= y[self.rate]);
        partials.push((self.rate, self.torque(y)));
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

    /// The same of the power.
    pub fn power_curvature(&self, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        for (quantity, partial) in self.torque_partials(y) {
            add(quantity, self.rate, partial);
        }
        self.torque_curvature(y, |a, b, second| add(a, b, y[self.rate] * second));
    }
}
