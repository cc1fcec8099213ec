//! Whether a motion is an optimum, from the motion alone: the residual of the first-order conditions and the multipliers.
//!
//! Θ is rebuilt from the motion and the program is linearized there, with constraints imposed wherever they dip between nodes,
//! as in the search. But nothing of the search is taken over: the multipliers are fitted to the gradients ([`multipliers`]).
//! A multiplier is a price: what the criterion would gain per unit by which its limit is loosened.

use crate::cycle::{AT_REST, Cycle, Label, Place, theta};
use crate::search::refine::dips;
use piaffe_model::motion::{Criterion, Motion};
use piaffe_model::{Gait, Limit};
use piaffe_sqp::{Multipliers, Undefined, multipliers};
use serde::{Deserialize, Serialize};

/// Largest residual of an optimum.
pub const KKT_RESIDUAL: f64 = 1e-5;
/// Prices below this share of the largest are left out.
const NEGLIGIBLE: f64 = 1e-9;
/// A limit nearer than this (scaled) is active.
const ACTIVE: f64 = 1e-6;
/// A price below this share of the criterion is none.
const FREE: f64 = 1e-6;

/// The first-order conditions at a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Optimality {
    /// What the multipliers leave of the objective's gradient, relative to max(1, ‖∇f‖∞), in scaled variables: f is the mean of
    /// the criterion's integrand over time, in a natural unit.
    pub stationarity: f64,
    /// Largest product of a multiplier with its constraint's distance from zero, in the same measure.
    pub complementarity: f64,
    /// Largest violation (scaled) in the nonlinear program.
    pub violation: f64,
    /// Multipliers of the equations: slopes of the optimal criterion in what is required to be zero.
    pub equations: Vec<Price>,
    /// Multipliers of the limits that hold the optimum where it is, the largest first.
    pub limits: Vec<Price>,
}

/// The multiplier of a constraint at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Price {
    #[serde(deserialize_with = "piaffe_model::limit::name")]
    pub constraint: String,
    /// 1-based.
    #[serde(alias = "half_step")]
    pub phase: usize,
    /// s.
    pub time: f64,
    /// Criterion per natural unit of the constraint, that of durations √(leg/gravity); of limits positive.
    pub value: f64,
}

impl Optimality {
    /// The residual of the optimality conditions.
    pub fn residual(&self) -> f64 {
        self.stationarity.max(self.complementarity)
    }

    /// The limits with a price by name, each once.
    pub fn holders(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for price in &self.limits {
            if !names.contains(&price.constraint.as_str()) {
                names.push(&price.constraint);
            }
        }
        names
    }
}

/// Residuals and multipliers of a motion that is said to minimize `criterion` at `speed` (m/s).
///
/// # Errors, Panics
/// As for [`Linearized::new`].
pub fn optimality(gait: &dyn Gait, criterion: Criterion, speed: f64, motion: &Motion) -> Result<Optimality, Undefined> {
    let Linearized { cycle, multipliers, .. } = Linearized::new(gait, criterion, speed, motion)?;
    let criterion = cycle.criterion_per_objective();
    let mut multipliers_of_equations = multipliers.equalities.clone();
    // More travel than asked for is also what the criterion is divided by.
    multipliers_of_equations[cycle.speed_equation()] -=
        multipliers.values.objective * cycle.units().length / cycle.asked_travel();
    let equations = prices(&multipliers_of_equations, criterion, |i| cycle.equality_label(i));
    let mut limits = prices(&multipliers.inequalities, criterion, |i| cycle.label(i));
    let time = criterion * cycle.units().time;
    limits.extend(prices(&multipliers.bounds, time, |i| cycle.bound_label(i)).into_iter().map(Price::of_bound));
    limits.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
    let largest = limits.first().map_or(0.0, |p| p.value.abs());
    limits.retain(|p| p.value.abs() > NEGLIGIBLE * largest);
    let kkt = multipliers.kkt;
    Ok(Optimality {
        stationarity: kkt.stationarity,
        complementarity: kkt.complementarity,
        violation: kkt.violation,
        equations,
        limits,
    })
}

impl Price {
    /// That of a bound: positive at the lower one, negative at the upper.
    fn of_bound(self) -> Price {
        let limit = if self.value > 0.0 { Limit::ShortestPhase } else { Limit::LongestPhase };
        Price { constraint: limit.name().into(), value: self.value.abs(), ..self }
    }
}

/// Multipliers of the objective as prices in a unit.
fn prices(values: &[f64], unit: f64, label: impl Fn(usize) -> Label) -> Vec<Price> {
    let price = |(i, value): (usize, &f64)| {
        let label = label(i);
        Price { constraint: label.name(), phase: label.phase, time: label.time, value: unit * value }
    };
    values.iter().enumerate().filter(|(_, value)| **value != 0.0).map(price).collect()
}

/// The nonlinear program linearized at a motion, with its multipliers there.
pub struct Linearized<'a> {
    pub cycle: Cycle<'a>,
    pub theta: Vec<f64>,
    pub multipliers: Multipliers,
}

impl<'a> Linearized<'a> {
    /// On the coarsest mesh that resolves the motion and on which the conditions hold; if there is none, on the coarsest.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    ///
    /// # Panics
    /// If the motion has not the numbers that the gait needs; `verify` tells.
    pub fn new(
        gait: &'a dyn Gait,
        criterion: Criterion,
        speed: f64,
        motion: &Motion,
    ) -> Result<Linearized<'a>, Undefined> {
        let theta = theta(motion);
        let first = Linearized::on(Cycle::resolving(gait, criterion, speed, &theta).map_err(|_| Undefined)?, &theta)?;
        // A mesh that resolves the motion need not resolve the slopes of a constraint that hardly depends on Θ.
        let mut finer = first.finer()?;
        while let Some(found) = finer {
            if found.holds() {
                return Ok(found);
            }
            finer = found.finer()?;
        }
        Ok(first)
    }

    /// Of a motion that `cycle` has just simulated.
    fn on(mut cycle: Cycle<'a>, theta: &[f64]) -> Result<Linearized<'a>, Undefined> {
        dips(&cycle).and_then(|dips| dips.impose(&mut cycle)).map_err(|_| Undefined)?;
        // Where joints nearly turn around, least torque is not smooth.
        let halts = cycle.halts(AT_REST);
        cycle.keep_going(&halts);
        // Where joints rest, least energy has kinks.
        let still = cycle.still(AT_REST);
        cycle.hold(&still);
        cycle.let_go();
        let scale = cycle.scale();
        let mut found = multipliers(&mut cycle, theta, scale.clone())?;
        let overpaid = cycle.overpaid(&halts, &found.inequalities);
        if !overpaid.is_empty() {
            // These hold no optimum: without them it shows.
            cycle.let_turn(&overpaid);
            found = multipliers(&mut cycle, theta, scale)?;
        }
        Ok(Linearized { cycle, theta: theta.to_vec(), multipliers: found })
    }

    fn holds(&self) -> bool {
        self.multipliers.kkt.optimality() <= KKT_RESIDUAL
    }

    /// The same on a mesh twice as fine, if the conditions do not hold and there is one.
    fn finer(&self) -> Result<Option<Linearized<'a>>, Undefined> {
        let finer = self.cycle.twice_as_fine().filter(|_| !self.holds());
        let linearize = |mut cycle: Cycle<'a>| {
            cycle.simulate(&self.theta).map_err(|_| Undefined)?;
            Linearized::on(cycle, &self.theta)
        };
        finer.map(linearize).transpose()
    }

    /// Names of limits that are active but have no price: the slightest change may make them hold the optimum, or not.
    pub fn unpriced(&self) -> Vec<String> {
        let (cycle, m) = (&self.cycle, &self.multipliers);
        let least = FREE * m.values.objective.abs();
        // Of neighbouring rows one has the price of all.
        let kind = |i: usize| match cycle.place(i) {
            Place::Instant { phase, constraint, .. } => (phase, constraint, false),
            Place::Impact { phase, constraint } => (phase, constraint, true),
        };
        let priced: Vec<_> = (0..m.inequalities.len()).filter(|i| m.inequalities[*i] > least).map(kind).collect();
        let active = (0..m.inequalities.len()).filter(|i| m.values.inequalities[*i] < ACTIVE);
        let mut names = Vec::new();
        for i in active.filter(|i| !priced.contains(&kind(*i))) {
            let label = cycle.label(i);
            let name = format!("{} (phase {})", label.name(), label.phase);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }
}
