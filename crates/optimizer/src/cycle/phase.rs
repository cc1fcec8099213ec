//! One half step that defines the gait, and how its parameters depend on Θ.

use super::Variables;
use super::dip::{Dip, Lowest};
use crate::constraints::PathConstraint;
use crate::cost::Integral;
use crate::instant::{Glance, Instants};
use crate::lgl::NODES;
use crate::stance::{Layout, Mesh, Stance, Undefined};
use piaffe_model::units::Units;
use piaffe_model::{Description, Gait};

/// Length of a touchdown's couple and pitch, which come after everything else.
const SHARED: usize = 3;

/// State of a half step: what the last simulation left, and the derivatives of the last linearization.
pub struct Phase {
    /// Stance leg.
    pub leg: usize,
    pub mesh: Mesh,
    pub stance: Stance,
    pub instants: Instants,
    pub layout: Layout,
    /// Local parameters: see `stance`.
    pub parameters: Vec<f64>,
    pub cost: Integral,
    /// Constraints imposed between nodes.
    pub dips: Vec<Dip>,
    /// Joints that are held still.
    pub still: Vec<usize>,
    /// Configuration and velocity at its start, after the impact.
    pub q_start: Vec<f64>,
    pub qd_start: Vec<f64>,
    /// Wanted configuration and velocity at its end, before the impact.
    pub q_end: Vec<f64>,
    pub qd_end: Vec<f64>,
    /// `touchdown` and `placement` kernels at the end.
    pub touchdown: Vec<f64>,
    pub placement: Vec<f64>,
    /// Of the touchdown the impulse, leaving and landing velocity and, where the platform rolls, couple and pitch.
    pub impact: Vec<f64>,
    /// `momentum` kernel: σ and its gradient in (q, q̇), at the start and at the wanted end.
    pub momentum_start: Vec<f64>,
    pub momentum_end: Vec<f64>,
    /// Forward travel, m.
    pub travel: f64,

    /// ∂parameters/∂Θ, one row per parameter.
    pub by_theta: Vec<f64>,
    /// Quantities at the linearized point (a trial point must not disturb its derivatives).
    pub linearized: Vec<f64>,
    pub travel_p: Vec<f64>,
    /// ∂(q_start, q̇_start)/∂Θ, one row each.
    pub start_by_theta: Vec<f64>,
    scratch: Vec<f64>,
}

impl Phase {
    pub fn new(d: &Description, leg: usize, elements: usize) -> Phase {
        let mesh = Mesh::new(elements, d.polynomial_order);
        let layout = Layout::new(d, &mesh.basis);
        let (nq, nc) = (d.orientations(), d.positions());
        let n = Variables::new(d).total();
        let instants = Instants::new(d, &mesh);
        let shared = if d.lateral { SHARED } else { 0 };
        let z = |count: usize| vec![0.0; count];
        Phase {
            leg,
            stance: Stance::new(d, &mesh, leg),
            linearized: instants.values.clone(),
            instants,
            layout,
            parameters: z(layout.len()),
            cost: Integral::new(d, &mesh),
            dips: Vec::new(),
            still: Vec::new(),
            q_start: z(nq),
            qd_start: z(nq),
            q_end: z(nq),
            qd_end: z(nq),
            touchdown: z((nq + nc + 2 + shared) * (1 + 2 * nq)),
            impact: z(nc + 2 + shared),
            placement: z(2 * nc + 2 * nc * nq),
            momentum_start: z(1 + 2 * nq),
            momentum_end: z(1 + 2 * nq),
            travel: 0.0,
            by_theta: z(layout.len() * n),
            travel_p: z(layout.len()),
            start_by_theta: z(2 * nq * n),
            scratch: z(layout.len()),
            mesh,
        }
    }

    pub fn duration(&self) -> f64 {
        self.parameters[self.layout.duration()]
    }

    /// Last node.
    pub fn last(&self) -> usize {
        self.mesh.nodes.len() - 1
    }

    /// Looks at share `s`, between the nodes, of the last simulated motion.
    pub fn glance(&self, gait: &dyn Gait, s: f64, glance: &mut Glance) -> Result<(), Undefined> {
        glance.at(gait, self.leg, &self.mesh, &self.stance, &self.parameters, s)
    }

    /// What a mesh twice as fine changes in β and β̇ at the end of the last simulated motion, in the robot's units.
    pub fn mesh_error(&self, gait: &dyn Gait, units: &Units) -> Result<f64, Undefined> {
        let d = gait.description();
        let mesh = Mesh::new(2 * self.mesh.elements, d.polynomial_order);
        let mut finer = Stance::new(d, &mesh, self.leg);
        finer.integrate(gait, self.leg, &mesh, &self.parameters)?;
        let (here, there) = (self.last(), mesh.nodes.len() - 1);
        let change = |of: fn(&Stance) -> &[f64]| (of(&finer)[there] - of(&self.stance)[here]).abs();
        Ok(change(|s| &s.beta).max(change(|s| &s.betad) / units.rate()))
    }

    /// Where a path constraint is lowest in an element of the last simulated motion, as the quartic has it, near `from`.
    pub fn lowest(&self, constraint: &PathConstraint, element: usize, from: f64) -> Lowest {
        Lowest::of(&self.mesh.lobatto, &self.in_element(constraint, element), from)
    }

    /// Values of a path constraint at the nodes of an element of the last simulated motion.
    pub fn in_element(&self, constraint: &PathConstraint, element: usize) -> [f64; NODES] {
        let first = element * (NODES - 1);
        std::array::from_fn(|i| constraint.value(self.instants.row(first + i)))
    }

    /// Quantities of a node at the linearized point.
    pub fn linearized(&self, node: usize) -> &[f64] {
        let count = self.instants.quantities.len();
        &self.linearized[node * count..][..count]
    }

    /// Row of ∂(q̇⁺, impulse, leaving, landing, couple, pitch)/∂(q, q̇⁻) at the end.
    pub fn touchdown_row(&self, d: &Description, row: usize) -> &[f64] {
        let nq = d.orientations();
        let rows = nq + d.positions() + 2;
        // Values of couple and pitch stand between their rows and those before.
        let values = rows + if row < rows { 0 } else { SHARED };
        &self.touchdown[values + row * 2 * nq..][..2 * nq]
    }

    fn gather_impact(&mut self, d: &Description) {
        let nq = d.orientations();
        let rows = nq + d.positions() + 2;
        let (first, shared) = self.impact.split_at_mut(rows - nq);
        first.copy_from_slice(&self.touchdown[nq..rows]);
        shared.copy_from_slice(&self.touchdown[rows * (1 + 2 * nq)..][..shared.len()]);
    }

    /// ∂(vertical position of the swing foot)/∂q at the wanted end.
    pub fn landing_gradient(&self, d: &Description) -> &[f64] {
        let (nq, nc) = (d.orientations(), d.positions());
        &self.placement[2 * nc + nc * nq + nq..][..nq]
    }

    /// Evaluates what depends on the wanted end alone: the impact there, the foot's height, σ.
    pub fn end(&mut self, gait: &dyn Gait, variables: &Variables, own: &[f64]) {
        variables.end_state(own, &mut self.q_end, &mut self.qd_end);
        gait.touchdown(1 - self.leg, &self.q_end, &self.qd_end, &mut self.touchdown);
        self.gather_impact(gait.description());
        gait.placement(self.leg, &self.q_end, &mut self.placement);
        gait.momentum(self.leg, &self.q_end, &self.qd_end, &mut self.momentum_end);
    }

    /// Local parameters from the half step's own variables and its start.
    pub fn set_parameters(&mut self, gait: &dyn Gait, variables: &Variables, own: &[f64]) {
        let d = gait.description();
        gait.momentum(self.leg, &self.q_start, &self.qd_start, &mut self.momentum_start);
        let layout = self.layout;
        for j in 0..layout.prescribed {
            let index = d.prescribed_index(j);
            let p = &mut self.parameters[layout.joint(j, 0)..][..layout.per_joint];
            p[0] = self.q_start[index];
            p[1] = self.qd_start[index];
            for i in 0..layout.per_joint - 4 {
                p[2 + i] = own[variables.interior(i, j)];
            }
            p[layout.per_joint - 2] = own[variables.q(index)];
            p[layout.per_joint - 1] = own[variables.qd(index)];
        }
        self.parameters[layout.duration()] = own[variables.duration()];
        self.parameters[layout.beta()] = self.q_start[d.unactuated];
        self.parameters[layout.sigma()] = self.momentum_start[0];
    }

    /// Derivatives in the local parameters.
    pub fn differentiate(&mut self, gait: &dyn Gait, path: &[PathConstraint]) {
        let d = gait.description();
        self.stance.differentiate(gait, self.leg, &self.mesh, &self.parameters);
        self.instants.differentiate(d, &self.mesh, &self.stance, &self.parameters);
        self.linearized.copy_from_slice(&self.instants.values);
        for k in 0..self.dips.len() {
            let Dip { constraint, element, ref lowest, .. } = self.dips[k];
            self.dips[k].lowest = self.lowest(&path[constraint], element, lowest.at);
        }
        let last = self.last();
        self.instants.platform_x_gradient(d, &self.stance, 0, &mut self.scratch);
        self.instants.platform_x_gradient(d, &self.stance, last, &mut self.travel_p);
        for (end, start) in self.travel_p.iter_mut().zip(&self.scratch) {
            *end -= start;
        }
    }

    /// ∂parameters/∂Θ, once `start_by_theta` is known; `own` is where this half step's variables begin.
    pub fn differentiate_parameters(&mut self, d: &Description, variables: &Variables, own: usize) {
        let n = variables.total();
        let nq = d.orientations();
        let layout = self.layout;
        self.by_theta.fill(0.0);
        let row = |local: usize| local * n..(local + 1) * n;
        for j in 0..layout.prescribed {
            let index = d.prescribed_index(j);
            self.by_theta[row(layout.joint(j, 0))].copy_from_slice(&self.start_by_theta[row(index)]);
            self.by_theta[row(layout.joint(j, 1))].copy_from_slice(&self.start_by_theta[row(nq + index)]);
            for i in 0..layout.per_joint - 4 {
                self.by_theta[layout.joint(j, 2 + i) * n + own + variables.interior(i, j)] = 1.0;
            }
            self.by_theta[layout.joint(j, layout.per_joint - 2) * n + own + variables.q(index)] = 1.0;
            self.by_theta[layout.joint(j, layout.per_joint - 1) * n + own + variables.qd(index)] = 1.0;
        }
        self.by_theta[layout.duration() * n + own + variables.duration()] = 1.0;
        self.by_theta[row(layout.beta())].copy_from_slice(&self.start_by_theta[row(d.unactuated)]);
        for (k, gradient) in self.momentum_start[1..].iter().enumerate() {
            for (s, c) in self.by_theta[row(layout.sigma())].iter_mut().zip(&self.start_by_theta[row(k)]) {
                *s += gradient * c;
            }
        }
    }

    /// `row += scale · localᵀ ∂parameters/∂Θ`.
    pub fn project(&self, local: &[f64], scale: f64, row: &mut [f64]) {
        for (g, by) in local.iter().zip(self.by_theta.chunks(row.len())) {
            let factor = scale * g;
            if factor != 0.0 {
                for (r, b) in row.iter_mut().zip(by) {
                    *r += factor * b;
                }
            }
        }
    }
}
