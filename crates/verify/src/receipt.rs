//! The receipt: what an independent evaluation of a motion found.

use super::constraint::{Constraint, Tally};
use super::contact::contact;
use super::cycle::{closure, transition};
use super::error::{VerifyError, check};
use super::grid::{Totals, evaluate};
use super::margins::Units;
use super::numbers::Numbers;
use super::phase::Phase;
use piaffe_model::Description;
use piaffe_model::motion::{Costs, Motion};
use serde::{Deserialize, Serialize};

/// What verification found; see [`verify`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Receipt {
    /// Largest violation of a constraint on the grid, in its natural unit; 0 where all hold.
    pub max_violation: f64,
    /// The constraint that is violated most.
    pub worst: Option<Finding>,
    /// How far the motion is from a cycle, by an integration of its own: the ends of β and β̇
    /// (eq. 23, 24) and the initial states after the impacts (eq. 16, 18, 19). Angles in rad, rates relative to themselves or, if
    /// that is greater, to a fifth of √(gravity/leg).
    pub cycle_error: f64,
    pub costs: Costs,
    /// Travel of the platform's mass centre over the phases of the motion, m: of a mirrored gait that of a half step.
    pub step_length: f64,
    /// Mean forward speed, m/s.
    pub speed: f64,
    /// Inequalities without room to spare: one entry per constraint and phase, at its worst time.
    pub active: Vec<Finding>,
    /// The inequality with the least room, active or not.
    pub least: Option<Finding>,
    pub peaks: Vec<JointPeak>,
    /// Points per phase.
    pub grid: usize,
}

/// A constraint at the time where it is closest to its limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Its name, as in "torque of haunch1".
    #[serde(deserialize_with = "piaffe_model::limit::name")]
    pub constraint: String,
    /// 1-based.
    #[serde(alias = "half_step")]
    pub phase: usize,
    /// From the beginning of the phase, s.
    pub time: f64,
    /// Room that is left, scaled; negative = violated.
    pub margin: f64,
}

/// How much of its actuator a joint uses, over all phases of the motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointPeak {
    pub name: String,
    /// Greatest |Γ|, N·m.
    pub torque: f64,
    /// N·m.
    pub max_torque: f64,
    /// Greatest |q̇|, rad/s.
    pub speed: f64,
    /// rad/s.
    pub unloaded_speed: f64,
    /// Least margin to the torque–speed limit, as a share of the unloaded speed.
    pub envelope_margin: f64,
}

/// Evaluates a motion at `grid` points per phase, to be performed at the mean `speed` (m/s).
///
/// Nothing is taken from whoever made the motion but its variables: β is integrated anew, and the
/// dynamics come from the numbers of the description alone.
///
/// # Errors
/// If the motion does not have the numbers that the gait needs, or cannot be followed to its end.
pub fn verify(description: &Description, motion: &Motion, speed: f64, grid: usize) -> Result<Receipt, VerifyError> {
    check(description, motion, grid)?;
    if !speed.is_finite() || speed == 0.0 {
        return Err(VerifyError::Speed(speed));
    }
    let units = Units::new(description);
    let mut cycle_error = 0.0_f64;
    let mut tallies = Vec::new();
    let mut totals: Vec<Totals> = Vec::new();
    for (i, course) in motion.phases.iter().enumerate() {
        let mut tally = Tally::new(description, i + 1);
        let mut phase = Phase::new(description, course, contact(description, &motion.phases, i), i + 1)?;
        totals.push(evaluate(&mut phase, &motion.phases, i, grid, &mut tally)?);
        let at_impact = |constraint, margin| tally.note(constraint, margin, course.duration);
        let gaps = transition(description, Numbers::new(description), &motion.phases, i, at_impact)?;
        let all = gaps.into_iter().chain(closure(&units, course, phase.beta_end()));
        cycle_error = all.fold(cycle_error, |worst, gap| worst.max(gap.abs()));
        let numbers = phase.numbers();
        units.duration(numbers, i, course.duration, |constraint, margin| {
            tally.note(constraint, margin, course.duration)
        });
        tallies.push(tally);
    }

    let sum = |of: fn(&Totals) -> f64| totals.iter().map(of).sum::<f64>();
    let step_length = sum(|t| t.travel);
    // A gait may walk backwards; what a metre costs does not depend on where it leads.
    let distance = step_length.abs();
    if !distance.is_normal() {
        return Err(VerifyError::NoTravel { distance: step_length });
    }
    let costs = Costs { energy: sum(|t| t.energy) / distance, torque: sum(|t| t.torque) / distance };
    let mean_speed = step_length / motion.durations().sum::<f64>();
    if let (Some(tally), Some(course)) = (tallies.last_mut(), motion.phases.last()) {
        tally.note(Constraint::MeanSpeed, Units::mean_speed(mean_speed, speed), course.duration);
    }

    let worst = tallies.iter().filter_map(|t| t.worst(description)).min_by(|a, b| a.margin.total_cmp(&b.margin));
    Ok(Receipt {
        max_violation: worst.as_ref().map_or(0.0, |finding| -finding.margin),
        worst,
        cycle_error,
        costs,
        step_length,
        speed: mean_speed,
        least: tallies.iter().filter_map(|t| t.least(description)).min_by(|a, b| a.margin.total_cmp(&b.margin)),
        active: tallies.iter().flat_map(|t| t.active(description)).collect(),
        peaks: peaks(description, &totals, &tallies),
        grid,
    })
}

fn peaks(description: &Description, totals: &[Totals], tallies: &[Tally]) -> Vec<JointPeak> {
    let joints = description.joints.iter().enumerate();
    joints
        .map(|(j, joint)| JointPeak {
            name: joint.name.into(),
            torque: totals.iter().map(|t| t.peaks[j][0]).fold(0.0, f64::max),
            max_torque: joint.max_torque,
            speed: totals.iter().map(|t| t.peaks[j][1]).fold(0.0, f64::max),
            unloaded_speed: joint.unloaded_speed,
            envelope_margin: tallies.iter().map(|t| t.margin(Constraint::Speed(j))).fold(f64::INFINITY, f64::min),
        })
        .collect()
}
