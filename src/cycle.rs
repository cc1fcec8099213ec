//! Θ → the whole periodic motion: torques, reactions, criterion, every constraint, exact gradients (§5).
//!
//! Variables, per half step that defines the gait: Q_f, β_f, Q̇_f, β̇_f, interior values of Q, T. The
//! initial state of a half step follows from the final state of the one before: same configuration,
//! velocities after the impact, legs renamed where half steps mirror each other (eq. 16, 18, 19).
//! Equalities: β and β̇ close the cycle (eq. 23, 24, the latter as σ), the swing foot lands, and the
//! mean speed is the given one.

use crate::constraints::{ImpactConstraints, PathConstraint, path_constraints};
use crate::cost::{Integral, integrate};
use crate::instant::Instants;
use crate::model::{Description, Gait, HalfSteps};
use crate::motion::{Costs, Criterion, HalfStep, Motion};
use crate::sqp;
use crate::stance::{Layout, Mesh, Stance, Undefined};

/// Elements per half step: 4 × this + 1 nodes.
pub const ELEMENTS: usize = 8;

/// Equalities of each half step: closure of β and σ, touchdown.
const CLOSURE: usize = 3;

/// The optimization problem of one gait, criterion and speed.
pub struct Cycle<'a> {
    gait: &'a dyn Gait,
    pub criterion: Criterion,
    /// Mean forward speed, m/s.
    pub speed: f64,
    phases: Vec<Phase>,
    path: Vec<PathConstraint>,
    impact: ImpactConstraints,
    /// Distance travelled in all half steps, m.
    distance: f64,
    cost_gradient: Vec<f64>,
}

/// One half step and how its parameters depend on Θ.
struct Phase {
    leg: usize,
    mesh: Mesh,
    stance: Stance,
    instants: Instants,
    layout: Layout,
    /// Local parameters.
    parameters: Vec<f64>,
    /// ∂parameters/∂Θ, row-major.
    by_theta: Vec<f64>,
    cost: Integral,
    /// Configuration and velocity at the end, before the impact.
    q_final: Vec<f64>,
    qd_final: Vec<f64>,
    /// Touchdown kernel at the end of this half step.
    touchdown: Vec<f64>,
    /// Placement kernel at the end.
    placement: Vec<f64>,
    /// σ and its gradient at the start and at the wanted end.
    momentum_start: Vec<f64>,
    momentum_end: Vec<f64>,
    /// Forward distance and its gradient in the local parameters.
    distance: f64,
    distance_p: Vec<f64>,
}

/// Which constraint an inequality row is.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub name: String,
    /// 1-based.
    pub half_step: usize,
    /// s.
    pub time: f64,
}

impl<'a> Cycle<'a> {
    pub fn new(gait: &'a dyn Gait, criterion: Criterion, speed: f64) -> Cycle<'a> {
        let d = gait.description();
        let phases = (0..d.phases()).map(|k| Phase::new(d, k)).collect();
        let n = d.phases() * variables_per_phase(d);
        Cycle {
            gait,
            criterion,
            speed,
            phases,
            path: path_constraints(d),
            impact: ImpactConstraints::new(d),
            distance: 0.0,
            cost_gradient: vec![0.0; n],
        }
    }

    pub fn description(&self) -> &'static Description {
        self.gait.description()
    }

    /// The same problem, with collocation nodes only.
    pub fn again(&self) -> Cycle<'a> {
        Cycle::new(self.gait, self.criterion, self.speed)
    }

    /// Number of half steps that define the gait.
    pub fn phases(&self) -> usize {
        self.phases.len()
    }

    /// Number of instants looked at in a half step.
    pub fn nodes(&self, phase: usize) -> usize {
        self.phases[phase].mesh.nodes.len()
    }

    /// Instant `node` as a share of its half step.
    pub fn instant(&self, phase: usize, node: usize) -> f64 {
        self.phases[phase].mesh.nodes[node].0
    }

    /// Number of path constraints.
    pub fn path_count(&self) -> usize {
        self.path.len()
    }

    /// Scaled value of a path constraint in the last simulated motion.
    pub fn path_value(&self, phase: usize, node: usize, constraint: usize) -> f64 {
        self.path[constraint].value(&self.phases[phase].instants, node)
    }

    /// Number of variables Θ.
    pub fn dimension(&self) -> usize {
        self.phases.len() * self.per_phase()
    }

    fn per_phase(&self) -> usize {
        variables_per_phase(self.description())
    }

    /// Natural size of each variable: rad, rad/s, s.
    pub fn scale(&self) -> Vec<f64> {
        let d = self.description();
        let nq = d.orientations();
        let mut scale = Vec::new();
        for _ in 0..self.phases.len() {
            scale.extend(std::iter::repeat_n(0.3, nq));
            scale.extend(std::iter::repeat_n(3.0, nq));
            scale.extend(std::iter::repeat_n(0.3, d.prescribed() * (d.polynomial_order - 3)));
            scale.push(0.1);
        }
        scale
    }

    /// Looks at further instants (fractions of each half step) besides the collocation nodes.
    pub fn set_instants(&mut self, instants: &[Vec<f64>]) {
        let d = self.description();
        for (phase, list) in self.phases.iter_mut().zip(instants) {
            phase.mesh.set_instants(list);
            phase.stance = Stance::new(d, &phase.mesh, phase.leg);
            phase.instants = Instants::new(d, &phase.mesh);
        }
    }

    /// Evaluates the motion of Θ.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    pub fn simulate(&mut self, theta: &[f64]) -> Result<(), Undefined> {
        let d = self.description();
        let (nq, nt) = (d.orientations(), d.prescribed());
        let m = self.per_phase();
        for (k, phase) in self.phases.iter_mut().enumerate() {
            let own = &theta[k * m..(k + 1) * m];
            for j in 0..nt {
                phase.q_final[d.prescribed_index(j)] = own[j];
                phase.qd_final[d.prescribed_index(j)] = own[nq + j];
            }
            phase.q_final[d.unactuated] = own[nt];
            phase.qd_final[d.unactuated] = own[nq + nt];
            self.gait.touchdown(1 - phase.leg, &phase.q_final, &phase.qd_final, &mut phase.touchdown);
            self.gait.placement(phase.leg, &phase.q_final, &mut phase.placement);
            self.gait.momentum(phase.leg, &phase.q_final, &phase.qd_final, &mut phase.momentum_end);
        }
        self.distance = 0.0;
        for k in 0..self.phases.len() {
            let before = (k + self.phases.len() - 1) % self.phases.len();
            let (q, qd) = self.initial_state(before);
            let phase = &mut self.phases[k];
            self.gait.momentum(phase.leg, &q, &qd, &mut phase.momentum_start);
            let own = &theta[k * m..(k + 1) * m];
            phase.set_parameters(d, own, &q, &qd);
            let t = phase.parameters[phase.layout.duration()];
            if t.is_nan() || t < 1e-4 {
                return Err(Undefined::NotFinite);
            }
            phase.stance.integrate(self.gait, phase.leg, &phase.mesh, &phase.parameters)?;
            phase.instants.evaluate(self.gait, phase.leg, &phase.mesh, &phase.stance, &phase.parameters);
            integrate(self.criterion, d, &phase.mesh, &phase.instants, &mut phase.cost);
            let last = phase.mesh.collocation() - 1;
            phase.distance = phase.instants.platform(d, last)[0] - phase.instants.platform(d, 0)[0];
            self.distance += phase.distance;
        }
        Ok(())
    }

    /// Configuration and velocity with which the half step after `before` starts.
    fn initial_state(&self, before: usize) -> (Vec<f64>, Vec<f64>) {
        let d = self.description();
        let phase = &self.phases[before];
        let pick = |values: &[f64]| -> Vec<f64> {
            (0..d.orientations())
                .map(|k| {
                    let (from, sign) = renamed(d, k);
                    sign * values[from]
                })
                .collect()
        };
        (pick(&phase.q_final), pick(&phase.touchdown[..d.orientations()]))
    }

    /// Objective and constraints of the last simulated motion.
    fn collect(&self, theta: &[f64], out: &mut sqp::Values) {
        let d = self.description();
        let m = self.per_phase();
        out.objective = self.work() / self.distance;
        out.equalities.clear();
        out.inequalities.clear();
        let mut duration = 0.0;
        for (k, phase) in self.phases.iter().enumerate() {
            let own = &theta[k * m..(k + 1) * m];
            let last = phase.mesh.collocation() - 1;
            out.equalities.push(phase.stance.beta[last] - own[d.prescribed()]);
            out.equalities.push(phase.stance.sigma[last] - phase.momentum_end[0]);
            out.equalities.push(phase.placement[d.positions() + 1] / d.leg_length());
            duration += own[m - 1];
        }
        out.equalities.push((self.distance - self.speed * duration) / d.leg_length());
        for phase in &self.phases {
            for node in 0..phase.mesh.nodes.len() {
                for constraint in self.path_at(node) {
                    out.inequalities.push(constraint.value(&phase.instants, node));
                }
            }
        }
        for phase in &self.phases {
            let nq = d.orientations();
            let impulse = &phase.touchdown[nq..nq + d.positions()];
            self.impact.values(impulse, phase.touchdown[nq + d.positions()], &mut out.inequalities);
        }
    }

    fn path_at(&self, node: usize) -> impl Iterator<Item = &PathConstraint> {
        self.path.iter().filter(move |c| node > 0 || c.at_start)
    }

    /// Integral of the criterion's integrand over the whole motion.
    fn work(&self) -> f64 {
        self.phases.iter().map(|p| p.parameters[p.layout.duration()] * p.cost.value).sum()
    }

    /// Where inequality row `i` comes from.
    fn locate(&self, i: usize) -> Row {
        let at_start = self.path.iter().filter(|c| c.at_start).count();
        let mut rest = i;
        for (k, phase) in self.phases.iter().enumerate() {
            if rest < at_start {
                return Row::Path { phase: k, node: 0, constraint: self.path.iter().enumerate().filter(|(_, c)| c.at_start).nth(rest).map_or(0, |(c, _)| c) };
            }
            rest -= at_start;
            let others = (phase.mesh.nodes.len() - 1) * self.path.len();
            if rest < others {
                return Row::Path { phase: k, node: 1 + rest / self.path.len(), constraint: rest % self.path.len() };
            }
            rest -= others;
        }
        let per_phase = self.impact.names().len();
        Row::Impact { phase: rest / per_phase, constraint: rest % per_phase }
    }

    /// Which constraint inequality row `i` is, in words.
    pub fn label(&self, i: usize) -> Label {
        match self.locate(i) {
            Row::Path { phase, node, constraint } => {
                let p = &self.phases[phase];
                let time = p.mesh.nodes[node].0 * p.parameters[p.layout.duration()];
                Label { name: self.path[constraint].name.clone(), half_step: phase + 1, time }
            }
            Row::Impact { phase, constraint } => {
                let p = &self.phases[phase];
                Label { name: self.impact.names()[constraint].into(), half_step: phase + 1, time: p.parameters[p.layout.duration()] }
            }
        }
    }

    /// Which equality `i` is, in words.
    pub fn equality_label(&self, i: usize) -> Label {
        let names = ["closure of β", "closure of σ", "touchdown of the swing foot"];
        let phase = i / CLOSURE;
        if phase < self.phases.len() {
            let p = &self.phases[phase];
            Label { name: names[i % CLOSURE].into(), half_step: phase + 1, time: p.parameters[p.layout.duration()] }
        } else {
            Label { name: "mean speed".into(), half_step: self.phases.len(), time: 0.0 }
        }
    }

    /// Which variable's bound `i` is, in words: only durations are bounded.
    pub fn bound_label(&self, i: usize) -> Label {
        let phase = i / self.per_phase();
        Label { name: "duration of the half step".into(), half_step: phase + 1, time: 0.0 }
    }

    /// Both criteria of the last simulated motion.
    pub fn costs(&self) -> Costs {
        let d = self.description();
        let of = |criterion| {
            let mut integral = Integral::default();
            let mut sum = 0.0;
            for p in &self.phases {
                integrate(criterion, d, &p.mesh, &p.instants, &mut integral);
                sum += p.parameters[p.layout.duration()] * integral.value;
            }
            sum / self.distance
        };
        Costs { energy: of(Criterion::Energy), torque: of(Criterion::Torque) }
    }

    /// The last simulated motion as numbers.
    pub fn motion(&self) -> Motion {
        let d = self.description();
        let half_steps = (0..self.phases.len())
            .map(|k| {
                let before = (k + self.phases.len() - 1) % self.phases.len();
                let (q, qd) = self.initial_state(before);
                let p = &self.phases[k];
                let prescribed = |values: &[f64]| -> Vec<f64> { (0..d.prescribed()).map(|j| values[d.prescribed_index(j)]).collect() };
                let interior = p.layout.per_joint - 4;
                HalfStep {
                    duration: p.parameters[p.layout.duration()],
                    q_initial: prescribed(&q),
                    qd_initial: prescribed(&qd),
                    q_interior: (0..interior).map(|i| (0..d.prescribed()).map(|j| p.parameters[p.layout.joint(j, 2 + i)]).collect()).collect(),
                    q_final: prescribed(&p.q_final),
                    qd_final: prescribed(&p.qd_final),
                    beta_initial: q[d.unactuated],
                    betad_initial: qd[d.unactuated],
                    beta_final: p.q_final[d.unactuated],
                    betad_final: p.qd_final[d.unactuated],
                }
            })
            .collect();
        Motion { half_steps }
    }

    /// Θ of a motion.
    pub fn theta(&self, motion: &Motion) -> Vec<f64> {
        let mut theta = Vec::with_capacity(self.dimension());
        for h in &motion.half_steps {
            theta.extend_from_slice(&h.q_final);
            theta.push(h.beta_final);
            theta.extend_from_slice(&h.qd_final);
            theta.push(h.betad_final);
            theta.extend(h.q_interior.iter().flatten());
            theta.push(h.duration);
        }
        theta
    }

    /// ∂parameters/∂Θ of every half step, from the impact's and the momentum's Jacobians.
    fn differentiate_parameters(&mut self) {
        let d = self.description();
        let (nq, nt, n, m) = (d.orientations(), d.prescribed(), self.dimension(), self.per_phase());
        let count = self.phases.len();
        for k in 0..count {
            let before = (k + count - 1) % count;
            let rows = d.orientations() + d.positions() + 2;
            let offset = rows;
            // Rows of ∂(q_i, q̇_i)/∂Θ; the state before the impact is (Q_f, β_f, Q̇_f, β̇_f) of `before`.
            let column_q = |j: usize| before * m + theta_position(d, j);
            let column_qd = |j: usize| before * m + nq + theta_position(d, j);
            let mut q_i = vec![0.0; nq * n];
            let mut qd_i = vec![0.0; nq * n];
            for row in 0..nq {
                let (from, sign) = renamed(d, row);
                q_i[row * n + column_q(from)] = sign;
                let jacobian = &self.phases[before].touchdown[offset + from * 2 * nq..][..2 * nq];
                for j in 0..nq {
                    qd_i[row * n + column_q(j)] = sign * jacobian[j];
                    qd_i[row * n + column_qd(j)] = sign * jacobian[nq + j];
                }
            }
            let phase = &mut self.phases[k];
            phase.by_theta.fill(0.0);
            let layout = phase.layout;
            let own = k * m;
            let mut set = |local: usize, source: &[f64]| phase.by_theta[local * n..(local + 1) * n].copy_from_slice(source);
            let mut unit = vec![0.0; n];
            for j in 0..nt {
                let index = d.prescribed_index(j);
                set(layout.joint(j, 0), &q_i[index * n..(index + 1) * n]);
                set(layout.joint(j, 1), &qd_i[index * n..(index + 1) * n]);
                let mut one = |local: usize, theta: usize| {
                    unit.fill(0.0);
                    unit[theta] = 1.0;
                    set(local, &unit);
                };
                for i in 0..layout.per_joint - 4 {
                    one(layout.joint(j, 2 + i), own + 2 * nq + i * nt + j);
                }
                one(layout.joint(j, layout.per_joint - 2), own + j);
                one(layout.joint(j, layout.per_joint - 1), own + nq + j);
            }
            unit.fill(0.0);
            unit[own + m - 1] = 1.0;
            set(layout.duration(), &unit);
            set(layout.beta(), &q_i[d.unactuated * n..(d.unactuated + 1) * n]);
            let gradient = phase.momentum_start[1..].to_vec();
            let sigma = &mut phase.by_theta[layout.sigma() * n..(layout.sigma() + 1) * n];
            for j in 0..nq {
                for c in 0..n {
                    sigma[c] += gradient[j] * q_i[j * n + c] + gradient[nq + j] * qd_i[j * n + c];
                }
            }
        }
    }

    /// `row += scale · (local gradient)ᵀ ∂parameters/∂Θ`.
    fn project(&self, phase: usize, local: &[f64], scale: f64, row: &mut [f64]) {
        let p = &self.phases[phase];
        let n = row.len();
        for (l, g) in local.iter().enumerate() {
            let factor = scale * g;
            if factor != 0.0 {
                for (r, b) in row.iter_mut().zip(&p.by_theta[l * n..(l + 1) * n]) {
                    *r += factor * b;
                }
            }
        }
    }

    /// Gradient of inequality `i` in the local parameters of its half step.
    fn local_row(&self, phase: usize, node: usize, constraint: usize, local: &mut [f64]) {
        let p = &self.phases[phase];
        local.fill(0.0);
        self.path[constraint].partials(&p.instants, node, |quantity, partial| {
            for (l, g) in local.iter_mut().zip(p.instants.gradient(node, quantity)) {
                *l += partial * g;
            }
        });
    }

    fn impact_row(&self, phase: usize, constraint: usize, row: &mut [f64]) {
        let d = self.description();
        let (nq, nc, m) = (d.orientations(), d.positions(), self.per_phase());
        let p = &self.phases[phase];
        let impulse = &p.touchdown[nq..nq + nc];
        for (i, partial) in self.impact.partials(constraint, impulse).into_iter().enumerate() {
            if partial == 0.0 {
                continue;
            }
            let jacobian = &p.touchdown[nq + nc + 2 + (nq + i) * 2 * nq..][..2 * nq];
            for j in 0..nq {
                row[phase * m + theta_position(d, j)] += partial * jacobian[j];
                row[phase * m + nq + theta_position(d, j)] += partial * jacobian[nq + j];
            }
        }
    }
}

enum Row {
    Path { phase: usize, node: usize, constraint: usize },
    Impact { phase: usize, constraint: usize },
}

fn variables_per_phase(d: &Description) -> usize {
    2 * d.orientations() + d.prescribed() * (d.polynomial_order - 3) + 1
}

/// Position of coordinate `j` of q among (Q_f, β_f).
fn theta_position(d: &Description, j: usize) -> usize {
    match j.cmp(&d.unactuated) {
        std::cmp::Ordering::Less => j,
        std::cmp::Ordering::Equal => d.prescribed(),
        std::cmp::Ordering::Greater => j - 1,
    }
}

/// Where coordinate `k` comes from after a half step.
fn renamed(d: &Description, k: usize) -> (usize, f64) {
    match d.half_steps {
        HalfSteps::Mirrored => d.swapped(k),
        HalfSteps::Distinct => (k, 1.0),
    }
}

impl Phase {
    fn new(d: &Description, k: usize) -> Phase {
        let mesh = Mesh::new(ELEMENTS, d.polynomial_order);
        let leg = k;
        let layout = Layout::new(d, &mesh.basis);
        let (nq, nc) = (d.orientations(), d.positions());
        let n = d.phases() * variables_per_phase(d);
        Phase {
            leg,
            stance: Stance::new(d, &mesh, leg),
            instants: Instants::new(d, &mesh),
            layout,
            parameters: vec![0.0; layout.len()],
            by_theta: vec![0.0; layout.len() * n],
            cost: Integral::default(),
            q_final: vec![0.0; nq],
            qd_final: vec![0.0; nq],
            touchdown: vec![0.0; nq + nc + 2 + (nq + nc + 2) * 2 * nq],
            placement: vec![0.0; 2 * nc + 2 * nc * nq],
            momentum_start: vec![0.0; 1 + 2 * nq],
            momentum_end: vec![0.0; 1 + 2 * nq],
            distance: 0.0,
            distance_p: vec![0.0; layout.len()],
            mesh,
        }
    }

    /// Local parameters from the half step's own variables and its initial state.
    fn set_parameters(&mut self, d: &Description, own: &[f64], q: &[f64], qd: &[f64]) {
        let (nq, nt) = (d.orientations(), d.prescribed());
        let layout = self.layout;
        for j in 0..nt {
            let index = d.prescribed_index(j);
            self.parameters[layout.joint(j, 0)] = q[index];
            self.parameters[layout.joint(j, 1)] = qd[index];
            for i in 0..layout.per_joint - 4 {
                self.parameters[layout.joint(j, 2 + i)] = own[2 * nq + i * nt + j];
            }
            self.parameters[layout.joint(j, layout.per_joint - 2)] = own[j];
            self.parameters[layout.joint(j, layout.per_joint - 1)] = own[nq + j];
        }
        self.parameters[layout.duration()] = own[own.len() - 1];
        self.parameters[layout.beta()] = q[d.unactuated];
        self.parameters[layout.sigma()] = self.momentum_start[0];
    }

    fn differentiate(&mut self, gait: &dyn Gait) {
        let d = gait.description();
        self.stance.differentiate(gait, self.leg, &self.mesh, &self.parameters);
        self.instants.differentiate(d, &self.mesh, &self.stance, &self.parameters);
        let last = self.mesh.collocation() - 1;
        let mut start = vec![0.0; self.layout.len()];
        self.instants.platform_x_gradient(d, &self.mesh, &self.stance, &self.parameters, 0, &mut start);
        self.instants.platform_x_gradient(d, &self.mesh, &self.stance, &self.parameters, last, &mut self.distance_p);
        for (end, start) in self.distance_p.iter_mut().zip(&start) {
            *end -= start;
        }
    }
}

impl sqp::Problem for Cycle<'_> {
    fn variables(&self) -> usize {
        self.dimension()
    }

    fn equalities(&self) -> usize {
        CLOSURE * self.phases.len() + 1
    }

    fn inequalities(&self) -> usize {
        let at_start = self.path.iter().filter(|c| c.at_start).count();
        let path: usize = self.phases.iter().map(|p| at_start + (p.mesh.nodes.len() - 1) * self.path.len()).sum();
        path + self.phases.len() * self.impact.names().len()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        lower.fill(f64::NEG_INFINITY);
        upper.fill(f64::INFINITY);
        let m = self.per_phase();
        for k in 0..self.phases.len() {
            let [shortest, longest] = self.description().limits.half_step_duration;
            lower[(k + 1) * m - 1] = shortest;
            upper[(k + 1) * m - 1] = longest;
        }
    }

    fn evaluate(&mut self, x: &[f64], out: &mut sqp::Values) -> Result<(), sqp::Undefined> {
        self.simulate(x).map_err(|_| sqp::Undefined)?;
        self.collect(x, out);
        Ok(())
    }

    fn linearize(&mut self, _x: &[f64]) -> Result<(), sqp::Undefined> {
        self.differentiate_parameters();
        let gait = self.gait;
        for phase in &mut self.phases {
            phase.differentiate(gait);
        }
        // d(work/distance) = (d work − cost d distance)/distance
        let cost = self.work() / self.distance;
        let mut gradient = std::mem::take(&mut self.cost_gradient);
        gradient.fill(0.0);
        for k in 0..self.phases.len() {
            let p = &self.phases[k];
            let t = p.parameters[p.layout.duration()];
            let mut local = vec![0.0; p.layout.len()];
            for (node, quantity, partial) in &p.cost.partials {
                for (l, g) in local.iter_mut().zip(p.instants.gradient(*node, *quantity)) {
                    *l += t * partial * g;
                }
            }
            local[p.layout.duration()] += p.cost.value;
            for (l, g) in local.iter_mut().zip(&p.distance_p) {
                *l -= cost * g;
            }
            self.project(k, &local, 1.0 / self.distance, &mut gradient);
        }
        self.cost_gradient = gradient;
        Ok(())
    }

    fn gradient(&self, gradient: &mut [f64]) {
        gradient.copy_from_slice(&self.cost_gradient);
    }

    fn equality_row(&self, i: usize, row: &mut [f64]) {
        let d = self.description();
        let (nq, m) = (d.orientations(), self.per_phase());
        row.fill(0.0);
        let k = i / CLOSURE;
        if k == self.phases.len() {
            for (k, p) in self.phases.iter().enumerate() {
                self.project(k, &p.distance_p, 1.0 / d.leg_length(), row);
                row[(k + 1) * m - 1] -= self.speed / d.leg_length();
            }
            return;
        }
        let p = &self.phases[k];
        let np = p.layout.len();
        let last = (p.mesh.collocation() - 1) * np;
        match i % CLOSURE {
            0 => {
                self.project(k, &p.stance.beta_p[last..last + np], 1.0, row);
                row[k * m + d.prescribed()] -= 1.0;
            }
            1 => {
                self.project(k, &p.stance.sigma_p[last..last + np], 1.0, row);
                for j in 0..nq {
                    row[k * m + theta_position(d, j)] -= p.momentum_end[1 + j];
                    row[k * m + nq + theta_position(d, j)] -= p.momentum_end[1 + nq + j];
                }
            }
            _ => {
                let nc = d.positions();
                let gradient = &p.placement[2 * nc + nc * nq + nq..][..nq];
                for j in 0..nq {
                    row[k * m + theta_position(d, j)] += gradient[j] / d.leg_length();
                }
            }
        }
    }

    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        row.fill(0.0);
        match self.locate(i) {
            Row::Path { phase, node, constraint } => {
                let mut local = vec![0.0; self.phases[phase].layout.len()];
                self.local_row(phase, node, constraint, &mut local);
                self.project(phase, &local, 1.0, row);
            }
            Row::Impact { phase, constraint } => self.impact_row(phase, constraint, row),
        }
    }

    fn inequality_directions(&self, direction: &[f64], out: &mut [f64]) {
        let mut i = 0;
        let n = direction.len();
        for p in &self.phases {
            // The direction in local parameters, then in the quantities of each instant.
            let local: Vec<f64> =
                p.by_theta.chunks(n).map(|row| row.iter().zip(direction).map(|(a, b)| a * b).sum()).collect();
            let count = p.instants.quantities.len();
            let mut change = vec![0.0; count];
            for node in 0..p.mesh.nodes.len() {
                for (q, slot) in change.iter_mut().enumerate() {
                    *slot = p.instants.gradient(node, q).iter().zip(&local).map(|(a, b)| a * b).sum();
                }
                for constraint in self.path_at(node) {
                    let mut sum = 0.0;
                    constraint.partials(&p.instants, node, |quantity, partial| sum += partial * change[quantity]);
                    out[i] = sum;
                    i += 1;
                }
            }
        }
        let mut row = vec![0.0; n];
        for phase in 0..self.phases.len() {
            for constraint in 0..self.impact.names().len() {
                row.fill(0.0);
                self.impact_row(phase, constraint, &mut row);
                out[i] = row.iter().zip(direction).map(|(a, b)| a * b).sum();
                i += 1;
            }
        }
    }
}
