//! The modular actuator for a loop of one's own: the classes `Actuator`, `ActuatorState` and `Response`.

use crate::pulses::Pulses;
use crate::raised::{Raised, exception};
use crate::scenario::Scenario;
use mckibben::control::Drive;
use mckibben::simulation::{ModularActuator, Snapshot, State};
use mckibben::valve::Request;
use mckibben_cli::failure::Failure;
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
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct ActuatorState {
    snapshot: Snapshot,
    state: State,
    time: f64,
    valve: &'static str,
}

/// What an actuator answers to where its ends are, with its derivatives.
#[pyclass(frozen, get_all, module = "mckibben")]
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

impl ActuatorState {
    fn of(actuator: &ModularActuator) -> Self {
        let (state, time, valve) = (actuator.state(), actuator.time(), actuator.ports().name());
        Self { snapshot: actuator.snapshot(), state, time, valve }
    }
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
        ActuatorState::of(&self.model.actuator)
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
        let state = state.get();
        actuator.restore(&state.snapshot);
        let went = match command {
            None => Ok(()),
            Some(Asked::Duty(duty)) => actuator.drive(self.model.pulses.of_duty(duty)),
            Some(Asked::Request(request)) => actuator.drive(Drive::Steady(request)),
        };
        let went = went.and_then(|()| actuator.move_to(state.time + dt, length));
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
        Ok((ActuatorState::of(&actuator), response.tension, answer))
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
    /// The time in s that has been reached.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// Distance between the ends in m.
    #[getter]
    fn length(&self) -> f64 {
        self.state.length
    }

    /// Absolute pressure of the air in Pa.
    #[getter]
    fn pressure(&self) -> f64 {
        self.state.pressure.0
    }

    /// Mass of the air in kg.
    #[getter]
    fn air_mass(&self) -> f64 {
        self.state.air_mass
    }

    /// Which passage of the valve is open: "supply", "exhaust", "both" or "closed".
    #[getter]
    fn valve(&self) -> &'static str {
        self.valve
    }

    fn __repr__(&self) -> String {
        let State { length, pressure, .. } = &self.state;
        format!("<mckibben.ActuatorState at {:?} s, {length:?} m, {:?} Pa>", self.time, pressure.0)
    }
}

#[pymethods]
impl Response {
    fn __repr__(&self) -> String {
        format!("<mckibben.Response, {:?} N>", self.tension)
    }
}
