//! What `size` and `design` of the package call: which muscle does something, and which values of keys do it best.

use crate::exceptions::OrException;
use crate::scenario::ScenarioArgument;
use crate::signals::{followed_to_its_end, interruptible};
use crate::typed::{Count, Items, Progress, Quantity, SHARE, Sections, Texts, Value};
use mckibben_run::design::constraint::Constraint;
use mckibben_run::design::outcome::{End, Outcome};
use mckibben_run::design::vary::Vary;
use mckibben_run::design::{Design, Goal, Request};
use mckibben_run::failure::Failure;
use mckibben_run::identify::Monitor;
use mckibben_run::linearize::Measure;
use mckibben_run::quantities;
use mckibben_run::size::{Quickness, Requirement, Sizes, force_of};
use mckibben_scenario::keys::{Key, key_for};
use numpy::PyArray1;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What `mckibben.Sizes` is made of.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct _Sizes(Sizes);

/// A candidate: name and count, its sizes, the least conductance of its valve, and frequency and duty of its pulses.
type Sized = (String, usize, [f64; 8], Option<f64>, Option<(f64, f64)>);

#[pymethods]
impl _Sizes {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "each is given by its name")]
    fn new(
        py: Python<'_>,
        load: Quantity<'_>,
        stroke: Quantity<'_>,
        gauge_pressure: Quantity<'_>,
        braid_angles: Items<Quantity<'_>>,
        effectiveness: Quantity<'_>,
        most_length: Option<Quantity<'_>>,
        most_diameter: Option<Quantity<'_>>,
        time: Option<Quantity<'_>>,
        ripple: Option<Quantity<'_>>,
    ) -> PyResult<Self> {
        let read = |name: &str, of: Quantity<'_>, [what, unit, example]: [&str; 3]| {
            of.read(name, |text| quantities::read(text, what, unit, example), |number| number)
        };
        let length = ["length", "m", "30 mm"];
        let maybe = |name: &str, of: Option<Quantity<'_>>, how| of.map(|of| read(name, of, how)).transpose();
        let angles = braid_angles.0.into_iter().map(|angle| read("braid_angles", angle, ["angle", "rad", "25 deg"]));
        let requirement = Requirement {
            load: load.read("load", |text| Measure::read(text).map(force_of), |force| force)?,
            stroke: read("stroke", stroke, length)?,
            gauge_pressure: read("gauge_pressure", gauge_pressure, ["pressure", "Pa", "4 bar"])?,
            braid_angles: angles.collect::<PyResult<_>>()?,
            effectiveness: effectiveness.si("effectiveness", SHARE)?,
            most_length: maybe("most_length", most_length, length)?,
            most_diameter: maybe("most_diameter", most_diameter, length)?,
            time: maybe("time", time, ["time", "s", "0.3 s"])?,
            ripple: maybe("ripple", ripple, length)?,
        };
        interruptible(py, |check| Sizes::of(requirement, check))?.or_exception_of_arguments().map(Self)
    }

    /// The candidates, those that take the least air first.
    fn candidates(&self) -> Vec<Sized> {
        let of = |its: &mckibben_run::size::Candidate| {
            let ([thread, turns], [length, diameter]) = (its.thread, [its.length, its.diameter]);
            let numbers =
                [length, diameter, thread, turns, its.contraction, its.needed_pressure, its.force_at_rest, its.air];
            let pulses = its.pulses.as_ref().map(|of| (of.frequency, of.duty));
            (its.name.clone(), its.count, numbers, its.quickness.as_ref().and_then(Quickness::conductance), pulses)
        };
        self.0.candidates.iter().map(of).collect()
    }

    /// What does not do it, and why.
    fn left_out(&self) -> Vec<String> {
        self.0.left_out.clone()
    }

    /// The scenario of a candidate as TOML.
    fn scenario(&self, place: usize) -> PyResult<String> {
        self.0.scenario(place).or_exception_of_arguments()
    }

    /// Named valves, each with the time in s in which it does nine tenths of the stroke.
    fn valves(&self, py: Python<'_>, place: usize) -> PyResult<Vec<(&'static str, Option<f64>)>> {
        let found = interruptible(py, |check| self.0.valves(place, check))?.or_exception_of_arguments()?;
        Ok(found.into_iter().map(|valve| (valve.name, valve.time)).collect())
    }

    /// Inner diameters in m of hoses of a length, each with the least conductance of the valve behind it.
    fn hoses(&self, py: Python<'_>, place: usize, length: Quantity<'_>) -> PyResult<Vec<(f64, Option<f64>)>> {
        let read = |text: &str| quantities::read(text, "length", "m", "2 m");
        let length = length.read("length", read, |number| number)?;
        let found = interruptible(py, |check| self.0.hoses(place, length, check))?.or_exception_of_arguments()?;
        Ok(found.into_iter().map(|hose| (hose.diameter, hose.quickness.conductance())).collect())
    }
}

/// A key with the ends of its range: numbers in SI, or text as in "3" and "7 bar".
type Range<'py> = (String, Quantity<'py>, Quantity<'py>);

fn vary_of((key, low, high): Range<'_>) -> PyResult<Vary> {
    let path = key.split_once('[').map_or(key.as_str(), |(list, _)| list);
    let unit = key_for(path).and_then(Key::parameter).map_or("", |row| row.unit);
    let end = |end: Quantity<'_>| match end.given(&format!("vary[{key:?}]"))? {
        Value::Number(number) => Ok(format!("{number:?} {unit}")),
        Value::Text(text) => Ok::<_, PyErr>(text),
    };
    let text = format!("{key}={}..{}", end(low)?.trim_end(), end(high)?.trim_end());
    let vary = text.parse().map_err(|why: String| {
        Failure::input(format!("`vary`: {why}"), "give a pair of numbers in SI, or text such as \"3..7 bar\"")
    });
    vary.or_exception()
}

/// Search values of keys.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the package gives each of them")]
pub(crate) fn _design<'py>(
    py: Python<'py>,
    scenario: ScenarioArgument<'py>,
    vary: Items<Range<'py>>,
    minimize: bool,
    objective: String,
    subject_to: Texts<'_>,
    settle: bool,
    evaluations: Count,
    progress: Option<Progress<'py>>,
) -> PyResult<Sections<'py>> {
    let constraint = |text: String| {
        text.parse::<Constraint>()
            .map_err(|why| Failure::input(format!("`subject_to`: {why}"), "give text such as \"length.final<=80 mm\""))
    };
    let request = Request {
        settings: Vec::new(),
        vary: vary.0.into_iter().map(vary_of).collect::<PyResult<_>>()?,
        goal: if minimize { Goal::Minimize } else { Goal::Maximize },
        objective,
        constraints: subject_to
            .read("subject_to")?
            .into_iter()
            .map(constraint)
            .collect::<Result<_, _>>()
            .or_exception()?,
        settle,
        evaluations: evaluations.0,
    };
    let (monitor, most, progress) =
        (Monitor::default(), request.evaluations, progress.map(|progress| progress.0.unbind()));
    let report = |py: Python<'_>| match &progress {
        Some(progress) => progress.call1(py, (monitor.evaluations(), most)).map(drop),
        None => Ok(()),
    };
    let document = &scenario.0.get().document;
    let work = || Design::of(document, request)?.search(&monitor);
    let outcome = match followed_to_its_end(py, report, || monitor.stop(), work)? {
        // Ctrl-C ends the search with what it has found; where that is nothing, and whatever else was raised, is raised.
        (Some(error), Ok(outcome))
            if error.is_instance_of::<PyKeyboardInterrupt>(py) && outcome.best().is_feasible() =>
        {
            outcome
        }
        (Some(error), _) => return Err(error),
        (None, outcome) => outcome.or_exception_of_arguments()?,
    };
    outcome.verdict().or_exception_of_arguments()?;
    described(py, &outcome)
}

fn described<'py>(py: Python<'py>, outcome: &Outcome) -> PyResult<Sections<'py>> {
    let (all, request) = (PyDict::new(py), outcome.request());
    let end = |place: usize| match outcome.end(place) {
        Some(End::Low) => Some("low"),
        Some(End::High) => Some("high"),
        None => None,
    };
    let values = outcome.values_in_si();
    let value = |(place, value): (usize, &f64)| (request.vary[place].key.clone(), *value, end(place));
    all.set_item("values", values.iter().enumerate().map(value).collect::<Vec<_>>())?;
    all.set_item("objective", (request.objective.as_str(), outcome.objective()))?;
    let constraint =
        |(of, (value, margin, active)): (&Constraint, (f64, f64, bool))| (of.to_string(), value, margin, active);
    let constraints = request.constraints.iter().zip(outcome.margins()).map(constraint);
    all.set_item("constraints", constraints.collect::<Vec<_>>())?;
    all.set_item("scenario", outcome.found().to_toml())?;
    all.set_item("converged", outcome.is_converged())?;
    all.set_item("interrupted", outcome.is_interrupted())?;
    all.set_item("warnings", outcome.warnings().iter().map(ToString::to_string).collect::<Vec<_>>())?;
    // Every run: its values, its numbers, and whether it met the constraints.
    let points = PyDict::new(py);
    let column = |name: String, values: Vec<f64>| points.set_item(name, PyArray1::from_vec(py, values));
    for (place, vary) in request.vary.iter().enumerate() {
        column(vary.key.clone(), outcome.points().iter().map(|point| vary.in_si(point.values[place])).collect())?;
    }
    let numbers = std::iter::once(&request.objective).chain(request.constraints.iter().map(|of| &of.name));
    for (place, name) in numbers.enumerate() {
        let of = |point: &mckibben_run::design::outcome::Reached| {
            point.numbers.as_ref().map_or(f64::NAN, |numbers| numbers[place])
        };
        column(name.clone(), outcome.points().iter().map(of).collect())?;
    }
    let feasible = outcome.points().iter().map(|point| point.is_feasible()).collect();
    points.set_item("feasible", PyArray1::from_vec(py, feasible))?;
    all.set_item("points", points)?;
    Ok(Sections(all.into_any()))
}
