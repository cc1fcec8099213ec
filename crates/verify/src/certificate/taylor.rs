//! Taylor models: functions of one variable as a polynomial and a bound on what it misses.
//!
//! A model stands for all functions f on [−1, 1] with |f(τ) − Σ cₖ τᵏ| ≤ rest. Operations give a model of the result
//! for whatever functions the operands stand for: terms of too high an order and all rounding go into the rest. With
//! one coefficient it is a ball of numbers. A rest that is not finite says nothing at all.
//!
//! Rounding is bounded, not switched: a sum or product of IEEE 754 is off by at most a share [`UNIT`] of itself, and
//! every bound is made greater by more than its own evaluation can have lost (`above`).

use num_traits::Zero;
use piaffe_number::assigning;
use std::ops::{Add, Mul, Neg, Sub};

/// Half the distance of 1 from the next number.
pub const UNIT: f64 = f64::EPSILON / 2.0;

/// More than underflow can lose, and so much more that products of it are not slowed down by underflow themselves.
const UNDERFLOW: f64 = 1e-140;

/// A model with N coefficients; see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor<const N: usize> {
    pub(super) c: [f64; N],
    /// Coefficients beyond it are 0.
    pub(super) degree: usize,
    pub(super) rest: f64,
}

/// A number and how far it may be off.
pub type Ball = Taylor<1>;

/// More than the exact value of a sum of up to 100 products of non-negative numbers that was found to be `x`.
pub(super) fn above(x: f64) -> f64 {
    x * (1.0 + 1e-13) + UNDERFLOW
}

impl<const N: usize> Taylor<N> {
    /// Stands for every function, and for none that is defined.
    pub const UNKNOWN: Self = Taylor { c: [0.0; N], degree: 0, rest: f64::INFINITY };

    /// The polynomial with these coefficients; those that do not fit go into the rest.
    pub fn polynomial(coefficients: &[f64]) -> Self {
        let (within, cut) = coefficients.split_at(coefficients.len().min(N));
        let mut polynomial = Taylor::zero();
        polynomial.c[..within.len()].copy_from_slice(within);
        polynomial.degree = within.len().max(1) - 1;
        if cut.is_empty() { polynomial } else { polynomial.widened(cut.iter().map(|c| c.abs()).sum()) }
    }

    /// The same functions with fewer or more coefficients.
    pub fn cast<const M: usize>(&self) -> Taylor<M> {
        let cast = Taylor::polynomial(self.coefficients());
        if self.rest == 0.0 { cast } else { cast.widened(self.rest) }
    }

    /// The same with up to `more` added or taken away.
    pub fn widened(self, more: f64) -> Self {
        Taylor { rest: above(self.rest + more), ..self }
    }

    /// Half the width of the band around the polynomial.
    pub fn rest(&self) -> f64 {
        self.rest
    }

    pub(super) fn is_known(&self) -> bool {
        self.rest.is_finite() && self.c.iter().all(|c| c.is_finite())
    }

    /// Coefficients up to the degree.
    pub fn coefficients(&self) -> &[f64] {
        &self.c[..=self.degree]
    }

    /// Σ |cₖ|: the polynomial is nowhere greater.
    pub(super) fn norm(&self) -> f64 {
        self.coefficients().iter().map(|c| c.abs()).sum()
    }

    /// The same without its rest.
    pub(super) fn exact(self) -> Self {
        Taylor { rest: 0.0, ..self }
    }

    fn is_nothing(&self) -> bool {
        self.degree == 0 && self.c[0] == 0.0 && self.rest == 0.0
    }

    /// dp/dτ of the polynomial p alone.
    pub(super) fn slope(&self) -> Self {
        let mut slope = Taylor::zero();
        slope.degree = self.degree.saturating_sub(1);
        for k in 1..=self.degree {
            slope.c[k - 1] = k as f64 * self.c[k];
        }
        slope.rest = above(UNIT * slope.norm());
        slope
    }

    /// ∫ from −1 to τ.
    pub fn integral(&self) -> Self {
        let mut sum = Taylor::zero();
        sum.degree = (self.degree + 1).min(N - 1);
        let mut start = 0.0;
        let mut beyond = 0.0;
        for (k, c) in self.coefficients().iter().enumerate() {
            let term = c / (k + 1) as f64;
            start += if k % 2 == 0 { term } else { -term };
            match sum.c.get_mut(k + 1) {
                Some(place) => *place = term,
                None => beyond = term.abs(),
            }
        }
        sum.c[0] = start;
        // Each term and the sum of them at −1, over an interval of at most 2.
        let rounding = UNIT * (N + 2) as f64 * 2.0 * self.norm();
        sum.rest = above(2.0 * self.rest + beyond + rounding);
        sum
    }

    fn sum(self, other: Self) -> Self {
        if other.is_nothing() {
            return self;
        }
        if self.is_nothing() {
            return other;
        }
        let mut sum = self;
        sum.degree = self.degree.max(other.degree);
        for (c, more) in sum.c.iter_mut().zip(other.coefficients()) {
            *c += more;
        }
        sum.rest = above(self.rest + other.rest + UNIT * sum.norm());
        sum
    }

    fn product(self, other: Self) -> Self {
        if self.is_nothing() && other.is_known() || other.is_nothing() && self.is_known() {
            return Taylor::zero();
        }
        let mut product = Taylor::zero();
        product.degree = (self.degree + other.degree).min(N - 1);
        // What the i-th coefficient multiplies is too high from the other's (N − i)-th on.
        let (mut beyond, mut cut) = (0.0, 0.0);
        for (i, a) in self.coefficients().iter().enumerate() {
            for (c, b) in product.c[i..].iter_mut().zip(other.coefficients()) {
                *c += a * b;
            }
            if i > 0 {
                cut += other.c[N - i].abs();
            }
            beyond += a.abs() * cut;
        }
        let (of_self, of_other) = (self.norm(), other.norm());
        // A coefficient sums up to N products.
        let rounding = UNIT * (N + 2) as f64 * of_self * of_other;
        let rests = of_self * other.rest + of_other * self.rest + self.rest * other.rest;
        product.rest = above(rests + beyond + rounding);
        product
    }

    /// Times a plain number.
    pub(super) fn times(self, factor: f64) -> Self {
        if self.is_nothing() {
            return self;
        }
        let mut scaled = self;
        for c in &mut scaled.c[..=self.degree] {
            *c *= factor;
        }
        scaled.rest = above(self.rest * factor.abs() + UNIT * scaled.norm());
        scaled
    }
}

impl<const N: usize> From<f64> for Taylor<N> {
    fn from(x: f64) -> Self {
        Taylor::polynomial(&[x])
    }
}

impl<const N: usize> Zero for Taylor<N> {
    fn zero() -> Self {
        Taylor { c: [0.0; N], degree: 0, rest: 0.0 }
    }

    fn is_zero(&self) -> bool {
        self.is_nothing()
    }
}

impl<const N: usize> Neg for Taylor<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Taylor { c: self.c.map(|c| -c), ..self }
    }
}

impl<const N: usize> Add for Taylor<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.sum(other)
    }
}

impl<const N: usize> Sub for Taylor<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.sum(-other)
    }
}

impl<const N: usize> Mul for Taylor<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.product(other)
    }
}

assigning!([const N: usize] Taylor<N>);
