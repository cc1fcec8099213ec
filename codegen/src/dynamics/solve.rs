//! Solution of small symmetric positive definite systems, unrolled: A = L D Lᵀ.

#![allow(clippy::needless_range_loop, reason = "indices as in the formulas")]

use crate::expr::{Poly, Ring};

/// The factors of a symmetric matrix, as bound atoms.
pub struct Factors {
    /// Strictly lower part of L, row by row.
    lower: Vec<Vec<Poly>>,
    /// The pivots D.
    pub pivots: Vec<Poly>,
    reciprocals: Vec<Poly>,
}

impl Factors {
    /// Factors `matrix` (its lower triangle is read).
    pub fn new(ring: &mut Ring, matrix: &[Vec<Poly>]) -> Factors {
        let n = matrix.len();
        let mut f = Factors { lower: Vec::new(), pivots: Vec::new(), reciprocals: Vec::new() };
        for i in 0..n {
            // u[j] = L[i][j] · D[j]
            let mut row = Vec::new();
            let mut u: Vec<Poly> = Vec::new();
            for j in 0..i {
                let mut value = matrix[i][j].clone();
                for k in 0..j {
                    value = &value - &(&u[k] * &f.lower[j][k]);
                }
                let value = ring.bind(value);
                row.push(ring.bind(&value * &f.reciprocals[j]));
                u.push(value);
            }
            let mut pivot = matrix[i][i].clone();
            for (a, b) in u.iter().zip(&row) {
                pivot = &pivot - &(a * b);
            }
            let pivot = ring.bind(pivot);
            f.reciprocals.push(ring.reciprocal(pivot.clone()));
            f.pivots.push(pivot);
            f.lower.push(row);
        }
        f
    }

    /// The solution of A x = b as bound atoms.
    pub fn solve(&self, ring: &mut Ring, b: &[Poly]) -> Vec<Poly> {
        let n = b.len();
        let mut y: Vec<Poly> = Vec::with_capacity(n);
        for i in 0..n {
            let mut value = b[i].clone();
            for k in 0..i {
                value = &value - &(&self.lower[i][k] * &y[k]);
            }
            y.push(ring.bind(value));
        }
        let mut x = y;
        for i in (0..n).rev() {
            let mut value = &x[i] * &self.reciprocals[i];
            for k in i + 1..n {
                value = &value - &(&self.lower[k][i] * &x[k]);
            }
            x[i] = ring.bind(value);
        }
        x
    }
}
