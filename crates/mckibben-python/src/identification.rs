//! What `identify` of the package calls: a study file, or a study from memory, to what was found.

use crate::exceptions::OrException;
use crate::scenario::Scenario;
use crate::signals::followed_to_its_end;
use crate::typed::{Items, Name, Object, Progress, Sections, Sequence, Values};
use crate::values;
use mckibben_identify::least_squares::{Estimate, Monitor};
use mckibben_identify::study::Table;
use mckibben_identify::trajectories::StepInfo;
use mckibben_plot::Theme;
use mckibben_run::failure::Failure;
use mckibben_run::identify::{OtherMinimum, Outcome, Prediction, Request, StepResponse, WARNED, identified};
use mckibben_run::report::Plate;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};

/// Estimate parameters from a study file.
#[pyfunction]
#[pyo3(signature = (study, output, progress))]
pub(crate) fn _identify_file<'py>(
    py: Python<'py>,
    study: PathBuf,
    output: Option<PathBuf>,
    progress: Option<Progress<'py>>,
) -> PyResult<Sections<'py>> {
    found(py, || Request::load(&study), output, progress)
}

/// Estimate parameters from a study in memory: its sections as in a file, and its tables by their names.
#[pyfunction]
#[pyo3(signature = (sections, tables, scenario, output, progress))]
pub(crate) fn _identify<'py>(
    py: Python<'py>,
    sections: Values<'py>,
    tables: Items<(String, Items<(Name, Sequence)>)>,
    scenario: &Bound<'py, Scenario>,
    output: Option<PathBuf>,
    progress: Option<Progress<'py>>,
) -> PyResult<Sections<'py>> {
    let text = values::pairs_of(&sections.0)?.into_iter().collect::<toml::Table>().to_string();
    let table = |(name, columns): (String, Items<(Name, Sequence)>)| {
        let columns = columns.0.into_iter().map(|(Name(name), Sequence(values))| (name, values)).collect();
        Table::new(&name, columns).map_err(|error| Failure::input(error.what, error.remedy))
    };
    let tables = tables.0.into_iter().map(table).collect::<Result<Vec<_>, _>>().or_exception()?;
    let document = scenario.get().document.clone();
    found(py, || Request::in_memory(&text, tables, document), output, progress)
}

/// What a request comes to, as a dictionary of what the classes of the package are made of.
fn found<'py>(
    py: Python<'py>,
    request: impl FnOnce() -> Result<Request, Failure> + Send,
    output: Option<PathBuf>,
    progress: Option<Progress<'py>>,
) -> PyResult<Sections<'py>> {
    let (monitor, folder, progress) =
        (Monitor::default(), output.as_deref(), progress.map(|progress| progress.0.unbind()));
    let report = |py: Python<'_>| match &progress {
        Some(progress) => progress.call1(py, (monitor.evaluations(), py.None())).map(drop),
        None => Ok(()),
    };
    let work = || fitted(request()?.followed_by(monitor.clone()), folder);
    match followed_to_its_end(py, report, || monitor.stop(), work)? {
        // Ctrl-C ends the search with what it has found; where that is nothing, and whatever else was raised, is raised.
        (Some(error), Ok(outcome))
            if error.is_instance_of::<PyKeyboardInterrupt>(py) && !outcome.estimates.is_empty() =>
        {
            described(py, &outcome)
        }
        (Some(error), _) => Err(error),
        (None, outcome) => described(py, &outcome.or_exception()?),
    }
}

/// What was found of some runs is worth having; the warnings say what failed of the others.
fn fitted(request: Request, folder: Option<&Path>) -> Result<Outcome, Failure> {
    let outcome = identified(request, folder)?;
    outcome.check_finite()?;
    let page = folder.map(|folder| outcome.write(folder)).transpose()?;
    if outcome.estimates.is_empty() {
        outcome.verdict(page.as_deref())?;
    }
    Ok(outcome)
}

fn described<'py>(py: Python<'py>, outcome: &Outcome) -> PyResult<Sections<'py>> {
    let all = PyDict::new(py);
    let estimate = |of: &Estimate| {
        let interval = of.confidence_interval.map(|[low, high]| (low, high));
        (of.name.clone(), of.unit, of.value, of.standard_error, interval, of.on_bound)
    };
    all.set_item("estimates", outcome.estimates.iter().map(estimate).collect::<Vec<_>>())?;
    let correlations = match outcome.correlations.is_empty() {
        true => None,
        false => Some(PyArray2::from_vec2(py, &outcome.correlations)?),
    };
    all.set_item("correlations", correlations)?;
    let minimum = |of: &OtherMinimum| (of.values.clone(), of.error_ratio, of.searches, of.is_minimum);
    all.set_item("other_minima", outcome.other_minima.iter().map(minimum).collect::<Vec<_>>())?;
    let response =
        |of: &StepInfo, error: Option<f64>| (of.stroke, of.overshoot, of.first_peak, of.frequency, of.settling, error);
    let step = |of: &StepResponse| {
        let [predicted, held_out] =
            [0, 1].map(|place| of.predicted[place].as_ref().map(|(of, error)| response(of, Some(*error))));
        (of.run.clone(), of.quantity.clone(), of.unit, response(&of.measured, None), predicted, held_out)
    };
    all.set_item("step_responses", outcome.step_responses.iter().map(step).collect::<Vec<_>>())?;
    all.set_item("interrupted", outcome.interrupted)?;
    let predictions = outcome.predictions.iter().map(|of| predicted(py, of));
    all.set_item("predictions", predictions.collect::<PyResult<Vec<_>>>()?)?;
    all.set_item("notes", &outcome.introduction)?;
    let without_mark = |words: &String| words.strip_prefix(WARNED).unwrap_or(words).to_owned();
    let grave = outcome.warnings.iter().filter(|words| words.starts_with(WARNED)).map(without_mark);
    all.set_item("warnings", grave.collect::<Vec<_>>())?;
    let remarks = outcome.warnings.iter().filter(|words| !words.starts_with(WARNED));
    all.set_item("remarks", remarks.collect::<Vec<_>>())?;
    all.set_item("scenarios", &outcome.scenarios)?;
    let figure = |plate: &Plate| Ok::<_, Failure>((plate.stem, plate.figure.to_svg(Theme::Light)?));
    let figures = py.detach(|| outcome.plates().map(figure).collect::<Result<Vec<_>, _>>());
    all.set_item("figures", figures.or_exception()?)?;
    Ok(Sections(all.into_any()))
}

fn predicted<'py>(py: Python<'py>, of: &Prediction) -> PyResult<Object<'py>> {
    let (all, coordinates) = (PyDict::new(py), PyDict::new(py));
    let array = |values: &[f64]| PyArray1::from_slice(py, values);
    of.coordinates.iter().try_for_each(|(name, values)| coordinates.set_item(name, array(values)))?;
    all.set_item("run", &of.run)?;
    all.set_item("quantity", &of.quantity)?;
    all.set_item("unit", of.unit)?;
    all.set_item("coordinates", coordinates)?;
    all.set_item("measured", array(&of.measured))?;
    all.set_item("predicted", array(&of.predicted))?;
    Ok(Object(all.into_any()))
}
