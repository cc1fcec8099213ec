//! Joints with dry friction that go on the way they go: no limit, but asked for where an optimum has a joint just not turn around
//! (`cycle/halt.rs`).

use super::PathConstraint;
use crate::instant::Quantities;
use piaffe_model::units::Units;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, y: &Quantities) -> Vec<PathConstraint<T>> {
    let unit = Units::new(d).rate();
    let dry = d.joints.iter().enumerate().filter(|(_, joint)| joint.coulomb != 0.0);
    let both = dry.flat_map(|(j, joint)| [1.0, -1.0].map(|sign| (j, joint, sign)));
    let going = both.map(|(j, joint, sign)| {
        let forward = PathConstraint::linear(Limit::Still, unit, T::zero(), vec![(y.rate(j), T::from(sign))]);
        PathConstraint { on_demand: true, ..forward.of(joint.name) }
    });
    going.collect()
}
