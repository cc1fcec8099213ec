//! A result that comes back from a file: it is of a gait at hand, and all that it states was derived anew.

use crate::audit::Audit;
use crate::origin::{Foreign, gait_of};
use crate::result::GaitResult;
use piaffe_model::Gait;
use piaffe_model::motion::Motion;

/// An optimum that says of its motion nothing but what the motion does.
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
    #[error(transparent)]
    Foreign(#[from] Foreign),
    #[error("{name} is not confirmed: {reason}; optimize again")]
    NotConfirmed { name: String, reason: String },
}

impl<'a> Readback<'a> {
    /// Derives anew what a result states ([`Audit`]).
    ///
    /// # Errors
    /// If the result is no optimum, is of another robot, or states what its motion does not do.
    pub fn new(result: GaitResult, gaits: &[&'a dyn Gait]) -> Result<Readback<'a>, Unusable> {
        let readback = Readback::issued(result, gaits)?;
        match Audit::of(&readback.result, gaits).objection() {
            Some(reason) => Err(Unusable::NotConfirmed { name: readback.result.name(), reason }),
            None => Ok(readback),
        }
    }

    /// The same of a result that this program has derived itself, and which needs no audit.
    ///
    /// # Errors
    /// If the result is no optimum or of another robot.
    pub fn issued(result: GaitResult, gaits: &[&'a dyn Gait]) -> Result<Readback<'a>, Unusable> {
        let (Some(motion), Some(cost)) = (result.motion(), result.cost) else {
            return Err(Unusable::NoOptimum { name: result.name(), message: result.message });
        };
        let gait = gait_of(&result, gaits)?;
        Ok(Readback { result, gait, motion, cost })
    }
}
