//! A look at an instant between the nodes.

use super::Quantities;
use crate::flow::{Fall, Flow, Layout, Mesh, State, Undefined};
use crate::swing::{Swing, swings};
use piaffe_model::shape::ModeShapes;
use piaffe_model::{Description, Gait, Mode, UP};

/// One instant between the nodes: the same quantities, without derivatives.
#[derive(Clone, Debug)]
pub struct Glance {
    quantities: Quantities,
    mode: Mode,
    swings: Vec<Swing>,
    /// The durations that they depend on, s.
    durations: Vec<f64>,
    shapes: &'static ModeShapes,
    pub state: State,
    pub qdd: Vec<f64>,
    /// Of all quantities.
    pub values: Vec<f64>,
    inverse: Vec<f64>,
    placement: Vec<f64>,
    heights: Vec<f64>,
    sharing: Vec<f64>,
    /// Positions from the stance foot, or in flight from below where the mass centre took off, m.
    platform: Vec<f64>,
    feet: Vec<f64>,
    /// Of the robot's mass centre in flight, else zero, m/s.
    pub centre_velocity: [f64; 2],
}

impl Glance {
    /// At instants of phase `k` of a gait.
    pub fn new(d: &Description, k: usize) -> Glance {
        let mode = d.phases[k].mode;
        let (quantities, shapes) = (Quantities::new(d, mode), d.shape(mode));
        Glance {
            quantities,
            mode,
            swings: swings(d, k),
            durations: Vec::with_capacity(d.phases.len()),
            shapes,
            state: State::new(d, mode),
            qdd: vec![0.0; d.orientations()],
            values: vec![0.0; quantities.len()],
            inverse: shapes.inverse.zeros(),
            placement: shapes.placement.zeros(),
            heights: shapes.heights.zeros(),
            sharing: quantities.sharing(shapes).zeros(),
            platform: vec![0.0; shapes.placement.p.len()],
            feet: vec![0.0; shapes.placement.swing.len()],
            centre_velocity: [0.0; 2],
        }
    }

    /// Looks at `s` of an integrated phase, neither its beginning nor its end.
    ///
    /// # Errors
    /// As for [`Flow::integrate`].
    pub fn at(
        &mut self,
        gait: &dyn Gait,
        mesh: &Mesh,
        flow: &Flow,
        layout: &Layout,
        parameters: &[f64],
        s: f64,
    ) -> Result<(), Undefined> {
        let (y, shapes, mode) = (self.quantities, self.shapes, self.mode);
        flow.at(gait, mode, mesh, parameters, s, &mut self.state)?;
        let State { q, qd, prescribed: [.., accelerations], .. } = &self.state;
        gait.inverse(mode, q, qd, accelerations, &mut self.inverse);
        let shape = &shapes.inverse;
        let [xdd, torques, force] = [shape.xdd, shape.gamma, shape.f].map(|block| block.of(&self.inverse));
        self.qdd.copy_from_slice(&xdd[xdd.len() - q.len()..]);
        gait.placement(mode, q, &mut self.placement);
        self.platform.copy_from_slice(shapes.placement.p.of(&self.placement));
        self.feet.copy_from_slice(shapes.placement.swing.of(&self.placement));
        gait.heights(mode, q, &mut self.heights);
        let components = self.platform.len();
        let mut fallen = 0.0;
        if let Some(fall) = Fall::new(layout, gait.description().gravity, parameters) {
            fallen = fall.height(s);
            self.centre_velocity = fall.velocity(s);
            fall.carry(s, &mut self.platform, components);
            fall.carry(s, &mut self.feet, components);
        }
        y.write(&mut self.values, [q, qd], [torques, force], self.platform[UP]);
        self.durations.clear();
        self.durations.extend(layout.durations().map(|at| parameters[at]));
        for (foot, swing) in self.swings.iter().enumerate() {
            self.values[y.clearance(foot)] = self.feet[foot * components + UP] * swing.factor(&self.durations, s).value;
        }
        let heights = &mut self.values[y.heights()];
        heights.copy_from_slice(shapes.heights.heights.of(&self.heights));
        heights.iter_mut().for_each(|height| *height += fallen);
        if y.shared > 0 {
            gait.sharing(mode, q, qd, &self.qdd, &mut self.sharing);
            y.write_shared(&mut self.values, shapes, &self.sharing);
        }
        Ok(())
    }

    /// Positions of the platform's mass centre and of the feet in the air, one after the other; from the stance foot, or in flight
    /// from the ground below where the mass centre took off, m.
    pub fn places(&self) -> [&[f64]; 2] {
        [&self.platform, &self.feet]
    }
}
