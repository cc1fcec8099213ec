//! The platform stays above the ground.
//!
//! The equations know the ground only at the feet: without this they admit a robot that hangs
//! upside down below its own feet, and cheaply so.

use super::PathConstraint;
use crate::instant::Quantities;
use crate::model::Description;

pub fn constraint(description: &Description, y: &Quantities) -> PathConstraint {
    let terms = vec![(y.height(), 1.0)];
    PathConstraint::linear("platform above the ground".into(), description.leg_length(), 0.0, terms)
}
