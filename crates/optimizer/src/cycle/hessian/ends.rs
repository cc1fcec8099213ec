//! Curvature at both ends of a half step: its initial state as a function of Θ through the impact before it (kernel
//! `touchdown_curvature`), σ(q, q̇) (eq. 8), and what is imposed at its end.

use super::Workspace;
use super::products::congruence;
use crate::constraints::sharing::pitches;
use crate::cycle::phase::Phase;
use crate::cycle::problem::{CLOSURE, pitch};
use crate::cycle::{Cycle, renamed};

impl Cycle<'_> {
    /// Curvature of the initial state as a function of Θ, and of what is imposed at the end.
    pub(super) fn start_terms(&self, k: usize, lambda: &[f64], mu: &[f64], work: &mut Workspace, hessian: &mut [f64]) {
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
            &mut work.others,
            &mut work.kernel,
            &mut work.small,
        );
        congruence(&work.small, &p.start_by_theta, n, &mut work.rows, hessian);

        // The touchdown that leads here, at the end of the half step before.
        let before = self.before(k);
        let b = &self.phases[before];
        work.xi.fill(0.0);
        let (_, by_qd) = p.shapes.momentum.sigma_w.of(&p.momentum_start).split_at(nq);
        for row in 0..nq {
            let (from, sign) = renamed(d, row);
            let mut weight = sigma_weight * by_qd[row];
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
        if pitches(d) {
            work.outputs[pitch(d)] -= lambda[self.speed_equation() + 1 + before] / self.units.angular_momentum();
        }
        self.gait.touchdown_curvature(1 - b.leg, &b.q_end, &b.qd_end, &work.xi, &work.outputs, &mut work.touchdown);
        let shape = &p.shapes.touchdown_curvature;
        let [q_q, q_qd, q_plus] = [shape.q_q, shape.q_qd, shape.q_plus].map(|block| block.of(&work.touchdown));
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
                    for (c, jacobian) in b.qd_plus_row(l).iter().enumerate() {
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
                    let (a, b) = (b.impact_row(i), b.impact_row(j));
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
        let units = &self.units;
        let (closure, touchdown) =
            (lambda[CLOSURE * k + 1] / units.angular_momentum(), lambda[CLOSURE * k + 2] / units.length);
        self.sigma_curvature(
            p,
            &p.q_end,
            &p.qd_end,
            closure,
            -touchdown,
            &work.zeros,
            &mut work.others,
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
        others: &mut [f64],
        kernel: &mut [f64],
        small: &mut [f64],
    ) {
        let (nq, shape) = (q.len(), &p.shapes.curvature);
        let zero = |count: usize| &zeros[..count];
        others.fill(0.0);
        others[shape.others.sigma.place(0)] = sigma;
        others[shape.others.swing_height.place(0)] = height;
        self.gait.curvature(
            p.leg,
            q,
            qd,
            zero(nq),
            zero(shape.n.len),
            zero(p.shapes.inverse_jacobian.f.len()),
            others,
            kernel,
        );
        let size = 2 * nq;
        for i in 0..nq {
            for j in 0..nq {
                small[i * size + j] = kernel[shape.q_q.index(i, j)];
                small[i * size + nq + j] = kernel[shape.q_qd.index(i, j)];
                small[(nq + j) * size + i] = kernel[shape.q_qd.index(i, j)];
                small[(nq + i) * size + nq + j] = kernel[shape.qd_qd.index(i, j)];
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
