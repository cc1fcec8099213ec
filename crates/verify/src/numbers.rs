//! The numbers of a robot and gait as scalars of any kind. What is no number (which body hangs on which, what turns
//! about which axis) stays in the description.

use super::geometry::Vec3;
use piaffe_model::{Description, Member};
use piaffe_number::Scalar;

/// Masses, lengths and limits of a [`Description`], in its units and order.
#[derive(Clone, Debug)]
pub struct Numbers<T = f64> {
    pub gravity: T,
    pub bodies: Vec<Rigid<T>>,
    /// Foot of each leg from the joint of its body, m.
    pub feet: [Vec3<T>; 2],
    /// The real legs of each.
    pub members: [Vec<RealLeg<T>>; 2],
    /// Of the platform, from its mass centre, m.
    pub corners: Vec<Vec3<T>>,
    pub joints: Vec<Actuator<T>>,
    pub friction: T,
    pub min_vertical_force: T,
    pub swing_clearance: T,
    /// Shortest and longest, of each phase.
    pub durations: Vec<[T; 2]>,
    pub min_platform_height: T,
    pub body_clearance: T,
}

/// See [`Member`]; m.
#[derive(Clone, Debug)]
pub struct RealLeg<T> {
    /// Joint of each link on the one before.
    pub offsets: Vec<Vec3<T>>,
    pub spots: Vec<Vec3<T>>,
}

/// See [`Body`](piaffe_model::Body).
#[derive(Clone, Copy, Debug)]
pub struct Rigid<T> {
    pub offset: Vec3<T>,
    pub mass: T,
    pub com: Vec3<T>,
    /// Rows of the tensor.
    pub inertia: [Vec3<T>; 3],
}

/// See [`Joint`](piaffe_model::Joint).
#[derive(Clone, Copy, Debug)]
pub struct Actuator<T> {
    pub range: [T; 2],
    pub max_torque: T,
    pub unloaded_speed: T,
    pub loaded_speed: T,
    pub rotor_inertia: T,
    /// A spring beside the motor, and where it does nothing.
    pub stiffness: T,
    pub rest: T,
    /// Viscous friction.
    pub damping: T,
    /// Dry friction.
    pub coulomb: T,
}

impl<T: Scalar> Numbers<T> {
    /// As they are.
    pub fn new(description: &Description) -> Self {
        Numbers::of(description, description.numbers().into_iter().map(T::from))
    }

    /// Others in the order of [`Description::numbers`].
    pub fn of(description: &Description, numbers: impl IntoIterator<Item = T>) -> Self {
        let mut rest = numbers.into_iter();
        let mut one = || rest.next().unwrap_or(T::from(f64::NAN));
        let gravity = one();
        let bodies = description.bodies.iter().map(|_| rigid(&mut one)).collect();
        let rotors: Vec<T> = description.joints.iter().map(|_| one()).collect();
        let mut members = [Vec::new(), Vec::new()];
        let feet = [0, 1].map(|leg| {
            let foot = vector(&mut one);
            members[leg].extend(description.legs[leg].members.iter().map(|member| real_leg(member, &mut one)));
            foot
        });
        let corners = description.corners.iter().map(|_| vector(&mut one)).collect();
        let joints = rotors.into_iter().map(|rotor_inertia| Actuator {
            range: [one(), one()],
            max_torque: one(),
            unloaded_speed: one(),
            loaded_speed: one(),
            stiffness: one(),
            rest: one(),
            damping: one(),
            coulomb: one(),
            rotor_inertia,
        });
        let joints = joints.collect();
        Numbers {
            gravity,
            bodies,
            feet,
            members,
            corners,
            joints,
            friction: one(),
            min_vertical_force: one(),
            swing_clearance: one(),
            durations: description.phases.iter().map(|_| [one(), one()]).collect(),
            min_platform_height: one(),
            body_clearance: one(),
        }
    }
}

/// What its links weigh is part of the virtual leg: it is only asked where its joints and other spots are.
fn real_leg<T: Scalar>(member: &Member, one: &mut impl FnMut() -> T) -> RealLeg<T> {
    let offsets = member.bodies.iter().map(|_| rigid(one).offset).collect();
    vector(one);
    RealLeg { offsets, spots: member.spots.iter().map(|_| vector(one)).collect() }
}

fn rigid<T: Scalar>(one: &mut impl FnMut() -> T) -> Rigid<T> {
    let (offset, mass, com) = (vector(one), one(), vector(one));
    Rigid { offset, mass, com, inertia: [(); 3].map(|()| vector(one)) }
}

fn vector<T: Scalar>(one: &mut impl FnMut() -> T) -> Vec3<T> {
    Vec3::from([(); 3].map(|()| one()))
}
