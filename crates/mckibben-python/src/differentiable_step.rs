//! A step of the modular actuator as a function with an exact Jacobian: the class `DifferentiableStep`.
//!
//! ```text
//! (x, L, v, u)  →  (x′, F)        x, x′  numbers of the state before and after the step
//!                                 L, v   distance and velocity of the ends at the end of the step
//!                                 u      command of the valve,  F  tension at the end of the step
//! ```
//!
//! The derivatives are those of the step itself, over dual numbers: instants of poppets and pulses, and events of friction, move
//! with what determines them. Since `x` is all that a step continues from, Jacobians of successive steps multiply.
//!
//! For that a set point or a position is a new one in each step, also where it equals the one that holds. A valve that is
//! set again to what it has would go on with the number in `x`. Equality has no derivative: with respect to `x` the step would
//! follow the old number, with respect to `u` the new one, and both would count.

use crate::actuator::{
    Actuator, ActuatorState, Model, PARTS_PER_CHECK, check_dt, check_length, check_velocity, longest_part, respond,
};
use crate::exceptions::OrException;
use crate::python;
use crate::typed::{Function, LENGTH, Line, NewArguments, Numbers, Quantity, TIME, VELOCITY, Value};
use mckibben::plant::{PlantRun, PlantSteps};
use mckibben::valve::RuntimeCommand;
use mckibben::{DIRECTIONS, Error, GaugePressure, Instantiate, Over, Seeded};
use mckibben_run::failure::Failure;
use mckibben_run::host::end_of_step;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

/// One step of an actuator as a function of its state, the motion of its ends and its command, with the exact Jacobian.
///
/// An instance is called with an array of inputs, and returns an array of outputs. The inputs are the numbers of the state, then
/// "length" in m and "velocity" in m/s of the ends at the end of the step, then "command" where the actuator has a valve. The
/// outputs are the numbers of the state after the step, then "tension" in N. The Jacobian accounts for poppets and pulses that
/// move, and friction that turns, within the step.
///
/// Parameters
/// ----------
/// actuator : Actuator
///     Actuator whose step it is.
/// dt : float or str
///     Duration of the step in s, above zero, or text with a unit.
/// max_step : float or str, optional
///     Longest part of the step in s, or text with a unit, as of `Actuator.step`. By default the step is one part.
///
/// Raises
/// ------
/// InputError
///     `dt` or `max_step` is out of range.
///
/// Notes
/// -----
/// The names of the state's numbers are "state.time" (s), "state.absolute_pressure" (Pa), "state.air_mass" (kg), "state.length"
/// (m) and "state.velocity" (m/s); all others are "state[1]", "state[2]" and so on by their place: what friction remembers,
/// instants at which poppets move, pulses. Numbers that stand for something discrete, such as an open port, have derivatives of
/// zero. Jacobians of successive steps multiply to that of the whole motion. Where an event or an edge of a pulse lies exactly at the
/// end of a step, the derivatives are those of one side.
///
/// A command is a duty cycle from 0 to 1, of a pressure regulator a gauge pressure in Pa, of a proportional spool a position from
/// -1 to 1. A duty cycle takes effect when the next pulse begins. A set point and a position are new ones in each step, also where
/// they equal those before, so that each has its own derivatives. `Actuator.step` goes on with an equal one: its results differ by
/// rounding, and with a dead time that is no multiple of `dt` as those of a step that is divided there. At most 64 commands may be
/// on their way: with a dead time of more steps give a longer `dt`.
///
/// Examples
/// --------
/// The pressure and the tension of a closed muscle rise with its length:
///
///     >>> import mckibben
///     >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... }))
///     >>> step = mckibben.DifferentiableStep(muscle, 1e-3)
///     >>> outputs, jacobian = step.value_and_jacobian(step.pack(muscle.start(), 0.0851, 0.1))
///     >>> pressure, length = step.outputs.index("state.absolute_pressure"), step.inputs.index("length")
///     >>> bool(jacobian[pressure, length] > 0.0), bool(jacobian[-1, length] > 0.0)
///     (True, True)
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct DifferentiableStep {
    actuator: Py<Actuator>,
    dt: f64,
    max_step: Option<f64>,
    longest: f64,
    /// Where steps over dual numbers begin; each call has a copy.
    seeded: PlantSteps<Seeded>,
    states: Vec<String>,
}

/// The steps of a model over dual numbers without derivatives.
fn seeded(model: &Model) -> Result<PlantSteps<Seeded>, Error> {
    let plant = model.steps.plant().map(|_, _, value| Seeded::of(value));
    let start = model.begin.map(|_, value| Seeded::of(value));
    Ok(PlantRun::new(&plant, &start, crate::actuator::TOLERANCE)?.steps(model.steps.method()))
}

/// Names of the numbers of a state.
fn states(model: &Model) -> Vec<String> {
    let places = model.steps.plant().indices();
    let (air, motion) = (places.actuators[0], &places.mechanisms[0]);
    let mut names: Vec<String> = (0..model.size).map(|place| format!("state[{place}]")).collect();
    // The time comes first, then the states of the plant.
    names[0] = "state.time".to_owned();
    let known = [
        (air.pressure, "absolute_pressure"),
        (air.mass(), "air_mass"),
        (motion.position(0), "length"),
        (motion.rate(0), "velocity"),
    ];
    known.into_iter().for_each(|(place, name)| names[1 + place] = format!("state.{name}"));
    names
}

/// A command over dual numbers: its number is `number`.
fn seeded_command(command: RuntimeCommand, number: Seeded) -> RuntimeCommand<Seeded> {
    match command {
        RuntimeCommand::Request(request) => RuntimeCommand::Request(request),
        RuntimeCommand::Pulses { frequency, pulse, rest, .. } => {
            RuntimeCommand::Pulses { frequency: Seeded::of(frequency), duty: number, pulse, rest }
        }
        RuntimeCommand::SetPoint(_) => RuntimeCommand::SetPoint(GaugePressure(number)),
        RuntimeCommand::Position(_) => RuntimeCommand::Position(number),
    }
}

/// Sets the valve, as a new command also where it is the one that holds: of two commands at one instant the later counts,
/// and the earlier is another one here.
fn set_as_new<R: Instantiate>(steps: &mut PlantSteps<R>, command: RuntimeCommand<R>) -> Result<(), Error> {
    // Between zero and the number, so that the valve takes it.
    let other = |number: R| R::constant(if number.value() == 0.0 { f64::MIN_POSITIVE } else { 0.5 * number.value() });
    match command {
        RuntimeCommand::SetPoint(gauge) => steps.set(0, RuntimeCommand::SetPoint(GaugePressure(other(gauge.0))))?,
        RuntimeCommand::Position(position) => steps.set(0, RuntimeCommand::Position(other(position)))?,
        // A request has no number, and a duty cycle replaces the one before in any case.
        RuntimeCommand::Request(_) | RuntimeCommand::Pulses { .. } => {}
    }
    steps.set(0, command)
}

impl DifferentiableStep {
    fn model(&self) -> &Model {
        &self.actuator.get().model
    }

    fn has_valve(&self) -> bool {
        !self.model().steps.plant().network().valves.is_empty()
    }

    /// How many inputs there are.
    fn width(&self) -> usize {
        self.states.len() + 2 + usize::from(self.has_valve())
    }

    /// The command among the inputs, checked with the other inputs.
    fn command(&self, values: &[f64]) -> Result<Option<RuntimeCommand>, Failure> {
        if values.len() != self.width() {
            return Err(Failure::input(
                format!("{} values were given for {} inputs", values.len(), self.width()),
                "give those of `pack`: the numbers of the state, length, velocity and, with a valve, the command",
            ));
        }
        let (model, motion) = (self.model(), &values[self.states.len()..]);
        check_length(&model.steps, "length", motion[0])?;
        check_velocity("velocity", motion[1])?;
        motion.get(2).map(|number| model.command("command", *number)).transpose()
    }

    /// Ends a step of too many parts before it begins.
    fn check_parts(parts: f64) -> Result<(), Failure> {
        if parts <= PARTS_PER_CHECK {
            return Ok(());
        }
        Err(Failure::input(
            format!("the step would have {parts:.0} parts, more than {PARTS_PER_CHECK:.0}"),
            "give a smaller dt, a lower pulse_frequency or a longer max_step",
        ))
    }

    /// The outputs.
    fn outputs_at(&self, values: &[f64]) -> Result<Vec<f64>, Failure> {
        let command = self.command(values)?;
        let (numbers, motion) = values.split_at(self.states.len());
        let mut steps = self.model().steps.clone();
        steps.restore_from(numbers)?;
        command.map_or(Ok(()), |command| set_as_new(&mut steps, command))?;
        steps.limit_step(self.longest)?;
        let until = end_of_step(steps.time(), self.dt);
        Self::check_parts(steps.parts_until(until))?;
        steps.move_to(until, &[motion[0]])?;
        let mut outputs = vec![0.0; self.states.len() + 1];
        let (state, tension) = outputs.split_at_mut(numbers.len());
        steps.save_to(state)?;
        tension[0] = respond(&mut steps, motion[1])?.tension;
        Ok(outputs)
    }

    /// The Jacobian, row by row. The values have been checked.
    fn jacobian_at(&self, values: &[f64]) -> Result<Vec<f64>, Failure> {
        let (width, command) = (self.width(), self.command(values)?);
        let states = self.states.len();
        let mut jacobian = vec![0.0; (states + 1) * width];
        let mut steps = self.seeded.clone();
        let mut outputs = vec![Seeded::of(0.0); states + 1];
        for first in (0..width).step_by(DIRECTIONS) {
            let seed = |(place, value): (usize, &f64)| match place.checked_sub(first) {
                Some(direction) if direction < DIRECTIONS => Seeded::variable(*value, direction),
                _ => Seeded::of(*value),
            };
            let inputs: Vec<Seeded> = values.iter().enumerate().map(seed).collect();
            let (numbers, motion) = inputs.split_at(states);
            steps.restore_from(numbers)?;
            if let Some((command, number)) = command.zip(motion.get(2)) {
                set_as_new(&mut steps, seeded_command(command, *number))?;
            }
            steps.limit_step(self.longest)?;
            let from = steps.time();
            let until = Seeded { value: end_of_step(from.value, self.dt), ..from };
            steps.move_to(until, &[motion[0]])?;
            let (state, tension) = outputs.split_at_mut(states);
            steps.save_to(state)?;
            let mut response = [steps.compute(0)?];
            steps.compute_at(&[motion[0]], &[motion[1]], &mut response)?;
            tension[0] = response[0].tension;
            for (output, row) in outputs.iter().zip(jacobian.chunks_exact_mut(width)) {
                // An instant that does not come is infinite, and has no derivative.
                let slopes = output.slope.iter().map(|slope| if slope.is_finite() { *slope } else { 0.0 });
                row[first..].iter_mut().zip(slopes).for_each(|(into, slope)| *into = slope);
            }
        }
        Ok(jacobian)
    }

    fn numbers<'py>(py: Python<'py>, numbers: Vec<f64>) -> Numbers<'py> {
        Numbers(PyArray1::from_vec(py, numbers).into_any())
    }
}

#[pymethods]
impl DifferentiableStep {
    #[new]
    #[pyo3(signature = (actuator, dt, *, max_step = None))]
    fn new(actuator: Py<Actuator>, dt: Quantity<'_>, max_step: Option<Quantity<'_>>) -> PyResult<Self> {
        let (dt, max_step) = (dt.si("dt", TIME)?, max_step.map(|it| it.si("max_step", TIME)).transpose()?);
        check_dt(dt).or_exception()?;
        let longest = longest_part(max_step).or_exception()?;
        let model = &actuator.get().model;
        let (seeded, states) = (seeded(model).or_exception()?, states(model));
        Ok(Self { actuator, dt, max_step, longest, seeded, states })
    }

    /// Actuator whose step it is.
    #[getter]
    fn actuator(&self, py: Python<'_>) -> Py<Actuator> {
        self.actuator.clone_ref(py)
    }

    /// Duration of the step in s.
    #[getter]
    fn dt(&self) -> f64 {
        self.dt
    }

    /// Longest part of the step in s; `None` where it is one part.
    #[getter]
    fn max_step(&self) -> Option<f64> {
        self.max_step
    }

    /// Names of the inputs, in their order.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        let more = ["length", "velocity", "command"].map(str::to_owned);
        self.states.iter().cloned().chain(more).take(self.width()).collect()
    }

    /// Names of the outputs, in their order.
    #[getter]
    fn outputs(&self) -> Vec<String> {
        self.states.iter().cloned().chain(["tension".to_owned()]).collect()
    }

    /// Return the inputs of a step from a state.
    ///
    /// Parameters
    /// ----------
    /// state : ActuatorState
    ///     State of the actuator at the beginning of the step.
    /// length : float or str
    ///     Distance between the ends in m at the end of the step, above zero, or text with a unit.
    /// velocity : float or str
    ///     Velocity of the ends in m/s at the end of the step, above zero while lengthening.
    /// command : float or str, optional
    ///     Command of the valve: a duty cycle, a gauge pressure in Pa or a position; 0 by default. Ignored where there is no
    ///     valve.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Inputs in SI, of shape (len(inputs),).
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The state belongs to another actuator.
    #[pyo3(signature = (state, length, velocity, command = Quantity::Number(0.0)), text_signature = "($self, state, length, velocity, command=0.0)")]
    fn pack<'py>(
        &self,
        py: Python<'py>,
        state: &Bound<'py, ActuatorState>,
        length: Quantity<'py>,
        velocity: Quantity<'py>,
        command: Quantity<'py>,
    ) -> PyResult<Numbers<'py>> {
        let (length, velocity) = (length.si("length", LENGTH)?, velocity.si("velocity", VELOCITY)?);
        let command = match command.given("command")? {
            Value::Number(number) => number,
            Value::Text(text) => self.model().number_of("command", &text).or_exception()?,
        };
        let mut values = self.model().own_numbers(state.get()).or_exception()?.to_vec();
        values.extend([length, velocity, command]);
        values.truncate(self.width());
        Ok(Self::numbers(py, values))
    }

    /// Return the state and the tension that outputs stand for.
    ///
    /// Parameters
    /// ----------
    /// outputs : array_like
    ///     Outputs of a step, of shape (len(outputs),).
    ///
    /// Returns
    /// -------
    /// state : ActuatorState
    ///     State after the step, from which `Actuator.step` continues too.
    /// tension : float
    ///     Tension in N.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The numbers are no outputs of this step.
    fn unpack(&self, outputs: Line<'_>) -> PyResult<(ActuatorState, f64)> {
        let outputs = outputs.read("outputs")?;
        let (count, expected) = (outputs.len(), self.states.len() + 1);
        if count != expected {
            let title = format!("{count} numbers were given for {expected} outputs");
            return Err(Failure::input(title, "give all outputs of this step, in their order")).or_exception();
        }
        let mut steps = self.model().steps.clone();
        let (numbers, tension) = outputs.split_at(self.states.len());
        steps.restore_from(numbers).map_err(Failure::from).or_exception()?;
        Ok((self.model().state_of(&mut steps).or_exception()?, tension[0]))
    }

    /// Return the outputs.
    ///
    /// Parameters
    /// ----------
    /// values : array_like
    ///     Inputs in SI, of shape (len(inputs),), as `pack` returns them.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Outputs in SI, of shape (len(outputs),).
    fn __call__<'py>(&self, py: Python<'py>, values: Line<'py>) -> PyResult<Numbers<'py>> {
        let values = values.read("values")?;
        Ok(Self::numbers(py, py.detach(|| self.outputs_at(&values)).or_exception()?))
    }

    /// Return the outputs and their Jacobian with respect to the inputs.
    ///
    /// Parameters
    /// ----------
    /// values : array_like
    ///     Inputs in SI, of shape (len(inputs),), as `pack` returns them.
    ///
    /// Returns
    /// -------
    /// value : numpy.ndarray
    ///     Outputs in SI, of shape (len(outputs),).
    /// jacobian : numpy.ndarray
    ///     Derivatives in SI, of shape (len(outputs), len(inputs)).
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The values are of another number, out of range, or no state of the actuator; or the step has more than 20 000 parts.
    /// SimulationError
    ///     The step leads to a non-physical state.
    fn value_and_jacobian<'py>(&self, py: Python<'py>, values: Line<'py>) -> PyResult<(Numbers<'py>, Numbers<'py>)> {
        let values = values.read("values")?;
        let both = || Ok::<_, Failure>((self.outputs_at(&values)?, self.jacobian_at(&values)?));
        let (outputs, jacobian) = py.detach(both).or_exception()?;
        let jacobian = PyArray1::from_vec(py, jacobian).reshape([outputs.len(), self.width()])?;
        Ok((Self::numbers(py, outputs), Numbers(jacobian.into_any())))
    }

    /// Return this function for JAX, which differentiates it in forward and in reverse mode.
    ///
    /// Returns
    /// -------
    /// callable
    ///     A `jax.custom_jvp` of the inputs in SI. The steps of a `vmap` use all cores.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     JAX computes in 32 bits; call `jax.config.update("jax_enable_x64", True)` first.
    fn for_jax<'py>(this: &Bound<'py, Self>) -> PyResult<Function<'py>> {
        let (shape, width) = ((this.get().states.len() + 1,), this.get().width());
        python::call(this.py(), ("_beside", "for_jax"), (this, shape, width)).map(Function)
    }

    /// Return this function for PyTorch, which differentiates it in forward and in reverse mode.
    ///
    /// Returns
    /// -------
    /// callable
    ///     A function of a float64 tensor of the inputs in SI, with any leading dimensions. The steps of leading dimensions use
    ///     all cores.
    ///
    /// Notes
    /// -----
    /// The function raises `InputError` for a tensor of another type, and where a second derivative is taken.
    fn for_torch<'py>(this: &Bound<'py, Self>) -> PyResult<Function<'py>> {
        let (shape, width) = ((this.get().states.len() + 1,), this.get().width());
        python::call(this.py(), ("_beside", "for_torch"), (this, shape, width)).map(Function)
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.DifferentiableStep of {:?} s, {} inputs>", self.dt, self.width())
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py, (Py<Actuator>, f64)>> {
        let named = [("max_step", self.max_step.into_bound_py_any(py)?)];
        Ok(((self.actuator.clone_ref(py), self.dt), named.into()))
    }
}
