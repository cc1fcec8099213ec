//! Stance reaction (§4.2): Fy ≥ Fmin, and the tangential part at most μ Fy.

use super::{Form, Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> Vec<PathConstraint<T>> {
    let weight = d.total_mass() * d.gravity;
    let mut list = vec![PathConstraint::linear(
        Limit::VerticalForce,
        weight,
        -limits.min_vertical_force,
        vec![(y.force(1), T::from(1.0))],
    )];
    if d.is_spatial() {
        let form = Form::Cone { normal: y.force(1), factor: limits.friction, tangential: vec![y.force(0), y.force(2)] };
        list.push(PathConstraint::new(Limit::Friction, weight, form));
    } else {
        for sign in [1.0, -1.0] {
            let terms = vec![(y.force(1), limits.friction), (y.force(0), T::from(sign))];
            list.push(PathConstraint::linear(Limit::Friction, weight, T::zero(), terms));
        }
    }
    list
}
