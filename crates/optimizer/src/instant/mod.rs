//! Everything that constraints and criteria look at, at each instant of a phase.
//!
//! The *quantities* of an instant are the torques of all joints, the reaction, the joints' angles and
//! rates, the clearances of the feet in the air, the platform's height and that of all that can be lowest; each with its gradient in
//! the instant's state (see `chain`).

mod chain;
mod glance;
mod quantities;

pub use chain::Chain;
pub use glance::Glance;
pub use quantities::{Quantities, Shared};

use crate::flow::{Fall, Flow, Layout, Mesh, basis_derivatives};
use crate::swing::{ByDurations, Factor, Of, Swing, swings};
use piaffe_model::shape::{ModeShapes, Takeoff};
use piaffe_model::{Description, FORWARD, Gait, Mode, UP};

/// The quantities at all nodes of a phase: values, and derivatives of the last linearization.
#[derive(Clone, Debug)]
pub struct Instants {
    pub quantities: Quantities,
    mode: Mode,
    /// Of the feet in the air, in the order in which kernels give them.
    pub swings: Vec<Swing>,
    /// The durations that they depend on, s.
    durations: Vec<f64>,
    shapes: &'static ModeShapes,
    takeoff_shape: Takeoff,
    layout: Layout,
    components: usize,
    gravity: f64,
    /// Entries of a state.
    width: usize,
    /// One row of quantities per node.
    pub values: Vec<f64>,
    /// q, q̇ and q̈, a row per node.
    states: Vec<f64>,
    /// Results of the `inverse_jacobian` and `placement` kernels, a row per node, and of `swing_velocity` at both ends.
    inverse: Vec<f64>,
    placement: Vec<f64>,
    swing: [Vec<f64>; 2],
    /// Result of the `takeoff` kernel at the first node, of the foot that leaves there at rest.
    takeoff: Vec<f64>,
    /// Results of the `heights` kernel, a row per node.
    heights: Vec<f64>,
    /// Results of the `sharing` kernel, a row per node; none if nothing shared is looked at.
    sharing: Vec<f64>,
    /// Per node and quantity a row of derivatives in the state. Those of angles and rates are units and never change.
    gradients: Vec<f64>,
    /// A state.
    scratch: Vec<f64>,
    /// ∂β̈/∂parameters, a row per node.
    betadd_p: Vec<f64>,
    /// Per node and basis parameter the derivatives of Q, Q̇, Q̈.
    basis: Vec<[f64; 3]>,
    /// The same in T, per node and prescribed coordinate.
    by_duration: Vec<[f64; 3]>,
}

impl Instants {
    /// Of phase `k` of a gait.
    pub fn new(d: &Description, mesh: &Mesh, k: usize) -> Instants {
        let mode = d.phases[k].mode;
        let quantities = Quantities::new(d, mode);
        let layout = Layout::new(d, k, &mesh.basis);
        let swings = swings(d, k);
        let (nq, shapes) = (d.orientations(), d.shape(mode));
        let n = mesh.nodes.len();
        let leaves = swings.iter().any(Swing::begins_at_rest);
        let takeoff_shape = if leaves { d.shapes.takeoff } else { Takeoff::NONE };
        let width = 3 * nq + layout.direct();
        let mut gradients = vec![0.0; n * quantities.len() * width];
        for block in gradients.chunks_mut(quantities.len() * width) {
            for joint in 0..d.joints() {
                block[quantities.angle(joint) * width + joint] = 1.0;
                block[quantities.rate(joint) * width + nq + joint] = 1.0;
            }
        }
        Instants {
            quantities,
            mode,
            swings,
            durations: vec![0.0; layout.durations().count()],
            shapes,
            takeoff: takeoff_shape.zeros(),
            takeoff_shape,
            layout,
            components: d.positions(),
            gravity: d.gravity,
            values: vec![0.0; n * quantities.len()],
            states: vec![0.0; n * 3 * nq],
            inverse: vec![0.0; n * shapes.inverse_jacobian.len],
            placement: vec![0.0; n * shapes.placement.len],
            swing: [shapes.swing_velocity.zeros(), shapes.swing_velocity.zeros()],
            heights: vec![0.0; n * shapes.heights.len],
            sharing: vec![0.0; n * quantities.sharing(shapes).len],
            width,
            gradients,
            scratch: vec![0.0; width],
            betadd_p: vec![0.0; n * layout.len()],
            basis: vec![[0.0; 3]; n * layout.per_joint],
            by_duration: vec![[0.0; 3]; n * layout.prescribed],
        }
    }

    /// Value of a quantity at a node.
    #[inline]
    pub fn value(&self, node: usize, quantity: usize) -> f64 {
        self.values[node * self.quantities.len() + quantity]
    }

    /// All values of a node.
    #[inline]
    pub fn row(&self, node: usize) -> &[f64] {
        &self.values[node * self.quantities.len()..][..self.quantities.len()]
    }

    /// Entries of a state: see [`Chain`].
    #[inline]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Gradient of a quantity at a node in the state.
    #[inline]
    pub fn gradient(&self, node: usize, quantity: usize) -> &[f64] {
        &self.gradients[(node * self.quantities.len() + quantity) * self.width..][..self.width]
    }

    /// Gradients of all quantities of a node in the state, row after row.
    #[inline]
    pub fn gradients(&self, node: usize) -> &[f64] {
        let size = self.quantities.len() * self.width;
        &self.gradients[node * size..][..size]
    }

    /// The chain rule at a node, of the last linearization.
    pub fn chain<'a>(&'a self, d: &'a Description, flow: &'a Flow, node: usize) -> Chain<'a> {
        let np = self.layout.len();
        Chain::new(self, d, flow, node, &self.betadd_p[node * np..][..np])
    }

    /// q, q̇ and q̈ at a node.
    pub fn state(&self, d: &Description, node: usize) -> [&[f64]; 3] {
        let nq = d.orientations();
        [0, 1, 2].map(|order| &self.states[(3 * node + order) * nq..][..nq])
    }

    /// Position of the platform's mass centre from the stance foot, or in flight from the robot's, at a node, m.
    pub fn platform(&self, node: usize) -> &[f64] {
        self.shapes.placement.p.of(self.placement(node))
    }

    /// Result of the `placement` kernel at a node.
    pub fn placement(&self, node: usize) -> &[f64] {
        result(&self.placement, self.shapes.placement.len, node)
    }

    /// ∂/∂(q, q̇, q̈) of torques, then the reaction at a node.
    pub fn forces(&self, node: usize) -> impl Iterator<Item = &[f64]> {
        let shape = &self.shapes.inverse_jacobian;
        let inverse = result(&self.inverse, shape.len, node);
        shape.gamma_w.each(inverse).chain(shape.f_w.each(inverse))
    }

    /// ∂/∂(q, q̇, q̈) of the balance (eq. 10) at a node.
    pub fn balance(&self, node: usize) -> &[f64] {
        let shape = &self.shapes.inverse_jacobian;
        shape.balance_w.of(result(&self.inverse, shape.len, node))
    }

    /// ∂/∂q of the heights at a node, point by point.
    pub fn heights(&self, node: usize) -> impl Iterator<Item = &[f64]> {
        let shape = &self.shapes.heights;
        shape.heights_q.each(result(&self.heights, shape.len, node))
    }

    /// ∂/∂(q, q̇, q̈) of what real legs share at a node: moment, then levers. None if nothing shared is looked at.
    pub fn sharing(&self, node: usize) -> impl Iterator<Item = &[f64]> {
        let shape = self.quantities.sharing(self.shapes);
        let sharing = result(&self.sharing, shape.len, node);
        shape.moment_w.each(sharing).chain(shape.levers_w.each(sharing))
    }

    /// Where the vertical position or velocity of a foot in the air stands in a kernel's block of them.
    pub fn up(&self, foot: usize) -> usize {
        foot * self.components + UP
    }

    /// What a foot's clearance at a node is made of.
    pub fn factor(&self, mesh: &Mesh, node: usize, foot: usize) -> Factor {
        self.swings[foot].factor(&self.durations, mesh.nodes[node].0)
    }

    /// How that factor depends on the durations of phases, if it does.
    pub fn by_durations(&self, mesh: &Mesh, node: usize, foot: usize) -> Option<ByDurations> {
        self.swings[foot].by_durations(&self.durations, mesh.nodes[node].0)
    }

    /// Gradient of what a foot's clearance at a node is made of, in (q, q̇, q̈) or the first of them, as far as the state decides.
    pub fn of_foot(&self, mesh: &Mesh, node: usize, foot: usize, of: Of) -> &[f64] {
        let up = self.up(foot);
        match of {
            Of::Height => self.shapes.placement.swing_q.row(self.placement(node), up),
            Of::Velocity => {
                let end = usize::from(node + 1 == mesh.nodes.len());
                self.shapes.swing_velocity.v_w.row(&self.swing[end], up)
            }
            Of::Acceleration => self.takeoff_shape.lift_w.of(&self.takeoff),
        }
    }

    /// Evaluates all quantities; `flow` must have been integrated.
    pub fn evaluate(&mut self, gait: &dyn Gait, mesh: &Mesh, flow: &Flow, parameters: &[f64]) {
        let d = gait.description();
        let (nq, s, mode) = (d.orientations(), self.shapes, self.mode);
        let last = mesh.nodes.len() - 1;
        let y = self.quantities;
        let fall = Fall::new(&self.layout, self.gravity, parameters);
        self.durations.iter_mut().zip(self.layout.durations()).for_each(|(t, at)| *t = parameters[at]);
        let inverse_rows = self.inverse.chunks_mut(s.inverse_jacobian.len);
        let placement_rows = self.placement.chunks_mut(s.placement.len);
        let value_rows = self.values.chunks_mut(y.len());
        let rows = self.states.chunks_mut(3 * nq).zip(inverse_rows).zip(placement_rows).zip(value_rows);
        for (k, (((state, inverse), placement), values)) in rows.enumerate() {
            let share = mesh.nodes[k].0;
            let [prescribed, rates, accelerations] = flow.prescribed.at(k);
            let (q, rest) = state.split_at_mut(nq);
            let (qd, qdd) = rest.split_at_mut(nq);
            for j in 0..self.layout.prescribed {
                let index = d.prescribed_index(j);
                (q[index], qd[index], qdd[index]) = (prescribed[j], rates[j], accelerations[j]);
            }
            (q[d.unactuated], qd[d.unactuated]) = (flow.beta[k], flow.betad[k]);
            gait.inverse_jacobian(mode, q, qd, accelerations, inverse);
            let ([torques, force], betadd) = {
                let shape = &s.inverse_jacobian;
                ([shape.gamma.of(inverse), shape.f.of(inverse)], shape.beta_dd.value(inverse))
            };
            qdd[d.unactuated] = betadd;
            gait.placement(mode, q, placement);
            let fallen = fall.map_or(0.0, |fall| fall.height(share));
            y.write(values, [q, qd], [torques, force], s.placement.p.of(placement)[UP] + fallen);
            if k == 0 || k == last {
                gait.swing_velocity(mode, q, qd, &mut self.swing[usize::from(k == last)]);
            }
            for (foot, swing) in self.swings.iter().enumerate() {
                let up = foot * self.components + UP;
                let factor = swing.factor(&self.durations, share);
                let made_of = match factor.of {
                    Of::Height => s.placement.swing.of(placement)[up] + fallen,
                    Of::Velocity => {
                        let rise = fall.map_or(0.0, |fall| fall.rise(share));
                        s.swing_velocity.v.of(&self.swing[usize::from(k == last)])[up] + rise
                    }
                    Of::Acceleration => {
                        gait.takeoff(swing.leg, q, qd, qdd, &mut self.takeoff);
                        self.takeoff_shape.lift.value(&self.takeoff)
                    }
                };
                values[y.clearance(foot)] = factor.value * made_of;
            }
            let heights = &mut self.heights[k * s.heights.len..][..s.heights.len];
            gait.heights(mode, q, heights);
            let own = &mut values[y.heights()];
            own.copy_from_slice(s.heights.heights.of(heights));
            if fall.is_some() {
                own.iter_mut().for_each(|height| *height += fallen);
            }
            if y.shared > 0 {
                let sharing = &mut self.sharing[k * s.sharing.len..][..s.sharing.len];
                gait.sharing(mode, q, qd, qdd, sharing);
                y.write_shared(values, s, sharing);
            }
        }
    }

    /// Gradients of all quantities; `flow` must have been differentiated.
    pub fn differentiate(&mut self, d: &Description, mesh: &Mesh, flow: &Flow, parameters: &[f64]) {
        let (nq, np, width, s) = (d.orientations(), self.layout.len(), self.width, self.shapes);
        let y = self.quantities;
        let fall = Fall::new(&self.layout, self.gravity, parameters);
        let mut gradients = std::mem::take(&mut self.gradients);
        let mut betadd = std::mem::take(&mut self.betadd_p);
        let mut state = std::mem::take(&mut self.scratch);
        for (k, block) in gradients.chunks_mut(y.len() * width).enumerate() {
            let share = mesh.nodes[k].0;
            self.tabulate(mesh, flow, parameters, k);
            // β̈ follows from the balance (eq. 10): its row tells how.
            state[..3 * nq].copy_from_slice(self.balance(k));
            let over_f1 = -1.0 / std::mem::take(&mut state[2 * nq + d.unactuated]);
            state.iter_mut().for_each(|x| *x *= over_f1);
            Chain::new(self, d, flow, k, &[]).pull_explicit(&state, &mut betadd[k * np..(k + 1) * np]);

            for (row, out) in self.forces(k).zip(block.chunks_mut(width)) {
                out[..3 * nq].copy_from_slice(row);
            }
            let height = s.placement.p_q.row(self.placement(k), UP);
            let heights = std::iter::once(height).chain(self.heights(k));
            for (row, out) in heights.zip(block[y.height() * width..].chunks_mut(width)) {
                out[..nq].copy_from_slice(row);
                if let Some(fall) = fall {
                    out[3 * nq..].fill(0.0);
                    fall.add_height_gradient(share, 1.0, &mut out[3 * nq..]);
                }
            }
            for (row, out) in self.sharing(k).zip(block[y.shared().start * width..].chunks_mut(width)) {
                out[..3 * nq].copy_from_slice(row);
            }
            for foot in 0..y.feet() {
                let factor = self.factor(mesh, k, foot);
                let clearance = self.values[k * y.len() + y.clearance(foot)];
                let out = &mut block[y.clearance(foot) * width..][..width];
                let row = self.of_foot(mesh, k, foot, factor.of);
                out.fill(0.0);
                out[..row.len()].copy_from_slice(row);
                let direct = &mut out[3 * nq..];
                match (fall, factor.of) {
                    (Some(fall), Of::Height) => fall.add_height_gradient(share, 1.0, direct),
                    (Some(fall), Of::Velocity) => fall.add_rise_gradient(share, 1.0, direct),
                    _ => {}
                }
                out.iter_mut().for_each(|x| *x *= factor.value);
                if let Some(by) = self.by_durations(mesh, k, foot) {
                    for (at, by) in self.direct_durations(nq).zip(&by.first) {
                        out[at] += clearance / factor.value * by;
                    }
                }
            }
        }
        self.gradients = gradients;
        self.betadd_p = betadd;
        self.scratch = state;
    }

    /// Where the durations that swings depend on stand in a state of `nq` coordinates.
    pub fn direct_durations(&self, nq: usize) -> impl Iterator<Item = usize> + '_ {
        self.layout.durations().map(move |at| 3 * nq + at - self.layout.duration())
    }

    /// Derivatives of Q, Q̇, Q̈ at node `k`, for the duration at hand.
    fn tabulate(&mut self, mesh: &Mesh, flow: &Flow, parameters: &[f64], k: usize) {
        let layout = self.layout;
        let t = parameters[layout.duration()];
        let jet = &mesh.nodes[k].1;
        for i in 0..layout.per_joint {
            self.basis[k * layout.per_joint + i] = basis_derivatives(&mesh.basis, jet, t, i);
        }
        self.by_duration[k * layout.prescribed..][..layout.prescribed].copy_from_slice(flow.prescribed.by_duration(k));
    }

    /// How far forward the platform's mass centre has come at a node since take-off or beside the stance foot, m.
    pub fn platform_x(&self, mesh: &Mesh, parameters: &[f64], node: usize) -> f64 {
        let fall = Fall::new(&self.layout, self.gravity, parameters);
        self.platform(node)[FORWARD] + fall.map_or(0.0, |fall| fall.advance(mesh.nodes[node].0))
    }

    /// Its gradient in the local parameters; after `differentiate`.
    pub fn platform_x_gradient(
        &self,
        d: &Description,
        mesh: &Mesh,
        flow: &Flow,
        parameters: &[f64],
        node: usize,
        out: &mut [f64],
    ) {
        let row = self.shapes.placement.p_q.row(self.placement(node), FORWARD);
        let mut state = smallvec::SmallVec::<[f64; 32]>::from_elem(0.0, self.width);
        state[..row.len()].copy_from_slice(row);
        if let Some(fall) = Fall::new(&self.layout, self.gravity, parameters) {
            fall.add_advance_gradient(mesh.nodes[node].0, 1.0, &mut state[3 * d.orientations()..]);
        }
        self.chain(d, flow, node).pull_explicit(&state, out);
    }

    /// The foot that leaves the ground at rest when the phase begins.
    pub fn leaving_at_rest(&self) -> Option<usize> {
        self.swings.iter().position(Swing::begins_at_rest)
    }
}

/// A kernel's numbers at a node, in a table of them.
#[inline]
fn result(table: &[f64], length: usize, node: usize) -> &[f64] {
    &table[node * length..][..length]
}
