//! Between which numbers a Taylor model stays, as a whole and half by half.

use super::bernstein::{Bernstein, CLOSE};
use super::taylor::{Ball, Taylor, UNIT, above};
use piaffe_number::Scalar;

impl<const N: usize> Taylor<N> {
    /// What |f| nowhere exceeds.
    pub fn magnitude(&self) -> f64 {
        if self.is_known() { above(self.norm() + self.rest) } else { f64::INFINITY }
    }

    /// Numbers between which f stays: exact up to second order.
    pub fn bounds(&self) -> [f64; 2] {
        [self.floor(), -(-*self).floor()]
    }

    /// The greatest lower bound of f that is worth finding.
    pub fn least(&self) -> f64 {
        let floor = self.floor();
        let taken = [-1.0, 1.0].map(|end| self.at(end).value()).into_iter().fold(self.c[0], f64::min);
        if floor >= taken - self.rest - CLOSE || !floor.is_finite() {
            return floor;
        }
        let (polynomial, rounding) = Bernstein::new(self);
        (polynomial.least() - above(self.rest + rounding)).next_down().max(floor)
    }

    /// The same, and an upper bound that is exact up to second order.
    pub fn range(&self) -> [f64; 2] {
        [self.least(), self.bounds()[1]]
    }

    fn floor(&self) -> f64 {
        if !self.is_known() {
            return f64::NEG_INFINITY;
        }
        let [a, b, c] = [0, 1, 2].map(|k| self.c.get(k).copied().unwrap_or(0.0));
        let mut least = (a + c) - b.abs();
        if b.abs() < 2.0 * c {
            // The vertex lies between the ends.
            least = a - 0.25 * b * (b / c);
        }
        let higher: f64 = self.c.iter().skip(3).map(|c| c.abs()).sum();
        let rounding = 16.0 * UNIT * (a.abs() + b.abs() + c.abs());
        (least - above(higher + self.rest + rounding)).next_down()
    }

    /// The two halves of the interval, each stretched to [−1, 1].
    pub fn halves(&self) -> [Self; 2] {
        [-0.5, 0.5].map(|middle| {
            // By Horner: multiplied by (middle + τ/2), the sum of the magnitudes of the coefficients does not grow.
            let mut half = Taylor { c: [0.0; N], ..*self };
            for c in self.coefficients().iter().rev() {
                for k in (1..=self.degree).rev() {
                    half.c[k] = middle * half.c[k] + 0.5 * half.c[k - 1];
                }
                half.c[0] = middle * half.c[0] + c;
            }
            let rounding = 4.0 * N as f64 * UNIT * self.norm();
            half.rest = if self.degree == 0 { self.rest } else { above(self.rest + rounding) };
            half
        })
    }

    /// The ball of values at τ, from −1 to 1.
    pub fn at(&self, tau: f64) -> Ball {
        let value = self.coefficients().iter().rev().fold(0.0, |sum, c| sum * tau + c);
        let rounding = 2.0 * N as f64 * UNIT * self.norm();
        Taylor::from(value).widened(self.rest + rounding)
    }
}
