//! Multipliers of a point that somebody calls an optimum, and its residuals, from the problem's derivatives there alone.
//!
//! They come from one convex program: the step d that minimizes ∇fᵀd + ½ s‖d‖² subject to the linearized constraints, in scaled
//! variables, with s = max(1, ‖∇f‖∞). It is zero exactly where the optimality conditions hold. Otherwise s·d is minus what is
//! left of ∇f by the multipliers that the program finds: those with the least residual in the sense of least squares, where
//! those of inequalities are not negative and pay for every distance from the constraint (the program's dual is that fit).
//! What is violated counts as met: violations have a residual of their own, and where active constraints nearly depend on each
//! other, the least of them would ask for a long step.
//! Where f has kinks, the multipliers of these, up to the kinks' prices, choose among its subgradients.

use super::dense::{axpy, max_abs};
use super::kkt;
use super::qp::active_set::ActiveSet;
use super::qp::{Quadratic, interior};
use super::scaled::{Point, Scaled};
use super::{KktResidual, Options, Problem, Undefined, Values};

/// Inequalities farther from zero than this have no multiplier.
const NEAR: f64 = 1e-3;
/// Inequalities nearer than this are met exactly, as far as a solver goes: how far a multiplier's constraint still is from zero
/// is the complementarity residual's to say.
const MET: f64 = 1e-8;
/// Limit of a multiplier in units of max(1, ‖∇f‖∞): where the constraints contradict each other, they give way.
const LIMIT: f64 = 1e6;

/// Multipliers of a point in the problem's own units, of the Lagrangian f − λᵀc_E − μᵀc_I − νᵀx.
#[derive(Clone, Debug, PartialEq)]
pub struct Multipliers {
    /// λ of c_E(x) = 0.
    pub equalities: Vec<f64>,
    /// μ ≥ 0 of c_I(x) ≥ 0.
    pub inequalities: Vec<f64>,
    /// ν of the bounds: positive at a lower bound, negative at an upper one.
    pub bounds: Vec<f64>,
    /// Of the kinks of f: the subgradient is ∇f − Σ multiplier · ∇c.
    pub kinks: Vec<f64>,
    /// What these multipliers leave of the optimality conditions.
    pub kkt: KktResidual,
    /// The step of the convex program: the way down where the conditions do not hold.
    pub step: Vec<f64>,
    /// The values of all functions.
    pub values: Values,
}

/// The multipliers of `x`; `scale` is the typical magnitude of each variable.
///
/// # Errors
/// If the functions or their derivatives are not defined there, or lengths, scales or bounds make no sense.
pub fn multipliers<P: Problem>(problem: &mut P, x: &[f64], scale: Vec<f64>) -> Result<Multipliers, Undefined> {
    let options = Options { scale: Some(scale), ..Options::default() };
    let mut view = Scaled::new(problem, x, &options).ok_or(Undefined)?;
    let (n, equalities) = (view.n, view.equalities);
    let mut point = Point::new(n, equalities, view.inequalities);
    view.enter(x, &mut point.z);
    view.evaluate(&mut point)?;
    let mut gradient = vec![0.0; n];
    view.linearize(&mut gradient)?;
    let size = max_abs(&gradient).max(1.0);

    let near: Vec<usize> = (0..view.inequalities).filter(|i| point.values.inequalities[*i] <= NEAR).collect();
    let mut qp = Quadratic::new(n, equalities + near.len() + view.kinks());
    (0..n).for_each(|j| qp.hessian[j * n + j] = size);
    qp.gradient.copy_from_slice(&gradient);
    let (lower, upper) = view.bounds();
    for j in 0..n {
        (qp.lower[j], qp.upper[j]) = (lower[j] - point.z[j], upper[j] - point.z[j]);
    }
    let mut row = vec![0.0; n];
    for i in 0..equalities {
        view.equality_row(i, &mut row)?;
        qp.push(&row, 0.0, true, LIMIT * size);
    }
    for &i in &near {
        view.inequality_row(i, &mut row)?;
        let value = point.values.inequalities[i];
        qp.push(&row, if value <= MET { 0.0 } else { value }, false, LIMIT * size);
    }
    for i in 0..view.kinks() {
        let price = view.kink(i, &mut row)?;
        qp.push(&row, 0.0, true, price);
    }
    let mut solver = ActiveSet::new(n, qp.len());
    let step = match solver.solve(&qp) {
        Ok(step) => step.clone(),
        Err(_) => interior::solve(&qp).map_err(|_| Undefined)?,
    };

    let lambda: Vec<f64> = (0..equalities).map(|i| qp.multiplier(&step, i)).collect();
    let mut mu = vec![0.0; view.inequalities];
    for (k, &i) in near.iter().enumerate() {
        mu[i] = qp.multiplier(&step, equalities + k);
    }
    let kinks: Vec<f64> = (equalities + near.len()..qp.len()).map(|i| qp.multiplier(&step, i)).collect();
    let mut left = gradient;
    for (i, multiplier) in lambda.iter().chain(near.iter().map(|i| &mu[*i])).chain(&kinks).enumerate() {
        axpy(-multiplier * qp.norms[i], qp.row(i), &mut left);
    }
    let mut nu = vec![0.0; n];
    kkt::project(&point.z, &lower, &upper, &mut left, &mut nu);
    let kkt = kkt::residual(&view, &point, size, &left, &mu);
    nu.iter_mut().zip(&view.scale).for_each(|(nu, scale)| *nu /= scale);
    let step = step.d.iter().zip(&view.scale).map(|(d, scale)| d * scale).collect();
    Ok(Multipliers { equalities: lambda, inequalities: mu, bounds: nu, kinks, kkt, step, values: point.values })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Minimize (x + y)² − 3y subject to y ≤ 1 (twice over), x·y = 1, x ≤ 2.
    struct Plain([f64; 2]);

    impl Problem for Plain {
        fn variables(&self) -> usize {
            2
        }
        fn equalities(&self) -> usize {
            1
        }
        fn inequalities(&self) -> usize {
            3
        }
        fn bounds(&self, _: &mut [f64], upper: &mut [f64]) {
            upper[0] = 2.0;
        }
        fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
            out.objective = (x[0] + x[1]).powi(2) - 3.0 * x[1];
            out.equalities[0] = x[0] * x[1] - 1.0;
            out.inequalities.copy_from_slice(&[1.0 - x[1], 2.0 - 2.0 * x[1], x[0]]);
            Ok(())
        }
        fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
            self.0 = [x[0], x[1]];
            Ok(())
        }
        fn gradient(&self, gradient: &mut [f64]) {
            let slope = 2.0 * (self.0[0] + self.0[1]);
            gradient.copy_from_slice(&[slope, slope - 3.0]);
        }
        fn equality_row(&self, _: usize, row: &mut [f64]) {
            row.copy_from_slice(&[self.0[1], self.0[0]]);
        }
        fn inequality_row(&self, i: usize, row: &mut [f64]) {
            row.copy_from_slice(&[[0.0, -1.0], [0.0, -2.0], [1.0, 0.0]][i]);
        }
    }

    #[test]
    fn multipliers_of_an_optimum_with_one_constraint_twice() {
        // At (1, 1): ∇f = (4, 1) = λ (1, 1) + (μ₁ + 2 μ₂) (0, −1) with λ = 4, μ₁ + 2 μ₂ = 3, in any units.
        for scale in [vec![1.0, 1.0], vec![0.1, 3.0]] {
            let found = multipliers(&mut Plain([0.0; 2]), &[1.0, 1.0], scale).unwrap();
            assert!((found.equalities[0] - 4.0).abs() < 1e-12, "{found:?}");
            let [first, second, far] = found.inequalities[..] else { panic!() };
            assert!((first + 2.0 * second - 3.0).abs() < 1e-12 && first >= 0.0 && second >= 0.0 && far == 0.0);
            assert!(found.kkt.stationarity < 1e-12 && found.kkt.complementarity < 1e-12 && found.bounds == [0.0; 2]);
        }
    }

    /// Minimize slope·x + y² + |x| + |x + y|/2, kinks left out.
    struct Kinked(f64);

    impl Problem for Kinked {
        fn variables(&self) -> usize {
            2
        }
        fn equalities(&self) -> usize {
            0
        }
        fn inequalities(&self) -> usize {
            0
        }
        fn bounds(&self, _: &mut [f64], _: &mut [f64]) {}
        fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
            out.objective = self.0 * x[0] + x[1] * x[1];
            Ok(())
        }
        fn linearize(&mut self, _: &[f64]) -> Result<(), Undefined> {
            Ok(())
        }
        fn gradient(&self, gradient: &mut [f64]) {
            gradient.copy_from_slice(&[self.0, 0.0]);
        }
        fn equality_row(&self, _: usize, _: &mut [f64]) {}
        fn inequality_row(&self, _: usize, _: &mut [f64]) {}
        fn kinks(&self) -> usize {
            2
        }
        fn kink(&self, i: usize, row: &mut [f64]) -> f64 {
            row.copy_from_slice(&[[1.0, 0.0], [1.0, 1.0]][i]);
            [1.0, 0.5][i]
        }
    }

    #[test]
    fn at_kinks_some_subgradient_must_vanish() {
        for (slope, optimal) in [(0.0, true), (0.9, true), (-1.0, true), (1.2, false), (-3.0, false)] {
            let found = multipliers(&mut Kinked(slope), &[0.0, 0.0], vec![1.0; 2]).unwrap();
            assert_eq!(found.kkt.stationarity < 1e-12, optimal, "{slope}: {found:?}");
            // Off the kink it goes down.
            let [x, y] = found.step[..] else { panic!() };
            let change = slope * x + x.abs() + 0.5 * (x + y).abs();
            assert!(if optimal { x.abs() + y.abs() < 1e-12 } else { change < -1e-3 }, "{slope}: {found:?}");
            assert!(found.kinks[0].abs() <= 1.0 && found.kinks[1].abs() <= 0.5);
        }
    }

    #[test]
    fn a_point_that_is_no_optimum_has_a_residual() {
        // Feasible, at the bound on x, but f falls towards smaller x.
        let found = multipliers(&mut Plain([0.0; 2]), &[2.0, 0.5], vec![1.0; 2]).unwrap();
        assert!(found.kkt.violation < 1e-12 && found.kkt.stationarity > 0.1, "{found:?}");
        // Not feasible: said so, whatever the multipliers.
        let found = multipliers(&mut Plain([0.0; 2]), &[0.5, 1.5], vec![1.0; 2]).unwrap();
        assert!(found.kkt.violation > 0.2);
    }
}
