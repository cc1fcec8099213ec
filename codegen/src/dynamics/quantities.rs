//! The mechanism's numbers as expressions: constants, or sums of parameters of the real robot.

use crate::expr::{Poly, Var};
use crate::mechanism::{Body, Family, Mechanism};

/// What of a mechanism is measured, in the order of [`Mechanism::numbers`]; SI units.
#[derive(Clone, Debug)]
pub struct Quantities {
    /// All of them.
    pub numbers: Vec<Poly>,
    pub gravity: Poly,
    pub bodies: Vec<BodyQuantities>,
    /// Of each joint, seen at the joint.
    pub rotor_inertia: Vec<Poly>,
    /// Foot of each leg in the axes of its last body.
    pub feet: [[Poly; 3]; 2],
    /// The real legs of each.
    pub members: [Vec<MemberQuantities>; 2],
    /// Of the platform.
    pub corners: Vec<[Poly; 3]>,
}

/// See `mechanism::Member`.
#[derive(Clone, Debug)]
pub struct MemberQuantities {
    /// Of its links.
    pub offsets: Vec<[Poly; 3]>,
    pub spots: Vec<[Poly; 3]>,
}

/// See `mechanism::Body`.
#[derive(Clone, Debug)]
pub struct BodyQuantities {
    pub offset: [Poly; 3],
    pub mass: Poly,
    pub com: [Poly; 3],
    pub inertia: [[Poly; 3]; 3],
}

impl BodyQuantities {
    pub fn constant(body: &Body) -> BodyQuantities {
        BodyQuantities {
            offset: body.offset.map(Poly::constant),
            mass: Poly::constant(body.mass),
            com: body.com.map(Poly::constant),
            inertia: body.inertia.map(|row| row.map(Poly::constant)),
        }
    }
}

impl Quantities {
    pub fn constant(mechanism: &Mechanism) -> Quantities {
        Quantities::new(mechanism, mechanism.numbers().into_iter().map(Poly::constant).collect())
    }

    /// With a symbol for each parameter of the family.
    pub fn of_family(family: &Family, parameters: &[Var]) -> Quantities {
        let number = |k: usize| {
            let mut sum = Poly::constant(family.base[k]);
            for (parameter, slope) in parameters.iter().zip(&family.slopes) {
                sum += &Poly::from(*parameter).scaled(slope[k]);
            }
            sum
        };
        Quantities::new(&family.mechanism, (0..family.base.len()).map(number).collect())
    }

    /// From expressions for all of the mechanism's numbers.
    pub fn new(mechanism: &Mechanism, numbers: Vec<Poly>) -> Quantities {
        let mut rest = numbers.iter().cloned();
        let mut one = || rest.next().unwrap_or_default();
        let gravity = one();
        let mut bodies = Vec::new();
        for _ in &mechanism.bodies {
            let offset = [(); 3].map(|()| one());
            let mass = one();
            bodies.push(BodyQuantities {
                offset,
                mass,
                com: [(); 3].map(|()| one()),
                inertia: [(); 3].map(|()| [(); 3].map(|()| one())),
            });
        }
        let rotor_inertia = mechanism.joints.iter().map(|_| one()).collect();
        let mut members = [Vec::new(), Vec::new()];
        let feet = [0, 1].map(|leg| {
            let foot = [(); 3].map(|()| one());
            for member in &mechanism.legs[leg].members {
                // Of the members matter the places of their joints: the dynamics are those of the virtual leg.
                let mut offset = || {
                    let offset = [(); 3].map(|()| one());
                    (3..Body::COUNT).for_each(|_| drop(one()));
                    offset
                };
                let offsets = member.bodies.iter().map(|_| offset()).collect();
                (0..3).for_each(|_| drop(one()));
                let spots = member.spots.iter().map(|_| [(); 3].map(|()| one())).collect();
                members[leg].push(MemberQuantities { offsets, spots });
            }
            foot
        });
        let corners = mechanism.corners.iter().map(|_| [(); 3].map(|()| one())).collect();
        Quantities { numbers, gravity, bodies, rotor_inertia, feet, members, corners }
    }

    pub fn total_mass(&self) -> Poly {
        self.bodies.iter().fold(Poly::zero(), |sum, body| &sum + &body.mass)
    }
}
