//! Optimal periodic gaits of legged robots, from a declarative description, with a receipt for each.
//!
//! This package holds the robots of `model-spec/`: its build derives their dynamics. Everything else comes from crates that
//! know no robot, so that an edit of a robot compiles its dynamics and nothing more. [`Robot`] reads any other robot from its files, without a
//! compiler.

#![forbid(unsafe_code)]

pub use optimize::Unaskable;
#[cfg(feature = "cli")]
pub use piaffe_cli as cli;
#[cfg(feature = "export")]
pub use piaffe_export as export;
#[cfg(feature = "import")]
pub use piaffe_import as import;
#[cfg(feature = "interpreter")]
pub use piaffe_interpreter as interpreter;
#[cfg(feature = "interpreter")]
pub use piaffe_interpreter::Robot;
pub use piaffe_model as model;
pub use piaffe_model::{motion, units};
pub use piaffe_number as number;
pub use piaffe_optimizer::{
    altered, audit, constraints, cost, cycle, examine, finite, flow, four_legs, instant, optimality, optimize, origin,
    readback, result, search, sensitivity, stability, states, trajectory, verdict, walk,
};
#[cfg(feature = "report")]
pub use piaffe_report as report;
pub use piaffe_sqp as sqp;
#[cfg(feature = "study")]
pub use piaffe_study as study;
pub use piaffe_verify as verify;
pub use piaffe_verify::certificate;
pub use search::local::Task;

/// The programs in the book are run as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
mod book {}

/// Generated dynamics: one module per gait of `model-spec`.
pub mod gaits {
    include!(concat!(env!("OUT_DIR"), "/gaits.rs"));
}

#[cfg(feature = "cli")]
mod paper;

#[cfg(feature = "cli")]
mod specification {
    include!(concat!(env!("OUT_DIR"), "/specification.rs"));
}

/// The gaits of this build, the files that they come from, and what was published of them.
#[cfg(feature = "cli")]
pub const BUILT: cli::Build = cli::Build {
    gaits: gaits::GAITS,
    folder: specification::FOLDER,
    files: specification::FILES,
    published: paper::PUBLISHED,
};
