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
pub use modules::{check_modules, file_name, registry_source};
pub use whole::{whole_file_name, whole_module, whole_source};

/// The pinned sine and cosine, as source: part of every generated module.
pub const MATH: &str = include_str!("../../support/math.rs");

/// `trot` → `Trot`.
pub fn type_name(name: &str) -> String {
    let mut result = String::new();
    let mut upper = true;
    for c in name.chars() {
        if c.is_ascii_alphanumeric() {
            result.extend(if upper { c.to_uppercase().collect::<Vec<_>>() } else { vec![c] });
        }
        upper = !c.is_ascii_alphanumeric();
    }
    result
}

/// A name as a Rust identifier: lower case, `_` for everything else.
pub fn module_name(name: &str) -> String {
    let mut result: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect();
    if result.starts_with(|c: char| c.is_ascii_digit()) || result.is_empty() {
        result.insert(0, '_');
    }
    result
}
