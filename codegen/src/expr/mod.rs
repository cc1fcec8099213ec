//! Symbolic expressions: polynomials in *atoms* with numeric coefficients.
//!
//! Everything that rigid-body dynamics needs is polynomial in sines and cosines of absolute angles,
//! rates and accelerations. So the canonical form is the polynomial's own: terms sorted, like terms
//! collected, constants folded, and `sin²` replaced by `1 − cos²` ([`laws`] has them all), so that
//! equal expressions are equal data. What is not polynomial (a solved system, a reciprocal) enters as a *bound* atom with
//! a definition. `space` has vectors and rotations of such expressions.

pub mod laws;
mod poly;
mod ring;
mod space;

pub use poly::{Monomial, Poly, Terms, Var};
pub use ring::{Kind, Ring};
pub use space::{Frame, Mat3, Vec3, add, cross, dot, rotate, subtract, zero};
