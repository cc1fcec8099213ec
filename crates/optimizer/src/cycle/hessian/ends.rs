//! Curvature at both ends of a phase: its initial state as a function of Θ through the transition before it (kernels
//! `touchdown_curvature`, `landing_curvature`), σ(q, q̇) (eq. 8), the parabola that a take-off begins, and what is imposed at its end.

use super::EndWork;
use super::products::congruence;
use crate::cycle::Cycle;
use crate::cycle::phase::Phase;
use piaffe_model::{FORWARD, Transition, UP};

/// What is weighed in a state (q, q̇): σ, and the height of a foot in the air.
struct Weights {
    sigma: f64,
    foot: usize,
    height: f64,
}

impl Cycle<'_> {
    /// Curvature of the initial state of phase `k` as a function of Θ, and of what is imposed at its end; `gradient` is that of the
    /// phase's part of L in the local parameters.
    pub(super) fn start_terms(
        &self,
        k: usize,
        gradient: &[f64],
        lambda: &[f64],
        mu: &[f64],
        work: &mut EndWork,
        hessian: &mut [f64],
    ) {
        let d = self.description();
        let (n, layout) = (self.variables.total(), self.phases[k].layout);
        let p = &self.phases[k];
        let sigma = gradient[layout.sigma()];

        // σ(q, q̇) at the start.
        self.state_curvature(p, &p.q_start, &p.qd_start, &Weights { sigma, foot: 0, height: 0.0 }, work);
        let size = 2 * d.orientations();
        congruence(&work.small[..size * size], &p.start_by_theta, n, &mut work.rows, hessian);

        let before = self.before(k);
        match self.phases[before].crossing.transition {
            Transition::TakeOff(_) => {
                let velocity = [FORWARD, UP].map(|c| gradient[layout.centre_velocity(c)]);
                self.takeoff_terms(before, gradient[layout.centre_height()], velocity, work, hessian);
            }
            _ => self.impact_terms(k, gradient, mu, work, hessian),
        }

        // Closure of σ and touchdown at this phase's own end.
        let [_, closure] = self.closures(k, lambda);
        let touchdown = self.rows.of(k).touchdown.map_or(0.0, |row| lambda[row] / self.units.length);
        let weights = Weights {
            sigma: closure / self.units.angular_momentum(),
            foot: p.landing_foot.unwrap_or_default(),
            height: -touchdown,
        };
        self.state_curvature(p, &p.q_end, &p.qd_end, &weights, work);
        self.scatter(k, &work.small[..size * size], hessian);
    }

    /// The impact that leads to phase `k`, at the end of the phase before: q̇⁺ and what else it gives.
    fn impact_terms(&self, k: usize, gradient: &[f64], mu: &[f64], work: &mut EndWork, hessian: &mut [f64]) {
        let d = self.description();
        let (nq, n) = (d.orientations(), self.variables.total());
        let (p, before) = (&self.phases[k], self.before(k));
        let b = &self.phases[before];
        let layout = p.layout;
        let sigma = gradient[layout.sigma()];
        work.xi.fill(0.0);
        let (_, by_qd) = p.shapes.momentum.sigma_w.of(&p.momentum_start).split_at(nq);
        for row in 0..nq {
            let (from, sign) = d.renamed(before, row);
            let mut weight = sigma * by_qd[row];
            if row != d.unactuated {
                let j = if row < d.unactuated { row } else { row - 1 };
                weight += gradient[layout.joint(j, 1)];
            }
            work.xi[from] += sign * weight;
        }
        let outputs = &mut work.outputs[..b.crossing.outputs.len()];
        outputs.fill(0.0);
        self.weighted_impacts(before, mu, |impact, row, multiplier| {
            impact.partials(row, &b.crossing.outputs, |i, partial| outputs[i] -= multiplier * partial);
        });

        // In w = (q, q̇⁻) or (q, v⁻, q̇⁻).
        let size = 2 * nq + b.crossing.components();
        let small = &mut work.small[..size * size];
        small.fill(0.0);
        let [q_q, q_w, q_plus] =
            b.crossing.curvature(self.gait, &b.q_end, &b.qd_end, &work.xi, outputs, &mut work.kernel);
        let others = size - nq;
        for i in 0..nq {
            for j in 0..nq {
                small[i * size + j] += q_q[i * nq + j];
            }
            for j in 0..others {
                small[i * size + nq + j] += q_w[i * others + j];
                small[(nq + j) * size + i] += q_w[i * others + j];
            }
            for l in 0..nq {
                let coupling = q_plus[i * nq + l];
                if coupling != 0.0 {
                    for (c, jacobian) in b.crossing.qd_plus_row(l).iter().enumerate() {
                        small[i * size + c] += coupling * jacobian;
                        small[c * size + i] += coupling * jacobian;
                    }
                }
            }
        }
        self.weighted_impacts(before, mu, |impact, row, multiplier| {
            impact.curvature(row, &b.crossing.outputs, |i, j, second| {
                let (a, b) = (b.crossing.output_row(i), b.crossing.output_row(j));
                for (r, x) in a.iter().enumerate() {
                    for (s, y) in b.iter().enumerate() {
                        small[r * size + s] -= multiplier * second * x * y;
                    }
                }
            });
        });
        if let Transition::Landing(_) = b.crossing.transition {
            b.crossing.add_matrix(small, self.end_state(before), &mut work.rows[..n], hessian);
            // The mass centre's velocity before it is a function of the take-off.
            let velocity = b.crossing.by_centre(&work.xi, outputs);
            self.takeoff_terms(self.before(before), 0.0, velocity, work, hessian);
        } else {
            self.scatter(before, small, hessian);
        }
    }

    /// Curvature of height and velocity of the mass centre at the take-off that ends phase `k`, weighted.
    fn takeoff_terms(&self, k: usize, height: f64, velocity: [f64; 2], work: &mut EndWork, hessian: &mut [f64]) {
        let (p, shape) = (&self.phases[k], &self.description().shapes.takeoff_curvature);
        let Transition::TakeOff(leg) = p.crossing.transition else { return };
        work.of_takeoff.fill(0.0);
        work.of_takeoff[shape.weights.r.place(UP)] = height;
        [FORWARD, UP].iter().for_each(|c| work.of_takeoff[shape.weights.v.place(*c)] = velocity[*c]);
        let still = &work.zeros[..p.q_end.len()];
        self.gait.takeoff_curvature(leg, &p.q_end, &p.qd_end, still, &work.of_takeoff, &mut work.kernel);
        let size = 2 * p.q_end.len();
        let blocks = [shape.q_q, shape.q_qd, shape.qd_qd].map(|block| block.of(&work.kernel));
        in_state(blocks, &mut work.small[..size * size]);
        self.scatter(k, &work.small[..size * size], hessian);
    }

    /// Adds a matrix in (q, q̇) at the end of phase `k`.
    fn scatter(&self, k: usize, matrix: &[f64], hessian: &mut [f64]) {
        let (place, n) = (self.end_state(k), self.variables.total());
        let size = matrix.len().isqrt();
        for (i, row) in matrix.chunks(size).enumerate() {
            for (j, value) in row.iter().enumerate() {
                hessian[place(i) * n + place(j)] += value;
            }
        }
    }

    /// Second derivatives in (q, q̇) of what is weighed there.
    fn state_curvature(&self, p: &Phase, q: &[f64], qd: &[f64], weights: &Weights, work: &mut EndWork) {
        let (nq, shape) = (q.len(), &p.shapes.curvature);
        let zero = |count: usize| &work.zeros[..count];
        let others = &mut work.others[..shape.others.len];
        others.fill(0.0);
        others[shape.others.sigma.place(0)] = weights.sigma;
        others[shape.others.swing_height.place(weights.foot)] = weights.height;
        let phi = zero(p.shapes.inverse_jacobian.f.len());
        self.gait.curvature(p.mode, q, qd, zero(nq), zero(shape.n.len), phi, others, &mut work.kernel);
        let blocks = [shape.q_q, shape.q_qd, shape.qd_qd].map(|block| block.of(&work.kernel));
        in_state(blocks, &mut work.small[..4 * nq * nq]);
    }
}

/// Blocks of second derivatives as one matrix in (q, q̇).
fn in_state([q_q, q_qd, qd_qd]: [&[f64]; 3], matrix: &mut [f64]) {
    let nq = q_q.len().isqrt();
    let size = 2 * nq;
    for i in 0..nq {
        for j in 0..nq {
            matrix[i * size + j] = q_q[i * nq + j];
            matrix[i * size + nq + j] = q_qd[i * nq + j];
            matrix[(nq + j) * size + i] = q_qd[i * nq + j];
            matrix[(nq + i) * size + nq + j] = qd_qd[i * nq + j];
        }
    }
}
