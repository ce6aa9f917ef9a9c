//! Errors as Python sees them: one that the input was refused, one that something failed
//! on the way, as the command line's exit codes 2 and 1.

use std::fmt::Display;

use pyo3::{PyErr, create_exception, exceptions::PyException};

create_exception!(
    ferntast,
    FerntastError,
    PyException,
    "What the command line would print as its error."
);
create_exception!(
    ferntast,
    RefusedError,
    FerntastError,
    "The input was refused, and nothing was done."
);
create_exception!(
    ferntast,
    FailedError,
    FerntastError,
    "Something failed on the way."
);

/// The input was refused.
pub fn refused(error: impl Display) -> PyErr {
    RefusedError::new_err(error.to_string())
}

/// Something failed on the way.
pub fn failed(error: impl Display) -> PyErr {
    FailedError::new_err(error.to_string())
}
