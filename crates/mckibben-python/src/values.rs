//! Values of Python as TOML, and back.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString};

/// The TOML value of a Python value; `path` names it in messages.
pub(crate) fn to_toml(path: &str, value: &Bound<'_, PyAny>) -> PyResult<toml::Value> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(toml::Value::String(text.to_string()));
    }
    if let Ok(truth) = value.cast::<PyBool>() {
        return Ok(toml::Value::Boolean(truth.is_true()));
    }
    if let Ok(table) = value.cast::<PyMapping>() {
        return table_of(path, table).map(toml::Value::Table);
    }
    // Arrays have all that numbers have, so they come first.
    if let Ok(items) = value.try_iter() {
        let items = items.enumerate().map(|(index, item)| to_toml(&format!("{path}[{index}]"), &item?));
        return items.collect::<PyResult<Vec<_>>>().map(toml::Value::Array);
    }
    // The floats of NumPy have __float__ and its whole numbers __index__, as Python's have.
    if value.is_instance_of::<PyInt>() || (!value.is_instance_of::<PyFloat>() && value.hasattr("__index__")?) {
        return match value.extract::<i64>() {
            Ok(whole) => Ok(toml::Value::Integer(whole)),
            Err(_) => value.extract().map(toml::Value::Float),
        };
    }
    value.extract().map(toml::Value::Float).map_err(|_| {
        let name = value.get_type().name().map_or_else(|_| "object".to_owned(), |name| name.to_string());
        PyTypeError::new_err(format!(
            "`{path}` is of type {name}, which no scenario has; give text such as \"60 psi\", a number, a list or a dict"
        ))
    })
}

/// The TOML table of a mapping.
pub(crate) fn table_of(path: &str, mapping: &Bound<'_, PyMapping>) -> PyResult<toml::Table> {
    Ok(pairs_of(path, mapping)?.into_iter().collect())
}

/// The keys of a mapping with their TOML values, in its order.
pub(crate) fn pairs_of(path: &str, mapping: &Bound<'_, PyMapping>) -> PyResult<Vec<(String, toml::Value)>> {
    let mut pairs = Vec::new();
    for pair in mapping.items()?.try_iter()? {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = pair?.extract()?;
        let Ok(name) = key.cast::<PyString>() else {
            return Err(PyTypeError::new_err(format!("a key of `{path}` is no text: {key}")));
        };
        let name = name.to_string();
        let inner = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        pairs.push((name, to_toml(&inner, &value)?));
    }
    Ok(pairs)
}

/// The Python value of a TOML value.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &toml::Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        toml::Value::String(text) => PyString::new(py, text).into_any(),
        toml::Value::Integer(whole) => whole.into_pyobject(py)?.into_any(),
        toml::Value::Float(number) => PyFloat::new(py, *number).into_any(),
        toml::Value::Boolean(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        toml::Value::Datetime(date) => PyString::new(py, &date.to_string()).into_any(),
        toml::Value::Array(items) => {
            let list = PyList::empty(py);
            items.iter().try_for_each(|item| list.append(to_python(py, item)?))?;
            list.into_any()
        }
        toml::Value::Table(table) => dict_of(py, table)?.into_any(),
    })
}

/// The dictionary of a TOML table.
pub(crate) fn dict_of<'py>(py: Python<'py>, table: &toml::Table) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    table.iter().try_for_each(|(key, value)| dict.set_item(key, to_python(py, value)?))?;
    Ok(dict)
}
