//! The numbers of a robot and gait as scalars of any kind. What is no number (which body hangs on which, what turns
//! about which axis) stays in the description.

use super::multibody::Vec3;
use super::scalar::Scalar;
use crate::model::Description;

/// Masses, lengths and limits of a [`Description`], in its units and order.
#[derive(Clone, Debug)]
pub struct Numbers<T = f64> {
    pub gravity: T,
    pub bodies: Vec<Rigid<T>>,
    /// Foot of each leg from the joint of its body, m.
    pub feet: [Vec3<T>; 2],
    pub joints: Vec<Actuator<T>>,
    pub friction: T,
    pub min_vertical_force: T,
    pub swing_clearance: T,
    pub min_platform_height: T,
}

/// See [`Body`](crate::model::Body).
#[derive(Clone, Copy, Debug)]
pub struct Rigid<T> {
    pub offset: Vec3<T>,
    pub mass: T,
    pub com: Vec3<T>,
    /// Rows of the tensor.
    pub inertia: [Vec3<T>; 3],
}

/// See [`Joint`](crate::model::Joint).
#[derive(Clone, Copy, Debug)]
pub struct Actuator<T> {
    pub range: [T; 2],
    pub max_torque: T,
    pub unloaded_speed: T,
    pub loaded_speed: T,
    pub rotor_inertia: T,
}

impl<T: Scalar> Numbers<T> {
    /// As they are.
    pub fn new(description: &Description) -> Self {
        let vector = |v: [f64; 3]| Vec3::from(v.map(T::from));
        let bodies = description.bodies.iter().map(|b| Rigid {
            offset: vector(b.offset),
            mass: b.mass.into(),
            com: vector(b.com),
            inertia: b.inertia.map(vector),
        });
        let joints = description.joints.iter().map(|j| Actuator {
            range: j.range.map(T::from),
            max_torque: j.max_torque.into(),
            unloaded_speed: j.unloaded_speed.into(),
            loaded_speed: j.loaded_speed.into(),
            rotor_inertia: j.rotor_inertia.into(),
        });
        Numbers {
            gravity: description.gravity.into(),
            bodies: bodies.collect(),
            feet: [0, 1].map(|leg| vector(description.legs[leg].foot)),
            joints: joints.collect(),
            friction: description.limits.friction.into(),
            min_vertical_force: description.limits.min_vertical_force.into(),
            swing_clearance: description.limits.swing_clearance.into(),
            min_platform_height: description.limits.min_platform_height.into(),
        }
    }
}
