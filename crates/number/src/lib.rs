//! Kinds of numbers that a formula can be evaluated with, once it is written for any [`Scalar`].
//!
//! They know nothing of robots: optimizer and verifier both calculate with them.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod dual;
mod lanes;
mod scalar;

pub use dual::Dual;
pub use lanes::Lanes;
pub use scalar::Scalar;
