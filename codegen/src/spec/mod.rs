//! The first pass: TOML text → a validated [`Robot`] and its [`Gait`]s, or every mistake with its place.
//!
//! `robot.toml` describes the real robot once: its links, joints, legs and actuators. A gait file says which
//! legs move together, how the platform may move, which coordinate is unactuated, and the limits. The format
//! is defined in `format.rs`, from which [`robot_schema`] and [`gait_schema`] are written; what a spec must
//! satisfy beyond its form is checked in `bodies.rs`, `tree.rs`, `chain.rs` (robot), `pairing.rs`, `mirror.rs`,
//! `coordinates.rs` and `phases.rs` (gait).
//!
//! `set.rs` changes numbers where they stand in the files, `words.rs` has what is no number, `load.rs` puts a load on the platform.
//!
//! What gaits make of legs is in `locked.rs` (joints held still) and `as_one.rs` (legs that move as one).
//!
//! A quantity with a unit never has a default, but where absence says all there is: a platform's mass centre
//! lies at the origin of the frame of the legs' mounts unless `com` says otherwise, axes are principal ones
//! unless `products` are given, there is no foot without `foot_mass`, a joint has no friction without `damping` or `coulomb`, a platform has no
//! `extent`, and body and platform must stay above the ground at no particular height unless `body_clearance` and
//! `min_platform_height` say so. Other defaults: a joint's `axis` is
//! pitch, a leg's `first_joint` is the only joint that hangs on the platform, a gait's `name` is its file's
//! name, its `polynomial_order` is 4, and it locks no joints.

mod as_one;
mod bodies;
mod chain;
mod code;
mod coordinates;
mod decode;
pub(crate) mod diagnostic;
mod field;
mod format;
mod gait;
mod keys;
mod load;
mod locked;
mod mirror;
pub(crate) mod modules;
pub mod name;
mod nearest;
mod pairing;
mod phases;
mod rigid;
mod robot;
mod schema;
mod set;
mod syntax;
mod tree;
mod types;
mod view;
mod words;

#[cfg(test)]
mod tests;

pub use code::Code;
pub use diagnostic::{BYTE_ORDER_MARK, Diagnostic, Label, Source, Span};
pub use format::default_of;
pub use gait::{gait_mistakes, parse_gait};
pub use load::load;
pub use locked::Tilted;
pub use name::unusable_as_folder;
pub use robot::{RobotFile, parse_robot};
pub use schema::{gait_schema, robot_schema};
pub use set::{alternatives, is_duration_on_a_foot, number, numbers, set, set_all, unknown};
pub use types::*;
pub use words::{Word, words};
