//! Actuators (§6.1): |Γ| ≤ Γmax and |q̇| ≤ ω0 − (ω0 − ω1) |Γ|/Γmax at every joint.
//!
//! Each absolute value is two linear constraints, so the envelope is four.

use super::{Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> Vec<PathConstraint<T>> {
    let mut list = Vec::new();
    for (j, (joint, limits)) in d.joints.iter().zip(&limits.joints).enumerate() {
        for sign in [1.0, -1.0] {
            let terms = vec![(y.torque(j), T::from(-sign))];
            list.push(PathConstraint::linear(Limit::Torque, joint.max_torque, limits.max_torque, terms).of(joint.name));
        }
        let slope = (limits.unloaded_speed - limits.loaded_speed) / limits.max_torque;
        for (speed, torque) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let terms = vec![(y.rate(j), T::from(-speed)), (y.torque(j), T::from(-torque) * slope)];
            list.push(
                PathConstraint::linear(Limit::TorqueSpeed, joint.unloaded_speed, limits.unloaded_speed, terms)
                    .of(joint.name),
            );
        }
    }
    list
}
