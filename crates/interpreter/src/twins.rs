//! Kernels that compute the same for either leg, under one name.

use super::shapes::base_name;
use super::tape::{Tape, Unrunnable};
use piaffe_codegen::dynamics::Kernel;
use piaffe_codegen::program::Program;
use std::collections::BTreeMap;

/// The tapes of a kernel for leg 1 and 2, or the one that is of neither.
#[derive(Clone, Debug, Default)]
pub struct Twins([Option<Tape>; 2]);

impl Twins {
    /// Of what there is no kernel for there are no numbers: NaN.
    pub fn evaluate(&self, which: usize, inputs: &[&[f64]], out: &mut [f64]) {
        match self.0.get(which).and_then(Option::as_ref) {
            Some(tape) => tape.evaluate(inputs, out),
            None => out.fill(f64::NAN),
        }
    }
}

/// The tapes of all kernels, by their names without the leg's number.
///
/// # Errors
/// If there can be none of a kernel.
pub fn tapes<'p>(
    kernels: &[Kernel],
    programs: impl IntoIterator<Item = &'p Program>,
) -> Result<BTreeMap<String, Twins>, Unrunnable> {
    let mut tapes: BTreeMap<String, Twins> = BTreeMap::new();
    for (kernel, program) in kernels.iter().zip(programs) {
        let (base, leg) = base_name(&kernel.name);
        if let Some(place) = tapes.entry(base.into()).or_default().0.get_mut(leg.unwrap_or(0)) {
            *place = Some(Tape::new(kernel, program)?);
        }
    }
    Ok(tapes)
}
