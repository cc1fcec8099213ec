//! Joint ranges: lower ≤ q ≤ upper stop over the whole step.

use super::PathConstraint;
use crate::instant::Quantities;
use crate::model::Description;

pub fn constraints(description: &Description, y: &Quantities) -> Vec<PathConstraint> {
    let mut list = Vec::new();
    for (j, joint) in description.joints.iter().enumerate() {
        let [lower, upper] = joint.range;
        let stop = |which: &str| format!("range of {} ({which} stop)", joint.name);
        list.push(PathConstraint::linear(stop("lower"), 1.0, -lower, vec![(y.angle(j), 1.0)]));
        list.push(PathConstraint::linear(stop("upper"), 1.0, upper, vec![(y.angle(j), -1.0)]));
    }
    for constraint in &mut list {
        constraint.at_start = false;
    }
    list
}
