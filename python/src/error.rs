//! Errors as exceptions, with the program's own words.

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    piaffe,
    Error,
    PyValueError,
    "What piaffe cannot do with what it was given, why, and what to write instead."
);
create_exception!(
    piaffe,
    SpecificationError,
    Error,
    "A robot or gait that is none: every mistake, with its place and a remedy."
);
create_exception!(piaffe, NoOptimum, Error, "A result without a motion was asked for its motion: why it has none.");
