//! The constraints of §4.2 and §6.1 by name, and the record of how closely each is met.
//!
//! A margin is what is left, in a natural unit: torques in the greatest torque, joint speeds in the
//! unloaded speed, forces in the robot's weight, lengths in the stretched leg, durations in √(leg/gravity), velocities in
//! √(gravity·leg), impulses in the robot's momentum at that velocity, angles in rad, the mean speed in the speed asked.
//! Negative means violated.

use super::receipt::Finding;
use piaffe_model::{Description, Limit};

/// A margin below this makes a constraint active.
pub const ACTIVE: f64 = 1e-4;

/// One inequality or equality, to hold at all times of a phase or at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constraint {
    /// |Γ| ≤ greatest torque.
    Torque(usize),
    /// |q̇| ≤ unloaded − (unloaded − loaded)·|Γ| / greatest torque.
    Speed(usize),
    /// Lower joint stop.
    LowerStop(usize),
    /// Upper joint stop.
    UpperStop(usize),
    /// Vertical reaction ≥ its minimum.
    VerticalForce,
    /// |tangential| ≤ μ·vertical.
    Friction,
    /// Swing foot above its curve.
    Clearance,
    /// The same of this leg, where both are in the air.
    FootClearance(usize),
    /// Platform's mass centre above the ground by its minimum.
    PlatformHeight,
    /// A joint or a corner of the platform above the ground by the body's clearance.
    Height(usize),
    /// Swing foot on the ground at the end; equality.
    Touchdown,
    /// T ≥ its minimum.
    Shortest,
    /// T ≤ its maximum.
    Longest,
    /// Vertical impulse on the landing foot ≥ 0.
    VerticalImpulse,
    /// |tangential impulse| ≤ μ·vertical.
    ImpulseFriction,
    /// The foot that leaves does not move into the ground.
    Leaving,
    /// Mean forward speed; equality.
    MeanSpeed,
}

impl Constraint {
    /// All constraints of a gait, in the order in which they are told.
    pub fn all(description: &Description) -> impl Iterator<Item = Constraint> {
        use Constraint::*;
        let of_joints = (0..description.joints()).flat_map(|j| [Torque(j), Speed(j), LowerStop(j), UpperStop(j)]);
        let others = [
            VerticalForce,
            Friction,
            Clearance,
            Touchdown,
            Shortest,
            Longest,
            VerticalImpulse,
            ImpulseFriction,
            Leaving,
            MeanSpeed,
            PlatformHeight,
            FootClearance(0),
            FootClearance(1),
        ];
        of_joints.chain(others).chain((0..description.points.len()).map(Height))
    }

    /// An equality can only be met exactly: it is never reported as active.
    pub fn is_equality(self) -> bool {
        matches!(self, Constraint::Touchdown | Constraint::MeanSpeed)
    }

    /// Which limit or equation it is.
    pub fn limit(self) -> Limit {
        match self {
            Constraint::Torque(_) => Limit::Torque,
            Constraint::Speed(_) => Limit::TorqueSpeed,
            Constraint::LowerStop(_) => Limit::LowerStop,
            Constraint::UpperStop(_) => Limit::UpperStop,
            Constraint::VerticalForce => Limit::VerticalForce,
            Constraint::Friction => Limit::Friction,
            Constraint::Clearance => Limit::Clearance,
            Constraint::FootClearance(_) => Limit::ClearanceOfFoot,
            Constraint::Touchdown => Limit::Touchdown,
            Constraint::Shortest => Limit::ShortestPhase,
            Constraint::Longest => Limit::LongestPhase,
            Constraint::VerticalImpulse => Limit::VerticalImpulse,
            Constraint::ImpulseFriction => Limit::ImpulseFriction,
            Constraint::Leaving => Limit::Leaving,
            Constraint::MeanSpeed => Limit::MeanSpeed,
            Constraint::PlatformHeight => Limit::PlatformHeight,
            Constraint::Height(_) => Limit::Height,
        }
    }

    /// Which of those with the same limit.
    fn index(self) -> usize {
        use Constraint::*;
        match self {
            Torque(j) | Speed(j) | LowerStop(j) | UpperStop(j) => j,
            FootClearance(leg) => leg,
            Height(point) => point,
            _ => 0,
        }
    }

    /// What a person reads.
    pub fn name(self, description: &Description) -> String {
        use Constraint::*;
        self.limit().of(match self {
            Torque(j) | Speed(j) | LowerStop(j) | UpperStop(j) => {
                description.joints.get(j).map_or("?", |joint| joint.name)
            }
            Height(point) => description.points.get(point).map_or("?", |point| point.name),
            FootClearance(0) => "leg 1",
            FootClearance(_) => "leg 2",
            _ => "",
        })
    }
}

/// The least margin of every constraint over one phase.
#[derive(Clone, Debug)]
pub struct Tally {
    phase: usize,
    /// Constraint, least margin, its time.
    entries: Vec<(Constraint, f64, f64)>,
    /// Which of them are of each kind of limit, in order.
    slots: Vec<Vec<usize>>,
}

impl Tally {
    /// For phase `phase`, 1-based.
    pub fn new(description: &Description, phase: usize) -> Tally {
        let entries: Vec<_> = Constraint::all(description).map(|c| (c, f64::INFINITY, 0.0)).collect();
        let mut slots: Vec<Vec<usize>> = Vec::new();
        for (slot, (constraint, ..)) in entries.iter().enumerate() {
            let kind = constraint.limit() as usize;
            slots.resize_with(slots.len().max(kind + 1), Vec::new);
            debug_assert_eq!(slots[kind].len(), constraint.index());
            slots[kind].push(slot);
        }
        Tally { phase, entries, slots }
    }

    /// Notes the margin of a constraint at a time; a margin that is not a number counts as violated.
    pub fn note(&mut self, constraint: Constraint, margin: f64, time: f64) {
        self.note_all(constraint, &[margin], &[time]);
    }

    /// The same at several times.
    pub fn note_all(&mut self, constraint: Constraint, margins: &[f64], times: &[f64]) {
        let slot = self.slot(constraint);
        let (_, least, at) = &mut self.entries[slot];
        for (margin, time) in margins.iter().zip(times) {
            let margin = if margin.is_nan() { f64::MIN } else { *margin };
            if margin < *least {
                (*least, *at) = (margin, *time);
            }
        }
    }

    /// Which of the entries is that of a constraint.
    #[inline]
    fn slot(&mut self, constraint: Constraint) -> usize {
        let alike = self.slots.get(constraint.limit() as usize);
        if let Some(slot) = alike.and_then(|alike| alike.get(constraint.index())) {
            return *slot;
        }
        // What the gait was not known to have is no reason to forget it.
        self.entries.iter().position(|entry| entry.0 == constraint).unwrap_or_else(|| {
            self.entries.push((constraint, f64::INFINITY, 0.0));
            self.entries.len() - 1
        })
    }

    /// Least margin of a constraint noted so far.
    pub fn margin(&self, constraint: Constraint) -> f64 {
        self.entries.iter().find(|entry| entry.0 == constraint).map_or(f64::INFINITY, |entry| entry.1)
    }

    /// The constraint that is violated most.
    pub fn worst(&self, description: &Description) -> Option<Finding> {
        let worst = self.entries.iter().filter(|entry| entry.1 < 0.0).min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(self.finding(description, worst))
    }

    /// The inequality with the least room.
    pub fn least(&self, description: &Description) -> Option<Finding> {
        let inequalities = self.entries.iter().filter(|entry| entry.1.is_finite() && !entry.0.is_equality());
        let least = inequalities.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(self.finding(description, least))
    }

    /// Inequalities that are met without room to spare, or not met.
    pub fn active<'b>(&'b self, description: &'b Description) -> impl Iterator<Item = Finding> + 'b {
        let active = self.entries.iter().filter(|entry| entry.1 <= ACTIVE && !entry.0.is_equality());
        active.map(|entry| self.finding(description, entry))
    }

    fn finding(&self, description: &Description, &(constraint, margin, time): &(Constraint, f64, f64)) -> Finding {
        Finding { constraint: constraint.name(description), phase: self.phase, time, margin }
    }
}
