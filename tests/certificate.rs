//! The certificate is sound: what it encloses is in there, what it bounds stays above, and what is broken it does not certify.

#[path = "certificate/double.rs"]
mod double;
#[path = "certificate/enclosures.rs"]
mod enclosures;
#[path = "certificate/models.rs"]
mod models;
#[allow(dead_code)] // some of it is for others
#[path = "verify/motions.rs"]
mod motions;
#[path = "certificate/verdicts.rs"]
mod verdicts;
