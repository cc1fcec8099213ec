//! The cycle as a nonlinear program.
//!
//! Path constraints are many and their gradients short (local parameters), so a row is projected to Θ
//! only when it is asked for. Everything that rows need is kept from the last linearization: trial
//! points in between do not disturb it.

use super::dip::Dip;
use super::phase::Phase;
use super::{Cycle, Label, renamed};
use crate::constraints::PathConstraint;
use crate::constraints::sharing::pitches;
use crate::cost::Drive;
use crate::lgl::NODES;
use piaffe_model::{Description, Limit};
use piaffe_sqp as sqp;
use piaffe_sqp::{Problem, Undefined, Values, dot};

/// Equalities of each half step: closure of β and of σ, touchdown.
pub const CLOSURE: usize = 3;

/// Number of equalities: those of each half step, the mean speed, and for real legs that impacts do not pitch the robot.
pub fn equalities(d: &Description) -> usize {
    let pitching = if pitches(d) { d.phases() } else { 0 };
    CLOSURE * d.phases() + 1 + pitching
}

/// Where an impact's change of angular momentum about the transverse axis stands among its results.
pub fn pitch(d: &Description) -> usize {
    d.shapes.touchdown_curvature.outputs.pitch.place(0)
}

/// What an inequality row is.
enum Row {
    Path { phase: usize, node: usize, constraint: usize },
    Dip { phase: usize, index: usize },
    Impact { phase: usize, constraint: usize },
}

/// Where an inequality row is imposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A path constraint at a share of a half step.
    Instant { phase: usize, share: f64, constraint: usize },
    /// A constraint on the impact that ends a half step.
    Impact { phase: usize, constraint: usize },
}

impl Cycle<'_> {
    /// Path constraints that are imposed at a node.
    fn path_at(&self, node: usize) -> impl Iterator<Item = &PathConstraint> {
        self.path.iter().filter(move |c| node > 0 || c.at_start)
    }

    /// Indices of the path constraints that are imposed at the first node.
    fn at_start(&self) -> impl Iterator<Item = usize> + '_ {
        self.path.iter().enumerate().filter(|(_, c)| c.at_start).map(|(k, _)| k)
    }

    /// Calls `visit(phase, node, constraint, row)` for every path row with a multiplier.
    pub(super) fn weighted_path_rows(&self, mu: &[f64], mut visit: impl FnMut(usize, usize, &PathConstraint, f64)) {
        let mut i = 0;
        for (k, phase) in self.phases.iter().enumerate() {
            for node in 0..phase.mesh.nodes.len() {
                for constraint in self.path_at(node) {
                    if mu[i] != 0.0 {
                        visit(k, node, constraint, mu[i]);
                    }
                    i += 1;
                }
            }
        }
    }

    /// Index of the first row of a dip.
    pub(super) fn first_dip_row(&self) -> usize {
        let at_start = self.at_start().count();
        self.phases.iter().map(|p| at_start + (p.mesh.nodes.len() - 1) * self.path.len()).sum()
    }

    /// Index of the first impact row.
    pub(super) fn first_impact_row(&self) -> usize {
        self.first_dip_row() + self.phases.iter().map(|p| p.dips.len()).sum::<usize>()
    }

    /// Calls `visit(index, multiplier)` for every dip of a half step with a multiplier.
    pub(super) fn weighted_dips(&self, phase: usize, mu: &[f64], mut visit: impl FnMut(&Dip, f64)) {
        let before: usize = self.phases[..phase].iter().map(|p| p.dips.len()).sum();
        for (dip, mu) in self.phases[phase].dips.iter().zip(&mu[self.first_dip_row() + before..]) {
            if *mu != 0.0 {
                visit(dip, *mu);
            }
        }
    }

    /// Of these multipliers those of the rows between nodes, per half step.
    pub fn dip_multipliers(&self, mu: &[f64]) -> Vec<Vec<f64>> {
        let mut rest = &mu[self.first_dip_row()..];
        let take = |phase: &Phase| {
            let (own, others) = rest.split_at(phase.dips.len());
            rest = others;
            own.to_vec()
        };
        self.phases.iter().map(take).collect()
    }

    fn locate(&self, i: usize) -> Row {
        let at_start = self.at_start().count();
        let mut rest = i;
        for (phase, p) in self.phases.iter().enumerate() {
            if rest < at_start {
                return Row::Path { phase, node: 0, constraint: self.at_start().nth(rest).unwrap_or(0) };
            }
            rest -= at_start;
            let others = (p.mesh.nodes.len() - 1) * self.path.len();
            if rest < others {
                return Row::Path { phase, node: 1 + rest / self.path.len(), constraint: rest % self.path.len() };
            }
            rest -= others;
        }
        for (phase, p) in self.phases.iter().enumerate() {
            if rest < p.dips.len() {
                return Row::Dip { phase, index: rest };
            }
            rest -= p.dips.len();
        }
        Row::Impact { phase: rest / self.impact.count(), constraint: rest % self.impact.count() }
    }

    /// Where inequality row `i` is imposed.
    pub fn place(&self, i: usize) -> Place {
        match self.locate(i) {
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

    /// The nodes of its half step at which inequality row `i` takes its values, with their weights; none of an impact.
    pub fn row_nodes(&self, i: usize) -> Vec<(usize, f64)> {
        match self.locate(i) {
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
                limit: self.path[constraint].limit,
                of: self.path[constraint].of.clone(),
                half_step: phase + 1,
                time: share * self.phases[phase].duration(),
            },
            Place::Impact { phase, constraint } => Label {
                limit: self.impact.limit(constraint),
                of: String::new(),
                half_step: phase + 1,
                time: self.phases[phase].duration(),
            },
        }
    }

    /// Which equality `i` is, in words.
    pub fn equality_label(&self, i: usize) -> Label {
        let closure = [Limit::ClosureOfBeta, Limit::ClosureOfSigma, Limit::Touchdown];
        let speed = self.speed_equation();
        let label = |limit, half_step, time| Label { limit, of: String::new(), half_step, time };
        let (limit, phase) = match i {
            _ if i < speed => (closure[i % CLOSURE], i / CLOSURE),
            _ if i == speed => return label(Limit::MeanSpeed, self.phases.len(), 0.0),
            _ if i < equalities(self.description()) => (Limit::Pitching, i - speed - 1),
            _ => {
                let held = self.holding().nth(i - equalities(self.description()));
                let (phase, joint, node) = held.unwrap_or_default();
                let of = self.description().joints[joint].name.into();
                let time = self.instant(phase, node) * self.phases[phase].duration();
                return Label { of, ..label(Limit::Still, phase + 1, time) };
            }
        };
        label(limit, phase + 1, self.phases[phase].duration())
    }

    /// The equality that is the mean speed.
    pub fn speed_equation(&self) -> usize {
        CLOSURE * self.phases.len()
    }

    /// Which variable's bound `i` is, in words: only durations are bounded.
    pub fn bound_label(&self, i: usize) -> Label {
        Label { limit: Limit::Duration, of: String::new(), half_step: i / self.variables.per_phase() + 1, time: 0.0 }
    }

    /// ∂(q_start, q̇_start)/∂Θ of every half step, from the impact's Jacobian.
    fn differentiate_starts(&mut self) {
        let d = self.description();
        let (nq, n) = (d.orientations(), self.variables.total());
        for k in 0..self.phases.len() {
            let before = self.before(k);
            let column = before * self.variables.per_phase();
            let mut table = std::mem::take(&mut self.phases[k].start_by_theta);
            table.fill(0.0);
            for row in 0..nq {
                let (from, sign) = renamed(d, row);
                table[row * n + column + self.variables.q(from)] = sign;
                let jacobian = self.phases[before].qd_plus_row(from);
                for j in 0..nq {
                    table[(nq + row) * n + column + self.variables.q(j)] = sign * jacobian[j];
                    table[(nq + row) * n + column + self.variables.qd(j)] = sign * jacobian[nq + j];
                }
            }
            self.phases[k].start_by_theta = table;
        }
    }

    /// d(work/duration) = (d work − mean d duration)/duration
    fn differentiate_cost(&mut self) {
        let (per_work, mean) = (self.per_work(), self.work() / self.duration);
        self.cost_gradient.fill(0.0);
        self.duration_gradient.fill(0.0);
        self.travel_gradient.fill(0.0);
        let m = self.variables.per_phase();
        let local = &mut self.workspace.local;
        for (k, p) in self.phases.iter().enumerate() {
            let t = p.duration();
            local.fill(0.0);
            for (node, quantity, partial) in &p.cost.partials {
                for (l, g) in local.iter_mut().zip(p.instants.gradient(*node, *quantity)) {
                    *l += t * partial * g;
                }
            }
            local[p.layout.duration()] += p.cost.value - mean;
            p.project(local, per_work, &mut self.cost_gradient);
            self.duration_gradient[k * m + self.variables.duration()] = 1.0;
            p.project(&p.travel_p, 1.0, &mut self.travel_gradient);
        }
    }

    fn differentiate_equalities(&mut self) {
        let d = self.description();
        let (nq, n, m) = (d.orientations(), self.variables.total(), self.variables.per_phase());
        let units = self.units;
        let (length, momentum) = (units.length, units.angular_momentum());
        let mut table = std::mem::take(&mut self.equality_rows);
        table.fill(0.0);
        let mut rows = table.chunks_mut(n);
        for (k, p) in self.phases.iter().enumerate() {
            let np = p.layout.len();
            let last = p.last() * np;
            let own = |index: usize| k * m + index;
            if let Some(row) = rows.next() {
                p.project(&p.stance.beta_p[last..last + np], 1.0, row);
                row[own(self.variables.q(d.unactuated))] -= 1.0;
            }
            if let Some(row) = rows.next() {
                p.project(&p.stance.sigma_p[last..last + np], 1.0 / momentum, row);
                let (by_q, by_qd) = p.shapes.momentum.sigma_w.of(&p.momentum_end).split_at(nq);
                for j in 0..nq {
                    row[own(self.variables.q(j))] -= by_q[j] / momentum;
                    row[own(self.variables.qd(j))] -= by_qd[j] / momentum;
                }
            }
            if let Some(row) = rows.next() {
                for (j, g) in p.landing_gradient().iter().enumerate() {
                    row[own(self.variables.q(j))] += g / length;
                }
            }
        }
        if let Some(row) = rows.next() {
            for (r, g) in row.iter_mut().zip(&self.travel_gradient) {
                *r = g / length;
            }
            for k in 0..self.phases.len() {
                row[k * m + self.variables.duration()] -= self.speed / length;
            }
        }
        let pitch = pitch(d);
        let pitching = if pitches(d) { self.phases.len() } else { 0 };
        for (k, (p, row)) in self.phases.iter().zip(rows.by_ref().take(pitching)).enumerate() {
            let jacobian = p.impact_row(pitch);
            for j in 0..nq {
                row[k * m + self.variables.q(j)] += jacobian[j] / momentum;
                row[k * m + self.variables.qd(j)] += jacobian[nq + j] / momentum;
            }
        }
        for (phase, joint, node) in self.holding() {
            let p = &self.phases[phase];
            let rate = p.instants.gradient(node, p.instants.quantities.rate(joint));
            if let Some(row) = rows.next() {
                p.project(rate, 1.0 / self.units.rate(), row);
            }
        }
        self.equality_rows = table;
    }

    fn differentiate_impacts(&mut self) {
        let d = self.description();
        let (nq, n, m) = (d.orientations(), self.variables.total(), self.variables.per_phase());
        self.impact_rows.fill(0.0);
        let count = self.impact.count();
        for (k, p) in self.phases.iter().enumerate() {
            for c in 0..count {
                let row = &mut self.impact_rows[(k * count + c) * n..][..n];
                self.impact.partials(c, &p.impact, |i, partial| {
                    let jacobian = p.impact_row(i);
                    for j in 0..nq {
                        row[k * m + self.variables.q(j)] += partial * jacobian[j];
                        row[k * m + self.variables.qd(j)] += partial * jacobian[nq + j];
                    }
                });
            }
        }
    }
}

impl Problem for Cycle<'_> {
    fn variables(&self) -> usize {
        self.dimension()
    }

    fn equalities(&self) -> usize {
        equalities(self.description()) + self.holding().count()
    }

    fn inequalities(&self) -> usize {
        self.first_impact_row() + self.phases.len() * self.impact.count()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let [shortest, longest] = self.description().limits.half_step_duration;
        let m = self.variables.per_phase();
        for k in 0..self.phases.len() {
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
        for (k, p) in self.phases.iter().enumerate() {
            let equalities = &mut out.equalities[k * CLOSURE..][..CLOSURE];
            equalities[0] = p.stance.beta[p.last()] - p.q_end[d.unactuated];
            equalities[1] = (p.stance.sigma[p.last()] - p.momentum_end[0]) / units.angular_momentum();
            equalities[2] = p.landing_height() / units.length;
        }
        let speed = self.speed_equation();
        let (own, holding) = out.equalities.split_at_mut(equalities(d));
        own[speed] = (self.travel - self.asked_travel()) / units.length;
        for (slot, p) in own[speed + 1..].iter_mut().zip(&self.phases) {
            *slot = p.impact[pitch(d)] / units.angular_momentum();
        }
        for (slot, (phase, joint, node)) in holding.iter_mut().zip(self.holding()) {
            let instants = &self.phases[phase].instants;
            *slot = instants.value(node, instants.quantities.rate(joint)) / self.units.rate();
        }
        let mut slots = out.inequalities.iter_mut();
        for p in &self.phases {
            for node in 0..p.mesh.nodes.len() {
                let y = p.instants.row(node);
                for (constraint, slot) in self.path_at(node).zip(&mut slots) {
                    *slot = constraint.value(y);
                }
            }
        }
        for p in &self.phases {
            for (dip, slot) in p.dips.iter().zip(&mut slots) {
                *slot = p.lowest(&self.path[dip.constraint], dip.element, dip.lowest.at).value + dip.offset;
            }
        }
        for p in &self.phases {
            for (c, slot) in (0..self.impact.count()).zip(&mut slots) {
                *slot = self.impact.value(c, &p.impact);
            }
        }
        Ok(())
    }

    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        let d = self.description();
        if self.linearized.is_empty() {
            self.linearized.extend_from_slice(x);
        }
        for ((moved, old), new) in self.moved.iter_mut().zip(&mut self.linearized).zip(x) {
            *moved = new - *old;
            *old = *new;
        }
        self.differentiate_starts();
        for (k, phase) in self.phases.iter_mut().enumerate() {
            phase.differentiate_parameters(d, &self.variables, k * self.variables.per_phase());
            phase.differentiate(self.gait, &self.path);
        }
        self.differentiate_cost();
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
        match self.locate(i) {
            Row::Path { phase, node, constraint } => {
                let p = &self.phases[phase];
                row.fill(0.0);
                self.path[constraint].partials(p.linearized(node), |quantity, partial| {
                    p.project(p.instants.gradient(node, quantity), partial, row);
                });
            }
            Row::Dip { phase, index } => {
                let p = &self.phases[phase];
                let dip = &p.dips[index];
                row.fill(0.0);
                for (i, share) in dip.lowest.shape.iter().enumerate().take(NODES) {
                    let node = dip.first() + i;
                    self.path[dip.constraint].partials(p.linearized(node), |quantity, partial| {
                        p.project(p.instants.gradient(node, quantity), share * partial, row);
                    });
                }
            }
            Row::Impact { phase, constraint } => {
                let index = phase * self.impact.count() + constraint;
                row.copy_from_slice(&self.impact_rows[index * row.len()..][..row.len()]);
            }
        }
    }

    fn inequality_directions(&self, direction: &[f64], out: &mut [f64]) {
        let n = direction.len();
        let mut slots = out.iter_mut();
        let mut local = smallvec::SmallVec::<[f64; 64]>::new();
        let mut change = smallvec::SmallVec::<[f64; 32]>::new();
        for p in &self.phases {
            // The direction in local parameters, then in the quantities of each instant.
            local.clear();
            local.extend(p.by_theta.chunks(n).map(|row| dot(row, direction)));
            for node in 0..p.mesh.nodes.len() {
                change.clear();
                change.extend(p.instants.gradients(node).chunks(local.len()).map(|g| dot(g, &local)));
                let y = p.linearized(node);
                for (constraint, slot) in self.path_at(node).zip(&mut slots) {
                    let mut sum = 0.0;
                    constraint.partials(y, |quantity, partial| sum += partial * change[quantity]);
                    *slot = sum;
                }
            }
        }
        for p in &self.phases {
            local.clear();
            local.extend(p.by_theta.chunks(n).map(|row| dot(row, direction)));
            for (dip, slot) in p.dips.iter().zip(&mut slots) {
                let mut sum = 0.0;
                for (i, share) in dip.lowest.shape.iter().enumerate().take(NODES) {
                    let node = dip.first() + i;
                    self.path[dip.constraint].partials(p.linearized(node), |quantity, partial| {
                        sum += share * partial * dot(p.instants.gradient(node, quantity), &local);
                    });
                }
                *slot = sum;
            }
        }
        for (row, slot) in self.impact_rows.chunks(n).zip(slots) {
            *slot = dot(row, direction);
        }
    }

    fn kinks(&self) -> usize {
        self.resting().count()
    }

    fn kink(&self, i: usize, row: &mut [f64]) -> f64 {
        let Some((phase, joint, node)) = self.resting().nth(i) else { return 0.0 };
        let p = &self.phases[phase];
        let y = p.instants.quantities;
        row.fill(0.0);
        p.project(p.instants.gradient(node, y.rate(joint)), 1.0, row);
        // Of all joints that this one stands for.
        let drives = Drive::all(self.description());
        let torques =
            drives.iter().filter(|drive| drive.rate() == y.rate(joint)).map(|d| d.torque(p.linearized(node)).abs());
        p.mesh.weights[node] * p.duration() * torques.sum::<f64>() * self.per_work()
    }

    fn hessian(&mut self, equality_multipliers: &[f64], inequality_multipliers: &[f64], hessian: &mut [f64]) -> bool {
        self.lagrangian_hessian(equality_multipliers, inequality_multipliers, hessian);
        true
    }
}
