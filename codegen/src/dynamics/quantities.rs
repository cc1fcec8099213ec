//! The mechanism's numbers as expressions: constants, or sums of parameters of the real robot.

use crate::expr::{Poly, Var};
use crate::mechanism::{Body, Family, Mechanism};

/// What of a mechanism is measured, in the order of [`Mechanism::numbers`]; SI units.
#[derive(Clone, Debug)]
pub struct Quantities {
    /// All of them.
    pub numbers: Vec<Poly>,
    pub gravity: Poly,
    /// Of the real robot's bodies in the order of [`Mechanism::tree`].
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
    fn read(one: &mut impl FnMut() -> Poly) -> BodyQuantities {
        let (offset, mass, com) = (vector(one), one(), vector(one));
        BodyQuantities { offset, mass, com, inertia: [(); 3].map(|()| vector(one)) }
    }

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
        // What is asked of bodies put together is where they hang: what they weigh, the real ones say.
        let together: Vec<BodyQuantities> = mechanism.bodies.iter().map(|_| BodyQuantities::read(&mut one)).collect();
        let rotor_inertia = mechanism.joints.iter().map(|_| one()).collect();
        let mut bodies = together[..1].to_vec();
        let mut members = [Vec::new(), Vec::new()];
        let feet = [0, 1].map(|leg| {
            let foot = vector(&mut one);
            let of = &mechanism.legs[leg];
            let mut links: Vec<Vec<BodyQuantities>> = Vec::new();
            for member in &of.members {
                let own: Vec<_> = member.bodies.iter().map(|_| BodyQuantities::read(&mut one)).collect();
                let offsets = own.iter().map(|link| link.offset.clone()).collect();
                links.push(own);
                vector(&mut one);
                let spots = member.spots.iter().map(|_| vector(&mut one)).collect();
                members[leg].push(MemberQuantities { offsets, spots });
            }
            let hip = &together[of.first_body()].offset;
            links.iter_mut().filter_map(|links| links.first_mut()).for_each(|first| first.offset = hip.clone());
            bodies.extend((0..of.joints.len()).flat_map(|depth| links.iter().map(move |links| links[depth].clone())));
            foot
        });
        let corners = mechanism.corners.iter().map(|_| vector(&mut one)).collect();
        Quantities { numbers, gravity, bodies, rotor_inertia, feet, members, corners }
    }
}

fn vector(one: &mut impl FnMut() -> Poly) -> [Poly; 3] {
    [(); 3].map(|()| one())
}
