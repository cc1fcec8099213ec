//! A positive definite stand-in for the exact Hessian W that costs as little of Newton's convergence as possible.
//!
//! Only the curvature along the active constraints matters. By Finsler's lemma W + γAᵀA is positive definite for large γ
//! exactly if W is so on the null space of the active normals A; and because (γ/2)‖Ad + b‖² vanishes on Ad + b = 0, adding it
//! to the subproblem (with its linear part γAᵀb) changes neither step nor multipliers as long as these constraints stay active.
//!
//! If that is still indefinite, its negative eigenvalues change their sign, in a metric D that knows the variables' scales:
//! directions of negative curvature are descended as fast as their curvature says, all others stay Newton's.

use super::dense::{axpy, cholesky, max_abs, rank_one};
use super::eigen;
use super::qp::{Place, Quadratic};

/// Curvature that rounding hides, beside the largest.
const NOISE: f64 = 1e-12;
/// Flattest curvature of the stand-in, beside the largest: a valley much flatter than its walls are steep is still descended in long
/// steps.
const FLATTEST: f64 = 1e-10;

#[derive(Clone, Debug)]
pub(super) struct Convexifier {
    u: Vec<f64>,
    /// AᵀA, and W + γAᵀA.
    normal: Vec<f64>,
    augmented: Vec<f64>,
    active: Vec<usize>,
    vectors: Vec<f64>,
    lambda: Vec<f64>,
    off: Vec<f64>,
}

impl Convexifier {
    pub(super) fn new(n: usize) -> Self {
        Self {
            u: vec![0.0; n * n],
            normal: vec![0.0; n * n],
            augmented: vec![0.0; n * n],
            active: Vec::with_capacity(n),
            vectors: vec![0.0; n * n],
            lambda: vec![0.0; n],
            off: vec![0.0; n],
        }
    }

    /// Writes the stand-in for `w` and its linear part into `qp` (whose gradient must be ∇f), and turns `w` itself into the
    /// stand-in without γAᵀA, the curvature of the model along the constraints. `model`: the quasi-Newton matrix, the stand-in
    /// of last resort. With `augment`, the rows that `qp` hints at are expected to stay active; else γ = 0.
    pub(super) fn convexify(&mut self, w: &mut [f64], qp: &mut Quadratic, model: &[f64], augment: bool) {
        let n = qp.n;
        let size = max_abs(w).max(1e-8);
        // Barely definite is not enough: the steps of the active-set method would be noise.
        let floor = NOISE * size;
        if self.definite(w, n, floor) {
            qp.hessian.copy_from_slice(w);
            return;
        }
        self.active.clear();
        if augment {
            self.active.extend((0..qp.len()).filter(|i| qp.hints[2 * n + i] == Place::Working));
            self.normal.fill(0.0);
            self.active.iter().for_each(|i| rank_one(1.0, qp.row(*i), &mut self.normal));
        }
        let mut gamma = 0.0;
        let mut definite = false;
        for candidate in [1e1, 1e3] {
            if self.active.is_empty() || definite {
                break;
            }
            gamma = candidate * size;
            self.augment(w, gamma);
            let augmented = std::mem::take(&mut self.augmented);
            definite = self.definite(&augmented, n, floor);
            self.augmented = augmented;
        }
        if !definite {
            // A moderate γ keeps the eigenvectors of the two parts apart well enough.
            gamma = if self.active.is_empty() { 0.0 } else { 1e1 * size };
            self.augment(w, gamma);
            if !self.reflect(w, n, size) {
                w.copy_from_slice(model);
                self.augmented.copy_from_slice(model);
                gamma = 0.0;
            }
        }
        qp.hessian.copy_from_slice(&self.augmented);
        if gamma > 0.0 {
            for &i in &self.active {
                let b = qp.constants[i];
                axpy(gamma * b, &qp.rows[i * n..(i + 1) * n], &mut qp.gradient);
            }
        }
    }

    /// W + γAᵀA.
    fn augment(&mut self, w: &[f64], gamma: f64) {
        self.augmented.copy_from_slice(w);
        if gamma > 0.0 {
            axpy(gamma, &self.normal, &mut self.augmented);
        }
    }

    /// Adds (|λ| − λ)·(Dv)(Dv)ᵀ to both matrices for each eigenpair of D⁻¹(W + γAᵀA)D⁻¹ with λ < 0 (or nearly 0).
    fn reflect(&mut self, w: &mut [f64], n: usize, size: f64) -> bool {
        self.vectors.copy_from_slice(&self.augmented);
        if !eigen::symmetric(&mut self.vectors, &mut self.lambda, &mut self.off) {
            return false;
        }
        for k in 0..n {
            let lambda = self.lambda[k];
            let wanted = lambda.abs().max(FLATTEST * size);
            if lambda < wanted {
                let vector = &self.vectors[k * n..(k + 1) * n];
                rank_one(wanted - lambda, vector, w);
                rank_one(wanted - lambda, vector, &mut self.augmented);
            }
        }
        true
    }

    fn definite(&mut self, a: &[f64], n: usize, floor: f64) -> bool {
        // The smallest squared pivot bounds the smallest eigenvalue from above; near enough as a safeguard.
        cholesky(a, n, &mut self.u) && (0..n).all(|i| self.u[i * n + i] * self.u[i * n + i] > floor)
    }
}
