//! Actuators (§6.1): |Γ| ≤ Γmax and |q̇| ≤ ω0 − (ω0 − ω1) |Γ|/Γmax at every joint.
//!
//! Each absolute value is two linear constraints, so the envelope is four.

use super::PathConstraint;
use crate::instant::Quantities;
use crate::model::Description;

pub fn constraints(description: &Description, y: &Quantities) -> Vec<PathConstraint> {
    let mut list = Vec::new();
    for (j, joint) in description.joints.iter().enumerate() {
        for sign in [1.0, -1.0] {
            let name = format!("torque of {}", joint.name);
            list.push(PathConstraint::linear(name, joint.max_torque, joint.max_torque, vec![(y.torque(j), -sign)]));
        }
        let slope = (joint.unloaded_speed - joint.loaded_speed) / joint.max_torque;
        for (speed, torque) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let name = format!("torque–speed of {}", joint.name);
            let terms = vec![(y.rate(j), -speed), (y.torque(j), -torque * slope)];
            list.push(PathConstraint::linear(name, joint.unloaded_speed, joint.unloaded_speed, terms));
        }
    }
    list
}
