//! Columns of numbers and words as NumPy arrays.

use mckibben_run::record::{Filled, Values};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

/// The column as an array that cannot be written to. Numbers are handed over, not copied.
pub(crate) fn array<'py>(py: Python<'py>, values: Values) -> PyResult<Bound<'py, PyAny>> {
    match values {
        Values::Numbers(numbers) => {
            let array = PyArray1::from_vec(py, numbers);
            Ok(array.readwrite().make_nonwriteable().as_any().clone())
        }
        Values::Words(words) => {
            let words: Vec<Bound<'_, PyString>> = words.into_iter().map(|word| PyString::intern(py, word)).collect();
            // An empty list would be of numbers.
            let kwargs = PyDict::new(py);
            kwargs.set_item(intern!(py, "dtype"), intern!(py, "str"))?;
            let array = py.import(intern!(py, "numpy"))?.call_method(intern!(py, "array"), (words,), Some(&kwargs))?;
            array.call_method1(intern!(py, "setflags"), (false,))?;
            Ok(array)
        }
    }
}

/// The columns as a dictionary of arrays by their names, in order.
pub(crate) fn dictionary<'py>(py: Python<'py>, columns: Vec<Filled>) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for column in columns {
        dictionary.set_item(&column.name, array(py, column.values)?)?;
    }
    Ok(dictionary)
}
