//! What the Python package `ferntast` calls: the same code as the command line, whose
//! JSON the results are. Data come in as files; the package writes arrays to such.

mod error;
mod interrupt;
mod lab;
mod virtual_time;

use pyo3::prelude::*;

/// Compiled part of the package `ferntast`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::error::{FailedError, FerntastError, RefusedError};
    #[pymodule_export]
    use super::lab::{add, auto, challenge, compare, diagnose, discover, effects, export, new};
    #[pymodule_export]
    use super::virtual_time::{lockstep, sweep};
}
