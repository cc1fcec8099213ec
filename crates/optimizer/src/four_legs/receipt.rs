//! The verdict on a motion: can the real legs do what the virtual ones do?

use super::cost::RealCosts;
use super::lack::Lack;
use super::lift::{Lift, NotLifted, Sharing};
use super::limits::{Limit, Limits};
use crate::constraints::sharing::BALANCED;
use piaffe_model::Gait;
use piaffe_model::motion::Motion;
use serde::{Deserialize, Serialize};

/// A margin above this is none that is violated.
pub const LEAST_MARGIN: f64 = -1e-6;

/// How the real legs share what the virtual legs do, and whether each keeps to its limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealLegs {
    /// What the whole robot's equations lack if the legs of a pair do the same.
    pub equal_shares: Lacks,
    /// What they lack with the best shares: more than rounding if no shares meet them.
    pub best_shares: Lacks,
    /// The instant of support or flight with the least room, each with its best shares.
    pub support: Worst,
    /// The impact with the least room.
    pub impact: Worst,
    /// What the motion costs on the real joints.
    pub costs: RealCosts,
    /// Part of the step's time in which no shares keep to all limits.
    pub impossible: f64,
    /// The largest part of the vertical load that one foot carries: 1/2 if two carry the same.
    pub largest_load: f64,
    /// Instants looked at.
    pub instants: usize,
}

/// The largest lack of the equations of motion, and of the impacts' equations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lacks {
    pub support: Lack,
    pub impact: Lack,
}

/// Where there is least room.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// Least margin over all limits of the real legs, in natural units; negative: no shares keep to them.
    pub margin: f64,
    /// 1-based.
    #[serde(alias = "half_step")]
    pub phase: usize,
    /// From the beginning of the step, s.
    pub time: f64,
    /// What is in the way of more.
    pub binding: Vec<Binding>,
}

/// A limit that no shares give more room, because of the others beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Binding {
    pub limit: String,
    /// Its weight in the proof (the multipliers of the cone program, which sum to 1).
    pub weight: f64,
}

/// What can be said in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Each leg of a pair does its equal share.
    EqualShares,
    /// The legs of a pair must do unequal shares, and can.
    UnequalShares,
    /// No shares keep to all limits.
    BeyondLimits,
    /// No torques and reactions at all give this motion.
    NoEquilibrium,
}

impl Lacks {
    fn holds(&self) -> bool {
        self.support.share <= BALANCED && self.impact.share <= BALANCED
    }
}

impl RealLegs {
    /// Looks at a whole step.
    ///
    /// # Errors
    /// If there is no model of the whole robot or no such motion.
    pub fn new(gait: &dyn Gait, motion: &Motion) -> Result<RealLegs, NotLifted> {
        Ok(RealLegs::of(&Lift::close(gait, motion, Sharing::MostRoom)?))
    }

    /// Looks at the instants of a lifted motion.
    pub fn of(lift: &Lift) -> RealLegs {
        let limits = Limits { legs: &lift.legs };
        let worst = |all: &mut dyn Iterator<Item = (f64, usize, f64, &[(Limit, f64)])>| {
            let found = all.min_by(|a, b| a.0.total_cmp(&b.0));
            let (margin, phase, time, binding) = found.unwrap_or((f64::NAN, 0, 0.0, &[]));
            let binding =
                binding.iter().map(|(l, weight)| Binding { limit: limits.name(*l), weight: rounded(*weight) });
            Worst { margin, phase: phase + 1, time, binding: binding.collect() }
        };
        let (instants, impacts) = (&lift.instants, &lift.impacts);
        let most =
            |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a });
        let supports = &mut instants.iter().map(|i| (i.margin, i.phase, i.time, &i.binding[..]));
        let landings = &mut impacts.iter().map(|i| (i.margin, i.phase, i.time, &i.binding[..]));
        let loads = &mut instants.iter().filter(|i| i.stance.len() > 1).map(|i| {
            let vertical = |leg: &usize| i.reactions[*leg][1];
            most(&mut i.stance.iter().map(vertical)) / i.stance.iter().map(vertical).sum::<f64>()
        });
        RealLegs {
            equal_shares: Lacks {
                support: instants.iter().map(|i| i.equal_lack).fold(Lack::NONE, Lack::larger),
                impact: impacts.iter().map(|i| i.equal_lack).fold(Lack::NONE, Lack::larger),
            },
            best_shares: Lacks {
                support: instants.iter().map(|i| i.lack).fold(Lack::NONE, Lack::larger),
                impact: impacts.iter().map(|i| i.lack).fold(Lack::NONE, Lack::larger),
            },
            support: worst(supports),
            impact: worst(landings),
            costs: RealCosts::of(lift),
            impossible: impossible(lift),
            largest_load: most(loads),
            instants: instants.len(),
        }
    }

    pub fn verdict(&self) -> Verdict {
        if !self.best_shares.holds() {
            Verdict::NoEquilibrium
        } else if !(self.support.margin >= LEAST_MARGIN && self.impact.margin >= LEAST_MARGIN) {
            Verdict::BeyondLimits
        } else if self.equal_shares.holds() {
            Verdict::EqualShares
        } else {
            Verdict::UnequalShares
        }
    }

    /// Whether the real legs can do what the virtual ones do between impacts, and at them.
    pub fn between_and_at_impacts(&self) -> [bool; 2] {
        let can = |lack: Lack, worst: &Worst| lack.share <= BALANCED && worst.margin >= LEAST_MARGIN;
        [can(self.best_shares.support, &self.support), can(self.best_shares.impact, &self.impact)]
    }
}

/// To a millionth: what the solver's tolerance makes certain.
fn rounded(weight: f64) -> f64 {
    (1e6 * weight).round() / 1e6
}

/// The part of the step whose instants leave no room, by trapezoids.
fn impossible(lift: &Lift) -> f64 {
    let lacks = |margin: f64| f64::from(u8::from(margin < LEAST_MARGIN));
    let time: f64 = lift
        .instants
        .windows(2)
        .map(|pair| 0.5 * (pair[1].time - pair[0].time) * (lacks(pair[0].margin) + lacks(pair[1].margin)))
        .sum();
    time / lift.durations.iter().sum::<f64>()
}
