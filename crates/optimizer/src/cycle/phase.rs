//! One half step that defines the gait, and how its parameters depend on Θ.

use super::Variables;
use super::dip::{Dip, Lowest};
use crate::constraints::PathConstraint;
use crate::cost::Integral;
use crate::instant::{Glance, Instants};
use crate::lgl::NODES;
use crate::stance::{Layout, Mesh, Stance, Undefined};
use piaffe_model::shape::{Block, Shapes};
use piaffe_model::units::Units;
use piaffe_model::{Description, Gait, UP};

/// State of a half step: what the last simulation left, and the derivatives of the last linearization.
pub struct Phase {
    /// Stance leg.
    pub leg: usize,
    pub shapes: &'static Shapes,
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
    /// What the touchdown gives beside q̇⁺, in the order of the weights of `touchdown_curvature`.
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
        let (nq, shapes) = (d.orientations(), d.shapes);
        let n = Variables::new(d).total();
        let instants = Instants::new(d, &mesh);
        let z = |count: usize| vec![0.0; count];
        Phase {
            leg,
            shapes,
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
            touchdown: shapes.touchdown.zeros(),
            impact: shapes.touchdown_curvature.outputs.zeros(),
            placement: shapes.placement.zeros(),
            momentum_start: shapes.momentum.zeros(),
            momentum_end: shapes.momentum.zeros(),
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

    /// q̇⁺ after the impact at the end, before the legs swap names.
    pub fn qd_plus(&self) -> &[f64] {
        self.shapes.touchdown.qd_plus.of(&self.touchdown)
    }

    /// ∂/∂(q, q̇⁻) of an entry of q̇⁺.
    pub fn qd_plus_row(&self, k: usize) -> &[f64] {
        self.shapes.touchdown.qd_plus_w.row(&self.touchdown, k)
    }

    /// ∂/∂(q, q̇⁻) of an entry of `impact`.
    pub fn impact_row(&self, i: usize) -> &[f64] {
        let found = self.of_impact().into_iter().find(|[to, ..]| to.range().contains(&i));
        let [to, _, rows] = found.unwrap_or([Block::NONE; 3]);
        rows.row(&self.touchdown, i - to.range().start)
    }

    /// Where in `impact` something of the touchdown stands, where in `touchdown`, and where its gradients do there.
    fn of_impact(&self) -> [[Block; 3]; 5] {
        let (to, from) = (&self.shapes.touchdown_curvature.outputs, &self.shapes.touchdown);
        [
            [to.impulse, from.impulse, from.impulse_w],
            [to.leaving, from.leaving, from.leaving_w],
            [to.landing, from.landing, from.landing_w],
            [to.couple, from.couple, from.couple_w],
            [to.pitch, from.pitch, from.pitch_w],
        ]
    }

    fn gather_impact(&mut self) {
        for [to, from, _] in self.of_impact() {
            to.of_mut(&mut self.impact).copy_from_slice(from.of(&self.touchdown));
        }
    }

    /// Height of the swing foot at the wanted end, m.
    pub fn landing_height(&self) -> f64 {
        self.shapes.placement.swing.of(&self.placement)[UP]
    }

    /// ∂(vertical position of the swing foot)/∂q at the wanted end.
    pub fn landing_gradient(&self) -> &[f64] {
        self.shapes.placement.swing_q.row(&self.placement, UP)
    }

    /// Evaluates what depends on the wanted end alone: the impact there, the foot's height, σ.
    pub fn end(&mut self, gait: &dyn Gait, variables: &Variables, own: &[f64]) {
        variables.end_state(own, &mut self.q_end, &mut self.qd_end);
        gait.touchdown(1 - self.leg, &self.q_end, &self.qd_end, &mut self.touchdown);
        self.gather_impact();
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
        self.parameters[layout.sigma()] = self.shapes.momentum.sigma.value(&self.momentum_start);
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
        for (k, gradient) in self.shapes.momentum.sigma_w.of(&self.momentum_start).iter().enumerate() {
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
