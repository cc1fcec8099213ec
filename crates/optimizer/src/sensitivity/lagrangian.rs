//! ∂L/∂p with Θ and the multipliers kept: L = f − λᵀc_E − μᵀc_I − νᵀ(Θ − bounds), every function of it as the nonlinear program has it.
//! f is the criterion per metre but for a factor, which the speed is part of and no other number.
//!
//! Numbers of the robot change the impacts, with them the velocities and the momentum at the beginning of each phase, the parabola of a
//! flight, and (β, σ) along it (`path`). The end of a phase is part of Θ. A row of L at a dip between nodes is the quartic through the nodes, as in the
//! program; the dip's motion does not matter (envelope theorem). Joints at rest do not stay so when numbers change: the criterion's
//! subgradient there is part of L.

use super::path::{Rates, follow};
use crate::constraints::{ImpactConstraints, Limits, path_constraints_of};
use crate::cycle::{Equation, Place};
use crate::instant::Quantities;
use crate::lgl::NODES;
use crate::optimality::Linearized;
use crate::swing::{Of, Swing, swings};
use num_traits::Zero;
use piaffe_model::motion::{Course, Motion};
use piaffe_model::{Description, Lever, Mode, UP};
use piaffe_number::{Dual, Scalar};
use piaffe_verify::contact::Contact;
use piaffe_verify::impact::{Before, Impact, impact_of};
use piaffe_verify::instants::{Instants, State};
use piaffe_verify::multibody::Multibody;
use piaffe_verify::numbers::Numbers;

/// Parameters that are taken together.
pub const LANES: usize = 14;

/// With derivatives in the parameters, then in β and β̇ of an instant.
type Number = Dual<f64, { LANES + 2 }>;

/// The Lagrangian of an optimum as a function of parameters.
pub struct Slopes<'a> {
    linearized: &'a Linearized<'a>,
    motion: &'a Motion,
    d: &'a Description,
}

/// How a phase ends.
enum End {
    Lands(Box<Landing>),
    /// All velocities stay: these of q.
    Leaves(Vec<Number>),
}

impl End {
    /// Velocities of q with which it ends.
    fn rates(&self, d: &Description) -> &[Number] {
        match self {
            End::Lands(landing) => &landing.impact.after[d.positions()..],
            End::Leaves(rates) => rates,
        }
    }
}

/// What happens where a foot lands.
struct Landing {
    impact: Impact<Number>,
    /// Of the foot that lands, over the stance foot or, out of flight, the ground.
    height: Number,
}

impl<'a> Slopes<'a> {
    pub fn new(linearized: &'a Linearized, motion: &'a Motion) -> Slopes<'a> {
        Slopes { linearized, motion, d: linearized.cycle.description() }
    }

    /// The slope in the mean speed, which enters one equation, and divides the criterion.
    pub fn in_speed(&self) -> f64 {
        let Linearized { cycle, multipliers, .. } = self.linearized;
        let through_equation = self.speed_multiplier() * cycle.asked_travel() / cycle.units().length;
        let through_division = -multipliers.values.objective;
        cycle.criterion_per_objective() * (through_equation + through_division) / cycle.speed
    }

    /// That of the equation of the mean speed.
    fn speed_multiplier(&self) -> f64 {
        self.linearized.multipliers.equalities[self.linearized.cycle.speed_equation()]
    }

    /// The slopes along levers, [`LANES`] at most. `None` if the motion cannot be followed.
    pub fn along(&self, levers: &[Lever]) -> Option<[f64; LANES]> {
        let (d, m) = (self.d, &self.linearized.multipliers);
        let mut numbers: Vec<Number> = d.numbers().into_iter().map(Number::constant).collect();
        for (lane, lever) in levers.iter().enumerate() {
            for (number, slope) in lever.slopes.iter() {
                numbers.get_mut(*number)?.d[lane] = *slope;
            }
        }
        let numbers = Numbers::of(d, numbers);
        let limits =
            Limits::along(d, &std::array::from_fn(|lane| d.direction(levers.get(lane).map_or(&[], |l| &l.slopes))));
        let ends = (0..d.phases.len()).map(|k| self.end(&numbers, k)).collect::<Option<Vec<_>>>()?;

        let units = self.linearized.cycle.units();
        let mut lagrangian = Number::zero();
        for (k, end) in ends.iter().enumerate() {
            let before = (k + d.phases.len() - 1) % d.phases.len();
            lagrangian += self.phase(&numbers, &limits, k, ends[before].rates(d))?;
            if let (End::Lands(landing), Some(impact)) =
                (end, ImpactConstraints::with(d, d.transition(k), limits.friction))
            {
                lagrangian -= landing.height.scale(self.multiplier(Equation::Touchdown(k)) / units.length);
                let end = [&landing.impact.impulse.as_slice()[..d.positions()], &[landing.impact.leaving.y]].concat();
                for (i, multiplier) in self.priced() {
                    if let Place::Impact { phase, constraint } = self.linearized.cycle.place(i)
                        && phase == k
                    {
                        lagrangian -= impact.value(constraint, &end).scale(multiplier);
                    }
                }
            }
            let bounds = self.motion.phases.len();
            let own = m.bounds.len() / bounds;
            let nu = m.bounds[(k + 1) * own - 1];
            lagrangian += limits.durations[k][usize::from(nu < 0.0)].scale(nu);
        }
        let criterion = self.linearized.cycle.criterion_per_objective();
        Some(parameters(&lagrangian).map(|slope| criterion * slope))
    }

    /// That of an equation.
    fn multiplier(&self, equation: Equation) -> f64 {
        let Linearized { cycle, multipliers, .. } = self.linearized;
        let row = cycle.equations().iter().position(|other| *other == equation);
        row.map_or(0.0, |row| multipliers.equalities[row])
    }

    /// Inequalities with a multiplier.
    fn priced(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.linearized
            .multipliers
            .inequalities
            .iter()
            .copied()
            .enumerate()
            .filter(|(_, multiplier)| *multiplier != 0.0)
    }

    /// All phases, where Θ has them.
    fn phases(&self) -> Vec<Course<Number>> {
        self.motion.phases.iter().map(Course::cast).collect()
    }

    /// How phase `k` ends, where Θ has it.
    fn end(&self, numbers: &Numbers<Number>, k: usize) -> Option<End> {
        let (d, h) = (self.d, &self.motion.phases[k]);
        let constants = |values: Vec<f64>| -> Vec<Number> { values.into_iter().map(Number::constant).collect() };
        let q = constants(d.complete(&h.q_final, h.beta_final));
        let qd = constants(d.complete(&h.qd_final, h.betad_final));
        let Some(landing) = d.transition(k).lands() else { return Some(End::Leaves(qd)) };
        let mut multibody = Multibody::with(d, numbers.clone());
        let contact = Contact::of(d, numbers, &self.phases(), k);
        let t = Number::constant(h.duration);
        let before = match contact {
            Contact::Foot(_) => Before::Stance,
            Contact::Flight(fall) => Before::Flight(fall.velocity(t)),
        };
        let impact = impact_of(&mut multibody, landing, &q, &qd, before)?;
        let foot = multibody.foot(landing).position.y;
        let height = match contact {
            Contact::Foot(stance) => foot - multibody.foot(stance).position.y,
            Contact::Flight(fall) => fall.place(t)[UP] + foot - multibody.centre().position.y,
        };
        Some(End::Lands(Box::new(Landing { impact, height })))
    }

    /// Its part of L, but for how it ends; `rates` are those with which the phase before ends.
    fn phase(&self, numbers: &Numbers<Number>, limits: &Limits<Number>, k: usize, rates: &[Number]) -> Option<Number> {
        let (d, cycle, m) = (self.d, &self.linearized.cycle, &self.linearized.multipliers);
        let mut course: Course<Number> = self.motion.phases[k].cast();
        let rate = |index: usize| {
            let (from, sign) = d.renamed((k + d.phases.len() - 1) % d.phases.len(), index);
            rates[from].scale(sign)
        };
        course.qd_initial = (0..d.prescribed()).map(|j| rate(d.prescribed_index(j))).collect();
        let betad_initial = rate(d.unactuated);
        let duration = self.motion.phases[k].duration;
        let (mode, swings) = (cycle.mode(k), swings(d, k));
        let mut instants = Instants::new(d, numbers.clone(), &course, Contact::of(d, numbers, &self.phases(), k));

        // What is weighted at an instant: quantities of the criterion, constraints.
        let last = cycle.last_node(k);
        let mut weights = vec![Vec::new(); last + 1];
        cycle.objective_partials(k).for_each(|(node, quantity, weight)| weights[node].push((quantity, weight)));
        for ((_, joint, node), multiplier) in cycle.resting().zip(&m.kinks).filter(|((phase, ..), _)| *phase == k) {
            weights[node].push((Quantities::new(d, mode).rate(joint), -multiplier));
        }
        let mut rows = vec![Vec::new(); last + 1];
        for (i, multiplier) in self.priced() {
            if let Place::Instant { phase, constraint, .. } = cycle.place(i)
                && phase == k
            {
                cycle
                    .row_nodes(i)
                    .into_iter()
                    .for_each(|(node, part)| rows[node].push((constraint, multiplier * part)));
                for (node, quantity, part) in cycle.row_turn(i) {
                    weights[node].push((quantity, -multiplier * part));
                }
            }
        }
        let durations: Vec<f64> = self.motion.durations().collect();
        let constraints = path_constraints_of(d, limits, k);
        let mut state = State::new(d);
        // By instants, each with β and β̇ of its own.
        let (mut parts, mut rates) = (Vec::with_capacity(last + 1), Vec::with_capacity(last + 1));
        let mut initial = [0.0; LANES];
        for (node, (weights, rows)) in weights.iter().zip(&rows).enumerate() {
            let (share, [q, qd, _]) = (cycle.instant(k, node), cycle.sample(k, node).state);
            let beta = Number::variable(q[d.unactuated], LANES);
            let betad = Number::variable(qd[d.unactuated], LANES + 1);
            instants.at(Number::constant(share * duration), [beta, betad], &mut state)?;
            let [momentum, moment] = instants.momentum();
            // β̇ where σ is as it is.
            let by_betad = momentum.d[LANES + 1];
            rates.push(Rates {
                by_state: [[-momentum.d[LANES] / by_betad, 1.0 / by_betad], [moment.d[LANES], 0.0]],
                direct: [parameters(&momentum).map(|by| -by / by_betad), parameters(&moment)],
            });
            if node == 0 {
                initial = parameters(&momentum);
                initial.iter_mut().zip(betad_initial.d).for_each(|(sigma, betad)| *sigma += by_betad * betad);
            }
            let mut lagrangian = Number::zero();
            let y = quantities(d, mode, &swings, &state, share, &durations);
            for (quantity, weight) in weights {
                lagrangian += y[*quantity].scale(*weight);
                // A motor also overcomes springs and viscous friction, which are no quantities.
                if let Some(passive) = limits.joints.get(*quantity).and_then(|joint| joint.passive) {
                    let [angle, rate] = [&state.q, &state.qd].map(|list| Number::constant(list[*quantity].value()));
                    lagrangian += passive.smooth(angle, rate).scale(*weight);
                }
            }
            for (constraint, multiplier) in rows {
                lagrangian -= constraints[*constraint].value(&y).scale(*multiplier);
            }
            let travel = state.platform.x.scale(self.speed_multiplier() / cycle.units().length);
            if node == 0 {
                lagrangian += travel;
            } else if node == last {
                lagrangian -= travel;
                // These numbers change σ(q, q̇) of the wanted end and of the motion's alike: what is left is by β and β̇.
                lagrangian -= beta.scale(self.multiplier(Equation::ClosureOfBeta(k)));
                let of_sigma = self.multiplier(Equation::ClosureOfSigma(k)) / cycle.units().angular_momentum();
                (LANES..LANES + 2).for_each(|by| lagrangian.d[by] -= of_sigma * momentum.d[by]);
            }
            parts.push(lagrangian);
        }
        let length = duration / (last / (NODES - 1)) as f64;
        let changes = follow(&rates, length, [[0.0; LANES], initial])?;
        let mut lagrangian = Number::zero();
        for (part, (rates, change)) in parts.iter().zip(rates.iter().zip(&changes)) {
            lagrangian += *part;
            let ([beta, _], [betad, _]) = (change, rates.changes(change));
            for lane in 0..LANES {
                lagrangian.d[lane] += part.d[LANES] * beta[lane] + part.d[LANES + 1] * betad[lane];
            }
        }
        for (joint, by) in cycle.objective_by_coulomb(k) {
            lagrangian += numbers.joints[joint].coulomb.scale(by);
        }
        Some(lagrangian)
    }
}

/// Derivatives in the parameters alone.
fn parameters(number: &Number) -> [f64; LANES] {
    std::array::from_fn(|lane| number.d[lane])
}

/// The quantities of an instant, in the order of [`Quantities`].
fn quantities(
    d: &Description,
    mode: Mode,
    swings: &[Swing],
    state: &State<Number>,
    share: f64,
    durations: &[f64],
) -> Vec<Number> {
    let (y, joints) = (Quantities::new(d, mode), d.joints());
    let mut values = vec![Number::zero(); y.len()];
    values[..joints].copy_from_slice(&state.torques);
    values[y.force(0)..][..y.components()].copy_from_slice(&state.force.as_slice()[..y.components()]);
    values[y.angle(0)..][..joints].copy_from_slice(&state.q[..joints]);
    values[y.rate(0)..][..joints].copy_from_slice(&state.qd[..joints]);
    values[y.height()] = state.platform.y;
    for (value, point) in values[y.heights()].iter_mut().zip(d.lowest) {
        *value = state.heights[*point];
    }
    for (foot, swing) in swings.iter().enumerate() {
        let factor = swing.factor(durations, share);
        let made_of = match factor.of {
            Of::Height => state.feet[swing.leg].y,
            Of::Velocity => state.feet_velocity[swing.leg].y,
            Of::Acceleration => state.feet_acceleration[swing.leg],
        };
        values[y.clearance(foot)] = made_of.scale(factor.value);
    }
    values
}
