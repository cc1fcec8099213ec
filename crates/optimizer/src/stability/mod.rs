//! Orbital stability: does the gait recover from a push, how fast, and under which control.
//!
//! Four joints cannot hold five coordinates: while the joints are kept where they are wanted, the robot turns about its stance
//! foot as gravity likes, and in flight about its mass centre as it did when it left. How a deviation of that free motion comes
//! back after a step depends on what "wanted" means:
//!
//! - as functions of time ([`time`]): the joints' references run on by the clock. A deviation is one of (β, σ), and the return
//!   map is 2 × 2;
//! - as functions of a phase ([`phase`]): the references follow how far the robot has got. Only the speed along the path can
//!   deviate, and the return map is a number.
//!
//! Tracking is perfect in both: the limit of stiff control. Limits of torque and ground are not looked at, since deviations are
//! small. Derivations are in docs/algorithms.md.

mod passage;
pub mod phase;
pub mod time;
mod words;

use crate::flow::Undefined;
use passage::Passage;
pub use phase::PhaseTracking;
use piaffe_model::motion::Motion;
use piaffe_model::{Gait, Then};
use serde::{Deserialize, Serialize};
pub use time::{Clock, TimeTracking};

/// What becomes of small deviations from a gait.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// Joints follow their trajectories by a clock that runs on whenever the foot lands.
    pub clock: TimeTracking,
    /// The same with a clock that starts anew when the foot lands.
    pub restarted_clock: TimeTracking,
    /// Joints follow a phase of the robot's own motion.
    pub phase: PhaseTracking,
}

/// Looks at a periodic motion with both ways of tracking.
///
/// # Errors
/// If the equations admit no such motion.
///
/// # Panics
/// If the motion has not the numbers that the gait needs; `verify` tells.
pub fn stability(gait: &dyn Gait, motion: &Motion) -> Result<Stability, Undefined> {
    let d = gait.description();
    let count = motion.phases.len();
    let passages = (0..count).map(|k| Passage::new(gait, motion, k)).collect::<Result<Vec<_>, _>>()?;
    // The legs swap roles: two like halves are a step.
    let repeats = if d.then == Then::Mirrored { 2 } else { 1 };
    Ok(Stability {
        clock: TimeTracking::new(gait, &passages, repeats, Clock::RunsOn),
        restarted_clock: TimeTracking::new(gait, &passages, repeats, Clock::StartsAnew),
        phase: PhaseTracking::new(gait, &passages, repeats),
    })
}

/// Whole steps in which a deviation that shrinks by `factor` in each is halved; none if it does not shrink.
pub fn halving(factor: f64) -> Option<f64> {
    (factor < 1.0).then(|| if factor > 0.0 { -std::f64::consts::LN_2 / libm::log(factor) } else { 0.0 })
}
