//! Swing foot (§6.1): its height is at least 4 h s (1 − s).
//!
//! Divided by 4 s (1 − s) it reads clearance ≥ h, which stays meaningful at both ends, where height
//! and parabola vanish together and their slopes decide.

use super::{Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraint<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> PathConstraint<T> {
    let terms = vec![(y.clearance(), T::from(1.0))];
    PathConstraint::linear(Limit::Clearance, d.leg_length(), -limits.swing_clearance, terms)
}
