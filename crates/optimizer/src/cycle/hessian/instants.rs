//! Second-order terms of all instants, in the local parameters of a half step: `Uᵀ G U` at every node, products of
//! gradients where criterion and constraints are no linear functions of the quantities, and T times everything.

use super::PhaseWork;
use super::products::{cross_duration, product, square};
use crate::cycle::Cycle;
use crate::cycle::phase::Phase;
use crate::lgl::NODES;
use crate::swing::Of;
use piaffe_model::{Description, Gait};
use piaffe_sqp::dot;
use std::array::from_fn;

/// Share of an element per change of power over slope, beyond which a kink's curvature is averaged.
const REACH: f64 = 0.3;

impl Cycle<'_> {
    /// Second-order terms of all instants of phase `k`, in the local parameters.
    pub(super) fn instant_terms(&self, k: usize, mu: &[f64], work: &mut PhaseWork) {
        let d = self.description();
        let p = &self.phases[k];
        let t = p.duration();
        let mut matrix = std::mem::take(&mut work.h);
        let h = &mut matrix;
        for node in 0..p.mesh.nodes.len() {
            work.node(self.gait, d, p, node, h);
            work.by_durations(d, p, node, h);
        }
        // Products of quantities: squares of torques, torque times rate, cones.
        let scale = t * self.per_work();
        for (slot, row) in work.reach.iter_mut().zip(p.by_theta.chunks(self.moved.len())) {
            *slot = dot(row, &self.moved);
        }
        for (node, a, b, second) in &p.cost.seconds {
            let (ga, gb) = (p.instants.gradient(*node, *a), p.instants.gradient(*node, *b));
            if a == b {
                square(h, ga, second * scale);
            } else {
                // The gradient of a rate is sparse.
                product(h, gb, ga, second * scale);
            }
        }
        for kink in &p.cost.kinks {
            let g = &mut work.local;
            g.fill(0.0);
            for (i, shape) in kink.shape.iter().enumerate().take(NODES) {
                let node = kink.first + i;
                for (quantity, partial) in kink.partials(&p.cost.drives[kink.drive], p.linearized(node)) {
                    let gradient = p.instants.gradient(node, quantity);
                    g.iter_mut().zip(gradient).for_each(|(slot, by)| *slot += shape * partial * by);
                }
            }
            // A root that the next step moves out of sight bends the cost less than its slope says:
            // the last step tells how far the power at the root may change.
            let change = dot(g, &work.reach);
            let moved = REACH * change / kink.slope;
            let weight = kink.weight / (1.0 + moved * moved).sqrt();
            square(h, g, weight * scale);
        }
        for turn in &p.cost.turns {
            let drive = &p.cost.drives[turn.drive];
            let (a, b) = (&mut work.local, &mut work.scratch);
            a.fill(0.0);
            b.fill(0.0);
            let add = |to: &mut [f64], node: usize, quantity: usize, weight: f64| {
                let gradient = p.instants.gradient(node, quantity);
                to.iter_mut().zip(gradient).for_each(|(slot, by)| *slot += weight * by);
            };
            for i in 0..NODES {
                let node = turn.first + i;
                add(a, node, drive.rate(), turn.shape[i]);
                add(b, node, drive.rate(), turn.by_rate[i]);
                for (quantity, partial) in drive.torque_partials(p.linearized(node)) {
                    add(b, node, quantity, turn.by_torque[i] * partial);
                }
            }
            product(h, a, b, scale);
        }
        self.weighted_path_rows(k, mu, |node, constraint, multiplier| {
            constraint.curvature(p.linearized(node), |a, b, second| {
                product(h, p.instants.gradient(node, a), p.instants.gradient(node, b), -0.5 * multiplier * second);
            });
        });
        self.weighted_dips(k, mu, |dip, multiplier| {
            // The minimum moves: its slope's gradient twice, over the curvature in s.
            let slope = &mut work.local;
            slope.fill(0.0);
            for (i, (share, by)) in dip.lowest.shape.iter().zip(&dip.lowest.slopes).enumerate() {
                let node = dip.first() + i;
                let (constraint, y) = (&p.path[dip.constraint], p.linearized(node));
                constraint.partials(y, |quantity, partial| {
                    slope.iter_mut().zip(p.instants.gradient(node, quantity)).for_each(|(s, g)| *s += by * partial * g);
                });
                constraint.curvature(y, |a, b, second| {
                    let weight = -0.5 * multiplier * share * second;
                    product(h, p.instants.gradient(node, a), p.instants.gradient(node, b), weight);
                });
            }
            square(h, slope, multiplier / dip.lowest.curvature);
        });
        work.h = matrix;
    }
}

impl PhaseWork {
    /// Adds `Uᵀ G U` of one node and the curvature of Q, Q̇, Q̈ in the parameters.
    fn node(&mut self, gait: &dyn Gait, d: &Description, p: &Phase, node: usize, h: &mut [f64]) {
        let (nq, nj) = (d.orientations(), d.joints());
        let (layout, t) = (p.layout, p.duration());
        let (np, m, nt) = (layout.len(), layout.per_joint, layout.prescribed);
        let y = p.instants.quantities;
        let w = &self.weights[node * y.len()..][..y.len()];
        let [_, betad_weight, balance] = self.direct[node];
        let [omega_beta, omega_sigma] = self.omega[node];
        let f1 = p.flow.inertia(node);
        let chi = -(betad_weight + t * omega_beta) / f1;
        let kappa = t * omega_sigma;
        let shape = &p.shapes.curvature;
        shape.n.torque.of_mut(&mut self.n).copy_from_slice(&w[y.torque(0)..][..nj]);
        self.n[shape.n.balance.place(0)] = balance;
        self.others.fill(0.0);
        self.others[shape.others.sigma.place(0)] = chi;
        // In flight σ̇ = 0, whatever its weight.
        shape.others.sigmad.of_mut(&mut self.others).fill(kappa);
        self.others[shape.others.platform_x.place(0)] = self.travel_weight(p, node);
        self.others[shape.others.platform_height.place(0)] = w[y.height()];
        let mut lift = None;
        for foot in 0..y.feet() {
            let (factor, weight) = self.of_clearance(p, node, foot);
            let weight = weight * factor.value;
            match factor.of {
                Of::Height => self.others[shape.others.swing_height.place(foot)] = weight,
                Of::Velocity => self.others[shape.others.swing_velocity.place(foot)] = weight,
                Of::Acceleration => lift = Some((p.instants.swings[foot].leg, weight)),
            }
        }
        let [q, qd, qdd] = p.instants.state(d, node);
        gait.curvature(p.mode, q, qd, qdd, &self.n, &w[y.force(0)..][..y.components()], &self.others, &mut self.out);
        let heights = &w[y.heights()];
        if heights.iter().any(|w| *w != 0.0) {
            gait.heights_curvature(p.mode, q, heights, &mut self.heights);
            let of = &p.shapes.heights_curvature;
            for (to, from) in [(shape.gradient, of.gradient), (shape.q_q, of.q_q)] {
                let (to, from) = (to.of_mut(&mut self.out), from.of(&self.heights));
                to.iter_mut().zip(from).for_each(|(out, x)| *out += x);
            }
        }
        let shared = &w[y.shared()];
        if shared.iter().any(|w| *w != 0.0) {
            gait.sharing_curvature(p.mode, q, qd, qdd, shared, &mut self.shared);
            self.out.iter_mut().zip(&self.shared).for_each(|(out, shared)| *out += shared);
        }
        if let Some((leg, weight)) = lift {
            let of = &d.shapes.takeoff_curvature;
            self.of_takeoff[of.weights.lift.place(0)] = weight;
            gait.takeoff_curvature(leg, q, qd, qdd, &self.of_takeoff, &mut self.takeoff);
            self.out.iter_mut().zip(&self.takeoff).for_each(|(out, takeoff)| *out += takeoff);
        }
        let gradient = shape.gradient.of(&self.out);
        let [q_q, q_qd, q_qdd, qd_qd] =
            [shape.q_q, shape.q_qd, shape.q_qdd, shape.qd_qd].map(|block| block.of(&self.out));
        // G between all orders of coordinate i and all of coordinate j.
        let g = |i: usize, j: usize| {
            let (ij, ji) = (i * nq + j, j * nq + i);
            Block { q_q: q_q[ij], q_qd: q_qd[ij], qd_q: q_qd[ji], q_qdd: q_qdd[ij], qdd_q: q_qdd[ji], qd_qd: qd_qd[ij] }
        };
        let basis = &p.instants.basis[node * m..][..m];
        let by_t = p.flow.prescribed.by_duration(node);
        let beta = d.unactuated;
        let sensitivity =
            [&p.flow.beta_p, &p.flow.betad_p, &p.instants.betadd_p].map(|table| &table[node * np..][..np]);

        // Prescribed coordinates with each other: sparse in the parameters.
        let mut tt = 0.0;
        for jj in 0..nt {
            let i = d.prescribed_index(jj);
            let mut by_duration = [0.0; 3];
            for ll in 0..nt {
                let block = g(i, d.prescribed_index(ll));
                let part = block.times(&by_t[ll]);
                by_duration = from_fn(|a| by_duration[a] + part[a]);
                if ll > jj {
                    continue;
                }
                let share = if ll == jj { 0.5 } else { 1.0 };
                for (image, column) in self.images.iter_mut().zip(basis) {
                    *image = block.times(column).map(|x| share * x);
                }
                for (r, row) in basis.iter().enumerate() {
                    let slots = &mut h[layout.joint(jj, r) * np + layout.joint(ll, 0)..][..m];
                    slots.iter_mut().zip(&self.images).for_each(|(slot, image)| *slot += dot3(row, image));
                }
            }
            tt += dot3(&by_t[jj], &by_duration);
            for (r, row) in basis.iter().enumerate() {
                h[layout.joint(jj, r) * np + layout.duration()] += dot3(row, &by_duration);
            }
        }
        h[layout.duration() * np + layout.duration()] += 0.5 * tt;

        // Unactuated coordinate: dense in the parameters.
        self.v.iter_mut().for_each(|v| v.fill(0.0));
        for jj in 0..nt {
            let columns = g(d.prescribed_index(jj), beta).columns();
            for (v, column) in self.v.iter_mut().zip(&columns) {
                for (slot, row) in v[jj * m..(jj + 1) * m].iter_mut().zip(basis) {
                    *slot = dot3(row, column);
                }
                v[layout.duration()] += dot3(&by_t[jj], column);
            }
        }
        let columns = g(beta, beta).columns();
        for (v, column) in self.v.iter_mut().zip(&columns) {
            for (half, s) in column.iter().map(|x| 0.5 * x).zip(&sensitivity).filter(|(half, _)| *half != 0.0) {
                v.iter_mut().zip(*s).for_each(|(x, y)| *x += half * y);
            }
        }
        // T multiplies β̇ where it is integrated: ω T β̇.
        self.v[1][layout.duration()] += omega_beta;
        let [v0, v1, v2] = &self.v;
        let [s0, s1, s2] = sensitivity;
        for (r, row) in h.chunks_mut(np).enumerate() {
            let [x0, x1, x2] = [v0[r], v1[r], v2[r]];
            for (((slot, s0), s1), s2) in row.iter_mut().zip(s0).zip(s1).zip(s2) {
                *slot += x0 * s0 + x1 * s1 + x2 * s2;
            }
        }
        // ω T σ̇.
        p.flow.moment_gradient(node, t, &mut self.scratch);
        cross_duration(h, &self.scratch, omega_sigma, layout.duration());

        // Second derivatives of Q, Q̇, Q̈ themselves, weighted with ∂L/∂(Q, Q̇, Q̈).
        for jj in 0..nt {
            let i = d.prescribed_index(jj);
            let (mut by_q, mut by_qd) = (gradient[i], gradient[nq + i]);
            if i < nj {
                by_q += w[y.angle(i)];
                by_qd += w[y.rate(i)];
            }
            let weight = [by_q, by_qd, gradient[2 * nq + i]];
            let mut duration = 0.0;
            for (r, b) in basis.iter().enumerate() {
                let is_rate = p.mesh.basis.is_rate(r);
                // ∂²/∂parameter∂T of Q, Q̇, Q̈: exponents of T are 0, −1, −2, or one more for rates.
                let e = [0.0, -1.0, -2.0].map(|e| if is_rate { e + 1.0 } else { e });
                let mixed = (0..3).map(|a| weight[a] * e[a] * b[a] / t).sum::<f64>();
                let index = layout.joint(jj, r);
                h[index * np + layout.duration()] += mixed;
                let value = p.parameters[index];
                duration += (0..3).map(|a| weight[a] * e[a] * (e[a] - 1.0) * b[a] / (t * t)).sum::<f64>() * value;
            }
            h[layout.duration() * np + layout.duration()] += 0.5 * duration;
        }
    }

    /// What depends on durations beside the state: factors of clearances, and in flight the mass centre's parabola.
    fn by_durations(&mut self, d: &Description, p: &Phase, node: usize, h: &mut [f64]) {
        let (np, y, layout) = (p.layout.len(), p.instants.quantities, p.layout);
        let w = &self.weights[node * y.len()..][..y.len()];
        for foot in 0..y.feet() {
            let Some(by) = p.instants.by_durations(&p.mesh, node, foot) else { continue };
            let (factor, weight) = self.of_clearance(p, node, foot);
            if weight == 0.0 {
                continue;
            }
            // The clearance is factor · made_of.
            let made_of = p.linearized(node)[y.clearance(foot)] / factor.value;
            self.scratch.copy_from_slice(p.instants.gradient(node, y.clearance(foot)));
            for (at, by) in layout.durations().zip(&by.first) {
                self.scratch[at] -= made_of * by;
            }
            for (at, by) in layout.durations().zip(&by.first) {
                cross_duration(h, &self.scratch, weight * by / factor.value, at);
            }
            for (row, second) in layout.durations().zip(by.second.chunks(by.first.len())) {
                for (column, second) in layout.durations().zip(second) {
                    h[row * np + column] += 0.5 * weight * made_of * second;
                }
            }
        }
        let Some(fall) = p.fall(d) else { return };
        let mut height = w[y.height()] + w[y.heights()].iter().sum::<f64>();
        for foot in 0..y.feet() {
            let (factor, weight) = self.of_clearance(p, node, foot);
            if factor.of == Of::Height {
                height += weight * factor.value;
            }
        }
        if node == p.last() {
            height += self.landing;
        }
        let weights = [height, self.travel_weight(p, node)];
        fall.second_derivatives(p.mesh.nodes[node].0, weights, |other, second| {
            h[layout.duration() * np + other] += second;
        });
    }

    /// T times the integral of the criterion.
    pub(super) fn bilinear(&mut self, p: &Phase, per_work: f64) {
        self.scratch.fill(0.0);
        for (node, quantity, partial) in &p.cost.partials {
            for (s, g) in self.scratch.iter_mut().zip(p.instants.gradient(*node, *quantity)) {
                *s += partial * g;
            }
        }
        cross_duration(&mut self.h, &self.scratch, per_work, p.layout.duration());
    }
}

/// Second derivatives in the orders of one coordinate (rows) and of another (columns); the others are zero.
struct Block {
    q_q: f64,
    q_qd: f64,
    qd_q: f64,
    q_qdd: f64,
    qdd_q: f64,
    qd_qd: f64,
}

impl Block {
    fn times(&self, v: &[f64; 3]) -> [f64; 3] {
        [
            self.q_q * v[0] + self.q_qd * v[1] + self.q_qdd * v[2],
            self.qd_q * v[0] + self.qd_qd * v[1],
            self.qdd_q * v[0],
        ]
    }

    fn columns(&self) -> [[f64; 3]; 3] {
        [[self.q_q, self.qd_q, self.qdd_q], [self.q_qd, self.qd_qd, 0.0], [self.q_qdd, 0.0, 0.0]]
    }
}

fn dot3(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
