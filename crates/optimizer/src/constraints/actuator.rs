//! Actuators (§6.1): |Γ| ≤ Γmax and |q̇| ≤ ω0 − (ω0 − ω1) |Γ|/Γmax at every joint.
//!
//! Each absolute value is two linear constraints, so the envelope is four. Γ is the motor's torque: where there is a
//! spring or friction it overcomes that too. Dry friction jumps where the joint turns around: there both sides are limited, each by a
//! constraint that knows its side and is asked for (`search::refine`).

use super::{Form, Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> Vec<PathConstraint<T>> {
    let mut list = Vec::new();
    for (j, (joint, limits)) in d.joints.iter().zip(&limits.joints).enumerate() {
        let (torque, angle, rate) = (y.torque(j), y.angle(j), y.rate(j));
        let mut add = |limit, unit, offset, [by_rate, by_torque]: [T; 2]| {
            let motor = |passive, side| {
                let form =
                    Form::Motor { offset, torque: (torque, by_torque), angle, rate: (rate, by_rate), passive, side };
                PathConstraint { on_demand: side.is_some(), ..PathConstraint::new(limit, unit, form).of(joint.name) }
            };
            let linear = |terms| PathConstraint::linear(limit, unit, offset, terms).of(joint.name);
            match limits.passive {
                Some(passive) => list.push(motor(passive, None)),
                None if limit == Limit::Torque => list.push(linear(vec![(torque, by_torque)])),
                None => list.push(linear(vec![(rate, by_rate), (torque, by_torque)])),
            }
            if let Some(passive) = limits.passive.filter(|_| joint.coulomb != 0.0) {
                list.extend([1.0, -1.0].map(|side| motor(passive, Some(side))));
            }
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
