//! Damped BFGS (Powell 1978): with s = z⁺ − z and y = ∇L(z⁺, λ⁺) − ∇L(z, λ⁺),
//!
//! B⁺ = B − B s sᵀB / sᵀBs + r rᵀ / sᵀr,   r = θy + (1 − θ)Bs,   θ < 1 only where sᵀy < 0.2·sᵀBs.
//!
//! The Lagrangian need not be convex off the constraints; damping keeps B positive definite all the same.

use super::dense::{axpy, dot, multiply, rank_one};

#[derive(Clone, Debug)]
pub(super) struct QuasiNewton {
    /// B, in full.
    pub(super) b: Vec<f64>,
    bs: Vec<f64>,
    r: Vec<f64>,
    /// No curvature has been seen since the last reset.
    pub(super) fresh: bool,
    size: f64,
}

impl QuasiNewton {
    pub(super) fn new(n: usize) -> Self {
        let mut model = Self { b: vec![0.0; n * n], bs: vec![0.0; n], r: vec![0.0; n], fresh: true, size: 1.0 };
        model.reset(1.0);
        model
    }

    /// B = size·I.
    pub(super) fn reset(&mut self, size: f64) {
        let n = self.bs.len();
        self.size = if size.is_finite() { size.clamp(1e-8, 1e12) } else { 1.0 };
        self.fresh = true;
        self.b.fill(0.0);
        self.b.iter_mut().step_by(n + 1).for_each(|b| *b = self.size);
    }

    /// Learns the curvature along `s` from the change `y` of the Lagrangian's gradient.
    pub(super) fn update(&mut self, s: &[f64], y: &[f64]) {
        let (ss, sy, yy) = (dot(s, s), dot(s, y), dot(y, y));
        if !(ss > 0.0 && sy.is_finite() && yy.is_finite()) {
            return;
        }
        if self.fresh && sy > 1e-4 * (ss * yy).sqrt() {
            // The first pair gives the scale of the whole matrix (Nocedal & Wright eq. 6.20), within reason: the first
            // step may have been a wild one.
            let size = (yy / sy).clamp(1e-4 * self.size, 1e4 * self.size);
            self.reset(size);
        }
        self.fresh = false;
        multiply(&self.b, s, &mut self.bs);
        let sbs = dot(s, &self.bs);
        if !(sbs > 0.0 && sbs.is_finite()) {
            self.reset(self.size);
            return;
        }
        let theta = if sy < 0.2 * sbs { 0.8 * sbs / (sbs - sy) } else { 1.0 };
        self.r.fill(0.0);
        axpy(theta, y, &mut self.r);
        axpy(1.0 - theta, &self.bs, &mut self.r);
        let sr = dot(s, &self.r);
        rank_one(-1.0 / sbs, &self.bs, &mut self.b);
        rank_one(1.0 / sr, &self.r, &mut self.b);
        self.symmetrize();
    }

    /// Rounding in the updates is not symmetric; the factorization reads one triangle and the products read both.
    fn symmetrize(&mut self) {
        let n = self.bs.len();
        for i in 0..n {
            for j in 0..i {
                self.b[j * n + i] = self.b[i * n + j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_secant_equation_holds() {
        let mut model = QuasiNewton::new(2);
        let (s, y) = ([1.0, 2.0], [3.0, 1.0]);
        model.update(&s, &y);
        let mut bs = [0.0; 2];
        multiply(&model.b, &s, &mut bs);
        assert!((bs[0] - y[0]).abs() < 1e-12 && (bs[1] - y[1]).abs() < 1e-12);
    }

    #[test]
    fn negative_curvature_leaves_it_positive_definite() {
        let mut model = QuasiNewton::new(2);
        model.update(&[1.0, 0.5], &[-2.0, -1.0]);
        assert!(super::super::dense::cholesky(&model.b, 2, &mut [0.0; 4]));
    }
}
