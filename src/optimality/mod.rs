//! Whether a motion is an optimum, from the motion alone: the residual of the first-order conditions and the multipliers.
//!
//! Θ is rebuilt from the motion and the program is linearized there, with constraints imposed wherever they dip between nodes,
//! as in the search. But nothing of the search is taken over: the multipliers are fitted to the gradients ([`multipliers`]).
//! A multiplier is a price: what the criterion would gain per unit by which its constraint is loosened.

use crate::cycle::{Cycle, Label};
use crate::model::Gait;
use crate::motion::{Criterion, Motion};
use crate::search::refine::{dips, probe};
use crate::sqp::{Multipliers, Undefined, multipliers};
use serde::{Deserialize, Serialize};

/// Multipliers below this share of the largest are left out of the list.
const NEGLIGIBLE: f64 = 1e-9;

/// The first-order conditions at a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Optimality {
    /// What is left of the criterion's gradient, relative to max(1, ‖∇C‖∞), in scaled variables.
    pub stationarity: f64,
    /// Largest product of a multiplier with its constraint's distance from zero, in the same measure.
    pub complementarity: f64,
    /// Largest violation (scaled) in the nonlinear program.
    pub violation: f64,
    /// Of the constraints that hold the optimum where it is; those of inequalities by size, after those of equalities.
    pub multipliers: Vec<Price>,
}

/// The multiplier of a constraint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Price {
    pub constraint: String,
    /// 1-based.
    pub half_step: usize,
    /// s.
    pub time: f64,
    /// Criterion per (scaled) unit of the constraint. That of an inequality is positive; of an equality it is the
    /// slope of the optimal criterion in the equality's left-hand side.
    pub value: f64,
}

impl Optimality {
    /// The residual of the optimality conditions.
    pub fn residual(&self) -> f64 {
        self.stationarity.max(self.complementarity)
    }
}

/// The nonlinear program linearized at a motion, with its multipliers there.
pub struct Linearized<'a> {
    pub cycle: Cycle<'a>,
    pub theta: Vec<f64>,
    pub multipliers: Multipliers,
}

impl<'a> Linearized<'a> {
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
        let mut cycle = Cycle::new(gait, criterion, speed);
        let theta = cycle.theta(motion);
        let found = dips(&mut probe(&cycle), &theta).map_err(|_| Undefined)?;
        cycle.simulate(&theta).map_err(|_| Undefined)?;
        found.impose(&mut cycle);
        let scale = cycle.scale();
        let multipliers = multipliers(&mut cycle, &theta, scale)?;
        Ok(Linearized { cycle, theta, multipliers })
    }

    fn prices(&self) -> Vec<Price> {
        let (cycle, m) = (&self.cycle, &self.multipliers);
        let price = |label: Label, value: f64| Price {
            constraint: label.name,
            half_step: label.half_step,
            time: label.time,
            value,
        };
        let list = |values: &[f64], label: &dyn Fn(usize) -> Label| -> Vec<Price> {
            values.iter().enumerate().filter(|(_, v)| **v != 0.0).map(|(i, v)| price(label(i), *v)).collect()
        };
        let equalities = list(&m.equalities, &|i| cycle.equality_label(i));
        let mut others = list(&m.inequalities, &|i| cycle.label(i));
        others.extend(list(&m.bounds, &|i| cycle.bound_label(i)));
        let largest = others.iter().fold(0.0, |largest: f64, p| largest.max(p.value.abs()));
        others.retain(|p| p.value.abs() > NEGLIGIBLE * largest);
        others.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
        equalities.into_iter().chain(others).collect()
    }
}

/// Residuals and multipliers of a motion that is said to minimize `criterion` at `speed` (m/s).
///
/// # Errors, Panics
/// As for [`Linearized::new`].
pub fn optimality(
    gait: &dyn Gait,
    criterion: Criterion,
    speed: f64,
    motion: &Motion,
) -> Result<Optimality, Undefined> {
    let linearized = Linearized::new(gait, criterion, speed, motion)?;
    let kkt = linearized.multipliers.kkt;
    Ok(Optimality {
        stationarity: kkt.stationarity,
        complementarity: kkt.complementarity,
        violation: kkt.violation,
        multipliers: linearized.prices(),
    })
}
