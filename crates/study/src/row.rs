//! The answer to a point.

use piaffe_model::motion::{Costs, Criterion};
use piaffe_optimizer::result::Status;
use piaffe_verify::Finding;
use piaffe_verify::certificate::Standing;
use serde::{Deserialize, Serialize};

/// What can be told of an optimum beyond its receipt. Slopes take about as long as finding it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Beyond {
    /// Whether it is proven that no limit is broken between the receipt's instants. What is proven broken is no optimum.
    Certificate,
    /// What the least cost does when the speed or a varied number changes.
    Slopes,
    /// What becomes of a push.
    Stability,
}

impl Beyond {
    pub const ALL: [Beyond; 3] = [Beyond::Certificate, Beyond::Slopes, Beyond::Stability];

    pub fn name(self) -> &'static str {
        match self {
            Beyond::Certificate => "certificate",
            Beyond::Slopes => "slopes",
            Beyond::Stability => "stability",
        }
    }
}

/// A point with its answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub point: usize,
    pub design: usize,
    /// The design's, in the order of the study's names.
    pub numbers: Vec<f64>,
    pub gait: String,
    pub criterion: Criterion,
    /// m/s.
    pub speed: f64,
    pub status: Outcome,
    /// In plain words: why there is no optimum; nothing where there is one.
    pub reason: Option<String>,
    /// Constraints that conflict, worst first, where the status says that some do.
    pub conflict: Vec<String>,
    pub optimum: Option<Optimum>,
}

/// What became of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// There is no robot with these numbers, or none that has this gait.
    NoRobot,
    /// A motion was looked for.
    Searched(Status),
}

impl Outcome {
    pub fn name(self) -> &'static str {
        match self {
            Outcome::NoRobot => "no-robot",
            Outcome::Searched(status) => status.name(),
        }
    }
}

/// A local optimum with its receipt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Optimum {
    /// Both criteria, by the receipt's own integration; with limits at each real leg those of the real joints.
    pub costs: Costs,
    /// The criterion of the optimum without limits at each real leg, where it was looked for too and there is one.
    pub virtual_cost: Option<f64>,
    /// Of each phase, s.
    pub durations: Vec<f64>,
    /// m.
    pub step_length: f64,
    /// Largest violation of any constraint, in natural units.
    pub violation: f64,
    /// How far the motion is from a cycle under an independent integration.
    pub cycle_error: f64,
    /// Residual of the first-order conditions.
    pub kkt_residual: f64,
    /// The limit with the least room.
    pub least: Option<Finding>,
    /// Names of the active limits.
    pub active: Vec<String>,
    /// Starts that knew of no optimum, and how many of these led to one.
    pub starts: usize,
    pub successes: usize,
    /// Different optima found.
    pub optima: usize,
    /// Where it was asked for and could be derived.
    pub certificate: Option<Standing>,
    pub slopes: Option<Slopes>,
    pub stability: Option<Pushed>,
}

/// Slopes of the least criterion, the criterion's unit per the number's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slopes {
    pub speed: f64,
    /// In each varied number, or in those that one name varies; none where the gait does not depend on it, or where it must stay
    /// like others that this name does not vary.
    pub numbers: Vec<Option<f64>>,
}

/// Factors by which a push changes in a whole step; below 1 it dies out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pushed {
    /// With joints that follow a clock.
    pub by_clock: Option<f64>,
    /// With joints that follow a phase of the motion; none where that is not possible.
    pub by_phase: Option<f64>,
}

impl Row {
    /// The least value of the criterion, if there is an optimum.
    pub fn cost(&self) -> Option<f64> {
        self.optimum.as_ref().map(|optimum| optimum.costs.of(self.criterion))
    }
}
