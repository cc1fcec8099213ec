//! The factorization behind the dual method (Goldfarb & Idnani 1983, §4): with H = Uᵀ·U and the normals N of the working set,
//!
//! J = U⁻¹Q  and  JᵀN = [R; 0],   so that   JᵀHJ = I.
//!
//! The first q columns J₁ span the range of H⁻¹N, the others J₂ the null space of Nᵀ. Adding a normal is one Householder
//! reflection of J₂, removing one a few Givens rotations: O(n²) each, and orthogonal, so errors do not pile up.

use crate::dense::{axpy, cholesky, combine, dot, multiply, rotate};

#[derive(Clone, Debug, Default)]
pub(super) struct Factor {
    n: usize,
    /// Number of normals in the working set.
    pub(super) q: usize,
    /// J by columns.
    j: Vec<f64>,
    /// R by columns.
    r: Vec<f64>,
    u: Vec<f64>,
    /// A sum of columns of J.
    reflected: Vec<f64>,
    vector: Vec<f64>,
}

impl Factor {
    pub(super) fn new(n: usize) -> Self {
        Self {
            n,
            q: 0,
            j: vec![0.0; n * n],
            r: vec![0.0; n * n],
            u: vec![0.0; n * n],
            reflected: vec![0.0; n],
            vector: vec![0.0; n],
        }
    }

    /// Empty working set: J = U⁻¹. `false` if H is not positive definite.
    pub(super) fn start(&mut self, hessian: &[f64]) -> bool {
        let n = self.n;
        self.q = 0;
        if !cholesky(hessian, n, &mut self.u) {
            return false;
        }
        // Column k of U⁻¹ by forward substitution: once known, it is subtracted from all that come after.
        self.j.fill(0.0);
        for k in 0..n {
            let (done, rest) = self.j.split_at_mut((k + 1) * n);
            let (column, u) = (&mut done[k * n..=k * n + k], &self.u[k * n + k..(k + 1) * n]);
            column[k] = 1.0;
            column.iter_mut().for_each(|x| *x /= u[0]);
            for (u, later) in u[1..].iter().zip(rest.chunks_exact_mut(n)) {
                axpy(-u, column, later);
            }
        }
        true
    }

    /// w ← Jᵀa.
    pub(super) fn project(&self, a: &[f64], w: &mut [f64]) {
        multiply(&self.j, a, w);
    }

    /// w ← ±Jᵀeᵢ.
    pub(super) fn project_unit(&self, i: usize, sign: f64, w: &mut [f64]) {
        for (w, column) in w.iter_mut().zip(self.j.chunks_exact(self.n)) {
            *w = sign * column[i];
        }
    }

    /// d ← d + t·J₂w₂.
    pub(super) fn descend(&mut self, t: f64, w: &[f64], d: &mut [f64]) {
        self.reflected.fill(0.0);
        combine(&w[self.q..], &self.j[self.q * self.n..], &mut self.reflected);
        axpy(t, &self.reflected, d);
    }

    /// d ← d + J·u.
    pub(super) fn expand(&self, u: &[f64], d: &mut [f64]) {
        combine(u, &self.j, d);
    }

    /// x₁ ← R⁻¹·x₁.
    pub(super) fn solve(&self, x: &mut [f64]) {
        for k in (0..self.q).rev() {
            let column = &self.r[k * self.n..k * self.n + k + 1];
            let value = x[k] / column[k];
            x[k] = value;
            axpy(-value, &column[..k], &mut x[..k]);
        }
    }

    /// out ← R⁻ᵀ·b.
    pub(super) fn solve_transposed(&self, b: &[f64], out: &mut [f64]) {
        for k in 0..self.q {
            let column = &self.r[k * self.n..k * self.n + k + 1];
            out[k] = (b[k] - dot(&column[..k], &out[..k])) / column[k];
        }
    }

    /// Adds the normal a with w = Jᵀa. The caller has made sure that w₂ is not zero.
    pub(super) fn add(&mut self, w: &[f64]) {
        let (n, q) = (self.n, self.q);
        let length = dot(&w[q..n], &w[q..n]).sqrt();
        // Reflect w₂ onto −sign(w₂₁)·‖w₂‖·e₁: no cancellation.
        let alpha = if w[q] > 0.0 { -length } else { length };
        self.vector[q..n].copy_from_slice(&w[q..n]);
        self.vector[q] -= alpha;
        let beta = 1.0 / (length * (length + w[q].abs()));
        self.reflected.fill(0.0);
        let (vector, free) = (&self.vector[q..], &mut self.j[q * n..]);
        combine(vector, free, &mut self.reflected);
        for (v, column) in vector.iter().zip(free.chunks_exact_mut(n)) {
            axpy(-beta * v, &self.reflected, column);
        }
        let column = &mut self.r[q * n..(q + 1) * n];
        column[..q].copy_from_slice(&w[..q]);
        column[q] = alpha;
        self.q += 1;
    }

    /// Removes normal `k` of the working set; the later ones move up. What is Jᵀa in `w` stays that.
    pub(super) fn remove(&mut self, k: usize, w: &mut [f64]) {
        let (n, q) = (self.n, self.q);
        self.r.copy_within((k + 1) * n..q * n, k * n);
        self.q -= 1;
        for i in k..self.q {
            let (a, b) = (self.r[i * n + i], self.r[i * n + i + 1]);
            let length = (a * a + b * b).sqrt();
            if length == 0.0 {
                continue;
            }
            let (c, s) = (a / length, b / length);
            for column in self.r[i * n..self.q * n].chunks_exact_mut(n) {
                let (a, b) = (column[i], column[i + 1]);
                column[i] = c * a + s * b;
                column[i + 1] = c * b - s * a;
            }
            let (first, second) = self.j[i * n..(i + 2) * n].split_at_mut(n);
            rotate(c, s, first, second);
            (w[i], w[i + 1]) = (c * w[i] + s * w[i + 1], c * w[i + 1] - s * w[i]);
        }
    }
}
