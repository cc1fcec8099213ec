//! A positive definite stand-in for the exact Hessian W that costs as little of Newton's convergence as possible.
//!
//! Only the curvature along the active constraints matters. By Finsler's lemma W + γAᵀA is positive definite for large γ
//! exactly if W is so on the null space of the active normals A; and because (γ/2)‖Ad + b‖² vanishes on Ad + b = 0, adding it
//! to the subproblem (with its linear part γAᵀb) changes neither step nor multipliers as long as these constraints stay active.
//! Bounds on which variables rest are among them: without these, negative curvature towards a bound would cost all of Newton's convergence.
//!
//! If that is still indefinite, its negative eigenvalues change their sign, in a metric D that knows the variables' scales:
//! directions of negative curvature are descended as fast as their curvature says, all others stay Newton's.
//!
//! W stays what it is until the next iterate, however often its subproblem is solved with smaller radii; so does the stand-in.

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
    /// AᵀA.
    normal: Vec<f64>,
    /// The stand-in, the same without γAᵀA, and its linear part γAᵀb.
    augmented: Vec<f64>,
    plain: Vec<f64>,
    linear: Vec<f64>,
    /// Whether they are those of the present W, and whether it was augmented.
    known: Option<bool>,
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
            plain: vec![0.0; n * n],
            linear: vec![0.0; n],
            known: None,
            active: Vec::with_capacity(n),
            vectors: vec![0.0; n * n],
            lambda: vec![0.0; n],
            off: vec![0.0; n],
        }
    }

    /// Whether rows were expected to stay active in the last stand-in.
    pub(super) fn is_augmented(&self) -> bool {
        self.known == Some(true)
    }

    /// There is another W.
    pub(super) fn forget(&mut self) {
        self.known = None;
    }

    /// Writes the stand-in for `w` and its linear part into `qp` (whose gradient must be ∇f), and turns `w` itself into the
    /// stand-in without γAᵀA, the curvature of the model along the constraints. `model`: the quasi-Newton matrix, the stand-in
    /// of last resort. With `augment`, the rows that `qp` hints at are expected to stay active; else γ = 0.
    pub(super) fn convexify(&mut self, w: &mut [f64], qp: &mut Quadratic, model: &[f64], augment: bool) {
        if self.known != Some(augment) {
            self.plain.copy_from_slice(w);
            self.linear.fill(0.0);
            self.stand_in(qp, model, augment);
            self.known = Some(augment);
        }
        w.copy_from_slice(&self.plain);
        qp.hessian.copy_from_slice(&self.augmented);
        axpy(1.0, &self.linear, &mut qp.gradient);
    }

    /// Of W in `plain`.
    fn stand_in(&mut self, qp: &Quadratic, model: &[f64], augment: bool) {
        let n = qp.n;
        let size = max_abs(&self.plain).max(1e-8);
        // Barely definite is not enough: the steps of the active-set method would be noise.
        let floor = NOISE * size;
        self.augmented.copy_from_slice(&self.plain);
        if self.definite(n, floor) {
            return;
        }
        self.active.clear();
        if augment {
            self.active.extend((0..qp.len()).filter(|i| qp.hints[2 * n + i] == Place::Working));
            self.normal.fill(0.0);
            self.active.iter().for_each(|i| rank_one(1.0, qp.row(*i), &mut self.normal));
        }
        let resting = |j: &usize| {
            let at = |place: usize, bound: f64| bound == 0.0 && qp.hints[place] == Place::Working;
            at(*j, qp.lower[*j]) || at(n + j, qp.upper[*j])
        };
        let mut any = !self.active.is_empty();
        for j in (0..n).filter(|j| augment && resting(j)) {
            self.normal[j * n + j] += 1.0;
            any = true;
        }
        let mut gamma = 0.0;
        let mut definite = false;
        for candidate in [1e1, 1e3] {
            if !any || definite {
                break;
            }
            gamma = candidate * size;
            self.augment(gamma);
            definite = self.definite(n, floor);
        }
        if !definite {
            // A moderate γ keeps the eigenvectors of the two parts apart well enough.
            gamma = if any { 1e1 * size } else { 0.0 };
            self.augment(gamma);
            if !self.reflect(n, size) {
                self.plain.copy_from_slice(model);
                self.augmented.copy_from_slice(model);
                gamma = 0.0;
            }
        }
        if gamma > 0.0 {
            for &i in &self.active {
                axpy(gamma * qp.constants[i], qp.row(i), &mut self.linear);
            }
        }
    }

    /// W + γAᵀA.
    fn augment(&mut self, gamma: f64) {
        self.augmented.copy_from_slice(&self.plain);
        if gamma > 0.0 {
            axpy(gamma, &self.normal, &mut self.augmented);
        }
    }

    /// Adds (|λ| − λ)·(Dv)(Dv)ᵀ to both matrices for each eigenpair of D⁻¹(W + γAᵀA)D⁻¹ with λ < 0 (or nearly 0).
    fn reflect(&mut self, n: usize, size: f64) -> bool {
        self.vectors.copy_from_slice(&self.augmented);
        if !eigen::symmetric(&mut self.vectors, &mut self.lambda, &mut self.off) {
            return false;
        }
        for (lambda, vector) in self.lambda.iter().zip(self.vectors.chunks_exact(n)) {
            let wanted = lambda.abs().max(FLATTEST * size);
            if *lambda < wanted {
                rank_one(wanted - lambda, vector, &mut self.plain);
                rank_one(wanted - lambda, vector, &mut self.augmented);
            }
        }
        true
    }

    /// Whether `augmented` is.
    fn definite(&mut self, n: usize, floor: f64) -> bool {
        // The smallest squared pivot bounds the smallest eigenvalue from above; near enough as a safeguard.
        cholesky(&self.augmented, n, &mut self.u) && (0..n).all(|i| self.u[i * n + i] * self.u[i * n + i] > floor)
    }
}
