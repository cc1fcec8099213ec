//! Joint ranges: lower ≤ q ≤ upper stop over the whole step.

use super::{Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::Description;
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> Vec<PathConstraint<T>> {
    let mut list = Vec::new();
    for (j, (joint, limits)) in d.joints.iter().zip(&limits.joints).enumerate() {
        let [lower, upper] = limits.range;
        let stop = |which: &str| format!("range of {} ({which} stop)", joint.name);
        list.push(PathConstraint::linear(stop("lower"), 1.0, -lower, vec![(y.angle(j), T::from(1.0))]));
        list.push(PathConstraint::linear(stop("upper"), 1.0, upper, vec![(y.angle(j), T::from(-1.0))]));
    }
    for constraint in &mut list {
        constraint.at_start = false;
    }
    list
}
