//! Sequential quadratic programming for smooth programs with few variables and very many inequalities.
//!
//! minimize f(x) subject to c_E(x) = 0, c_I(x) ≥ 0, lower ≤ x ≤ upper
//!
//! Each iteration linearizes the constraints, models the Lagrangian's curvature and solves the quadratic subproblem
//! (Nocedal & Wright, *Numerical Optimization*, 2006, ch. 18). What makes it fast here: [screening](self) takes only the rows
//! that matter into the subproblem, and a dense dual active-set method ([`qp::active_set`]) starts it from the last active set.
//! What makes it robust: capped multipliers turn an inconsistent subproblem into its ℓ1 relaxation with no detour, penalty
//! steering (Byrd, Nocedal & Waltz 2008) sets their cap, and a phase that looks at the violation alone ends infeasible problems
//! with a proof, [`Conflict`]; steps are tried in full, corrected to second order, or tried again within a smaller radius (Fletcher's
//! Sℓ1QP, 1982). Exact or Gauss-Newton Hessians are convexified where they must be; without them, damped BFGS. The code reads in the order [`minimize`], `direction`, `trial`, `screening`, [`qp`].
//!
//! ```
//! use piaffe_sqp::{Control, Options, Problem, Undefined, Values, minimize};
//!
//! /// The point of the unit disc that lies farthest down the slope x₀ + x₁.
//! struct Disc([f64; 2]);
//!
//! impl Problem for Disc {
//!     fn variables(&self) -> usize { 2 }
//!     fn equalities(&self) -> usize { 0 }
//!     fn inequalities(&self) -> usize { 1 }
//!     fn bounds(&self, _lower: &mut [f64], _upper: &mut [f64]) {}
//!     fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
//!         out.objective = x[0] + x[1];
//!         out.inequalities[0] = 1.0 - x[0] * x[0] - x[1] * x[1];
//!         Ok(())
//!     }
//!     fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
//!         self.0 = [x[0], x[1]];
//!         Ok(())
//!     }
//!     fn gradient(&self, gradient: &mut [f64]) { gradient.fill(1.0); }
//!     fn equality_row(&self, _: usize, _: &mut [f64]) {}
//!     fn inequality_row(&self, _: usize, row: &mut [f64]) {
//!         row.copy_from_slice(&[-2.0 * self.0[0], -2.0 * self.0[1]]);
//!     }
//! }
//!
//! let solution = minimize(&mut Disc([0.0; 2]), &[0.5, 0.0], &Options::default(), &mut |_| Control::Continue);
//! assert!(solution.status.is_optimal());
//! assert!((solution.objective + 2f64.sqrt()).abs() < 1e-6);
//! ```

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
// Several arrays run along one index in most loops here, as in the formulas.
#![allow(clippy::needless_range_loop)]

mod convexify;
mod dense;
mod direction;
mod eigen;
mod folds;
mod kkt;
mod merit;
mod minimize;
mod multipliers;
mod objective;
mod options;
mod problem;
pub mod qp;
mod quasi_newton;
mod run;
mod scaled;
mod screening;
mod status;
mod trial;

pub use dense::{axpy, combine, dot, multiply};
pub use minimize::minimize;
pub use multipliers::{Multipliers, multipliers};
pub use objective::{Objective, Own, Redirected};
pub use options::{Control, Iteration, Kind, Options, Subproblems};
pub use problem::{Problem, Undefined, Values};
pub use status::{Conflict, KktResidual, Solution, Status};
