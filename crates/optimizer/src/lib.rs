//! The optimal periodic gait: from the variables of a motion to everything that criteria and limits look at, the search for an
//! optimum, and what is said of it.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod altered;
pub mod audit;
pub mod constraints;
pub mod cost;
pub mod cycle;
pub mod examine;
pub mod finite;
pub mod flow;
pub mod four_legs;
pub mod instant;
mod lgl;
pub mod optimality;
pub mod optimize;
pub mod origin;
mod passive;
mod polynomial;
pub mod readback;
pub mod result;
pub mod search;
pub mod sensitivity;
pub mod stability;
pub mod states;
mod swing;
pub mod trajectory;
pub mod verdict;
pub mod walk;
