//! Positions and angular velocities of all bodies of the real robot in the coordinates of a gait, as expressions.

use super::quantities::{BodyQuantities, Quantities};
use crate::expr::{Frame, Mat3, Poly, Ring, Var, Vec3, add, rotate, zero};
use crate::mechanism::{Body, Mechanism};
use crate::spec::{Axis, Rotation};

/// The symbols of a mechanism: X = [p, q] with rates and accelerations.
pub struct Coordinates {
    /// `[coordinate, rate, acceleration]` of p.
    pub p: Vec<[Var; 3]>,
    /// `[coordinate, rate, acceleration]` of q (joints, then θ).
    pub q: Vec<[Var; 3]>,
}

/// A body's place and motion relative to the platform's mass centre (position) and the world (spin).
#[derive(Clone, PartialEq)]
pub struct Placement {
    /// Mass centre minus p, in the axes on which the tree is built (the world's).
    pub com: Vec3,
    /// Angular velocity in the body's own axes.
    pub spin: Vec3,
    /// From the body's own axes to the world's.
    pub axes: Mat3,
}

/// What weighs in one motion: a body, or bodies that the gait moves exactly alike.
#[derive(Clone)]
pub struct Moving {
    pub place: Placement,
    pub mass: Poly,
    /// About the mass centre, in the axes of the body.
    pub inertia: [Vec3; 3],
}

/// Positions relative to the platform's mass centre. In a planar gait all that moves does so in the sagittal plane: z is 0.
pub struct Kinematics {
    /// The platform first.
    pub bodies: Vec<Moving>,
    /// Of the platform, then of each virtual leg's links from the platform down.
    pub axes: Vec<Mat3>,
    pub feet: [Vec3; 2],
}

impl Coordinates {
    pub fn new(ring: &mut Ring, mechanism: &Mechanism) -> Coordinates {
        let names = mechanism.coordinate_names();
        let mut all = names.iter().map(|n| ring.coordinate(n));
        let p = all.by_ref().take(mechanism.positions()).collect();
        let q = all.collect();
        Coordinates { p, q }
    }

    /// X in order: p, then q.
    pub fn all(&self) -> Vec<[Var; 3]> {
        self.p.iter().chain(&self.q).copied().collect()
    }
}

impl Kinematics {
    pub fn new(
        ring: &mut Ring,
        mechanism: &Mechanism,
        quantities: &Quantities,
        coordinates: &Coordinates,
    ) -> Kinematics {
        let theta = coordinates.q.get(mechanism.joints.len()).map(|c| c[0]);
        let mut platform = Frame::base(zero());
        if let Some(theta) = theta {
            let axis = if mechanism.rotation == Rotation::Roll { Axis::Roll } else { Axis::Pitch };
            platform = platform.turned(ring, axis.index(), theta);
        }
        let planar = |mut v: Vec3| {
            if !mechanism.rotation.is_spatial() {
                v[2] = Poly::zero();
            }
            v
        };
        let bodies = mechanism.tree();
        let tree = Tree::new(ring, platform, &bodies, &quantities.bodies, &coordinates.q);
        let feet = [0, 1].map(|leg| {
            let last = mechanism.lead_links(leg).last().unwrap_or_default();
            planar(tree.point(ring, last, &quantities.feet[leg]))
        });
        let leads = (0..2).flat_map(|leg| mechanism.lead_links(leg));
        let axes = std::iter::once(0).chain(leads).map(|body| tree.bodies[body].axes.clone()).collect();
        let mut alike: Vec<Moving> = Vec::new();
        for (place, numbers) in tree.bodies.into_iter().zip(&quantities.bodies) {
            let place = Placement { com: planar(place.com), ..place };
            match alike.iter_mut().find(|one| one.place == place) {
                Some(one) => one.take(numbers),
                None => alike.push(Moving { place, mass: numbers.mass.clone(), inertia: numbers.inertia.clone() }),
            }
        }
        Kinematics { bodies: alike, axes, feet }
    }
}

impl Moving {
    /// Adds a body that moves alike.
    fn take(&mut self, body: &BodyQuantities) {
        self.mass += &body.mass;
        let more = body.inertia.as_flattened();
        self.inertia.as_flattened_mut().iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    }
}

/// Bodies that hang on each other.
pub struct Tree {
    pub bodies: Vec<Placement>,
    /// Axes and joint of each.
    frames: Vec<(Frame, Vec3)>,
}

impl Tree {
    /// The tree on a platform with these axes; body 0 is the platform. Joints turn by the first of `q`'s symbols.
    pub fn new(
        ring: &mut Ring,
        platform: Frame,
        bodies: &[Body],
        quantities: &[BodyQuantities],
        q: &[[Var; 3]],
    ) -> Tree {
        let mut tree = Tree { bodies: Vec::new(), frames: Vec::new() };
        for (body, numbers) in bodies.iter().zip(quantities) {
            let (frame, joint) = match (body.parent, body.coordinate) {
                (Some(parent), Some(coordinate)) => {
                    let joint = tree.point(ring, parent, &numbers.offset);
                    (tree.frames[parent].0.turned(ring, body.axis.index(), q[coordinate][0]), joint)
                }
                _ => (platform.clone(), zero()),
            };
            tree.bodies.push(place(ring, &numbers.com, &frame, &joint));
            tree.frames.push((frame, joint));
        }
        tree
    }

    /// Where the point of a body is that lies at `at` in its axes, from its joint.
    pub fn point(&self, ring: &mut Ring, body: usize, at: &Vec3) -> Vec3 {
        let (frame, joint) = &self.frames[body];
        add(joint, &rotate(&frame.rotation(ring), at))
    }
}

fn place(ring: &mut Ring, com: &Vec3, frame: &Frame, joint: &Vec3) -> Placement {
    let axes = frame.rotation(ring);
    Placement { com: add(joint, &rotate(&axes, com)), spin: frame.spin(ring), axes }
}
