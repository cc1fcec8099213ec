//! The platform stays above the ground, at least as high as its limit.
//!
//! The equations know the ground only at the feet: without this they admit a robot that hangs
//! upside down below its own feet, and cheaply so.

use super::{Limits, PathConstraint};
use crate::instant::Quantities;
use crate::model::Description;
use crate::number::Scalar;

pub fn constraint<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> PathConstraint<T> {
    let terms = vec![(y.height(), T::from(1.0))];
    PathConstraint::linear("platform height".into(), d.leg_length(), -limits.min_platform_height, terms)
}
