//! Everything that constraints and criteria look at, at each instant of a half step.
//!
//! The *quantities* of an instant are the torques of all joints, the reaction, the joints' angles and
//! rates, the swing foot's clearance and the platform's height; each with its gradient in the half step's parameters.

use crate::constraints::sharing;
use crate::model::{Description, Gait};
use crate::stance::{Layout, Mesh, Stance, State, Undefined, basis_derivatives};

/// Where each quantity stands.
#[derive(Clone, Copy, Debug)]
pub struct Quantities {
    joints: usize,
    components: usize,
    shared: usize,
}

impl Quantities {
    pub fn new(description: &Description) -> Quantities {
        let shared = if sharing::applies(description) { Shared::new(description).len() } else { 0 };
        Quantities { joints: description.joints(), components: description.positions(), shared }
    }

    /// Γj, N·m.
    pub fn torque(&self, joint: usize) -> usize {
        joint
    }

    /// Component of the reaction at the stance foot, N.
    pub fn force(&self, component: usize) -> usize {
        self.joints + component
    }

    /// Joint angle, rad.
    pub fn angle(&self, joint: usize) -> usize {
        self.joints + self.components + joint
    }

    /// Joint rate, rad/s.
    pub fn rate(&self, joint: usize) -> usize {
        2 * self.joints + self.components + joint
    }

    /// Height of the swing foot over `4 s (1 − s)`: the height of the parabola that it touches, m.
    /// At both ends its limit: the vertical speed times T/4, up or down.
    pub fn clearance(&self) -> usize {
        3 * self.joints + self.components
    }

    /// Height of the platform's mass centre over the ground, m.
    pub fn height(&self) -> usize {
        self.clearance() + 1
    }

    /// What decides how the real legs share the load, if their limits count: see [`Shared`].
    pub fn shared(&self) -> std::ops::Range<usize> {
        self.height() + 1..self.height() + 1 + self.shared
    }

    /// Writes what follows from the state itself, and torques and reaction.
    fn write(&self, values: &mut [f64], q: &[f64], qd: &[f64], forces: &[f64], height: f64) {
        let nj = self.joints;
        values[..nj + self.components].copy_from_slice(forces);
        values[self.angle(0)..][..nj].copy_from_slice(&q[..nj]);
        values[self.rate(0)..][..nj].copy_from_slice(&qd[..nj]);
        values[self.height()] = height;
    }

    pub fn len(&self) -> usize {
        self.shared().end
    }

    pub fn is_empty(&self) -> bool {
        false
    }
}

/// Order of what the kernel `sharing` gives.
#[derive(Clone, Copy, Debug)]
pub struct Shared {
    joints: usize,
}

impl Shared {
    pub fn new(description: &Description) -> Shared {
        let leg = &description.legs[0];
        Shared { joints: leg.end_joint - leg.first_joint }
    }

    /// Moment about the vertical (0) or the transverse axis (1).
    pub fn moment(self, axis: usize) -> usize {
        axis
    }

    /// Component of ∂foot/∂q for a joint of the leg in support.
    pub fn lever(self, joint: usize, component: usize) -> usize {
        2 + 3 * joint + component
    }

    pub fn len(self) -> usize {
        self.lever(self.joints, 0)
    }

    pub fn is_empty(self) -> bool {
        false
    }
}

/// The quantities at all nodes of a half step: values, and derivatives of the last linearization.
#[derive(Clone, Debug)]
pub struct Instants {
    pub quantities: Quantities,
    layout: Layout,
    /// One row of quantities per node.
    pub values: Vec<f64>,
    /// q, q̇ and q̈, a row per node.
    states: Vec<f64>,
    /// Results of the `inverse_jacobian` and `placement` kernels, a row per node, and of `swing_velocity` at both ends.
    inverse: Vec<f64>,
    placement: Vec<f64>,
    swing: [Vec<f64>; 2],
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
        let (nq, nj, nc) = (description.orientations(), description.joints(), description.positions());
        let n = mesh.nodes.len();
        Instants {
            quantities,
            layout,
            values: vec![0.0; n * quantities.len()],
            states: vec![0.0; n * 3 * nq],
            inverse: vec![0.0; n * inverse_length(nq, nj, nc)],
            placement: vec![0.0; n * placement_length(nq, nc)],
            swing: [vec![0.0; nc + nc * 2 * nq], vec![0.0; nc + nc * 2 * nq]],
            sharing: vec![0.0; n * sharing_length(nq, quantities.shared)],
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
    pub fn platform(&self, description: &Description, node: usize) -> &[f64] {
        &self.placement(description, node)[..description.positions()]
    }

    /// Result of the `placement` kernel at a node.
    pub fn placement(&self, d: &Description, node: usize) -> &[f64] {
        let length = placement_length(d.orientations(), d.positions());
        &self.placement[node * length..][..length]
    }

    /// Jacobian of the `inverse_jacobian` kernel at a node: rows Γ, F, balance; columns q, q̇, q̈.
    pub fn jacobian(&self, d: &Description, node: usize) -> &[f64] {
        let (nq, nj, nc) = (d.orientations(), d.joints(), d.positions());
        &self.inverse[node * inverse_length(nq, nj, nc)..][1 + nj + nc..][..(nj + nc + 1) * 3 * nq]
    }

    /// Jacobian of the `sharing` kernel at a node: rows moment, levers; columns q, q̇, q̈. Empty if nothing shared is looked at.
    pub fn sharing(&self, d: &Description, node: usize) -> &[f64] {
        let length = sharing_length(d.orientations(), self.quantities.shared);
        &self.sharing[node * length..][..length][self.quantities.shared..]
    }

    /// Result of the `swing_velocity` kernel at the first (0) or last (1) node.
    pub fn swing_velocity(&self, end: usize) -> &[f64] {
        &self.swing[end]
    }

    /// Evaluates all quantities; `stance` must have been integrated.
    pub fn evaluate(&mut self, gait: &dyn Gait, leg: usize, mesh: &Mesh, stance: &Stance, parameters: &[f64]) {
        let d = gait.description();
        let (nq, nj, nc) = (d.orientations(), d.joints(), d.positions());
        let t = parameters[self.layout.duration()];
        let last = mesh.nodes.len() - 1;
        let y = self.quantities;
        let inverse_rows = self.inverse.chunks_mut(inverse_length(nq, nj, nc));
        let placement_rows = self.placement.chunks_mut(placement_length(nq, nc));
        let value_rows = self.values.chunks_mut(y.len());
        let rows = self.states.chunks_mut(3 * nq).zip(inverse_rows).zip(placement_rows).zip(value_rows);
        for (k, (((state, inverse), placement), values)) in rows.enumerate() {
            let s = mesh.nodes[k].0;
            let [prescribed, rates, accelerations] = stance.prescribed.at(k);
            let (q, rest) = state.split_at_mut(nq);
            let (qd, qdd) = rest.split_at_mut(nq);
            for j in 0..self.layout.prescribed {
                let index = d.prescribed_index(j);
                (q[index], qd[index], qdd[index]) = (prescribed[j], rates[j], accelerations[j]);
            }
            (q[d.unactuated], qd[d.unactuated]) = (stance.beta[k], stance.betad[k]);
            gait.inverse_jacobian(leg, q, qd, accelerations, inverse);
            qdd[d.unactuated] = inverse[0];
            gait.placement(leg, q, placement);
            y.write(values, q, qd, &inverse[1..1 + nj + nc], placement[1]);
            values[y.clearance()] = if k == 0 || k == last {
                let end = usize::from(k == last);
                gait.swing_velocity(leg, q, qd, &mut self.swing[end]);
                direction(end) * self.swing[end][1] * t
            } else {
                placement[nc + 1] / (4.0 * s * (1.0 - s))
            };
            if y.shared > 0 {
                let length = sharing_length(nq, y.shared);
                let sharing = &mut self.sharing[k * length..][..length];
                gait.sharing(leg, q, qd, qdd, sharing);
                values[y.shared()].copy_from_slice(&sharing[..y.shared]);
            }
        }
    }

    /// Gradients of all quantities; `stance` must have been differentiated.
    pub fn differentiate(&mut self, d: &Description, mesh: &Mesh, stance: &Stance, parameters: &[f64]) {
        let (nq, nj, nc, np) = (d.orientations(), d.joints(), d.positions(), self.layout.len());
        let (y, layout) = (self.quantities, self.layout);
        let t = parameters[layout.duration()];
        let last = mesh.nodes.len() - 1;
        let mut gradients = std::mem::take(&mut self.gradients);
        let mut betadd = std::mem::take(&mut self.betadd_p);
        for k in 0..mesh.nodes.len() {
            self.tabulate(mesh, parameters, k);
            let chain = Chain::new(self, d, stance, k);
            let jacobian = self.jacobian(d, k);
            let row = |r: usize| parts(jacobian, r, nq);
            // β̈ follows from the balance (eq. 10): its row tells how.
            let betadd_p = &mut betadd[k * np..(k + 1) * np];
            let balance = row(nj + nc);
            chain.row(balance, None, betadd_p);
            let over_f1 = -1.0 / balance[2][d.unactuated];
            betadd_p.iter_mut().for_each(|x| *x *= over_f1);

            let block = &mut gradients[k * y.len() * np..(k + 1) * y.len() * np];
            for (r, out) in block.chunks_mut(np).take(nj + nc).enumerate() {
                chain.row(row(r), Some(betadd_p), out);
            }
            for (j, out) in block[y.angle(0) * np..].chunks_mut(np).take(nj).enumerate() {
                chain.coordinate(j, 0, out);
            }
            for (j, out) in block[y.rate(0) * np..].chunks_mut(np).take(nj).enumerate() {
                chain.coordinate(j, 1, out);
            }
            let row = &self.placement(d, k)[2 * nc + nq..][..nq];
            chain.row([row, &[], &[]], None, &mut block[y.height() * np..][..np]);
            for (r, out) in block[y.shared().start * np..].chunks_mut(np).enumerate() {
                chain.row(parts(self.sharing(d, k), r, nq), Some(betadd_p), out);
            }
            let out = &mut block[y.clearance() * np..][..np];
            if k == 0 || k == last {
                let end = usize::from(k == last);
                let swing = &self.swing[end];
                let row = &swing[nc + 2 * nq..][..2 * nq];
                chain.row([&row[..nq], &row[nq..], &[]], None, out);
                out.iter_mut().for_each(|x| *x *= direction(end) * t);
                out[layout.duration()] += direction(end) * swing[1];
            } else {
                let s = mesh.nodes[k].0;
                let row = &self.placement(d, k)[2 * nc + nc * nq + nq..][..nq];
                chain.row([row, &[], &[]], None, out);
                out.iter_mut().for_each(|x| *x /= 4.0 * s * (1.0 - s));
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
        let (nq, nc) = (d.orientations(), d.positions());
        let row = &self.placement(d, node)[2 * nc..][..nq];
        Chain::new(self, d, stance, node).row([row, &[], &[]], None, out);
    }
}

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

/// Row `r` of a Jacobian in (q, q̇, q̈), by parts.
fn parts(jacobian: &[f64], r: usize, nq: usize) -> [&[f64]; 3] {
    let row = &jacobian[r * 3 * nq..][..3 * nq];
    [&row[..nq], &row[nq..2 * nq], &row[2 * nq..]]
}

/// Sign and factor that turn the swing foot's vertical velocity into clearance: up first, down last.
pub fn direction(end: usize) -> f64 {
    if end == 0 { 0.25 } else { -0.25 }
}

fn inverse_length(nq: usize, nj: usize, nc: usize) -> usize {
    1 + nj + nc + (nj + nc + 1) * 3 * nq
}

fn sharing_length(nq: usize, shared: usize) -> usize {
    shared + shared * 3 * nq
}

fn placement_length(nq: usize, nc: usize) -> usize {
    2 * nc + 2 * nc * nq
}

/// The chain rule at one node: from partial derivatives in q, q̇, q̈ to the local parameters.
struct Chain<'a> {
    d: &'a Description,
    layout: Layout,
    basis: &'a [[f64; 3]],
    by_duration: &'a [[f64; 3]],
    beta_p: &'a [f64],
    betad_p: &'a [f64],
}

impl<'a> Chain<'a> {
    fn new(instants: &'a Instants, d: &'a Description, stance: &'a Stance, node: usize) -> Chain<'a> {
        let layout = instants.layout;
        let np = layout.len();
        Chain {
            d,
            layout,
            basis: &instants.basis[node * layout.per_joint..][..layout.per_joint],
            by_duration: stance.prescribed.by_duration(node),
            beta_p: &stance.beta_p[node * np..][..np],
            betad_p: &stance.betad_p[node * np..][..np],
        }
    }

    /// `parts` are the partial derivatives in q, q̇ and q̈ (each may be empty). Without `betadd_p` the
    /// derivative in β̈ is left out.
    fn row(&self, parts: [&[f64]; 3], betadd_p: Option<&[f64]>, out: &mut [f64]) {
        let (layout, beta) = (self.layout, self.d.unactuated);
        let at = |part: usize, index: usize| parts[part].get(index).copied().unwrap_or(0.0);
        let mut by_duration = 0.0;
        for (j, out) in out.chunks_mut(layout.per_joint).take(layout.prescribed).enumerate() {
            let index = self.d.prescribed_index(j);
            let [a, b, c] = [at(0, index), at(1, index), at(2, index)];
            for (o, basis) in out.iter_mut().zip(self.basis) {
                *o = a * basis[0] + b * basis[1] + c * basis[2];
            }
            let t = self.by_duration[j];
            by_duration += a * t[0] + b * t[1] + c * t[2];
        }
        out[layout.duration()] = by_duration;
        out[layout.beta()] = 0.0;
        out[layout.sigma()] = 0.0;
        let [a, b, c] = [at(0, beta), at(1, beta), at(2, beta)];
        match betadd_p {
            Some(betadd_p) => {
                for (((o, x), y), z) in out.iter_mut().zip(self.beta_p).zip(self.betad_p).zip(betadd_p) {
                    *o += a * x + b * y + c * z;
                }
            }
            None => {
                for ((o, x), y) in out.iter_mut().zip(self.beta_p).zip(self.betad_p) {
                    *o += a * x + b * y;
                }
            }
        }
    }

    /// Gradient of coordinate `index` of q (order 0) or of q̇ (order 1).
    fn coordinate(&self, index: usize, order: usize, out: &mut [f64]) {
        let layout = self.layout;
        if index == self.d.unactuated {
            out.copy_from_slice(if order == 0 { self.beta_p } else { self.betad_p });
            return;
        }
        let j = if index < self.d.unactuated { index } else { index - 1 };
        out.fill(0.0);
        for (o, basis) in out[layout.joint(j, 0)..].iter_mut().zip(self.basis) {
            *o = basis[order];
        }
        out[layout.duration()] = self.by_duration[j][order];
    }
}
