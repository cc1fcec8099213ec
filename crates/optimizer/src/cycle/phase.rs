//! One phase of the gait, and how its parameters depend on Θ.

use super::Variables;
use super::by_theta::ByTheta;
use super::crossing::Crossing;
use super::dip::{Dip, Lowest};
use super::fold::Parts;
use crate::constraints::{ImpactConstraints, PathConstraint, path_constraints};
use crate::cost::{Integral, Partials};
use crate::flow::{Fall, Flow, Layout, Mesh, Undefined};
use crate::instant::{Glance, Instants};
use crate::lgl::NODES;
use piaffe_model::shape::ModeShapes;
use piaffe_model::units::Units;
use piaffe_model::{Description, FORWARD, Gait, Mode, UP};
use piaffe_sqp::axpy;
use smallvec::SmallVec;

/// State of a phase: what the last simulation left, and the derivatives of the last linearization.
pub struct Phase {
    /// Which of the gait's.
    index: usize,
    pub mode: Mode,
    pub shapes: &'static ModeShapes,
    pub mesh: Mesh,
    pub flow: Flow,
    pub instants: Instants,
    pub layout: Layout,
    /// Local parameters: see `flow`.
    pub parameters: Vec<f64>,
    pub cost: Integral,
    /// Of the criterion at the linearized point, by element and joint, done and taken.
    pub parts: Parts,
    /// Constraints at its instants.
    pub path: Vec<PathConstraint>,
    /// Constraints imposed between nodes.
    pub dips: Vec<Dip>,
    /// Joints that are held still.
    pub still: Vec<usize>,
    /// Configuration and velocity at its start, after the transition.
    pub q_start: Vec<f64>,
    pub qd_start: Vec<f64>,
    /// Wanted configuration and velocity at its end, before the transition.
    pub q_end: Vec<f64>,
    pub qd_end: Vec<f64>,
    /// How it ends, and what is asked of the impact if there is one.
    pub crossing: Crossing,
    pub impact: Option<ImpactConstraints>,
    /// `placement` kernel at the wanted end.
    pub placement: Vec<f64>,
    /// The foot that lands at its end, as kernels count those in the air.
    pub landing_foot: Option<usize>,
    /// `momentum` kernel: σ and its gradient in (q, q̇), at the start and at the wanted end.
    pub momentum_start: Vec<f64>,
    pub momentum_end: Vec<f64>,
    /// Forward travel, m.
    pub travel: f64,

    /// ∂parameters/∂Θ, and as a table in which it is put together, one row per parameter.
    pub by_theta: ByTheta,
    table: Vec<f64>,
    /// Quantities at the linearized point (a trial point must not disturb its derivatives).
    pub linearized: Vec<f64>,
    /// Gradients of the criterion's integral and of the travel in the local parameters.
    pub cost_p: Vec<f64>,
    pub travel_p: Vec<f64>,
    /// ∂(q_start, q̇_start)/∂Θ, one row each.
    pub start_by_theta: Vec<f64>,
    scratch: Vec<f64>,
}

impl Phase {
    /// Phase `k` of a gait.
    pub fn new(d: &Description, k: usize, elements: usize) -> Phase {
        let mode = d.phases[k].mode;
        let mesh = Mesh::new(elements, d.polynomial_order);
        let layout = Layout::new(d, k, &mesh.basis);
        let (nq, shapes) = (d.orientations(), d.shape(mode));
        let n = Variables::new(d).total();
        let instants = Instants::new(d, &mesh, k);
        let lands = d.transition(k).lands();
        let z = |count: usize| vec![0.0; count];
        Phase {
            index: k,
            mode,
            shapes,
            flow: Flow::new(d, &mesh, k),
            linearized: instants.values.clone(),
            landing_foot: mode.swinging().position(|leg| lands == Some(leg)),
            instants,
            layout,
            parameters: z(layout.len()),
            cost: Integral::new(d, mode, &mesh),
            parts: Parts::default(),
            path: path_constraints(d, k),
            dips: Vec::new(),
            still: Vec::new(),
            q_start: z(nq),
            qd_start: z(nq),
            q_end: z(nq),
            qd_end: z(nq),
            crossing: Crossing::new(d, k, n),
            impact: ImpactConstraints::new(d, d.transition(k)),
            placement: shapes.placement.zeros(),
            momentum_start: shapes.momentum.zeros(),
            momentum_end: shapes.momentum.zeros(),
            travel: 0.0,
            by_theta: ByTheta::new(layout.len(), n),
            table: z(layout.len() * n),
            cost_p: z(layout.len()),
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

    /// The mass centre's parabola, in flight.
    pub fn fall(&self, d: &Description) -> Option<Fall> {
        Fall::new(&self.layout, d.gravity, &self.parameters)
    }

    /// Looks at share `s`, between the nodes, of the last simulated motion.
    pub fn glance(&self, gait: &dyn Gait, s: f64, glance: &mut Glance) -> Result<(), Undefined> {
        glance.at(gait, &self.mesh, &self.flow, &self.layout, &self.parameters, s)
    }

    /// What a mesh twice as fine changes in β and β̇ at the end of the last simulated motion, in the robot's units.
    pub fn mesh_error(&self, gait: &dyn Gait, units: &Units) -> Result<f64, Undefined> {
        let d = gait.description();
        let mesh = Mesh::new(2 * self.mesh.elements, d.polynomial_order);
        let mut finer = Flow::new(d, &mesh, self.index);
        finer.integrate(gait, self.mode, &mesh, &self.parameters)?;
        let (here, there) = (self.last(), mesh.nodes.len() - 1);
        let change = |of: fn(&Flow) -> &[f64]| (of(&finer)[there] - of(&self.flow)[here]).abs();
        Ok(change(|s| &s.beta).max(change(|s| &s.betad) / units.rate()))
    }

    /// Where a path constraint is lowest in an element of the last simulated motion, as the quartic has it, near `from`.
    pub fn lowest(&self, constraint: &PathConstraint, element: usize, from: f64) -> Lowest {
        let (lobatto, values) = (&self.mesh.lobatto, self.in_element(constraint, element));
        match constraint.dry() {
            Some((rate, Some(side))) => {
                Lowest::on_side(lobatto, &values, self.of_element(rate, element), rate, side, from)
            }
            _ => Lowest::of(lobatto, &values, from),
        }
    }

    /// Values of a quantity at the nodes of an element of the last simulated motion.
    pub fn of_element(&self, quantity: usize, element: usize) -> [f64; NODES] {
        std::array::from_fn(|i| self.instants.value(element * (NODES - 1) + i, quantity))
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

    /// Height of a foot at the wanted end, m.
    pub fn landing_height(&self, d: &Description, foot: usize) -> f64 {
        let fallen = self.fall(d).map_or(0.0, |fall| fall.height(1.0));
        self.shapes.placement.swing.of(&self.placement)[self.instants.up(foot)] + fallen
    }

    /// ∂(its height from the stance foot, or in flight from the mass centre)/∂q.
    pub fn landing_gradient(&self, foot: usize) -> &[f64] {
        self.shapes.placement.swing_q.row(&self.placement, self.instants.up(foot))
    }

    /// Evaluates what depends on the wanted end alone, and in flight on the parabola: the transition there, the foot's height, σ.
    pub fn end(&mut self, gait: &dyn Gait, variables: &Variables, own: &[f64], centre: [f64; 2], still: &[f64]) {
        variables.end_state(own, &mut self.q_end, &mut self.qd_end);
        self.crossing.evaluate(gait, &self.q_end, &self.qd_end, centre, still);
        gait.placement(self.mode, &self.q_end, &mut self.placement);
        gait.momentum(self.mode, &self.q_end, &self.qd_end, &mut self.momentum_end);
    }

    /// Local parameters from Θ, the phase's start and the parabola that begins there in flight.
    pub fn set_parameters(&mut self, gait: &dyn Gait, variables: &Variables, theta: &[f64], parabola: (f64, [f64; 2])) {
        let d = gait.description();
        gait.momentum(self.mode, &self.q_start, &self.qd_start, &mut self.momentum_start);
        let layout = self.layout;
        let own = &theta[self.index * variables.per_phase()..][..variables.per_phase()];
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
        if layout.flies() {
            let (height, velocity) = parabola;
            self.parameters[layout.centre_height()] = height;
            [FORWARD, UP].iter().for_each(|c| self.parameters[layout.centre_velocity(*c)] = velocity[*c]);
        }
        for (k, at) in layout.others() {
            self.parameters[at] = theta[k * variables.per_phase() + variables.duration()];
        }
    }

    /// Derivatives in the local parameters.
    pub fn differentiate(&mut self, gait: &dyn Gait) {
        let d = gait.description();
        self.flow.differentiate(gait, self.mode, &self.mesh, &self.parameters);
        self.instants.differentiate(d, &self.mesh, &self.flow, &self.parameters);
        self.linearized.copy_from_slice(&self.instants.values);
        for k in 0..self.dips.len() {
            let Dip { constraint, element, ref lowest, .. } = self.dips[k];
            self.dips[k].lowest = self.lowest(&self.path[constraint], element, lowest.at);
        }
        let (instants, flow, parameters, last) = (&self.instants, &self.flow, &self.parameters, self.last());
        instants.platform_x_gradient(d, &self.mesh, flow, parameters, 0, &mut self.scratch);
        instants.platform_x_gradient(d, &self.mesh, flow, parameters, last, &mut self.travel_p);
        for (end, start) in self.travel_p.iter_mut().zip(&self.scratch) {
            *end -= start;
        }
    }

    /// ∂parameters/∂Θ, once `start_by_theta` is known. A flight needs the transition before it, and where the variables of that phase
    /// begin.
    pub fn differentiate_parameters(
        &mut self,
        d: &Description,
        variables: &Variables,
        before: Option<(&Crossing, usize)>,
    ) {
        let (n, own) = (variables.total(), self.index * variables.per_phase());
        let nq = d.orientations();
        let layout = self.layout;
        self.table.fill(0.0);
        let row = |local: usize| local * n..(local + 1) * n;
        for j in 0..layout.prescribed {
            let index = d.prescribed_index(j);
            self.table[row(layout.joint(j, 0))].copy_from_slice(&self.start_by_theta[row(index)]);
            self.table[row(layout.joint(j, 1))].copy_from_slice(&self.start_by_theta[row(nq + index)]);
            for i in 0..layout.per_joint - 4 {
                self.table[layout.joint(j, 2 + i) * n + own + variables.interior(i, j)] = 1.0;
            }
            self.table[layout.joint(j, layout.per_joint - 2) * n + own + variables.q(index)] = 1.0;
            self.table[layout.joint(j, layout.per_joint - 1) * n + own + variables.qd(index)] = 1.0;
        }
        self.table[layout.duration() * n + own + variables.duration()] = 1.0;
        self.table[row(layout.beta())].copy_from_slice(&self.start_by_theta[row(d.unactuated)]);
        for (k, gradient) in self.shapes.momentum.sigma_w.of(&self.momentum_start).iter().enumerate() {
            for (s, c) in self.table[row(layout.sigma())].iter_mut().zip(&self.start_by_theta[row(k)]) {
                *s += gradient * c;
            }
        }
        if let Some((takeoff, first)) = before.filter(|_| layout.flies()) {
            for (k, gradient) in takeoff.height_gradient().iter().enumerate() {
                self.table[layout.centre_height() * n + first + variables.q(k)] = *gradient;
            }
            for c in [FORWARD, UP] {
                let (by_q, by_qd) = takeoff.velocity_gradient(c).split_at(nq);
                for k in 0..nq {
                    let row = &mut self.table[row(layout.centre_velocity(c))];
                    row[first + variables.q(k)] = by_q[k];
                    row[first + variables.qd(k)] = by_qd[k];
                }
            }
        }
        for (k, at) in layout.others() {
            self.table[at * n + k * variables.per_phase() + variables.duration()] = 1.0;
        }
        self.by_theta.set(&self.table);
    }

    /// The parabola's parameters of a landing: what the mass centre's velocity before it is as a function of Θ.
    pub fn differentiate_centre(&mut self, d: &Description, n: usize) {
        if !self.layout.flies() {
            return;
        }
        for c in [FORWARD, UP] {
            let (velocity, duration) = (self.layout.centre_velocity(c) * n, self.layout.duration() * n);
            let table = &self.table;
            self.crossing.set_centre_gradient(c, |row| {
                row.copy_from_slice(&table[velocity..velocity + n]);
                if c == UP {
                    row.iter_mut().zip(&table[duration..]).for_each(|(slot, by)| *slot -= d.gravity * by);
                }
            });
        }
    }

    /// A gradient in the local parameters, of nothing yet.
    pub fn no_parameters(&self) -> SmallVec<[f64; 64]> {
        SmallVec::from_elem(0.0, self.layout.len())
    }

    /// Adds to a gradient in the local parameters one in the state of a node.
    pub fn pull(&self, d: &Description, node: usize, state: &[f64], local: &mut [f64]) {
        let mut pulled = self.no_parameters();
        self.instants.chain(d, &self.flow, node).pull(state, &mut pulled);
        axpy(1.0, &pulled, local);
    }

    /// Adds `scale` times the gradient of what has these partial derivatives in the quantities of a node.
    pub fn add_partials(&self, d: &Description, node: usize, partials: &Partials, scale: f64, local: &mut [f64]) {
        let mut state = SmallVec::<[f64; 32]>::from_elem(0.0, self.instants.width());
        for (quantity, partial) in partials {
            axpy(scale * partial, self.instants.gradient(node, *quantity), &mut state);
        }
        self.pull(d, node, &state, local);
    }

    /// Adds `scale` times the gradient of a quantity at a node.
    pub fn add_quantity(&self, d: &Description, node: usize, quantity: usize, scale: f64, local: &mut [f64]) {
        let mut pulled = self.no_parameters();
        self.instants.chain(d, &self.flow, node).pull(self.instants.gradient(node, quantity), &mut pulled);
        axpy(scale, &pulled, local);
    }

    /// Adds `scale` times the gradient of a path constraint at a node.
    pub fn add_constraint(
        &self,
        d: &Description,
        node: usize,
        constraint: &PathConstraint,
        scale: f64,
        local: &mut [f64],
    ) {
        let mut state = SmallVec::<[f64; 32]>::from_elem(0.0, self.instants.width());
        constraint.partials(self.linearized(node), |quantity, partial| {
            axpy(scale * partial, self.instants.gradient(node, quantity), &mut state);
        });
        self.pull(d, node, &state, local);
    }
}
