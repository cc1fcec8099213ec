//! Rust source from programs: one documented function per kernel, one file for all gaits that move the robot alike, and one
//! per gait.
//!
//! The functions are straight lines of `let`s over named values: no allocation, no indexing, no
//! branch. All of it is tokens first (`tokens`): a name or a number that cannot be one ends there. Items are parsed
//! before they are written, bodies written line by line (`lines`). What is no code, a header, is text, and so is
//! `support/math.rs`.

mod batch;
mod body;
mod description;
mod embedding;
mod family;
mod function;
mod gait;
mod lines;
mod methods;
mod modules;
mod scopes;
mod shapes;
mod specification;
mod tokens;
mod whole;

pub use embedding::{Embedding, embedding_module, embedding_source};
pub use family::{families_source, family_file_name, family_source};
pub use function::Function;
pub use gait::{Beside, Modules, gait_source};
pub use modules::{MATH_FILE, Together, file_name, registry_source};
pub use specification::{SPECIFICATION_FILE, specification_source};
pub use tokens::{Unwritable, Written};
pub use whole::{whole_module, whole_source};

/// The pinned sine and cosine, as source: beside every generated module.
pub const MATH: &str = include_str!("../../support/math.rs");
