//! The gaits of a robot of one's own.

include!(concat!(env!("OUT_DIR"), "/gaits.rs"));
