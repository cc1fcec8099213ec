//! Robots that are hard for one reason each: a compass walker, whose swing foot can only just pass; a biped whose knees bend
//! the other way; and one of two centimetres.

include!(concat!(env!("OUT_DIR"), "/gaits.rs"));
