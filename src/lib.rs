//! Optimal periodic gaits of legged robots, from a declarative description, with a receipt for each.

#![forbid(unsafe_code)]

pub mod model;
pub mod states;

/// Generated dynamics: one module per gait of `model-spec`.
pub mod gaits {
    include!(concat!(env!("OUT_DIR"), "/gaits.rs"));
}
