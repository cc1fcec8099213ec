//! The dynamics of a gait where there is no operating system.

#![no_std]
#![forbid(unsafe_code)]

include!(concat!(env!("OUT_DIR"), "/gaits.rs"));
