//! What Python is told when a call cannot be answered: an exception for each kind of reason.

use forcefeel_solve::threads::NoThreads;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(forcefeel._core, ArgumentError, PyValueError, "An argument has no meaning; the message names it.");
create_exception!(forcefeel._core, ThreadsError, PyRuntimeError, "The system gives no threads.");

/// An [`ArgumentError`] that says so.
pub fn refused(message: impl Into<String>) -> PyErr {
    ArgumentError::new_err(message.into())
}

/// A [`ThreadsError`], where there are no threads.
pub fn threads<T>(answered: Result<T, NoThreads>) -> PyResult<T> {
    answered.map_err(|none| ThreadsError::new_err(none.to_string()))
}
