//! Rust source from programs: one documented function per kernel, one file per gait.
//!
//! The functions are straight lines of `let`s over named values: no allocation, no indexing, no
//! branch.

mod batch;
mod body;
mod description;
mod family;
mod function;
mod gait;
mod layout;
mod modules;
mod scopes;
mod whole;

pub use family::{families_source, family_file_name, family_source};
pub use gait::gait_source;
pub use modules::{file_name, registry_source};
pub use whole::{whole_file_name, whole_module, whole_source};

/// The pinned sine and cosine, as source: part of every generated module.
pub const MATH: &str = include_str!("../../support/math.rs");
