//! Actuators (§6.1): |Γ| ≤ Γmax and |q̇| ≤ ω0 − (ω0 − ω1) |Γ|/Γmax at every joint.
//!
//! Each absolute value is two linear constraints, so the envelope is four. Γ is the motor's torque: where there is a
//! spring or friction it overcomes that too.

use super::{Form, Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> Vec<PathConstraint<T>> {
    let mut list = Vec::new();
    for (j, (joint, limits)) in d.joints.iter().zip(&limits.joints).enumerate() {
        let (torque, angle, rate) = (y.torque(j), y.angle(j), y.rate(j));
        let mut add = |limit, unit, offset, [by_rate, by_torque]: [T; 2]| {
            let form = match limits.passive {
                Some(passive) => {
                    Form::Motor { offset, torque: (torque, by_torque), angle, rate: (rate, by_rate), passive }
                }
                None if limit == Limit::Torque => Form::Linear { offset, terms: vec![(torque, by_torque)] },
                None => Form::Linear { offset, terms: vec![(rate, by_rate), (torque, by_torque)] },
            };
            list.push(PathConstraint::new(limit, unit, form).of(joint.name));
        };
        for sign in [1.0, -1.0] {
            add(Limit::Torque, joint.max_torque, limits.max_torque, [T::zero(), T::from(-sign)]);
        }
        let slope = (limits.unloaded_speed - limits.loaded_speed) / limits.max_torque;
        for (speed, torque) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let by = [T::from(-speed), T::from(-torque) * slope];
            add(Limit::TorqueSpeed, joint.unloaded_speed, limits.unloaded_speed, by);
        }
    }
    list
}
