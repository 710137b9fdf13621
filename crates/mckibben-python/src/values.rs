//! Values of Python as TOML, and back.

use crate::exceptions::exception;
use crate::typed::{kind, shortened};
use mckibben_run::failure::Failure;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString};

/// Levels of dictionaries and lists within each other, at most: no scenario has more than five, and each takes room on the stack.
const DEEPEST: usize = 64;
/// Values in all, at most.
const MOST: usize = 2_000_000;

/// A walk through values within each other.
#[derive(Default)]
struct Walk<'py> {
    /// What the value lies in, from the outermost, each with its path.
    above: Vec<(String, Bound<'py, PyAny>)>,
    /// Values so far.
    count: usize,
}

impl<'py> Walk<'py> {
    /// Does something within a value that has others in it.
    fn within<T>(
        &mut self,
        path: &str,
        value: &Bound<'py, PyAny>,
        work: impl FnOnce(&mut Self) -> PyResult<T>,
    ) -> PyResult<T> {
        if let Some((outer, _)) = self.above.iter().find(|(_, above)| above.is(value)) {
            let outer = if outer.is_empty() { "the whole dictionary".to_owned() } else { format!("`{outer}`") };
            let title = format!("`{path}` is {outer} again: it contains itself");
            return Err(exception(&Failure::input(title, "give a dictionary whose values end in text and numbers")));
        }
        if self.above.len() > DEEPEST {
            let title = format!("`{}` lies deeper than {DEEPEST} levels", beginning(path));
            return Err(exception(&Failure::input(
                title,
                "give sections of keys; no scenario has more than five levels",
            )));
        }
        self.above.push((path.to_owned(), value.clone()));
        let done = work(self);
        self.above.pop();
        done
    }

    /// The TOML value of a Python value; `path` names it in messages.
    fn value(&mut self, path: &str, value: &Bound<'py, PyAny>) -> PyResult<toml::Value> {
        self.count += 1;
        if self.count > MOST {
            let title = format!("there are more than {MOST} values up to `{}`", beginning(path));
            return Err(exception(&Failure::input(title, "give fewer; a long table of a motion has thousands")));
        }
        if let Ok(text) = value.cast::<PyString>() {
            return Ok(toml::Value::String(text.to_string()));
        }
        if let Ok(truth) = value.cast::<PyBool>() {
            return Ok(toml::Value::Boolean(truth.is_true()));
        }
        if let Ok(table) = value.cast::<PyMapping>() {
            return Ok(toml::Value::Table(self.pairs(path, table)?.into_iter().collect()));
        }
        // Arrays have all that numbers have, so they come first.
        if let Ok(items) = value.try_iter() {
            return self.within(path, value, |walk| {
                let items = items.enumerate().map(|(index, item)| walk.value(&format!("{path}[{index}]"), &item?));
                items.collect::<PyResult<Vec<_>>>().map(toml::Value::Array)
            });
        }
        // The floats of NumPy have __float__ and its whole numbers __index__, as Python's have.
        if value.is_instance_of::<PyInt>() || (!value.is_instance_of::<PyFloat>() && value.hasattr("__index__")?) {
            return match value.extract::<i64>() {
                Ok(whole) => Ok(toml::Value::Integer(whole)),
                Err(_) => value.extract().map(toml::Value::Float).map_err(|_| {
                    let title = format!("`{path}` = {} is larger than any number", shortened(&value.to_string()));
                    exception(&Failure::input(title, "give a number in SI below 1.8e308, or text with a unit"))
                }),
            };
        }
        value.extract().map(toml::Value::Float).map_err(|_| {
            PyTypeError::new_err(format!(
                "`{path}` is of type {}, which no scenario has; give text such as \"60 psi\", a number, a list or a dict",
                kind(value)
            ))
        })
    }

    fn pairs(&mut self, path: &str, mapping: &Bound<'py, PyMapping>) -> PyResult<Vec<(String, toml::Value)>> {
        self.within(path, mapping.as_any(), |walk| {
            let mut pairs = Vec::new();
            for pair in mapping.items()?.try_iter()? {
                let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = pair?.extract()?;
                let Ok(name) = key.cast::<PyString>() else {
                    return Err(PyTypeError::new_err(format!("a key of `{path}` is no text: {key}")));
                };
                let name = name.to_string();
                let inner = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                pairs.push((name, walk.value(&inner, &value)?));
            }
            Ok(pairs)
        })
    }
}

/// As much of a path as a message has room for.
fn beginning(path: &str) -> &str {
    path.char_indices().nth(60).map_or(path, |(end, _)| &path[..end])
}

/// The keys of a mapping with their TOML values, in its order.
pub(crate) fn pairs_of(mapping: &Bound<'_, PyMapping>) -> PyResult<Vec<(String, toml::Value)>> {
    Walk::default().pairs("", mapping)
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
