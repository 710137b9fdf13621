//! `parameters`: the quantities of a scenario file, each with its row of the one table of parameters.

use crate::typed::Sections;
use mckibben::parameter::Parameter;
use mckibben_scenario::keys::{Key, all_keys};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Return the quantities of a scenario as dictionaries by their keys: the arguments of `Parameter` of the package.
#[pyfunction]
pub(crate) fn _parameters(py: Python<'_>) -> PyResult<Sections<'_>> {
    let all = PyDict::new(py);
    for key in all_keys() {
        if let Some(row) = key.parameter() {
            all.set_item(key.path, described(py, key, row)?)?;
        }
    }
    Ok(Sections(all.into_any()))
}

fn described<'py>(py: Python<'py>, key: &Key, row: &Parameter) -> PyResult<Bound<'py, PyDict>> {
    let end = |end: f64| end.is_finite().then_some(end);
    let of = PyDict::new(py);
    of.set_item("meaning", key.meaning)?;
    of.set_item("symbol", row.symbol)?;
    of.set_item("unit", row.unit)?;
    of.set_item("range", row.range.to_string())?;
    of.set_item("minimum", end(row.range.low))?;
    of.set_item("minimum_included", row.range.low_included)?;
    of.set_item("maximum", end(row.range.high))?;
    of.set_item("maximum_included", row.range.high_included)?;
    of.set_item("default", row.default)?;
    of.set_item("source", row.source)?;
    of.set_item("remedy", row.remedy)?;
    of.set_item("example", key.example)?;
    Ok(of)
}
