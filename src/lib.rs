//! Optimal periodic gaits of legged robots, from a declarative description, with a receipt for each.

#![forbid(unsafe_code)]

pub mod altered;
pub mod audit;
pub mod certificate;
pub mod constraints;
pub mod cost;
pub mod cycle;
mod examine;
pub mod export;
pub mod finite;
pub mod four_legs;
pub mod import;
pub mod instant;
mod lgl;
pub mod model;
pub mod motion;
pub mod number;
pub mod optimality;
pub mod origin;
pub mod overview;
mod polynomial;
pub mod readback;
pub mod report;
pub mod result;
pub mod search;
pub mod sensitivity;
pub mod sqp;
pub mod stability;
pub mod stance;
pub mod standing;
pub mod states;
pub mod trajectory;
pub mod units;
pub mod verdict;
pub mod verify;
pub mod walk;

/// The programs in the book are run as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
mod book {}

/// Generated dynamics: one module per gait of `model-spec`.
pub mod gaits {
    include!(concat!(env!("OUT_DIR"), "/gaits.rs"));
}
