//! Swing foot (§6.1): its height is at least 4 h s (1 − s).
//!
//! Divided by 4 s (1 − s) it reads clearance ≥ h, which stays meaningful at both ends, where height
//! and parabola vanish together and their slopes decide.

use super::PathConstraint;
use crate::instant::Quantities;
use crate::model::Description;

pub fn constraint(description: &Description, y: &Quantities) -> PathConstraint {
    let terms = vec![(y.clearance(), 1.0)];
    PathConstraint::linear(
        "swing clearance".into(),
        description.leg_length(),
        -description.limits.swing_clearance,
        terms,
    )
}
