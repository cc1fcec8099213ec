//! The platform stays above the ground, at least as high as its limit.
//!
//! The equations know the ground only at the feet: without this they admit a robot that hangs
//! upside down below its own feet, and cheaply so.

use super::PathConstraint;
use crate::instant::Quantities;
use crate::model::Description;

pub fn constraint(description: &Description, y: &Quantities) -> PathConstraint {
    let terms = vec![(y.height(), 1.0)];
    let least = description.limits.min_platform_height;
    PathConstraint::linear("platform height".into(), description.leg_length(), -least, terms)
}
