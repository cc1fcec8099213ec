//! What is not prescribed, over a phase: (β, σ), integrated with sensitivities (eq. 8–10, 20–24), and in flight the mass centre's
//! parabola.
//!
//! With Q(t) known, `β̇ = (σ − f2)/f1` and `σ̇ = moment of gravity`, which is zero in flight. On s = t/T the interval is cut
//! into equal elements with five Lobatto nodes each (order 8). The nodes are also where torques and
//! reactions are evaluated, and their quadrature is that of the criteria. Sensitivities in all
//! parameters are those of the discrete equations: exact to rounding.
//!
//! Parameters of a phase ("local"): per prescribed coordinate the basis parameters of its polynomial (rates not multiplied by
//! T), then T, β(0), σ(0); in flight where the mass centre starts, and how fast; and the durations of other phases, where a foot's
//! swing lasts longer than this one.

mod fall;
mod layout;
mod mesh;
mod prescribed;
mod system;

pub use fall::Fall;
pub use layout::Layout;
pub use mesh::Mesh;
pub use prescribed::{Prescribed, basis_derivatives};
pub use system::System;

use crate::lgl::NODES;
use piaffe_model::shape::LateGradient;
use piaffe_model::units::Units;
use piaffe_model::{Description, Gait, Mode};

/// A motion that the equations do not admit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Undefined {
    #[error(
        "the inertia about the stance foot or, in flight, the mass centre vanishes (f1 → 0): the unactuated coordinate cannot be driven in this posture"
    )]
    NoInertia,
    #[error("the unactuated coordinate runs away: no motion with these joint trajectories")]
    Diverged,
    #[error("a value is not finite")]
    NotFinite,
}

/// The solution of one phase. Matrices are row-major, one row of local parameters per collocation node.
#[derive(Clone, Debug)]
pub struct Flow {
    pub beta: Vec<f64>,
    pub sigma: Vec<f64>,
    pub betad: Vec<f64>,
    pub sigmad: Vec<f64>,
    /// ∂β/∂parameters, ∂σ/∂parameters at every node.
    pub beta_p: Vec<f64>,
    pub sigma_p: Vec<f64>,
    /// ∂β̇/∂parameters.
    pub betad_p: Vec<f64>,
    /// Derivatives of T·β̇ and T·σ̇: what is integrated over s.
    rate_p: Vec<f64>,
    moment_p: Vec<f64>,
    /// Per node: f1, f2, σ̇ and their β-derivatives.
    late: Vec<[f64; 6]>,
    early: Vec<f64>,
    gradient: Vec<f64>,
    shape: LateGradient,
    pub prescribed: Prescribed,
    early_length: usize,
    layout: Layout,
    units: Units,
}

const NEWTON_STEPS: usize = 25;
/// Newton's method has converged where rounding is left after one more step, and diverged here; in rad and in the robot's unit
/// of angular momentum.
const CONVERGED: f64 = 1e-9;
const DIVERGED: f64 = 1e6;

/// f1 counts as zero below this share of what it is in the beginning, and of the robot's unit of inertia.
const VANISHING: [f64; 2] = [1e-3, 1e-6];
/// No motion turns so far, rad.
const FARTHEST: f64 = 20.0;

impl Flow {
    /// For phase `k` of the gait.
    pub fn new(description: &Description, mesh: &Mesh, k: usize) -> Flow {
        let layout = Layout::new(description, k, &mesh.basis);
        let shapes = description.shape(description.phases[k].mode);
        let n = mesh.nodes.len();
        let table = || vec![0.0; mesh.nodes.len() * layout.len()];
        let early_length = shapes.early.len;
        Flow {
            beta: vec![0.0; n],
            sigma: vec![0.0; n],
            betad: vec![0.0; n],
            sigmad: vec![0.0; n],
            beta_p: table(),
            sigma_p: table(),
            betad_p: table(),
            rate_p: table(),
            moment_p: table(),
            late: vec![[0.0; 6]; n],
            early: vec![0.0; n * early_length],
            gradient: shapes.late_gradient.zeros(),
            shape: shapes.late_gradient,
            prescribed: Prescribed::new(layout.prescribed, n),
            early_length,
            layout,
            units: Units::new(description),
        }
    }

    /// Integrates (β, σ) from their initial values.
    ///
    /// # Errors
    /// If f1 comes near zero or changes sign, or the collocation equations have no solution.
    pub fn integrate(&mut self, gait: &dyn Gait, mode: Mode, mesh: &Mesh, parameters: &[f64]) -> Result<(), Undefined> {
        let t = parameters[self.layout.duration()];
        self.prescribed.evaluate(&self.layout, mesh, parameters);
        for (k, early) in self.early.chunks_mut(self.early_length).enumerate() {
            let [q, qd, _] = self.prescribed.at(k);
            gait.early(mode, q, qd, early);
        }
        self.beta[0] = parameters[self.layout.beta()];
        self.sigma[0] = parameters[self.layout.sigma()];
        self.rates(gait, mode, 0)?;
        for e in 0..mesh.elements {
            self.element(gait, mode, mesh, e, t / mesh.elements as f64)?;
        }
        Ok(())
    }

    /// β̇, σ̇ at node `k` from β, σ.
    fn rates(&mut self, gait: &dyn Gait, mode: Mode, k: usize) -> Result<(), Undefined> {
        let early = &self.early[k * self.early_length..][..self.early_length];
        gait.late(mode, early, self.beta[k], &mut self.late[k]);
        [self.betad[k], self.sigmad[k]] = self.rates_of(&self.late[k], self.beta[k], self.sigma[k])?;
        Ok(())
    }

    /// β̇ and σ̇ (eq. 8, 9), where f1 is not nearly zero beside what it is in the beginning.
    fn rates_of(&self, [f1, f2, moment, ..]: &[f64; 6], beta: f64, sigma: f64) -> Result<[f64; 2], Undefined> {
        let reference = self.late[0][0];
        let least = (VANISHING[0] * reference.abs()).max(VANISHING[1] * self.units.inertia());
        // Negative, too, if its sign is not that of the beginning.
        if f1 * reference.signum() < least {
            return Err(Undefined::NoInertia);
        }
        let betad = (sigma - f2) / f1;
        if !(betad.is_finite() && moment.is_finite()) {
            return Err(Undefined::NotFinite);
        }
        if beta.abs() > FARTHEST {
            return Err(Undefined::Diverged);
        }
        Ok([betad, *moment])
    }

    /// ∂β̇/∂β, ∂β̇/∂σ and ∂σ̇/∂β at node `k`.
    pub fn partials(&self, k: usize) -> (f64, f64, f64) {
        let [f1, _, _, f1_b, f2_b, moment_b] = self.late[k];
        (-(f2_b + self.betad[k] * f1_b) / f1, 1.0 / f1, moment_b)
    }

    /// f1 at node `k`, kg·m².
    pub fn inertia(&self, k: usize) -> f64 {
        self.late[k][0]
    }

    /// ∂σ̇/∂parameters at node `k`.
    pub fn moment_gradient(&self, k: usize, t: f64, out: &mut [f64]) {
        let np = self.layout.len();
        for (o, m) in out.iter_mut().zip(&self.moment_p[k * np..]) {
            *o = m / t;
        }
        out[self.layout.duration()] -= self.sigmad[k] / t;
    }

    /// The linearized collocation equations of element `e`.
    pub fn system(&self, mesh: &Mesh, e: usize, t: f64) -> System {
        let first = e * (NODES - 1);
        System::new(&mesh.lobatto.integral, t / mesh.elements as f64, |j| self.partials(first + j))
    }

    /// Solves the collocation equations of element `e` of length `h` (in time) by Newton's method.
    fn element(&mut self, gait: &dyn Gait, mode: Mode, mesh: &Mesh, e: usize, h: f64) -> Result<(), Undefined> {
        const M: usize = NODES - 1;
        let a = &mesh.lobatto.integral;
        let first = e * M;
        let momentum = self.units.angular_momentum();
        let (b0, s0, bd0, sd0) = (self.beta[first], self.sigma[first], self.betad[first], self.sigmad[first]);
        for i in 1..NODES {
            let dt = h * mesh.lobatto.nodes[i];
            self.beta[first + i] = b0 + dt * bd0;
            self.sigma[first + i] = s0 + dt * sd0;
        }
        let mut converged = false;
        for _ in 0..NEWTON_STEPS {
            for i in 1..NODES {
                self.rates(gait, mode, first + i)?;
            }
            let mut residual = [[0.0; 2]; M];
            let mut largest = 0.0f64;
            for i in 1..NODES {
                let (mut beta, mut sigma) = (b0, s0);
                for j in 0..NODES {
                    beta += h * a[i][j] * self.betad[first + j];
                    sigma += h * a[i][j] * self.sigmad[first + j];
                }
                let [by_beta, by_sigma] = [beta - self.beta[first + i], sigma - self.sigma[first + i]];
                residual[i - 1] = [by_beta, by_sigma];
                largest = largest.max(by_beta.abs()).max(by_sigma.abs() / momentum);
            }
            if !largest.is_finite() || largest > DIVERGED {
                return Err(Undefined::Diverged);
            }
            let system = System::new(a, h, |j| self.partials(first + j));
            let (db, ds) = system.solve(&residual);
            for i in 1..NODES {
                self.beta[first + i] += db[i - 1];
                self.sigma[first + i] += ds[i - 1];
            }
            if converged {
                break;
            }
            // One more step after this: quadratic convergence then leaves rounding only.
            converged = largest < CONVERGED;
        }
        if !converged {
            return Err(Undefined::Diverged);
        }
        for i in 1..NODES {
            self.rates(gait, mode, first + i)?;
        }
        Ok(())
    }

    /// Sensitivities of the solution in all local parameters, at the collocation nodes.
    pub fn differentiate(&mut self, gait: &dyn Gait, mode: Mode, mesh: &Mesh, parameters: &[f64]) {
        let layout = self.layout;
        let np = layout.len();
        let t = parameters[layout.duration()];
        self.beta_p[..np].fill(0.0);
        self.sigma_p[..np].fill(0.0);
        self.beta_p[layout.beta()] = 1.0;
        self.sigma_p[layout.sigma()] = 1.0;
        for k in 0..mesh.nodes.len() {
            self.explicit(gait, mode, mesh, k, t);
        }
        self.complete(0, t);
        for e in 0..mesh.elements {
            self.element_sensitivities(mesh, e, t);
        }
    }

    /// Fills the rows of node `k` with ∂(T β̇), ∂(T σ̇) at fixed (β, σ).
    fn explicit(&mut self, gait: &dyn Gait, mode: Mode, mesh: &Mesh, k: usize, t: f64) {
        let layout = self.layout;
        let LateGradient { f1_q, f2_q, f2_qd, moment_q, .. } = self.shape;
        let jet = &mesh.nodes[k].1;
        let early = &self.early[k * self.early_length..][..self.early_length];
        gait.late_gradient(mode, early, self.beta[k], &mut self.gradient);
        let f1 = self.late[k][0];
        let row = k * layout.len();
        let (rate, moment) = (&mut self.rate_p[row..row + layout.len()], &mut self.moment_p[row..row + layout.len()]);
        rate.fill(0.0);
        moment.fill(0.0);
        let (mut rate_t, mut moment_t) = (self.betad[k], self.sigmad[k]);
        for (j, [q_t, qd_t, _]) in self.prescribed.by_duration(k).iter().enumerate() {
            let [f1_q, f2_q, f2_qd, moment_q] =
                [f1_q, f2_q, f2_qd, moment_q].map(|block| self.gradient[block.place(j)]);
            let by_q = -(f2_q + self.betad[k] * f1_q) / f1;
            let by_qd = -f2_qd / f1;
            for i in 0..layout.per_joint {
                let [q, qd, _] = basis_derivatives(&mesh.basis, jet, t, i);
                rate[layout.joint(j, i)] = t * (by_q * q + by_qd * qd);
                moment[layout.joint(j, i)] = t * moment_q * q;
            }
            rate_t += t * (by_q * q_t + by_qd * qd_t);
            moment_t += t * moment_q * q_t;
        }
        rate[layout.duration()] = rate_t;
        moment[layout.duration()] = moment_t;
    }

    /// Adds what changes through (β, σ) at node `k`, whose sensitivities are known.
    fn complete(&mut self, k: usize, t: f64) {
        let np = self.layout.len();
        let (g_b, g_s, m_b) = self.partials(k);
        for p in k * np..(k + 1) * np {
            self.rate_p[p] += t * (g_b * self.beta_p[p] + g_s * self.sigma_p[p]);
            self.moment_p[p] += t * m_b * self.beta_p[p];
            self.betad_p[p] = self.rate_p[p] / t;
        }
        self.betad_p[k * np + self.layout.duration()] -= self.betad[k] / t;
    }

    fn element_sensitivities(&mut self, mesh: &Mesh, e: usize, t: f64) {
        const M: usize = NODES - 1;
        let a = &mesh.lobatto.integral;
        let np = self.layout.len();
        let share = 1.0 / mesh.elements as f64;
        let first = e * M;
        let system = self.system(mesh, e, t);
        for p in 0..np {
            let at = |node: usize| node * np + p;
            let mut right = [[0.0; 2]; M];
            for i in 1..NODES {
                let (mut beta, mut sigma) = (self.beta_p[at(first)], self.sigma_p[at(first)]);
                for j in 0..NODES {
                    // The first node's rows are complete; the others hold the explicit part.
                    beta += share * a[i][j] * self.rate_p[at(first + j)];
                    sigma += share * a[i][j] * self.moment_p[at(first + j)];
                }
                right[i - 1] = [beta, sigma];
            }
            let (beta, sigma) = system.solve(&right);
            for i in 1..NODES {
                self.beta_p[at(first + i)] = beta[i - 1];
                self.sigma_p[at(first + i)] = sigma[i - 1];
            }
        }
        for i in 1..NODES {
            self.complete(first + i, t);
        }
    }

    /// The state at any `s` of an integrated phase, by the collocation polynomial.
    ///
    /// # Errors
    /// As for [`Flow::integrate`].
    pub fn at(
        &self,
        gait: &dyn Gait,
        mode: Mode,
        mesh: &Mesh,
        parameters: &[f64],
        s: f64,
        state: &mut State,
    ) -> Result<(), Undefined> {
        let (d, layout) = (gait.description(), self.layout);
        let jet = mesh.basis.jet(s);
        for k in 0..layout.prescribed {
            ([state.prescribed[0][k], state.prescribed[1][k], state.prescribed[2][k]], _) =
                layout.coordinate(k, &jet, parameters);
            let index = d.prescribed_index(k);
            (state.q[index], state.qd[index]) = (state.prescribed[0][k], state.prescribed[1][k]);
        }
        let e = mesh.element(s);
        let (first, share) = (e * (NODES - 1), parameters[layout.duration()] / mesh.elements as f64);
        let (mut beta, mut sigma) = (self.beta[first], self.sigma[first]);
        for (j, w) in mesh.lobatto.integrals(s * mesh.elements as f64 - e as f64).iter().enumerate() {
            beta += share * w * self.betad[first + j];
            sigma += share * w * self.sigmad[first + j];
        }
        let mut late = [0.0; 6];
        gait.early(mode, &state.prescribed[0], &state.prescribed[1], &mut state.early);
        gait.late(mode, &state.early, beta, &mut late);
        let [betad, _] = self.rates_of(&late, beta, sigma)?;
        (state.q[d.unactuated], state.qd[d.unactuated], state.sigma) = (beta, betad, sigma);
        Ok(())
    }
}

/// The state at one instant, and room to find it.
#[derive(Clone, Debug)]
pub struct State {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    /// Q, Q̇ and Q̈.
    pub prescribed: [Vec<f64>; 3],
    pub sigma: f64,
    early: Vec<f64>,
}

impl State {
    pub fn new(d: &Description, mode: Mode) -> State {
        let (q, own) = (vec![0.0; d.orientations()], vec![0.0; d.prescribed()]);
        State {
            qd: q.clone(),
            q,
            prescribed: [own.clone(), own.clone(), own],
            sigma: 0.0,
            early: d.shape(mode).early.zeros(),
        }
    }
}
