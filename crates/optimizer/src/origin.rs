//! Which gait of this build a result is of.

use crate::altered::Altered;
use crate::result::GaitResult;
use piaffe_model::{Description, Gait, Limits};

/// Why there is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Foreign {
    #[error("there is no gait `{gait}` in this build, which has {known}; rebuild with the specification of the result")]
    UnknownGait { gait: String, known: String },
    #[error(
        "{name} is a result of another robot or gait than this build's (its fingerprint differs); optimize again, or rebuild with its specification"
    )]
    OtherRobot { name: String },
}

/// The gait of this build that a result is of, as it was built.
///
/// # Errors
/// If there is none of its name, or it is of another robot.
pub fn gait_of<'a>(result: &GaitResult, gaits: &[&'a dyn Gait]) -> Result<&'a dyn Gait, Foreign> {
    let mut candidates = gaits.iter().filter(|g| g.description().key == result.gait).peekable();
    if candidates.peek().is_none() {
        let known = gaits.iter().map(|g| g.description().key).collect::<Vec<_>>().join(", ");
        return Err(Foreign::UnknownGait { gait: result.gait.clone(), known });
    }
    let same = candidates.find(|g| is_of(result, g.description()));
    same.copied().ok_or_else(|| Foreign::OtherRobot { name: result.name() })
}

/// Whether a result is of this robot and gait.
pub fn is_of(result: &GaitResult, d: &Description) -> bool {
    let limits = Limits { real_legs: result.limits_at_real_legs, ..d.limits.clone() };
    result.gait == d.key && Description { limits, ..d.clone() }.fingerprint() == result.fingerprint
}

/// Does something with the gait of a result under the limits that were asked for.
///
/// # Errors
/// If the limits cannot be imposed at each real leg, why.
pub fn under_its_limits<T>(
    result: &GaitResult,
    gait: &dyn Gait,
    with: impl FnOnce(&dyn Gait) -> T,
) -> Result<T, String> {
    if result.limits_at_real_legs { Ok(with(&Altered::at_real_legs(gait)?)) } else { Ok(with(gait)) }
}
