//! A result that comes back from a file: it is what it says, and of this build's robot.

use crate::model::{Description, Gait, Limits};
use crate::motion::Motion;
use crate::result::{GRID, GaitResult};
use crate::verify::verify;

/// An optimum whose motion does what the result states.
pub struct Readback<'a> {
    pub result: GaitResult,
    pub gait: &'a dyn Gait,
    pub motion: Motion,
    /// The criterion, per metre of travel.
    pub cost: f64,
}

/// Why a result cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unusable {
    #[error("{name} is no optimum ({message}): it has no walk")]
    NoOptimum { name: String, message: String },
    #[error("there is no gait `{gait}` in this build, which has {known}; rebuild with the specification of the result")]
    UnknownGait { gait: String, known: String },
    #[error(
        "{name} is a result of another robot or gait than this build's (its fingerprint differs); optimize again, or rebuild with its specification"
    )]
    OtherRobot { name: String },
    #[error("{name} contradicts itself: {reason}; optimize again")]
    Contradiction { name: String, reason: String },
}

impl<'a> Readback<'a> {
    /// Verifies the motion of a result anew.
    ///
    /// # Errors
    /// If the result is no optimum, is of another robot, or states what its motion does not do.
    pub fn new(result: GaitResult, gaits: &[&'a dyn Gait]) -> Result<Readback<'a>, Unusable> {
        let name = result.name();
        let (Some(motion), Some(cost)) = (result.motion(), result.cost) else {
            return Err(Unusable::NoOptimum { name, message: result.message });
        };
        let gait = gait_of(&result, gaits)?;
        let receipt = verify(gait.description(), &motion, result.speed, GRID)
            .map_err(|e| Unusable::Contradiction { name: name.clone(), reason: e.to_string() })?;
        let found = receipt.costs.of(result.criterion);
        if (found - cost).abs() > 1e-9 * cost.abs() {
            let reason = format!("it states a cost of {cost}, but its motion costs {found}");
            return Err(Unusable::Contradiction { name, reason });
        }
        Ok(Readback { result, gait, motion, cost })
    }
}

/// The gait of this build that a result is of.
///
/// # Errors
/// If there is none of its name, or it is of another robot.
pub fn gait_of<'a>(result: &GaitResult, gaits: &[&'a dyn Gait]) -> Result<&'a dyn Gait, Unusable> {
    let mut candidates = gaits.iter().filter(|g| g.description().key == result.gait).peekable();
    if candidates.peek().is_none() {
        let known = gaits.iter().map(|g| g.description().key).collect::<Vec<_>>().join(", ");
        return Err(Unusable::UnknownGait { gait: result.gait.clone(), known });
    }
    let fingerprint = |d: &Description| {
        let limits = Limits { real_legs: result.limits_at_real_legs, ..d.limits.clone() };
        Description { limits, ..d.clone() }.fingerprint()
    };
    let same = candidates.find(|g| fingerprint(g.description()) == result.fingerprint);
    same.copied().ok_or_else(|| Unusable::OtherRobot { name: result.name() })
}
