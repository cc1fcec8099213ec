//! Rigid bodies put together: masses add, and moments of inertia by the parallel axis theorem.

use super::types::{Axis, Inertia};
use crate::math::sin_cos;

pub(super) type Rotation3 = [[f64; 3]; 3];

pub(super) const IDENTITY: Rotation3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Mass, mass centre and inertia about it, in one frame; kg, m, kg·m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rigid {
    pub mass: f64,
    pub com: [f64; 3],
    pub inertia: Inertia,
}

impl Rigid {
    /// A point mass.
    pub fn point(mass: f64, com: [f64; 3]) -> Rigid {
        Rigid { mass, com, inertia: [[0.0; 3]; 3] }
    }

    /// Both bodies as one.
    pub fn with(&self, other: &Rigid) -> Rigid {
        let mass = self.mass + other.mass;
        let apart = [0, 1, 2].map(|i| other.com[i] - self.com[i]);
        let share = if mass > 0.0 { other.mass / mass } else { 0.0 };
        let reduced = self.mass * share;
        let square: f64 = apart.iter().map(|x| x * x).sum();
        Rigid {
            mass,
            com: [0, 1, 2].map(|i| self.com[i] + share * apart[i]),
            inertia: [0, 1, 2].map(|i| {
                [0, 1, 2].map(|j| {
                    let steiner = if i == j { square } else { 0.0 } - apart[i] * apart[j];
                    self.inertia[i][j] + other.inertia[i][j] + reduced * steiner
                })
            }),
        }
    }

    /// The body turned by `rotation` about the origin, then moved by `offset`.
    pub fn moved(&self, rotation: &Rotation3, offset: [f64; 3]) -> Rigid {
        let com = apply(rotation, &self.com);
        let half = times(rotation, &self.inertia);
        Rigid {
            mass: self.mass,
            com: [0, 1, 2].map(|i| com[i] + offset[i]),
            // R I Rᵀ
            inertia: half.map(|row| rotation.map(|other| (0..3).map(|k| row[k] * other[k]).sum())),
        }
    }

    /// Whether some distribution of mass has this inertia: ∫ r rᵀ dm = ½ tr(I) 1 − I is positive semidefinite.
    pub fn is_possible(&self) -> bool {
        let trace: f64 = (0..3).map(|i| self.inertia[i][i]).sum();
        if trace == 0.0 {
            return self.inertia.as_flattened().iter().all(|x| *x == 0.0);
        }
        // In units of the trace. Some slack for data in decimal digits: a flat plate has exactly a zero here.
        let slack = 1e-9;
        let s = |i: usize, j: usize| if i == j { 0.5 + slack } else { 0.0 } - self.inertia[i][j] / trace;
        let minor = |i: usize, j: usize| s(i, i) * s(j, j) - s(i, j) * s(i, j);
        let determinant = s(0, 0) * minor(1, 2) - s(0, 1) * (s(0, 1) * s(2, 2) - s(1, 2) * s(0, 2))
            + s(0, 2) * (s(0, 1) * s(1, 2) - s(1, 1) * s(0, 2));
        (0..3).all(|i| s(i, i) >= 0.0)
            && [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| minor(i, j) >= -slack)
            && determinant >= -slack
    }
}

/// The turn by `angle` about a coordinate axis.
pub(super) fn turn(axis: Axis, angle: f64) -> Rotation3 {
    let (sin, cos) = sin_cos(angle);
    let i = axis.index();
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let mut turn = IDENTITY;
    (turn[j][j], turn[k][k], turn[k][j], turn[j][k]) = (cos, cos, sin, -sin);
    turn
}

pub(super) fn times(a: &Rotation3, b: &Rotation3) -> Rotation3 {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

pub(super) fn apply(a: &Rotation3, v: &[f64; 3]) -> [f64; 3] {
    a.map(|row| row.iter().zip(v).map(|(x, y)| x * y).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    /// Points of a cube as one body have the moments of their sum, in any frame.
    #[test]
    fn points_add_up() {
        let corners = [[0.1, 0.2, -0.3], [0.4, -0.1, 0.2], [-0.2, 0.3, 0.1], [0.0, 0.1, 0.5]];
        let masses = [1.0, 0.5, 2.0, 0.3];
        let rotation = times(&turn(Axis::Roll, 0.7), &turn(Axis::Pitch, -1.1));
        let shift = [0.3, -0.2, 0.9];
        let all = |points: &[[f64; 3]]| {
            let each = points.iter().zip(masses).map(|(at, mass)| Rigid::point(mass, *at));
            each.reduce(|a, b| a.with(&b)).unwrap()
        };
        let moved = corners.map(|c| {
            let r = apply(&rotation, &c);
            [0, 1, 2].map(|i| r[i] + shift[i])
        });
        let (direct, carried) = (all(&moved), all(&corners).moved(&rotation, shift));
        assert!(direct.is_possible() && close(direct.mass, 3.8));
        for i in 0..3 {
            assert!(close(direct.com[i], carried.com[i]));
            let mean: f64 = moved.iter().zip(masses).map(|(c, m)| m * c[i]).sum::<f64>() / 3.8;
            assert!(close(direct.com[i], mean));
            for j in 0..3 {
                assert!(close(direct.inertia[i][j], carried.inertia[i][j]), "{i} {j}");
                let moment: f64 = moved
                    .iter()
                    .zip(masses)
                    .map(|(c, m)| {
                        let d = [0, 1, 2].map(|k| c[k] - direct.com[k]);
                        let square: f64 = d.iter().map(|x| x * x).sum();
                        m * (if i == j { square } else { 0.0 } - d[i] * d[j])
                    })
                    .sum();
                assert!(close(direct.inertia[i][j], moment), "{i} {j}");
            }
        }
    }

    #[test]
    fn products_too_large_for_their_moments_are_impossible() {
        let body = |product| Rigid {
            mass: 1.0,
            com: [0.0; 3],
            inertia: [[1.0, product, 0.0], [product, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        assert!(body(0.49).is_possible() && body(-0.49).is_possible());
        assert!(!body(0.51).is_possible() && !body(-0.51).is_possible());
    }
}
