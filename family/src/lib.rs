//! The gaits of `model-spec` for families of robots: every physical number of a robot is a parameter.
//!
//! ```
//! use piaffe::model::family::Parametric;
//! use piaffe::{motion::Criterion, search::multi_start};
//! use piaffe_family::FAMILIES;
//!
//! # fn main() -> Result<(), piaffe::model::family::Unfit> {
//! let trot = FAMILIES.iter().find(|f| f.description.key == "trot").expect("a trot in model-spec");
//! let heavy = trot.with(&[("links.thigh.mass", 2.0), ("links.shin.length", 0.16)])?;
//! assert_eq!(heavy.parameters()[0], 9.81); // gravity, m/s²
//! // From here on it is a gait like any other.
//! let settings = multi_start::Settings { starts: Some(1), ..Default::default() };
//! let found = multi_start::search(&*heavy, Criterion::Torque, 0.6, &settings, &|_| ());
//! assert_eq!(found.optima.len(), 1);
//! # Ok(())
//! # }
//! ```
//!
//! A crate of its own, so that what is built for one robot does not wait for it.

#![forbid(unsafe_code)]

include!(concat!(env!("OUT_DIR"), "/families.rs"));
