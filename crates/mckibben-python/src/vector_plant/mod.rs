//! Many copies of one plant that are commanded at run time and begin again one by one: the class `VectorPlant`.
//!
//! | module | what it holds |
//! |---|---|
//! | `file` | the plant of a scenario file, with other values of numbers by their paths |
//! | `columns` | what is observed of each |
//! | `fleet` | the plants, stepped together in a batch |

mod columns;
mod file;
mod fleet;

use crate::alone;
use crate::arguments;
use crate::exceptions::OrException;
use crate::pace::Span;
use crate::pool;
use crate::scenario::{Scenario, ScenarioArgument};
use crate::typed::{
    ActionWord, Copied, Count, FREQUENCY, Flags, Line, NewArguments, Numbers as Array, PrecisionWord, Quantity, Rows,
    TIME, Table, Texts,
};
use file::File;
use fleet::Fleet;
use mckibben::network::NodeKind;
use mckibben::simulation::MOST_PARTS;
use mckibben::valve::Solenoid;
use mckibben_run::failure::Failure;
use mckibben_run::host::CommandMode;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// Many instances of a scenario's plant, stepped together on all cores, whose valves the caller commands.
///
/// Each instance may be reset, with its own values of parameters, while the others continue. The environments of
/// `mckibben.learning` are made of it. The caller owns the arrays that `step` and `observe` use: they are C-contiguous, and are
/// read and written in place. `values` and `rows` may have any memory layout. An array of other numbers or dimensions raises
/// `TypeError`.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     Any plant with a valve: one actuator with its load, an antagonistic joint, or several actuators with names on their
///     mechanisms. Its controllers and the commands of the actuators' valves are not used; supplies follow theirs.
/// count : int
///     Number of instances.
/// parameters : sequence of str, optional
///     Paths of the parameters that differ between the instances: "load.mass", "initial.gauge_pressure"; where actuators have
///     names also "actuators.biceps.friction.viscous" and "mechanism.joints.elbow.damping"; none by default.
/// action_mode : {"duty", "request", "position", "set-point"}, optional
///     What an action is: a duty cycle from 0 to 1 (the default); a request, 1 to fill, 0 to hold, -1 to exhaust; the position
///     of a proportional spool from -1 to 1; the set point of a pressure regulator, a gauge pressure in Pa.
/// pulse_frequency : float or str, optional
///     Frequency in Hz, above zero, or text with a unit, of the pulses of all duty cycles. By default that of the scenario's first PWM.
///     What is requested in the pulses of a valve and between them its own PWM says, or the first one where its command is no PWM.
/// precision : {"double", "single"}, optional
///     Numbers that the instances are stepped in; double by default. Single precision takes twice as many at once, and keeps seven digits of a
///     state: what a step changes below the last of them is lost. It needs a package that is built with the feature `f32`.
///
/// Raises
/// ------
/// InputError
///     The plant has no valve, a valve does not take such actions, or there is no such parameter, or one that changes nothing of the
///     plant.
/// MemoryError
///     This machine does not have the memory for so many instances.
///
/// Notes
/// -----
/// Steps are fixed and by `run.method`, each no longer than `run.step`, or where that is not given than `run.accuracy` needs. A
/// copy, or an instance from a pickle, is reset: it has the same scenario and options, at t = 0.
///
/// Examples
/// --------
///     >>> import mckibben, numpy
///     >>> scenario = mckibben.Scenario.from_dict({
///     ...     "supply": {"gauge_pressure": "100 psi"},
///     ...     "valve": {"preset": "matrix-eight-channel"},
///     ...     "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
///     ...     "initial": {"gauge_pressure": "40 psi", "length": "equilibrium"},
///     ...     "run": {"duration": "1 s", "engine": "fixed-step", "step": "0.5 ms"},
///     ... })
///     >>> plants = mckibben.VectorPlant(scenario, 2, parameters=["load.mass"], action_mode="request")
///     >>> plants.start(numpy.array([[2.0], [3.0]]))
///     >>> observations, stopped = numpy.zeros((2, len(plants.columns))), numpy.zeros(2, dtype=bool)
///     >>> plants.step(numpy.array([[1.0], [-1.0]]), 0.02, observations, stopped)
///     >>> plants.columns[0], bool(stopped.any()), float(plants.time[0])
///     ('length_m', False, 0.02)
#[pyclass(module = "mckibben")]
pub(crate) struct VectorPlant {
    scenario: Py<Scenario>,
    parameters: Vec<String>,
    action_mode: String,
    pulse_frequency: Option<f64>,
    given: Vec<f64>,
    /// The longest step in s.
    longest: f64,
    duration: f64,
    requests: Vec<f64>,
    /// Frequency of the pulses in Hz, where actions are duty cycles.
    pulses: Option<f64>,
    /// Longest time in s from a command to its effect at a valve.
    valve_delay: f64,
    count: usize,
    /// How many columns are observed of each.
    width: usize,
    fleet: Fleet,
}

/// A step of a control period that is this much longer than the longest is as long.
const ROUNDING: f64 = 1e-9;
/// By this share a parameter is moved to see whether it changes the plant.
const NUDGE: f64 = 1e-3;
/// Steps and edges of pulses of all plants together between two checks for Ctrl-C.
const PARTS_PER_CHECK: f64 = 1e6;

impl VectorPlant {
    fn of(
        py: Python<'_>,
        scenario: &Py<Scenario>,
        parameters: &[String],
        (mode, pulse_frequency): (&str, Option<f64>),
        (count, precision): (usize, &PrecisionWord),
    ) -> Result<Self, Failure> {
        let file = File::read(scenario.clone_ref(py), parameters, (mode, pulse_frequency))?;
        arguments::taking_part("parameters", parameters, IDLE)?;
        if file.valves.is_empty() {
            let remedy = "give the scenario [supply] and [valve]";
            return Err(Failure::input("the plant has no valve that could be commanded", remedy));
        }
        let requests = CommandMode::requests_of(file.solenoids().collect::<Vec<_>>().into_iter());
        let of_valve = |valve: &Solenoid| valve.dead_time() + valve.delays().into_iter().fold(0.0, f64::max);
        let hoses = file.begin().plant.network().nodes.iter().filter_map(|node| match &node.kind {
            NodeKind::Hose(hose) => Some(hose.transport_delay()),
            _ => None,
        });
        let valve_delay = file.solenoids().map(of_valve).fold(0.0, f64::max) + hoses.fold(0.0, f64::max);
        let (longest, duration, given) = (file.step, file.run.duration, file.given().to_vec());
        let (width, pulses) = (file.columns.len(), file.modes.first().and_then(CommandMode::pulse_frequency));
        let least: Vec<f64> = file.modes.iter().map(|mode| mode.least(&requests)).collect();
        let fleet = Fleet::new(file, precision.read()?)?;
        fleet.check(&least).map_err(|(_, failure)| failure)?;
        let (scenario, parameters, action_mode) = (scenario.clone_ref(py), parameters.to_vec(), mode.to_owned());
        let plants = Self {
            scenario,
            parameters,
            action_mode,
            pulse_frequency,
            given,
            longest,
            duration,
            requests,
            pulses,
            valve_delay,
            count,
            width,
            fleet,
        };
        plants.check_effects()?;
        Ok(plants)
    }

    /// Refuses a parameter that changes nothing of the plant, such as the velocity of a start that cannot move. All others are moved
    /// too: a number may act only where another is not zero.
    fn check_effects(&self) -> Result<(), Failure> {
        for (place, path) in self.parameters.iter().enumerate() {
            let acts = |share: f64| {
                let size = |value: f64| if value == 0.0 { 1.0 } else { value.abs() };
                let one: Vec<f64> = self.given.iter().map(|value| value + share * size(*value)).collect();
                let mut other = one.clone();
                other[place] = self.given[place];
                self.fleet.differ([&one, &other]).ok()
            };
            // Values that the plant cannot have say nothing.
            let found = match acts(NUDGE) {
                Some(true) => Some(true),
                other => acts(-NUDGE).or(other),
            };
            if found == Some(false) {
                let title = format!("`parameters`: `{path}` changes nothing of this plant");
                return Err(Failure::input(title, "leave it out"));
            }
        }
        Ok(())
    }

    fn begin(&mut self, py: Python<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        let (values, count) = (values.map(|values| values.copied("values")).transpose()?, self.count);
        let (fleet, values) = self.valued(values.as_ref(), count).or_exception()?;
        py.detach(|| pool::share(count > FEW, |keeps| fleet.begin(&values, keeps).map_err(of_plant))?).or_exception()
    }

    /// The plants with the values of each; a failure where they are as many as there should not be, or not finite.
    fn valued<'a>(&'a mut self, values: Option<&'a Copied>, count: usize) -> Result<Valued<'a>, Failure> {
        let Self { fleet, parameters, given, .. } = self;
        let width = parameters.len();
        let Some(Copied { entries, shape }) = values else { return Ok((fleet, vec![given.as_slice(); count])) };
        if *shape != [count, width] {
            let [given, due] = [&shape[..], &[count, width]].map(arguments::tuple);
            let remedy = match width {
                0 => "leave `values` out: no `parameters` were named".to_owned(),
                _ => {
                    format!("give an array of shape {due}, in SI, with a column for each of {}", parameters.join(", "))
                }
            };
            return Err(Failure::input(format!("values of shape {given} are given for {count} instances"), remedy));
        }
        arguments::finite_table("values", entries, width)?;
        let values = if width == 0 { vec![[].as_slice(); count] } else { entries.chunks(width).collect() };
        Ok((fleet, values))
    }
}

/// Plants that begin in less time than it takes to wake other threads.
const FEW: usize = 4;

/// VectorPlant, and the values of each.
type Valued<'a> = (&'a mut Fleet, Vec<&'a [f64]>);

/// Name of the class, for messages.
const CLASS: &str = "VectorPlant";

/// The plants, unless another thread works on them.
fn mine<'py>(this: &Bound<'py, VectorPlant>) -> PyResult<PyRefMut<'py, VectorPlant>> {
    alone::to_change(this, CLASS)
}

/// A failure of a plant by its number.
fn of_plant((row, failure): (usize, Failure)) -> Failure {
    failure.of(&format!("plant {row}"))
}

/// The indices of instances, of which there are so many.
pub(crate) fn instances(rows: &Rows<'_>, count: usize) -> PyResult<Vec<usize>> {
    let known = |(at, row): (usize, &i64)| {
        usize::try_from(*row).ok().filter(|row| *row < count).ok_or_else(|| {
            let remedy = match count.checked_sub(1) {
                Some(last) => format!("give indices from 0 to {last}"),
                None => "make a VectorPlant with a count of 1 or more".to_owned(),
            };
            Failure::input(format!("rows[{at}] = {row} is the index of no instance"), remedy)
        })
    };
    rows.copied("rows")?.entries.iter().enumerate().map(known).collect::<Result<_, _>>().or_exception()
}

/// Refuses an instance that is named twice.
pub(crate) fn check_each_once(rows: &[usize]) -> Result<(), Failure> {
    let mut places = BTreeMap::new();
    for (at, row) in rows.iter().enumerate() {
        if let Some(first) = places.insert(*row, at) {
            let title = format!("rows[{at}] = {row} is the instance of rows[{first}] again");
            return Err(Failure::input(title, "give each index once"));
        }
    }
    Ok(())
}

/// Sections whose numbers change nothing of plants that a caller commands.
const IDLE: &[(&str, &str)] = &[
    ("command", "this plant, whose valves `actions` command"),
    ("controller", "this plant, whose valves `actions` command"),
    ("run", "this plant: all instances take the steps of the scenario"),
];

#[pymethods]
impl VectorPlant {
    #[new]
    #[pyo3(signature = (scenario, count, *, parameters = Texts::NONE, action_mode = ActionWord::from("duty"), pulse_frequency = None, precision = PrecisionWord::from("double")))]
    fn new(
        py: Python<'_>,
        scenario: ScenarioArgument<'_>,
        count: Count,
        parameters: Texts<'_>,
        action_mode: ActionWord,
        pulse_frequency: Option<Quantity<'_>>,
        precision: PrecisionWord,
    ) -> PyResult<Self> {
        let scenario = scenario.0.unbind();
        let pulse_frequency = pulse_frequency.map(|it| it.si("pulse_frequency", FREQUENCY)).transpose()?;
        let actions = (action_mode.0.as_str(), pulse_frequency);
        let parameters = parameters.read("parameters")?;
        arguments::each_once("parameters", &parameters).or_exception()?;
        let mut plants = Self::of(py, &scenario, &parameters, actions, (count.0, &precision)).or_exception()?;
        arguments::room(py, count.0, "plants", plants.fleet.bytes())?;
        plants.begin(py, None)?;
        Ok(plants)
    }

    /// Reset all instances to t = 0, without a command to their valves, and restart the clock.
    ///
    /// Parameters
    /// ----------
    /// values : numpy.ndarray, optional
    ///     Values of `parameters` in SI, float64 of shape (count, len(parameters)); those of the scenario by default.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A value is not valid; nothing has changed.
    #[pyo3(signature = (values = None))]
    fn start(this: &Bound<'_, Self>, py: Python<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        mine(this)?.begin(py, values)
    }

    /// Reset some instances, without a command to their valves, while the others continue.
    ///
    /// Parameters
    /// ----------
    /// rows : numpy.ndarray
    ///     Indices of the instances, int64, from 0, each once.
    /// values : numpy.ndarray, optional
    ///     Values of `parameters` in SI, float64 of shape (len(rows), len(parameters)); those of the scenario by default.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     There is no such instance, an index is given twice, or a value is not valid; nothing has changed.
    #[pyo3(signature = (rows, values = None))]
    fn restart(this: &Bound<'_, Self>, py: Python<'_>, rows: Rows<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        let mut plants = mine(this)?;
        let rows = instances(&rows, plants.count)?;
        check_each_once(&rows).or_exception()?;
        let values = values.map(|values| values.copied("values")).transpose()?;
        let (fleet, values) = plants.valued(values.as_ref(), rows.len()).or_exception()?;
        let rows: Vec<(usize, &[f64])> = rows.into_iter().zip(values).collect();
        py.detach(|| pool::share(rows.len() > FEW, |keeps| fleet.restart(&rows, keeps).map_err(of_plant))?)
            .or_exception()
    }

    /// Command the valves, advance all instances, and write their observations.
    ///
    /// Parameters
    /// ----------
    /// actions : numpy.ndarray
    ///     Commands of the valves, float64 of shape (count, valves), as `action_mode` says.
    /// dt : float or str
    ///     Duration of the step in s, above zero, or text with a unit.
    /// observations : numpy.ndarray
    ///     Receives the observations in SI, float64 of shape (count, len(columns)).
    /// stopped : numpy.ndarray
    ///     Receives which instances have produced a non-physical state, bool of shape (count,). Their observations stay as they
    ///     are, and only `restart` or `start` brings them back.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An action is not valid, an array is of another shape or not C-contiguous, or there are more than 10 000 000 steps and
    ///     edges of pulses; nothing has changed.
    ///
    /// Notes
    /// -----
    /// Ctrl-C ends a step of many parts between two of them.
    fn step(
        this: &Bound<'_, Self>,
        py: Python<'_>,
        actions: Table<'_>,
        dt: Quantity<'_>,
        observations: Table<'_>,
        stopped: Flags<'_>,
    ) -> PyResult<()> {
        let dt = dt.si("dt", TIME)?;
        let mut plants = mine(this)?;
        let Self { fleet, count, width, longest, pulses, .. } = &mut *plants;
        let (valves, count, width) = (fleet.valves(), *count, *width);
        let (actions, mut observations, mut stopped) =
            (actions.read("actions")?, observations.write("observations")?, stopped.write("stopped")?);
        arguments::shaped("actions", "float64", actions.shape(), &[count, valves]).or_exception()?;
        let actions = actions.as_slice()?;
        arguments::finite_table("actions", actions, valves).or_exception()?;
        crate::actuator::check_dt(dt).or_exception()?;
        let steps = (dt / *longest - ROUNDING).ceil().max(1.0);
        let parts = steps + 2.0 * dt * pulses.unwrap_or(0.0);
        if parts > MOST_PARTS {
            let title = format!("dt = {dt:?} s takes {parts:.3e} steps and edges of pulses, more than {MOST_PARTS:e}");
            return Err(Failure::input(title, "give a shorter dt, a longer run.step or a lower pulse_frequency"))
                .or_exception();
        }
        fleet.check(actions).map_err(of_plant).or_exception()?;
        arguments::shaped("observations", "float64", observations.shape(), &[count, width]).or_exception()?;
        arguments::shaped("stopped", "bool", stopped.shape(), &[count]).or_exception()?;
        let (observations, stopped) = (observations.as_slice_mut()?, stopped.as_slice_mut()?);
        // Between spans Ctrl-C is handled; commands that are repeated meanwhile change nothing.
        let spans = (parts * count as f64 / PARTS_PER_CHECK).ceil().max(1.0);
        let span = Span { duration: dt / spans, steps: (steps / spans).ceil() as u64 };
        for number in 0..spans as u64 {
            if number > 0 {
                py.check_signals()?;
            }
            py.detach(|| {
                pool::share(fleet.is_much(span.steps), |keeps| {
                    fleet.keep_to_thread(keeps);
                    fleet.step(span, actions, observations, stopped);
                })
            })
            .or_exception()?;
        }
        Ok(())
    }

    /// Write the current observations of some instances.
    ///
    /// Parameters
    /// ----------
    /// rows : numpy.ndarray
    ///     Indices of the instances, int64, from 0.
    /// observations : numpy.ndarray
    ///     Receives the observations in SI in the rows of these instances, float64 of shape (count, len(columns)).
    ///
    /// Raises
    /// ------
    /// InputError
    ///     There is no such instance, or `observations` is of another shape or not C-contiguous.
    fn observe(this: &Bound<'_, Self>, rows: Rows<'_>, observations: Table<'_>) -> PyResult<()> {
        let mut plants = mine(this)?;
        let Self { fleet, count, width, .. } = &mut *plants;
        let (count, width, rows) = (*count, *width, instances(&rows, *count)?);
        let mut observations = observations.write("observations")?;
        arguments::shaped("observations", "float64", observations.shape(), &[count, width]).or_exception()?;
        let observations = observations.as_slice_mut()?;
        for row in rows {
            if let Some(into) = observations.get_mut(row * width..(row + 1) * width) {
                fleet.observe(row, into);
            }
        }
        Ok(())
    }

    /// Return whether two sets of values of `parameters` give different plants, the commands of valves aside.
    ///
    /// Parameters
    /// ----------
    /// one : array_like
    ///     Values in SI, one for each of `parameters`.
    /// other : array_like
    ///     Values to compare with.
    ///
    /// Returns
    /// -------
    /// bool
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A value is missing or not valid.
    fn differ(this: &Bound<'_, Self>, one: Line<'_>, other: Line<'_>) -> PyResult<bool> {
        let (one, other) = (one.read("one")?, other.read("other")?);
        let plants = alone::to_read(this, CLASS)?;
        let values = [one.as_slice(), other.as_slice()];
        if values.iter().any(|values| values.len() != plants.parameters.len()) {
            let remedy = format!("give a value for each of {}, in SI", plants.parameters.join(", "));
            return Err(Failure::input("values are missing, or there are too many", remedy)).or_exception();
        }
        plants.fleet.differ(values).or_exception()
    }

    /// Time in s of each instance on the clock of the pulses, which all share and `start` restarts.
    ///
    /// Pulse p begins at p / `pulses`.
    #[getter]
    fn time<'py>(this: &Bound<'py, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        let plants = alone::to_read(this, CLASS)?;
        let time = vec![plants.fleet.time(); plants.count];
        Ok(Array(PyArray1::from_vec(py, time).into_any()))
    }

    /// Least and greatest command of each valve of each instance, float64 of shape (2, count, valves), as `action_mode` says.
    ///
    /// Set points end at the gauge pressure in Pa of what feeds the valve of the instance.
    #[getter]
    fn command_range<'py>(this: &Bound<'py, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        let plants = alone::to_read(this, CLASS)?;
        let shape = [2, plants.count, plants.fleet.valves()];
        let range = PyArray1::from_vec(py, plants.fleet.command_range()).reshape(shape)?;
        Ok(Array(range.into_any()))
    }

    /// Frequency of the pulses in Hz; `None` unless `action_mode` is "duty".
    #[getter]
    fn pulses(this: &Bound<'_, Self>) -> PyResult<Option<f64>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.pulses)
    }

    /// Longest time in s from a command to its effect at a valve.
    ///
    /// It is the longest delay of a coil or dead time of a pressure regulator, and what a hose adds.
    #[getter]
    fn valve_delay(this: &Bound<'_, Self>) -> PyResult<f64> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.valve_delay)
    }

    /// Names of the observations of an instance, as of the columns of a run.
    #[getter]
    fn columns(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.fleet.file().columns.iter().map(|column| column.name.clone()).collect())
    }

    /// Number of valves of an instance.
    #[getter]
    fn valves(this: &Bound<'_, Self>) -> PyResult<usize> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.fleet.valves())
    }

    /// Return the names of the observations of a scenario's plant, without making one.
    ///
    /// Parameters
    /// ----------
    /// scenario : Scenario
    ///     Any plant.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     The `columns` of its `VectorPlant`.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The model finds a contradiction in the scenario.
    #[staticmethod]
    fn columns_of(scenario: ScenarioArgument<'_>) -> PyResult<Vec<String>> {
        let columns = file::columns_of(scenario.0.get()).or_exception()?;
        Ok(columns.into_iter().map(|column| column.name).collect())
    }

    /// Requests that every valve can do, of 1 (fill), 0 (hold) and -1 (exhaust).
    #[getter]
    fn requests(this: &Bound<'_, Self>) -> PyResult<Vec<f64>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.requests.clone())
    }

    /// Duration of the scenario in s.
    #[getter]
    fn duration(this: &Bound<'_, Self>) -> PyResult<f64> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.duration)
    }

    /// Paths of the parameters that differ between the instances.
    #[getter]
    fn parameters(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.parameters.clone())
    }

    /// Values of `parameters` in the scenario, in SI.
    #[getter]
    fn defaults<'py>(this: &Bound<'py, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(Array(PyArray1::from_slice(py, &plants.given).into_any()))
    }

    /// Scenario of the plant.
    #[getter]
    fn scenario(this: &Bound<'_, Self>, py: Python<'_>) -> PyResult<Py<Scenario>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.scenario.clone_ref(py))
    }

    fn __len__(this: &Bound<'_, Self>) -> PyResult<usize> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.count)
    }

    fn __getnewargs_ex__<'py>(
        this: &Bound<'py, Self>,
        py: Python<'py>,
    ) -> PyResult<NewArguments<'py, (Py<Scenario>, usize)>> {
        let plants = alone::to_read(this, CLASS)?;
        let named = [
            ("parameters", (&plants.parameters).into_bound_py_any(py)?),
            ("action_mode", (&plants.action_mode).into_bound_py_any(py)?),
            ("pulse_frequency", plants.pulse_frequency.into_bound_py_any(py)?),
            ("precision", PrecisionWord::of(plants.fleet.precision()).into_bound_py_any(py)?),
        ];
        Ok(((plants.scenario.clone_ref(py), plants.count), named.into()))
    }

    fn __repr__(this: &Bound<'_, Self>) -> PyResult<String> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(format!("<mckibben.VectorPlant, {} of {:?}>", plants.count, plants.scenario.get().title()))
    }
}
