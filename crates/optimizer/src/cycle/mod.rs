//! Θ → the whole periodic motion: torques, reactions, criterion, every constraint, exact derivatives (§5).
//!
//! Variables, per phase of the gait: Q_f, β_f, Q̇_f, β̇_f, interior values of Q, T. The
//! initial state of a phase follows from the final state of the one before: same configuration,
//! velocities after the impact if there is one, legs renamed where the gait mirrors itself (eq. 16, 18, 19); and in flight the mass
//! centre's parabola. Equalities: β̇ and β close the cycle (eq. 23, 24; the former as σ), feet land where they shall, and the
//! mean speed is the given one.
//!
//! `phase` is one phase, `by_theta` how its parameters depend on Θ, `crossing` how it ends, `dip` a constraint between its nodes,
//! `still` a joint that it holds, `halt` one that just does not turn around, `fold` where the criterion will bend, `rows` which equation
//! and which limit is which row, `problem` the nonlinear program, `hessian` its second derivatives.

mod by_theta;
mod crossing;
mod dip;
mod fold;
mod halt;
mod hessian;
mod phase;
mod problem;
mod rows;
mod sample;
mod still;

use crate::constraints::PathConstraint;
use crate::cost::{Integral, integrate};
use crate::flow::Undefined;
use crate::instant::Glance;
use crate::lgl::NODES;
use dip::{Dip, Lowest};
pub use halt::Halt;
use hessian::Workspace;
use phase::Phase;
use piaffe_model::motion::{Costs, Course, Criterion, Motion};
use piaffe_model::units::Units;
use piaffe_model::{Description, Gait, Limit};
pub use problem::Place;
pub use rows::Equation;
use rows::Rows;
pub use sample::Sample;
pub use still::{AT_REST, Still};

/// Elements per phase, of 4 intervals each: more where the polynomials of eq. 15 may bend more often.
///
/// With so many, least criteria of most robots are within 3·10⁻⁷ of those on finer meshes; see [`Cycle::finer`].
pub fn elements(d: &Description) -> usize {
    d.polynomial_order + 1
}

/// Elements are halved where that changes β or β̇ at the end of a phase by more than this, in the robot's units, or at low
/// speeds by more than this times twice the speed: the travel has to be the one asked, however short it is;
const RESOLUTION: f64 = 1e-7;
/// until there are so many times as many.
const FINEST: usize = 8;

/// Natural sizes of the variables, in the robot's units: angles, rates, durations.
const ANGLE: f64 = 0.3;
const RATE: f64 = 0.525;
const DURATION: f64 = 0.57;

/// A phase shorter than this, in the robot's unit of time, is no motion.
const SHORTEST: f64 = 5e-4;

/// Speeds below this, in the robot's unit, are met as closely as positions are known, not as closely as others.
const SLOWEST: f64 = 1e-7;

/// The optimization problem of one gait, criterion and speed.
pub struct Cycle<'a> {
    gait: &'a dyn Gait,
    pub criterion: Criterion,
    /// Mean forward speed, m/s.
    pub speed: f64,
    /// Rounds off the kinks of |power|, in the robot's unit of power; 0 for the criterion itself.
    pub smoothing: f64,
    units: Units,
    variables: Variables,
    phases: Vec<Phase>,
    rows: Rows,
    /// Held joints are held by equations; else by what their power costs.
    by_equations: bool,
    /// No accelerations: as many zeros as q has entries.
    still: Vec<f64>,
    /// Forward travel in all phases, m, and how long they take, s.
    travel: f64,
    duration: f64,

    // Derivatives of the last linearization, in Θ.
    cost_gradient: Vec<f64>,
    duration_gradient: Vec<f64>,
    travel_gradient: Vec<f64>,
    equality_rows: Vec<f64>,
    impact_rows: Vec<f64>,
    workspace: Workspace,
}

/// Where the variables of a phase stand among its own.
#[derive(Clone, Debug)]
pub struct Variables {
    orientations: usize,
    prescribed: usize,
    unactuated: usize,
    interior: usize,
    phases: usize,
}

impl Variables {
    pub fn new(d: &Description) -> Variables {
        Variables {
            orientations: d.orientations(),
            prescribed: d.prescribed(),
            unactuated: d.unactuated,
            interior: d.polynomial_order - 3,
            phases: d.phases.len(),
        }
    }

    /// Coordinate `k` of q at the end: Q_f, then β_f.
    pub fn q(&self, k: usize) -> usize {
        match k.cmp(&self.unactuated) {
            std::cmp::Ordering::Less => k,
            std::cmp::Ordering::Equal => self.prescribed,
            std::cmp::Ordering::Greater => k - 1,
        }
    }

    /// Its rate: Q̇_f, then β̇_f.
    pub fn qd(&self, k: usize) -> usize {
        self.orientations + self.q(k)
    }

    /// Interior value `i` of the j-th prescribed coordinate.
    pub fn interior(&self, i: usize, j: usize) -> usize {
        2 * self.orientations + i * self.prescribed + j
    }

    pub fn duration(&self) -> usize {
        2 * self.orientations + self.interior * self.prescribed
    }

    /// Variables of one phase.
    pub fn per_phase(&self) -> usize {
        self.duration() + 1
    }

    pub fn total(&self) -> usize {
        self.phases * self.per_phase()
    }

    /// q and q̇ at the end of a phase.
    pub fn end_state(&self, own: &[f64], q: &mut [f64], qd: &mut [f64]) {
        for k in 0..self.orientations {
            q[k] = own[self.q(k)];
            qd[k] = own[self.qd(k)];
        }
    }
}

/// Which constraint a row is.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub limit: Limit,
    /// What it is of; empty where there is but one.
    pub of: String,
    /// 1-based.
    pub phase: usize,
    /// s.
    pub time: f64,
}

impl Label {
    /// In words, as reports show it.
    pub fn name(&self) -> String {
        self.limit.of(&self.of)
    }
}

impl<'a> Cycle<'a> {
    pub fn new(gait: &'a dyn Gait, criterion: Criterion, speed: f64) -> Cycle<'a> {
        Self::with_elements(gait, criterion, speed, elements(gait.description()))
    }

    /// The same with another number of elements per phase: few will do far from an optimum.
    pub fn with_elements(gait: &'a dyn Gait, criterion: Criterion, speed: f64, elements: usize) -> Cycle<'a> {
        let d = gait.description();
        let variables = Variables::new(d);
        let phases: Vec<Phase> = (0..d.phases.len()).map(|k| Phase::new(d, k, elements)).collect();
        let rows = Rows::new(&phases, &[]);
        let n = variables.total();
        Cycle {
            gait,
            criterion,
            speed,
            smoothing: 0.0,
            units: Units::new(d),
            cost_gradient: vec![0.0; n],
            duration_gradient: vec![0.0; n],
            travel_gradient: vec![0.0; n],
            equality_rows: vec![0.0; n * rows.equations.len()],
            impact_rows: vec![0.0; n * rows.impacts()],
            workspace: Workspace::new(d, &variables, &phases),
            variables,
            phases,
            rows,
            by_equations: true,
            still: vec![0.0; d.orientations()],
            travel: 0.0,
            duration: 0.0,
        }
    }

    /// The problem on a mesh that resolves a motion.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    pub fn resolving(
        gait: &'a dyn Gait,
        criterion: Criterion,
        speed: f64,
        theta: &[f64],
    ) -> Result<Cycle<'a>, Undefined> {
        let mut cycle = Cycle::new(gait, criterion, speed);
        cycle.simulate(theta)?;
        while let Some(finer) = cycle.finer() {
            cycle = finer;
            cycle.simulate(theta)?;
        }
        Ok(cycle)
    }

    /// The problem with twice as many elements, if these do not resolve the last simulated motion.
    pub fn finer(&self) -> Option<Cycle<'a>> {
        let resolution = RESOLUTION * (2.0 * self.froude()).min(1.0);
        // What a finer mesh has no motion for is not resolved either.
        let coarse = |p: &Phase| !p.mesh_error(self.gait, &self.units).is_ok_and(|error| error <= resolution);
        if self.phases.iter().any(coarse) { self.twice_as_fine() } else { None }
    }

    /// The problem with twice as many elements, if there may be so many.
    pub fn twice_as_fine(&self) -> Option<Cycle<'a>> {
        let present = self.phases[0].mesh.elements;
        let some = present < FINEST * elements(self.description());
        some.then(|| {
            let mut finer = Cycle::with_elements(self.gait, self.criterion, self.speed, 2 * present);
            finer.hold(&self.held().collect::<Vec<_>>());
            finer
        })
    }

    pub fn description(&self) -> &'a Description {
        self.gait.description()
    }

    pub fn gait(&self) -> &'a dyn Gait {
        self.gait
    }

    /// Number of phases that define the gait.
    pub fn phases(&self) -> usize {
        self.phases.len()
    }

    /// Number of collocation nodes of a phase.
    pub fn nodes(&self, phase: usize) -> usize {
        self.phases[phase].mesh.nodes.len()
    }

    /// Node `node` as a share of its phase.
    pub fn instant(&self, phase: usize, node: usize) -> f64 {
        self.phases[phase].mesh.nodes[node].0
    }

    /// All path constraints of an instant of a phase.
    pub fn path(&self, phase: usize) -> &[PathConstraint] {
        &self.phases[phase].path
    }

    /// The quantities of a node in the last simulated motion.
    pub fn quantities(&self, phase: usize, node: usize) -> &[f64] {
        self.phases[phase].instants.row(node)
    }

    /// Looks at share `s` of a phase, between its nodes, in the last simulated motion.
    ///
    /// # Errors
    /// If the equations admit no such state.
    pub fn glance(&self, phase: usize, s: f64, glance: &mut Glance) -> Result<(), Undefined> {
        self.phases[phase].glance(self.gait, s, glance)
    }

    /// Values of a path constraint at the nodes of an element of the last simulated motion, and the coefficients of the quartic
    /// through them.
    pub fn quartic(&self, phase: usize, constraint: usize, element: usize) -> [[f64; NODES]; 2] {
        let p = &self.phases[phase];
        let values = p.in_element(&p.path[constraint], element);
        [values, p.mesh.lobatto.interpolate(&values)]
    }

    /// Whether a limit jumps in the element around `s`, because its joint turns around there.
    pub fn is_torn(&self, phase: usize, constraint: usize, s: f64) -> bool {
        let p = &self.phases[phase];
        let turns = |(rate, _)| {
            let rates = p.of_element(rate, p.mesh.element(s));
            rates.iter().any(|rate| *rate <= 0.0) && rates.iter().any(|rate| *rate >= 0.0)
        };
        p.path[constraint].dry().is_some_and(turns)
    }

    /// Where a limit that is meant for a side is lowest inside the elements in which its joint turns around, as shares of the phase.
    pub fn lows_beside_turns(&self, phase: usize, constraint: usize) -> Vec<f64> {
        let p = &self.phases[phase];
        let Some((rate, Some(side))) = p.path[constraint].dry() else { return Vec::new() };
        let in_element = |element: usize| {
            let share = move |at: f64| (element as f64 + at) / p.mesh.elements as f64;
            let values = p.in_element(&p.path[constraint], element);
            let all = match self.is_torn(phase, constraint, share(0.5)) {
                true => Lowest::all_on_side(&p.mesh.lobatto, &values, p.of_element(rate, element), rate, side),
                false => Vec::new(),
            };
            // What is lowest at a node is a row of its own there.
            all.into_iter().map(|lowest| lowest.at).filter(|at| 0.0 < *at && *at < 1.0).map(share)
        };
        (0..p.mesh.elements).flat_map(in_element).collect()
    }

    /// Number of variables Θ.
    pub fn dimension(&self) -> usize {
        self.variables.total()
    }

    /// Natural size of each variable: rad, rad/s, s.
    pub fn scale(&self) -> Vec<f64> {
        scale(self.description())
    }

    /// Imposes a path constraint at its lowest point near `s`, in the element there, where it is known to have this value
    /// (scaled) in the last simulated motion.
    pub fn impose(&mut self, phase: usize, constraint: usize, s: f64, value: f64) {
        let p = &mut self.phases[phase];
        let element = p.mesh.element(s);
        let from = s * p.mesh.elements as f64 - element as f64;
        let lowest = p.lowest(&p.path[constraint], element, from);
        let dip = Dip { constraint, element, offset: value - lowest.value, lowest };
        match p.dips.iter_mut().find(|known| known.is(&dip)) {
            Some(known) => *known = dip,
            None => {
                p.dips.push(dip);
                self.count_rows();
            }
        }
    }

    /// Values of the rows between nodes in the last simulated motion (scaled), per phase.
    pub fn dip_values(&self) -> Vec<Vec<f64>> {
        let value =
            |p: &Phase, dip: &Dip| p.lowest(&p.path[dip.constraint], dip.element, dip.lowest.at).value + dip.offset;
        self.phases.iter().map(|p| p.dips.iter().map(|dip| value(p, dip)).collect()).collect()
    }

    /// Gives every row between nodes the value that its constraint has in the last simulated motion, where the row's quartic is
    /// lowest.
    ///
    /// # Errors
    /// If the equations admit no such state.
    pub fn measure_dips(&mut self, phase: usize) -> Result<(), Undefined> {
        if self.phases[phase].dips.is_empty() {
            return Ok(());
        }
        let mut glance = Glance::new(self.description(), phase);
        for k in 0..self.phases[phase].dips.len() {
            let p = &self.phases[phase];
            let dip = &p.dips[k];
            let constraint = &p.path[dip.constraint];
            let lowest = p.lowest(constraint, dip.element, dip.lowest.at);
            // At an end of the element the quartic has the constraint's own value, which may be a limit that no glance can take.
            let offset = if lowest.at == 0.0 || lowest.at == 1.0 {
                0.0
            } else {
                p.glance(self.gait, (dip.element as f64 + lowest.at) / p.mesh.elements as f64, &mut glance)?;
                constraint.value(&glance.values) - lowest.value
            };
            let dip = &mut self.phases[phase].dips[k];
            (dip.offset, dip.lowest) = (offset, lowest);
        }
        Ok(())
    }

    /// The phase before `k`.
    fn before(&self, k: usize) -> usize {
        (k + self.phases.len() - 1) % self.phases.len()
    }

    /// Evaluates the motion of Θ.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    pub fn simulate(&mut self, theta: &[f64]) -> Result<(), Undefined> {
        let d = self.description();
        let per_phase = self.variables.per_phase();
        let own = |k: usize| &theta[k * per_phase..][..per_phase];
        // In flight the end also depends on where the parabola has begun, which the phases before tell.
        for k in self.stances().chain(self.flights()) {
            let centre = match self.parabola(k) {
                Some((_, [forward, up])) => [forward, up - d.gravity * own(k)[self.variables.duration()]],
                None => [0.0; 2],
            };
            self.phases[k].end(self.gait, &self.variables, own(k), centre, &self.still);
        }
        (self.travel, self.duration) = (0.0, 0.0);
        for k in 0..self.phases.len() {
            let before = self.before(k);
            for row in 0..d.orientations() {
                let (from, sign) = d.renamed(before, row);
                let b = &self.phases[before];
                let (q, qd) = (b.q_end[from], b.crossing.qd_plus().unwrap_or(&b.qd_end)[from]);
                self.phases[k].q_start[row] = sign * q;
                self.phases[k].qd_start[row] = sign * qd;
            }
            let parabola = self.parabola(k).unwrap_or_default();
            let phase = &mut self.phases[k];
            phase.set_parameters(self.gait, &self.variables, theta, parabola);
            let t = phase.duration();
            if t.is_nan() || t < SHORTEST * self.units.time {
                return Err(Undefined::NotFinite);
            }
            phase.flow.integrate(self.gait, phase.mode, &phase.mesh, &phase.parameters)?;
            phase.instants.evaluate(self.gait, &phase.mesh, &phase.flow, &phase.parameters);
            let smoothing = self.smoothing * self.units.power();
            integrate(self.criterion, smoothing, &phase.mesh, &phase.instants, &mut phase.cost);
            let x = |node: usize| phase.instants.platform_x(&phase.mesh, &phase.parameters, node);
            phase.travel = x(phase.last()) - x(0);
            self.travel += phase.travel;
            self.duration += t;
        }
        Ok(())
    }

    /// Phases on a foot, and those in flight.
    fn stances(&self) -> impl Iterator<Item = usize> + use<> {
        self.of_modes(false)
    }

    fn flights(&self) -> impl Iterator<Item = usize> + use<> {
        self.of_modes(true)
    }

    fn of_modes(&self, flies: bool) -> impl Iterator<Item = usize> + use<> {
        let phases: smallvec::SmallVec<[usize; 8]> =
            (0..self.phases.len()).filter(|k| self.phases[*k].layout.flies() == flies).collect();
        phases.into_iter()
    }

    /// Height and velocity of the mass centre at the beginning of a flight, from the take-off before it.
    fn parabola(&self, k: usize) -> Option<(f64, [f64; 2])> {
        self.phases[k].layout.flies().then(|| self.phases[self.before(k)].crossing.parabola())
    }

    /// Builds the table of rows anew.
    fn count_rows(&mut self) {
        let holding: Vec<Equation> = self.holding().collect();
        self.rows = Rows::new(&self.phases, &holding);
        self.equality_rows.resize(self.rows.equations.len() * self.dimension(), 0.0);
    }

    /// Partial derivatives of the objective in the quantities of the nodes of a phase: node, quantity, derivative.
    pub fn objective_partials(&self, phase: usize) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let p = &self.phases[phase];
        let share = p.duration() * self.per_work();
        p.cost.partials.iter().map(move |(node, quantity, partial)| (*node, *quantity, share * partial))
    }

    /// Derivatives of the objective in the dry friction of joints, in a phase, where torques and rates stay: joint, derivative.
    pub fn objective_by_coulomb(&self, phase: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let p = &self.phases[phase];
        let share = p.duration() * self.per_work();
        p.cost.drives.iter().zip(&p.cost.by_coulomb).map(move |(drive, by)| (drive.joint, share * by))
    }

    /// The criterion per metre of travel, where the objective is 1 and the mean speed the one asked.
    pub fn criterion_per_objective(&self) -> f64 {
        self.units.integrand(self.criterion) / self.speed.abs()
    }

    /// The speed asked for in the robot's unit, without its sign, as far as it can be told from none.
    fn froude(&self) -> f64 {
        (self.speed / self.units.speed()).abs().max(SLOWEST)
    }

    /// Travel at the speed asked for in the last simulated motion, m.
    pub fn asked_travel(&self) -> f64 {
        self.speed * self.duration
    }

    /// The robot's units.
    pub fn units(&self) -> &Units {
        &self.units
    }

    /// Integral of the criterion's integrand over the whole motion.
    fn work(&self) -> f64 {
        self.phases.iter().map(|p| p.duration() * p.cost.value).sum()
    }

    /// The objective is the mean of the criterion's integrand over time: at a given mean speed it is the criterion per metre
    /// but for a factor, and it stays what it is where the speed vanishes and metres cost infinitely much.
    fn objective(&self) -> f64 {
        self.work() * self.per_work()
    }

    /// What a unit of work adds to the objective.
    fn per_work(&self) -> f64 {
        1.0 / (self.duration * self.units.integrand(self.criterion))
    }

    /// Both criteria of the last simulated motion.
    pub fn costs(&self) -> Costs {
        let d = self.description();
        let of = |criterion| {
            let mut sum = 0.0;
            for p in &self.phases {
                let mut integral = Integral::new(d, p.mode, &p.mesh);
                integral.going.clone_from(&p.cost.going);
                integrate(criterion, 0.0, &p.mesh, &p.instants, &mut integral);
                sum += p.duration() * integral.value;
            }
            // Backwards, too, metres cost.
            sum / self.travel.abs()
        };
        Costs { energy: of(Criterion::Energy), torque: of(Criterion::Torque) }
    }

    /// The last simulated motion as numbers.
    pub fn motion(&self) -> Motion {
        let d = self.description();
        let prescribed =
            |values: &[f64]| -> Vec<f64> { (0..d.prescribed()).map(|j| values[d.prescribed_index(j)]).collect() };
        let course = |p: &Phase| Course {
            duration: p.duration(),
            q_initial: prescribed(&p.q_start),
            qd_initial: prescribed(&p.qd_start),
            q_interior: (0..p.layout.per_joint - 4)
                .map(|i| (0..d.prescribed()).map(|j| p.parameters[p.layout.joint(j, 2 + i)]).collect())
                .collect(),
            q_final: prescribed(&p.q_end),
            qd_final: prescribed(&p.qd_end),
            beta_initial: p.q_start[d.unactuated],
            betad_initial: p.qd_start[d.unactuated],
            beta_final: p.q_end[d.unactuated],
            betad_final: p.qd_end[d.unactuated],
        };
        Motion { phases: self.phases.iter().map(course).collect() }
    }
}

/// Θ of a motion.
pub fn theta(motion: &Motion) -> Vec<f64> {
    let mut theta = Vec::new();
    for h in &motion.phases {
        theta.extend_from_slice(&h.q_final);
        theta.push(h.beta_final);
        theta.extend_from_slice(&h.qd_final);
        theta.push(h.betad_final);
        theta.extend(h.q_interior.iter().flatten());
        theta.push(h.duration);
    }
    theta
}

/// Natural size of each variable: rad, rad/s, s.
pub fn scale(d: &Description) -> Vec<f64> {
    let (v, units) = (Variables::new(d), Units::new(d));
    let mut scale = Vec::new();
    for _ in 0..v.phases {
        scale.extend(std::iter::repeat_n(ANGLE, v.orientations));
        scale.extend(std::iter::repeat_n(RATE * units.rate(), v.orientations));
        scale.extend(std::iter::repeat_n(ANGLE, v.prescribed * v.interior));
        scale.push(DURATION * units.time);
    }
    scale
}

/// How far two motions are apart: the largest difference of a variable, in natural sizes.
pub fn apart(d: &Description, a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).zip(scale(d)).map(|((a, b), scale)| (a - b).abs() / scale);
    differences.fold(0.0, f64::max)
}
