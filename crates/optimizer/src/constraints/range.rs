//! Joint ranges: lower ≤ q ≤ upper stop over the whole step.

use super::{Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> Vec<PathConstraint<T>> {
    let mut list = Vec::new();
    for (j, (joint, limits)) in d.joints.iter().zip(&limits.joints).enumerate() {
        let [lower, upper] = limits.range;
        let stop = |limit, bound, sign| {
            PathConstraint::linear(limit, 1.0, bound, vec![(y.angle(j), T::from(sign))]).of(joint.name)
        };
        list.push(stop(Limit::LowerStop, -lower, 1.0));
        list.push(stop(Limit::UpperStop, upper, -1.0));
    }
    for constraint in &mut list {
        constraint.at_start = false;
    }
    list
}
