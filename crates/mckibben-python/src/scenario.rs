//! The class `Scenario`.

use crate::exceptions::OrException;
use crate::python;
use crate::signals::Watch;
use crate::typed::{Items, Object, Sections, Settled, Values, kind};
use crate::values;
use mckibben_run::failure::Failure;
use mckibben_run::run::Ready;
use mckibben_run::settle::Settling;
use mckibben_scenario::{Diagnostics, Document, keys};
use pyo3::exceptions::PyTypeError;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// An orbit and its columns, for the module of the package that makes the result.
type SettledColumns = (bool, f64, u64, u64, Vec<(String, String, [f64; 4])>);

/// What stands in messages where a file's name would, for values that Python set.
const SET: &str = "with_values";

/// One experiment: what is built, what drives it and what is recorded, as in a scenario file.
///
/// A quantity is text with its unit, such as "60 psi"; in values from Python it may be a number in SI. A scenario is immutable:
/// `with_values` returns another one. Sections are attributes: `scenario.load.mass` is a number in SI. Two scenarios are equal
/// if `to_toml` returns equal text: a section `[sweep]` counts, and whether an engine is given.
///
/// Parameters
/// ----------
/// text : str
///     Scenario as TOML.
/// name : str, optional
///     Name that messages show in place of that of a file; "scenario.toml" by default.
/// values : sequence of (str, str), optional
///     Paths of keys with values as TOML, which replace those of the text; none by default.
/// in_si : bool, optional
///     Whether numbers without a unit are quantities in SI. By default they are refused.
///
/// Raises
/// ------
/// InputError
///     The text is not TOML, or the scenario is not valid. The message names the place, the range and the remedy.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> scenario = mckibben.Scenario('''
///     ...     [load]
///     ...     kind = "hanging-mass"
///     ...     mass = "2 kg"
///     ...     [initial]
///     ...     gauge_pressure = "60 psi"
///     ...     [run]
///     ...     duration = "0.1 s"
///     ... ''')
///     >>> scenario.load.mass, scenario.load.kind
///     (2.0, 'hanging-mass')
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Scenario {
    name: String,
    text: String,
    /// Whether numbers of the text are in SI.
    in_si: bool,
    /// Paths of keys with the TOML of their values, which were set after reading.
    set: Vec<(String, String)>,
    pub(crate) document: Document,
    /// As it was understood; none of many actuators with names.
    understood: Option<mckibben_scenario::Scenario>,
    /// The dictionary of the attributes, made at the first use of one. It is read only.
    sections: PyOnceLock<Py<PyDict>>,
}

/// The scenario of an argument, which the message for anything else names.
pub(crate) struct ScenarioArgument<'py>(pub(crate) Bound<'py, Scenario>);

impl<'a, 'py> FromPyObject<'a, 'py> for ScenarioArgument<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = <Py<Scenario> as FromPyObject<'a, 'py>>::INPUT_TYPE;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        given.cast::<Scenario>().map(|scenario| Self(scenario.to_owned())).map_err(|_| {
            let remedy = match given.extract::<String>() {
                Ok(path) => format!("mckibben.Scenario.from_file({path:?})"),
                Err(_) => "mckibben.Scenario, such as one of mckibben.Scenario.from_file".to_owned(),
            };
            PyTypeError::new_err(format!("`scenario` is of type {}; give {remedy}", kind(&given)))
        })
    }
}

impl Scenario {
    fn read(document: Document, in_si: bool, set: Vec<(String, String)>) -> PyResult<Self> {
        let mut document = document;
        for (key, value) in &set {
            document.set_in_si(SET, key, value).or_exception()?;
        }
        if document.is_plant() {
            // What is wrong is found now; a sweep may give what is missing.
            match document.sweep().or_exception()? {
                Some(_) => {}
                None => drop(document.plant_experiment().or_exception()?),
            }
            let (name, text) = (document.source().name().to_owned(), document.source().text().to_owned());
            return Ok(Self { name, text, in_si, set, document, understood: None, sections: PyOnceLock::new() });
        }
        // What a sweep varies need not be given in the file: then the first run stands for all.
        let first = |error| match document.sweep()? {
            Some(sweep) => sweep.scenario(0).map_err(|_| error),
            None => Err(error),
        };
        let understood = document.scenario().or_else(first).or_exception()?;
        if !document.contains("sweep") {
            // What it describes is built once, so that a contradiction is found now and not by what uses it.
            buildable(&understood).map_err(|error| Diagnostics::from(document.diagnose(&error))).or_exception()?;
        }
        let understood = Some(understood);
        let (name, text) = (document.source().name().to_owned(), document.source().text().to_owned());
        Ok(Self { name, text, in_si, set, document, understood, sections: PyOnceLock::new() })
    }

    /// The scenario of one actuator or joint that it is.
    pub(crate) fn of_one(&self) -> Result<&mckibben_scenario::Scenario, Failure> {
        self.understood.as_ref().ok_or_else(|| {
            let limit = &mckibben::limit::PLANT_HOST;
            Failure::input(limit.title().to_string(), limit.remedy)
        })
    }

    /// As it was understood; none of many actuators with names.
    pub(crate) fn understood(&self) -> Option<&mckibben_scenario::Scenario> {
        self.understood.as_ref()
    }

    /// What was set after reading, as `KEY=VALUE`.
    pub(crate) fn settings(&self) -> Vec<String> {
        self.set.iter().map(|(key, value)| format!("{key}={value}")).collect()
    }

    /// A new dictionary of the sections of `to_toml`.
    fn dictionary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        values::dict_of(py, &table_of(&self.to_toml()))
    }

    /// The dictionary of the sections that all attributes share: with every default, and with what a sweep varies. It is never
    /// changed.
    fn sections<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        let all = || {
            let given = table_of(&self.to_toml());
            let mut all =
                self.understood.as_ref().map_or_else(|| given.clone(), |understood| table_of(&understood.to_toml()));
            all.extend(given.into_iter().filter(|(section, _)| section == keys::SWEEP));
            values::dict_of(py, &all).map(Bound::unbind)
        };
        self.sections.get_or_try_init(py, all).map(|sections| sections.bind(py))
    }

    /// The name without folder and ending.
    pub(crate) fn title(&self) -> String {
        PathBuf::from(&self.name).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
    }
}

/// The sections of text that a scenario has written: it reads back.
fn table_of(text: &str) -> toml::Table {
    text.parse().unwrap_or_default()
}

/// Builds what a scenario of one actuator or joint describes, as `mckibben check` does.
fn buildable(of: &mckibben_scenario::Scenario) -> Result<(), mckibben::Error> {
    match (of.has_joint(), of.has_controller()) {
        (false, false) => of.experiment().map(drop),
        (false, true) => of.controlled_experiment().map(drop),
        (true, false) => of.joint_experiment().map(drop),
        (true, true) => of.controlled_joint_experiment().map(drop),
    }
}

#[pymethods]
impl Scenario {
    #[new]
    #[pyo3(signature = (text, name = "scenario.toml", values = Items(Vec::new()), in_si = false))]
    pub(crate) fn new(text: &str, name: &str, values: Items<(String, String)>, in_si: bool) -> PyResult<Self> {
        let document = match in_si {
            true => Document::parse_in_si(text, name),
            false => Document::parse(text, name),
        };
        Self::read(document.or_exception()?, in_si, values.0)
    }

    /// Read a scenario file.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     TOML file.
    ///
    /// Returns
    /// -------
    /// Scenario
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The file cannot be read, is not TOML, or is not a valid scenario.
    #[staticmethod]
    fn from_file(path: PathBuf) -> PyResult<Self> {
        Self::read(Document::load(path).or_exception()?, false, Vec::new())
    }

    /// Make a scenario from a dictionary of its sections, as `tomllib` reads them from a file.
    ///
    /// Parameters
    /// ----------
    /// values : mapping
    ///     Sections with their keys. A quantity is text with its unit, or a number in SI. Lists may be NumPy arrays, and
    ///     numbers those of NumPy.
    /// name : str, optional
    ///     Name that messages show in place of that of a file; "scenario.toml" by default. They show the dictionary as TOML.
    ///
    /// Returns
    /// -------
    /// Scenario
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The scenario is not valid, or the dictionary contains itself, has more than 64 levels or more than 2 000 000 values.
    /// TypeError
    ///     A key is not text, or a value is of a type that no scenario has.
    ///
    /// Examples
    /// --------
    ///     >>> import mckibben
    ///     >>> mckibben.Scenario.from_dict({
    ///     ...     "load": {"kind": "hanging-mass", "mass": 2.0},
    ///     ...     "initial": {"gauge_pressure": "60 psi"},
    ///     ...     "run": {"duration": "0.1 s"},
    ///     ... })
    ///     <mckibben.Scenario "scenario.toml">
    #[staticmethod]
    #[pyo3(signature = (values, name = "scenario.toml"))]
    fn from_dict(values: Values<'_>, name: &str) -> PyResult<Self> {
        let table: toml::Table = values::pairs_of(&values.0)?.into_iter().collect();
        Self::new(&table.to_string(), name, Items(Vec::new()), true)
    }

    /// Return a scenario with other values.
    ///
    /// Parameters
    /// ----------
    /// values : mapping
    ///     Values by the paths of their keys, such as `{"load.mass": "10 lb", "command.duty": 0.3}`. A quantity is text with
    ///     its unit, or a number in SI.
    ///
    /// Returns
    /// -------
    /// Scenario
    ///     A new scenario; this one is unchanged.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     There is no such key, or the scenario is not valid with these values.
    /// TypeError
    ///     A value is of a type that no scenario has.
    ///
    /// Examples
    /// --------
    ///     >>> import mckibben
    ///     >>> scenario = mckibben.Scenario.from_dict({
    ///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
    ///     ...     "initial": {"gauge_pressure": "60 psi"},
    ///     ...     "run": {"duration": "0.1 s"},
    ///     ... })
    ///     >>> scenario.with_values({"load.mass": 3.5}).load.mass
    ///     3.5
    fn with_values(&self, values: Values<'_>) -> PyResult<Self> {
        let mut set = self.set.clone();
        for (key, value) in values::pairs_of(&values.0)? {
            set.retain(|(known, _)| *known != key);
            set.push((key, value.to_string()));
        }
        Self::new(&self.text, &self.name, Items(set), self.in_si)
    }

    /// Return the scenario as TOML: every value in SI, those of presets and defaults written out.
    ///
    /// Where no engine is given none is written, as a sweep chooses it then. Of several actuators with names, and of a scenario with
    /// a section `[sweep]`: every key that was given, with its value as it was written.
    ///
    /// Returns
    /// -------
    /// str
    pub(crate) fn to_toml(&self) -> String {
        self.document.to_toml_with(self.understood.as_ref())
    }

    /// Return the content of `to_toml` as a dictionary of sections, which `from_dict` accepts.
    ///
    /// Returns
    /// -------
    /// dict
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Sections<'py>> {
        Ok(Sections(self.dictionary(py)?.into_any()))
    }

    /// Name of the file, or that given in its place.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Text as it was read, without the values that `with_values` set.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Return whether both scenarios have equal values.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().to_toml() == self.to_toml())
    }

    /// Run the scenario and on behind its end to the periodic orbit, or to the equilibrium where nothing is pulsed.
    ///
    /// The orbit is that of the period that all pulses have in common. Where nothing but states is remembered it is found as a
    /// fixed point of the map from one period to the next, also where nothing damps the swing of the start.
    ///
    /// Returns
    /// -------
    /// Settled
    ///     Mean, ripple, least and greatest value of each column of numbers over a period.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The pulses have no common period of up to a thousand of the fastest.
    /// SimulationError
    ///     The simulation cannot go on.
    ///
    /// Notes
    /// -----
    /// The interpreter is released, so other threads continue. Ctrl-C ends it.
    ///
    /// Examples
    /// --------
    ///     >>> import mckibben
    ///     >>> scenario = mckibben.Scenario.from_dict({
    ///     ...     "load": {"kind": "hanging-mass", "mass": "2 kg"},
    ///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
    ///     ...     "run": {"duration": "0.1 s"},
    ///     ... })
    ///     >>> settled = scenario.settle()
    ///     >>> bool(abs(settled["tension"].mean - 2 * 9.80665) < 1e-4)
    ///     True
    fn settle<'py>(scenario: &Bound<'py, Self>) -> PyResult<Settled<'py>> {
        python::call(scenario.py(), ("_results", "settled"), (scenario,)).map(Settled)
    }

    /// Return the scenario as TOML in which each key stands as it was given, with presets, for keys that are set later.
    fn _given(&self) -> String {
        self.document.to_toml_with(None)
    }

    /// Return the orbit and its columns, each with its unit, mean, ripple, least and greatest value.
    fn _settled(&self, py: Python<'_>) -> PyResult<SettledColumns> {
        let document = &self.document;
        let mut watch = Watch::new();
        let found = py.detach(|| Ready::of(document)?.settle(document, &mut |time| watch.at(time)));
        let found = watch.outcome(found)?;
        let (orbit, rows) = (found.orbit, found.rows);
        let of = |row: Settling| {
            let ripple = row.ripple();
            (row.name, row.unit, [row.mean, ripple, row.least, row.greatest])
        };
        Ok((orbit.settled, orbit.period, orbit.periods, orbit.guesses, rows.into_iter().map(of).collect()))
    }

    /// Return the values in which another scenario differs.
    ///
    /// Parameters
    /// ----------
    /// other : Scenario
    ///     Scenario to compare with.
    ///
    /// Returns
    /// -------
    /// dict of str to tuple
    ///     For each path of a key the value here and that of `other`, as in `to_dict`; `None` where there is none.
    ///
    /// Examples
    /// --------
    ///     >>> import mckibben
    ///     >>> scenario = mckibben.Scenario.from_dict({
    ///     ...     "load": {"kind": "hanging-mass", "mass": "2 kg"},
    ///     ...     "initial": {"gauge_pressure": "60 psi"},
    ///     ...     "run": {"duration": "0.1 s"},
    ///     ... })
    ///     >>> scenario.diff(scenario.with_values({"load.mass": 3.5}))
    ///     {'load.mass': ('2 kg', '3.5 kg')}
    fn diff<'py>(&self, other: &Bound<'py, Self>) -> PyResult<Sections<'py>> {
        let py = other.py();
        python::call(py, ("_scenario", "diff"), (self.dictionary(py)?, other.get().dictionary(py)?)).map(Sections)
    }

    /// Return a section or a value by its name, such as `scenario.load.mass`: a quantity is a number in SI.
    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Object<'py>> {
        python::call(py, ("_scenario", "attribute"), (self.sections(py)?, name)).map(Object)
    }

    fn __dir__<'py>(this: &Bound<'py, Self>) -> PyResult<Object<'py>> {
        python::call(this.py(), ("_scenario", "names"), (this, this.get().sections(this.py())?)).map(Object)
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Scenario {:?}>", self.name)
    }

    fn __str__(&self) -> String {
        self.to_toml()
    }

    fn _repr_html_<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        python::call(py, ("_scenario", "to_html"), (&self.name, self.dictionary(py)?)).map(Object)
    }

    fn __getnewargs__(&self) -> (&str, &str, Vec<(String, String)>, bool) {
        (&self.text, &self.name, self.set.clone(), self.in_si)
    }
}

/// The value in SI of text with a unit; `None` where it is no quantity.
#[pyfunction]
pub(crate) fn _quantity(text: &str) -> Option<f64> {
    mckibben_scenario::quantity::parse(text).ok().filter(|read| read.has_unit).map(|read| read.value)
}
