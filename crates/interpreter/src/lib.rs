//! Gaits of a specification as it stands, without a compiler.
//!
//! `piaffe_codegen` derives the dynamics of a gait as programs, which a build writes as Rust. Here the same programs are lists of
//! operations that are evaluated: an [`Interpreted`] gait has the bits of the built one. Deriving takes long for some robots: who has
//! chosen a [`Store`] does so once.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod derived;
mod description;
mod family;
mod gait;
mod kept;
mod robot;
mod shapes;
mod store;
mod tape;
mod twins;
mod whole;

pub use family::Family;
pub use gait::Interpreted;
pub use robot::{Robot, Unloadable};
pub use store::Store;
pub use tape::{Tape, Unrunnable};
