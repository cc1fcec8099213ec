//! The independent verification against the generated kernels, physical identities and broken motions.

#[path = "verify/derivatives.rs"]
mod derivatives;
#[path = "verify/dynamics.rs"]
mod dynamics;
#[path = "verify/flight.rs"]
mod flight;
#[path = "verify/heights.rs"]
mod heights;
#[path = "verify/motions.rs"]
mod motions;
#[path = "verify/numerics.rs"]
mod numerics;
#[path = "verify/physics.rs"]
mod physics;
#[path = "verify/receipts.rs"]
mod receipts;
