//! The dual active-set method against Clarabel.
#![allow(clippy::needless_range_loop)]

use super::random::Random;
use piaffe::sqp::qp::active_set::ActiveSet;
use piaffe::sqp::qp::{Failure, Quadratic, interior};
use proptest::prelude::*;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What makes a random program hard.
#[derive(Clone, Copy, Debug, Default)]
struct Kind {
    /// Constraints that give way at this price instead of hard ones.
    price: Option<f64>,
    /// No point is known to satisfy all constraints.
    contradictory: bool,
    /// Many rows repeat others, up to this perturbation.
    repeated: Option<f64>,
    /// Condition number of H if its axes are orthogonal, else times what they depend on each other.
    condition: f64,
    orthogonal: bool,
}

fn program(seed: u64, n: usize, rows: usize, equalities: usize, kind: Kind) -> Quadratic {
    let mut random = Random::new(seed);
    let mut qp = Quadratic::new(n, rows);
    let mut axes: Vec<Vec<f64>> = Vec::new();
    for k in 0..n {
        let mut axis = random.vector(n);
        if kind.orthogonal {
            // Twice, against rounding.
            for other in axes.iter().chain(&axes) {
                let along = dot(&axis, other) / dot(other, other);
                axis.iter_mut().zip(other).for_each(|(a, o)| *a -= along * o);
            }
        }
        let weight =
            kind.condition.powf(-(k as f64) / n as f64) / if kind.orthogonal { dot(&axis, &axis) } else { 1.0 };
        for i in 0..n {
            for j in 0..n {
                qp.hessian[i * n + j] += weight * axis[i] * axis[j];
            }
        }
        axes.push(axis);
    }
    for i in 0..n {
        qp.hessian[i * n + i] += 1e-3 / kind.condition;
        for j in 0..i {
            qp.hessian[j * n + i] = qp.hessian[i * n + j];
        }
    }
    qp.gradient = random.vector(n).iter().map(|g| 3.0 * g).collect();
    let inside = random.vector(n);
    for j in 0..n {
        if random.unit() < 0.4 {
            qp.lower[j] = inside[j] - random.unit() * 0.5;
        }
        if random.unit() < 0.4 {
            qp.upper[j] = inside[j] + random.unit() * 0.5;
        }
    }
    let mut previous: Vec<Vec<f64>> = Vec::new();
    for i in 0..rows {
        let mut row = random.vector(n);
        if let (Some(perturbation), true) = (kind.repeated, i > 0 && random.unit() < 0.7) {
            row = previous[random.below(i)].iter().map(|a| a + perturbation * random.signed()).collect();
        }
        let equality = i < equalities;
        // A known point satisfies everything, some of it just barely.
        let slack = if equality || random.unit() < 0.3 { 0.0 } else { random.unit() };
        let mut constant = slack - dot(&row, &inside);
        if kind.contradictory {
            constant -= 2.0 * random.unit();
        }
        qp.push(&row, constant, equality, kind.price.unwrap_or(f64::INFINITY));
        previous.push(row);
    }
    qp
}

/// The active-set method must solve it, to tighter conditions than Clarabel, and agree with it where d is well determined. Without
/// hard rows Clarabel's point is allowed, so no better than the optimum.
fn compare(qp: &Quadratic, kind: Kind) -> Result<(), TestCaseError> {
    let mut solver = ActiveSet::new(qp.n, qp.len());
    let ours = solver.solve(qp);
    let theirs = interior::solve(qp);
    match (ours, theirs) {
        (Ok(ours), Ok(theirs)) => {
            prop_assert!(qp.residual(ours, &mut Vec::new()) <= 1e-9);
            let (value, bound) = (qp.value(&ours.d), qp.value(&theirs.d));
            let gap = (value - bound).abs();
            let apart = ours.d.iter().zip(&theirs.d).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
            let (reach, size) = (ours.d.iter().fold(1.0, |m: f64, d| m.max(d.abs())), 1.0 + value.abs());
            if let Some(price) = kind.price {
                prop_assert!(value < bound + 1e-9 * (size + price), "{value:e} is more than {bound:e}");
            }
            prop_assert!(
                apart < 1e-4 * reach || gap < 1e-6 * size,
                "apart {apart:e} of {reach:e}, gap {gap:e} of {size:e}"
            );
            Ok(())
        }
        (Ok(_), Err(Failure::Inaccurate)) | (Err(Failure::Inconsistent), Err(_)) => Ok(()),
        (ours, theirs) => Err(TestCaseError::fail(format!("active set {:?}, Clarabel {:?}", ours.err(), theirs.err()))),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: std::env::var("PROPTEST_CASES").ok().and_then(|c| c.parse().ok()).unwrap_or(300), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn agrees_with_clarabel(seed: u64, n in 1usize..20, rows in 0usize..60, e in 0usize..4) {
        let kind = Kind { condition: 1e2, ..Kind::default() };
        compare(&program(seed, n, rows, e.min(n / 3), kind), kind)?;
    }

    #[test]
    fn agrees_with_clarabel_on_elastic_programs(seed: u64, n in 1usize..20, rows in 1usize..60, e in 0usize..8, log in -1.0..3.0) {
        let kind = Kind { price: Some(10f64.powf(log)), contradictory: true, condition: 1e2, ..Kind::default() };
        compare(&program(seed, n, rows, e, kind), kind)?;
    }

    #[test]
    fn agrees_with_clarabel_on_repeated_rows(seed: u64, n in 1usize..16, rows in 1usize..80, log in -12.0..-3.0) {
        let kind = Kind { repeated: Some(10f64.powf(log)), condition: 1e2, ..Kind::default() };
        compare(&program(seed, n, rows, 0, kind), kind)?;
    }

    #[test]
    fn agrees_with_clarabel_on_repeated_elastic_rows(seed: u64, n in 1usize..16, rows in 1usize..80, e in 0usize..6) {
        let kind = Kind { repeated: Some(0.0), price: Some(10.0), contradictory: true, condition: 1e2, ..Kind::default() };
        compare(&program(seed, n, rows, e, kind), kind)?;
    }

    #[test]
    fn survives_bad_conditioning(seed: u64, n in 2usize..20, rows in 0usize..60) {
        // Where nothing bounds d it is as large as H is flat: much flatter, and no double holds Hd + g.
        let kind = Kind { condition: 1e6, orthogonal: true, ..Kind::default() };
        compare(&program(seed, n, rows, n / 4, kind), kind)?;
    }

    /// Rows that come later, or change, lead to the solution of the whole.
    #[test]
    fn resumes_and_restarts(seed: u64, n in 1usize..16, rows in 2usize..50) {
        let whole = program(seed, n, rows, 0, Kind { condition: 1e2, ..Kind::default() });
        let mut part = whole.clone();
        part.clear();
        let mut solver = ActiveSet::new(n, 0);
        prop_assert!(solver.solve(&part).is_ok());
        for i in 0..rows {
            part.push(whole.row(i), 0.0, false, f64::INFINITY);
        }
        let other = program(seed, n, rows, 0, Kind { condition: 1e2, ..Kind::default() });
        prop_assert_eq!(other.len(), whole.len());
        prop_assert!(solver.resume(&part).is_ok() || interior::solve(&part).is_err());
        let scratch = ActiveSet::new(n, 0).solve(&whole).cloned();
        let restarted = solver.solve(&whole).cloned();
        prop_assert_eq!(scratch.is_ok(), restarted.is_ok());
    }
}

/// Rows of high prices: Clarabel's point is 3e-4 off here, and costs more.
#[test]
fn of_two_answers_the_cheaper_one_is_right() {
    let kind =
        Kind { price: Some(10f64.powf(2.898_209_242_493_301)), contradictory: true, condition: 1e2, ..Kind::default() };
    compare(&program(14_520_122_465_574_976_311, 9, 31, 0, kind), kind).unwrap();
}

#[test]
fn names_a_contradiction() {
    let mut qp = Quadratic::new(2, 2);
    qp.hessian = vec![1.0, 0.0, 0.0, 1.0];
    qp.push(&[1.0, 0.0], -1.0, false, f64::INFINITY);
    qp.push(&[-1.0, 0.0], 0.0, false, f64::INFINITY);
    assert_eq!(ActiveSet::new(2, 2).solve(&qp).err(), Some(Failure::Inconsistent));
    assert_eq!(interior::solve(&qp).err(), Some(Failure::Inconsistent));
    qp.hessian[0] = -1.0;
    assert_eq!(ActiveSet::new(2, 2).solve(&qp).err(), Some(Failure::NotConvex));
}
