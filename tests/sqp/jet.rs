//! Numbers that carry their first and second derivatives, so that a test problem is written once as plain formulas.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the formulas need.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    fn constant(value: f64) -> Self;
    /// φ(self) from φ, φ' and φ''.
    fn apply(self, phi: fn(f64) -> [f64; 3]) -> Self;

    fn sq(self) -> Self {
        self * self
    }
    fn pow(self, n: usize) -> Self {
        (0..n).fold(Self::constant(1.0), |p, _| p * self)
    }
    fn exp(self) -> Self {
        self.apply(|x| [x.exp(); 3])
    }
    fn ln(self) -> Self {
        self.apply(|x| [x.ln(), 1.0 / x, -1.0 / (x * x)])
    }
    fn sin(self) -> Self {
        self.apply(|x| [x.sin(), x.cos(), -x.sin()])
    }
    fn recip(self) -> Self {
        self.apply(|x| [1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x)])
    }
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn apply(self, phi: fn(f64) -> [f64; 3]) -> Self {
        phi(self)[0]
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Jet<const N: usize> {
    pub v: f64,
    pub g: [f64; N],
    pub h: [[f64; N]; N],
}

impl<const N: usize> Jet<N> {
    pub fn variable(v: f64, i: usize) -> Self {
        let mut jet = Self::constant(v);
        jet.g[i] = 1.0;
        jet
    }

    /// αa + βb + γ(∇a∇bᵀ + ∇b∇aᵀ) with a new value: every operation below is one of these.
    fn combine(v: f64, alpha: f64, a: &Self, beta: f64, b: &Self, gamma: f64) -> Self {
        let mut out = Self { v, g: [0.0; N], h: [[0.0; N]; N] };
        for i in 0..N {
            out.g[i] = alpha * a.g[i] + beta * b.g[i];
            for j in 0..N {
                out.h[i][j] = alpha * a.h[i][j] + beta * b.h[i][j] + gamma * (a.g[i] * b.g[j] + b.g[i] * a.g[j]);
            }
        }
        out
    }
}

impl<const N: usize> Scalar for Jet<N> {
    fn constant(value: f64) -> Self {
        Self { v: value, g: [0.0; N], h: [[0.0; N]; N] }
    }
    fn apply(self, phi: fn(f64) -> [f64; 3]) -> Self {
        let [v, first, second] = phi(self.v);
        Self::combine(v, first, &self, 0.0, &self, 0.5 * second)
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::combine(self.v + b.v, 1.0, &self, 1.0, &b, 0.0)
    }
}
impl<const N: usize> Sub for Jet<N> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::combine(self.v - b.v, 1.0, &self, -1.0, &b, 0.0)
    }
}
impl<const N: usize> Mul for Jet<N> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self::combine(self.v * b.v, b.v, &self, self.v, &b, 1.0)
    }
}
impl<const N: usize> Div for Jet<N> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn div(self, b: Self) -> Self {
        self * b.recip()
    }
}
impl<const N: usize> Neg for Jet<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}
impl<const N: usize> Add<f64> for Jet<N> {
    type Output = Self;
    fn add(mut self, b: f64) -> Self {
        self.v += b;
        self
    }
}
impl<const N: usize> Sub<f64> for Jet<N> {
    type Output = Self;
    fn sub(mut self, b: f64) -> Self {
        self.v -= b;
        self
    }
}
impl<const N: usize> Mul<f64> for Jet<N> {
    type Output = Self;
    fn mul(self, b: f64) -> Self {
        Self::combine(self.v * b, b, &self, 0.0, &self, 0.0)
    }
}
