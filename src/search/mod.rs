//! Finding optima: where to start, and what to do with what is found.

pub mod guess;
