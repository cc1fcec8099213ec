//! Members of the family: compiled code of random robots against independent numbers.

#[path = "../draws/mod.rs"]
mod draws;
mod dynamics;
mod interpreter;
mod kernels;
mod sensitivity;
mod unfit;
