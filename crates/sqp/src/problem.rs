//! The nonlinear program as its owner describes it:
//!
//! minimize f(x) subject to c_E(x) = 0, c_I(x) ≥ 0, lower ≤ x ≤ upper.
//!
//! The derivatives come a row at a time and on demand, because of the thousands of inequalities that a sampled trajectory
//! carries only a handful matter in any one iteration.

/// The functions of a nonlinear program and their derivatives.
///
/// # Contract
/// - [`evaluate`](Problem::evaluate) may be called at any point and must leave the derivatives of the last
///   [`linearize`](Problem::linearize) untouched: rows at the current iterate are still asked for while trial points are evaluated.
/// - `linearize` is called only at the point of the *latest* `evaluate`, so whatever that call computed can be reused.
/// - [`directions`](Problem::directions) must agree with [`inequality_row`](Problem::inequality_row) and [`fold_row`](Problem::fold_row)
///   to rounding; the step of the quadratic subproblem is certified with it.
/// - Values that are not finite count as [`Undefined`].
pub trait Problem {
    /// Number of variables n.
    fn variables(&self) -> usize;
    /// Number of equalities c_E(x) = 0.
    fn equalities(&self) -> usize;
    /// Number of inequalities c_I(x) ≥ 0.
    fn inequalities(&self) -> usize;
    /// Bounds on the variables; both slices arrive filled with −∞ and +∞. Trial points never leave the bounds.
    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]);
    /// How much smaller than other violations that of equality `i` has to be at a solution: a share from 0 to 1 of the tolerance.
    /// An equality whose zero is to be met relative to something small is better told so than by blowing up its row.
    fn strictness(&self, i: usize) -> f64 {
        let _ = i;
        1.0
    }

    /// Values at `x`. `Err` where the functions are not defined: the solver then tries a shorter step.
    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined>;
    /// Prepares the derivatives at `x`, always the point of the latest `evaluate`.
    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined>;
    /// ∇f at the linearized point.
    fn gradient(&self, gradient: &mut [f64]);
    /// ∇c_E,i at the linearized point.
    fn equality_row(&self, i: usize, row: &mut [f64]);
    /// ∇c_I,i at the linearized point.
    fn inequality_row(&self, i: usize, row: &mut [f64]);

    /// J_I·d for all inequalities, and ∇c·d for all [folds](Problem::folds), at once. The default goes through the rows; override it where
    /// there is a cheaper way.
    fn directions(&self, d: &[f64], inequalities: &mut [f64], folds: &mut [f64]) {
        let n = self.variables();
        // Up to the sizes met in practice the row lives on the stack.
        let mut stack = [0.0; 64];
        let mut heap = Vec::new();
        let row = match stack.get_mut(..n) {
            Some(row) => row,
            None => {
                heap.resize(n, 0.0);
                heap.as_mut_slice()
            }
        };
        for (i, out) in inequalities.iter_mut().enumerate() {
            row.fill(0.0);
            self.inequality_row(i, row);
            *out = super::dense::dot(row, d);
        }
        for (i, out) in folds.iter_mut().enumerate() {
            row.fill(0.0);
            self.fold_row(i, row);
            *out = super::dense::dot(row, d);
        }
    }

    /// How many kinks f has at the linearized point: terms `price · |c(x)|` with c = 0 there, which its gradient leaves out.
    /// [`multipliers`](super::multipliers) knows of them, [`minimize`](super::minimize) does not.
    fn kinks(&self) -> usize {
        0
    }

    /// Writes ∇c of kink `i` and gives its price.
    fn kink(&self, i: usize, row: &mut [f64]) -> f64 {
        let _ = (i, row);
        0.0
    }

    /// How many folds f may have: places where a term of it, `c(x)` at the linearized point, changes its sign and counts on as |c|. What
    /// f's derivatives say is true on this side of a fold alone. A subproblem that knows of it stops there, or goes on at a price.
    fn folds(&self) -> usize {
        0
    }

    /// c > 0 of fold `i`; `None` where f has no such fold now. Called after `linearize` and before the next `evaluate`.
    fn fold(&self, i: usize) -> Option<f64> {
        let _ = i;
        None
    }

    /// ∇c of fold `i` at the linearized point; anything where there is none.
    fn fold_row(&self, i: usize, row: &mut [f64]) {
        let _ = (i, row);
    }

    /// The Hessian of f − λᵀc_E − μᵀc_I at the linearized point, row by row (n·n numbers, of which the lower triangle is
    /// read). Called after `linearize` and before the next `evaluate`. Need not be exact: Gauss-Newton curvature is welcome.
    /// Returning `false`, the default, asks for quasi-Newton approximations from then on.
    fn hessian(&mut self, equality_multipliers: &[f64], inequality_multipliers: &[f64], hessian: &mut [f64]) -> bool {
        let _ = (equality_multipliers, inequality_multipliers, hessian);
        false
    }
}

/// Values of the functions at one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// f(x).
    pub objective: f64,
    /// c_E(x), already of the right length when [`Problem::evaluate`] is called.
    pub equalities: Vec<f64>,
    /// c_I(x), already of the right length when [`Problem::evaluate`] is called.
    pub inequalities: Vec<f64>,
}

impl Values {
    /// Zeros for a problem with the given numbers of constraints.
    #[must_use]
    pub fn zeros(equalities: usize, inequalities: usize) -> Self {
        Self { objective: 0.0, equalities: vec![0.0; equalities], inequalities: vec![0.0; inequalities] }
    }

    /// Largest violation of any one constraint: max(|c_E|, −c_I, 0).
    #[must_use]
    pub fn violation(&self) -> f64 {
        let equalities = self.equalities.iter().fold(0.0, |worst: f64, c| worst.max(c.abs()));
        self.inequalities.iter().fold(equalities, |worst, c| worst.max(-c))
    }

    pub(super) fn finite(&self) -> bool {
        self.objective.is_finite()
            && self.equalities.iter().all(|c| c.is_finite())
            && self.inequalities.iter().all(|c| c.is_finite())
    }
}

/// The functions are not defined at a point (a square root of a negative number, a motion that falls over, …).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the functions are not defined at this point")]
pub struct Undefined;
