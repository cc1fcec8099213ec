//! What the Python package `piaffe` is made of below: robots, gaits, searches and what is said of results. Numbers cross as bytes
//! (little batches of doubles), results as their JSON; everything that a person sees is in `python/piaffe`.

mod bytes;
mod dynamics;
mod error;
mod optimize;
mod result;
mod robot;
mod robots;
mod study;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _piaffe {
    #[pymodule_export]
    use super::dynamics::Kernels;
    #[pymodule_export]
    use super::error::{Error, NoOptimum, SpecificationError};
    #[pymodule_export]
    use super::optimize::optimize;
    #[pymodule_export]
    use super::result::{csv, mjcf, normal, npz, page, verify};
    #[pymodule_export]
    use super::robot::{Gait, Robot};
    #[pymodule_export]
    use super::robots::built_in;
    #[pymodule_export]
    use super::run;
    #[pymodule_export]
    use super::study::{Question, answers};
    #[pymodule_export]
    use super::work::Stop;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        piaffe::interpreter::Store::of_user().choose();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// The command line: what was typed, the program's name first. The exit code.
#[pyfunction]
fn run(py: Python<'_>, typed: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| piaffe::cli::run_with(piaffe::BUILT, &typed))
}
