//! The same quadratic program through Clarabel's interior-point method (Goulart & Chen 2024): slower, without a warm start, but
//! indifferent to degeneracy. It decides where [`active_set`](super::active_set) fails its own check.
//!
//! Elastic rows get slack variables s ≥ 0 of cost w: aᵀd + b + s ≥ 0, and aᵀd + b + s⁺ − s⁻ = 0.

use super::{Failure, Quadratic, Step};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// Residual of the optimality conditions at which the answer stands.
const ACCEPT: f64 = 1e-6;

/// Silent, on one thread, and as exact as double precision reasonably allows.
pub fn settings() -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        presolve_enable: false,
        max_threads: 1,
        tol_gap_abs: 1e-10,
        tol_gap_rel: 1e-10,
        tol_feas: 1e-10,
        ..DefaultSettings::default()
    }
}

/// Solves `qp`.
///
/// # Errors
/// [`Failure::Inconsistent`] if hard constraints contradict each other, [`Failure::Inaccurate`] if Clarabel gives up.
pub fn solve(qp: &Quadratic) -> Result<Step, Failure> {
    // Prices far above the gradient ask for hard constraints; as slack costs they would drown everything else in rounding.
    let size = qp.gradient.iter().fold(1.0_f64, |size, g| size.max(g.abs()));
    if qp.limits.iter().any(|limit| limit.is_finite())
        && qp.limits.iter().all(|limit| *limit > 1e4 * size)
        && let Ok(step) = solve_capped(qp, true)
        && step.multipliers.iter().zip(&qp.limits).all(|(y, limit)| y.abs() < *limit)
    {
        return Ok(step);
    }
    solve_capped(qp, false)
}

fn solve_capped(qp: &Quadratic, hard: bool) -> Result<Step, Failure> {
    let n = qp.n;
    let elastic = |i: usize| !hard && qp.limits[i].is_finite();
    // A change of units that makes H and g of order one; multipliers and penalties carry the factor.
    let size = qp.hessian.iter().chain(&qp.gradient).fold(1e-12_f64, |size, h| size.max(h.abs()));
    let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
    let mut cost: Vec<f64> = qp.gradient.iter().map(|g| g / size).collect();
    let mut b = Vec::new();

    // Clarabel's form is A·x + s = b with s in a cone: equalities first, then everything of the form "≥ 0".
    for equalities in [true, false] {
        for i in (0..qp.len()).filter(|&i| qp.equality[i] == equalities) {
            let sign = if equalities { 1.0 } else { -1.0 };
            for (j, a) in qp.row(i).iter().enumerate() {
                columns[j].push((b.len(), sign * a));
            }
            if elastic(i) {
                columns.push(vec![(b.len(), sign)]);
                cost.push(qp.limits[i] / size);
                if equalities {
                    columns.push(vec![(b.len(), -sign)]);
                    cost.push(qp.limits[i] / size);
                }
            }
            b.push(-sign * qp.constants[i]);
        }
    }
    let equalities = qp.equality.iter().filter(|e| **e).count();
    for j in 0..n {
        for (bound, sign) in [(qp.lower[j], -1.0), (qp.upper[j], 1.0)] {
            if bound.is_finite() {
                columns[j].push((b.len(), sign));
                b.push(sign * bound);
            }
        }
    }
    for column in columns.iter_mut().skip(n) {
        column.push((b.len(), -1.0));
        b.push(0.0);
    }

    let width = columns.len();
    let mut upper_triangle: Vec<Vec<(usize, f64)>> =
        (0..n).map(|j| (0..=j).map(|i| (i, qp.hessian[j * n + i] / size)).collect()).collect();
    upper_triangle.resize(width, Vec::new());
    let p = sparse(width, &upper_triangle);
    let a = sparse(b.len(), &columns);
    let cones = [SupportedConeT::ZeroConeT(equalities), SupportedConeT::NonnegativeConeT(b.len() - equalities)];
    let mut solver = DefaultSolver::new(&p, &cost, &a, &b, &cones, settings()).map_err(|_| Failure::Inaccurate)?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => return Err(Failure::Inconsistent),
        _ => {}
    }

    // Back: multipliers of the rows in their own order, in the program's units.
    let (x, z) = (&solver.solution.x, &solver.solution.z);
    let mut step = Step {
        d: (0..n).map(|j| x[j].max(qp.lower[j]).min(qp.upper[j])).collect(),
        multipliers: vec![0.0; qp.len()],
        bound_multipliers: vec![0.0; n],
    };
    let mut next = z.iter().map(|z| z * size);
    for equalities in [true, false] {
        for i in (0..qp.len()).filter(|&i| qp.equality[i] == equalities) {
            let z = next.next().unwrap_or(0.0);
            step.multipliers[i] = if equalities { -z } else { z };
            if elastic(i) {
                let (low, high) = qp.range(i);
                step.multipliers[i] = step.multipliers[i].max(low).min(high);
            }
        }
    }
    for j in 0..n {
        for (bound, sign) in [(qp.lower[j], 1.0), (qp.upper[j], -1.0)] {
            if bound.is_finite() {
                step.bound_multipliers[j] += sign * next.next().unwrap_or(0.0);
            }
        }
    }
    // An active bound holds exactly: what follows reads the active set off the point.
    for j in 0..n {
        for (bound, sign) in [(qp.lower[j], 1.0), (qp.upper[j], -1.0)] {
            let nu = sign * step.bound_multipliers[j] / size;
            if nu > (step.d[j] - bound).abs() {
                step.d[j] = bound;
            }
        }
    }
    // An elastic row may sit at its limit up to rounding: put it there, so that its residual is judged as it should be.
    for i in 0..qp.len() {
        let limit = qp.limits[i];
        let y = &mut step.multipliers[i];
        if elastic(i) && limit - y.abs() <= 1e-6 * limit {
            *y = limit.copysign(*y);
        }
    }
    if qp.residual(&step, &mut Vec::new()) <= ACCEPT { Ok(step) } else { Err(Failure::Inaccurate) }
}

fn sparse(rows: usize, columns: &[Vec<(usize, f64)>]) -> CscMatrix<f64> {
    let mut colptr = vec![0];
    let (mut rowval, mut nzval) = (Vec::new(), Vec::new());
    for column in columns {
        rowval.extend(column.iter().map(|(i, _)| *i));
        nzval.extend(column.iter().map(|(_, v)| *v));
        colptr.push(rowval.len());
    }
    CscMatrix::new(rows, columns.len(), colptr, rowval, nzval)
}
