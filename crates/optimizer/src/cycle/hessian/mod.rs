//! The exact Hessian of the Lagrangian `L = cost − λᵀc_E − μᵀc_I` in Θ.
//!
//! Per phase, L is a sum over instants of the quantities there, and (β, σ) at the instants are
//! implicit in the parameters. The *adjoint* of the collocation equations gives their multipliers ω;
//! with them, and with χ for σ = σ(q, q̇) (eq. 8) and one for the balance of eq. 10, all implicit
//! second-order terms vanish, and what is left is `Uᵀ G U` per instant: G is the generated second
//! derivative of one weighted sum (kernel `curvature`), U the known sensitivities of (q, q̇, q̈).
//! Explicit curvature remains where parameters enter bilinearly: T with the polynomial's values, and
//! the initial velocities and σ as functions of Θ through the impact (kernel `touchdown_curvature`).
//!
//! Terms are summed into a matrix W with Hessian W + Wᵀ: a product of two gradients
//! then is written once instead of twice.
//!
//! In the order of the computation: `weights`, `adjoint`, `instants` and each `node`, `ends`; `products` of vectors and matrices.

mod adjoint;
mod ends;
mod instants;
mod node;
mod products;
mod weights;

use super::phase::Phase;
use super::{Cycle, Variables};
use piaffe_model::Description;
use piaffe_model::shape::ModeShapes;
use products::{add_transpose, cross_duration};

/// Memory of the computation, allocated once.
#[derive(Default)]
pub struct Workspace {
    /// A row of local parameters, of the phase that has most.
    pub local: Vec<f64>,
    /// A row of a state for each node, of the phase that has most.
    pub states: Vec<f64>,
    phases: Vec<PhaseWork>,
    /// Half the projection of a phase's Hessian.
    half: Vec<f64>,
    ends: EndWork,
}

/// Multipliers and second-order terms of one phase.
struct PhaseWork {
    /// Weights of all quantities, a row per node: ∂L/∂quantity at fixed Θ.
    weights: Vec<f64>,
    /// The same for the states' entries, a row per node.
    states: Vec<f64>,
    /// W in the state of each node.
    seconds: Vec<f64>,
    /// One vector of local parameters per unactuated row of G.
    v: [Vec<f64>; 3],
    /// A block of G times each parameter's part in (Q, Q̇, Q̈).
    images: Vec<[f64; 3]>,
    /// Gradient of this phase's part of L in the local parameters.
    gradient: Vec<f64>,
    /// Weight of the platform's x at the end, minus that at the start.
    travel: f64,
    /// Weight of the mass centre's height at the end of a flight.
    landing: f64,
    /// Adjoint weights of T β̇ and T σ̇ at every node.
    omega: Vec<[f64; 2]>,
    /// ∂L/∂(β, σ) at fixed parameters, per node.
    stationarity: Vec<[f64; 2]>,
    /// Per node ∂L/∂(β, β̇) through the quantities, and the multiplier of the balance.
    direct: Vec<[f64; 3]>,
    out: Vec<f64>,
    /// Gradient and second derivatives in q of the weighted heights.
    heights: Vec<f64>,
    /// Those in (q, q̇, q̈) of what real legs share, and of the foot that leaves.
    shared: Vec<f64>,
    takeoff: Vec<f64>,
    n: Vec<f64>,
    others: Vec<f64>,
    of_takeoff: Vec<f64>,
    scratch: Vec<f64>,
    local: Vec<f64>,
    /// W, later the Hessian, in the local parameters.
    h: Vec<f64>,
}

impl PhaseWork {
    fn new(d: &Description, phase: &Phase) -> PhaseWork {
        let (np, shapes, nodes) = (phase.layout.len(), phase.shapes, phase.mesh.nodes.len());
        let width = phase.instants.width();
        let z = |count: usize| vec![0.0; count];
        let leaves = phase.instants.leaving_at_rest().is_some();
        PhaseWork {
            weights: z(phase.linearized.len()),
            states: z(nodes * width),
            seconds: z(nodes * width * width),
            v: [z(np), z(np), z(np)],
            images: vec![[0.0; 3]; phase.layout.per_joint],
            gradient: z(np),
            travel: 0.0,
            landing: 0.0,
            omega: Vec::with_capacity(nodes),
            stationarity: Vec::with_capacity(nodes),
            direct: Vec::with_capacity(nodes),
            out: shapes.curvature.zeros(),
            heights: shapes.heights_curvature.zeros(),
            shared: shapes.sharing_curvature.zeros(),
            takeoff: if leaves { d.shapes.takeoff_curvature.zeros() } else { Vec::new() },
            n: shapes.curvature.n.zeros(),
            others: shapes.curvature.others.zeros(),
            of_takeoff: if leaves { d.shapes.takeoff_curvature.weights.zeros() } else { Vec::new() },
            scratch: z(np),
            local: z(np),
            h: z(np * np),
        }
    }
}

/// Memory for what happens at the ends of phases.
#[derive(Default)]
struct EndWork {
    /// Second derivatives in (q, q̇), or in what a landing is a function of.
    small: Vec<f64>,
    /// Weights of q̇⁺ and of what else an impact gives.
    xi: Vec<f64>,
    outputs: Vec<f64>,
    others: Vec<f64>,
    kernel: Vec<f64>,
    rows: Vec<f64>,
    of_takeoff: Vec<f64>,
    /// Weights that are not there: as many as any kernel input needs.
    zeros: Vec<f64>,
}

impl EndWork {
    fn new(d: &Description, n: usize) -> EndWork {
        let (nq, s) = (d.orientations(), d.shapes);
        let z = |count: usize| vec![0.0; count];
        let modes = [&s.stance, &s.flight];
        let most = |of: fn(&ModeShapes) -> usize| modes.map(of).into_iter().max().unwrap_or_default();
        let kernels = [s.touchdown_curvature.len, s.landing_curvature.len, s.takeoff_curvature.len];
        EndWork {
            small: z((2 * nq + 2).pow(2)),
            xi: z(nq),
            outputs: z(s.touchdown_curvature.outputs.len.max(s.landing_curvature.outputs.len)),
            others: z(most(|m| m.curvature.others.len)),
            kernel: z(kernels.into_iter().max().unwrap_or_default().max(most(|m| m.curvature.len))),
            rows: z(2 * nq * n),
            of_takeoff: s.takeoff_curvature.weights.zeros(),
            zeros: z(nq.max(most(|m| m.curvature.n.len)).max(d.positions())),
        }
    }
}

impl Workspace {
    pub fn new(d: &Description, variables: &Variables, phases: &[Phase]) -> Workspace {
        let n = variables.total();
        let most = phases.iter().map(|phase| phase.layout.len()).max().unwrap_or_default();
        let states = phases.iter().map(|phase| phase.mesh.nodes.len() * phase.instants.width());
        Workspace {
            local: vec![0.0; most],
            states: vec![0.0; states.max().unwrap_or_default()],
            phases: phases.iter().map(|phase| PhaseWork::new(d, phase)).collect(),
            half: vec![0.0; most * n],
            ends: EndWork::new(d, n),
        }
    }
}

impl Cycle<'_> {
    /// Writes the full symmetric Hessian at the linearized point.
    pub(super) fn lagrangian_hessian(&mut self, lambda: &[f64], mu: &[f64], hessian: &mut [f64]) {
        let n = self.variables.total();
        hessian.fill(0.0);
        let Workspace { local, states, mut phases, mut half, mut ends } = std::mem::take(&mut self.workspace);
        for (k, work) in phases.iter_mut().enumerate() {
            self.weigh(k, lambda, mu, work);
            let p = &self.phases[k];
            work.adjoint(self.description(), &self.units, p, self.closures(k, lambda));
            work.h.fill(0.0);
            self.instant_terms(k, mu, work);
            // T times the integral of the criterion.
            cross_duration(&mut work.h, &p.cost_p, self.per_work(), p.layout.duration());
            add_transpose(&mut work.h, p.layout.len());
            // Θ through the parameters: first order twice, then second order once.
            p.by_theta.congruence(&work.h, &mut half, hessian);
            self.start_terms(k, &work.gradient, lambda, mu, &mut ends, hessian);
        }
        // The objective is a quotient of work and duration: its own curvature.
        for i in 0..n {
            for j in 0..n {
                let product = self.cost_gradient[i] * self.duration_gradient[j]
                    + self.duration_gradient[i] * self.cost_gradient[j];
                hessian[i * n + j] -= product / self.duration;
            }
        }
        self.workspace = Workspace { local, states, phases, half, ends };
    }

    /// Multipliers of the closures of β and σ at the end of phase `k`.
    fn closures(&self, k: usize, lambda: &[f64]) -> [f64; 2] {
        let rows = self.rows.of(k);
        [lambda[rows.beta], lambda[rows.sigma]]
    }
}
