//! Joints that a phase holds still.
//!
//! While a joint moves, the kinks of |Γ q̇| are isolated instants and least energy is a smooth function of Θ. But it often pays
//! to hold a joint, a stance knee say, for a whole phase: q̇ = 0 throughout, and the criterion itself has a kink there. Such
//! an optimum is no stationary point, and no sequence of smooth steps finds it.
//!
//! Θ is kept *on* the kink by equations: a rate is a polynomial, and zero where it is zero at as many instants as it has
//! coefficients. The joint's power is left out, so all is smooth again. Whether the motion is an optimum off the kink too, is
//! what its subgradients say: power adds |Γ|·|q̇| at each instant, that is ς·Γ·q̇ with any |ς| ≤ 1 where q̇ = 0. The equations
//! are given up then, and each instant becomes a [kink](piaffe_sqp::Problem::kinks) with |Γ| as the limit of its multiplier. With dry
//! friction c power adds |Γ + c sign q̇|·|q̇|, which is min(|Γ|, c) sign Γ·q̇ and a kink of max(|Γ|, c). Where
//! it is none, the way down tells which of the joints had better move: those whose rates it changes.

use super::phase::Phase;
use super::{Cycle, Equation};
use crate::cost::Drive;
use piaffe_model::motion::Criterion;
use piaffe_sqp::dot;

/// A joint that moves by less than this, in parts of the fastest joint's rate, is at rest: what equations leave of its rate.
pub const AT_REST: f64 = 1e-6;

/// A joint in a phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Still {
    pub phase: usize,
    pub joint: usize,
}

impl Cycle<'_> {
    /// The prescribed joints whose rate in the last simulated motion never exceeds `share` of the fastest one's, where the criterion has a
    /// kink there.
    pub fn still(&self, share: f64) -> Vec<Still> {
        let d = self.description();
        if self.criterion != Criterion::Energy {
            return Vec::new();
        }
        let fastest = |p: &Phase, joint: usize| {
            let rate = p.instants.quantities.rate(joint);
            (0..p.mesh.nodes.len()).map(|node| p.instants.value(node, rate).abs()).fold(0.0, f64::max)
        };
        let all = self.phases.iter().flat_map(|p| (0..d.joints()).map(|j| fastest(p, j)));
        let limit = share * all.fold(0.0, f64::max);
        let slow = |p: &Phase, joint: usize| fastest(p, joint) <= limit;
        let joints = || (0..d.prescribed()).map(|j| d.prescribed_index(j)).filter(|j| *j < d.joints());
        let phases = self.phases.iter().enumerate();
        phases
            .flat_map(|(phase, p)| joints().filter(|j| slow(p, *j)).map(move |joint| Still { phase, joint }))
            .collect()
    }

    /// The joints that are held.
    pub fn held(&self) -> impl Iterator<Item = Still> + '_ {
        let phases = self.phases.iter().enumerate();
        phases.flat_map(|(phase, p)| p.still.iter().map(move |&joint| Still { phase, joint }))
    }

    /// Holds these joints, and only these, by equations.
    pub fn hold(&mut self, joints: &[Still]) {
        let d = self.description();
        for (k, phase) in self.phases.iter_mut().enumerate() {
            phase.still = joints.iter().filter(|s| s.phase == k).map(|s| s.joint).collect();
            let still = &phase.still;
            let (held, drives) = Drive::all(d, phase.mode).into_iter().partition(|drive| still.contains(&drive.joint));
            (phase.cost.held, phase.cost.drives) = (held, drives);
            phase.cost.held.retain(|drive| drive.coulomb() != 0.0);
        }
        self.by_equations = true;
        self.count_rows();
    }

    /// Gives the equations up: that the held joints rest is left to what their power costs.
    pub fn let_go(&mut self) {
        self.by_equations = false;
        self.count_rows();
    }

    /// Those of the held joints that a step in Θ from the linearized motion sets in motion.
    pub fn set_in_motion(&self, step: &[f64]) -> Vec<Still> {
        let d = self.description();
        let fastest = |p: &Phase, joint: usize| {
            let local: Vec<f64> = p.by_theta.push(step).collect();
            let change = |node: usize| {
                let mut by = p.no_parameters();
                p.add_quantity(d, node, p.instants.quantities.rate(joint), 1.0, &mut by);
                dot(&by, &local).abs()
            };
            (0..p.mesh.nodes.len()).map(change).fold(0.0, f64::max)
        };
        let all = self.phases.iter().flat_map(|p| (0..d.joints()).map(|joint| fastest(p, joint)));
        let limit = AT_REST * all.fold(0.0, f64::max);
        self.held().filter(|still| fastest(&self.phases[still.phase], still.joint) > limit).collect()
    }

    /// The equations that hold joints: one at as many nodes as the rate has coefficients.
    pub(super) fn holding(&self) -> impl Iterator<Item = Equation> + '_ {
        let instants = self.description().polynomial_order;
        let held = self.held().filter(|_| self.by_equations);
        held.flat_map(move |Still { phase, joint }| {
            let last = self.phases[phase].last();
            (0..instants).map(move |m| Equation::Still { phase, joint, node: m * last / (instants - 1) })
        })
    }

    /// The instants at which the power of a held joint has a kink: phase, joint, node.
    pub fn resting(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let held = self.held().filter(|_| !self.by_equations);
        held.flat_map(|Still { phase, joint }| {
            (0..self.phases[phase].mesh.nodes.len()).map(move |node| (phase, joint, node))
        })
    }
}
