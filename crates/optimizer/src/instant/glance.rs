//! A look at an instant between the nodes.

use super::Quantities;
use super::quantities::{heights_length, placement_length, sharing_length};
use crate::stance::{Mesh, Stance, State, Undefined};
use piaffe_model::{Description, Gait};

/// One instant between the nodes: the same quantities, without derivatives.
#[derive(Clone, Debug)]
pub struct Glance {
    quantities: Quantities,
    pub state: State,
    pub qdd: Vec<f64>,
    /// Of all quantities.
    pub values: Vec<f64>,
    inverse: Vec<f64>,
    placement: Vec<f64>,
    heights: Vec<f64>,
    sharing: Vec<f64>,
}

impl Glance {
    /// At half steps on `leg`.
    pub fn new(d: &Description, leg: usize) -> Glance {
        let quantities = Quantities::new(d);
        let (nq, nj, nc) = (d.orientations(), d.joints(), d.positions());
        let z = |count: usize| vec![0.0; count];
        Glance {
            quantities,
            state: State::new(d, leg),
            qdd: z(nq),
            values: z(quantities.len()),
            inverse: z(nq + nj + 2 * nc),
            placement: z(placement_length(nq, nc)),
            heights: z(heights_length(nq, quantities.heights().len())),
            sharing: z(sharing_length(nq, quantities.shared)),
        }
    }

    /// Looks at `s` of an integrated half step, neither its beginning nor its end.
    ///
    /// # Errors
    /// As for [`Stance::integrate`].
    pub fn at(
        &mut self,
        gait: &dyn Gait,
        leg: usize,
        mesh: &Mesh,
        stance: &Stance,
        parameters: &[f64],
        s: f64,
    ) -> Result<(), Undefined> {
        let (d, y) = (gait.description(), self.quantities);
        let (nq, nc) = (d.orientations(), d.positions());
        stance.at(gait, leg, mesh, parameters, s, &mut self.state)?;
        let State { q, qd, prescribed: [.., accelerations], .. } = &self.state;
        gait.inverse(leg, q, qd, accelerations, &mut self.inverse);
        let (xdd, forces) = self.inverse.split_at(nc + nq);
        self.qdd.copy_from_slice(&xdd[nc..]);
        gait.placement(leg, q, &mut self.placement);
        y.write(&mut self.values, q, qd, forces, self.placement[1]);
        self.values[y.clearance()] = self.placement[nc + 1] / (4.0 * s * (1.0 - s));
        gait.heights(leg, q, &mut self.heights);
        self.values[y.heights()].copy_from_slice(&self.heights[..y.heights().len()]);
        if y.shared > 0 {
            gait.sharing(leg, q, qd, &self.qdd, &mut self.sharing);
            self.values[y.shared()].copy_from_slice(&self.sharing[..y.shared]);
        }
        Ok(())
    }

    /// Positions of the platform's mass centre and of the swing foot, from the stance foot, m.
    pub fn places(&self, d: &Description) -> [&[f64]; 2] {
        let nc = d.positions();
        [&self.placement[..nc], &self.placement[nc..2 * nc]]
    }
}
