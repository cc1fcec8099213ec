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
//!
//! In the order of the computation: `weights`, `adjoint`, `instants`, `ends`; `products` of vectors and matrices.

mod adjoint;
mod ends;
mod instants;
mod products;
mod weights;

use super::phase::Phase;
use super::{Cycle, Variables};
use piaffe_model::Description;
use products::{add_transpose, congruence};

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
    others: Vec<f64>,
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
    /// Gradient and second derivatives in q of the weighted heights.
    heights: Vec<f64>,
    /// Those in (q, q̇, q̈) of what real legs share.
    shared: Vec<f64>,
    n: Vec<f64>,
    others: Vec<f64>,
    /// One vector of local parameters per unactuated column of G.
    v: [Vec<f64>; 3],
    /// A block of G times each parameter's part in (Q, Q̇, Q̈).
    images: Vec<[f64; 3]>,
    scratch: Vec<f64>,
}

impl Workspace {
    pub fn new(d: &Description, variables: &Variables, phase: &Phase) -> Workspace {
        let (nq, n, np, shapes) = (d.orientations(), variables.total(), phase.layout.len(), d.shapes);
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
                out: shapes.curvature.zeros(),
                heights: shapes.heights_curvature.zeros(),
                shared: shapes.sharing_curvature.zeros(),
                n: shapes.curvature.n.zeros(),
                others: shapes.curvature.others.zeros(),
                v: [z(np), z(np), z(np)],
                images: vec![[0.0; 3]; phase.layout.per_joint],
                scratch: z(np),
            },
            reach: z(np),
            h_local: z(np * np),
            half: z(np * n),
            touchdown: shapes.touchdown_curvature.zeros(),
            small: z(4 * nq * nq),
            xi: z(nq),
            outputs: shapes.touchdown_curvature.outputs.zeros(),
            others: shapes.curvature.others.zeros(),
            kernel: shapes.curvature.zeros(),
            rows: z(2 * nq * n),
            zeros: z(nq.max(shapes.curvature.n.len).max(shapes.inverse_jacobian.f.len())),
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
            work.phase.adjoint(self.description(), &self.units, p, lambda, k);
            work.h_local.fill(0.0);
            self.instant_terms(k, mu, &mut work);
            work.phase.bilinear(p, &mut work.h_local, self.per_work());
            add_transpose(&mut work.h_local, p.layout.len());
            // Θ through the parameters: first order twice, then second order once.
            congruence(&work.h_local, &p.by_theta, n, &mut work.half, hessian);
            self.start_terms(k, lambda, mu, &mut work, hessian);
        }
        // The objective is a quotient of work and duration: its own curvature.
        for i in 0..n {
            for j in 0..n {
                let product = self.cost_gradient[i] * self.duration_gradient[j]
                    + self.duration_gradient[i] * self.cost_gradient[j];
                hessian[i * n + j] -= product / self.duration;
            }
        }
        self.workspace = work;
    }
}
