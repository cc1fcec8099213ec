//! Adaptive integration of ẏ = f(t, y) to high order, with dense output.
//!
//! Dormand and Prince's method of order 8 with the step control and the interpolant of DOP853 (see
//! `tableau.rs`). A right-hand side that is not defined, or a result that is not
//! finite, counts as too large a step; steps that get too small or too many end the integration.

use super::tableau::{A, ALL_STAGES, C, D, E3, E5, Row, STAGES};
use piaffe_number::Scalar;

/// Steps, accepted or not, after which an integration is given up.
const MAX_STEPS: usize = 10_000;
/// Smallest step, as a share of the whole interval.
const SMALLEST: f64 = 1e-10;
const SAFETY: f64 = 0.9;
/// Least and greatest change of the step from one to the next.
const CHANGE: [f64; 2] = [0.2, 8.0];

/// Why an integration stopped at `time`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// The step that would keep the error small became too small: the solution blows up.
    Blowup { time: f64 },
    /// Too many steps.
    Steps { time: f64 },
}

/// A solution as a function of time.
#[derive(Clone, Debug)]
pub struct Solution<const N: usize, T = f64> {
    steps: Vec<Step<N, T>>,
    end: [T; N],
}

/// An accepted step with its interpolant.
#[derive(Clone, Debug)]
struct Step<const N: usize, T> {
    start: f64,
    length: f64,
    y: [T; N],
    coefficients: [[T; N]; 7],
}

/// Integrates from `start` to `end`; `tolerance` is relative to max(1, |y|), per step.
///
/// Steps are chosen by the values of y: derivatives that its numbers carry are those of the steps taken.
///
/// # Errors
/// If the solution cannot be continued to `end`.
pub fn integrate<const N: usize, T: Scalar>(
    mut f: impl FnMut(f64, &[T; N]) -> Option<[T; N]>,
    start: f64,
    end: f64,
    y: [T; N],
    tolerance: f64,
) -> Result<Solution<N, T>, Stop> {
    let span = end - start;
    let (mut t, mut y) = (start, y);
    let mut solution = Solution { steps: Vec::with_capacity(64), end: y };
    let mut k = [[T::zero(); N]; ALL_STAGES];
    k[0] = f(t, &y).filter(|rate| finite(rate)).ok_or(Stop::Blowup { time: t })?;
    let mut h = span / 16.0;
    let mut rejected = false;
    for _ in 0..MAX_STEPS {
        if t >= end {
            solution.end = y;
            return Ok(solution);
        }
        let last = t + 1.01 * h >= end;
        if last {
            h = end - t;
        }
        let next = advance(&mut f, t, h, &y, &mut k);
        let error = next.map_or(f64::INFINITY, |next| error(&k, h, &y, &next, tolerance));
        let accepted = next.filter(|_| error <= 1.0);
        let step = accepted.and_then(|next| interpolant(&mut f, t, h, &y, &next, &mut k).map(|step| (next, step)));
        let Some((next, step)) = step else {
            h *= if error.is_finite() { (SAFETY / eighth_root(error)).clamp(CHANGE[0], 0.9) } else { CHANGE[0] };
            rejected = true;
            if h < SMALLEST * span {
                return Err(Stop::Blowup { time: t });
            }
            continue;
        };
        solution.steps.push(step);
        t = if last { end } else { t + h };
        y = next;
        k[0] = k[STAGES];
        let most = if rejected { 1.0 } else { CHANGE[1] };
        // An error of zero asks for the greatest change.
        h *= (SAFETY / eighth_root(error).max(1e-3)).clamp(CHANGE[0], most);
        rejected = false;
    }
    Err(Stop::Steps { time: t })
}

impl<const N: usize, T: Scalar> Solution<N, T> {
    /// y at the end of the interval.
    pub fn end(&self) -> [T; N] {
        self.end
    }

    /// Number of accepted steps.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// y at time `t`, to order 7. `cursor` remembers the step; start it with 0 and let times grow.
    pub fn at(&self, t: f64, cursor: &mut usize) -> [T; N] {
        while *cursor + 1 < self.steps.len() && t >= self.steps[*cursor + 1].start {
            *cursor += 1;
        }
        let Some(step) = self.steps.get(*cursor) else { return self.end };
        let x = (t - step.start) / step.length;
        let mut y = [T::zero(); N];
        for (power, c) in step.coefficients.iter().rev().enumerate() {
            let factor = if power % 2 == 0 { x } else { 1.0 - x };
            for (y, c) in y.iter_mut().zip(c) {
                *y = (*y + *c).scale(factor);
            }
        }
        for (y, start) in y.iter_mut().zip(&step.y) {
            *y += *start;
        }
        y
    }
}

/// y after a step, with its stages in `k`.
fn advance<const N: usize, T: Scalar>(
    f: &mut impl FnMut(f64, &[T; N]) -> Option<[T; N]>,
    t: f64,
    h: f64,
    y: &[T; N],
    k: &mut [[T; N]; ALL_STAGES],
) -> Option<[T; N]> {
    for stage in 1..STAGES {
        k[stage] = f(t + C[stage] * h, &shifted(y, h, &combine(A[stage], k)))?;
    }
    let next = shifted(y, h, &combine(A[STAGES], k));
    k[STAGES] = f(t + h, &next)?;
    (finite(&next) && finite(&k[STAGES])).then_some(next)
}

/// Error of a step in units of the tolerance: the estimates of order 5 and 3 together.
fn error<const N: usize, T: Scalar>(
    k: &[[T; N]; ALL_STAGES],
    h: f64,
    y: &[T; N],
    next: &[T; N],
    tolerance: f64,
) -> f64 {
    let [y, next, e5, e3] = [*y, *next, combine(E5, k), combine(E3, k)].map(|list| list.map(T::value));
    let (mut fifth, mut third) = (0.0, 0.0);
    for i in 0..N {
        let scale = tolerance * y[i].abs().max(next[i].abs()).max(1.0);
        fifth += (e5[i] / scale) * (e5[i] / scale);
        third += (e3[i] / scale) * (e3[i] / scale);
    }
    let denominator = fifth + 0.01 * third;
    if denominator == 0.0 { 0.0 } else { h * fifth / (denominator * N as f64).sqrt() }
}

fn interpolant<const N: usize, T: Scalar>(
    f: &mut impl FnMut(f64, &[T; N]) -> Option<[T; N]>,
    t: f64,
    h: f64,
    y: &[T; N],
    next: &[T; N],
    k: &mut [[T; N]; ALL_STAGES],
) -> Option<Step<N, T>> {
    for stage in STAGES + 1..ALL_STAGES {
        k[stage] = f(t + C[stage] * h, &shifted(y, h, &combine(A[stage], k)))?;
    }
    let mut coefficients = [[T::zero(); N]; 7];
    for i in 0..N {
        let difference = next[i] - y[i];
        coefficients[0][i] = difference;
        coefficients[1][i] = k[0][i].scale(h) - difference;
        coefficients[2][i] = difference.scale(2.0) - (k[STAGES][i] + k[0][i]).scale(h);
    }
    for (row, c) in D.iter().zip(&mut coefficients[3..]) {
        *c = combine(row, k).map(|x| x.scale(h));
    }
    Some(Step { start: t, length: h, y: *y, coefficients })
}

fn combine<const N: usize, T: Scalar>(row: Row, k: &[[T; N]; ALL_STAGES]) -> [T; N] {
    let mut sum = [T::zero(); N];
    for (stage, weight) in row {
        for (s, k) in sum.iter_mut().zip(&k[*stage]) {
            *s += k.scale(*weight);
        }
    }
    sum
}

fn shifted<const N: usize, T: Scalar>(y: &[T; N], h: f64, rate: &[T; N]) -> [T; N] {
    std::array::from_fn(|i| y[i] + rate[i].scale(h))
}

fn finite<T: Scalar>(y: &[T]) -> bool {
    y.iter().all(|x| x.value().is_finite())
}

/// By square roots, which are the same bits everywhere.
fn eighth_root(x: f64) -> f64 {
    x.sqrt().sqrt().sqrt()
}
