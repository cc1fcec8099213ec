//! The exact Hessian of the Lagrangian `L = cost − λᵀc_E − μᵀc_I` in Θ.
//!
//! Per half step, L is a sum over instants of the quantities there, and (β, σ) at the instants are
//! implicit in the parameters. The *adjoint* of the collocation equations gives their multipliers ω;
//! with them, and with χ for σ = σ(q, q̇) (eq. 8) and one for the balance of eq. 10, all implicit
//! second-order terms vanish, and what is left is `Uᵀ G U` per instant: G is the generated second
//! derivative of one weighted sum (kernel `curvature`), U the known sensitivities of (q, q̇, q̈).
//! Explicit curvature remains where parameters enter bilinearly: T with the polynomial's values, and
//! the initial velocities and σ as functions of Θ through the impact (kernel `touchdown_curvature`).
//!
//! All terms of an instant are summed into a matrix W with Hessian W + Wᵀ: a product of two gradients
//! then is written once instead of twice.

use super::phase::Phase;
use super::problem::{CLOSURE, pitch, pitch_unit};
use super::{Cycle, Variables, renamed};
use crate::instant::direction;
use crate::lgl::NODES;
use crate::model::{Description, Gait};
use crate::sqp::dot;
use crate::stance::Stance;
use std::array::from_fn;

/// Share of an element per change of power over slope, beyond which a kink's curvature is averaged.
const REACH: f64 = 0.3;

/// Memory of the computation, allocated once.
#[derive(Default)]
pub struct Workspace {
    /// A row of local parameters.
    pub local: Vec<f64>,
    phase: PhaseWork,
    /// The last step, in local parameters.
    reach: Vec<f64>,
    /// W, later the Hessian, of one half step in its local parameters, and half its projection.
    h_local: Vec<f64>,
    half: Vec<f64>,
    touchdown: Vec<f64>,
    small: Vec<f64>,
    xi: Vec<f64>,
    outputs: Vec<f64>,
    kernel: Vec<f64>,
    rows: Vec<f64>,
    /// Weights that are not there: as many as any kernel input needs.
    zeros: Vec<f64>,
}

/// Multipliers and second-order terms of one half step.
#[derive(Default)]
struct PhaseWork {
    /// Weights of all quantities, a row per node: ∂L/∂quantity at fixed Θ.
    weights: Vec<f64>,
    /// Gradient of this half step's part of L in the local parameters.
    gradient: Vec<f64>,
    /// Weight of the platform's x at the end, minus that at the start.
    travel: f64,
    /// Adjoint weights of T β̇ and T σ̇ at every node.
    omega: Vec<[f64; 2]>,
    /// ∂L/∂(β, σ) at fixed parameters, per node.
    stationarity: Vec<[f64; 2]>,
    /// Per node ∂L/∂(β, β̇) through the quantities, and the multiplier of the balance.
    direct: Vec<[f64; 3]>,
    out: Vec<f64>,
    /// The same of what real legs share.
    shared: Vec<f64>,
    n: Vec<f64>,
    /// One vector of local parameters per unactuated column of G.
    v: [Vec<f64>; 3],
    /// A block of G times each parameter's part in (Q, Q̇, Q̈).
    images: Vec<[f64; 3]>,
    scratch: Vec<f64>,
}

impl Workspace {
    pub fn new(d: &Description, variables: &Variables, phase: &Phase) -> Workspace {
        let (nq, nc, n, np) = (d.orientations(), d.positions(), variables.total(), phase.layout.len());
        let z = |count: usize| vec![0.0; count];
        Workspace {
            local: z(np),
            phase: PhaseWork {
                weights: z(phase.linearized.len()),
                gradient: z(np),
                travel: 0.0,
                omega: Vec::with_capacity(phase.mesh.nodes.len()),
                stationarity: Vec::with_capacity(phase.mesh.nodes.len()),
                direct: Vec::with_capacity(phase.mesh.nodes.len()),
                out: z(3 * nq + 4 * nq * nq),
                shared: z(3 * nq + 4 * nq * nq),
                n: z(d.joints() + 1),
                v: [z(np), z(np), z(np)],
                images: vec![[0.0; 3]; phase.layout.per_joint],
                scratch: z(np),
            },
            reach: z(np),
            h_local: z(np * np),
            half: z(np * n),
            touchdown: z(3 * nq * nq),
            small: z(4 * nq * nq),
            xi: z(nq),
            outputs: z(phase.impact.len()),
            kernel: z(3 * nq + 4 * nq * nq),
            rows: z(2 * nq * n),
            zeros: z(nq + d.joints() + nc + 1),
        }
    }
}

impl Cycle<'_> {
    /// Writes the full symmetric Hessian at the linearized point.
    pub(super) fn lagrangian_hessian(&mut self, lambda: &[f64], mu: &[f64], hessian: &mut [f64]) {
        let n = self.variables.total();
        hessian.fill(0.0);
        let mut work = std::mem::take(&mut self.workspace);
        for k in 0..self.phases.len() {
            self.weigh(k, lambda, mu, &mut work.phase);
            let p = &self.phases[k];
            work.phase.adjoint(self.description(), p, lambda, k);
            work.h_local.fill(0.0);
            self.instant_terms(k, mu, &mut work);
            work.phase.bilinear(p, &mut work.h_local, self.travel);
            add_transpose(&mut work.h_local, p.layout.len());
            // Θ through the parameters: first order twice, then second order once.
            congruence(&work.h_local, &p.by_theta, n, &mut work.half, hessian);
            self.start_terms(k, lambda, mu, &mut work, hessian);
        }
        // cost = work/travel: the quotient's own curvature.
        for i in 0..n {
            for j in 0..n {
                let product =
                    self.cost_gradient[i] * self.travel_gradient[j] + self.travel_gradient[i] * self.cost_gradient[j];
                hessian[i * n + j] -= product / self.travel;
            }
        }
        self.workspace = work;
    }

    /// ∂L/∂(quantities) of half step `k`, and the gradient of its part of L.
    fn weigh(&self, k: usize, lambda: &[f64], mu: &[f64], work: &mut PhaseWork) {
        let d = self.description();
        let p = &self.phases[k];
        let count = p.instants.quantities.len();
        let nodes = p.mesh.nodes.len();
        let t = p.duration();
        work.weights.clear();
        work.weights.resize(nodes * count, 0.0);
        for (node, quantity, partial) in &p.cost.partials {
            work.weights[node * count + quantity] += t * partial / self.travel;
        }
        let weights = &mut work.weights;
        self.weighted_path_rows(mu, |phase, node, constraint, multiplier| {
            if phase == k {
                constraint.partials(p.linearized(node), |quantity, partial| {
                    weights[node * count + quantity] -= multiplier * partial
                });
            }
        });
        self.weighted_dips(k, mu, |dip, multiplier| {
            for (i, share) in dip.lowest.shape.iter().enumerate() {
                let node = dip.first() + i;
                self.path[dip.constraint].partials(p.linearized(node), |quantity, partial| {
                    weights[node * count + quantity] -= multiplier * share * partial
                });
            }
        });
        let speed = lambda[CLOSURE * self.phases.len()];
        work.travel = -self.cost / self.travel - speed / d.leg_length();

        // Gradient in the local parameters: all rows with their weights.
        let np = p.layout.len();
        let gradient = &mut work.gradient;
        gradient.fill(0.0);
        for node in 0..nodes {
            for (row, w) in p.instants.gradients(node).chunks(np).zip(&work.weights[node * count..]) {
                if *w != 0.0 {
                    gradient.iter_mut().zip(row).for_each(|(g, r)| *g += w * r);
                }
            }
        }
        let last = p.last() * np;
        let terminal = [
            (work.travel, &p.travel_p[..]),
            (-lambda[CLOSURE * k], &p.stance.beta_p[last..][..np]),
            (-lambda[CLOSURE * k + 1], &p.stance.sigma_p[last..][..np]),
        ];
        for (w, row) in terminal {
            gradient.iter_mut().zip(row).for_each(|(g, r)| *g += w * r);
        }
        gradient[p.layout.duration()] += p.cost.value / self.travel;
    }

    /// Second-order terms of all instants of half step `k`, in the local parameters.
    fn instant_terms(&self, k: usize, mu: &[f64], work: &mut Workspace) {
        let d = self.description();
        let p = &self.phases[k];
        let t = p.duration();
        let h = &mut work.h_local;
        for node in 0..p.mesh.nodes.len() {
            work.phase.node(self.gait, d, p, node, h);
        }
        // Products of quantities: squares of torques, torque times rate, cones.
        let scale = t / self.travel;
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
            let (torque, rate) = (p.instants.quantities.torque(kink.joint), p.instants.quantities.rate(kink.joint));
            for (i, shape) in kink.shape.iter().enumerate().take(NODES) {
                let node = kink.first + i;
                let y = p.linearized(node);
                let (gt, gr) = (p.instants.gradient(node, torque), p.instants.gradient(node, rate));
                for ((slot, a), b) in g.iter_mut().zip(gt).zip(gr) {
                    *slot += shape * (y[rate] * a + y[torque] * b);
                }
            }
            // A root that the next step moves out of sight bends the cost less than its slope says:
            // the last step tells how far the power at the root may change.
            let change = dot(g, &work.reach);
            let moved = REACH * change / kink.slope;
            let weight = kink.weight / (1.0 + moved * moved).sqrt();
            square(h, g, weight * scale);
        }
        self.weighted_path_rows(mu, |phase, node, constraint, multiplier| {
            if phase == k {
                constraint.curvature(p.linearized(node), |a, b, second| {
                    product(h, p.instants.gradient(node, a), p.instants.gradient(node, b), -0.5 * multiplier * second);
                });
            }
        });
        self.weighted_dips(k, mu, |dip, multiplier| {
            // The minimum moves: its slope's gradient twice, over the curvature in s.
            let slope = &mut work.local;
            slope.fill(0.0);
            for (i, (share, by)) in dip.lowest.shape.iter().zip(&dip.lowest.slopes).enumerate() {
                let node = dip.first() + i;
                let (constraint, y) = (&self.path[dip.constraint], p.linearized(node));
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
    }

    /// Curvature of the initial state as a function of Θ, and of what is imposed at the end.
    fn start_terms(&self, k: usize, lambda: &[f64], mu: &[f64], work: &mut Workspace, hessian: &mut [f64]) {
        let d = self.description();
        let (nq, n) = (d.orientations(), self.variables.total());
        let p = &self.phases[k];
        let layout = p.layout;
        let sigma_weight = work.phase.gradient[layout.sigma()];

        // σ(q, q̇) at the start.
        self.sigma_curvature(
            p,
            &p.q_start,
            &p.qd_start,
            sigma_weight,
            0.0,
            &work.zeros,
            &mut work.kernel,
            &mut work.small,
        );
        congruence(&work.small, &p.start_by_theta, n, &mut work.rows, hessian);

        // The touchdown that leads here, at the end of the half step before.
        let before = self.before(k);
        let b = &self.phases[before];
        work.xi.fill(0.0);
        for row in 0..nq {
            let (from, sign) = renamed(d, row);
            let mut weight = sigma_weight * p.momentum_start[1 + nq + row];
            if row != d.unactuated {
                let j = if row < d.unactuated { row } else { row - 1 };
                weight += work.phase.gradient[layout.joint(j, 1)];
            }
            work.xi[from] += sign * weight;
        }
        work.outputs.fill(0.0);
        let first = self.first_impact_row() + before * self.impact.count();
        for c in 0..self.impact.count() {
            let multiplier = mu[first + c];
            if multiplier != 0.0 {
                self.impact.partials(c, &b.impact, |i, partial| work.outputs[i] -= multiplier * partial);
            }
        }
        if let Some(multiplier) = lambda.get(CLOSURE * self.phases.len() + 1 + before) {
            work.outputs[pitch(d)] -= multiplier / pitch_unit(d);
        }
        self.gait.touchdown_curvature(1 - b.leg, &b.q_end, &b.qd_end, &work.xi, &work.outputs, &mut work.touchdown);
        let (q_q, rest) = work.touchdown.split_at(nq * nq);
        let (q_qd, q_plus) = rest.split_at(nq * nq);
        let small = &mut work.small;
        small.fill(0.0);
        let size = 2 * nq;
        for i in 0..nq {
            for j in 0..nq {
                small[i * size + j] += q_q[i * nq + j];
                small[i * size + nq + j] += q_qd[i * nq + j];
                small[(nq + j) * size + i] += q_qd[i * nq + j];
            }
            for l in 0..nq {
                let coupling = q_plus[i * nq + l];
                if coupling != 0.0 {
                    for (c, jacobian) in b.touchdown_row(d, l).iter().enumerate() {
                        small[i * size + c] += coupling * jacobian;
                        small[c * size + i] += coupling * jacobian;
                    }
                }
            }
        }
        for c in 0..self.impact.count() {
            let multiplier = mu[first + c];
            if multiplier != 0.0 {
                self.impact.curvature(c, &b.impact, |i, j, second| {
                    let (a, b) = (b.touchdown_row(d, nq + i), b.touchdown_row(d, nq + j));
                    for (r, x) in a.iter().enumerate() {
                        for (s, y) in b.iter().enumerate() {
                            small[r * size + s] -= multiplier * second * x * y;
                        }
                    }
                });
            }
        }
        self.scatter(before, small, hessian);

        // Closure of σ and touchdown at this half step's own end.
        let (closure, touchdown) = (lambda[CLOSURE * k + 1], lambda[CLOSURE * k + 2]);
        self.sigma_curvature(
            p,
            &p.q_end,
            &p.qd_end,
            closure,
            -touchdown / d.leg_length(),
            &work.zeros,
            &mut work.kernel,
            &mut work.small,
        );
        self.scatter(k, &work.small, hessian);
    }

    /// Second derivatives in (q, q̇) of `sigma · σ + height · swing foot's height`.
    #[allow(clippy::too_many_arguments)]
    fn sigma_curvature(
        &self,
        p: &Phase,
        q: &[f64],
        qd: &[f64],
        sigma: f64,
        height: f64,
        zeros: &[f64],
        kernel: &mut [f64],
        small: &mut [f64],
    ) {
        let (d, nq) = (self.description(), q.len());
        let zero = |count: usize| &zeros[..count];
        self.gait.curvature(
            p.leg,
            q,
            qd,
            zero(nq),
            zero(d.joints() + 1),
            zero(d.positions()),
            &[sigma, 0.0, height, 0.0, 0.0, 0.0],
            kernel,
        );
        let blocks = &kernel[3 * nq..];
        let block = |b: usize, i: usize, j: usize| blocks[b * nq * nq + i * nq + j];
        let size = 2 * nq;
        for i in 0..nq {
            for j in 0..nq {
                small[i * size + j] = block(0, i, j);
                small[i * size + nq + j] = block(1, i, j);
                small[(nq + j) * size + i] = block(1, i, j);
                small[(nq + i) * size + nq + j] = block(3, i, j);
            }
        }
    }

    /// Adds a matrix in (q, q̇) at the end of half step `k`.
    fn scatter(&self, k: usize, small: &[f64], hessian: &mut [f64]) {
        let (nq, n) = (self.description().orientations(), self.variables.total());
        let first = k * self.variables.per_phase();
        let place = |i: usize| first + if i < nq { self.variables.q(i) } else { self.variables.qd(i - nq) };
        for (i, row) in small.chunks(2 * nq).enumerate().take(2 * nq) {
            for (j, value) in row.iter().enumerate() {
                hessian[place(i) * n + place(j)] += value;
            }
        }
    }
}

impl PhaseWork {
    /// Multipliers of the collocation equations, from the last element to the first.
    fn adjoint(&mut self, d: &Description, p: &Phase, lambda: &[f64], k: usize) {
        let nodes = p.mesh.nodes.len();
        self.omega.clear();
        self.omega.resize(nodes, [0.0; 2]);
        self.stationarity.clear();
        self.direct.clear();
        for node in 0..nodes {
            let direct = self.direct(d, p, node);
            let (by_beta, by_sigma, _) = p.stance.partials(node);
            self.direct.push(direct);
            self.stationarity.push([direct[0] + direct[1] * by_beta, direct[1] * by_sigma]);
        }
        let last = p.last();
        self.stationarity[last][0] -= lambda[CLOSURE * k];
        self.stationarity[last][1] -= lambda[CLOSURE * k + 1];
        p.stance.adjoint(&p.mesh, p.duration(), &mut self.stationarity, &mut self.omega);
    }

    /// ∂L/∂β and ∂L/∂β̇ through the quantities of a node, β̈ eliminated; and the balance's multiplier.
    fn direct(&self, d: &Description, p: &Phase, node: usize) -> [f64; 3] {
        let (nq, nj, nc) = (d.orientations(), d.joints(), d.positions());
        let y = p.instants.quantities;
        let w = &self.weights[node * y.len()..][..y.len()];
        let jacobian = p.instants.jacobian(d, node);
        let entry = |row: usize, order: usize| jacobian[row * 3 * nq + order * nq + d.unactuated];
        let (mut beta, mut betad, mut betadd) = (0.0, 0.0, 0.0);
        for (row, weight) in w[..nj + nc].iter().enumerate() {
            beta += weight * entry(row, 0);
            betad += weight * entry(row, 1);
            betadd += weight * entry(row, 2);
        }
        let sharing = p.instants.sharing(d, node);
        for (weight, row) in w[y.shared()].iter().zip(sharing.chunks(3 * nq)) {
            beta += weight * row[d.unactuated];
            betad += weight * row[nq + d.unactuated];
            betadd += weight * row[2 * nq + d.unactuated];
        }
        let balance = -betadd / entry(nj + nc, 2);
        beta += balance * entry(nj + nc, 0);
        betad += balance * entry(nj + nc, 1);
        if d.unactuated < nj {
            beta += w[y.angle(d.unactuated)];
            betad += w[y.rate(d.unactuated)];
        }
        let (height, velocity) = self.swing_weights(p, node);
        if velocity != 0.0 {
            let end = usize::from(node == p.last());
            let row = &p.instants.swing_velocity(end)[nc + 2 * nq..][..2 * nq];
            beta += velocity * row[d.unactuated];
            betad += velocity * row[nq + d.unactuated];
        }
        let placement = p.instants.placement(d, node);
        beta += height * placement[2 * nc + nc * nq + nq + d.unactuated];
        beta += self.travel_weight(p, node) * placement[2 * nc + d.unactuated];
        beta += w[y.height()] * placement[2 * nc + nq + d.unactuated];
        [beta, betad, balance]
    }

    /// Weights of the swing foot's height and vertical velocity that the clearance stands for.
    fn swing_weights(&self, p: &Phase, node: usize) -> (f64, f64) {
        let y = p.instants.quantities;
        let w = self.weights[node * y.len() + y.clearance()];
        if node == 0 || node == p.last() {
            (0.0, w * direction(usize::from(node == p.last())) * p.duration())
        } else {
            let s = p.mesh.nodes[node].0;
            (w / (4.0 * s * (1.0 - s)), 0.0)
        }
    }

    /// Weight of the platform's x at a node.
    fn travel_weight(&self, p: &Phase, node: usize) -> f64 {
        if node == 0 {
            -self.travel
        } else if node == p.last() {
            self.travel
        } else {
            0.0
        }
    }

    /// Adds `Uᵀ G U` of one node and the curvature of Q, Q̇, Q̈ in the parameters.
    fn node(&mut self, gait: &dyn Gait, d: &Description, p: &Phase, node: usize, h: &mut [f64]) {
        let (nq, nj, nc) = (d.orientations(), d.joints(), d.positions());
        let (layout, t) = (p.layout, p.duration());
        let (np, m, nt) = (layout.len(), layout.per_joint, layout.prescribed);
        let y = p.instants.quantities;
        let w = &self.weights[node * y.len()..][..y.len()];
        let [_, betad_weight, balance] = self.direct[node];
        let [omega_beta, omega_sigma] = self.omega[node];
        let f1 = p.stance.inertia(node);
        let chi = -(betad_weight + t * omega_beta) / f1;
        let kappa = t * omega_sigma;
        self.n.fill(0.0);
        self.n[..nj].copy_from_slice(&w[..nj]);
        self.n[nj] = balance;
        let (height, velocity) = self.swing_weights(p, node);
        let others = [chi, kappa, height, self.travel_weight(p, node), velocity, w[y.height()]];
        let [q, qd, qdd] = p.instants.state(d, node);
        gait.curvature(p.leg, q, qd, qdd, &self.n, &w[y.force(0)..][..nc], &others, &mut self.out);
        let shared = &w[y.shared()];
        if shared.iter().any(|w| *w != 0.0) {
            gait.sharing_curvature(p.leg, q, qd, qdd, shared, &mut self.shared);
            self.out.iter_mut().zip(&self.shared).for_each(|(out, shared)| *out += shared);
        }
        let (gradient, blocks) = self.out.split_at(3 * nq);
        let (q_q, rest) = blocks.split_at(nq * nq);
        let (q_qd, rest) = rest.split_at(nq * nq);
        let (q_qdd, qd_qd) = rest.split_at(nq * nq);
        // G between all orders of coordinate i and all of coordinate j.
        let g = |i: usize, j: usize| {
            let (ij, ji) = (i * nq + j, j * nq + i);
            Block { q_q: q_q[ij], q_qd: q_qd[ij], qd_q: q_qd[ji], q_qdd: q_qdd[ij], qdd_q: q_qdd[ji], qd_qd: qd_qd[ij] }
        };
        let basis = &p.instants.basis[node * m..][..m];
        let by_t = p.stance.prescribed.by_duration(node);
        let beta = d.unactuated;
        let sensitivity =
            [&p.stance.beta_p, &p.stance.betad_p, &p.instants.betadd_p].map(|table| &table[node * np..][..np]);

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
        // ω T σ̇, and T times the vertical velocity at the ends.
        if node <= p.last() {
            p.stance.moment_gradient(node, t, &mut self.scratch);
            cross_duration(h, &self.scratch, omega_sigma, layout.duration());
        }
        if velocity != 0.0 {
            let weight = w[y.clearance()] / t;
            self.scratch.copy_from_slice(p.instants.gradient(node, y.clearance()));
            self.scratch[layout.duration()] -= p.linearized(node)[y.clearance()] / t;
            cross_duration(h, &self.scratch, weight, layout.duration());
        }

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

    /// T times the integral of the criterion.
    fn bilinear(&mut self, p: &Phase, h: &mut [f64], travel: f64) {
        self.scratch.fill(0.0);
        for (node, quantity, partial) in &p.cost.partials {
            for (s, g) in self.scratch.iter_mut().zip(p.instants.gradient(*node, *quantity)) {
                *s += partial * g;
            }
        }
        cross_duration(h, &self.scratch, 1.0 / travel, p.layout.duration());
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

/// `weight (a bᵀ + b aᵀ)` into W.
fn product(w: &mut [f64], a: &[f64], b: &[f64], weight: f64) {
    for (row, x) in w.chunks_mut(a.len()).zip(a) {
        let x = weight * x;
        if x != 0.0 {
            row.iter_mut().zip(b).for_each(|(slot, b)| *slot += x * b);
        }
    }
}

/// `weight a aᵀ` into W, by its lower triangle.
fn square(w: &mut [f64], a: &[f64], weight: f64) {
    for (i, (row, x)) in w.chunks_mut(a.len()).zip(a).enumerate() {
        let x = weight * x;
        if x != 0.0 {
            row[..i].iter_mut().zip(a).for_each(|(slot, a)| *slot += x * a);
            row[i] += 0.5 * x * a[i];
        }
    }
}

/// `weight (e_T aᵀ + a e_Tᵀ)` into W.
fn cross_duration(w: &mut [f64], a: &[f64], weight: f64, duration: usize) {
    w[duration * a.len()..].iter_mut().zip(a).for_each(|(slot, a)| *slot += weight * a);
}

/// `w + wᵀ` in the place of w.
fn add_transpose(w: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..=i {
            let sum = w[i * n + j] + w[j * n + i];
            w[i * n + j] = sum;
            w[j * n + i] = sum;
        }
    }
}

/// `out += mapᵀ h map`, with `map` of shape rows × n and `half` for `h map`.
fn congruence(h: &[f64], map: &[f64], n: usize, half: &mut [f64], out: &mut [f64]) {
    let rows = map.len() / n;
    for (target, row) in half.chunks_mut(n).zip(h.chunks(rows)) {
        target.fill(0.0);
        for (value, source) in row.iter().zip(map.chunks(n)) {
            if *value != 0.0 {
                target.iter_mut().zip(source).for_each(|(t, s)| *t += value * s);
            }
        }
    }
    for (source, target) in map.chunks(n).zip(half.chunks(n)) {
        for (i, s) in source.iter().enumerate() {
            if *s != 0.0 {
                out[i * n..(i + 1) * n].iter_mut().zip(target).for_each(|(o, t)| *o += s * t);
            }
        }
    }
}

impl Stance {
    /// Backward sweep: `stationarity` holds ∂L/∂(β, σ) per node at fixed rates; on return `omega`, zero before, holds the
    /// weights of T β̇ and T σ̇.
    fn adjoint(&self, mesh: &crate::stance::Mesh, t: f64, stationarity: &mut [[f64; 2]], omega: &mut [[f64; 2]]) {
        const M: usize = NODES - 1;
        let a = &mesh.lobatto.integral;
        let share = 1.0 / mesh.elements as f64;
        for e in (0..mesh.elements).rev() {
            let first = e * M;
            // Right side: −∂L/∂(β, σ) of the element's own nodes, with what ω already weighs.
            let mut right = [[0.0; 2]; M];
            for j in 1..NODES {
                let node = first + j;
                let (by_beta, by_sigma, moment) = self.partials(node);
                let [wb, ws] = omega[node];
                right[j - 1] = [
                    -(stationarity[node][0] + t * (wb * by_beta + ws * moment)),
                    -(stationarity[node][1] + t * wb * by_sigma),
                ];
            }
            let eta = self.system(mesh, e, t).solve_transposed(&right);
            let mut sums = [0.0; 2];
            for i in 1..NODES {
                for j in 0..NODES {
                    omega[first + j][0] -= share * a[i][j] * eta[i - 1][0];
                    omega[first + j][1] -= share * a[i][j] * eta[i - 1][1];
                }
                sums[0] += eta[i - 1][0];
                sums[1] += eta[i - 1][1];
            }
            stationarity[first][0] -= sums[0];
            stationarity[first][1] -= sums[1];
        }
    }
}
