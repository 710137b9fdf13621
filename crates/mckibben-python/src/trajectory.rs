//! `simulate`, and the classes `Trajectory` and `Event`.

use crate::arguments;
use crate::columns::{array, dictionary};
use crate::exceptions::OrException;
use crate::python;
use crate::scenario::{Scenario, ScenarioArgument};
use crate::signals::Watch;
use crate::typed::{
    self, Axes, AxisWord, Columns, Facts, Figure, Items, Line, Listed, Name, Names, Numbers, Pandas, Parts, Polars,
    Progress, Row, Single, Summary, Texts, Words,
};
use mckibben_plot::Theme;
use mckibben_run::axis::TrajectoryAxis;
use mckibben_run::failure::Failure;
use mckibben_run::output;
use mckibben_run::record::{Format, Provenance, Values};
use mckibben_run::run::{Figures, Finished, Ready};
use mckibben_run::settle::End;
use mckibben_run::warnings::of_run;
use pyo3::exceptions::{PyAttributeError, PyKeyError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Simulate a scenario and return its trajectory.
///
/// The result is bit-identical to that of `mckibben simulate`.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     One actuator, an antagonistic joint, or several actuators with names.
/// progress : callable, optional
///     Called as `progress(time, end)` with the time that is reached and the duration, both in s, at most about 20 times a
///     second. An exception that it raises ends the run.
///
/// Returns
/// -------
/// Trajectory
///     Columns over time, and events.
///
/// Raises
/// ------
/// InputError
///     The model finds a contradiction in the scenario.
/// SimulationError
///     The simulation cannot continue.
///
/// Notes
/// -----
/// The interpreter is released during the run, so other threads continue. Ctrl-C ends the run.
///
/// The columns are finite numbers. Those of `summary()` take longer than the run, so they are computed and checked when they are
/// first used, as by `warnings` and before a file is written. The whole run is kept, with about 3 kB for each event.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> scenario = mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
///     ...     "run": {"duration": "0.1 s"},
///     ... })
///     >>> run = mckibben.simulate(scenario)
///     >>> float(run.t[-1]), float(run.length[0])
///     (0.1, 0.085)
#[pyfunction]
#[pyo3(signature = (scenario, *, progress = None))]
pub(crate) fn simulate(
    py: Python<'_>,
    scenario: ScenarioArgument<'_>,
    progress: Option<Progress<'_>>,
) -> PyResult<Trajectory> {
    let scenario = scenario.0;
    let finished = run(py, scenario.get(), progress)?;
    let (columns, log) = py.detach(|| finished.columns().map(|columns| (columns, finished.log()))).or_exception()?;
    let of_column = |column: mckibben_run::record::Filled| {
        Ok(Column { name: column.name, unit: column.unit.to_owned(), values: array(py, column.values)?.unbind() })
    };
    let columns = columns.into_iter().map(of_column).collect::<PyResult<_>>()?;
    let names: Arc<[String]> = log.columns.into();
    let event = |(time, words): (f64, Vec<Cow<'static, str>>)| {
        let words = words.into_iter().map(Cow::into_owned).collect();
        Event { time, columns: names.clone(), words }
    };
    let events = log.times.into_iter().zip(log.rows).map(event).collect();
    let kept = Mutex::new(Some(Arc::new(finished)));
    Ok(Trajectory { scenario: scenario.unbind(), columns, events, kept, figures: OnceLock::new() })
}

fn run(py: Python<'_>, scenario: &Scenario, progress: Option<Progress<'_>>) -> PyResult<Finished> {
    let ready = py.detach(|| Ready::of(&scenario.document)).or_exception()?;
    let mut watch = Watch::new().reporting(progress, ready.plan().duration);
    let finished = py.detach(|| ready.run(&scenario.document, End::Duration, &mut |time| watch.at(time)));
    watch.outcome(finished.map(|(finished, _)| finished))
}

/// A column of a run.
struct Column {
    name: String,
    /// Empty for words.
    unit: String,
    values: Py<PyAny>,
}

/// Result of a run: its columns as NumPy arrays, its events, and its values between the samples.
///
/// There is a sample at t = 0, at every `run.sample_interval` and at the end. `trajectory["absolute_pressure_pa"]` is a column
/// by its name in the files of `mckibben simulate`; those that every run of one actuator or joint has are attributes too.
/// Arrays are read-only: copy one to change it. `simulate` returns a trajectory; the constructor serves pickling.
///
/// Notes
/// -----
/// Columns of a joint are those of its agonist, and those of its antagonist begin with `antagonist_`, as `antagonist_length_m`.
/// Of several actuators with names every column has a name in front: `flexor.absolute_pressure_pa`, `elbow.angle_rad`,
/// `tank.absolute_pressure_pa`. `len` is the number of samples; iteration, `in` and `dict` go by the names of the columns.
///
/// A trajectory from a pickle simulates the scenario again when a value between the samples, the summary or a file is
/// requested.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> run = mckibben.simulate(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
///     ...     "run": {"duration": "0.1 s"},
///     ... }))
///     >>> run.length is run["length_m"], run.units["tension_n"]
///     (True, 'N')
///     >>> run.at(0.0)["length_m"]
///     0.085
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Trajectory {
    scenario: Py<Scenario>,
    columns: Vec<Column>,
    events: Vec<Event>,
    /// The run; computed again on use where it is missing, as after unpickling.
    kept: Mutex<Option<Arc<Finished>>>,
    /// What it came to, once that is used: it takes longer than the run.
    figures: OnceLock<Figures>,
}

/// Event of a run: a discontinuity, and the discrete state that holds after it.
///
/// `Trajectory.events` has them; the constructor serves pickling.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> run = mckibben.simulate(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
///     ...     "run": {"duration": "0.1 s"},
///     ... }))
///     >>> event = run.events[0]
///     >>> event.kind, 0.0 <= event.time <= 0.1, event.after["valve"]
///     ('reversal', True, 'closed')
#[pyclass(frozen, module = "mckibben")]
#[derive(Clone, PartialEq)]
pub(crate) struct Event {
    time: f64,
    columns: Arc<[String]>,
    words: Vec<String>,
}

#[pymethods]
impl Event {
    #[new]
    fn new(time: f64, columns: Items<String>, words: Items<String>) -> Self {
        Self { time, columns: columns.0.into(), words: words.0 }
    }

    /// Time of the event in s.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// Kind of the event, such as "valve", "stick", "break-away" or "slack".
    #[getter]
    fn kind(&self) -> &str {
        self.words.first().map_or("", String::as_str)
    }

    /// Discrete state after the event, by the names of the columns of `mckibben simulate --events-output`.
    ///
    /// Values are words such as "slack", `bool` for true and false, and `float`.
    #[getter]
    fn after<'py>(&self, py: Python<'py>) -> PyResult<Facts<'py>> {
        let after = PyDict::new(py);
        for (name, word) in self.columns.iter().zip(&self.words).skip(1) {
            // Words such as "inf" are none of ours, so what begins like a number is one.
            let number =
                || word.starts_with(|c: char| c.is_ascii_digit() || c == '-').then(|| word.parse::<f64>().ok());
            match (word.as_str(), number().flatten()) {
                ("true", _) => after.set_item(name, true),
                ("false", _) => after.set_item(name, false),
                (_, Some(number)) => after.set_item(name, number),
                (word, None) => after.set_item(name, word),
            }?;
        }
        Ok(Facts(after.into_any()))
    }

    /// Return whether both events are equal.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get() == self)
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Event {:?} at {:?} s>", self.kind(), self.time)
    }

    fn __getnewargs__(&self) -> (f64, Vec<String>, Vec<String>) {
        (self.time, self.columns.to_vec(), self.words.clone())
    }
}

/// Times between the samples that are read between two checks for Ctrl-C.
const TIMES_PER_CHECK: usize = 50_000;

impl Trajectory {
    fn find(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// A column that is an attribute.
    fn attribute<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let missing = || {
            let names: Vec<&str> = self.columns.iter().map(|column| column.name.as_str()).collect();
            PyAttributeError::new_err(format!("this run has no column `{name}`; it has {}", names.join(", ")))
        };
        Ok(self.find(name).ok_or_else(missing)?.values.bind(py).clone())
    }

    /// The run itself.
    fn finished(&self, py: Python<'_>) -> PyResult<Arc<Finished>> {
        let kept = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(finished) = kept().clone() {
            return Ok(finished);
        }
        let scenario = self.scenario.get();
        let finished = Arc::new(run(py, scenario, None)?);
        Ok(kept().get_or_insert(finished).clone())
    }

    /// What the run came to. Each number of it is finite, as the program has it before it writes a file.
    fn figures(&self, py: Python<'_>) -> PyResult<&Figures> {
        if let Some(figures) = self.figures.get() {
            return Ok(figures);
        }
        let finished = self.finished(py)?;
        let checked = py.detach(|| finished.figures().and_then(|of| of.summary().check().map(|()| of)));
        let figures = checked.or_exception()?;
        Ok(self.figures.get_or_init(|| figures))
    }

    fn between<'py>(&self, py: Python<'py>, times: &[f64]) -> PyResult<Bound<'py, PyDict>> {
        let finished = self.finished(py)?;
        // Ctrl-C is handled between parts of very many times.
        let mut columns =
            py.detach(|| finished.columns_at(&times[..times.len().min(TIMES_PER_CHECK)])).or_exception()?;
        for part in times.chunks(TIMES_PER_CHECK).skip(1) {
            py.check_signals()?;
            let more = py.detach(|| finished.columns_at(part)).or_exception()?;
            for (column, more) in columns.iter_mut().zip(more) {
                match (&mut column.values, more.values) {
                    (Values::Numbers(numbers), Values::Numbers(more)) => numbers.extend(more),
                    (Values::Words(words), Values::Words(more)) => words.extend(more),
                    _ => {}
                }
            }
        }
        dictionary(py, columns)
    }

    fn write(&self, py: Python<'_>, path: PathBuf, format: Format) -> PyResult<()> {
        self.figures(py)?;
        let (finished, scenario) = (self.finished(py)?, self.scenario.get());
        py.detach(|| {
            let set = scenario.settings();
            let (document, scenario) = (&scenario.document, scenario.understood());
            let mut file = output::Pending::create(&path)?;
            finished.write(&Provenance { document, set: &set, scenario }, (&path, format), file.writer())?;
            file.commit()
        })
        .or_exception()
    }
}

/// What a run came to: numbers with names and units, counts of events, assumed values by their keys.
type Figured = (Vec<(String, f64, &'static str)>, Vec<(&'static str, u64)>, Vec<(String, String)>);

#[pymethods]
impl Trajectory {
    /// Restore a trajectory from a pickle.
    #[new]
    fn restored(
        scenario: Py<Scenario>,
        columns: Items<(String, String, Bound<'_, PyAny>)>,
        events: Items<Bound<'_, Event>>,
    ) -> PyResult<Self> {
        let of_column = |(name, unit, values): (String, String, Bound<'_, PyAny>)| {
            values.call_method1("setflags", (false,))?;
            Ok(Column { name, unit, values: values.unbind() })
        };
        let columns = columns.0.into_iter().map(of_column).collect::<PyResult<_>>()?;
        let events = events.0.iter().map(|event| event.get().clone()).collect();
        Ok(Self { scenario, columns, events, kept: Mutex::new(None), figures: OnceLock::new() })
    }

    /// Scenario that was run.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> Py<Scenario> {
        self.scenario.clone_ref(py)
    }

    /// Names of the columns in their order; that of a column of numbers ends with its unit.
    #[getter]
    fn columns(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.name.as_str()).collect()
    }

    /// Units of the columns of numbers by their names, in SI.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Names<'py>> {
        let units = PyDict::new(py);
        let numbers = self.columns.iter().filter(|column| !column.unit.is_empty());
        numbers.into_iter().try_for_each(|column| units.set_item(&column.name, &column.unit))?;
        Ok(Names(units.into_any()))
    }

    /// Return the names of the columns in their order, so that `dict(run)` has the columns.
    ///
    /// Returns
    /// -------
    /// list of str
    fn keys(&self) -> Vec<&str> {
        self.columns()
    }

    /// Iterate over the names of the columns in their order.
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Listed<'py>> {
        Ok(Listed(PyList::new(py, self.columns())?.try_iter()?.into_any()))
    }

    /// Return whether there is a column of this name.
    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.find(&name).is_some())
    }

    /// Return the number of samples.
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.columns.first().map_or(Ok(0), |column| column.values.bind(py).len())
    }

    /// Return a column by its name, such as "length_m" or "hose_absolute_pressure_pa".
    fn __getitem__<'py>(&self, py: Python<'py>, name: Name) -> PyResult<typed::Column<'py>> {
        self.attribute(py, &name.0).map(typed::Column).map_err(|error| PyKeyError::new_err(error.value(py).to_string()))
    }

    /// Times of the samples in s.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "time_s").map(Numbers)
    }

    /// Distances between the attachments in m; of a joint, that of its agonist.
    #[getter]
    fn length<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "length_m").map(Numbers)
    }

    /// Rates of the length in m/s, above zero while lengthening.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "velocity_m_s").map(Numbers)
    }

    /// Absolute pressures of the actuator's air in Pa.
    #[getter]
    fn absolute_pressure<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "absolute_pressure_pa").map(Numbers)
    }

    /// Gauge pressures of the actuator's air in Pa.
    #[getter]
    fn gauge_pressure<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "gauge_pressure_pa").map(Numbers)
    }

    /// Masses of the actuator's air in kg.
    #[getter]
    fn air_mass<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "air_mass_kg").map(Numbers)
    }

    /// Temperatures of the actuator's air in K.
    #[getter]
    fn temperature<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "temperature_k").map(Numbers)
    }

    /// Volumes of the actuator's air in m^3, in the braid and outside it.
    #[getter]
    fn volume<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "volume_m3").map(Numbers)
    }

    /// Tensions in N, zero or more: an actuator only pulls.
    #[getter]
    fn tension<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "tension_n").map(Numbers)
    }

    /// Net mass flows into the actuator in kg/s.
    #[getter]
    fn mass_flow<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "mass_flow_kg_s").map(Numbers)
    }

    /// Open ports of the valve: "supply", "exhaust", "supply+exhaust" or "closed".
    #[getter]
    fn valve<'py>(&self, py: Python<'py>) -> PyResult<Words<'py>> {
        self.attribute(py, "valve").map(Words)
    }

    /// Angles of a joint in rad, above zero where the agonist is shorter.
    #[getter]
    fn angle<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "angle_rad").map(Numbers)
    }

    /// Angular velocities of a joint in rad/s.
    #[getter]
    fn angular_velocity<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "angular_velocity_rad_s").map(Numbers)
    }

    /// Torques of both actuators on a joint in N*m.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "torque_n_m").map(Numbers)
    }

    /// Events in order of time.
    #[getter]
    fn events(&self) -> Vec<Event> {
        self.events.clone()
    }

    /// Warnings of what the scenario cannot mean, such as a valve that never opens or a length that no braid has.
    ///
    /// Each is one sentence that names the quantity, its value, the limit and the key to change. Of several actuators it begins
    /// with the name of the part. Where a number of `summary()` is not finite, `SimulationError` names it.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let (figures, document) = (self.figures(py)?, &self.scenario.get().document);
        let found = py.detach(|| Ok::<_, Failure>(of_run(Ready::of(document)?.warnings(), figures)));
        let found = found.or_exception()?;
        Ok(found.iter().map(ToString::to_string).collect())
    }

    /// Return every column at one time, from the interpolating polynomials of the steps.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Time in s, from 0 to the end of the run.
    ///
    /// Returns
    /// -------
    /// dict of str to float or str
    ///     Values by the names of the columns.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The time is outside the run.
    fn at<'py>(&self, py: Python<'py>, time: Single<'py>) -> PyResult<Row<'py>> {
        let time = time.read("time", "`at_times` takes several")?;
        let row = PyDict::new(py);
        for (name, values) in &self.between(py, &[time])? {
            row.set_item(name, values.get_item(0)?.call_method0("item")?)?;
        }
        Ok(Row(row.into_any()))
    }

    /// Return every column at several times, from the interpolating polynomials of the steps.
    ///
    /// Parameters
    /// ----------
    /// times : array_like
    ///     Times in s, from 0 to the end of the run, in any number.
    ///
    /// Returns
    /// -------
    /// dict of str to numpy.ndarray
    ///     Arrays of shape (len(times),) by the names of the columns.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A time is not finite or outside the run.
    fn at_times<'py>(&self, py: Python<'py>, times: Line<'py>) -> PyResult<Columns<'py>> {
        let times = times.read("times")?;
        arguments::finite("times", &times).or_exception()?;
        Ok(Columns(self.between(py, &times)?.into_any()))
    }

    /// Return the columns as arrays by their names, in their order.
    ///
    /// Returns
    /// -------
    /// dict of str to numpy.ndarray
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        let dictionary = PyDict::new(py);
        self.columns.iter().try_for_each(|column| dictionary.set_item(&column.name, &column.values))?;
        Ok(Columns(dictionary.into_any()))
    }

    /// Return the columns as a data frame of pandas, with the units in `attrs["units"]`.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     A row for each sample.
    fn to_pandas<'py>(run: &Bound<'py, Self>) -> PyResult<Pandas<'py>> {
        python::call(run.py(), ("_beside", "to_pandas"), (run,)).map(Pandas)
    }

    /// Return the columns as a data frame of Polars.
    ///
    /// Returns
    /// -------
    /// polars.DataFrame
    ///     A row for each sample.
    fn to_polars<'py>(run: &Bound<'py, Self>) -> PyResult<Polars<'py>> {
        python::call(run.py(), ("_beside", "to_polars"), (run,)).map(Polars)
    }

    /// Return figures of the run by the names of the reductions of a sweep.
    ///
    /// They are extremes, ripple, air consumption, energy and exergy, the chosen step and its error, counts of events, and
    /// assumed values. Extremes are those of the run between its samples too; those of a sweep are of the samples alone.
    ///
    /// Returns
    /// -------
    /// Summary
    ///     A mapping of names such as "length.final" to numbers in SI, with `units`, `events` and `assumed`.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     One of the numbers is not finite.
    ///
    /// Examples
    /// --------
    ///     >>> import mckibben
    ///     >>> run = mckibben.simulate(mckibben.Scenario.from_dict({
    ///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
    ///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
    ///     ...     "run": {"duration": "0.1 s"},
    ///     ... }))
    ///     >>> bool(run.summary()["length.final"] == run.length[-1])
    ///     True
    fn summary<'py>(run: &Bound<'py, Self>) -> PyResult<Summary<'py>> {
        python::call(run.py(), ("_results", "summary"), (run,)).map(Summary)
    }

    /// Return numbers with their names and units, counts of events, and assumed values.
    fn _figures(&self, py: Python<'_>) -> PyResult<Figured> {
        let (summary, assumed) = (self.figures(py)?.summary(), self.scenario.get().document.assumed());
        let numbers = summary.numbers.into_iter().map(|number| (number.name, number.value, number.unit)).collect();
        let assumed = assumed.into_iter().map(|of| (of.parameter.key.to_owned(), of.text)).collect();
        Ok((numbers, summary.events.into_iter().collect(), assumed))
    }

    /// Return the log of events as a data frame of pandas.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     A row for each event: `time_s`, `event`, and the discrete state after it.
    fn events_to_pandas<'py>(run: &Bound<'py, Self>) -> PyResult<Pandas<'py>> {
        python::call(run.py(), ("_results", "events_to_pandas"), (run,)).map(Pandas)
    }

    /// Draw columns over time with Matplotlib, in a panel for each.
    ///
    /// Parameters
    /// ----------
    /// columns : sequence of str, optional
    ///     Names of columns. By default length, pressure and tension; of a joint its angle in place of the length; of several
    ///     actuators angles too, with a line for each actuator or joint.
    /// ax : sequence of matplotlib.axes.Axes, optional
    ///     Axes to draw into, one for each panel. By default a new figure has them.
    ///
    /// Returns
    /// -------
    /// matplotlib.figure.Figure
    ///
    /// Raises
    /// ------
    /// InputError
    ///     `columns` is empty, or `ax` has another number of axes.
    /// KeyError
    ///     There is no column of that name.
    #[pyo3(signature = (columns = None, ax = None))]
    fn plot<'py>(run: &Bound<'py, Self>, columns: Option<Texts<'py>>, ax: Option<Axes<'py>>) -> PyResult<Figure<'py>> {
        let columns = columns.map(|of| of.read("columns")).transpose()?;
        let arguments = (run, columns, ax.map(|ax| ax.0));
        python::call(run.py(), ("_beside", "plot"), arguments).map(Figure)
    }

    /// Write the columns as Parquet: the columns and the numbers of the file of `mckibben simulate --output`.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to write.
    ///
    /// Raises
    /// ------
    /// OutputError
    ///     The file cannot be written; then none is left behind.
    /// SimulationError
    ///     A number of `summary()` is not finite.
    fn to_parquet(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.write(py, path, Format::Parquet)
    }

    /// Write the columns as CSV: byte for byte the file of `mckibben simulate --output`.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to write.
    ///
    /// Raises
    /// ------
    /// OutputError
    ///     The file cannot be written; then none is left behind.
    /// SimulationError
    ///     A number of `summary()` is not finite.
    fn to_csv(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.write(py, path, Format::Csv)
    }

    /// Write the columns as a MAT-file for MATLAB, Octave and SciPy, as `mckibben simulate --output` does.
    ///
    /// Each column is a variable; points in names become underscores.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to write.
    ///
    /// Raises
    /// ------
    /// OutputError
    ///     The file cannot be written; then none is left behind.
    /// SimulationError
    ///     A number of `summary()` is not finite.
    fn to_mat(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.write(py, path, Format::Mat)
    }

    /// Return the figure of `mckibben simulate --plot` as SVG.
    ///
    /// Parameters
    /// ----------
    /// over : {"time", "length"}, optional
    ///     Horizontal axis: time by default, or the length, over which the tension is drawn. The figure of several actuators is
    ///     always over time.
    ///
    /// Returns
    /// -------
    /// str
    ///
    /// Raises
    /// ------
    /// InputError
    ///     `over` is another word.
    #[pyo3(signature = (over = AxisWord::from("time")))]
    fn to_svg(&self, py: Python<'_>, over: AxisWord) -> PyResult<String> {
        let title = || format!("over = \"{}\" is no horizontal axis of a run", over.0);
        let over: TrajectoryAxis =
            over.0.parse().map_err(|remedy: String| Failure::input(title(), remedy)).or_exception()?;
        let (finished, title) = (self.finished(py)?, self.scenario.get().title());
        py.detach(|| Ok::<_, Failure>(finished.figure(over, &title)?.to_svg(Theme::Light)?)).or_exception()
    }

    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        self.to_svg(py, "time".into())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<mckibben.Trajectory of {:?}, {} rows>", self.scenario.get().title(), self.__len__(py)?))
    }

    fn __getnewargs__<'py>(run: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        let (py, of) = (run.py(), run.get());
        let columns: Vec<_> =
            of.columns.iter().map(|column| (&column.name, &column.unit, column.values.clone_ref(py))).collect();
        Ok(Parts((of.scenario.clone_ref(py), columns, of.events.clone()).into_pyobject(py)?.into_any()))
    }
}
