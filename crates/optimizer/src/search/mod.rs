//! Finding optima: where to start, how to descend, and what to keep.

pub mod atlas;
pub mod branch;
pub mod crossover;
pub mod evidence;
pub mod fastest;
mod feasible;
pub mod guess;
pub mod journal;
pub mod local;
pub mod multi_start;
mod nearest;
pub mod refine;
pub mod relative;
pub mod watch;
