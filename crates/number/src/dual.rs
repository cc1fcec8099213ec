//! Numbers with their derivatives: exact differentiation of whatever is computed with them.

use super::scalar::Scalar;
use crate::assigning;
use num_traits::Zero;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// x with its derivatives in N directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T, const N: usize> {
    pub x: T,
    pub d: [T; N],
}

impl<T: Scalar, const N: usize> Dual<T, N> {
    #[inline]
    pub fn constant(x: T) -> Self {
        Dual { x, d: [T::zero(); N] }
    }

    /// The variable of direction `k`.
    #[inline]
    pub fn variable(x: T, k: usize) -> Self {
        let mut variable = Dual::constant(x);
        variable.d[k] = T::from(1.0);
        variable
    }

    /// f(x), where f has this value and slope.
    #[inline]
    fn chain(self, value: T, slope: T) -> Self {
        Dual { x: value, d: self.d.map(|d| slope * d) }
    }

    #[inline]
    fn product(self, other: Self) -> Self {
        Dual { x: self.x * other.x, d: self.zip(other, |a, b| a * other.x + b * self.x) }
    }

    #[inline]
    fn quotient(self, other: Self) -> Self {
        let x = self.x / other.x;
        let per_unit = T::from(1.0) / other.x;
        Dual { x, d: self.zip(other, |a, b| (a - x * b) * per_unit) }
    }

    #[inline]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> [T; N] {
        std::array::from_fn(|k| f(self.d[k], other.d[k]))
    }
}

impl<T: Scalar, const N: usize> Scalar for Dual<T, N> {
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.x.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    #[inline]
    fn sqrt(self) -> Self {
        let root = self.x.sqrt();
        self.chain(root, T::from(0.5) / root)
    }

    /// At 0 the derivative is that from above.
    #[inline]
    fn abs(self) -> Self {
        self.chain(self.x.abs(), T::from(if self.x.value() < 0.0 { -1.0 } else { 1.0 }))
    }

    #[inline]
    fn side(self, rest: f64) -> Self {
        Dual::constant(self.x.side(rest))
    }

    #[inline]
    fn scale(self, factor: f64) -> Self {
        Dual { x: self.x.scale(factor), d: self.d.map(|d| d.scale(factor)) }
    }

    #[inline]
    fn value(self) -> f64 {
        self.x.value()
    }

    #[inline]
    fn least_magnitude(self) -> f64 {
        self.x.least_magnitude()
    }
}

impl<T: Scalar, const N: usize> From<f64> for Dual<T, N> {
    #[inline]
    fn from(x: f64) -> Self {
        Dual::constant(x.into())
    }
}

impl<T: Scalar, const N: usize> Zero for Dual<T, N> {
    #[inline]
    fn zero() -> Self {
        Dual::constant(T::zero())
    }

    #[inline]
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<T: Scalar, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Dual { x: -self.x, d: self.d.map(|d| -d) }
    }
}

impl<T: Scalar, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Dual { x: self.x + other.x, d: self.zip(other, |a, b| a + b) }
    }
}

impl<T: Scalar, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Dual { x: self.x - other.x, d: self.zip(other, |a, b| a - b) }
    }
}

impl<T: Scalar, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.product(other)
    }
}

impl<T: Scalar, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        self.quotient(other)
    }
}

assigning!([T: Scalar, const N: usize] Dual<T, N>);
