//! Independent verification of a periodic motion: the receipt without which no result is given out.
//!
//! From the numbers of the specification and the variables of the motion alone, and with no code in
//! common with the optimizer:
//!
//! 1. Q(t) by divided differences ([`polynomial`], eq. 15);
//! 2. β(t) by adaptive integration of order 8 ([`integrate`], eq. 20–22) of the balance of all bodies
//!    about the stance foot or, in flight, the falling mass centre ([`support`], eq. 10; [`contact`]), from Newton–Euler dynamics in numbers
//!    ([`multibody`], eq. 4, 5), in space or where it suffices in the plane ([`geometry`]);
//! 3. every constraint of §4.2 and §6.1 on a dense grid (`grid.rs`, [`constraint`]), and both criteria
//!    (eq. 13, 14) by quadrature that respects changes of sign ([`quadrature`]);
//! 4. the impacts ([`impact`], eq. 12) and how nearly the cycle closes (`cycle.rs`, eq. 16–19, 23, 24).
//!
//! From Q(t), β and β̇ to every margin the physics is written for any kind of number ([`number`](piaffe_number)) and with the robot's
//! numbers as such ([`numbers`]): plain ones, those of several instants side by side ([`Lanes`](piaffe_number::Lanes)), those that carry
//! derivatives ([`Dual`](piaffe_number::Dual)), or functions of time with bounds.
//!
//! Sines and cosines come from the `libm` crate and everything else is arithmetic of IEEE 754, in a
//! fixed order: the same motion gets the same receipt, to the bit, on every machine.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod certificate;
pub mod constraint;
pub mod contact;
pub mod cycle;
mod error;
pub mod geometry;
mod grid;
pub mod heights;
pub mod impact;
pub mod instants;
pub mod integrate;
pub mod margins;
pub mod multibody;
pub mod numbers;
pub mod phase;
pub mod polynomial;
pub mod quadrature;
mod receipt;
mod sample;
pub mod support;
pub mod swing;
mod tableau;

pub use error::VerifyError;
pub(crate) use error::{SMALLEST_GRID, check};
pub use receipt::{Finding, JointPeak, Receipt, verify};
pub use sample::{Sample, sample};
