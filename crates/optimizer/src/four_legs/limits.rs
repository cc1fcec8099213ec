//! What every real foot and joint must keep to, as margins that depend on how the reactions are shared.
//!
//! Units are a foot's share of the robot's weight for forces, of its momentum at the speed √(g × leg length) for impulses; the joint's greatest torque and its unloaded speed. So with equal shares every real leg has the virtual leg's margins.

use super::cost::Motor;
use super::posture::{Legs, Posture};
use super::rows::dot;
use super::shares::{Shares, Squeeze};
use smallvec::{SmallVec, smallvec};

/// A limit of §6.1 for one real leg or joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Vertical reaction ≥ the foot's share of the least one; at an impact, vertical impulse ≥ 0.
    Vertical(usize),
    /// |tangential| ≤ μ·vertical, of the reaction or of the impulse.
    Friction(usize),
    /// |Γ| ≤ greatest torque.
    Torque(usize),
    /// |q̇| ≤ unloaded − (unloaded − loaded)·|Γ| / greatest torque.
    Speed(usize),
}

/// What a limit leaves, for reactions shared by s: `height(s) − |tangential(s)|`.
#[derive(Clone, Debug)]
pub struct Room {
    pub limit: Limit,
    pub height: Affine,
    /// Of friction three components, of a joint its torque; of a vertical force none.
    pub tangential: SmallVec<[Affine; 3]>,
}

/// `at + slope · s`.
#[derive(Clone, Debug)]
pub struct Affine {
    pub at: f64,
    pub slope: Squeeze,
}

/// The limits of a gait's robot.
pub struct Limits<'a> {
    pub legs: &'a Legs<'a>,
}

impl Affine {
    /// `weights · F` for the part F, from `first` on, of reactions that are shared by s.
    pub fn of(weights: &[f64], first: usize, shares: &Shares) -> Affine {
        let part = |reactions: &[f64]| dot(weights, &reactions[first..][..weights.len()]);
        let mut slope = Squeeze::from_elem(0.0, shares.squeezes.len());
        slope.iter_mut().zip(shares.squeezes.iter()).for_each(|(slope, squeeze)| *slope = part(squeeze));
        Affine { at: part(&shares.nearest), slope }
    }

    /// The same for any choice.
    fn constant(at: f64, shares: &Shares) -> Affine {
        Affine { at, slope: Squeeze::from_elem(0.0, shares.squeezes.len()) }
    }

    /// `constant + factor · this`.
    pub fn mapped(&self, constant: f64, factor: f64) -> Affine {
        let mut slope = Squeeze::from_slice(&self.slope);
        slope.iter_mut().for_each(|slope| *slope *= factor);
        Affine { at: constant + factor * self.at, slope }
    }

    pub fn value(&self, s: &[f64]) -> f64 {
        self.at + dot(&self.slope, s)
    }
}

impl Room {
    pub fn margin(&self, s: &[f64]) -> f64 {
        let square: f64 = self.tangential.iter().map(|t| t.value(s).powi(2)).sum();
        self.height.value(s) - square.sqrt()
    }
}

impl Limits<'_> {
    /// Of the feet `stance` and of their legs' joints; in flight, where none stands, of all joints.
    pub fn instant(&self, stance: &[usize], posture: &Posture, shares: &Shares, motors: &[Motor]) -> Vec<Room> {
        let d = self.legs.description;
        let w = self.legs.whole.description();
        let weight = self.legs.weight() / stance.len() as f64;
        let least = d.limits.min_vertical_force / self.legs.weight();
        let mut rooms = self.feet(stance, posture, shares, weight, least);
        rooms.reserve(2 * motors.len());
        let standing = stance.iter().flat_map(|leg| w.legs[*leg].joints.clone());
        let all = if stance.is_empty() { 0..w.joints.len() } else { 0..0 };
        for joint in standing.chain(all) {
            let (limits, Motor { torque, rate, sharing }) = (&d.joints[self.legs.joints[joint]], &motors[joint]);
            let most = limits.max_torque / sharing;
            let slowed = (limits.unloaded_speed - limits.loaded_speed) / limits.unloaded_speed;
            let rate = rate.abs() / limits.unloaded_speed;
            let mut push = |limit, most, used| {
                let height = Affine::constant(most, shares);
                rooms.push(Room { limit, height, tangential: smallvec![torque.mapped(0.0, used)] });
            };
            push(Limit::Torque(joint), 1.0, 1.0 / most);
            push(Limit::Speed(joint), 1.0 - rate, slowed / most);
        }
        rooms
    }

    /// At the impact of the feet `landing`; no joint takes an impulse.
    pub fn impact(&self, landing: &[usize], posture: &Posture, shares: &Shares) -> Vec<Room> {
        let momentum = self.legs.momentum() / landing.len() as f64;
        self.feet(landing, posture, shares, momentum, 0.0)
    }

    /// Vertical part above `least` and friction of every foot, in `unit`.
    fn feet(&self, feet: &[usize], posture: &Posture, shares: &Shares, unit: f64, least: f64) -> Vec<Room> {
        let up = posture.up();
        let mut rooms = Vec::with_capacity(2 * feet.len());
        for (k, leg) in feet.iter().enumerate() {
            let along = |direction: [f64; 3]| Affine::of(&direction.map(|x| x / unit), 3 * k, shares);
            let vertical = along(up);
            let height = vertical.mapped(-least, 1.0);
            rooms.push(Room { limit: Limit::Vertical(*leg), height, tangential: SmallVec::new() });
            // The part of each axis of the platform that is tangential to the ground.
            let tangential = (0..3).map(|i| along([0, 1, 2].map(|j| f64::from(i == j) - up[i] * up[j])));
            rooms.push(Room {
                limit: Limit::Friction(*leg),
                height: vertical.mapped(0.0, self.legs.description.limits.friction),
                tangential: tangential.collect(),
            });
        }
        rooms
    }

    /// What a person reads.
    pub fn name(&self, limit: Limit) -> String {
        let w = self.legs.whole.description();
        match limit {
            Limit::Vertical(leg) => format!("vertical force on {}", w.legs[leg].name),
            Limit::Friction(leg) => format!("friction of {}", w.legs[leg].name),
            Limit::Torque(joint) => format!("torque of {}", w.joints[joint].name),
            Limit::Speed(joint) => format!("torque–speed of {}", w.joints[joint].name),
        }
    }
}
