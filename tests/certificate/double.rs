//! Numbers of twice the precision, to judge those that claim to know their own: sums of two plain numbers.

use num_traits::Zero;
use piaffe::number::Scalar;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// high + low, with |low| ≤ ulp(high)/2: about 31 digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Double {
    pub high: f64,
    pub low: f64,
}

/// The sum of any two numbers, exactly (Knuth).
fn exact_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let of_b = high - a;
    Double { high, low: (a - (high - of_b)) + (b - of_b) }
}

fn exact_product(a: f64, b: f64) -> Double {
    let high = a * b;
    Double { high, low: a.mul_add(b, -high) }
}

impl Double {
    fn series(self, first: Double, from: usize) -> Double {
        // Σ first (−1)ⁿ x²ⁿ / (from + 1)…(from + 2n)
        let square = self * self;
        let (mut sum, mut term, mut k) = (first, first, from);
        while term.high.abs() > 1e-40 {
            term = -(term * square) / Double::from(((k + 1) * (k + 2)) as f64);
            sum += term;
            k += 2;
        }
        sum
    }

    pub fn magnitude(self) -> Double {
        if self.high < 0.0 { -self } else { self }
    }
}

impl Scalar for Double {
    fn sin_cos(self) -> (Double, Double) {
        // Halved until the series is short; then doubled as often.
        let halvings = 8;
        let small = Double { high: self.high / 256.0, low: self.low / 256.0 };
        let (mut sin, mut cos) = (small.series(small, 1), small.series(1.0.into(), 0));
        for _ in 0..halvings {
            (sin, cos) = (Double::from(2.0) * sin * cos, cos * cos - sin * sin);
        }
        (sin, cos)
    }

    fn sqrt(self) -> Double {
        if self.high <= 0.0 {
            return Double::zero();
        }
        let near = Double::from(self.high.sqrt());
        let nearer = (near + self / near) / 2.0.into();
        (nearer + self / nearer) / 2.0.into()
    }

    fn abs(self) -> Double {
        self.magnitude()
    }

    fn side(self, rest: f64) -> Double {
        self.high.side(rest).into()
    }

    fn value(self) -> f64 {
        self.high
    }

    fn least_magnitude(self) -> f64 {
        self.high.abs()
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Double {
        Double { high, low: 0.0 }
    }
}

impl Zero for Double {
    fn zero() -> Double {
        0.0.into()
    }

    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl Neg for Double {
    type Output = Double;
    fn neg(self) -> Double {
        Double { high: -self.high, low: -self.low }
    }
}

impl Add for Double {
    type Output = Double;
    fn add(self, other: Double) -> Double {
        let (high, low) = (exact_sum(self.high, other.high), exact_sum(self.low, other.low));
        let first = exact_sum(high.high, high.low + low.high);
        exact_sum(first.high, first.low + low.low)
    }
}

impl Sub for Double {
    type Output = Double;
    fn sub(self, other: Double) -> Double {
        self + -other
    }
}

impl Mul for Double {
    type Output = Double;
    fn mul(self, other: Double) -> Double {
        let product = exact_product(self.high, other.high);
        exact_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Double {
    type Output = Double;
    fn div(self, other: Double) -> Double {
        // Long division, three digits of 53 bits.
        let first = self.high / other.high;
        let left = self - other * first.into();
        let second = left.high / other.high;
        let left = left - other * second.into();
        exact_sum(first, second) + Double::from(left.high / other.high)
    }
}

impl AddAssign for Double {
    fn add_assign(&mut self, other: Double) {
        *self = *self + other;
    }
}

impl SubAssign for Double {
    fn sub_assign(&mut self, other: Double) {
        *self = *self - other;
    }
}

impl MulAssign for Double {
    fn mul_assign(&mut self, other: Double) {
        *self = *self * other;
    }
}

impl DivAssign for Double {
    fn div_assign(&mut self, other: Double) {
        *self = *self / other;
    }
}

#[test]
fn it_has_twice_the_digits() {
    let third = Double::from(1.0) / 3.0.into();
    assert!((third * 3.0.into() - 1.0.into()).high.abs() < 1e-31);
    let (sin, cos) = Double::from(2.5).sin_cos();
    assert!((sin * sin + cos * cos - 1.0.into()).high.abs() < 1e-29);
    assert!((sin.high - 2.5_f64.sin()).abs() < 1e-15 && sin.low != 0.0);
    // π is where the sine changes its sign: 3.14159265358979311600 + 1.2246467991473532e-16.
    let pi = Double { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };
    assert!(pi.sin_cos().0.high.abs() < 1e-29);
    let root = Double::from(2.0).sqrt();
    assert!((root * root - 2.0.into()).high.abs() < 1e-30);
}
