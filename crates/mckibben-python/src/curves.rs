//! `curves`, and the named actuators and valves.

use crate::arguments;
use crate::exceptions::OrException;
use crate::scenario::ScenarioArgument;
use crate::typed::{GaugePressures, Numbered, Sections};
use mckibben_run::curves::{Curves, Pressures};
use mckibben_run::failure::Failure;
use mckibben_scenario::presets::{ACTUATORS, Preset, VALVES};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Return force, stiffness and volume of a scenario's actuator over length, at rest.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     One actuator.
/// gauge_pressures : array_like or str, optional
///     Gauge pressures in Pa, or text such as "35, 45, 55 psi"; those of the paper's Fig. 3 by default.
///
/// Returns
/// -------
/// dict of str to numpy.ndarray
///     Arrays by their names, which end with their units: a row for each pressure, a column for each length, from the shortest
///     to the longest. `stiffness_n_m` is equation (7), `sealed_stiffness_n_m` equation (5).
#[pyfunction]
#[pyo3(signature = (scenario, gauge_pressures = None))]
pub(crate) fn _curves<'py>(
    py: Python<'py>,
    scenario: ScenarioArgument<'py>,
    gauge_pressures: Option<GaugePressures<'py>>,
) -> PyResult<Numbered<'py>> {
    let document = &scenario.0.get().document;
    let text = |text: &str| {
        text.parse().map_err(|why: String| {
            let remedy = "give text such as \"35, 45, 55 psi\", or numbers in Pa";
            Failure::input(format!("`gauge_pressures`: {why}"), remedy)
        })
    };
    let pressures: Option<Pressures> = match gauge_pressures {
        None => None,
        Some(GaugePressures::Text(list)) => Some(text(&list).or_exception()?),
        Some(GaugePressures::Numbers(numbers)) => {
            let numbers = numbers.read("gauge_pressures")?;
            arguments::finite("gauge_pressures", &numbers).or_exception()?;
            Some(Pressures::of_pascals(&numbers))
        }
    };
    let (table, count) = py
        .detach(|| {
            let curves = Curves::of(document, pressures.as_ref())?;
            Ok::<_, Failure>((curves.data()?, curves.pressures().len()))
        })
        .or_exception()?;
    let arrays = PyDict::new(py);
    for (place, column) in table.columns.iter().enumerate() {
        let values = table.rows.iter().map(|row| row[place]).collect();
        let array = PyArray1::from_vec(py, values).reshape([count, table.rows.len() / count.max(1)])?;
        arrays.set_item(&column.name, array)?;
    }
    Ok(Numbered(arrays.into_any()))
}

/// Return the named actuators and valves as dictionaries: the arguments of `Preset` and `PresetValue` of the package.
#[pyfunction]
pub(crate) fn _presets(py: Python<'_>) -> PyResult<Sections<'_>> {
    let all = PyDict::new(py);
    for (section, presets) in [("actuator", ACTUATORS), ("valve", VALVES)] {
        for preset in presets {
            all.set_item(preset.name, described(py, section, preset)?)?;
        }
    }
    Ok(Sections(all.into_any()))
}

fn described<'py>(py: Python<'py>, section: &str, preset: &Preset) -> PyResult<Bound<'py, PyDict>> {
    let (described, values) = (PyDict::new(py), PyDict::new(py));
    for (path, word) in preset.words {
        let of = PyDict::new(py);
        of.set_item("value", word)?;
        values.set_item(path, of)?;
    }
    for number in preset.values {
        let of = PyDict::new(py);
        match number.list() {
            Some(list) => of.set_item("value", list)?,
            None => of.set_item("value", number.value())?,
        }
        of.set_item("unit", number.parameter.unit)?;
        of.set_item("symbol", number.parameter.symbol)?;
        of.set_item("meaning", number.parameter.meaning)?;
        of.set_item("text", number.text)?;
        of.set_item("source", number.source)?;
        of.set_item("assumed", number.assumed)?;
        values.set_item(number.parameter.key, of)?;
    }
    described.set_item("section", section)?;
    described.set_item("meaning", preset.meaning)?;
    described.set_item("values", values)?;
    Ok(described)
}
