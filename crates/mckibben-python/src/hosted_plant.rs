//! The plant of a scenario whose ends a robot's simulator moves: the class `HostedPlant`, and the plugin for MuJoCo.

use crate::arguments;
use crate::exceptions::{OrException, exception};
use crate::pace::{Pace, Span};
use crate::scenario::Scenario;
use crate::typed::{Count, Matrix, Table};
use mckibben::Response;
use mckibben_run::failure::Failure;
use mckibben_run::host::{HostOptions, HostPlant};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

/// Register the plugin of MuJoCo with the MuJoCo that is loaded.
#[pyfunction]
pub(crate) fn _register_mujoco() -> PyResult<()> {
    let failed = |why: String| exception(&Failure::input(why, "see the chapter on MuJoCo of the documentation"));
    mckibben_mujoco::register().map_err(failed)
}

/// Plants of a scenario whose ends a simulator of your own moves: distances and commands in, tensions and pressures out.
///
/// All actuators of the scenario, with the air network that they share, are one plant. The loads and mechanisms of the scenario
/// are not used: the simulator moves the ends. `count` plants, each with its own state, are stepped together on all
/// cores.
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
/// pulse_frequency : float, optional
///     Frequency in Hz of the pulses of a duty cycle, above zero; by default that of the scenario's PWM.
/// max_step : float, optional
///     Longest part of a step in s, above zero: the air takes several in a long step. By default a step is one part.
///
/// Raises
/// ------
/// InputError
///     The scenario has a mistake, a valve does not take such commands, or an option is out of range.
///
/// Notes
/// -----
/// Take the tensions at t, make your own step with them, then call `step` with the new distances.
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
    plants: Vec<HostPlant>,
    responses: Vec<Response>,
    pace: Pace,
}

/// Memory that a plant takes at least, in bytes.
const EACH: usize = 4096;

impl HostedPlant {
    fn width(&self) -> usize {
        self.plants[0].actuators().len()
    }

    /// The numbers of a table with one row for each plant.
    fn rows<'a>(&self, name: &str, table: &'a numpy::PyReadonlyArray2<'_, f64>, width: usize) -> PyResult<&'a [f64]> {
        let wrong = || {
            let shape = format!("({}, {width})", self.plants.len());
            exception(&Failure::input(
                format!("`{name}` is no array of the shape {shape} without gaps"),
                "give one row for each plant",
            ))
        };
        let numbers = table.as_slice().map_err(|_| wrong())?;
        let [rows, columns] = [table.as_array().nrows(), table.as_array().ncols()];
        if rows != self.plants.len() || columns != width {
            return Err(wrong());
        }
        arguments::finite_table(name, numbers, width).or_exception()?;
        Ok(numbers)
    }

    /// Calls a function for each plant with its rows; the first failure, with the number of its plant.
    fn each(
        &mut self,
        py: Python<'_>,
        function: impl Fn(usize, &mut HostPlant) -> Result<(), Failure> + Sync,
    ) -> PyResult<()> {
        let plants = &mut self.plants;
        let count = plants.len();
        let of = |(at, plant): (usize, &mut HostPlant)| {
            function(at, plant).map_err(|failure| if count == 1 { failure } else { failure.of(&format!("plant {at}")) })
        };
        let done = py.detach(|| match count {
            1 => plants.iter_mut().enumerate().try_for_each(of),
            _ => plants.par_iter_mut().enumerate().try_for_each(of),
        });
        done.or_exception()
    }
}

#[pymethods]
impl HostedPlant {
    #[new]
    #[pyo3(signature = (scenario, count = Count(1), *, command_mode = None, pulse_frequency = None, max_step = None))]
    fn new(
        py: Python<'_>,
        scenario: &Scenario,
        count: Count,
        command_mode: Option<String>,
        pulse_frequency: Option<f64>,
        max_step: Option<f64>,
    ) -> PyResult<Self> {
        let options =
            HostOptions { command_mode: command_mode.as_deref(), pulse_frequency, max_step, ..HostOptions::default() };
        let mut plant = HostPlant::read(&scenario.document, &options).or_exception()?;
        if count.0 == 0 {
            return Err(exception(&Failure::input("count = 0 plants cannot be stepped", "give a count of 1 or more")));
        }
        arguments::room(py, count.0, "plants", EACH)?;
        let width = plant.actuators().len();
        let responses = (0..width).map(|at| plant.steps_mut().compute(at)).collect::<Result<_, _>>().or_exception()?;
        Ok(Self { plants: vec![plant; count.0], responses, pace: Pace::default() })
    }

    /// Names of the actuators, in the order of the columns of `distances`.
    #[getter]
    fn actuators(&self) -> Vec<String> {
        self.plants[0].actuators().to_vec()
    }

    /// Names of the commands, in the order of the columns of `commands`: actuator and mode.
    #[getter]
    fn commands(&self) -> Vec<String> {
        self.plants[0].commands().iter().map(|input| input.name.clone()).collect()
    }

    /// Names of what `observe` returns, with their units, such as "biceps.gauge_pressure_pa".
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.plants[0].outputs().iter().map(mckibben_scenario::PlantColumn::title).collect()
    }

    /// Number of plants.
    #[getter]
    fn count(&self) -> usize {
        self.plants.len()
    }

    /// Time in s since the start.
    #[getter]
    fn time(&self) -> f64 {
        self.plants[0].steps().time()
    }

    /// Distances between the ends in m where the plants are, of the shape (count, actuators).
    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        let width = self.width();
        let all = self.plants.iter().flat_map(|plant| (0..width).map(|at| plant.distance(at))).collect();
        matrix(py, all, self.plants.len(), width)
    }

    /// Begin at t = 0 with the ends at given distances, and all else as the scenario starts.
    ///
    /// Parameters
    /// ----------
    /// distances : ndarray
    ///     Distances between the ends in m, above zero, of the shape (count, actuators), with the tendon if there is one.
    /// velocities : ndarray
    ///     Their rates of change in m/s, of the same shape.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array has another shape, or an actuator cannot have such a distance.
    fn begin(&mut self, py: Python<'_>, distances: Table<'_>, velocities: Table<'_>) -> PyResult<()> {
        let (distances, velocities) = (distances.read("distances")?, velocities.read("velocities")?);
        let width = self.width();
        let distances = self.rows("distances", &distances, width)?;
        let velocities = self.rows("velocities", &velocities, width)?;
        self.pace = Pace::default();
        self.each(py, |at, plant| {
            let its = at * width..(at + 1) * width;
            plant.begin_at(&distances[its.clone()], &velocities[its])
        })
    }

    /// Return the tensions with the ends at given distances and velocities.
    ///
    /// Parameters
    /// ----------
    /// distances : ndarray
    ///     Distances between the ends in m, above zero, of the shape (count, actuators).
    /// velocities : ndarray
    ///     Their rates of change in m/s, of the same shape.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Tensions in N, zero or more, of the same shape.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array has another shape, or an actuator cannot have such a distance.
    fn compute<'py>(
        &mut self,
        py: Python<'py>,
        distances: Table<'py>,
        velocities: Table<'py>,
    ) -> PyResult<Matrix<'py>> {
        let (distances, velocities) = (distances.read("distances")?, velocities.read("velocities")?);
        let width = self.width();
        let distances = self.rows("distances", &distances, width)?;
        let velocities = self.rows("velocities", &velocities, width)?;
        let mut tensions = Vec::with_capacity(distances.len());
        for (at, plant) in self.plants.iter_mut().enumerate() {
            let its = at * width..(at + 1) * width;
            plant.compute_at(&distances[its.clone()], &velocities[its], &mut self.responses).or_exception()?;
            tensions.extend(self.responses.iter().map(|response| response.tension));
        }
        matrix(py, tensions, self.plants.len(), width)
    }

    /// Advance all plants by one time step, in which the ends go in straight lines to new distances.
    ///
    /// Parameters
    /// ----------
    /// distances : ndarray
    ///     Distances between the ends in m at the end of the step, above zero, of the shape (count, actuators).
    /// commands : ndarray
    ///     Commands of the valves during the step, of the shape (count, commands).
    /// dt : float
    ///     Duration of the step in s, above zero.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An array has another shape, or a valve does not take such a command.
    /// SimulationError
    ///     The step leads to a non-physical state. Other plants may have taken the step.
    fn step(&mut self, py: Python<'_>, distances: Table<'_>, commands: Table<'_>, dt: f64) -> PyResult<()> {
        crate::actuator::check_dt(dt).or_exception()?;
        let (distances, commands) = (distances.read("distances")?, commands.read("commands")?);
        let (width, inputs) = (self.width(), self.plants[0].commands().len());
        let distances = self.rows("distances", &distances, width)?;
        let commands = self.rows("commands", &commands, inputs)?;
        let pace = self.pace.on(Span { duration: dt, steps: 1 });
        let until = pace.now();
        self.each(py, |at, plant| {
            let its = &commands[at * inputs..(at + 1) * inputs];
            its.iter().enumerate().try_for_each(|(input, number)| plant.command(input, *number))?;
            plant.advance(until, &distances[at * width..(at + 1) * width])
        })?;
        // A step that was refused took no time.
        self.pace = pace;
        Ok(())
    }

    /// Return the outputs where the plants are, of the shape (count, columns).
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     What `columns` names, in SI.
    fn observe<'py>(&mut self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        let width = self.plants[0].outputs().len();
        let mut all = vec![0.0; self.plants.len() * width];
        for (plant, into) in self.plants.iter_mut().zip(all.chunks_mut(width.max(1))) {
            plant.read_outputs(into).or_exception()?;
        }
        matrix(py, all, self.plants.len(), width)
    }

    /// Return the states of all plants as numbers, of the shape (count, numbers of a state).
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     What `restore` takes; the order of the numbers may change from one version to the next.
    fn save<'py>(&mut self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        let width = self.plants[0].state_size();
        let mut all = vec![0.0; self.plants.len() * width];
        for (plant, into) in self.plants.iter_mut().zip(all.chunks_mut(width)) {
            plant.save(into).or_exception()?;
        }
        matrix(py, all, self.plants.len(), width)
    }

    /// Bring all plants back to states that plants of the same scenario have saved.
    ///
    /// Parameters
    /// ----------
    /// states : ndarray
    ///     States from `save`.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The numbers are no states of these plants.
    fn restore(&mut self, py: Python<'_>, states: Table<'_>) -> PyResult<()> {
        let states = states.read("states")?;
        let width = self.plants[0].state_size();
        let wrong =
            || Failure::input("`states` is no array that `save` has returned", "give such an array, of as many plants");
        let numbers = states.as_slice().map_err(|_| exception(&wrong()))?;
        if numbers.len() != self.plants.len() * width {
            return Err(wrong()).or_exception();
        }
        self.each(py, |at, plant| plant.restore(&numbers[at * width..(at + 1) * width]))?;
        self.pace = Pace::at(self.time());
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!(
            "<mckibben.HostedPlant, {} of {} at {:?} s>",
            self.plants.len(),
            self.actuators().join(", "),
            self.time()
        )
    }
}

/// Numbers as an array of so many rows.
fn matrix(py: Python<'_>, numbers: Vec<f64>, rows: usize, columns: usize) -> PyResult<Matrix<'_>> {
    Ok(Matrix(PyArray1::from_vec(py, numbers).reshape([rows, columns])?.into_any()))
}
