//! Sensitivity of the optimum: what to change on the robot, or in what is asked of it, to lower the criterion.
//!
//! At an optimum the slope of the least criterion C* in a parameter p is that of the Lagrangian, with the variables Θ and the
//! multipliers as they are (envelope theorem): dC*/dp = ∂L/∂p. The multipliers are [`optimality`](crate::optimality)'s;
//! ∂L/∂p comes from the verifier's physics in dual numbers (`lagrangian.rs`), with (β, σ) as the program has them (`path.rs`).

mod lagrangian;
mod path;

use crate::constraints::sharing::applies;
use crate::optimality::{KKT_RESIDUAL, Linearized};
use lagrangian::{LANES, Slopes};
use piaffe_model::Gait;
use piaffe_model::motion::{Criterion, Motion};
use serde::{Deserialize, Serialize};

/// Slopes of the least criterion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivities {
    /// In the numbers that stand in the specification and the speed, the largest elasticity first.
    pub slopes: Vec<Sensitivity>,
    /// Constraints that are active without a price: the optimum may change its active set right here, and then slopes hold to
    /// one side only.
    #[serde(deserialize_with = "piaffe_model::limit::names")]
    pub one_sided: Vec<String>,
}

impl Sensitivities {
    /// Those in what the robot is made of: links, joints, actuators, mounts; the largest elasticity first.
    pub fn of_robot(&self) -> impl Iterator<Item = &Sensitivity> {
        let asked = |name: &str| name == "speed" || name == "gravity" || name.starts_with("limits.");
        self.slopes.iter().filter(move |s| !asked(&s.parameter) && s.elasticity != 0.0)
    }
}

/// The slope of the least criterion in a number, or in those that must change together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// Its name in the specification, or `speed`; of several, what differs between their names in braces.
    pub parameter: String,
    /// Each of them by its name.
    #[serde(default)]
    pub numbers: Vec<String>,
    pub unit: String,
    /// Of the first.
    pub value: f64,
    /// dC*/dp, the criterion's unit per the parameter's.
    pub slope: f64,
    /// Percent of the criterion per percent of the parameter.
    pub elasticity: f64,
}

impl Sensitivity {
    /// Beyond this elasticity the optimum stands at a corner, a leg stretched or folded to the last, say.
    const STEEP: f64 = 1e3;

    /// Whether the slope is that of a point alone: too steep for advice.
    pub fn is_steep(&self) -> bool {
        self.elasticity.abs() > Self::STEEP
    }
}

/// Why there are no sensitivities.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unknown {
    /// See [`Gait::levers`].
    #[error("it is not known which numbers of a specification the robot is made of")]
    NoLevers,
    #[error("slopes with limits at each real leg are not derived")]
    RealLegs,
    #[error("the motion cannot be followed")]
    Undefined,
    #[error(
        "prices are told only where the first-order conditions hold to {KKT_RESIDUAL:.0e}, and the residual is {residual:.1e}"
    )]
    NoOptimum { residual: f64 },
}

/// The sensitivities of a motion that minimizes `criterion` at `speed` (m/s).
///
/// # Errors
/// Why there are none.
///
/// # Panics
/// If the motion has not the numbers that the gait needs; `verify` tells.
pub fn sensitivities(
    gait: &dyn Gait,
    criterion: Criterion,
    speed: f64,
    motion: &Motion,
) -> Result<Sensitivities, Unknown> {
    let (d, levers) = (gait.description(), gait.levers());
    if levers.is_empty() {
        return Err(Unknown::NoLevers);
    }
    if applies(d) {
        return Err(Unknown::RealLegs);
    }
    let linearized = Linearized::new(gait, criterion, speed, motion).map_err(|_| Unknown::Undefined)?;
    let residual = linearized.multipliers.kkt.optimality();
    if residual > KKT_RESIDUAL {
        return Err(Unknown::NoOptimum { residual });
    }
    let slopes = Slopes::new(&linearized, motion);
    let cost = linearized.multipliers.values.objective * linearized.cycle.criterion_per_objective();
    let entry = |parameter: &str, numbers: &[&str], unit: &str, value: f64, slope: f64| Sensitivity {
        parameter: parameter.into(),
        numbers: numbers.iter().map(ToString::to_string).collect(),
        unit: unit.into(),
        value,
        slope,
        elasticity: slope * value / cost,
    };
    let mut list = vec![entry("speed", &["speed"], "m/s", speed, slopes.in_speed())];
    for chunk in levers.chunks(LANES) {
        let found = slopes.along(chunk).ok_or(Unknown::Undefined)?;
        list.extend(chunk.iter().zip(found).map(|(l, slope)| entry(l.name, &l.numbers, l.unit, l.value, slope)));
    }
    list.sort_by(|a, b| b.elasticity.abs().total_cmp(&a.elasticity.abs()));
    Ok(Sensitivities { slopes: list, one_sided: linearized.unpriced() })
}
