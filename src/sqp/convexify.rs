//! A positive definite stand-in for the exact Hessian W that costs as little of Newton's convergence as possible.
//!
//! Only the curvature along the active constraints matters. By Finsler's lemma W + γAᵀA is positive definite for large γ
//! exactly if W is so on the null space of the active normals A; and because (γ/2)‖Ad + b‖² vanishes on Ad + b = 0, adding it
//! to the subproblem (with its linear part γAᵀb) changes neither step nor multipliers as long as these constraints stay active.
//! Only if that fails too is W shifted: not by a multiple of I, which knows nothing of the variables' scales, but by one of the
//! positive definite quasi-Newton matrix B that is kept alongside, W + τB. The shift is remembered, as in Ipopt (Wächter &
//! Biegler 2006), so that a run of indefinite Hessians costs few factorizations.

use super::dense::{axpy, cholesky, max_abs, rank_one};
use super::qp::{Place, Quadratic};

#[derive(Clone, Debug)]
pub(super) struct Convexifier {
    l: Vec<f64>,
    augmented: Vec<f64>,
    active: Vec<usize>,
    shift: f64,
}

impl Convexifier {
    pub(super) fn new(n: usize) -> Self {
        Self { l: vec![0.0; n * n], augmented: vec![0.0; n * n], active: Vec::new(), shift: 0.0 }
    }

    /// Writes the stand-in for `w` and its linear part into `qp` (whose gradient must be ∇f), and adds the shift by `model` to
    /// `w` itself, so that `w` remains the curvature of the model. The rows to count on are those that `qp` hints at.
    pub(super) fn convexify(&mut self, w: &mut [f64], qp: &mut Quadratic, model: &[f64], augment: bool) {
        let n = qp.n;
        self.active.clear();
        self.active.extend((0..qp.len()).filter(|i| augment && qp.hints[2 * n + i] == Place::Working));
        let size = max_abs(w).max(1e-8);
        // Barely definite is not enough: the steps of the active-set method would be noise.
        let floor = 1e-8 * size;
        if self.definite(w, n, floor) {
            qp.hessian.copy_from_slice(w);
            self.shift = 0.0;
            return;
        }
        let mut gamma = 0.0;
        for candidate in [1e1, 1e3] {
            self.augmented.copy_from_slice(w);
            for &i in &self.active {
                rank_one(candidate * size, qp.row(i), &mut self.augmented);
            }
            let augmented = std::mem::take(&mut self.augmented);
            let definite = self.definite(&augmented, n, floor);
            self.augmented = augmented;
            gamma = candidate * size;
            if definite {
                break;
            }
        }
        let augmented = std::mem::take(&mut self.augmented);
        let definite = self.definite(&augmented, n, floor);
        self.augmented = augmented;
        if definite {
            qp.hessian.copy_from_slice(&self.augmented);
            for &i in &self.active {
                let b = qp.constants[i];
                axpy(gamma * b, &qp.rows[i * n..(i + 1) * n], &mut qp.gradient);
            }
            return;
        }
        // γ as large as this would only make the matrix ill-conditioned: W + τB alone.
        let mut tau = if self.shift > 0.0 { 0.1 * self.shift } else { 1e-2 };
        while tau < 1e4 && !self.definite_shifted(w, n, tau, model, floor) {
            tau *= 4.0;
        }
        self.shift = tau.min(1e2);
        if tau >= 1e4 {
            w.fill(0.0);
            tau = 1.0;
        }
        shift(tau, model, n, w);
        qp.hessian.copy_from_slice(w);
    }

    fn definite(&mut self, a: &[f64], n: usize, floor: f64) -> bool {
        // The smallest squared pivot bounds the smallest eigenvalue from above; near enough as a safeguard.
        cholesky(a, n, &mut self.l) && (0..n).all(|i| self.l[i * n + i] * self.l[i * n + i] > floor)
    }

    fn definite_shifted(&mut self, w: &[f64], n: usize, tau: f64, model: &[f64], floor: f64) -> bool {
        self.augmented.copy_from_slice(w);
        shift(tau, model, n, &mut self.augmented);
        let shifted = std::mem::take(&mut self.augmented);
        let definite = self.definite(&shifted, n, floor);
        self.augmented = shifted;
        definite
    }
}

/// W + τ(B + diag B): where B has forgotten a direction, its diagonal still knows the variables' scales.
fn shift(tau: f64, model: &[f64], n: usize, w: &mut [f64]) {
    axpy(tau, model, w);
    for (w, b) in w.iter_mut().step_by(n + 1).zip(model.iter().step_by(n + 1)) {
        *w += 0.1 * tau * b;
    }
}
