//! Kernels that compute the same for either leg or in several modes, under one name.

use super::tape::{Tape, Unrunnable};
use piaffe_codegen::dynamics::Kernel;
use piaffe_codegen::mechanism;
use piaffe_codegen::program::Program;
use piaffe_model::Mode;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The tapes of a kernel for leg 1 and 2 or stance on these, and for flight; or the one that is of none, as the first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Twins([Option<Tape>; 3]);

/// Which of the tapes is that of a leg or a mode.
pub trait Which {
    fn which(self) -> usize;
}

impl Which for usize {
    fn which(self) -> usize {
        self
    }
}

impl Which for Mode {
    fn which(self) -> usize {
        match self {
            Mode::Stance(leg) => leg,
            Mode::Flight => 2,
        }
    }
}

impl Twins {
    /// With these numbers for their first inputs.
    pub fn with(&self, first: &[f64]) -> Twins {
        Twins(self.0.each_ref().map(|tape| tape.as_ref().map(|tape| tape.with(first))))
    }

    /// Of what there is no kernel for there are no numbers: NaN.
    pub fn evaluate(&self, which: usize, inputs: &[&[f64]], out: &mut [f64]) {
        match self.0.get(which).and_then(Option::as_ref) {
            Some(tape) => tape.evaluate(inputs, out),
            None => out.fill(f64::NAN),
        }
    }
}

/// The tapes of all kernels, by what they compute, whichever leg or mode they are of.
#[derive(Serialize, Deserialize)]
pub struct Tapes(BTreeMap<String, Twins>);

impl Tapes {
    /// Those of a kernel that every gait has.
    ///
    /// # Panics
    /// If it was not derived: its name is not that of the derivation.
    pub fn take(&mut self, kernel: &str) -> Twins {
        self.0.remove(kernel).unwrap_or_else(|| panic!("no kernel `{kernel}` is derived"))
    }

    /// Those of a kernel that a gait may do without.
    pub fn take_any(&mut self, kernel: &str) -> Twins {
        self.0.remove(kernel).unwrap_or_default()
    }

    /// After all have been taken.
    ///
    /// # Panics
    /// If one is left: nobody knows its name.
    pub fn end(self) {
        assert!(self.0.is_empty(), "nobody evaluates the kernels {:?}", self.0.into_keys());
    }
}

/// The tapes of all kernels.
///
/// # Errors
/// If there can be none of a kernel.
pub fn tapes<'p>(kernels: &[Kernel], programs: impl IntoIterator<Item = &'p Program>) -> Result<Tapes, Unrunnable> {
    let mut tapes: BTreeMap<String, Twins> = BTreeMap::new();
    for (kernel, program) in kernels.iter().zip(programs) {
        let which = match kernel.mode() {
            Some(mechanism::Mode::Flight) => Mode::Flight.which(),
            _ => kernel.leg().unwrap_or_default(),
        };
        if let Some(place) = tapes.entry(kernel.what.clone()).or_default().0.get_mut(which) {
            *place = Some(Tape::new(kernel, program)?);
        }
    }
    Ok(Tapes(tapes))
}
