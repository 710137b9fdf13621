//! Functions of the package that are written in Python.

use pyo3::call::PyCallArgs;
use pyo3::prelude::*;

/// Calls a function of a module of the package, such as `plot` of `_beside`.
pub(crate) fn call<'py>(
    py: Python<'py>,
    (module, function): (&str, &str),
    arguments: impl PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import(format!("mckibben.{module}"))?.call_method1(function, arguments)
}
