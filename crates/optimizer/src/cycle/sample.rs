//! What the last simulated motion is at its instants: for whoever shows it.

use super::Cycle;
use crate::instant::Glance;

/// One instant of a half step. Positions are from the stance foot, world axes, m.
pub struct Sample<'a> {
    /// Time as a share of the half step.
    pub share: f64,
    /// q, q̇ and q̈.
    pub state: [&'a [f64]; 3],
    /// The quantities of an instant: see `Quantities`.
    pub quantities: &'a [f64],
    /// Platform's mass centre.
    pub platform: &'a [f64],
    /// Foot of the other leg.
    pub swing: &'a [f64],
}

impl<'a> Sample<'a> {
    /// What was seen at a share of a half step.
    pub fn of(glance: &'a Glance, share: f64) -> Sample<'a> {
        let [platform, swing] = glance.places();
        let state = [&glance.state.q[..], &glance.state.qd, &glance.qdd];
        Sample { share, state, quantities: &glance.values, platform, swing }
    }
}

impl Cycle<'_> {
    /// Node `node` of a half step.
    pub fn sample(&self, phase: usize, node: usize) -> Sample<'_> {
        let (p, d) = (&self.phases[phase], self.description());
        let [platform, swing] =
            [p.shapes.placement.p, p.shapes.placement.swing].map(|b| b.of(p.instants.placement(node)));
        Sample {
            share: p.mesh.nodes[node].0,
            state: p.instants.state(d, node),
            quantities: p.instants.row(node),
            platform,
            swing,
        }
    }

    /// Duration of a half step, s.
    pub fn duration(&self, phase: usize) -> f64 {
        self.phases[phase].duration()
    }

    /// Stance leg of a half step.
    pub fn stance_leg(&self, phase: usize) -> usize {
        self.phases[phase].leg
    }

    /// The node at which a half step ends.
    pub fn last_node(&self, phase: usize) -> usize {
        self.phases[phase].last()
    }
}
