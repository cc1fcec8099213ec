//! Arrays of doubles, as bytes in the machine's order: what numpy takes and gives without a copy of its own.

use crate::error::Error;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

const SIZE: usize = size_of::<f64>();

/// The doubles in these bytes.
pub fn doubles(bytes: &[u8]) -> Vec<f64> {
    let (numbers, _) = bytes.as_chunks::<SIZE>();
    numbers.iter().map(|number| f64::from_ne_bytes(*number)).collect()
}

/// The bytes of these doubles.
pub fn bytes<'py>(py: Python<'py>, numbers: &[f64]) -> Bound<'py, PyBytes> {
    PyBytes::new(py, numbers.iter().flat_map(|number| number.to_ne_bytes()).collect::<Vec<u8>>().as_slice())
}

/// Columns of a batch: as many rows in each, or why not.
pub fn rows<const N: usize>(columns: [(&str, &[f64], usize); N]) -> PyResult<usize> {
    let count = |(name, numbers, width): &(&str, &[f64], usize)| match numbers.len() % width {
        0 => Ok(numbers.len() / width),
        _ => Err(Error::new_err(format!("`{name}` has {} numbers, which are no rows of {width}", numbers.len()))),
    };
    let counts = columns.iter().map(count).collect::<PyResult<Vec<_>>>()?;
    match counts.windows(2).all(|pair| pair[0] == pair[1]) {
        true => Ok(counts[0]),
        false => Err(Error::new_err(format!("arrays of different lengths: {counts:?}"))),
    }
}
