//! Numbers side by side: one pass through the physics evaluates several instants, each with the bits of its own pass.

use super::scalar::Scalar;
use crate::assigning;
use num_traits::Zero;
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// N numbers, on each of which every operation acts alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<const N: usize>(pub [f64; N]);

impl<const N: usize> Lanes<N> {
    #[inline]
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        Lanes(self.0.map(f))
    }

    #[inline]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Lanes(from_fn(|lane| f(self.0[lane], other.0[lane])))
    }
}

impl<const N: usize> Scalar for Lanes<N> {
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let both = self.0.map(Scalar::sin_cos);
        (Lanes(both.map(|(sin, _)| sin)), Lanes(both.map(|(_, cos)| cos)))
    }

    #[inline]
    fn sqrt(self) -> Self {
        self.each(f64::sqrt)
    }

    #[inline]
    fn abs(self) -> Self {
        self.each(f64::abs)
    }

    #[inline]
    fn side(self, rest: f64) -> Self {
        self.each(|x| x.side(rest))
    }

    #[inline]
    fn scale(self, factor: f64) -> Self {
        self.each(|x| x * factor)
    }

    /// That of the first lane.
    #[inline]
    fn value(self) -> f64 {
        self.0[0]
    }

    /// That of the lane where it is least.
    #[inline]
    fn least_magnitude(self) -> f64 {
        let lower = |least: f64, x: &f64| if x.abs() < least || x.is_nan() { x.abs() } else { least };
        self.0.iter().fold(f64::INFINITY, lower)
    }
}

impl<const N: usize> From<f64> for Lanes<N> {
    #[inline]
    fn from(x: f64) -> Self {
        Lanes([x; N])
    }
}

impl<const N: usize> Zero for Lanes<N> {
    #[inline]
    fn zero() -> Self {
        Lanes([0.0; N])
    }

    #[inline]
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.each(|x| -x)
    }
}

impl<const N: usize> Add for Lanes<N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Lanes<N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Lanes<N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl<const N: usize> Div for Lanes<N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
}

assigning!([const N: usize] Lanes<N>);
