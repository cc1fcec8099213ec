//! What the last simulated motion is at its instants: for whoever shows it.

use super::Cycle;

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

impl Cycle<'_> {
    /// Instant `node` of a half step.
    pub fn sample(&self, phase: usize, node: usize) -> Sample<'_> {
        let (p, d) = (&self.phases[phase], self.description());
        let nc = d.positions();
        let placement = p.instants.placement(d, node);
        Sample {
            share: p.mesh.nodes[node].0,
            state: p.instants.state(d, node),
            quantities: p.instants.row(node),
            platform: &placement[..nc],
            swing: &placement[nc..2 * nc],
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

    /// The instant at which a half step ends: the last of the collocation nodes.
    pub fn last_node(&self, phase: usize) -> usize {
        self.phases[phase].last()
    }
}
