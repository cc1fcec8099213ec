//! Joints that come to a halt and go on the same way.
//!
//! Where a joint turns around, dry friction c makes its torque jump by 2c. Whether a joint just does not turn, or does for a moment, may
//! make a great difference: what a turn costs grows like the root of its depth. So least torque can have a joint slow down until its
//! rate touches zero, and no further. There no gradient vanishes: it points into the turn that would cost.
//!
//! Θ is kept on this side of it by a row, the least rate near there, and the joint's direction is taken for what it is: so all is
//! smooth again. Such a point is an optimum if the row has a price and a turn costs.
//!
//! At an end of a phase a joint can come to a halt too. A turn that comes in there lasts as long as the rate at the end is beyond zero, over
//! its slope: what it costs grows in proportion, so the row's price must not be more ([`Cycle::overpaid`]).

use super::Cycle;
use super::phase::Phase;
use crate::constraints::Form;
use crate::cost::{Drive, Going, Nearest};
use crate::lgl::NODES;
use crate::polynomial::{Roots, derivative, evaluate, roots};
use piaffe_model::motion::Criterion;

/// A joint that nearly turns around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halt {
    pub phase: usize,
    /// The path constraint by which it goes on.
    constraint: usize,
    /// When, as a share of the phase.
    share: f64,
    nearest: Nearest,
}

impl Halt {
    /// Whether it is the same one, at another time perhaps.
    pub fn is(&self, other: &Halt) -> bool {
        /// Shares of a phase.
        const SAME: f64 = 0.02;
        (self.phase, self.constraint) == (other.phase, other.constraint) && (self.share - other.share).abs() < SAME
    }
}

impl Cycle<'_> {
    /// Where joints in the last simulated motion come to a halt, to within `share` of the fastest rate, and a turn would cost.
    pub fn halts(&self, share: f64) -> Vec<Halt> {
        if self.criterion != Criterion::Torque {
            return Vec::new();
        }
        let joints = self.description().joints();
        let fastest_at = |p: &Phase, node: usize| {
            let rates = &p.instants.row(node)[p.instants.quantities.rate(0)..][..joints];
            rates.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()))
        };
        let fastest_in = |p: &Phase| (0..p.mesh.nodes.len()).map(|node| fastest_at(p, node)).fold(0.0, f64::max);
        let fastest = self.phases.iter().map(fastest_in).fold(0.0, f64::max);
        let mut found = Vec::new();
        for (phase, p) in self.phases.iter().enumerate() {
            for (constraint, c) in p.path.iter().enumerate().filter(|(_, c)| c.on_demand) {
                for element in 0..p.mesh.elements {
                    let near = p.minima(constraint, element).into_iter().filter(|(at, value)| {
                        value.abs() * c.unit <= share * fastest && p.turning_costs(constraint, element, *at)
                    });
                    let share = |at: f64| (element as f64 + at) / p.mesh.elements as f64;
                    let inside = |(at, _)| Halt { phase, constraint, share: share(at), nearest: Nearest::Inside };
                    found.extend(near.map(inside));
                }
                let slow =
                    |end: &End| (end.value * c.unit).abs() <= share * fastest && p.turn_price(constraint, end) > 0.0;
                let ends = p.ends(constraint).into_iter().filter(slow);
                found.extend(ends.map(|end| Halt { phase, constraint, share: end.share(), nearest: end.nearest }));
            }
        }
        found
    }

    /// Lets these joints go on the way they go, in the last simulated motion.
    pub fn keep_going(&mut self, halts: &[Halt]) {
        for halt in halts {
            let p = &self.phases[halt.phase];
            let element = p.mesh.element(halt.share);
            let from = halt.share * p.mesh.elements as f64 - element as f64;
            let value = p.lowest(&p.path[halt.constraint], element, from).value;
            self.impose(halt.phase, halt.constraint, halt.share, value);
            let p = &mut self.phases[halt.phase];
            if let Some((joint, sign)) = p.direction(halt.constraint) {
                p.cost.going.push(Going { joint, sign, element, nearest: halt.nearest });
            }
        }
    }

    /// Lets these joints turn around again.
    pub fn let_turn(&mut self, halts: &[Halt]) {
        for halt in halts {
            let p = &mut self.phases[halt.phase];
            let element = p.mesh.element(halt.share);
            let direction = p.direction(halt.constraint);
            p.dips.retain(|dip| (dip.constraint, dip.element) != (halt.constraint, element));
            p.cost.going.retain(|going| (Some((going.joint, going.sign)), going.element) != (direction, element));
        }
        self.count_rows();
    }

    /// Those of the halts at ends of phases whose rows have a higher price than a turn costs, with these multipliers of a solution, the
    /// last simulated motion: there a joint had better turn.
    pub fn overpaid(&self, halts: &[Halt], inequality_multipliers: &[f64]) -> Vec<Halt> {
        let multipliers = self.dip_multipliers(inequality_multipliers);
        let per_work = self.per_work();
        let pays = |halt: &&Halt| {
            let p = &self.phases[halt.phase];
            let ends = p.ends(halt.constraint);
            let Some(end) = ends.iter().find(|end| end.nearest == halt.nearest) else { return false };
            let rows = p.dips.iter().zip(&multipliers[halt.phase]);
            let own =
                rows.filter(|(dip, _)| (dip.constraint, dip.element) == (halt.constraint, p.mesh.element(end.share())));
            let price = own.map(|(_, multiplier)| *multiplier).fold(0.0, f64::max);
            price > (1.0 + SLACK) * p.duration() * per_work * p.turn_price(halt.constraint, end).max(0.0)
        };
        halts.iter().filter(pays).copied().collect()
    }
}

/// What a price may be above the cost of a turn, as a share: rounding.
const SLACK: f64 = 1e-6;

/// An end of a phase at which a joint comes to a halt or has just turned around.
struct End {
    nearest: Nearest,
    /// The constraint (scaled), and how much more of it there is per share of the phase away from the end.
    value: f64,
    slope: f64,
}

impl End {
    fn share(&self) -> f64 {
        if self.nearest == Nearest::End { 1.0 } else { 0.0 }
    }
}

impl Phase {
    /// The joint and the direction in which a constraint lets it go on.
    fn direction(&self, constraint: usize) -> Option<(usize, f64)> {
        let c = &self.path[constraint];
        let Form::Linear { terms, .. } = &c.form else { return None };
        let [(quantity, sign)] = terms[..] else { return None };
        c.on_demand.then(|| (quantity - self.instants.quantities.rate(0), sign))
    }

    /// Minima of a constraint inside an element, as the quartic has it: places and values (scaled).
    fn minima(&self, constraint: usize, element: usize) -> Vec<(f64, f64)> {
        let quartic = self.mesh.lobatto.interpolate(&self.in_element(&self.path[constraint], element));
        let (mut buffer, mut stationary) = Default::default();
        roots(derivative(&quartic, &mut buffer), &mut stationary);
        let minima = Roots::into_iter(stationary).filter(|(_, second)| *second > 0.0);
        minima.map(|(at, _)| (at, evaluate(&quartic, at))).collect()
    }

    /// The ends of the phase at which a constraint that lets a joint go on has less room than before or after.
    fn ends(&self, constraint: usize) -> Vec<End> {
        let last = self.mesh.elements - 1;
        let end = |nearest: Nearest| {
            let (element, at, away) = if nearest == Nearest::End { (last, 1.0, -1.0) } else { (0, 0.0, 1.0) };
            let values = self.in_element(&self.path[constraint], element);
            let quartic = self.mesh.lobatto.interpolate(&values);
            let mut buffer = [0.0; NODES];
            let slope = away * evaluate(derivative(&quartic, &mut buffer), at) * self.mesh.elements as f64;
            End { nearest, value: evaluate(&quartic, at), slope }
        };
        let both = [Nearest::Beginning, Nearest::End].map(end);
        both.into_iter().filter(|end| end.slope > 0.0).collect()
    }

    /// What a turn that comes in at an end of the phase adds to the criterion, per unit of the phase and by which the constraint is
    /// exceeded: (Γ − c)² instead of (Γ + c)² for as long as it lasts.
    fn turn_price(&self, constraint: usize, end: &End) -> f64 {
        let Some((joint, sign)) = self.direction(constraint) else { return 0.0 };
        let node = if end.nearest == Nearest::End { self.last() } else { 0 };
        let gain = |drive: &Drive| drive.sharing * drive.coulomb() * drive.torque(self.instants.row(node), 0.0);
        let own = self.cost.drives.iter().filter(|drive| drive.joint == joint);
        -4.0 * sign * own.map(gain).sum::<f64>() / end.slope
    }

    /// Whether (Γ − c)² on the other side of zero rate is more than (Γ + c)² on this one, summed over the joints that one stands for.
    fn turning_costs(&self, constraint: usize, element: usize, at: f64) -> bool {
        let Some((joint, sign)) = self.direction(constraint) else { return false };
        let shape = self.mesh.lobatto.values(at);
        let first = element * (NODES - 1);
        let gain = |drive: &Drive| {
            let torque = |(i, l): (usize, &f64)| l * drive.torque(self.instants.row(first + i), 0.0);
            drive.sharing * drive.coulomb() * shape.iter().enumerate().map(torque).sum::<f64>()
        };
        let own = self.cost.drives.iter().filter(|drive| drive.joint == joint);
        sign * own.map(gain).sum::<f64>() < 0.0
    }
}
