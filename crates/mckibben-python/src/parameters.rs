//! `parameters`: the quantities of a scenario file, each with its row of the one table of parameters.

use crate::typed::Sections;
use mckibben::parameter::Parameter;
use mckibben_scenario::keys::{Key, all_keys};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The quantities of a scenario by their keys, in the order of the file: what `mckibben schema` says of them.
///
/// Of each `meaning`, `symbol` (the paper's, or the usual one), `unit` (SI; empty for a pure number), `range` in words,
/// `minimum` and `maximum` (`None` where there is no end) with `minimum_included` and `maximum_included`, `default` in that
/// unit (`None` where it must be given or follows from other keys), the `source` of definition and default, the `remedy` where
/// a value is refused, and an `example` as a file has it. A preset may stand in for a default.
///
/// Those of an antagonist have `antagonist.` before them. In the keys of a file of many actuators `*` stands for a name: what
/// `actuators.flexor.valve.efficiency` takes is said by `valve.efficiency`, and what `supplies.tank.inlet.drop` takes by
/// `supplies.*.inlet.drop`.
#[pyfunction]
pub(crate) fn parameters(py: Python<'_>) -> PyResult<Sections<'_>> {
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
