//! The plant of a scenario whose ends a robot's simulator moves: the class `HostedPlant`, and the plugin for MuJoCo.

use crate::actuator::{check_dt, check_parts, check_velocity, reach};
use crate::alone;
use crate::arguments;
use crate::exceptions::{OrException, exception};
use crate::pace::{PACE_PARTS, Pace, Span};
use crate::pool;
use crate::scenario::{Scenario, ScenarioArgument};
use crate::typed::{Copied, Count, FREQUENCY, Matrix, NewArguments, PrecisionWord, Quantity, Rows, TIME, Table};
use crate::vector_plant::{check_each_once, instances};
use mckibben_run::failure::Failure;
use mckibben_run::host::{HostBatch, HostOptions, HostPlant};
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

/// Register the plugin of MuJoCo with the MuJoCo that is loaded.
#[pyfunction]
pub(crate) fn _register_mujoco() -> PyResult<()> {
    let failed = |why: String| exception(&Failure::input(why, "see the chapter on MuJoCo of the documentation"));
    mckibben_mujoco::register().map_err(failed)
}

/// Plants of a scenario whose ends a simulator of your own moves: distances and commands in, tensions and pressures out.
///
/// All actuators of the scenario, with the air network that they share, are one plant. The loads and mechanisms of the scenario
/// are not used: the simulator moves the ends. Nor are `run.method` and `run.step`: every part of a step is one of the stable
/// method. `count` plants, each with its own state, are stepped together, side by side in the
/// vector registers of the processor; many of them on all cores. In double precision each is bit-identical to a plant alone; in single
/// precision the others of the batch change it by less than a millionth of its range.
///
/// Arrays have a row for each plant. Those of distances, velocities and commands are read in place, and are C-contiguous.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     A scenario of any kind.
/// count : int, optional
///     Number of plants; 1 by default.
/// command_mode : {"duty", "request", "position", "set-point"}, optional
///     What a command is: a duty cycle from 0 to 1; 1 to fill, 0 to hold, -1 to exhaust; the position of a proportional spool
///     from -1 to 1; the set point of a pressure regulator, a gauge pressure in Pa. By default what each valve takes.
/// pulse_frequency : float or str, optional
///     Frequency in Hz of the pulses of a duty cycle, above zero, or text with a unit; by default that of the scenario's PWM.
/// max_step : float or str, optional
///     Longest part of a step in s, above zero, or text with a unit: the air takes several in a long step. By default a step is one part.
/// precision : {"double", "single"}, optional
///     Numbers that the plants are stepped in; double by default. Single precision takes twice as many at once, and keeps seven digits of a
///     state: what a step changes below the last of them is lost. It needs a package that is built with the feature `f32`.
///
/// Raises
/// ------
/// InputError
///     The scenario has a mistake, a valve does not take such commands, or an option is out of range.
///
/// Notes
/// -----
/// Take the tensions at t, make your own step with them, then call `step` with the new distances. A copy, or a plant from a pickle,
/// continues bit-identically.
///
/// Examples
/// --------
/// A mass of 2 kg on a muscle that is filled:
///
///     >>> import mckibben, numpy
///     >>> scenario = mckibben.Scenario.from_dict({
///     ...     "supply": {"gauge_pressure": "100 psi"},
///     ...     "valve": {"preset": "matrix-eight-channel"},
///     ...     "command": {"kind": "fill"},
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "90 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... })
///     >>> plant = mckibben.HostedPlant(scenario, command_mode="request")
///     >>> distance, velocity, dt = numpy.array([[0.09]]), numpy.zeros((1, 1)), 1e-3
///     >>> plant.begin(distance, velocity)
///     >>> for _ in range(100):
///     ...     velocity += (9.81 - plant.compute(distance, velocity) / 2.0) * dt
///     ...     distance += velocity * dt
///     ...     plant.step(distance, numpy.ones((1, 1)), dt)
///     >>> bool(distance[0, 0] < 0.08), plant.commands
///     (True, ['actuator.request'])
#[pyclass(module = "mckibben")]
pub(crate) struct HostedPlant {
    scenario: Py<Scenario>,
    /// The arguments of the constructor, for pickling.
    command_mode: Option<String>,
    pulse_frequency: Option<f64>,
    max_step: Option<f64>,
    precision: PrecisionWord,
    batch: HostBatch,
    /// A plant on which starts and saved states are tried.
    trial: HostPlant,
    pace: Pace,
}

/// Numbers of a saved state before those of the plant: the mark, and the clock.
const HEAD: usize = 1 + PACE_PARTS;

/// Share of a time by which two clocks at one instant may differ.
const ROUNDING: f64 = 1e-9;

/// Name of the class, for messages.
const CLASS: &str = "HostedPlant";

/// Memory that a plant takes at least, in bytes.
const EACH: usize = 4096;

/// Parts of a step between two checks for Ctrl-C. It does not depend on the number of plants, so that each goes on as alone.
const PARTS_PER_CHECK: f64 = 1000.0;

impl HostedPlant {
    fn width(&self) -> usize {
        self.batch.model().actuators().len()
    }

    /// Distances between the ends and their velocities, with one row for each of so many plants.
    fn ends<'a>(
        &self,
        count: usize,
        distances: &'a numpy::PyReadonlyArray2<'_, f64>,
        velocities: &'a numpy::PyReadonlyArray2<'_, f64>,
    ) -> PyResult<[&'a [f64]; 2]> {
        let distances = self.distances_of(count, distances)?;
        let width = self.width();
        let velocities = table("velocities", velocities, count, width)?;
        let check = |(at, velocity): (usize, &f64)| check_velocity(&element("velocities", at, width), *velocity);
        velocities.iter().enumerate().try_for_each(check).or_exception()?;
        Ok([distances, velocities])
    }

    /// Distances between the ends, with one row for each of so many plants.
    fn distances_of<'a>(&self, count: usize, distances: &'a numpy::PyReadonlyArray2<'_, f64>) -> PyResult<&'a [f64]> {
        let width = self.width();
        let distances = table("distances", distances, count, width)?;
        let check = |(at, distance): (usize, &f64)| reach(None, &element("distances", at, width), *distance);
        distances.iter().enumerate().try_for_each(check).or_exception()?;
        Ok(distances)
    }

    /// Numbers of a saved state: the mark, the clock, and those of the plant.
    fn state_size(&self) -> usize {
        HEAD + self.batch.state_size()
    }

    /// The states of all plants as numbers, each behind the mark and the clock.
    fn saved<'py>(&mut self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        let (width, count) = (self.state_size(), self.batch.count());
        let mut numbers = vec![0.0; count * (width - HEAD)];
        self.batch.save(&mut numbers).or_exception()?;
        let [origin, duration, spans] = self.pace.parts();
        let head = [self.batch.model().mark(), origin, duration, spans];
        let all = numbers.chunks(width - HEAD).flat_map(|row| head.into_iter().chain(row.iter().copied())).collect();
        matrix(py, all, count, width)
    }

    /// The clock of a saved state, which is at the time of the plant there.
    fn clock_of(&mut self, state: &[f64]) -> Option<Pace> {
        let (head, numbers) = state.split_at_checked(HEAD)?;
        let pace = Pace::of_parts(head[1..].try_into().ok()?)?;
        // A state that the plant refuses is reported by the batch.
        let time = self.trial.restore(numbers).map_or(pace.now(), |()| self.trial.steps().time());
        ((time - pace.now()).abs() <= ROUNDING * time.abs()).then_some(pace)
    }

    /// Brings all plants back to states that were saved.
    fn bring_back(&mut self, py: Python<'_>, states: &Table<'_>) -> PyResult<()> {
        let Copied { entries, shape } = states.copied("states")?;
        let width = self.state_size();
        if shape.len() != 2 || shape[0] != self.batch.count() || shape[1] == 0 {
            let title = "`states` is no array that `save` has returned";
            return Err(Failure::input(title, "give such an array, of as many plants")).or_exception();
        }
        for (row, its) in entries.chunks(shape[1]).enumerate() {
            self.batch.model().check_mark(&format!("states[{row}]"), its[0]).or_exception()?;
        }
        if shape[1] != width {
            let title = format!("`states` has {} numbers for each plant, whose state is {width}", shape[1]);
            return Err(Failure::input(title, "give an array that this version of `save` has returned")).or_exception();
        }
        let Some(pace) = self.clock_of(&entries[..width]) else {
            let remedy = "give an array that `save` has returned";
            return Err(Failure::input("states[0] has a clock that is not at its time", remedy)).or_exception();
        };
        let numbers: Vec<f64> = entries.chunks(width).flat_map(|its| &its[HEAD..]).copied().collect();
        self.share(py, |batch| batch.restore(&numbers))?;
        self.pace = pace;
        Ok(())
    }

    /// Does work on the threads of the pool where there are enough plants, and else on the caller's own.
    fn share(
        &mut self,
        py: Python<'_>,
        work: impl FnOnce(&mut HostBatch) -> Result<(), Failure> + Send,
    ) -> PyResult<()> {
        let (is_much, batch) = (self.batch.is_much(), &mut self.batch);
        let on_threads = |keeps| {
            batch.keep_to_thread(keeps);
            work(batch)
        };
        py.detach(|| pool::share(is_much, on_threads)?).or_exception()
    }

    /// Parts of a step of so many s, and edges of the pulses in it.
    fn parts(&self, dt: f64) -> f64 {
        let parts = self.max_step.map_or(1.0, |longest| (dt / longest).ceil().max(1.0));
        let commands = self.batch.model().commands().iter();
        let fastest = commands.filter_map(|input| input.mode.pulse_frequency()).fold(0.0, f64::max);
        parts + 2.0 * dt * fastest
    }

    /// Advances all plants along straight lines in several spans, and checks for Ctrl-C between them.
    fn advance_in_spans(
        &mut self,
        py: Python<'_>,
        spans: u64,
        until: f64,
        distances: &[f64],
        commands: &[f64],
    ) -> PyResult<()> {
        let (from, begin) = (self.pace.now(), self.batch.distances().to_vec());
        self.share(py, |batch| batch.command(commands))?;
        for span in 1..spans {
            let share = span as f64 / spans as f64;
            let ends: Vec<f64> =
                begin.iter().zip(distances).map(|(begin, end)| begin + share * (end - begin)).collect();
            self.share(py, |batch| batch.advance(from + share * (until - from), &ends))?;
            py.check_signals()?;
        }
        self.share(py, |batch| batch.advance(until, distances))
    }

    /// What has stopped the first plant that has stopped.
    fn check(&self) -> PyResult<()> {
        self.batch.first_failure().map_or(Ok(()), |failure| Err(exception(&failure)))
    }
}

#[pymethods]
impl HostedPlant {
    #[new]
    #[pyo3(signature = (scenario, count = Count(1), *, command_mode = None, pulse_frequency = None, max_step = None, precision = PrecisionWord::from("double")))]
    fn new(
        py: Python<'_>,
        scenario: ScenarioArgument<'_>,
        count: Count<1>,
        command_mode: Option<String>,
        pulse_frequency: Option<Quantity<'_>>,
        max_step: Option<Quantity<'_>>,
        precision: PrecisionWord,
    ) -> PyResult<Self> {
        let scenario = scenario.0.unbind();
        let pulse_frequency = pulse_frequency.map(|it| it.si("pulse_frequency", FREQUENCY)).transpose()?;
        let max_step = max_step.map(|it| it.si("max_step", TIME)).transpose()?;
        let options =
            HostOptions { command_mode: command_mode.as_deref(), pulse_frequency, max_step, ..HostOptions::default() };
        let plant = HostPlant::read(&scenario.get().document, &options).or_exception()?;
        arguments::room(py, count.0, "plants", EACH)?;
        let (trial, pace) = (plant.clone(), Pace::default());
        let batch = HostBatch::with_precision(std::iter::repeat_n(plant, count.0), precision.read().or_exception()?)
            .or_exception()?;
        Ok(Self { scenario, command_mode, pulse_frequency, max_step, precision, batch, trial, pace })
    }

    /// Names of the actuators, in the order of the columns of `distances`.
    #[getter]
    fn actuators(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.batch.model().actuators().to_vec())
    }

    /// Names of the commands, in the order of the columns of `commands`: actuator and mode.
    #[getter]
    fn commands(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.batch.model().commands().iter().map(|input| input.name.clone()).collect())
    }

    /// Names of what `observe` returns, with their units, such as "biceps.gauge_pressure_pa".
    #[getter]
    fn columns(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.batch.model().outputs().iter().map(mckibben_scenario::PlantColumn::title).collect())
    }

    /// Number of plants.
    #[getter]
    fn count(this: &Bound<'_, Self>) -> PyResult<usize> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.batch.count())
    }

    /// Time in s since the start.
    #[getter]
    fn time(this: &Bound<'_, Self>) -> PyResult<f64> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.batch.time())
    }

    /// Distances between the ends in m where the plants are, of the shape (count, actuators).
    #[getter]
    fn distances<'py>(this: &Bound<'py, Self>, py: Python<'py>) -> PyResult<Matrix<'py>> {
        let plants = alone::to_read(this, CLASS)?;
        matrix(py, plants.batch.distances().to_vec(), plants.batch.count(), plants.width())
    }

    /// Begin at t = 0 with the ends at given distances, and all else as the scenario starts.
    ///
    /// Parameters
    /// ----------
    /// distances : ndarray
    ///     Distances between the ends in m, above zero, of the shape (count, actuators), with the tendon if there is one.
    /// velocities : ndarray
    ///     Their rates of change in m/s, between -1e6 and 1e6, of the shape of `distances`.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array has another shape or is not C-contiguous, an actuator cannot have such a distance, or a velocity is out of
    ///     range.
    /// TypeError
    ///     An array is not one of float64 with two dimensions.
    fn begin(this: &Bound<'_, Self>, py: Python<'_>, distances: Table<'_>, velocities: Table<'_>) -> PyResult<()> {
        let plants = &mut *alone::to_change(this, CLASS)?;
        let (distances, velocities) = (distances.read("distances")?, velocities.read("velocities")?);
        let [distances, velocities] = plants.ends(plants.batch.count(), &distances, &velocities)?;
        plants.share(py, |batch| batch.begin_at(distances, velocities))?;
        plants.pace = Pace::default();
        Ok(())
    }

    /// Begin some plants again, without a command to their valves, while the others continue.
    ///
    /// They begin with the ends at given distances, and all else as the scenario starts. The clock continues. Plants that have
    /// stopped begin again as well.
    ///
    /// Parameters
    /// ----------
    /// rows : ndarray
    ///     Indices of the plants, int64, from 0, each once.
    /// distances : ndarray
    ///     Distances between the ends in m, above zero, of the shape (len(rows), actuators), with the tendon if there is one.
    /// velocities : ndarray
    ///     Their rates of change in m/s, between -1e6 and 1e6, of the shape of `distances`.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     There is no such plant, an index is given twice, an array has another shape or is not C-contiguous, an actuator cannot
    ///     have such a distance, or a velocity is out of range; nothing has changed.
    /// TypeError
    ///     An array of distances or velocities is not one of float64 with two dimensions, or `rows` not one of int64 with one;
    ///     nothing has changed.
    fn restart(
        this: &Bound<'_, Self>,
        py: Python<'_>,
        rows: Rows<'_>,
        distances: Table<'_>,
        velocities: Table<'_>,
    ) -> PyResult<()> {
        let plants = &mut *alone::to_change(this, CLASS)?;
        let rows = instances(&rows, plants.batch.count())?;
        check_each_once(&rows).or_exception()?;
        let (distances, velocities) = (distances.read("distances")?, velocities.read("velocities")?);
        let [distances, velocities] = plants.ends(rows.len(), &distances, &velocities)?;
        let width = plants.width();
        let its = |at: usize| (&distances[width * at..width * (at + 1)], &velocities[width * at..width * (at + 1)]);
        if rows.len() > 1 {
            // Each start is tried before any plant begins again.
            for (at, row) in rows.iter().enumerate() {
                let tried = plants.trial.begin_at(its(at).0, its(at).1);
                tried.map_err(|failure| failure.of(&format!("plant {row}"))).or_exception()?;
            }
        }
        plants.share(py, |batch| {
            rows.iter().enumerate().try_for_each(|(at, row)| batch.begin_row(*row, its(at).0, its(at).1))
        })
    }

    /// Return the tensions with the ends at given distances and velocities.
    ///
    /// Parameters
    /// ----------
    /// distances : ndarray
    ///     Distances between the ends in m, above zero, of the shape (count, actuators).
    /// velocities : ndarray
    ///     Their rates of change in m/s, between -1e6 and 1e6, of the shape of `distances`.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Tensions in N, zero or more, of the shape (count, actuators).
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array has another shape or is not C-contiguous, an actuator cannot have such a distance, or a velocity is out of
    ///     range.
    /// TypeError
    ///     An array is not one of float64 with two dimensions.
    /// SimulationError
    ///     A plant has stopped.
    fn compute<'py>(
        this: &Bound<'py, Self>,
        py: Python<'py>,
        distances: Table<'py>,
        velocities: Table<'py>,
    ) -> PyResult<Matrix<'py>> {
        let plants = &mut *alone::to_change(this, CLASS)?;
        let (distances, velocities) = (distances.read("distances")?, velocities.read("velocities")?);
        let [distances, velocities] = plants.ends(plants.batch.count(), &distances, &velocities)?;
        plants.share(py, |batch| batch.compute_at(distances, velocities))?;
        let mut tensions = Vec::with_capacity(distances.len());
        for row in 0..plants.batch.count() {
            let responses = plants.batch.responses(row).or_exception()?;
            tensions.extend(responses.iter().map(|response| response.tension));
        }
        matrix(py, tensions, plants.batch.count(), plants.width())
    }

    /// Advance all plants by one time step, in which the ends go in straight lines to new distances.
    ///
    /// Parameters
    /// ----------
    /// distances : ndarray
    ///     Distances between the ends in m at the end of the step, above zero, of the shape (count, actuators).
    /// commands : ndarray
    ///     Commands of the valves during the step, of the shape (count, commands).
    /// dt : float or str
    ///     Duration of the step in s, above zero, or text with a unit.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array has another shape or is not C-contiguous, a valve does not take such a command, or there are more than
    ///     10 000 000 parts and edges of pulses; no plant has moved.
    /// TypeError
    ///     An array is not one of float64 with two dimensions; no plant has moved.
    /// SimulationError
    ///     The step leads a plant to a non-physical state. The others have taken the step. That plant has stopped: until `begin` or
    ///     `restore`, its later steps raise as well.
    ///
    /// Notes
    /// -----
    /// Ctrl-C ends a step of many parts; then all plants are in their states before the step.
    fn step(
        this: &Bound<'_, Self>,
        py: Python<'_>,
        distances: Table<'_>,
        commands: Table<'_>,
        dt: Quantity<'_>,
    ) -> PyResult<()> {
        let dt = dt.si("dt", TIME)?;
        let plants = &mut *alone::to_change(this, CLASS)?;
        check_dt(dt).or_exception()?;
        let (distances, commands) = (distances.read("distances")?, commands.read("commands")?);
        let (count, inputs) = (plants.batch.count(), plants.batch.model().commands().len());
        let distances = plants.distances_of(count, &distances)?;
        let commands = table("commands", &commands, count, inputs)?;
        let pace = plants.pace.on(Span { duration: dt, steps: 1 });
        let until = pace.now();
        let parts = plants.parts(dt);
        check_parts(parts, dt).or_exception()?;
        let spans = (parts / PARTS_PER_CHECK).ceil().max(1.0) as u64;
        match spans {
            1 => plants.share(py, |batch| {
                batch.command(commands)?;
                batch.advance(until, distances)
            })?,
            _ => {
                let before = plants.batch.clone();
                if let Err(error) = plants.advance_in_spans(py, spans, until, distances, commands) {
                    plants.batch = before;
                    return Err(error);
                }
            }
        }
        // A step that was refused took no time.
        plants.pace = pace;
        plants.check()
    }

    /// Refuse commands that a valve does not take, before a step.
    fn _check_commands(this: &Bound<'_, Self>, commands: Table<'_>) -> PyResult<()> {
        let plants = alone::to_read(this, CLASS)?;
        let commands = commands.read("commands")?;
        let (count, inputs, model) =
            (plants.batch.count(), plants.batch.model().commands().len(), plants.batch.model());
        let check = |(at, number): (usize, &f64)| {
            let of_row = |failure: Failure| match count {
                1 => failure,
                _ => failure.of(&format!("plant {}", at / inputs)),
            };
            model.check_command(at % inputs, *number).map(drop).map_err(of_row)
        };
        table("commands", &commands, count, inputs)?.iter().enumerate().try_for_each(check).or_exception()
    }

    /// Return the outputs where the plants are, of the shape (count, columns).
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     What `columns` names, in SI.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     A plant has stopped.
    fn observe<'py>(this: &Bound<'py, Self>, py: Python<'py>) -> PyResult<Matrix<'py>> {
        let plants = &mut *alone::to_change(this, CLASS)?;
        let width = plants.batch.model().outputs().len();
        let mut all = vec![0.0; plants.batch.count() * width];
        plants.share(py, |batch| batch.read_outputs(&mut all))?;
        plants.check()?;
        matrix(py, all, plants.batch.count(), width)
    }

    /// Return the states of all plants as numbers, of the shape (count, numbers of a state).
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     What `restore` takes. The first number of each row is a mark of the scenario and the commands; the order of the others,
    ///     among them the clock, may change from one version to the next.
    fn save<'py>(this: &Bound<'py, Self>, py: Python<'py>) -> PyResult<Matrix<'py>> {
        alone::to_change(this, CLASS)?.saved(py)
    }

    /// Bring all plants back to states that plants of an equal scenario have saved. They continue bit-identically.
    ///
    /// The scenarios may differ in `command`, `controller`, `initial`, `load`, `mechanism` and `run`.
    ///
    /// Parameters
    /// ----------
    /// states : ndarray
    ///     States from `save`, of any memory layout.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The numbers are no states of these plants, or are states of plants of another scenario, command mode or pulse
    ///     frequency; nothing has changed.
    /// TypeError
    ///     The states are no array of float64 with two dimensions; nothing has changed.
    fn restore(this: &Bound<'_, Self>, py: Python<'_>, states: Table<'_>) -> PyResult<()> {
        alone::to_change(this, CLASS)?.bring_back(py, &states)
    }

    /// Scenario of the plants.
    #[getter]
    fn scenario(this: &Bound<'_, Self>, py: Python<'_>) -> PyResult<Py<Scenario>> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(plants.scenario.clone_ref(py))
    }

    fn __getnewargs_ex__<'py>(
        this: &Bound<'py, Self>,
        py: Python<'py>,
    ) -> PyResult<NewArguments<'py, (Py<Scenario>, usize)>> {
        let plants = alone::to_read(this, CLASS)?;
        let named = [
            ("command_mode", (&plants.command_mode).into_bound_py_any(py)?),
            ("pulse_frequency", plants.pulse_frequency.into_bound_py_any(py)?),
            ("max_step", plants.max_step.into_bound_py_any(py)?),
            ("precision", plants.precision.clone().into_bound_py_any(py)?),
        ];
        Ok(((plants.scenario.clone_ref(py), plants.batch.count()), named.into()))
    }

    /// Return the states of the plants.
    fn __getstate__<'py>(this: &Bound<'py, Self>, py: Python<'py>) -> PyResult<Matrix<'py>> {
        alone::to_change(this, CLASS)?.saved(py)
    }

    fn __setstate__(this: &Bound<'_, Self>, py: Python<'_>, state: Table<'_>) -> PyResult<()> {
        alone::to_change(this, CLASS)?.bring_back(py, &state)
    }

    fn __repr__(this: &Bound<'_, Self>) -> PyResult<String> {
        let plants = alone::to_read(this, CLASS)?;
        Ok(format!(
            "<mckibben.HostedPlant, {} of {} at {:?} s>",
            plants.batch.count(),
            plants.batch.model().actuators().join(", "),
            plants.batch.time()
        ))
    }
}

/// The numbers of a table of so many rows and columns.
fn table<'a>(
    name: &str,
    table: &'a numpy::PyReadonlyArray2<'_, f64>,
    rows: usize,
    width: usize,
) -> PyResult<&'a [f64]> {
    arguments::shaped(name, "float64", table.shape(), &[rows, width]).or_exception()?;
    let numbers = table.as_slice()?;
    arguments::finite_table(name, numbers, width).or_exception()?;
    Ok(numbers)
}

/// The name of an element of a table of so many columns.
fn element(name: &str, at: usize, width: usize) -> String {
    format!("{name}[{}, {}]", at / width, at % width)
}

/// Numbers as an array of so many rows.
fn matrix(py: Python<'_>, numbers: Vec<f64>, rows: usize, columns: usize) -> PyResult<Matrix<'_>> {
    Ok(Matrix(PyArray1::from_vec(py, numbers).reshape([rows, columns])?.into_any()))
}
