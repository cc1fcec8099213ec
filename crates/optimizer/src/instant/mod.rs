//! Everything that constraints and criteria look at, at each instant of a half step.
//!
//! The *quantities* of an instant are the torques of all joints, the reaction, the joints' angles and
//! rates, the swing foot's clearance, the platform's height and that of all that can be lowest; each with its gradient in the half step's parameters.

mod chain;
mod glance;
mod quantities;

pub use glance::Glance;
pub use quantities::{Quantities, Shared, direction};

use crate::stance::{Layout, Mesh, Stance, basis_derivatives};
use chain::{Chain, parts};
use piaffe_model::shape::Shapes;
use piaffe_model::{Description, FORWARD, Gait, UP};

/// The quantities at all nodes of a half step: values, and derivatives of the last linearization.
#[derive(Clone, Debug)]
pub struct Instants {
    pub quantities: Quantities,
    shapes: &'static Shapes,
    layout: Layout,
    /// One row of quantities per node.
    pub values: Vec<f64>,
    /// q, q̇ and q̈, a row per node.
    states: Vec<f64>,
    /// Results of the `inverse_jacobian` and `placement` kernels, a row per node, and of `swing_velocity` at both ends.
    inverse: Vec<f64>,
    placement: Vec<f64>,
    swing: [Vec<f64>; 2],
    /// Results of the `heights` kernel, a row per node.
    heights: Vec<f64>,
    /// Results of the `sharing` kernel, a row per node; none if nothing shared is looked at.
    sharing: Vec<f64>,
    /// Per node and quantity a row of derivatives in the local parameters.
    gradients: Vec<f64>,
    /// ∂β̈/∂parameters, a row per node.
    pub betadd_p: Vec<f64>,
    /// Per node and basis parameter the derivatives of Q, Q̇, Q̈.
    pub basis: Vec<[f64; 3]>,
}

impl Instants {
    pub fn new(description: &Description, mesh: &Mesh) -> Instants {
        let quantities = Quantities::new(description);
        let layout = Layout::new(description, &mesh.basis);
        let (nq, shapes) = (description.orientations(), description.shapes);
        let n = mesh.nodes.len();
        Instants {
            quantities,
            shapes,
            layout,
            values: vec![0.0; n * quantities.len()],
            states: vec![0.0; n * 3 * nq],
            inverse: vec![0.0; n * shapes.inverse_jacobian.len],
            placement: vec![0.0; n * shapes.placement.len],
            swing: [shapes.swing_velocity.zeros(), shapes.swing_velocity.zeros()],
            heights: vec![0.0; n * shapes.heights.len],
            sharing: vec![0.0; n * quantities.sharing(shapes).len],
            gradients: vec![0.0; n * quantities.len() * layout.len()],
            betadd_p: vec![0.0; n * layout.len()],
            basis: vec![[0.0; 3]; n * layout.per_joint],
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

    /// Gradient of a quantity at a node in the local parameters.
    #[inline]
    pub fn gradient(&self, node: usize, quantity: usize) -> &[f64] {
        let np = self.layout.len();
        &self.gradients[(node * self.quantities.len() + quantity) * np..][..np]
    }

    /// Gradients of all quantities of a node, row after row.
    #[inline]
    pub fn gradients(&self, node: usize) -> &[f64] {
        let size = self.quantities.len() * self.layout.len();
        &self.gradients[node * size..][..size]
    }

    /// q, q̇ and q̈ at a node.
    pub fn state(&self, d: &Description, node: usize) -> [&[f64]; 3] {
        let nq = d.orientations();
        [0, 1, 2].map(|order| &self.states[(3 * node + order) * nq..][..nq])
    }

    /// Position of the platform's mass centre from the stance foot at a node, m.
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

    /// Result of the `swing_velocity` kernel at the first (0) or last (1) node.
    pub fn swing_velocity(&self, end: usize) -> &[f64] {
        &self.swing[end]
    }

    /// Evaluates all quantities; `stance` must have been integrated.
    pub fn evaluate(&mut self, gait: &dyn Gait, leg: usize, mesh: &Mesh, stance: &Stance, parameters: &[f64]) {
        let d = gait.description();
        let (nq, s) = (d.orientations(), self.shapes);
        let t = parameters[self.layout.duration()];
        let last = mesh.nodes.len() - 1;
        let y = self.quantities;
        let inverse_rows = self.inverse.chunks_mut(s.inverse_jacobian.len);
        let placement_rows = self.placement.chunks_mut(s.placement.len);
        let value_rows = self.values.chunks_mut(y.len());
        let rows = self.states.chunks_mut(3 * nq).zip(inverse_rows).zip(placement_rows).zip(value_rows);
        for (k, (((state, inverse), placement), values)) in rows.enumerate() {
            let share = mesh.nodes[k].0;
            let [prescribed, rates, accelerations] = stance.prescribed.at(k);
            let (q, rest) = state.split_at_mut(nq);
            let (qd, qdd) = rest.split_at_mut(nq);
            for j in 0..self.layout.prescribed {
                let index = d.prescribed_index(j);
                (q[index], qd[index], qdd[index]) = (prescribed[j], rates[j], accelerations[j]);
            }
            (q[d.unactuated], qd[d.unactuated]) = (stance.beta[k], stance.betad[k]);
            gait.inverse_jacobian(leg, q, qd, accelerations, inverse);
            let ([torques, force], betadd) = {
                let shape = &s.inverse_jacobian;
                ([shape.gamma.of(inverse), shape.f.of(inverse)], shape.beta_dd.value(inverse))
            };
            qdd[d.unactuated] = betadd;
            gait.placement(leg, q, placement);
            y.write(values, [q, qd], [torques, force], s.placement.p.of(placement)[UP]);
            values[y.clearance()] = if k == 0 || k == last {
                let end = usize::from(k == last);
                gait.swing_velocity(leg, q, qd, &mut self.swing[end]);
                direction(end) * s.swing_velocity.v.of(&self.swing[end])[UP] * t
            } else {
                s.placement.swing.of(placement)[UP] / (4.0 * share * (1.0 - share))
            };
            let heights = &mut self.heights[k * s.heights.len..][..s.heights.len];
            gait.heights(leg, q, heights);
            values[y.heights()].copy_from_slice(s.heights.heights.of(heights));
            if y.shared > 0 {
                let sharing = &mut self.sharing[k * s.sharing.len..][..s.sharing.len];
                gait.sharing(leg, q, qd, qdd, sharing);
                y.write_shared(values, s, sharing);
            }
        }
    }

    /// Gradients of all quantities; `stance` must have been differentiated.
    pub fn differentiate(&mut self, d: &Description, mesh: &Mesh, stance: &Stance, parameters: &[f64]) {
        let (nq, nj, np, s) = (d.orientations(), d.joints(), self.layout.len(), self.shapes);
        let (y, layout) = (self.quantities, self.layout);
        let t = parameters[layout.duration()];
        let last = mesh.nodes.len() - 1;
        let mut gradients = std::mem::take(&mut self.gradients);
        let mut betadd = std::mem::take(&mut self.betadd_p);
        for k in 0..mesh.nodes.len() {
            self.tabulate(mesh, parameters, k);
            let chain = Chain::new(self, d, stance, k);
            // β̈ follows from the balance (eq. 10): its row tells how.
            let betadd_p = &mut betadd[k * np..(k + 1) * np];
            let balance = parts(self.balance(k), nq);
            chain.row(balance, None, betadd_p);
            let over_f1 = -1.0 / balance[2][d.unactuated];
            betadd_p.iter_mut().for_each(|x| *x *= over_f1);

            let block = &mut gradients[k * y.len() * np..(k + 1) * y.len() * np];
            for (row, out) in self.forces(k).zip(block.chunks_mut(np)) {
                chain.row(parts(row, nq), Some(betadd_p), out);
            }
            for (j, out) in block[y.angle(0) * np..].chunks_mut(np).take(nj).enumerate() {
                chain.coordinate(j, 0, out);
            }
            for (j, out) in block[y.rate(0) * np..].chunks_mut(np).take(nj).enumerate() {
                chain.coordinate(j, 1, out);
            }
            let row = s.placement.p_q.row(self.placement(k), UP);
            chain.row([row, &[], &[]], None, &mut block[y.height() * np..][..np]);
            let heights = block[y.heights().start * np..y.heights().end * np].chunks_mut(np);
            for (row, out) in self.heights(k).zip(heights) {
                chain.row([row, &[], &[]], None, out);
            }
            for (row, out) in self.sharing(k).zip(block[y.shared().start * np..].chunks_mut(np)) {
                chain.row(parts(row, nq), Some(betadd_p), out);
            }
            let out = &mut block[y.clearance() * np..][..np];
            if k == 0 || k == last {
                let end = usize::from(k == last);
                let swing = &self.swing[end];
                let row = s.swing_velocity.v_w.row(swing, UP);
                chain.row([&row[..nq], &row[nq..], &[]], None, out);
                out.iter_mut().for_each(|x| *x *= direction(end) * t);
                out[layout.duration()] += direction(end) * s.swing_velocity.v.of(swing)[UP];
            } else {
                let share = mesh.nodes[k].0;
                let row = s.placement.swing_q.row(self.placement(k), UP);
                chain.row([row, &[], &[]], None, out);
                out.iter_mut().for_each(|x| *x /= 4.0 * share * (1.0 - share));
            }
        }
        self.gradients = gradients;
        self.betadd_p = betadd;
    }

    /// Derivatives of Q, Q̇, Q̈ at node `k`, for the duration at hand.
    fn tabulate(&mut self, mesh: &Mesh, parameters: &[f64], k: usize) {
        let layout = self.layout;
        let t = parameters[layout.duration()];
        let jet = &mesh.nodes[k].1;
        for i in 0..layout.per_joint {
            self.basis[k * layout.per_joint + i] = basis_derivatives(&mesh.basis, jet, t, i);
        }
    }

    /// Gradient of the platform's x at a node, in the local parameters; after `differentiate`.
    pub fn platform_x_gradient(&self, d: &Description, stance: &Stance, node: usize, out: &mut [f64]) {
        let row = self.shapes.placement.p_q.row(self.placement(node), FORWARD);
        Chain::new(self, d, stance, node).row([row, &[], &[]], None, out);
    }
}

/// A kernel's numbers at a node, in a table of them.
#[inline]
fn result(table: &[f64], length: usize, node: usize) -> &[f64] {
    &table[node * length..][..length]
}
