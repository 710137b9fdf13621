//! `simulate`, and the classes `Trajectory` and `Event`.

use crate::arguments;
use crate::columns::{array, dictionary};
use crate::python;
use crate::raised::Raised;
use crate::scenario::Scenario;
use crate::signals::Watch;
use crate::typed::{
    self, Axes, Columns, Facts, Figure, Items, Listed, Name, Names, Numbers, Pandas, Parts, Polars, Row, Sequence,
    Summary, Words,
};
use mckibben_plot::Theme;
use mckibben_run::failure::Failure;
use mckibben_run::finished::{Finished, Ready};
use mckibben_run::output;
use mckibben_run::portrait::Over;
use mckibben_run::record::{Format, Provenance};
use pyo3::exceptions::{PyAttributeError, PyKeyError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Runs a scenario, of whatever kind: what `mckibben simulate` does, to the last bit.
///
/// Other threads of Python go on meanwhile, and Ctrl-C ends it. Raises `InputError` where the model finds a contradiction, and
/// `SimulationError` where the simulation cannot go on.
#[pyfunction]
#[pyo3(signature = (scenario, *, progress = None))]
pub(crate) fn simulate(
    py: Python<'_>,
    scenario: &Bound<'_, Scenario>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Trajectory> {
    let finished = run(py, scenario.get(), progress)?;
    let (columns, log) = py.detach(|| finished.columns().map(|columns| (columns, finished.log()))).raised()?;
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
    Ok(Trajectory { scenario: scenario.clone().unbind(), columns, events, kept })
}

fn run(py: Python<'_>, scenario: &Scenario, progress: Option<Bound<'_, PyAny>>) -> PyResult<Finished> {
    let ready = py.detach(|| Ready::of(&scenario.document)).raised()?;
    let mut watch = Watch::new().reporting(progress, ready.plan().duration);
    let finished = py.detach(|| ready.run(&scenario.document, &mut |time| watch.at(time)));
    watch.outcome(finished)
}

/// A column of a run.
struct Column {
    name: String,
    /// Empty for words.
    unit: String,
    values: Py<PyAny>,
}

/// A finished run: its columns as NumPy arrays, its events, and what it was between the samples.
///
/// There is a row at t = 0, at every `run.sample_interval` and at the end. `trajectory["absolute_pressure_pa"]` is a column by its
/// name in the files of `mckibben simulate`; those that every run has are attributes too. The columns of a joint begin with
/// its agonist's; those of its antagonist are called `antagonist_length_m` and so on. Of many
/// actuators with names every column carries one: `flexor.absolute_pressure_pa`, `elbow.angle_rad`, `tank.absolute_pressure_pa`.
///
/// Arrays cannot be written to: copy one to change it.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Trajectory {
    scenario: Py<Scenario>,
    columns: Vec<Column>,
    events: Vec<Event>,
    /// The run itself; made again when it is asked for and not there, as after unpickling.
    kept: Mutex<Option<Arc<Finished>>>,
}

/// What happened at an instant of a run, and what holds from then on.
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

    /// When it happened, in s.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// What happened: `valve`, `stick`, `slack` and so on.
    #[getter]
    fn kind(&self) -> &str {
        self.words.first().map_or("", String::as_str)
    }

    /// What holds from then on, by the names of the columns of `mckibben simulate --events-output`: words such as "slack",
    /// whether something is so as a `bool`, numbers as `float`.
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

    /// Whether both are the same.
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

    fn between<'py>(&self, py: Python<'py>, times: &[f64]) -> PyResult<Bound<'py, PyDict>> {
        let finished = self.finished(py)?;
        let columns = py.detach(|| finished.columns_at(times)).raised()?;
        dictionary(py, columns)
    }

    fn write(&self, py: Python<'_>, path: PathBuf, format: Format) -> PyResult<()> {
        let (finished, scenario) = (self.finished(py)?, self.scenario.get());
        py.detach(|| {
            let set = scenario.settings();
            let (document, scenario) = (&scenario.document, scenario.understood());
            let mut file = output::Pending::create(&path)?;
            finished.write(&Provenance { document, set: &set, scenario }, (&path, format), file.writer())?;
            file.commit()
        })
        .raised()
    }
}

/// What a run came to: numbers with names and units, counts of events, assumed values by their keys.
type Figured = (Vec<(String, f64, &'static str)>, Vec<(&'static str, u64)>, Vec<(String, String)>);

#[pymethods]
impl Trajectory {
    /// A run as it was pickled; what only the engine knows is simulated anew when it is asked for.
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
        Ok(Self { scenario, columns, events, kept: Mutex::new(None) })
    }

    /// What was run.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> Py<Scenario> {
        self.scenario.clone_ref(py)
    }

    /// The names of the columns in their order, each of numbers with its unit at the end.
    #[getter]
    fn columns(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.name.as_str()).collect()
    }

    /// The units of the columns of numbers by their names, in SI.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Names<'py>> {
        let units = PyDict::new(py);
        let numbers = self.columns.iter().filter(|column| !column.unit.is_empty());
        numbers.into_iter().try_for_each(|column| units.set_item(&column.name, &column.unit))?;
        Ok(Names(units.into_any()))
    }

    /// The names of the columns, as of a data frame: `dict(run)` has the columns by their names.
    fn keys(&self) -> Vec<&str> {
        self.columns()
    }

    /// The names of the columns in their order.
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Listed<'py>> {
        Ok(Listed(PyList::new(py, self.columns())?.try_iter()?.into_any()))
    }

    /// Whether there is a column of this name.
    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.find(&name).is_some())
    }

    /// How many rows there are.
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.columns.first().map_or(Ok(0), |column| column.values.bind(py).len())
    }

    /// A column by its name, such as "length_m" or "hose_absolute_pressure_pa".
    fn __getitem__<'py>(&self, py: Python<'py>, name: Name) -> PyResult<typed::Column<'py>> {
        self.attribute(py, &name.0).map(typed::Column).map_err(|error| PyKeyError::new_err(error.value(py).to_string()))
    }

    /// Times in s.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "time_s").map(Numbers)
    }

    /// Distances between the attachments in m; of a joint, its agonist's.
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

    /// Volumes of the actuator's air in m^3, braid and hose.
    #[getter]
    fn volume<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "volume_m3").map(Numbers)
    }

    /// Tensions in N, zero or above: an actuator only pulls.
    #[getter]
    fn tension<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "tension_n").map(Numbers)
    }

    /// Net mass flows into the actuator in kg/s.
    #[getter]
    fn mass_flow<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "mass_flow_kg_s").map(Numbers)
    }

    /// Which passage of the valve is open: "supply", "exhaust", "both" or "closed".
    #[getter]
    fn valve<'py>(&self, py: Python<'py>) -> PyResult<Words<'py>> {
        self.attribute(py, "valve").map(Words)
    }

    /// Angles of a joint in rad, above zero where the agonist is shorter.
    #[getter]
    fn angle<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "angle_rad").map(Numbers)
    }

    /// Rates of a joint's angle in rad/s.
    #[getter]
    fn angular_velocity<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "angular_velocity_rad_s").map(Numbers)
    }

    /// Torques of both actuators on a joint in N*m.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        self.attribute(py, "torque_n_m").map(Numbers)
    }

    /// What happened, in order of time.
    #[getter]
    fn events(&self) -> Vec<Event> {
        self.events.clone()
    }

    /// Every column at `time` in s, by the polynomials of the steps: by the event-located engine exact between the samples too.
    ///
    /// Raises `InputError` for a time outside the run, and for a run at fixed steps.
    fn at<'py>(&self, py: Python<'py>, time: f64) -> PyResult<Row<'py>> {
        let row = PyDict::new(py);
        for (name, values) in &self.between(py, &[time])? {
            row.set_item(name, values.get_item(0)?.call_method0("item")?)?;
        }
        Ok(Row(row.into_any()))
    }

    /// Every column at each of `times` in s, as arrays by the names of the columns; as `at`.
    fn at_times<'py>(&self, py: Python<'py>, times: Sequence) -> PyResult<Columns<'py>> {
        arguments::finite("times", &times.0).raised()?;
        Ok(Columns(self.between(py, &times.0)?.into_any()))
    }

    /// The columns as arrays by their names, in their order.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        let dictionary = PyDict::new(py);
        self.columns.iter().try_for_each(|column| dictionary.set_item(&column.name, &column.values))?;
        Ok(Columns(dictionary.into_any()))
    }

    /// The columns as a data frame of pandas.
    fn to_pandas<'py>(run: &Bound<'py, Self>) -> PyResult<Pandas<'py>> {
        python::call(run.py(), ("_beside", "to_pandas"), (run,)).map(Pandas)
    }

    /// The columns as a data frame of Polars.
    fn to_polars<'py>(run: &Bound<'py, Self>) -> PyResult<Polars<'py>> {
        python::call(run.py(), ("_beside", "to_polars"), (run,)).map(Polars)
    }

    /// What the run came to: extremes, ripple, air used, energy and exergy, the step that was chosen and its error, events, assumed
    /// values.
    fn summary<'py>(run: &Bound<'py, Self>) -> PyResult<Summary<'py>> {
        python::call(run.py(), ("_results", "summary"), (run,)).map(Summary)
    }

    /// Numbers with their names and units, counts of events, and assumed values.
    fn _figures(&self, py: Python<'_>) -> PyResult<Figured> {
        let (finished, assumed) = (self.finished(py)?, self.scenario.get().document.assumed());
        let summary = py.detach(|| finished.figures().map(|figures| figures.summary())).raised()?;
        let numbers = summary.numbers.into_iter().map(|number| (number.name, number.value, number.unit)).collect();
        let assumed = assumed.into_iter().map(|of| (of.parameter.key.to_owned(), of.text)).collect();
        Ok((numbers, summary.events.into_iter().collect(), assumed))
    }

    /// The log of events as a data frame of pandas: `time_s`, `event`, and what holds from then on.
    fn events_to_pandas<'py>(run: &Bound<'py, Self>) -> PyResult<Pandas<'py>> {
        python::call(run.py(), ("_results", "events_to_pandas"), (run,)).map(Pandas)
    }

    /// Columns over time as a figure of Matplotlib, a panel for each, or into as many axes.
    ///
    /// Without `columns`: length, pressure and tension; of a joint or a plant its angles too, a line for each actuator.
    #[pyo3(signature = (columns = None, ax = None))]
    fn plot<'py>(
        run: &Bound<'py, Self>,
        columns: Option<Items<String>>,
        ax: Option<Axes<'py>>,
    ) -> PyResult<Figure<'py>> {
        let arguments = (run, columns.map(|of| of.0), ax.map(|ax| ax.0));
        python::call(run.py(), ("_beside", "plot"), arguments).map(Figure)
    }

    /// Writes the columns as Parquet: the file of `mckibben simulate --output`, byte by byte.
    fn to_parquet(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.write(py, path, Format::Parquet)
    }

    /// Writes the columns as CSV: the file of `mckibben simulate --output`, byte by byte.
    fn to_csv(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.write(py, path, Format::Csv)
    }

    /// The figure of `mckibben simulate --plot` as SVG; over "time", or tension over "length".
    #[pyo3(signature = (over = "time"))]
    fn to_svg(&self, py: Python<'_>, over: &str) -> PyResult<String> {
        let over = match over {
            "time" => Over::Time,
            "length" => Over::Length,
            other => {
                let title = format!("over = \"{other}\" is not what a run is drawn over");
                return Err(Failure::input(title, "give \"time\" or \"length\"")).raised();
            }
        };
        let (finished, title) = (self.finished(py)?, self.scenario.get().title());
        py.detach(|| finished.figure(over, &title).to_svg(Theme::Light)).raised()
    }

    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        self.to_svg(py, "time")
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
