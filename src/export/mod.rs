//! Walks and robots for other software: tables of numbers, polynomials for a controller, robot models.
//!
//! Tables keep the axes of this crate (x forward, y up, z to the right). Robot models have z up, as their readers
//! expect: x forward, y to the left.

pub mod controller;
mod frame;
pub mod mjcf;
pub mod npz;
pub mod table;
pub mod urdf;
mod xml;

use crate::model::Description;

/// A joint's name in its leg, without the number of the virtual leg.
fn joint_name(d: &Description, joint: usize) -> &'static str {
    let leg = usize::from(joint >= d.legs[1].first_joint) + 1;
    let name = d.joints[joint].name;
    name.strip_suffix(&leg.to_string()).unwrap_or(name)
}
