//! Residuals of the optimality conditions. The bounds' multipliers are not taken from a subproblem but read off: of a variable
//! at a bound, the part of ∇L that pushes outwards *is* the multiplier.

use super::Problem;
use super::dense::max_abs;
use super::scaled::{Point, Scaled};
use super::status::KktResidual;

/// Moves the outward part of `lagrangian` (∇f − J_Eᵀλ − J_Iᵀμ) at the bounds into `nu`; what stays is the residual.
pub(super) fn project(z: &[f64], lower: &[f64], upper: &[f64], lagrangian: &mut [f64], nu: &mut [f64]) {
    for j in 0..z.len() {
        let close = 1e-12 * (1.0 + z[j].abs());
        let r = lagrangian[j];
        let held = (r > 0.0 && z[j] - lower[j] <= close) || (r < 0.0 && upper[j] - z[j] <= close);
        nu[j] = if held { r } else { 0.0 };
        lagrangian[j] = r - nu[j];
    }
}

/// The residuals relative to `size`, from the projected gradient of the Lagrangian.
pub(super) fn residual<P: Problem>(
    view: &Scaled<P>,
    point: &Point,
    size: f64,
    projected: &[f64],
    mu: &[f64],
) -> KktResidual {
    let products = mu.iter().zip(&point.values.inequalities).fold(0.0, |worst: f64, (mu, c)| worst.max((mu * c).abs()));
    KktResidual {
        stationarity: max_abs(projected) / size,
        complementarity: products / size,
        violation: view.raw_violation(point),
    }
}
