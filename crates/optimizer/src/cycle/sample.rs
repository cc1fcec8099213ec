//! What the last simulated motion is at its instants: for whoever shows it.

use super::Cycle;
use crate::instant::Glance;
use piaffe_model::Mode;

/// One instant of a phase. Positions are from the stance foot, or in flight from the ground below where the mass centre took off;
/// world axes, m.
pub struct Sample<'a> {
    /// Time as a share of the phase.
    pub share: f64,
    /// q, q̇ and q̈.
    pub state: [&'a [f64]; 3],
    /// The quantities of an instant: see `Quantities`.
    pub quantities: &'a [f64],
    /// Platform's mass centre.
    pub platform: Vec<f64>,
    /// Feet in the air, one after the other.
    pub feet: Vec<f64>,
    /// Velocity of the robot's mass centre in flight, where kernels give velocities from it; else zero, m/s.
    pub centre_velocity: [f64; 2],
}

impl<'a> Sample<'a> {
    /// What was seen at a share of a phase.
    pub fn of(glance: &'a Glance, share: f64) -> Sample<'a> {
        let [platform, feet] = glance.places().map(<[f64]>::to_vec);
        let state = [&glance.state.q[..], &glance.state.qd, &glance.qdd];
        Sample { share, state, quantities: &glance.values, platform, feet, centre_velocity: glance.centre_velocity }
    }
}

impl Cycle<'_> {
    /// Node `node` of a phase.
    pub fn sample(&self, phase: usize, node: usize) -> Sample<'_> {
        let (p, d) = (&self.phases[phase], self.description());
        let [mut platform, mut feet] =
            [p.shapes.placement.p, p.shapes.placement.swing].map(|b| b.of(p.instants.placement(node)).to_vec());
        let share = p.mesh.nodes[node].0;
        let fall = p.fall(d);
        if let Some(fall) = fall {
            fall.carry(share, &mut platform, d.positions());
            fall.carry(share, &mut feet, d.positions());
        }
        Sample {
            share,
            state: p.instants.state(d, node),
            quantities: p.instants.row(node),
            platform,
            feet,
            centre_velocity: fall.map_or([0.0; 2], |fall| fall.velocity(share)),
        }
    }

    /// Duration of a phase, s.
    pub fn duration(&self, phase: usize) -> f64 {
        self.phases[phase].duration()
    }

    /// Mode of a phase.
    pub fn mode(&self, phase: usize) -> Mode {
        self.phases[phase].mode
    }

    /// The node at which a phase ends.
    pub fn last_node(&self, phase: usize) -> usize {
        self.phases[phase].last()
    }
}
