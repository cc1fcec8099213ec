//! Functions of Taylor models: a polynomial that is nearly the result, and a proof of how nearly.
//!
//! The polynomial comes from the recurrences of power series, in plain arithmetic. What it misses is bounded by how far
//! it is from solving the equation that defines the function: y f = 1, y² = f, or (sin f)′ = f′ cos f.

use super::taylor::{Taylor, UNIT, above};
use num_traits::Zero;
use piaffe_number::Scalar;
use std::ops::Div;

/// Error of the plain sine and cosine. `libm`'s are within 1 ulp, which is at most an eighth of this.
const SINE: f64 = 8.0 * UNIT;

impl<const N: usize> Taylor<N> {
    /// 1/f.
    pub fn reciprocal(self) -> Self {
        let mut y = Self::zero();
        y.degree = if self.degree == 0 { 0 } else { N - 1 };
        y.c[0] = 1.0 / self.c[0];
        for k in 1..=y.degree {
            let sum: f64 = (1..=k).map(|j| self.c[j] * y.c[k - j]).sum();
            y.c[k] = -y.c[0] * sum;
        }
        // With e = 1 − y f: 1/f − y = y e / (1 − e).
        let e = (Self::from(1.0) - y * self).magnitude();
        if e.is_nan() || e >= 0.5 {
            return Taylor::UNKNOWN;
        }
        y.widened(y.norm() * e / (1.0 - e))
    }

    /// Anything from 0 to `most`.
    fn up_to(most: f64) -> Self {
        if most.is_finite() { Taylor::from(0.5 * most).widened(0.5 * most) } else { Taylor::UNKNOWN }
    }
}

impl<const N: usize> Scalar for Taylor<N> {
    const IS_SET: bool = true;

    fn sin_cos(self) -> (Self, Self) {
        let [mut sin, mut cos] = [Self::zero(); 2];
        (sin.c[0], cos.c[0]) = libm::sincos(self.c[0]);
        let degree = if self.degree == 0 { 0 } else { N - 1 };
        (sin.degree, cos.degree) = (degree, degree);
        let slope = self.exact().slope();
        for k in 1..=degree {
            let [mut by_cos, mut by_sin] = [0.0; 2];
            for j in 0..k {
                by_cos += slope.c[j] * cos.c[k - 1 - j];
                by_sin += slope.c[j] * sin.c[k - 1 - j];
            }
            (sin.c[k], cos.c[k]) = (by_cos / k as f64, -by_sin / k as f64);
        }
        // The error turns with the angle and grows by the defects alone; the rest of the angle goes over as it is.
        let defects = (sin.slope() - slope * cos).magnitude() + (cos.slope() + slope * sin).magnitude();
        let error = 2.0 * SINE + defects + self.rest;
        if error.is_nan() || !self.is_known() {
            return (Taylor::UNKNOWN, Taylor::UNKNOWN);
        }
        (sin.widened(error), cos.widened(error))
    }

    /// Of what is not negative.
    fn sqrt(self) -> Self {
        let mut y = Self::zero();
        y.degree = if self.degree == 0 { 0 } else { N - 1 };
        y.c[0] = self.c[0].max(0.0).sqrt();
        for k in 1..=y.degree {
            let sum: f64 = (1..k).map(|j| y.c[j] * y.c[k - j]).sum();
            y.c[k] = (self.c[k] - sum) / (2.0 * y.c[0]);
        }
        // √f − y = (f − y²) / (√f + y).
        let least = y.bounds()[0];
        if least > 0.0 {
            return y.widened((self - y * y).magnitude() / least);
        }
        let most = above(self.bounds()[1].max(0.0)).sqrt();
        Taylor::up_to(most)
    }

    fn abs(self) -> Self {
        match self.bounds() {
            [low, _] if low >= 0.0 => self,
            [_, high] if high <= 0.0 => -self,
            [low, high] => Taylor::up_to(high.max(-low)),
        }
    }

    fn side(self, rest: f64) -> Self {
        match self.bounds() {
            [low, _] if low > rest => Taylor::from(1.0),
            [_, high] if high < -rest => Taylor::from(-1.0),
            [low, high] if low >= -rest && high <= rest => Taylor::zero(),
            // Not known, too.
            _ => Taylor::zero().widened(1.0),
        }
    }

    fn scale(self, factor: f64) -> Self {
        self.times(factor)
    }

    fn value(self) -> f64 {
        self.c[0]
    }

    fn least_magnitude(self) -> f64 {
        let [low, high] = self.bounds();
        low.max(-high).max(0.0)
    }
}

impl<const N: usize> Div for Taylor<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        #[allow(clippy::suspicious_arithmetic_impl)] // That is how models are divided.
        let quotient = self * other.reciprocal();
        quotient
    }
}
