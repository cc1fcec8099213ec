//! Walks and robots for other software: tables of numbers, polynomials for a controller, robot models.
//!
//! Tables keep the axes of this crate (x forward, y up, z to the right). Robot models have z up, as their readers
//! expect: x forward, y to the left.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod controller;
mod frame;
pub mod mjcf;
pub mod npz;
pub mod table;
pub mod urdf;
mod xml;

use piaffe_model::{Description, Member};

/// The name of a real leg's foot: no link has it.
fn foot_name(d: &Description, member: &Member) -> String {
    let mut name = format!("{}_foot", member.name);
    let links = || d.legs.iter().flat_map(|leg| leg.members.iter()).flat_map(|m| m.bodies.iter());
    while d.bodies[0].name == name || links().any(|link| link.name == name) {
        name.push('_');
    }
    name
}
