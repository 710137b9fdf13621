//! `identify`, and the classes `Identification` and `Estimate`.

use crate::pool;
use crate::raised::Raised;
use crate::scenario::Scenario;
use crate::typed::{Items, Listed};
use mckibben_run::failure::Failure;
use mckibben_run::identify::{WARNED, identified};
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// From measured data to numbers, with how sure they are: what `mckibben identify` does with a study file.
///
/// With `output`, a folder, the report, the scenarios and the numbers are written there as well. Where some runs of several
/// fail, `warnings` say which and why.
///
/// Raises `InputError` where the study, its data or its scenario is wrong, and `SimulationError` where no fit was found; the report
/// is written then too.
#[pyfunction]
#[pyo3(signature = (study, output = None))]
pub(crate) fn identify(py: Python<'_>, study: PathBuf, output: Option<PathBuf>) -> PyResult<Identification> {
    let found = py
        .detach(|| {
            let found = pool::shared(|| identified(&study, output.as_deref()))??;
            found.check_finite()?;
            let page = output.as_ref().map(|folder| found.write(folder)).transpose()?;
            // What was found of other runs is worth having; the warnings say what failed.
            if found.estimates.is_empty() {
                found.verdict(page.as_deref())?;
            }
            Ok::<_, Failure>(found)
        })
        .raised()?;
    let estimate = |of: &mckibben_identify::least_squares::Estimate| Estimate {
        name: of.name.clone(),
        unit: of.unit.to_owned(),
        value: of.value,
        standard_error: of.standard_error,
        confidence_interval: of.confidence_interval.map(|[low, high]| (low, high)),
        on_bound: of.on_bound,
    };
    let without_mark = |words: &String| words.strip_prefix(WARNED).unwrap_or(words).to_owned();
    Ok(Identification {
        estimates: found.estimates.iter().map(estimate).collect(),
        notes: found.introduction.clone(),
        warnings: found.warnings.iter().map(without_mark).collect(),
        scenarios: found.scenarios,
    })
}

/// What was found in measured data.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Identification {
    estimates: Vec<Estimate>,
    notes: Vec<String>,
    warnings: Vec<String>,
    /// Names and texts.
    scenarios: Vec<(String, String)>,
}

/// A number that was found.
#[pyclass(frozen, from_py_object, module = "mckibben")]
#[derive(Clone, PartialEq)]
pub(crate) struct Estimate {
    name: String,
    unit: String,
    value: f64,
    standard_error: Option<f64>,
    confidence_interval: Option<(f64, f64)>,
    on_bound: bool,
}

#[pymethods]
impl Identification {
    #[new]
    fn new(
        estimates: Items<Estimate>,
        notes: Items<String>,
        warnings: Items<String>,
        scenarios: Items<(String, String)>,
    ) -> Self {
        Self { estimates: estimates.0, notes: notes.0, warnings: warnings.0, scenarios: scenarios.0 }
    }

    /// The numbers with their intervals; of ring-downs those of the waveform, or of all turns where there is none.
    #[getter]
    fn estimates(&self) -> Vec<Estimate> {
        self.estimates.clone()
    }

    /// The names of the estimates: `dict(found)` has the estimates by their names.
    fn keys(&self) -> Vec<&str> {
        self.estimates.iter().map(|estimate| estimate.name.as_str()).collect()
    }

    /// The names of the estimates in their order.
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Listed<'py>> {
        Ok(Listed(PyList::new(py, self.keys())?.try_iter()?.into_any()))
    }

    /// The number of this name, such as "actuator.friction.viscous".
    fn __getitem__(&self, name: &str) -> PyResult<Estimate> {
        let known = || self.estimates.iter().map(|estimate| estimate.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = self.estimates.iter().find(|estimate| estimate.name == name).cloned();
        found.ok_or_else(|| pyo3::exceptions::PyKeyError::new_err(format!("there is no `{name}` but {}", known())))
    }

    /// What was done, in a few sentences.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// What to know before believing the numbers.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The scenarios with the numbers that were found, by the names of their files.
    #[getter]
    fn scenarios(&self) -> PyResult<BTreeMap<String, Scenario>> {
        let read = |(name, text): &(String, String)| Ok((name.clone(), Scenario::new(text, name, Items(Vec::new()))?));
        self.scenarios.iter().map(read).collect()
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.estimates.iter().map(|estimate| estimate.name.as_str()).collect();
        format!("<mckibben.Identification of {}>", names.join(", "))
    }

    #[expect(clippy::type_complexity, reason = "the arguments of the constructor")]
    fn __getnewargs__(&self) -> (Vec<Estimate>, Vec<String>, Vec<String>, Vec<(String, String)>) {
        (self.estimates.clone(), self.notes.clone(), self.warnings.clone(), self.scenarios.clone())
    }
}

/// What an estimate is made of, for pickling.
type Made<'a> = (&'a str, &'a str, f64, Option<f64>, Option<(f64, f64)>, bool);

#[pymethods]
impl Estimate {
    #[new]
    fn new(
        name: String,
        unit: String,
        value: f64,
        standard_error: Option<f64>,
        confidence_interval: Option<(f64, f64)>,
        on_bound: bool,
    ) -> Self {
        Self { name, unit, value, standard_error, confidence_interval, on_bound }
    }

    /// The path of its key in a scenario, with the run behind it where each run has its own.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The unit of its values, in SI; empty for a pure number.
    #[getter]
    fn unit(&self) -> &str {
        &self.unit
    }

    /// The value that fits best.
    #[getter]
    fn value(&self) -> f64 {
        self.value
    }

    /// Its standard error; `None` where the data do not identify it or it rests on a bound.
    #[getter]
    fn standard_error(&self) -> Option<f64> {
        self.standard_error
    }

    /// Its 95 % confidence interval, likewise.
    #[getter]
    fn confidence_interval(&self) -> Option<(f64, f64)> {
        self.confidence_interval
    }

    /// Whether it rests on one of its bounds.
    #[getter]
    fn on_bound(&self) -> bool {
        self.on_bound
    }

    /// Whether both are the same.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get() == self)
    }

    fn __repr__(&self) -> String {
        let confidence_interval =
            self.confidence_interval.map(|(low, high)| format!(", {low:?} to {high:?}")).unwrap_or_default();
        format!("<mckibben.Estimate {} = {:?} {}{confidence_interval}>", self.name, self.value, self.unit)
    }

    fn __getnewargs__(&self) -> Made<'_> {
        (&self.name, &self.unit, self.value, self.standard_error, self.confidence_interval, self.on_bound)
    }
}
