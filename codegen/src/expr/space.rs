//! Vectors of expressions, and frames that turn by coordinates.
//!
//! A frame is a base rotation followed by one turn about one axis. Joints about the same axis add
//! up to one absolute angle, so a planar chain has one sine and cosine per link and no products.

use super::{Poly, Ring, Var};

pub type Vec3 = [Poly; 3];
pub type Mat3 = [[Poly; 3]; 3];

/// The axes of a body.
#[derive(Clone)]
pub struct Frame {
    base: Mat3,
    /// Angular velocity of the base in its own axes.
    base_spin: Vec3,
    /// 0, 1, 2 for x, y, z.
    axis: usize,
    /// Coordinates whose sum is the turn about `axis`.
    turn: Vec<Var>,
}

impl Frame {
    /// Axes in which positions are given, which turn with this angular velocity (in these axes).
    pub fn base(spin: Vec3) -> Frame {
        Frame { base: identity(), base_spin: spin, axis: 2, turn: Vec::new() }
    }

    /// From these axes to those in which positions are given.
    pub fn rotation(&self, ring: &mut Ring) -> Mat3 {
        product(&self.base, &elementary(ring, self.axis, &self.turn))
    }

    /// Angular velocity in the frame's own axes.
    pub fn spin(&self, ring: &mut Ring) -> Vec3 {
        let turn = elementary(ring, self.axis, &self.turn);
        let mut spin = [0, 1, 2].map(|i| {
            let mut sum = Poly::zero();
            for (row, base) in turn.iter().zip(&self.base_spin) {
                sum += &(&row[i] * base);
            }
            sum
        });
        let rates: Vec<Var> = self.turn.iter().filter_map(|q| ring.rate_of(*q)).collect();
        spin[self.axis] += &ring.sum(&rates);
        spin
    }

    /// The frame of a body that turns by `coordinate` about `axis` on this one.
    pub fn turned(&self, ring: &mut Ring, axis: usize, coordinate: Var) -> Frame {
        let mut next = self.clone();
        if self.axis != axis && !self.turn.is_empty() {
            next = Frame { base: self.rotation(ring), base_spin: self.spin(ring), axis, turn: Vec::new() };
        }
        next.axis = axis;
        next.turn.push(coordinate);
        next
    }
}

fn elementary(ring: &mut Ring, axis: usize, turn: &[Var]) -> Mat3 {
    let (s, c) = ring.sin_cos(turn);
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
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
