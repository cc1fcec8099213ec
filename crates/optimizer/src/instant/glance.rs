//! A look at an instant between the nodes.

use super::Quantities;
use crate::stance::{Mesh, Stance, State, Undefined};
use piaffe_model::shape::Shapes;
use piaffe_model::{Description, Gait, UP};

/// One instant between the nodes: the same quantities, without derivatives.
#[derive(Clone, Debug)]
pub struct Glance {
    quantities: Quantities,
    shapes: &'static Shapes,
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
        let shapes = d.shapes;
        Glance {
            quantities,
            shapes,
            state: State::new(d, leg),
            qdd: vec![0.0; d.orientations()],
            values: vec![0.0; quantities.len()],
            inverse: shapes.inverse.zeros(),
            placement: shapes.placement.zeros(),
            heights: shapes.heights.zeros(),
            sharing: quantities.sharing(shapes).zeros(),
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
        let (y, shapes) = (self.quantities, self.shapes);
        stance.at(gait, leg, mesh, parameters, s, &mut self.state)?;
        let State { q, qd, prescribed: [.., accelerations], .. } = &self.state;
        gait.inverse(leg, q, qd, accelerations, &mut self.inverse);
        let shape = &shapes.inverse;
        let [xdd, torques, force] = [shape.xdd, shape.gamma, shape.f].map(|block| block.of(&self.inverse));
        self.qdd.copy_from_slice(&xdd[xdd.len() - q.len()..]);
        gait.placement(leg, q, &mut self.placement);
        y.write(&mut self.values, [q, qd], [torques, force], shapes.placement.p.of(&self.placement)[UP]);
        self.values[y.clearance()] = shapes.placement.swing.of(&self.placement)[UP] / (4.0 * s * (1.0 - s));
        gait.heights(leg, q, &mut self.heights);
        self.values[y.heights()].copy_from_slice(shapes.heights.heights.of(&self.heights));
        if y.shared > 0 {
            gait.sharing(leg, q, qd, &self.qdd, &mut self.sharing);
            y.write_shared(&mut self.values, shapes, &self.sharing);
        }
        Ok(())
    }

    /// Positions of the platform's mass centre and of the swing foot, from the stance foot, m.
    pub fn places(&self) -> [&[f64]; 2] {
        [self.shapes.placement.p, self.shapes.placement.swing].map(|block| block.of(&self.placement))
    }
}
