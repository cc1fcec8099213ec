//! Positions and angular velocities of all bodies, as expressions.
//!
//! A frame is a base rotation followed by one turn about one axis. Joints about the same axis add
//! up to one absolute angle, so a planar chain has one sine and cosine per link and no products.

use super::quantities::{BodyQuantities, Quantities};
use crate::expr::{Poly, Ring, Var};
use crate::mechanism::{Body, Mechanism};
use crate::spec::{Axis, Rotation};

pub type Vec3 = [Poly; 3];
pub type Mat3 = [[Poly; 3]; 3];

/// The symbols of a mechanism: X = [p, q] with rates and accelerations.
pub struct Coordinates {
    /// `[coordinate, rate, acceleration]` of p.
    pub p: Vec<[Var; 3]>,
    /// `[coordinate, rate, acceleration]` of q (joints, then θ).
    pub q: Vec<[Var; 3]>,
}

/// A body's place and motion relative to the platform's mass centre (position) and the world (spin).
pub struct Placement {
    /// Mass centre minus p, in the axes on which the tree is built (the world's).
    pub com: Vec3,
    /// Angular velocity in the body's own axes.
    pub spin: Vec3,
    /// From the body's own axes to the world's.
    pub axes: Mat3,
}

/// Positions relative to the platform's mass centre.
pub struct Kinematics {
    pub bodies: Vec<Placement>,
    pub feet: [Vec3; 2],
}

/// The axes of a body.
#[derive(Clone)]
pub struct Frame {
    base: Mat3,
    /// Angular velocity of the base in its own axes.
    base_spin: Vec3,
    axis: Axis,
    /// Coordinates whose sum is the turn about `axis`.
    turn: Vec<Var>,
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
        match mechanism.rotation {
            Rotation::None => {}
            Rotation::Pitch => platform.turn.extend(theta),
            Rotation::Roll => {
                platform.axis = Axis::Roll;
                platform.turn.extend(theta);
            }
        }
        let tree = Tree::new(ring, platform, &mechanism.bodies, &quantities.bodies, &coordinates.q);
        let feet = [0, 1].map(|k| tree.point(ring, mechanism.legs[k].foot_body, &quantities.feet[k]));
        Kinematics { bodies: tree.bodies, feet }
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
                    (tree.frames[parent].0.turned(ring, body.axis, q[coordinate][0]), joint)
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

impl Frame {
    /// Axes in which positions are given, which turn with this angular velocity (in these axes).
    pub fn base(spin: Vec3) -> Frame {
        Frame { base: identity(), base_spin: spin, axis: Axis::Pitch, turn: Vec::new() }
    }

    fn rotation(&self, ring: &mut Ring) -> Mat3 {
        product(&self.base, &elementary(ring, self.axis, &self.turn))
    }

    /// Angular velocity in the frame's own axes.
    fn spin(&self, ring: &mut Ring) -> Vec3 {
        let turn = elementary(ring, self.axis, &self.turn);
        let mut spin = [0, 1, 2].map(|i| {
            let mut sum = Poly::zero();
            for (row, base) in turn.iter().zip(&self.base_spin) {
                sum += &(&row[i] * base);
            }
            sum
        });
        let rates: Vec<Var> = self.turn.iter().filter_map(|q| ring.rate_of(*q)).collect();
        spin[self.axis.index()] += &ring.sum(&rates);
        spin
    }

    /// The frame of a body that turns by `coordinate` about `axis` on this one.
    fn turned(&self, ring: &mut Ring, axis: Axis, coordinate: Var) -> Frame {
        let mut next = self.clone();
        if self.axis != axis && !self.turn.is_empty() {
            next = Frame { base: self.rotation(ring), base_spin: self.spin(ring), axis, turn: Vec::new() };
        }
        next.axis = axis;
        next.turn.push(coordinate);
        next
    }
}

fn elementary(ring: &mut Ring, axis: Axis, turn: &[Var]) -> Mat3 {
    let (s, c) = ring.sin_cos(turn);
    let i = axis.index();
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let mut m = identity();
    m[j][j] = c.clone();
    m[k][k] = c;
    m[k][j] = s.clone();
    m[j][k] = -&s;
    m
}

fn identity() -> Mat3 {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { Poly::constant(1.0) } else { Poly::zero() }))
}

pub fn zero() -> Vec3 {
    [Poly::zero(), Poly::zero(), Poly::zero()]
}

fn product(a: &Mat3, b: &Mat3) -> Mat3 {
    [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let mut sum = Poly::zero();
            for k in 0..3 {
                sum += &(&a[i][k] * &b[k][j]);
            }
            sum
        })
    })
}

pub fn rotate(m: &Mat3, v: &Vec3) -> Vec3 {
    [0, 1, 2].map(|i| {
        let mut sum = Poly::zero();
        for k in 0..3 {
            sum += &(&m[i][k] * &v[k]);
        }
        sum
    })
}

pub fn add(a: &Vec3, b: &Vec3) -> Vec3 {
    [0, 1, 2].map(|i| &a[i] + &b[i])
}

pub fn subtract(a: &Vec3, b: &Vec3) -> Vec3 {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

pub fn cross(a: &Vec3, b: &Vec3) -> Vec3 {
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&a[j] * &b[k]) - &(&a[k] * &b[j])
    })
}

pub fn dot(a: &Vec3, b: &Vec3) -> Poly {
    let mut sum = Poly::zero();
    for (x, y) in a.iter().zip(b) {
        sum += &(x * y);
    }
    sum
}
