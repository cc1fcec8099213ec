//! The factorization behind the dual method (Goldfarb & Idnani 1983, §4): with H = L·Lᵀ and the normals N of the working set,
//!
//! J = L⁻ᵀQ  and  JᵀN = [R; 0],   so that   JᵀHJ = I.
//!
//! The first q columns J₁ span the range of H⁻¹N, the others J₂ the null space of Nᵀ. Adding a normal is one Householder
//! reflection of J₂, removing one a few Givens rotations: O(n²) each, and orthogonal, so errors do not pile up.

use crate::dense::{axpy, cholesky, dot, rotate};

#[derive(Clone, Debug, Default)]
pub(super) struct Factor {
    n: usize,
    /// Number of normals in the working set.
    pub(super) q: usize,
    /// J by columns.
    j: Vec<f64>,
    /// R by columns.
    r: Vec<f64>,
    l: Vec<f64>,
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
            l: vec![0.0; n * n],
            reflected: vec![0.0; n],
            vector: vec![0.0; n],
        }
    }

    /// Empty working set: J = L⁻ᵀ. `false` if H is not positive definite.
    pub(super) fn start(&mut self, hessian: &[f64]) -> bool {
        let n = self.n;
        self.q = 0;
        if !cholesky(hessian, n, &mut self.l) {
            return false;
        }
        // Column i of L⁻ᵀ is row i of L⁻¹: a forward substitution over whole rows.
        for i in 0..n {
            let (above, row) = self.j.split_at_mut(i * n);
            let row = &mut row[..n];
            row.fill(0.0);
            let inverse = 1.0 / self.l[i * n + i];
            for k in 0..i {
                axpy(-self.l[i * n + k] * inverse, &above[k * n..k * n + k + 1], row);
            }
            row[i] = inverse;
        }
        true
    }

    pub(super) fn column(&self, k: usize) -> &[f64] {
        &self.j[k * self.n..(k + 1) * self.n]
    }

    /// w ← Jᵀa.
    pub(super) fn project(&self, a: &[f64], w: &mut [f64]) {
        for (w, column) in w.iter_mut().zip(self.j.chunks_exact(self.n)) {
            *w = dot(column, a);
        }
    }

    /// w ← ±Jᵀeᵢ.
    pub(super) fn project_unit(&self, i: usize, sign: f64, w: &mut [f64]) {
        for (w, column) in w.iter_mut().zip(self.j.chunks_exact(self.n)) {
            *w = sign * column[i];
        }
    }

    /// d ← d + t·J₂w₂.
    pub(super) fn descend(&self, t: f64, w: &[f64], d: &mut [f64]) {
        for k in self.q..self.n {
            axpy(t * w[k], self.column(k), d);
        }
    }

    /// d ← d + J·u.
    pub(super) fn expand(&self, u: &[f64], d: &mut [f64]) {
        for (column, u) in self.j.chunks_exact(self.n).zip(u) {
            axpy(*u, column, d);
        }
    }

    /// out ← R⁻¹·w₁.
    pub(super) fn solve(&self, w: &[f64], out: &mut [f64]) {
        let q = self.q;
        out[..q].copy_from_slice(&w[..q]);
        for k in (0..q).rev() {
            let column = &self.r[k * self.n..k * self.n + k + 1];
            let value = out[k] / column[k];
            out[k] = value;
            axpy(-value, &column[..k], &mut out[..k]);
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
        for k in q..n {
            axpy(self.vector[k], &self.j[k * n..(k + 1) * n], &mut self.reflected);
        }
        for k in q..n {
            axpy(-beta * self.vector[k], &self.reflected, &mut self.j[k * n..(k + 1) * n]);
        }
        let column = &mut self.r[q * n..(q + 1) * n];
        column[..q].copy_from_slice(&w[..q]);
        column[q] = alpha;
        self.q += 1;
    }

    /// Removes normal `k` of the working set; the later ones move up.
    pub(super) fn remove(&mut self, k: usize) {
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
        }
    }
}
