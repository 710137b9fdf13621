//! Many modular actuators stepped together on arrays that the caller owns: the class `Actuators`.

use crate::actuator::{
    ActuatorState, Model, PARTS_PER_CHECK, ValveInput, check_dt, check_parts, check_velocity, distance, longest_part,
    reach, steps_of,
};
use crate::alone;
use crate::arguments::{self, fitting};
use crate::exceptions::{OrException, exception};
use crate::pool;
use crate::scenario::{Scenario, ScenarioArgument};
use crate::typed::{
    Copied, Count, FREQUENCY, Given, MemberWord, NewArguments, Numbers, PrecisionWord, Quantity, TIME, Table, Texts,
};
use mckibben::parameter;
use mckibben::plant::{PlantRow, PlantSteps};
use mckibben_batch::{PlantBatch, Precision};
use mckibben_identify::adjustable::Adjustable;
use mckibben_run::failure::Failure;
use mckibben_run::host::end_of_step;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadwriteArray1, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Parts of all together between two checks for Ctrl-C.
const PARTS_PER_CHECK_TOGETHER: f64 = 2e7;

/// Bytes that one of them takes, about: states, mode, and what a step computes with.
const EACH: usize = 20 << 10;

/// Many actuators of one scenario, each with its own air, valve and hysteresis, stepped together on arrays.
///
/// The caller owns the arrays: `step` reads and writes them in place. They are one-dimensional and C-contiguous, of float64,
/// with one element for each actuator. They are stepped side by side in the vector registers of the processor, and by all cores where
/// they are many. In double precision each is bit-identical to a scalar `Actuator`; in single precision it is near that, and the others
/// of the batch change it by less than a millionth of its range. An array of other numbers or dimensions raises `TypeError`.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     One actuator, or an antagonistic joint.
/// count : int
///     Number of actuators.
/// name : {"agonist", "antagonist"}, optional
///     Which actuator of a joint. Required for a joint, not allowed otherwise.
/// parameters : sequence of str, optional
///     Paths of the parameters that differ between the actuators, such as "actuator.turns"; none by default. Not together with
///     `name`.
/// values : numpy.ndarray, optional
///     Values of `parameters` in SI, float64 of shape (count, len(parameters)), of any memory layout. Required with `parameters`.
/// pulse_frequency : float or str, optional
///     Frequency in Hz, above zero, or text with a unit, of the pulses of a duty cycle. By default that of the scenario's PWM. Required where the
///     valve has poppets and the scenario has no PWM.
/// precision : {"double", "single"}, optional
///     Numbers that the actuators are stepped in; double by default. Single precision takes twice as many at once, and keeps seven digits of a
///     state: what a step changes below the last of them is lost. It needs a package that is built with the feature `f32`.
///
/// Raises
/// ------
/// InputError
///     An argument does not fit the scenario, or a value of a parameter is out of range.
/// MemoryError
///     This machine does not have the memory for so many actuators.
///
/// Examples
/// --------
///     >>> import mckibben, numpy
///     >>> scenario = mckibben.Scenario.from_dict({
///     ...     "supply": {"gauge_pressure": "100 psi"},
///     ...     "valve": {"preset": "matrix-eight-channel"},
///     ...     "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... })
///     >>> muscles = mckibben.Actuators(scenario, 3)
///     >>> length, velocity, tension = numpy.full(3, 0.085), numpy.zeros(3), numpy.zeros(3)
///     >>> duty = numpy.array([0.2, 0.5, 0.8])
///     >>> for _ in range(200):
///     ...     muscles.step(length, velocity, duty, 1e-3, tension)
///     >>> bool((numpy.diff(tension) > 0.0).all())
///     True
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Actuators {
    scenario: Py<Scenario>,
    name: Option<String>,
    parameters: Vec<String>,
    /// The values of the parameters, one actuator after the other.
    values: Vec<f64>,
    pulse_frequency: Option<f64>,
    model: Model,
    count: usize,
    many: Mutex<Many>,
}

/// The actuators, and where their ends are.
#[derive(Clone)]
struct Many {
    batch: PlantBatch,
    /// How far apart the ends are, in m.
    distances: Vec<f64>,
    /// What they must be less than, in m, and its name, where there is such a limit.
    reaches: Vec<Option<(&'static str, f64)>>,
}

impl Many {
    fn new(rows: Vec<PlantRow>, precision: Precision) -> Result<Self, Failure> {
        let distances = rows.iter().map(distance).collect();
        let reaches = rows.iter().map(|row| row.plant().end_distance(0)).collect::<Result<_, _>>()?;
        Ok(Self { batch: PlantBatch::with_precision(rows, precision)?, distances, reaches })
    }

    /// Does something with every actuator. Where that fails, nothing has changed.
    fn change(&mut self, does: impl FnMut(usize, &mut PlantSteps) -> Result<(), Failure>) -> Result<(), Failure> {
        self.batch.change(does)?;
        self.distances = self.batch.rows().into_iter().flatten().map(distance).collect();
        Ok(())
    }

    /// Takes on the distances that can be reached; the rows of those that cannot be, and why the first cannot.
    fn take(&mut self, lengths: &[f64]) -> (Vec<usize>, Option<Failure>) {
        let (mut rows, mut fault) = (Vec::new(), None);
        let both = self.distances.iter_mut().zip(&self.reaches);
        for (row, ((distance, limit), length)) in both.zip(lengths).enumerate() {
            match reach(*limit, "length", *length) {
                Ok(()) => *distance = *length,
                Err(failure) => {
                    rows.push(row);
                    fault = fault.or(Some(of_row(failure, row)));
                }
            }
        }
        (rows, fault)
    }

    /// Writes what all but some answer whose ends move at these velocities; why the first that has stopped did.
    fn respond(
        &mut self,
        (velocity, but): (&[f64], &[usize]),
        tension: &mut [f64],
        beside: [Option<&mut [f64]>; 3],
    ) -> Option<Failure> {
        if let Err(error) = self.batch.compute_at(&self.distances, velocity) {
            return Some(error.into());
        }
        let [mut per_length, mut per_velocity, mut absolute_pressure] = beside;
        let mut fault = None;
        for (row, tension) in tension.iter_mut().enumerate() {
            let response = match self.batch.responses(row) {
                Ok(_) if but.binary_search(&row).is_ok() => continue,
                Ok(response) => response[0],
                Err(error) => {
                    fault = fault.or_else(|| Some(of_row(error.into(), row)));
                    continue;
                }
            };
            *tension = response.tension;
            for (slice, value) in [(&mut per_length, response.per_length), (&mut per_velocity, response.per_velocity)] {
                if let Some(slice) = slice {
                    slice[row] = value;
                }
            }
            if let Some(slice) = &mut absolute_pressure {
                slice[row] = self.batch.pressure(row, 0).unwrap_or(slice[row]);
            }
        }
        fault
    }
}

/// What went wrong in a row.
fn of_row(failure: Failure, row: usize) -> Failure {
    failure.of(&format!("actuator {row}"))
}

/// Arrays that the rows' answers are written to.
struct Answers<'py>([Option<PyReadwriteArray1<'py, f64>>; 4]);

/// Those arrays as they are given: the tension, its derivatives with respect to length and velocity, and the pressure.
type Targets<'py> = [Option<Given<'py>>; 4];

impl<'py> Answers<'py> {
    fn of(given: &Targets<'py>, count: usize) -> PyResult<Self> {
        let mut arrays = [None, None, None, None];
        let names = ["tension", "per_length", "per_velocity", "absolute_pressure"];
        for ((array, given), name) in arrays.iter_mut().zip(given).zip(names) {
            if let Some(given) = given {
                let borrowed = given.write(name)?;
                fitting(name, borrowed.len(), count).or_exception()?;
                *array = Some(borrowed);
            }
        }
        Ok(Self(arrays))
    }

    /// The tension, which is always there, and the others.
    fn slices(&mut self) -> (&mut [f64], [Option<&mut [f64]>; 3]) {
        let [tension, others @ ..] = self.0.each_mut();
        // They are C-contiguous, or they would not have been borrowed.
        let tension = tension.as_mut().and_then(|array| array.as_slice_mut().ok()).unwrap_or_default();
        (tension, others.map(|array| array.as_mut().and_then(|array| array.as_slice_mut().ok())))
    }
}

/// Numbers that a step reads, one for each row.
fn read<'py>(name: &str, given: &Given<'py>, count: usize) -> PyResult<PyReadonlyArray1<'py, f64>> {
    let array = given.read(name)?;
    fitting(name, array.len(), count).or_exception()?;
    arguments::finite(name, array.as_slice()?).or_exception()?;
    Ok(array)
}

/// Refuses velocities that are none.
fn check_velocities(velocity: &[f64]) -> Result<(), Failure> {
    velocity.iter().enumerate().try_for_each(|(row, velocity)| check_velocity(&format!("velocity[{row}]"), *velocity))
}

/// Refuses a command that a valve does not take, before any valve is set.
fn check_commands(model: &Model, command: &[f64]) -> Result<(), Failure> {
    let of_row = |(row, command): (usize, &f64)| {
        let commanded = model.commanded(&format!("command[{row}]"), &ValveInput::Number(*command));
        commanded.map(drop).map_err(|failure| of_row(failure, row))
    };
    command.iter().enumerate().try_for_each(of_row)
}

/// Arguments of the constructor by place: scenario, count, name.
type StateIndices = (Py<Scenario>, usize, Option<String>);

/// An actuator for each row of values of these parameters.
fn varied<'v>(
    scenario: &Scenario,
    name: Option<&str>,
    parameters: &[String],
    values: impl Iterator<Item = &'v [f64]>,
    rows: &mut Vec<PlantRow>,
) -> Result<(), Failure> {
    if name.is_some() {
        let title =
            "`name` and `parameters` cannot both be given: paths of a joint's antagonist begin with `antagonist.`";
        return Err(Failure::input(title, "make the scenario of one actuator, and vary that"));
    }
    let (document, mut base) = (&scenario.document, scenario.of_one()?.open_loop());
    let paths = || parameters.iter().map(String::as_str);
    let place = |path| {
        document.find(path, paths(), &mut base).map_err(|error| Failure::input(error.to_string(), "mend `parameters`"))
    };
    let places = paths().map(place).collect::<Result<Vec<_>, _>>()?;
    let adjustable = Adjustable::new(base, places, document.says_of_each(parameter::MIN_LENGTH.key));
    for (row, values) in values.enumerate() {
        let steps = adjustable.at(values).and_then(|of| steps_of(&of.experiment()?));
        rows.push(steps.map_err(|error| of_row(error.into(), row))?.into());
    }
    Ok(())
}

impl Actuators {
    /// The actuators, unless another thread works on them.
    fn many(&self) -> PyResult<MutexGuard<'_, Many>> {
        match self.many.try_lock() {
            Ok(many) => Ok(many),
            Err(TryLockError::Poisoned(many)) => Ok(many.into_inner()),
            Err(TryLockError::WouldBlock) => Err(alone::busy("Actuators")),
        }
    }

    /// Does work on the threads of the pool where there are enough actuators, and else on the caller's own.
    fn share<T: Send>(&self, many: &mut Many, work: impl FnOnce(&mut Many) -> T + Send) -> Result<T, Failure> {
        pool::share(many.batch.is_much(1), |keeps| {
            many.batch.keep_to_thread(keeps);
            work(many)
        })
    }
}

/// Sections whose numbers change nothing of actuators that a caller moves and commands.
const IDLE: &[(&str, &str)] = &[
    ("command", "these actuators, whose valves `step` commands"),
    ("controller", "these actuators, whose valves `step` commands"),
    ("run", "these actuators, which take the steps of the caller"),
];

#[pymethods]
impl Actuators {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "each is given by its name")]
    #[pyo3(signature = (scenario, count, name = None, *, parameters = Texts::NONE, values = None, pulse_frequency = None, precision = PrecisionWord::from("double")))]
    fn new(
        py: Python<'_>,
        scenario: ScenarioArgument<'_>,
        count: Count,
        name: Option<MemberWord>,
        parameters: Texts<'_>,
        values: Option<Table<'_>>,
        pulse_frequency: Option<Quantity<'_>>,
        precision: PrecisionWord,
    ) -> PyResult<Self> {
        let scenario = scenario.0.unbind();
        let pulse_frequency = pulse_frequency.map(|it| it.si("pulse_frequency", FREQUENCY)).transpose()?;
        let precision = precision.read().or_exception()?;
        let (count, each, name) = (count.0, EACH, name.map(|name| name.0));
        let parameters = parameters.read("parameters")?;
        arguments::each_once("parameters", &parameters).or_exception()?;
        arguments::taking_part("parameters", &parameters, IDLE).or_exception()?;
        arguments::room(py, count, "actuators", each)?;
        let model = Model::of(scenario.get(), name.as_deref(), pulse_frequency).or_exception()?;
        let mut rows = Vec::new();
        rows.try_reserve_exact(count).map_err(|_| arguments::no_room(count, "actuators", each))?;
        let values = values.map(|values| values.copied("values")).transpose()?;
        let shape = values.as_ref().map(|values| values.shape.clone());
        let values = values.map(|values| values.entries).unwrap_or_default();
        let remedy = "give `values` as an array of shape (count, len(parameters)), in SI";
        if values.len() != count * parameters.len() {
            let title =
                format!("{} values are given for {count} actuators with {} parameters", values.len(), parameters.len());
            return Err(Failure::input(title, remedy)).or_exception();
        }
        if let Some(shape) = shape.filter(|shape| *shape != [count, parameters.len()] && !values.is_empty()) {
            let of = format!("{count} actuators with {} parameters", parameters.len());
            let title = format!("values of shape {} are given for {of}", arguments::tuple(&shape));
            return Err(Failure::input(title, remedy)).or_exception();
        }
        match parameters.len() {
            0 => rows.resize(count, model.steps.clone().into()),
            width => {
                arguments::finite_table("values", &values, width).or_exception()?;
                let (of, name) = (scenario.get(), name.as_deref());
                py.detach(|| varied(of, name, &parameters, values.chunks(width), &mut rows)).or_exception()?;
            }
        }
        let many = Mutex::new(py.detach(|| Many::new(rows, precision)).or_exception()?);
        Ok(Self { scenario, name, parameters, values, pulse_frequency, model, count, many })
    }

    /// Advance all actuators by one time step, in which the ends of each move to a new distance at constant velocity.
    ///
    /// Parameters
    /// ----------
    /// length : numpy.ndarray
    ///     Distances between the ends in m at the end of the step, above zero, with the tendon if there is one.
    /// velocity : numpy.ndarray
    ///     Velocities of the ends in m/s at the end of the step, between -1e6 and 1e6.
    /// command : numpy.ndarray or None
    ///     Commands of the valves: duty cycles from 0 to 1; of pressure regulators the set points, gauge pressures in Pa; of
    ///     proportional spools the positions from -1 to 1. With `None` the last commands continue.
    /// dt : float or str
    ///     Duration of the step in s, above zero, or text with a unit.
    /// tension : numpy.ndarray
    ///     Receives the tensions in N.
    /// per_length : numpy.ndarray, optional
    ///     Receives the derivatives of the tension with respect to the length at constant pressure, in N/m.
    /// per_velocity : numpy.ndarray, optional
    ///     Receives the derivatives of the tension with respect to the velocity, in N*s/m.
    /// absolute_pressure : numpy.ndarray, optional
    ///     Receives the absolute pressures in Pa.
    /// max_step : float or str, optional
    ///     Longest part of the step in s, or text with a unit, as of `Actuator.step`. By default the step is one part.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array or a number is not valid; nothing has changed.
    /// SimulationError
    ///     A length is out of reach: the ends of that actuator stay where they were. Or an actuator comes to a non-physical state:
    ///     it has stopped then, later steps raise as well, and only `reset` brings it back. Its elements of the results stay as
    ///     they are, and the others have advanced.
    ///
    /// Notes
    /// -----
    /// Ctrl-C ends a step of many parts; then all actuators are in their states before the step.
    #[pyo3(signature = (length, velocity, command, dt, tension, *, per_length = None, per_velocity = None, absolute_pressure = None,
        max_step = None))]
    #[expect(clippy::too_many_arguments, reason = "each is a separate array")]
    fn step<'py>(
        &self,
        py: Python<'py>,
        length: Given<'py>,
        velocity: Given<'py>,
        command: Option<Given<'py>>,
        dt: Quantity<'py>,
        tension: Given<'py>,
        per_length: Option<Given<'py>>,
        per_velocity: Option<Given<'py>>,
        absolute_pressure: Option<Given<'py>>,
        max_step: Option<Quantity<'py>>,
    ) -> PyResult<()> {
        let (model, count) = (&self.model, self.count);
        let dt = dt.si("dt", TIME)?;
        let max_step = max_step.map(|it| it.si("max_step", TIME)).transpose()?;
        check_dt(dt).or_exception()?;
        let longest = longest_part(max_step).or_exception()?;
        let length = read("length", &length, count)?;
        let velocity = read("velocity", &velocity, count)?;
        let command = command.map(|command| read("command", &command, count)).transpose()?;
        let mut answers = Answers::of(&[Some(tension), per_length, per_velocity, absolute_pressure], count)?;
        let (length, velocity) = (length.as_slice()?, velocity.as_slice()?);
        let command = command.as_ref().map(|command| command.as_slice()).transpose()?;
        if let Some(row) = length.iter().position(|length| *length <= 0.0) {
            return reach(None, &format!("length[{row}]"), length[row]).or_exception();
        }
        check_velocities(velocity).or_exception()?;
        check_commands(model, command.unwrap_or_default()).or_exception()?;
        let mut many = self.many()?;
        let many = &mut *many;
        many.batch.limit_step(longest).or_exception()?;
        let from = many.batch.time();
        let until = end_of_step(from, dt);
        let pulses = command.map_or(0.0, |_| 2.0 * dt * model.pulses.frequency);
        let parts = (many.batch.parts_until(until)).max((dt / longest).ceil().max(1.0) + pulses);
        check_parts(parts, dt).or_exception()?;
        let spans = (parts / PARTS_PER_CHECK).ceil().max((parts * count as f64 / PARTS_PER_CHECK_TOGETHER).ceil());
        let before = (spans > 1.0).then(|| many.clone());
        let line = |many: &Many| if spans > 1.0 { many.distances.clone() } else { Vec::new() };
        let begin = line(many);
        if let Some(command) = command {
            let commanded = |row: usize| model.commanded("command", &ValveInput::Number(command[row])).ok();
            let set = py.detach(|| self.share(many, |many| many.batch.set_each(0, commanded))).or_exception()?;
            set.map_err(|(row, error)| of_row(error.into(), row)).or_exception()?;
        }
        let (stay, out_of_reach) = many.take(length);
        let end = line(many);
        let mut span = 0.0;
        while span < spans {
            span += 1.0;
            let share = span / spans;
            let to = if share < 1.0 { from + share * (until - from) } else { until };
            for ((distance, begin), end) in many.distances.iter_mut().zip(&begin).zip(&end) {
                *distance = if share < 1.0 { begin + share * (end - begin) } else { *end };
            }
            let moved =
                py.detach(|| self.share(many, |many| many.batch.move_to(to, &many.distances))).or_exception()?;
            let checked = moved.or_exception().and_then(|()| if span < spans { py.check_signals() } else { Ok(()) });
            if let (Err(error), Some(before)) = (&checked, &before) {
                many.clone_from(before);
                return Err(error.clone_ref(py));
            }
            checked?;
        }
        let (tension, beside) = answers.slices();
        let of = (velocity, &stay[..]);
        let stopped = py.detach(|| self.share(many, |many| many.respond(of, tension, beside))).or_exception()?;
        stopped.or(out_of_reach).map_or(Ok(()), |failure| Err(exception(&failure)))
    }

    /// Write the tensions and their derivatives in the current states, at any velocity of the ends, without a step.
    ///
    /// Parameters
    /// ----------
    /// velocity : numpy.ndarray
    ///     Velocities of the ends in m/s, between -1e6 and 1e6.
    /// tension : numpy.ndarray
    ///     Receives the tensions in N.
    /// per_length : numpy.ndarray, optional
    ///     Receives the derivatives of the tension with respect to the length at constant pressure, in N/m.
    /// per_velocity : numpy.ndarray, optional
    ///     Receives the derivatives of the tension with respect to the velocity, in N*s/m.
    /// absolute_pressure : numpy.ndarray, optional
    ///     Receives the absolute pressures in Pa.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array or a number is not valid; nothing has changed.
    #[pyo3(signature = (velocity, tension, *, per_length = None, per_velocity = None, absolute_pressure = None))]
    fn respond<'py>(
        &self,
        py: Python<'py>,
        velocity: Given<'py>,
        tension: Given<'py>,
        per_length: Option<Given<'py>>,
        per_velocity: Option<Given<'py>>,
        absolute_pressure: Option<Given<'py>>,
    ) -> PyResult<()> {
        let velocity = read("velocity", &velocity, self.count)?;
        let mut answers = Answers::of(&[Some(tension), per_length, per_velocity, absolute_pressure], self.count)?;
        let velocity = velocity.as_slice()?;
        check_velocities(velocity).or_exception()?;
        let mut many = self.many()?;
        let many = &mut *many;
        let (tension, beside) = answers.slices();
        let of = (velocity, &[][..]);
        let stopped = py.detach(|| self.share(many, |many| many.respond(of, tension, beside))).or_exception()?;
        stopped.map_or(Ok(()), |failure| Err(exception(&failure)))
    }

    /// Reset all actuators to t = 0 and the state of the scenario, with the coils of the valves released.
    fn reset(&self) -> PyResult<()> {
        let reset = |_, steps: &mut PlantSteps| {
            steps.reset();
            Ok(())
        };
        self.many()?.change(reset).or_exception()
    }

    /// Return the number of actuators.
    fn __len__(&self) -> usize {
        self.count
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Actuators, {} of {:?}>", self.count, self.scenario.get().title())
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py, StateIndices>> {
        let precision = PrecisionWord::of(self.many()?.batch.precision());
        let mut named = BTreeMap::from([
            ("pulse_frequency", self.pulse_frequency.into_bound_py_any(py)?),
            ("precision", precision.into_bound_py_any(py)?),
        ]);
        if !self.parameters.is_empty() {
            let values = PyArray1::from_slice(py, &self.values).reshape([self.count, self.parameters.len()])?;
            named.insert("parameters", (&self.parameters).into_bound_py_any(py)?);
            named.insert("values", values.into_any());
        }
        Ok(((self.scenario.clone_ref(py), self.count, self.name.clone()), named))
    }

    /// Paths of the parameters that differ between the actuators.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.parameters.clone()
    }

    /// Return the states of the actuators, a row for each, as an `ActuatorState` is pickled.
    fn __getstate__<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        let mut numbers = Vec::new();
        let mut many = self.many()?;
        for row in 0..self.count {
            let actuator = many.batch.row(row).map_err(|error| of_row(error.into(), row)).or_exception()?;
            numbers.extend_from_slice(self.model.state_of(&mut actuator.to_steps()).or_exception()?.numbers());
        }
        let width = numbers.len() / self.count.max(1);
        Ok(Numbers(PyArray1::from_vec(py, numbers).reshape([self.count, width])?.into_any()))
    }

    fn __setstate__(&self, numbers: Table<'_>) -> PyResult<()> {
        let Copied { entries, shape } = numbers.copied("state")?;
        let width = shape.last().copied().unwrap_or_default().max(1);
        let states: Vec<ActuatorState> =
            entries.chunks(width).map(ActuatorState::of_numbers).collect::<Result<_, _>>().or_exception()?;
        if states.len() != self.count {
            let title = format!("{} states are given for {} actuators", states.len(), self.count);
            return Err(Failure::input(title, "give one for each")).or_exception();
        }
        if states.iter().any(|state| state.time() != states[0].time()) {
            let title = "the states are of different times, and actuators that are stepped together share one";
            return Err(Failure::input(title, "give states of one time")).or_exception();
        }
        // All of them are tried before any of the actuators is changed.
        let mut trial = self.model.steps.clone();
        states.iter().try_for_each(|state| self.model.restore(&mut trial, state)).or_exception()?;
        self.many()?.change(|row, steps| self.model.restore(steps, &states[row])).or_exception()
    }
}
