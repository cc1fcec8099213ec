//! The problem in the units of the algorithm: z = x / scale, and constraint rows times a weight each. Everything behind this
//! file works with z; every number that is not finite becomes [`Undefined`] here.

use super::dense::max_abs;
use super::{Options, Problem, Undefined, Values};

pub(super) struct Scaled<'p, P: Problem> {
    problem: &'p mut P,
    pub(super) n: usize,
    pub(super) equalities: usize,
    pub(super) inequalities: usize,
    pub(super) scale: Vec<f64>,
    pub(super) equality_weights: Vec<f64>,
    /// Share of the tolerance within which each equality must be met.
    strictness: Vec<f64>,
    pub(super) inequality_weights: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    x: Vec<f64>,
    multipliers: (Vec<f64>, Vec<f64>),
    pub(super) evaluations: usize,
    pub(super) linearizations: usize,
}

/// A point and the (weighted) values of the functions there.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    pub(super) z: Vec<f64>,
    pub(super) values: Values,
    /// Σ of all (weighted) violations.
    pub(super) violation: f64,
}

impl Point {
    pub(super) fn new(n: usize, equalities: usize, inequalities: usize) -> Self {
        Self { z: vec![0.0; n], values: Values::zeros(equalities, inequalities), violation: 0.0 }
    }
}

impl<'p, P: Problem> Scaled<'p, P> {
    /// `None` if the lengths, the scales or the bounds make no sense.
    pub(super) fn new(problem: &'p mut P, x0: &[f64], options: &Options) -> Option<Self> {
        let n = problem.variables();
        let (equalities, inequalities) = (problem.equalities(), problem.inequalities());
        let scale = options.scale.clone().unwrap_or_else(|| vec![1.0; n]);
        let strictness: Vec<f64> = (0..equalities).map(|i| problem.strictness(i)).collect();
        let mut lower = vec![f64::NEG_INFINITY; n];
        let mut upper = vec![f64::INFINITY; n];
        problem.bounds(&mut lower, &mut upper);
        let sensible = n > 0
            && x0.len() == n
            && scale.len() == n
            && x0.iter().all(|x| x.is_finite())
            && scale.iter().all(|s| s.is_normal() && *s > 0.0)
            && strictness.iter().all(|s| *s > 0.0 && *s <= 1.0)
            // False for NaN too; a lower bound of +∞ or an upper one of −∞ leaves no point.
            && lower.iter().zip(&upper).all(|(l, u)| l <= u && *l < f64::INFINITY && *u > f64::NEG_INFINITY);
        sensible.then(|| Self {
            problem,
            n,
            equalities,
            inequalities,
            scale,
            equality_weights: vec![1.0; equalities],
            strictness,
            inequality_weights: vec![1.0; inequalities],
            lower,
            upper,
            x: vec![0.0; n],
            multipliers: (vec![0.0; equalities], vec![0.0; inequalities]),
            evaluations: 0,
            linearizations: 0,
        })
    }

    /// The bounds on z.
    pub(super) fn bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let divide = |bounds: &[f64]| bounds.iter().zip(&self.scale).map(|(b, s)| b / s).collect();
        (divide(&self.lower), divide(&self.upper))
    }

    /// z of a user's point, moved into the bounds.
    pub(super) fn enter(&self, x: &[f64], z: &mut [f64]) {
        for (j, z) in z.iter_mut().enumerate() {
            *z = x[j].max(self.lower[j]).min(self.upper[j]) / self.scale[j];
        }
    }

    /// The user's point of z; a rounding error never leaves the bounds.
    pub(super) fn leave(&self, z: &[f64], x: &mut [f64]) {
        for (j, x) in x.iter_mut().enumerate() {
            *x = (z[j] * self.scale[j]).max(self.lower[j]).min(self.upper[j]);
        }
    }

    /// Fills in the values at `point.z`.
    pub(super) fn evaluate(&mut self, point: &mut Point) -> Result<(), Undefined> {
        let mut x = std::mem::take(&mut self.x);
        self.leave(&point.z, &mut x);
        self.evaluations += 1;
        let outcome = self.problem.evaluate(&x, &mut point.values);
        self.x = x;
        outcome?;
        let values = &mut point.values;
        let lengths = values.equalities.len() == self.equalities && values.inequalities.len() == self.inequalities;
        if !lengths || !values.finite() {
            // Keeps the lengths right whatever the problem did to them.
            values.equalities.resize(self.equalities, 0.0);
            values.inequalities.resize(self.inequalities, 0.0);
            return Err(Undefined);
        }
        self.weigh(point);
        Ok(())
    }

    /// Applies the weights to values as the problem gave them.
    pub(super) fn weigh(&self, point: &mut Point) {
        let values = &mut point.values;
        point.violation = 0.0;
        for (c, w) in values.equalities.iter_mut().zip(&self.equality_weights) {
            *c *= w;
            point.violation += c.abs();
        }
        for (c, w) in values.inequalities.iter_mut().zip(&self.inequality_weights) {
            *c *= w;
            point.violation += (-*c).max(0.0);
        }
    }

    /// Largest violation in the problem's own units, of equalities by the measure of their tolerance.
    pub(super) fn raw_violation(&self, point: &Point) -> f64 {
        let mut worst: f64 = 0.0;
        for ((c, w), share) in point.values.equalities.iter().zip(&self.equality_weights).zip(&self.strictness) {
            worst = worst.max(c.abs() / (w * share));
        }
        for (c, w) in point.values.inequalities.iter().zip(&self.inequality_weights) {
            worst = worst.max(-c / w);
        }
        worst
    }

    /// Values back in the problem's own units.
    pub(super) fn unweigh(&self, point: &mut Point) {
        let Values { equalities, inequalities, .. } = &mut point.values;
        equalities.iter_mut().zip(&self.equality_weights).for_each(|(c, w)| *c /= w);
        inequalities.iter_mut().zip(&self.inequality_weights).for_each(|(c, w)| *c /= w);
    }

    /// Linearizes at the latest evaluated point and gives ∇f.
    pub(super) fn linearize(&mut self, gradient: &mut [f64]) -> Result<(), Undefined> {
        self.linearizations += 1;
        self.problem.linearize(&self.x)?;
        gradient.fill(0.0);
        self.problem.gradient(gradient);
        self.finish_row(1.0, gradient)
    }

    pub(super) fn equality_row(&self, i: usize, row: &mut [f64]) -> Result<(), Undefined> {
        row.fill(0.0);
        self.problem.equality_row(i, row);
        self.finish_row(self.equality_weights[i], row)
    }

    pub(super) fn inequality_row(&self, i: usize, row: &mut [f64]) -> Result<(), Undefined> {
        row.fill(0.0);
        self.problem.inequality_row(i, row);
        self.finish_row(self.inequality_weights[i], row)
    }

    /// Number of kinks of f.
    pub(super) fn kinks(&self) -> usize {
        self.problem.kinks()
    }

    /// ∇c of a kink, and its price.
    pub(super) fn kink(&self, i: usize, row: &mut [f64]) -> Result<f64, Undefined> {
        row.fill(0.0);
        let price = self.problem.kink(i, row);
        self.finish_row(1.0, row)?;
        if price.is_finite() { Ok(price) } else { Err(Undefined) }
    }

    /// Number of folds of f.
    pub(super) fn folds(&self) -> usize {
        self.problem.folds()
    }

    /// c of a fold, if f has it now.
    pub(super) fn fold(&self, i: usize) -> Result<Option<f64>, Undefined> {
        let value = self.problem.fold(i);
        if value.is_none_or(f64::is_finite) { Ok(value) } else { Err(Undefined) }
    }

    /// ∇c of a fold.
    pub(super) fn fold_row(&self, i: usize, row: &mut [f64]) -> Result<(), Undefined> {
        row.fill(0.0);
        self.problem.fold_row(i, row);
        self.finish_row(1.0, row)
    }

    fn finish_row(&self, weight: f64, row: &mut [f64]) -> Result<(), Undefined> {
        for (a, s) in row.iter_mut().zip(&self.scale) {
            *a *= weight * s;
        }
        if row.iter().all(|a| a.is_finite()) { Ok(()) } else { Err(Undefined) }
    }

    /// J_I·d, and ∇c·d of all folds; `scratch` holds d in the user's units.
    pub(super) fn directions(
        &self,
        d: &[f64],
        scratch: &mut [f64],
        out: &mut [f64],
        folds: &mut [f64],
    ) -> Result<(), Undefined> {
        for ((s, d), scale) in scratch.iter_mut().zip(d).zip(&self.scale) {
            *s = d * scale;
        }
        self.problem.directions(scratch, out, folds);
        for (o, w) in out.iter_mut().zip(&self.inequality_weights) {
            *o *= w;
        }
        if out.iter().chain(&*folds).all(|o| o.is_finite()) { Ok(()) } else { Err(Undefined) }
    }

    /// The Hessian of f·(objective? 1 : 0) − λᵀc_E − μᵀc_I in z, in full. `false`: the problem has none.
    pub(super) fn hessian(&mut self, lambda: &[f64], mu: &[f64], out: &mut [f64]) -> bool {
        for ((own, m), w) in self.multipliers.0.iter_mut().zip(lambda).zip(&self.equality_weights) {
            *own = m * w;
        }
        for ((own, m), w) in self.multipliers.1.iter_mut().zip(mu).zip(&self.inequality_weights) {
            *own = m * w;
        }
        out.fill(0.0);
        if !self.problem.hessian(&self.multipliers.0, &self.multipliers.1, out) {
            return false;
        }
        let n = self.n;
        for i in 0..n {
            for j in 0..=i {
                let h = out[i * n + j] * self.scale[i] * self.scale[j];
                out[i * n + j] = h;
                out[j * n + i] = h;
            }
        }
        out.iter().all(|h| h.is_finite())
    }

    /// Chooses the weights of the rows at the linearized point: the largest component of each gradient becomes one, within
    /// limits that keep a gradient which merely vanishes here from being blown up.
    pub(super) fn weigh_rows(&mut self) -> Result<(), Undefined> {
        let mut row = vec![0.0; self.n];
        for i in 0..self.equalities {
            self.equality_row(i, &mut row)?;
            self.equality_weights[i] = 1.0 / max_abs(&row).clamp(1e-2, 1e8);
        }
        for i in 0..self.inequalities {
            self.inequality_row(i, &mut row)?;
            self.inequality_weights[i] = 1.0 / max_abs(&row).clamp(1e-2, 1e8);
        }
        Ok(())
    }
}
