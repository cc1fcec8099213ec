//! Only feet touch the ground: the platform's mass centre is at least as high as its limit, and all joints and corners as the
//! body's clearance.
//!
//! The equations know the ground only at the feet: without this they admit a robot that hangs upside down below its own feet,
//! or drags its knees through the ground, and cheaply so.

use super::{Limits, PathConstraint};
use crate::instant::Quantities;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(d: &Description, limits: &Limits<T>, y: &Quantities) -> Vec<PathConstraint<T>> {
    let above = |limit: Limit, quantity: usize, least: T| {
        PathConstraint::linear(limit, d.leg_length(), -least, vec![(quantity, T::from(1.0))])
    };
    let mut list = vec![above(Limit::PlatformHeight, y.height(), limits.min_platform_height)];
    for (point, quantity) in d.lowest.iter().zip(y.heights()) {
        // At the first instant it is that of the last: there both feet are on the ground.
        list.push(PathConstraint {
            at_start: false,
            ..above(Limit::Height, quantity, limits.body_clearance).of(d.points[*point].name)
        });
    }
    list
}
