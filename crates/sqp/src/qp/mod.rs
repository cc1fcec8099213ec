//! The quadratic subproblem, with a bound on every multiplier:
//!
//! minimize ½ dᵀHd + gᵀd + Σ wᵢ·|aᵢᵀd + bᵢ|₋ + Σ wⱼ·|aⱼᵀd + bⱼ| subject to lower ≤ d ≤ upper,
//!
//! where |·|₋ = max(0, −·) penalizes inequalities and |·| equalities. With a weight wᵢ = ∞ a constraint is hard. The dual
//! explains the name of the weights: the multipliers obey 0 ≤ yᵢ ≤ wᵢ and |yⱼ| ≤ wⱼ, so the elastic (ℓ1) relaxation of a
//! quadratic program is the same program with its multipliers capped. Optimality, with rᵢ = aᵢᵀd + bᵢ:
//!
//! Hd + g = Aᵀy + ν,   yᵢ = clamp(yᵢ − rᵢ, 0 or −wᵢ, wᵢ),   and likewise for the bounds with multipliers ν.
//!
//! [`active_set`] solves it, [`interior`] (Clarabel) is the judge, and [`Quadratic::residual`] is the law for both.

pub mod active_set;
mod factor;
pub mod interior;
mod working_set;

use super::dense::{axpy, dot, max_abs, multiply, norm};

/// One quadratic subproblem. Rows are normalized to ‖aᵢ‖₂ = 1 as they come in.
#[derive(Clone, Debug, Default)]
pub struct Quadratic {
    /// Number of variables.
    pub n: usize,
    /// H, symmetric positive definite, stored in full.
    pub hessian: Vec<f64>,
    /// g.
    pub gradient: Vec<f64>,
    /// Lower bounds on d.
    pub lower: Vec<f64>,
    /// Upper bounds on d.
    pub upper: Vec<f64>,
    pub(super) rows: Vec<f64>,
    pub(super) constants: Vec<f64>,
    pub(super) limits: Vec<f64>,
    pub(super) equality: Vec<bool>,
    pub(super) norms: Vec<f64>,
    /// Guess of the active set: n lower bounds, n upper bounds, then the rows.
    pub(super) hints: Vec<Place>,
}

/// Where a constraint stands in the active set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Place {
    /// Multiplier zero.
    #[default]
    Off,
    /// Satisfied as an equation.
    Working,
    /// Multiplier at its upper limit: the constraint gives way.
    Full,
    /// Multiplier of an equality at minus its limit.
    Empty,
}

/// Solution of a [`Quadratic`].
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// d.
    pub d: Vec<f64>,
    /// y, of the normalized rows.
    pub multipliers: Vec<f64>,
    /// ν: positive at a lower bound, negative at an upper one.
    pub bound_multipliers: Vec<f64>,
}

impl Step {
    /// A step without content, and room for one of `n` variables and `rows` rows.
    pub(super) fn with_room(n: usize, rows: usize) -> Self {
        Self {
            d: Vec::with_capacity(n),
            multipliers: Vec::with_capacity(rows),
            bound_multipliers: Vec::with_capacity(n),
        }
    }

    /// Takes over another step's numbers.
    pub(super) fn copy(&mut self, other: &Self) {
        self.d.clone_from(&other.d);
        self.multipliers.clone_from(&other.multipliers);
        self.bound_multipliers.clone_from(&other.bound_multipliers);
    }
}

/// Why a quadratic program was not solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// H is not positive definite.
    #[error("the Hessian is not positive definite")]
    NotConvex,
    /// Hard constraints contradict each other.
    #[error("the constraints contradict each other")]
    Inconsistent,
    /// The method did not reach its tolerances.
    #[error("the quadratic program was not solved to its tolerances")]
    Inaccurate,
}

impl Quadratic {
    /// An empty program of `n` variables: no objective, no bounds, no rows, and room for `rows` of these.
    #[must_use]
    pub fn new(n: usize, rows: usize) -> Self {
        Self {
            n,
            hessian: vec![0.0; n * n],
            gradient: vec![0.0; n],
            lower: vec![f64::NEG_INFINITY; n],
            upper: vec![f64::INFINITY; n],
            rows: Vec::with_capacity(n * rows),
            constants: Vec::with_capacity(rows),
            limits: Vec::with_capacity(rows),
            equality: Vec::with_capacity(rows),
            norms: Vec::with_capacity(rows),
            hints: {
                let mut hints = Vec::with_capacity(2 * n + rows);
                hints.resize(2 * n, Place::Off);
                hints
            },
        }
    }

    /// Removes all rows.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.constants.clear();
        self.limits.clear();
        self.equality.clear();
        self.norms.clear();
        self.hints.truncate(2 * self.n);
    }

    /// Adds rowᵀd + constant ≥ 0 (or = 0) with a limit on its multiplier (infinite: hard).
    pub fn push(&mut self, row: &[f64], constant: f64, equality: bool, limit: f64) {
        let length = norm(row);
        let length = if length > 1e-150 { length } else { 1.0 };
        self.rows.extend(row.iter().map(|a| a / length));
        self.constants.push(constant / length);
        self.limits.push(limit * length);
        self.equality.push(equality);
        self.norms.push(length);
        self.hints.push(Place::Off);
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.constants.len()
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.constants.is_empty()
    }

    /// Row `i`, normalized.
    #[must_use]
    pub fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.n..(i + 1) * self.n]
    }

    /// Values aᵀd + b of successive rows, from `first` on.
    pub(super) fn values(&self, first: usize, d: &[f64], out: &mut [f64]) {
        let range = first..first + out.len();
        multiply(&self.rows[range.start * self.n..range.end * self.n], d, out);
        axpy(1.0, &self.constants[range], out);
    }

    /// What is minimized, at `d`: the quadratic and what elastic rows cost there. Hard rows and bounds are not asked.
    #[must_use]
    pub fn value(&self, d: &[f64]) -> f64 {
        let (mut product, mut rows) = (vec![0.0; self.n], vec![0.0; self.len()]);
        multiply(&self.hessian, d, &mut product);
        self.values(0, d, &mut rows);
        let paid = (0..self.len()).filter(|i| self.limits[*i].is_finite()).map(|i| {
            let violation = if self.equality[i] { rows[i].abs() } else { (-rows[i]).max(0.0) };
            self.limits[i] * violation
        });
        0.5 * dot(d, &product) + dot(d, &self.gradient) + paid.sum::<f64>()
    }

    /// Multiplier of row `i` as it was before the row was normalized.
    #[must_use]
    pub fn multiplier(&self, step: &Step, i: usize) -> f64 {
        step.multipliers[i] / self.norms[i]
    }

    /// The multiplier limits of row `i`.
    fn range(&self, i: usize) -> (f64, f64) {
        (if self.equality[i] { -self.limits[i] } else { 0.0 }, self.limits[i])
    }

    /// How far `step` is from satisfying the optimality conditions, relative to the magnitudes that enter them.
    #[must_use]
    pub fn residual(&self, step: &Step, scratch: &mut Vec<f64>) -> f64 {
        let n = self.n;
        scratch.resize(n, 0.0);
        let (y, nu, d) = (&step.multipliers, &step.bound_multipliers, &step.d);

        multiply(&self.hessian, d, scratch);
        let mut size = 1e-8 + max_abs(&self.gradient) + max_abs(scratch) + max_abs(nu);
        for ((s, g), nu) in scratch.iter_mut().zip(&self.gradient).zip(nu) {
            *s += g - nu;
        }
        for (i, &y) in y.iter().enumerate() {
            if y != 0.0 {
                axpy(-y, self.row(i), scratch);
                size = size.max(y.abs());
            }
        }
        let stationarity = max_abs(scratch) / size;

        let reach = 1.0 + max_abs(d);
        let mut worst: f64 = 0.0;
        let mut values = [0.0; 4];
        for (i, &y) in y.iter().enumerate() {
            if i % 4 == 0 {
                self.values(i, d, &mut values[..(self.len() - i).min(4)]);
            }
            let r = values[i % 4];
            let (low, high) = self.range(i);
            // In units of the constraint: a multiplier inside its range demands r = 0, one at an end allows one sign.
            let error = if y < low || y > high {
                f64::INFINITY
            } else {
                (if y > low { r.max(0.0) } else { 0.0 }).max(if y < high { -r } else { 0.0 })
            };
            // A nearly vanishing multiplier may belong to an inactive row: complementarity is a product.
            let product = if y > low && y < high { (y.abs() / size).min(1.0) * r.abs() } else { 0.0 };
            let error = if r > 0.0 && !self.equality[i] && y < high { product } else { error };
            worst = worst.max(error / (reach + self.constants[i].abs()));
        }
        for j in 0..n {
            let (above, below) = (d[j] - self.lower[j], self.upper[j] - d[j]);
            worst = worst.max(-above).max(-below);
            if nu[j] > 0.0 {
                worst = worst.max((nu[j] / size).min(1.0) * above);
            } else if nu[j] < 0.0 {
                worst = worst.max((-nu[j] / size).min(1.0) * below);
            }
        }
        let residual = stationarity.max(worst);
        if residual.is_nan() { f64::INFINITY } else { residual }
    }
}
