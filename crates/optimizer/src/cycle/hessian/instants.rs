//! Second-order terms of all instants, in the local parameters of a phase: `Uᵀ G U` at every node, where G also has products of
//! gradients of quantities, and products of gradients over several nodes.

use super::PhaseWork;
use super::products::{cross_duration, product, square};
use crate::constraints::PathConstraint;
use crate::cycle::Cycle;
use crate::cycle::phase::Phase;
use crate::lgl::NODES;
use crate::swing::Of;
use piaffe_model::{Description, Gait};
use piaffe_sqp::{axpy, dot};
use smallvec::SmallVec;

/// Share of an element per change of power over slope, beyond which a kink's curvature is averaged.
const REACH: f64 = 0.3;

impl Cycle<'_> {
    /// Second-order terms of all instants of phase `k`, in the local parameters.
    pub(super) fn instant_terms(&self, k: usize, mu: &[f64], work: &mut PhaseWork) {
        let d = self.description();
        let p = &self.phases[k];
        let t = p.duration();
        let (width, count) = (p.instants.width(), p.instants.width().pow(2));
        let PhaseWork { seconds, local, reach, h, .. } = work;
        seconds.fill(0.0);
        let in_state = |node: usize| node * count..(node + 1) * count;
        // Products of quantities: squares of torques, torque times rate, cones.
        let scale = t * self.per_work();
        for (node, a, b, second) in &p.cost.seconds {
            let (ga, gb) = (p.instants.gradient(*node, *a), p.instants.gradient(*node, *b));
            let w = &mut seconds[in_state(*node)];
            if a == b {
                square(w, ga, second * scale);
            } else {
                // The gradient of a rate is sparse.
                product(w, gb, ga, second * scale);
            }
        }
        reach.iter_mut().zip(p.by_theta.push(&self.moved)).for_each(|(slot, moved)| *slot = moved);
        for kink in &p.cost.kinks {
            local.fill(0.0);
            for (i, shape) in kink.shape.iter().enumerate().take(NODES) {
                let node = kink.first + i;
                let mut state = SmallVec::<[f64; 32]>::from_elem(0.0, width);
                for (quantity, partial) in kink.partials(&p.cost.drives[kink.drive], p.linearized(node)) {
                    axpy(shape * partial, p.instants.gradient(node, quantity), &mut state);
                }
                p.pull(d, node, &state, local);
            }
            // A root that the next step moves out of sight bends the cost less than its slope says:
            // the last step tells how far the power at the root may change.
            let change = dot(local, reach);
            let moved = REACH * change / kink.slope;
            let weight = kink.weight / (1.0 + moved * moved).sqrt();
            square(h, local, weight * scale);
        }
        for turn in &p.cost.turns {
            let drive = &p.cost.drives[turn.drive];
            let (mut a, mut b) = (p.no_parameters(), p.no_parameters());
            for i in 0..NODES {
                let node = turn.first + i;
                p.add_quantity(d, node, drive.rate(), turn.shape[i], &mut a);
                p.add_quantity(d, node, drive.rate(), turn.by_rate[i], &mut b);
                for (quantity, partial) in drive.torque_partials(p.linearized(node)) {
                    p.add_quantity(d, node, quantity, turn.by_torque[i] * partial, &mut b);
                }
            }
            product(h, &a, &b, scale);
        }
        let mut bend = |node: usize, constraint: &PathConstraint, weight: f64| {
            constraint.curvature(p.linearized(node), |a, b, second| {
                let [a, b] = [a, b].map(|quantity| p.instants.gradient(node, quantity));
                product(&mut seconds[in_state(node)], a, b, weight * second);
            });
        };
        self.weighted_path_rows(k, mu, |node, constraint, multiplier| bend(node, constraint, -0.5 * multiplier));
        self.weighted_dips(k, mu, |dip, multiplier| {
            // The minimum moves: its slope's gradient twice, over the curvature in s.
            local.fill(0.0);
            let constraint = &p.path[dip.constraint];
            for (i, (share, by)) in dip.lowest.shape.iter().zip(&dip.lowest.slopes).enumerate() {
                let node = dip.first() + i;
                p.add_constraint(d, node, constraint, *by, local);
                bend(node, constraint, -0.5 * multiplier * share);
            }
            square(h, local, multiplier / dip.lowest.curvature);
        });
        for node in 0..p.mesh.nodes.len() {
            work.by_durations(d, p, node);
            work.node(self.gait, d, p, node);
        }
    }
}

impl PhaseWork {
    /// Adds `Uᵀ G U` of one node and the curvature of Q, Q̇, Q̈ in the parameters.
    fn node(&mut self, gait: &dyn Gait, d: &Description, p: &Phase, node: usize) {
        let (nq, nj) = (d.orientations(), d.joints());
        let (layout, t) = (p.layout, p.duration());
        let (np, nt) = (layout.len(), layout.prescribed);
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
        let width = p.instants.width();
        let g = &mut self.seconds[node * width * width..][..width * width];
        for i in 0..nq {
            let (by_q, by_qd) = g[i * width..].split_at_mut(nq * width);
            for j in 0..nq {
                let ij = i * nq + j;
                by_q[j] += 0.5 * q_q[ij];
                by_q[nq + j] += q_qd[ij];
                by_q[2 * nq + j] += q_qdd[ij];
                by_qd[nq + j] += 0.5 * qd_qd[ij];
            }
        }
        // All orders of coordinate i with all of coordinate j: G is W + Wᵀ.
        let block = |i: usize, j: usize| {
            let [i, j] = [i, j].map(|index| [index, nq + index, 2 * nq + index]);
            i.map(|a| j.map(|b| g[a * width + b] + g[b * width + a]))
        };
        let chain = p.instants.chain(d, &p.flow, node);
        let (basis, by_t, m, duration) = (chain.basis, chain.by_duration, layout.per_joint, layout.duration());
        let h = &mut self.h;
        // Prescribed coordinates with each other: sparse in the parameters.
        let mut tt = 0.0;
        for jj in 0..nt {
            let i = d.prescribed_index(jj);
            let mut by_duration = [0.0; 3];
            for ll in 0..nt {
                let block = block(i, d.prescribed_index(ll));
                let part = times(&block, &by_t[ll]);
                by_duration.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
                if ll > jj {
                    continue;
                }
                let share = if ll == jj { 0.5 } else { 1.0 };
                for (image, column) in self.images.iter_mut().zip(basis) {
                    *image = times(&block, column).map(|x| share * x);
                }
                for (r, row) in basis.iter().enumerate() {
                    let slots = &mut h[layout.joint(jj, r) * np + layout.joint(ll, 0)..][..m];
                    slots.iter_mut().zip(&self.images).for_each(|(slot, image)| *slot += dot3(row, image));
                }
            }
            tt += dot3(&by_t[jj], &by_duration);
            for (r, row) in basis.iter().enumerate() {
                h[layout.joint(jj, r) * np + duration] += dot3(row, &by_duration);
            }
        }
        h[duration * np + duration] += 0.5 * tt;

        // Unactuated coordinate: dense in the parameters.
        let beta = d.unactuated;
        self.v.iter_mut().for_each(|v| v.fill(0.0));
        for jj in 0..nt {
            // Symmetric: rows of the block are those of its transpose.
            let rows = block(beta, d.prescribed_index(jj));
            for (v, row) in self.v.iter_mut().zip(&rows) {
                v[jj * m..(jj + 1) * m].iter_mut().zip(basis).for_each(|(slot, basis)| *slot = dot3(basis, row));
                v[duration] += dot3(&by_t[jj], row);
            }
        }
        for (v, row) in self.v.iter_mut().zip(&block(beta, beta)) {
            for (x, by) in row.iter().zip(chain.unactuated).filter(|(x, _)| **x != 0.0) {
                axpy(0.5 * x, by, v);
            }
        }
        // T multiplies β̇ where it is integrated: ω T β̇.
        self.v[1][duration] += omega_beta;
        let ([v0, v1, v2], [s0, s1, s2]) = (&self.v, chain.unactuated);
        for (r, row) in h.chunks_exact_mut(np).enumerate() {
            let [x0, x1, x2] = [v0[r], v1[r], v2[r]];
            for (((slot, s0), s1), s2) in row.iter_mut().zip(s0).zip(s1).zip(s2) {
                *slot += x0 * s0 + x1 * s1 + x2 * s2;
            }
        }

        // What depends on parameters directly, with all.
        for direct in 0..layout.direct() {
            let own = 3 * nq + direct;
            let mut row = SmallVec::<[f64; 32]>::from_slice(&g[own * width..][..width]);
            row[..3 * nq].iter_mut().enumerate().for_each(|(k, x)| *x += g[k * width + own]);
            if row.iter().any(|x| *x != 0.0) {
                chain.pull(&row, &mut self.scratch);
                axpy(1.0, &self.scratch, &mut h[(duration + direct) * np..][..np]);
            }
        }
        // ω T σ̇.
        p.flow.moment_gradient(node, t, &mut self.scratch);
        cross_duration(h, &self.scratch, omega_sigma, duration);

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
            for (r, b) in chain.basis.iter().enumerate() {
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
    fn by_durations(&mut self, d: &Description, p: &Phase, node: usize) {
        let (nq, width, y) = (d.orientations(), p.instants.width(), p.instants.quantities);
        let w = &self.weights[node * y.len()..][..y.len()];
        let mut height = w[y.height()] + w[y.heights()].iter().sum::<f64>();
        for foot in 0..y.feet() {
            let (factor, weight) = self.of_clearance(p, node, foot);
            if factor.of == Of::Height {
                height += weight * factor.value;
            }
            let Some(by) = p.instants.by_durations(&p.mesh, node, foot).filter(|_| weight != 0.0) else { continue };
            // The clearance is factor · made_of.
            let made_of = p.linearized(node)[y.clearance(foot)] / factor.value;
            let mut gradient = SmallVec::<[f64; 32]>::from_slice(p.instants.gradient(node, y.clearance(foot)));
            let g = &mut self.seconds[node * width * width..][..width * width];
            let durations = || p.instants.direct_durations(nq);
            for (at, by) in durations().zip(&by.first) {
                gradient[at] -= made_of * by;
            }
            for (at, by) in durations().zip(&by.first) {
                axpy(weight * by / factor.value, &gradient, &mut g[at * width..][..width]);
            }
            for (row, second) in durations().zip(by.second.chunks(by.first.len())) {
                for (column, second) in durations().zip(second) {
                    g[row * width + column] += 0.5 * weight * made_of * second;
                }
            }
        }
        let Some(fall) = p.fall(d) else { return };
        if node == p.last() {
            height += self.landing;
        }
        let weights = [height, self.travel_weight(p, node)];
        let g = &mut self.seconds[node * width * width..][..width * width];
        fall.second_derivatives(p.mesh.nodes[node].0, weights, |other, second| {
            g[3 * nq * width + 3 * nq + other] += second;
        });
    }
}

/// Second derivatives in the orders of one coordinate (rows) and of another (columns), times what moves the latter.
fn times(block: &[[f64; 3]; 3], v: &[f64; 3]) -> [f64; 3] {
    block.map(|row| dot3(&row, v))
}

fn dot3(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
