//! Objects that one thread at a time works on: another is refused with what it can do.

use crate::exceptions::exception;
use mckibben_run::failure::Failure;
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::pyclass::boolean_struct::False;

/// An object to be changed, unless another thread works on it; `class` is the name of its class.
pub(crate) fn to_change<'py, T: PyClass<Frozen = False>>(
    this: &Bound<'py, T>,
    class: &str,
) -> PyResult<PyRefMut<'py, T>> {
    this.try_borrow_mut().map_err(|_| busy(class))
}

/// An object to be read, unless another thread changes it.
pub(crate) fn to_read<'py, T: PyClass>(this: &Bound<'py, T>, class: &str) -> PyResult<PyRef<'py, T>> {
    this.try_borrow().map_err(|_| busy(class))
}

/// Refuses an object of a class that another thread works on.
pub(crate) fn busy(class: &str) -> PyErr {
    let (one, remedy) = match class.strip_suffix('s') {
        Some(_) => ("these", format!("give each thread separate {class}, or wait for the other")),
        None => ("this", format!("give each thread a separate {class}, or wait for the other")),
    };
    let are = if one == "these" { "are" } else { "is" };
    exception(&Failure::input(format!("{one} {class} {are} being stepped by another thread"), remedy))
}
