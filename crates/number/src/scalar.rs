//! The numbers that a motion is evaluated with.
//!
//! The physics is written once, for any of them: plain numbers give receipts, dual numbers ([`Dual`](super::Dual))
//! exact derivatives, and sets of numbers or functions of time proofs.

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::Zero;
use std::ops::Neg;

/// A field with the functions that rigid-body dynamics takes.
pub trait Scalar:
    nalgebra::Scalar
    + Copy
    + Zero
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
    + Neg<Output = Self>
    + From<f64>
{
    /// Whether it stands for a set of numbers, which long calculations make wider than it must be.
    const IS_SET: bool = false;

    fn sin_cos(self) -> (Self, Self);
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// Its sign: −1 or 1, and 0 where the magnitude is not above `rest`. Of a set it is the set of all signs; it has no derivative.
    fn side(self, rest: f64) -> Self;
    /// Times a plain number.
    #[inline]
    fn scale(self, factor: f64) -> Self {
        self * Self::from(factor)
    }
    /// The number by which choices are made: step sizes, pivots, which of two cases.
    fn value(self) -> f64;
    /// What |x| certainly is not below; NaN where x is not a number.
    fn least_magnitude(self) -> f64;
}

/// Gives a kind of number, with its generic parameters in brackets, `a op= b` as `a = a op b`.
#[macro_export]
macro_rules! assigning {
    ($generics:tt $type:ty) => {
        $crate::assigning! { $generics $type: AddAssign add_assign + }
        $crate::assigning! { $generics $type: SubAssign sub_assign - }
        $crate::assigning! { $generics $type: MulAssign mul_assign * }
        $crate::assigning! { $generics $type: DivAssign div_assign / }
    };
    ([$($generics:tt)*] $type:ty: $trait:ident $method:ident $op:tt) => {
        impl<$($generics)*> std::ops::$trait for $type {
            #[inline]
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    };
}

impl Scalar for f64 {
    fn sin_cos(self) -> (f64, f64) {
        libm::sincos(self)
    }

    #[inline]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline]
    fn side(self, rest: f64) -> f64 {
        if f64::abs(self) <= rest { 0.0 } else { self.signum() }
    }

    #[inline]
    fn scale(self, factor: f64) -> f64 {
        self * factor
    }

    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn least_magnitude(self) -> f64 {
        f64::abs(self)
    }
}
