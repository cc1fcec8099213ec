//! From a declarative description of a legged robot to closed-form, allocation-free Rust.
//!
//! The passes, in the order in which data flows: [`spec`] (TOML, validated, with diagnostics) →
//! [`mechanism`] (the real tree in the coordinates of a gait) → [`expr`] (canonical polynomials) →
//! [`dynamics`] (kernels: the equations of motion) → [`program`] (factored, scheduled) → [`emit`]
//! (Rust source). Each pass is a pure function: same spec, same bytes. Only [`Config`] reads the
//! environment and prints.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod changes;
mod config;
pub mod dynamics;
pub mod emit;
pub mod expr;
mod files;
mod generate;
pub mod math;
pub mod mechanism;
pub mod program;
#[path = "../support/sources.rs"]
pub mod sources;
pub mod spec;
mod turns;
pub mod typeset;

pub use changes::{Changes, Load};
pub use config::Config;
pub use files::{RobotFiles, SpecFile};
pub use generate::{Generated, Specified, check, generate, generate_families, specified};

/// Tells this derivation from that of any other version: a hash of its sources.
pub const SOURCES: &str = env!("SOURCES");
