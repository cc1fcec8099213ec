//! The cycle as a nonlinear program.
//!
//! Path constraints are many and their gradients short (local parameters), so a row is projected to Θ
//! only when it is asked for. Everything that rows need is kept from the last linearization: trial
//! points in between do not disturb it.

use super::dip::Dip;
use super::hessian::Workspace;
use super::rows::{Equation, Row};
use super::{Cycle, Label};
use crate::constraints::{ImpactConstraints, PathConstraint};
use crate::cost::Drive;
use piaffe_model::Limit;
use piaffe_sqp as sqp;
use piaffe_sqp::{Problem, Undefined, Values, axpy, dot, multiply};
use smallvec::SmallVec;

/// Where an inequality row is imposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A path constraint at a share of a phase.
    Instant { phase: usize, share: f64, constraint: usize },
    /// A constraint on the impact that ends a phase.
    Impact { phase: usize, constraint: usize },
}

impl Cycle<'_> {
    /// Calls `visit(node, constraint, multiplier)` for every path row of phase `k` with a multiplier.
    pub(super) fn weighted_path_rows(&self, k: usize, mu: &[f64], mut visit: impl FnMut(usize, &PathConstraint, f64)) {
        let range = self.rows.of(k).path.clone();
        for (row, multiplier) in range.clone().zip(&mu[range]).filter(|(_, multiplier)| **multiplier != 0.0) {
            if let Row::Path { node, constraint, .. } = self.rows.inequalities[row] {
                visit(node, &self.phases[k].path[constraint], *multiplier);
            }
        }
    }

    /// Calls `visit(dip, multiplier)` for every dip of a phase with a multiplier.
    pub(super) fn weighted_dips(&self, phase: usize, mu: &[f64], mut visit: impl FnMut(&Dip, f64)) {
        for (dip, mu) in self.phases[phase].dips.iter().zip(&mu[self.rows.of(phase).dips.clone()]) {
            if *mu != 0.0 {
                visit(dip, *mu);
            }
        }
    }

    /// Calls `visit(impact, row, multiplier)` for every row of the impact at the end of a phase with a multiplier.
    pub(super) fn weighted_impacts(
        &self,
        phase: usize,
        mu: &[f64],
        mut visit: impl FnMut(&ImpactConstraints, usize, f64),
    ) {
        let Some(impact) = &self.phases[phase].impact else { return };
        for (row, mu) in mu[self.rows.of(phase).impacts.clone()].iter().enumerate() {
            if *mu != 0.0 {
                visit(impact, row, *mu);
            }
        }
    }

    /// Of these multipliers those of the rows between nodes, per phase.
    pub fn dip_multipliers(&self, mu: &[f64]) -> Vec<Vec<f64>> {
        (0..self.phases.len()).map(|k| mu[self.rows.of(k).dips.clone()].to_vec()).collect()
    }

    /// Where inequality row `i` is imposed.
    pub fn place(&self, i: usize) -> Place {
        match self.rows.inequalities[i] {
            Row::Path { phase, node, constraint } => {
                Place::Instant { phase, share: self.phases[phase].mesh.nodes[node].0, constraint }
            }
            Row::Dip { phase, index } => {
                let p = &self.phases[phase];
                let dip = &p.dips[index];
                let share = (dip.element as f64 + dip.lowest.at) / p.mesh.elements as f64;
                Place::Instant { phase, share, constraint: dip.constraint }
            }
            Row::Impact { phase, constraint } => Place::Impact { phase, constraint },
        }
    }

    /// How inequality row `i` depends on a joint's rate besides, where it is imposed at a turn: node, quantity, derivative.
    pub fn row_turn(&self, i: usize) -> Vec<(usize, usize, f64)> {
        let Row::Dip { phase, index } = self.rows.inequalities[i] else { return Vec::new() };
        self.phases[phase].dips[index].of_turn().collect()
    }

    /// The nodes of its phase at which inequality row `i` takes its values, with their weights; none of an impact.
    pub fn row_nodes(&self, i: usize) -> Vec<(usize, f64)> {
        match self.rows.inequalities[i] {
            Row::Path { node, .. } => vec![(node, 1.0)],
            Row::Dip { phase, index } => {
                let dip = &self.phases[phase].dips[index];
                (dip.first()..).zip(dip.lowest.shape).collect()
            }
            Row::Impact { .. } => Vec::new(),
        }
    }

    /// Which constraint inequality row `i` is, in words.
    pub fn label(&self, i: usize) -> Label {
        match self.place(i) {
            Place::Instant { phase, share, constraint } => Label {
                limit: self.phases[phase].path[constraint].limit,
                of: self.phases[phase].path[constraint].of.clone(),
                phase: phase + 1,
                time: share * self.phases[phase].duration(),
            },
            Place::Impact { phase, constraint } => Label {
                limit: self.phases[phase].impact.as_ref().map_or(Limit::Touchdown, |impact| impact.limit(constraint)),
                of: String::new(),
                phase: phase + 1,
                time: self.phases[phase].duration(),
            },
        }
    }

    /// Which equality `i` is, in words.
    pub fn equality_label(&self, i: usize) -> Label {
        let label = |limit, phase, time| Label { limit, of: String::new(), phase, time };
        let at_end = |limit, phase: usize| label(limit, phase + 1, self.phases[phase].duration());
        match self.rows.equations[i] {
            Equation::ClosureOfBeta(phase) => at_end(Limit::ClosureOfBeta, phase),
            Equation::ClosureOfSigma(phase) => at_end(Limit::ClosureOfSigma, phase),
            Equation::Touchdown(phase) => at_end(Limit::Touchdown, phase),
            Equation::MeanSpeed => label(Limit::MeanSpeed, self.phases.len(), 0.0),
            Equation::Still { phase, joint, node } => {
                let of = self.description().joints[joint].name.into();
                let time = self.instant(phase, node) * self.phases[phase].duration();
                Label { of, ..label(Limit::Still, phase + 1, time) }
            }
        }
    }

    /// What the equalities are, in their order.
    pub fn equations(&self) -> &[Equation] {
        &self.rows.equations
    }

    /// The equality that is the mean speed.
    pub fn speed_equation(&self) -> usize {
        self.rows.speed
    }

    /// Which variable's bound `i` is, in words: only durations are bounded.
    pub fn bound_label(&self, i: usize) -> Label {
        Label { limit: Limit::Duration, of: String::new(), phase: i / self.variables.per_phase() + 1, time: 0.0 }
    }

    /// ∂parameters/∂Θ of every phase. Flights come first: of a landing, the initial state of the next phase depends on the parabola.
    fn differentiate_parameters(&mut self) {
        let n = self.variables.total();
        for k in self.flights().chain(self.stances()) {
            self.differentiate_start(k);
            let before = self.before(k);
            let first = before * self.variables.per_phase();
            let d = self.gait.description();
            // A flight never follows itself, and what is not one has no need of the transition before.
            match self.phases.get_disjoint_mut([k, before]) {
                Ok([phase, b]) => phase.differentiate_parameters(d, &self.variables, Some((&b.crossing, first))),
                Err(_) => self.phases[k].differentiate_parameters(d, &self.variables, None),
            }
            self.phases[k].differentiate_centre(d, n);
        }
    }

    /// ∂(q_start, q̇_start)/∂Θ of a phase, from the transition before it.
    fn differentiate_start(&mut self, k: usize) {
        let d = self.description();
        let (nq, n) = (d.orientations(), self.variables.total());
        let before = self.before(k);
        let place = self.end_state(before);
        let mut table = std::mem::take(&mut self.phases[k].start_by_theta);
        let b = &self.phases[before];
        table.fill(0.0);
        for row in 0..nq {
            let (from, sign) = d.renamed(before, row);
            table[row * n + place(from)] = sign;
            let rate = &mut table[(nq + row) * n..][..n];
            match b.crossing.qd_plus() {
                Some(_) => b.crossing.add_gradient(b.crossing.qd_plus_row(from), sign, &place, rate),
                None => rate[place(nq + from)] = sign,
            }
        }
        self.phases[k].start_by_theta = table;
    }

    /// Which variable is which entry of (q, q̇) at the wanted end of a phase.
    pub(super) fn end_state(&self, phase: usize) -> impl Fn(usize) -> usize + use<> {
        let (variables, nq) = (self.variables.clone(), self.description().orientations());
        let first = phase * variables.per_phase();
        move |k| first + if k < nq { variables.q(k) } else { variables.qd(k - nq) }
    }

    /// d(work/duration) = (d work − mean d duration)/duration
    fn differentiate_cost(&mut self) {
        let (per_work, mean) = (self.per_work(), self.work() / self.duration);
        self.cost_gradient.fill(0.0);
        self.duration_gradient.fill(0.0);
        self.travel_gradient.fill(0.0);
        let (d, m) = (self.gait.description(), self.variables.per_phase());
        let Workspace { local, states, .. } = &mut self.workspace;
        for (k, p) in self.phases.iter_mut().enumerate() {
            let (t, width) = (p.duration(), p.instants.width());
            let states = &mut states[..p.mesh.nodes.len() * width];
            states.fill(0.0);
            for (node, quantity, partial) in &p.cost.partials {
                axpy(*partial, p.instants.gradient(*node, *quantity), &mut states[node * width..][..width]);
            }
            let local = &mut local[..p.layout.len()];
            local.fill(0.0);
            for (node, state) in states.chunks(width).enumerate() {
                p.pull(d, node, state, local);
            }
            p.cost_p.copy_from_slice(local);
            local.iter_mut().for_each(|x| *x *= t);
            local[p.layout.duration()] += p.cost.value - mean;
            p.by_theta.pull(local, per_work, &mut self.cost_gradient);
            self.duration_gradient[k * m + self.variables.duration()] = 1.0;
            p.by_theta.pull(&p.travel_p, 1.0, &mut self.travel_gradient);
        }
    }

    fn differentiate_equalities(&mut self) {
        let d = self.description();
        let (n, m) = (self.variables.total(), self.variables.per_phase());
        let units = self.units;
        let (length, momentum) = (units.length, units.angular_momentum());
        let mut table = std::mem::take(&mut self.equality_rows);
        let mut local = std::mem::take(&mut self.workspace.local);
        table.fill(0.0);
        for (equation, row) in self.rows.equations.iter().zip(table.chunks_mut(n)) {
            let at_end = |k: usize| {
                let p = &self.phases[k];
                let np = p.layout.len();
                (p, p.last() * np..(p.last() + 1) * np, self.end_state(k))
            };
            match *equation {
                Equation::ClosureOfBeta(k) => {
                    let (p, last, place) = at_end(k);
                    p.by_theta.pull(&p.flow.beta_p[last], 1.0, row);
                    row[place(d.unactuated)] -= 1.0;
                }
                Equation::ClosureOfSigma(k) => {
                    let (p, last, place) = at_end(k);
                    p.by_theta.pull(&p.flow.sigma_p[last], 1.0 / momentum, row);
                    for (j, by) in p.shapes.momentum.sigma_w.of(&p.momentum_end).iter().enumerate() {
                        row[place(j)] -= by / momentum;
                    }
                }
                Equation::Touchdown(k) => {
                    let (p, _, place) = at_end(k);
                    let foot = p.landing_foot.unwrap_or_default();
                    for (j, g) in p.landing_gradient(foot).iter().enumerate() {
                        row[place(j)] += g / length;
                    }
                    if let Some(fall) = p.fall(d) {
                        let local = &mut local[..p.layout.len()];
                        local.fill(0.0);
                        fall.add_height_gradient(1.0, 1.0 / length, &mut local[p.layout.duration()..]);
                        p.by_theta.pull(local, 1.0, row);
                    }
                }
                Equation::MeanSpeed => {
                    for (r, g) in row.iter_mut().zip(&self.travel_gradient) {
                        *r = g / length;
                    }
                    for k in 0..self.phases.len() {
                        row[k * m + self.variables.duration()] -= self.speed / length;
                    }
                }
                Equation::Still { phase, joint, node } => {
                    let p = &self.phases[phase];
                    let local = &mut local[..p.layout.len()];
                    local.fill(0.0);
                    p.add_quantity(d, node, p.instants.quantities.rate(joint), 1.0 / units.rate(), local);
                    p.by_theta.pull(local, 1.0, row);
                }
            }
        }
        self.equality_rows = table;
        self.workspace.local = local;
    }

    fn differentiate_impacts(&mut self) {
        let n = self.variables.total();
        let mut table = std::mem::take(&mut self.impact_rows);
        table.fill(0.0);
        let mut rows = table.chunks_mut(n);
        for (k, p) in self.phases.iter().enumerate() {
            let Some(impact) = &p.impact else { continue };
            let place = self.end_state(k);
            for (c, row) in (0..impact.count()).zip(&mut rows) {
                impact.partials(c, &p.crossing.outputs, |i, partial| {
                    p.crossing.add_gradient(p.crossing.output_row(i), partial, &place, row);
                });
            }
        }
        self.impact_rows = table;
    }
}

impl Problem for Cycle<'_> {
    fn variables(&self) -> usize {
        self.dimension()
    }

    fn equalities(&self) -> usize {
        self.rows.equations.len()
    }

    fn inequalities(&self) -> usize {
        self.rows.inequalities.len()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let m = self.variables.per_phase();
        for (k, phase) in self.description().phases.iter().enumerate() {
            let [shortest, longest] = phase.duration;
            lower[k * m + self.variables.duration()] = shortest;
            upper[k * m + self.variables.duration()] = longest;
        }
    }

    /// The mean speed is met relative to the speed asked.
    fn strictness(&self, i: usize) -> f64 {
        if i == self.speed_equation() { self.froude().min(1.0) } else { 1.0 }
    }

    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        self.simulate(x).map_err(|_| sqp::Undefined)?;
        let d = self.description();
        let units = &self.units;
        out.objective = self.objective();
        for (equation, slot) in self.rows.equations.iter().zip(&mut out.equalities) {
            *slot = match *equation {
                Equation::ClosureOfBeta(k) => {
                    let p = &self.phases[k];
                    p.flow.beta[p.last()] - p.q_end[d.unactuated]
                }
                Equation::ClosureOfSigma(k) => {
                    let p = &self.phases[k];
                    (p.flow.sigma[p.last()] - p.momentum_end[0]) / units.angular_momentum()
                }
                Equation::Touchdown(k) => {
                    let p = &self.phases[k];
                    p.landing_height(d, p.landing_foot.unwrap_or_default()) / units.length
                }
                Equation::MeanSpeed => (self.travel - self.asked_travel()) / units.length,
                Equation::Still { phase, joint, node } => {
                    let instants = &self.phases[phase].instants;
                    instants.value(node, instants.quantities.rate(joint)) / units.rate()
                }
            };
        }
        for (k, p) in self.phases.iter().enumerate() {
            let rows = self.rows.of(k);
            let mut slots = out.inequalities[rows.path.clone()].iter_mut();
            for node in 0..p.mesh.nodes.len() {
                let y = p.instants.row(node);
                let imposed = p.path.iter().filter(|c| c.is_imposed(node));
                for (constraint, slot) in imposed.zip(&mut slots) {
                    *slot = constraint.value(y);
                }
            }
            for (dip, slot) in p.dips.iter().zip(&mut out.inequalities[rows.dips.clone()]) {
                *slot = p.lowest(&p.path[dip.constraint], dip.element, dip.lowest.at).value + dip.offset;
            }
            if let Some(impact) = &p.impact {
                for (c, slot) in out.inequalities[rows.impacts.clone()].iter_mut().enumerate() {
                    *slot = impact.value(c, &p.crossing.outputs);
                }
            }
        }
        Ok(())
    }

    fn linearize(&mut self, _: &[f64]) -> Result<(), Undefined> {
        self.differentiate_parameters();
        for phase in &mut self.phases {
            phase.differentiate(self.gait);
        }
        self.differentiate_cost();
        self.divide_criterion();
        self.differentiate_equalities();
        self.differentiate_impacts();
        Ok(())
    }

    fn gradient(&self, gradient: &mut [f64]) {
        gradient.copy_from_slice(&self.cost_gradient);
    }

    fn equality_row(&self, i: usize, row: &mut [f64]) {
        row.copy_from_slice(&self.equality_rows[i * row.len()..][..row.len()]);
    }

    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        let d = self.description();
        row.fill(0.0);
        match self.rows.inequalities[i] {
            Row::Path { phase, node, constraint } => {
                let p = &self.phases[phase];
                let mut local = p.no_parameters();
                p.add_constraint(d, node, &p.path[constraint], 1.0, &mut local);
                p.by_theta.pull(&local, 1.0, row);
            }
            Row::Dip { phase, index } => {
                let p = &self.phases[phase];
                let dip = &p.dips[index];
                let mut local = p.no_parameters();
                for (i, share) in dip.lowest.shape.iter().enumerate() {
                    p.add_constraint(d, dip.first() + i, &p.path[dip.constraint], *share, &mut local);
                }
                dip.of_turn().for_each(|(node, quantity, by)| p.add_quantity(d, node, quantity, by, &mut local));
                p.by_theta.pull(&local, 1.0, row);
            }
            Row::Impact { phase, constraint } => {
                let first = self.rows.inequalities.len() - self.rows.impacts();
                let index = self.rows.of(phase).impacts.start - first + constraint;
                row.copy_from_slice(&self.impact_rows[index * row.len()..][..row.len()]);
            }
        }
    }

    fn directions(&self, direction: &[f64], out: &mut [f64], folds: &mut [f64]) {
        let d = self.description();
        let mut change = SmallVec::<[f64; 32]>::new();
        let total = dot(&self.duration_gradient, direction);
        folds.fill(0.0);
        let mut folds = folds;
        for (k, p) in self.phases.iter().enumerate() {
            let rows = self.rows.of(k);
            // The direction in local parameters, then in the state and the quantities of each instant.
            let local: SmallVec<[f64; 64]> = p.by_theta.push(direction).collect();
            let mut state = SmallVec::<[f64; 32]>::from_elem(0.0, p.instants.width());
            let mut dips = SmallVec::<[f64; 16]>::from_elem(0.0, p.dips.len());
            change.resize(p.instants.quantities.len(), 0.0);
            let mut slots = out[rows.path.clone()].iter_mut();
            let (parts, rest) = folds.split_at_mut(p.folds().min(folds.len()));
            folds = rest;
            for node in 0..p.mesh.nodes.len() {
                p.instants.chain(d, &p.flow, node).push(&local, &mut state);
                multiply(p.instants.gradients(node), &state, &mut change);
                let y = p.linearized(node);
                let along = |constraint: &PathConstraint| {
                    let mut sum = 0.0;
                    constraint.partials(y, |quantity, partial| sum += partial * change[quantity]);
                    sum
                };
                let imposed = p.path.iter().filter(|c| c.is_imposed(node));
                imposed.zip(&mut slots).for_each(|(constraint, slot)| *slot = along(constraint));
                for (dip, sum) in p.dips.iter().zip(&mut dips) {
                    if let Some(share) = node.checked_sub(dip.first()).and_then(|i| dip.lowest.shape.get(i)) {
                        *sum += share * along(&p.path[dip.constraint]);
                        let here = dip.of_turn().filter(|(other, ..)| *other == node);
                        here.for_each(|(_, quantity, by)| *sum += by * change[quantity]);
                    }
                }
                if !parts.is_empty() {
                    p.add_changes(node, &change, parts);
                }
            }
            p.add_stretch([local[p.layout.duration()], total], parts);
            out[rows.dips.clone()].copy_from_slice(&dips);
        }
        let first = out.len() - self.rows.impacts();
        multiply(&self.impact_rows, direction, &mut out[first..]);
    }

    fn kinks(&self) -> usize {
        self.resting().count()
    }

    fn kink(&self, i: usize, row: &mut [f64]) -> f64 {
        let Some((phase, joint, node)) = self.resting().nth(i) else { return 0.0 };
        let p = &self.phases[phase];
        let y = p.instants.quantities;
        let mut local = p.no_parameters();
        p.add_quantity(self.description(), node, y.rate(joint), 1.0, &mut local);
        row.fill(0.0);
        p.by_theta.pull(&local, 1.0, row);
        // Of all joints that this one stands for.
        let drives = Drive::all(self.description(), p.mode);
        let torques = drives
            .iter()
            .filter(|drive| drive.joint == joint)
            .map(|drive| drive.torque(p.linearized(node), 0.0).abs().max(drive.coulomb()));
        p.mesh.weights[node] * p.duration() * torques.sum::<f64>() * self.per_work()
    }

    fn folds(&self) -> usize {
        self.count_folds()
    }

    fn fold(&self, i: usize) -> Option<f64> {
        self.value_of_fold(i)
    }

    fn fold_row(&self, i: usize, row: &mut [f64]) {
        self.write_fold(i, row);
    }

    fn hessian(&mut self, equality_multipliers: &[f64], inequality_multipliers: &[f64], hessian: &mut [f64]) -> bool {
        self.lagrangian_hessian(equality_multipliers, inequality_multipliers, hessian);
        true
    }
}
