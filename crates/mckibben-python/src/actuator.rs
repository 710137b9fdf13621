//! The modular actuator for a loop of one's own: the classes `Actuator`, `ActuatorState` and `Response`.

use crate::pulses::Pulses;
use crate::raised::{Raised, exception};
use crate::scenario::Scenario;
use crate::typed::{Numbers, Sequence};
use mckibben::control::Drive;
use mckibben::simulation::{ModularActuator, Snapshot, State};
use mckibben::valve::Request;
use mckibben_cli::failure::Failure;
use numpy::PyArray1;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyString;
use pyo3::{type_hint_identifier as name, type_hint_union};
use std::sync::{Mutex, PoisonError};

/// The actuator of a scenario, and how its valve is pulsed.
pub(crate) struct Model {
    pub(crate) actuator: ModularActuator,
    pub(crate) pulses: Pulses,
}

impl Model {
    /// The scenario's actuator with its air line and its valve, whatever the load; pulses come at a frequency in Hz, else at
    /// that of the scenario's PWM.
    pub(crate) fn of(scenario: &Scenario, pulse_frequency: Option<f64>) -> Result<Self, Failure> {
        let document = &scenario.document;
        let experiment = match document.controlled_experiment()? {
            Some(controlled) => controlled.experiment,
            None => document.experiment()?,
        };
        let command = experiment.rig.actuation().map(|actuation| &actuation.command);
        let pulses = Pulses::of(command, pulse_frequency)?;
        let actuator = ModularActuator::new(&experiment.rig, experiment.start, pulses.frequency)
            .map_err(|error| Failure::of_core(&error, document))?;
        Ok(Self { actuator, pulses })
    }
}

/// What is asked of a valve in a step.
pub(crate) enum Asked {
    Duty(f64),
    Request(Request),
}

impl<'a, 'py> FromPyObject<'a, 'py> for Asked {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = type_hint_union!(name!("builtins", "float"), name!("builtins", "str"));

    fn extract(asked: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let Ok(word) = asked.cast::<PyString>() else { return asked.extract().map(Self::Duty) };
        match word.to_cow()?.as_ref() {
            "fill" => Ok(Self::Request(Request::Fill)),
            "hold" => Ok(Self::Request(Request::Hold)),
            "exhaust" => Ok(Self::Request(Request::Exhaust)),
            other => Err(exception(&Failure::input(
                format!("command = \"{other}\" is nothing that a valve can be asked"),
                "give a duty cycle from 0 to 1, or \"fill\", \"hold\" or \"exhaust\"",
            ))),
        }
    }
}

/// The actuator of a scenario, with its air, its valve and its air line, for a loop of one's own: you say what is asked of
/// the valve and where the ends are, and it says how hard it pulls.
///
/// The scenario's load and command do not count. `pulse_frequency` in Hz is how often a duty cycle's pulses come; that of
/// the scenario's PWM unless given.
///
/// An actuator does not change: `step` takes a state and gives the next, so that any step can be taken again.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Actuator {
    scenario: Py<Scenario>,
    pulse_frequency: Option<f64>,
    model: Model,
    /// Where steps are taken.
    desk: Mutex<ModularActuator>,
}

/// Where an `Actuator` is: its air, its valve's seats and pulses, and what its hysteresis remembers.
///
/// It can be pickled; `ActuatorState(numbers)` is one as its pickle has it, in the same version of the package. An actuator of
/// the same scenario goes on from there to the same bits.
///
/// Raises `InputError` for numbers that are no state.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct ActuatorState(Snapshot);

/// What an actuator answers to where its ends are, with its derivatives.
#[pyclass(frozen, get_all, module = "mckibben")]
#[derive(PartialEq)]
pub(crate) struct Response {
    /// Tension in N, zero or more.
    tension: f64,
    /// Its derivative by the length at constant pressure, in N/m.
    per_length: f64,
    /// Its derivative by the velocity, in N*s/m.
    per_velocity: f64,
    /// Its derivative by the pressure, in m^2.
    per_pressure: f64,
    /// Rate of the pressure in Pa/s.
    pressure_rate: f64,
    /// Net mass flow into the actuator in kg/s.
    mass_flow: f64,
    /// Temperature of the air in K.
    temperature: f64,
    /// Volume of the air in m^3, braid and hose.
    volume: f64,
}

#[pymethods]
impl Actuator {
    #[new]
    #[pyo3(signature = (scenario, pulse_frequency = None))]
    fn new(scenario: Py<Scenario>, pulse_frequency: Option<f64>) -> PyResult<Self> {
        let model = Model::of(scenario.get(), pulse_frequency).raised()?;
        let desk = Mutex::new(model.actuator.clone());
        Ok(Self { scenario, pulse_frequency, model, desk })
    }

    /// The state at t = 0: that of the scenario, with the coils released.
    fn start(&self) -> ActuatorState {
        ActuatorState(self.model.actuator.snapshot())
    }

    /// Goes on from `state` by `dt` in s while the ends go in a straight line to a distance of `length` in m.
    ///
    /// `command` is a duty cycle from 0 to 1, "fill", "hold" or "exhaust"; with `None` what was asked before goes on, and an
    /// actuator without a valve takes nothing else. `velocity` in m/s is that of the ends at the end of the step.
    ///
    /// Returns the state there, the tension in N, and the tension's derivatives with the rates of the air.
    ///
    /// Raises `InputError` for what cannot be asked, and `StoppedError` where the step leaves the physics.
    fn step(
        &self,
        state: &Bound<'_, ActuatorState>,
        length: f64,
        velocity: f64,
        command: Option<Asked>,
        dt: f64,
    ) -> PyResult<(ActuatorState, f64, Response)> {
        // It is set to where the state is before anything is done with it, so whoever left it anywhere does no harm.
        let mut actuator = self.desk.lock().unwrap_or_else(PoisonError::into_inner);
        let ActuatorState(snapshot) = state.get();
        actuator.restore(snapshot);
        let went = match command {
            None => Ok(()),
            Some(Asked::Duty(duty)) => actuator.drive(self.model.pulses.of_duty(duty)),
            Some(Asked::Request(request)) => actuator.drive(Drive::Steady(request)),
        };
        let went = went.and_then(|()| actuator.move_to(snapshot.time() + dt, length));
        went.map_err(|error| Failure::of_core(&error, &self.scenario.get().document)).raised()?;
        let response = actuator.respond(velocity);
        let answer = Response {
            tension: response.tension,
            per_length: response.per_length,
            per_velocity: response.per_velocity,
            per_pressure: response.per_pressure,
            pressure_rate: response.pressure_rate,
            mass_flow: response.mass_flow,
            temperature: response.temperature,
            volume: response.volume,
        };
        Ok((ActuatorState(actuator.snapshot()), response.tension, answer))
    }

    /// What it was made of.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> Py<Scenario> {
        self.scenario.clone_ref(py)
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Actuator of {:?}>", self.scenario.get().title())
    }

    fn __getnewargs__(&self, py: Python<'_>) -> (Py<Scenario>, Option<f64>) {
        (self.scenario.clone_ref(py), self.pulse_frequency)
    }
}

#[pymethods]
impl ActuatorState {
    #[new]
    fn new(numbers: Sequence) -> PyResult<Self> {
        Snapshot::of_numbers(&numbers.0).map(Self).raised()
    }

    /// The time in s that has been reached.
    #[getter]
    fn time(&self) -> f64 {
        self.0.time()
    }

    /// Distance between the ends in m.
    #[getter]
    fn length(&self) -> f64 {
        self.0.state().length
    }

    /// Absolute pressure of the air in Pa.
    #[getter]
    fn pressure(&self) -> f64 {
        self.0.state().pressure.0
    }

    /// Mass of the air in kg.
    #[getter]
    fn air_mass(&self) -> f64 {
        self.0.state().air_mass
    }

    /// Which passage of the valve is open: "supply", "exhaust", "both" or "closed".
    #[getter]
    fn valve(&self) -> &'static str {
        self.0.ports().name()
    }

    /// Whether both are the same to the bit.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let bits = |state: &Self| state.0.numbers().into_iter().map(f64::to_bits).collect::<Vec<_>>();
        other.cast::<Self>().is_ok_and(|other| bits(other.get()) == bits(self))
    }

    fn __repr__(&self) -> String {
        let State { length, pressure, .. } = self.0.state();
        format!("<mckibben.ActuatorState at {:?} s, {length:?} m, {:?} Pa>", self.0.time(), pressure.0)
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> (Numbers<'py>,) {
        (Numbers(PyArray1::from_vec(py, self.0.numbers()).into_any()),)
    }
}

/// What a response is made of, for pickling.
type Made = (f64, f64, f64, f64, f64, f64, f64, f64);

#[pymethods]
impl Response {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "they are its attributes, each by its name")]
    fn new(
        tension: f64,
        per_length: f64,
        per_velocity: f64,
        per_pressure: f64,
        pressure_rate: f64,
        mass_flow: f64,
        temperature: f64,
        volume: f64,
    ) -> Self {
        Self { tension, per_length, per_velocity, per_pressure, pressure_rate, mass_flow, temperature, volume }
    }

    /// Whether both are the same.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get() == self)
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Response, {:?} N>", self.tension)
    }

    fn __getnewargs__(&self) -> Made {
        let Self { tension, per_length, per_velocity, per_pressure, .. } = *self;
        let Self { pressure_rate, mass_flow, temperature, volume, .. } = *self;
        (tension, per_length, per_velocity, per_pressure, pressure_rate, mass_flow, temperature, volume)
    }
}
