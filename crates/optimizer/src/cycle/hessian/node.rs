//! Second-order terms of one node in the local parameters: `Uᵀ G U` and the curvature of Q, Q̇, Q̈ in their parameters.

use super::PhaseWork;
use super::products::cross_duration;
use crate::cycle::phase::Phase;
use crate::instant::Chain;
use crate::swing::Of;
use piaffe_model::{Description, Gait};
use piaffe_sqp::axpy;
use smallvec::SmallVec;

/// G of a node, coordinate by coordinate; W stands for W + Wᵀ.
struct Blocks<'g> {
    w: &'g [f64],
    width: usize,
    coordinates: usize,
}

impl Blocks<'_> {
    /// Second derivatives in q, q̇, q̈ of coordinate `i` (rows) and of `j`.
    fn of(&self, i: usize, j: usize) -> [[f64; 3]; 3] {
        let [i, j] = [i, j].map(|index| [0, 1, 2].map(|order| order * self.coordinates + index));
        i.map(|a| j.map(|b| self.w[a * self.width + b] + self.w[b * self.width + a]))
    }
}

impl PhaseWork {
    /// Adds all terms of a node.
    pub(super) fn node(&mut self, gait: &dyn Gait, d: &Description, p: &Phase, node: usize) {
        self.by_durations(d, p, node);
        self.curve(gait, d, p, node);
        let chain = p.instants.chain(d, &p.flow, node);
        self.prescribed(d, p, &chain, node);
        self.unactuated(d, p, &chain, node);
        self.parameters(d, p, &chain, node);
        self.polynomials(d, p, &chain, node);
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

    /// The generated second derivatives of a node's weighted quantities, into `out` and G.
    fn curve(&mut self, gait: &dyn Gait, d: &Description, p: &Phase, node: usize) {
        let (nq, t, y) = (d.orientations(), p.duration(), p.instants.quantities);
        let w = &self.weights[node * y.len()..][..y.len()];
        let [_, betad_weight, balance] = self.direct[node];
        let [omega_beta, omega_sigma] = self.omega[node];
        // The multiplier of σ = σ(q, q̇), and the weight of σ̇.
        let chi = -(betad_weight + t * omega_beta) / p.flow.inertia(node);
        let kappa = t * omega_sigma;
        let shape = &p.shapes.curvature;
        shape.n.torque.of_mut(&mut self.n).copy_from_slice(&w[y.torque(0)..][..d.joints()]);
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
                axpy(1.0, from.of(&self.heights), to.of_mut(&mut self.out));
            }
        }
        let shared = &w[y.shared()];
        if shared.iter().any(|w| *w != 0.0) {
            gait.sharing_curvature(p.mode, q, qd, qdd, shared, &mut self.shared);
            axpy(1.0, &self.shared, &mut self.out);
        }
        if let Some((leg, weight)) = lift {
            self.of_takeoff[d.shapes.takeoff_curvature.weights.lift.place(0)] = weight;
            gait.takeoff_curvature(leg, q, qd, qdd, &self.of_takeoff, &mut self.takeoff);
            axpy(1.0, &self.takeoff, &mut self.out);
        }
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
    }

    /// Prescribed coordinates with each other: sparse in the parameters.
    fn prescribed(&mut self, d: &Description, p: &Phase, chain: &Chain, node: usize) {
        let PhaseWork { seconds, images, h, .. } = self;
        let blocks = blocks(seconds, d, p, node);
        let (basis, by_t, layout) = (chain.basis, chain.by_duration, p.layout);
        let (np, m, duration) = (layout.len(), layout.per_joint, layout.duration());
        let mut tt = 0.0;
        for jj in 0..layout.prescribed {
            let i = d.prescribed_index(jj);
            let mut by_duration = [0.0; 3];
            for ll in 0..layout.prescribed {
                let block = blocks.of(i, d.prescribed_index(ll));
                let part = times(&block, &by_t[ll]);
                by_duration.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
                if ll > jj {
                    continue;
                }
                let share = if ll == jj { 0.5 } else { 1.0 };
                for (image, column) in images.iter_mut().zip(basis) {
                    *image = times(&block, column).map(|x| share * x);
                }
                for (r, row) in basis.iter().enumerate() {
                    let slots = &mut h[layout.joint(jj, r) * np + layout.joint(ll, 0)..][..m];
                    slots.iter_mut().zip(&*images).for_each(|(slot, image)| *slot += dot3(row, image));
                }
            }
            tt += dot3(&by_t[jj], &by_duration);
            for (r, row) in basis.iter().enumerate() {
                h[layout.joint(jj, r) * np + duration] += dot3(row, &by_duration);
            }
        }
        h[duration * np + duration] += 0.5 * tt;
    }

    /// The unactuated coordinate with all: dense in the parameters.
    fn unactuated(&mut self, d: &Description, p: &Phase, chain: &Chain, node: usize) {
        let PhaseWork { seconds, v, h, omega, .. } = self;
        let blocks = blocks(seconds, d, p, node);
        let (layout, beta) = (p.layout, d.unactuated);
        let (np, m, duration) = (layout.len(), layout.per_joint, layout.duration());
        v.iter_mut().for_each(|v| v.fill(0.0));
        for jj in 0..layout.prescribed {
            // Symmetric: rows of the block are those of its transpose.
            let rows = blocks.of(beta, d.prescribed_index(jj));
            for (v, row) in v.iter_mut().zip(&rows) {
                v[jj * m..(jj + 1) * m].iter_mut().zip(chain.basis).for_each(|(slot, basis)| *slot = dot3(basis, row));
                v[duration] += dot3(&chain.by_duration[jj], row);
            }
        }
        for (v, row) in v.iter_mut().zip(&blocks.of(beta, beta)) {
            for (x, by) in row.iter().zip(chain.unactuated).filter(|(x, _)| **x != 0.0) {
                axpy(0.5 * x, by, v);
            }
        }
        // T multiplies β̇ where it is integrated: ω T β̇.
        v[1][duration] += omega[node][0];
        let ([v0, v1, v2], [s0, s1, s2]) = (&*v, chain.unactuated);
        for (r, row) in h.chunks_exact_mut(np).enumerate() {
            let [x0, x1, x2] = [v0[r], v1[r], v2[r]];
            for (((slot, s0), s1), s2) in row.iter_mut().zip(s0).zip(s1).zip(s2) {
                *slot += x0 * s0 + x1 * s1 + x2 * s2;
            }
        }
    }

    /// What depends on parameters directly, with all; and T with σ̇ where it is integrated: ω T σ̇.
    fn parameters(&mut self, d: &Description, p: &Phase, chain: &Chain, node: usize) {
        let (layout, width) = (p.layout, p.instants.width());
        let (np, states) = (layout.len(), 3 * d.orientations());
        let g = &self.seconds[node * width * width..][..width * width];
        for direct in 0..layout.direct() {
            let own = states + direct;
            let mut row = SmallVec::<[f64; 32]>::from_slice(&g[own * width..][..width]);
            row[..states].iter_mut().enumerate().for_each(|(k, x)| *x += g[k * width + own]);
            if row.iter().any(|x| *x != 0.0) {
                chain.pull(&row, &mut self.scratch);
                axpy(1.0, &self.scratch, &mut self.h[(layout.duration() + direct) * np..][..np]);
            }
        }
        p.flow.moment_gradient(node, p.duration(), &mut self.scratch);
        cross_duration(&mut self.h, &self.scratch, self.omega[node][1], layout.duration());
    }

    /// Second derivatives of Q, Q̇, Q̈ themselves, weighted with ∂L/∂(Q, Q̇, Q̈).
    fn polynomials(&mut self, d: &Description, p: &Phase, chain: &Chain, node: usize) {
        let (nq, layout, t, y) = (d.orientations(), p.layout, p.duration(), p.instants.quantities);
        let np = layout.len();
        let w = &self.weights[node * y.len()..][..y.len()];
        let gradient = p.shapes.curvature.gradient.of(&self.out);
        for jj in 0..layout.prescribed {
            let i = d.prescribed_index(jj);
            let (mut by_q, mut by_qd) = (gradient[i], gradient[nq + i]);
            if i < d.joints() {
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
                self.h[index * np + layout.duration()] += mixed;
                let value = p.parameters[index];
                duration += (0..3).map(|a| weight[a] * e[a] * (e[a] - 1.0) * b[a] / (t * t)).sum::<f64>() * value;
            }
            self.h[layout.duration() * np + layout.duration()] += 0.5 * duration;
        }
    }
}

fn blocks<'g>(seconds: &'g [f64], d: &Description, p: &Phase, node: usize) -> Blocks<'g> {
    let width = p.instants.width();
    Blocks { w: &seconds[node * width * width..][..width * width], width, coordinates: d.orientations() }
}

/// Second derivatives in the orders of one coordinate (rows) and of another (columns), times what moves the latter.
fn times(block: &[[f64; 3]; 3], v: &[f64; 3]) -> [f64; 3] {
    block.map(|row| dot3(&row, v))
}

fn dot3(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
