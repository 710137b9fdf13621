//! Failures as Python exceptions: the classes of `mckibben.errors`.

use mckibben_run::failure::{Failure, Reason};
use mckibben_scenario::Style;
use pyo3::PyErr;

mod classes {
    pyo3::import_exception!(mckibben.errors, InputError);
    pyo3::import_exception!(mckibben.errors, OutputError);
    pyo3::import_exception!(mckibben.errors, SimulationError);
}

/// What failed is raised in Python.
pub(crate) trait Raised<T> {
    /// The value, or the exception for why there is none.
    fn raised(self) -> Result<T, PyErr>;
}

impl<T, E: Into<Failure>> Raised<T> for Result<T, E> {
    fn raised(self) -> Result<T, PyErr> {
        self.map_err(|error| exception(&error.into()))
    }
}

/// The exception for a failure.
pub(crate) fn exception(failure: &Failure) -> PyErr {
    let words = failure.render(Style::Plain);
    match failure.reason() {
        Reason::Input => classes::InputError::new_err(words),
        Reason::Stopped => classes::SimulationError::new_err(words),
        Reason::Output => classes::OutputError::new_err(words),
    }
}
