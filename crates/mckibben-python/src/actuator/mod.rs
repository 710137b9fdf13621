//! The modular actuator for a simulation loop that users write: the class `Actuator`.

mod checks;
mod model;
mod state;

pub(crate) use checks::{check_dt, check_length, check_parts, check_velocity, longest_part, reach};
pub(crate) use model::{Model, TOLERANCE, ValveInput, distance, respond, steps_of};
pub(crate) use state::{ActuatorState, Response};

use crate::arguments;
use crate::exceptions::OrException;
use crate::scenario::{Scenario, ScenarioArgument};
use crate::signals::Watch;
use crate::typed::{FREQUENCY, LENGTH, MemberWord, NewArguments, PRESSURE, Quantity, TIME, VELOCITY};
use mckibben::plant::PlantSteps;
use mckibben::simulation::MOST_PARTS;
use mckibben::{Error, GaugePressure};
use mckibben_run::failure::Failure;
use mckibben_run::host::end_of_step;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Parts of a step between two checks for Ctrl-C.
pub(crate) const PARTS_PER_CHECK: f64 = 2e4;

/// Moves the ends in parts between which `watch` is called with the time, where there are many; nothing has changed where
/// that fails.
fn advance(
    actuator: &mut PlantSteps,
    (until, length): (f64, f64),
    watch: &mut dyn FnMut(f64) -> Result<(), Error>,
) -> Result<(), Error> {
    let spans = (actuator.parts_until(until) / PARTS_PER_CHECK).ceil();
    if !(spans > 1.0 && spans <= MOST_PARTS) {
        return actuator.move_to(until, &[length]);
    }
    let (before, from, begin) = (actuator.save(), actuator.time(), distance(actuator));
    let mut span = 0.0;
    while span < spans {
        span += 1.0;
        let share = span / spans;
        let to = if share < 1.0 {
            (from + share * (until - from), begin + share * (length - begin))
        } else {
            (until, length)
        };
        let went = watch(actuator.time()).and_then(|()| actuator.move_to(to.0, &[to.1]));
        if went.is_err() {
            return actuator.restore(&before).and(went);
        }
    }
    Ok(())
}

/// Actuator of a scenario with its air, valve and air line, for a simulation loop that you write.
///
/// The loop commands the valve and moves the ends; the actuator returns its tension. The load, the command and the controller
/// of the scenario are not used. An actuator is immutable: `step` takes a state and returns the next, so that a step can be
/// repeated.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     One actuator, or an antagonistic joint.
/// name : {"agonist", "antagonist"}, optional
///     Which actuator of a joint. Required for a joint, not allowed otherwise.
/// pulse_frequency : float or str, optional
///     Frequency in Hz, above zero, or text with a unit, of the pulses of a duty cycle. By default that of the scenario's PWM. Required where the
///     valve has poppets and the scenario has no PWM.
///
/// Raises
/// ------
/// InputError
///     The scenario has several actuators with names, there is no actuator of that name, or `pulse_frequency` is missing.
///
/// Notes
/// -----
/// Take the tension at t, make your own step with it, then call `step` with the new length and velocity. A loop that calls
/// `step` with the length from before its own step uses a force that lags by one step.
///
/// Examples
/// --------
/// A mass of 2 kg on a muscle that is pulsed at 25 Hz with a duty cycle of 0.5:
///
///     >>> import mckibben
///     >>> scenario = mckibben.Scenario.from_dict({
///     ...     "supply": {"gauge_pressure": "100 psi"},
///     ...     "valve": {"preset": "matrix-eight-channel"},
///     ...     "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... })
///     >>> muscle = mckibben.Actuator(scenario)
///     >>> state, velocity, mass, dt = muscle.start(), 0.0, 2.0, 1e-3
///     >>> length, tension = muscle.initial_length, muscle.initial_tension
///     >>> for _ in range(100):
///     ...     velocity += (9.81 - tension / mass) * dt
///     ...     length += velocity * dt
///     ...     state, tension, response = muscle.step(state, length, velocity, 0.5, dt)
///     >>> round(state.time, 9), tension == response.tension
///     (0.1, True)
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Actuator {
    scenario: Py<Scenario>,
    name: Option<String>,
    pulse_frequency: Option<f64>,
    pub(crate) model: Model,
    /// Where steps are taken.
    desk: Mutex<PlantSteps>,
}

#[pymethods]
impl Actuator {
    #[new]
    #[pyo3(signature = (scenario, name = None, *, pulse_frequency = None))]
    fn new(
        scenario: ScenarioArgument<'_>,
        name: Option<MemberWord>,
        pulse_frequency: Option<Quantity<'_>>,
    ) -> PyResult<Self> {
        let scenario = scenario.0.unbind();
        let pulse_frequency = pulse_frequency.map(|it| it.si("pulse_frequency", FREQUENCY)).transpose()?;
        let name = name.map(|name| name.0);
        let model = Model::of(scenario.get(), name.as_deref(), pulse_frequency).or_exception()?;
        let desk = Mutex::new(model.steps.clone());
        Ok(Self { scenario, name, pulse_frequency, model, desk })
    }

    /// Return the state at t = 0: that of the scenario, with the coils of the valve released.
    ///
    /// Returns
    /// -------
    /// ActuatorState
    fn start(&self) -> PyResult<ActuatorState> {
        self.model.state_of(&mut self.model.steps.clone()).or_exception()
    }

    /// Advance a state by one time step, in which the ends move to a new distance at constant velocity.
    ///
    /// Parameters
    /// ----------
    /// state : ActuatorState
    ///     State at the beginning of the step.
    /// length : float or str
    ///     Distance between the ends in m at the end of the step, above zero, with the tendon if there is one. This and the
    ///     other quantities may be text with a unit.
    /// velocity : float or str
    ///     Velocity of the ends in m/s at the end of the step, above zero while lengthening, between -1e6 and 1e6. The
    ///     tension depends on it through friction; the motion during the step follows from `length` alone.
    /// command : float or str or {"fill", "hold", "exhaust"} or None
    ///     Command of the valve: a duty cycle from 0 to 1, "40 %", or one of the words; of a pressure regulator the set point, a
    ///     gauge pressure in Pa; of a proportional spool the position from -1 to 1. With `None` the last command continues.
    ///     It must be `None` where there is no valve.
    /// dt : float or str
    ///     Duration of the step in s, above zero.
    /// max_step : float or str, optional
    ///     Longest part of the step in s. The step is divided into equal parts no longer than that, along which the length is
    ///     interpolated linearly: the air is then as accurate as with steps of `max_step`. By default the step is one part.
    ///
    /// Returns
    /// -------
    /// state : ActuatorState
    ///     State at the end of the step.
    /// tension : float
    ///     Tension there in N.
    /// response : Response
    ///     Tension with its partial derivatives, and the rates of the air.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An argument is out of range, the valve does not take the command, the state belongs to another actuator, or the step
    ///     has more than 10 000 000 parts and edges of pulses.
    /// SimulationError
    ///     The step leads to a non-physical state, or the length is one to which the actuator cannot be stretched.
    ///
    /// Notes
    /// -----
    /// Edges of pulses and motions of the poppets take place at their instants, however long the step is. Ctrl-C ends a step of
    /// many parts.
    #[pyo3(signature = (state, length, velocity, command, dt, *, max_step = None))]
    #[expect(clippy::too_many_arguments, reason = "they are those of a step, each by its name")]
    fn step(
        &self,
        py: Python<'_>,
        state: &Bound<'_, ActuatorState>,
        length: Quantity<'_>,
        velocity: Quantity<'_>,
        command: Option<ValveInput>,
        dt: Quantity<'_>,
        max_step: Option<Quantity<'_>>,
    ) -> PyResult<(ActuatorState, f64, Response)> {
        let (length, velocity) = (length.si("length", LENGTH)?, velocity.si("velocity", VELOCITY)?);
        let (dt, max_step) = (dt.si("dt", TIME)?, max_step.map(|it| it.si("max_step", TIME)).transpose()?);
        check_dt(dt).or_exception()?;
        check_velocity("velocity", velocity).or_exception()?;
        check_length(&self.model.steps, "length", length).or_exception()?;
        let longest = longest_part(max_step).or_exception()?;
        let commanded = command.map(|given| self.model.commanded("command", &given)).transpose().or_exception()?;
        // It is set to where the state is before anything is done with it, so no earlier position does harm.
        let mut actuator = self.desk.lock().unwrap_or_else(PoisonError::into_inner);
        self.model.restore(&mut actuator, state.get()).or_exception()?;
        commanded.map_or(Ok(()), |commanded| actuator.set(0, commanded)).or_exception()?;
        actuator.limit_step(longest).or_exception()?;
        let from = actuator.time();
        let until = end_of_step(from, dt);
        if until <= from {
            let title = format!("dt = {dt:?} s is lost in the rounding of the {from} s that have been reached");
            return Err(Failure::input(title, "give a longer dt")).or_exception();
        }
        let parts = actuator.parts_until(until);
        check_parts(parts, dt).or_exception()?;
        if parts <= PARTS_PER_CHECK {
            actuator.move_to(until, &[length]).or_exception()?;
            return self.answer(&mut actuator, velocity);
        }
        // A handler of a signal may take a step of the same actuator: the desk must be free.
        let (mut own, mut watch) = (actuator.clone(), Watch::new());
        drop(actuator);
        let went = py.detach(|| advance(&mut own, (until, length), &mut |time| watch.at(time)));
        watch.outcome(went)?;
        self.answer(&mut own, velocity)
    }

    /// Return the tension and its derivatives in a state, at any velocity of the ends, without a step.
    ///
    /// Parameters
    /// ----------
    /// state : ActuatorState
    ///     State of this actuator.
    /// velocity : float or str, optional
    ///     Velocity of the ends in m/s, above zero while lengthening, between -1e6 and 1e6; 0 by default.
    ///
    /// Returns
    /// -------
    /// Response
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The velocity is out of range, or the state belongs to another actuator.
    #[pyo3(signature = (state, velocity = Quantity::Number(0.0)), text_signature = "($self, state, velocity=0.0)")]
    fn respond(&self, state: &Bound<'_, ActuatorState>, velocity: Quantity<'_>) -> PyResult<Response> {
        let velocity = velocity.si("velocity", VELOCITY)?;
        check_velocity("velocity", velocity).or_exception()?;
        let mut actuator = self.desk.lock().unwrap_or_else(PoisonError::into_inner);
        self.model.restore(&mut actuator, state.get()).or_exception()?;
        self.answer(&mut actuator, velocity).map(|(_, _, response)| response)
    }

    /// Return the longest distance between the ends at which the actuator does not pull, at rest and without friction.
    ///
    /// Parameters
    /// ----------
    /// gauge_pressure : float or str, optional
    ///     Gauge pressure of the air in Pa, or text with a unit; that of the start by default.
    ///
    /// Returns
    /// -------
    /// float
    ///     Distance in m, with the tendon if there is one; the shortest length where the actuator pulls even there.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The pressure is below vacuum, or there is no such length.
    #[pyo3(signature = (gauge_pressure = None))]
    fn rest_length(&self, gauge_pressure: Option<Quantity<'_>>) -> PyResult<f64> {
        let gauge_pressure = gauge_pressure.map(|it| it.si("gauge_pressure", PRESSURE)).transpose()?;
        let plant = self.model.steps.plant();
        let here = || self.model.steps.state()[plant.indices().actuators[0].pressure] - plant.network().atmosphere;
        let gauge_pressure = gauge_pressure.unwrap_or_else(here);
        let is_in = gauge_pressure.is_finite();
        arguments::number("gauge_pressure", gauge_pressure, "Pa", "a gauge pressure in Pa, such as 2e5", is_in)
            .or_exception()?;
        let length = plant.rest_distance(0, GaugePressure(gauge_pressure));
        length.map_err(|error| Failure::from(error).of("gauge_pressure")).or_exception()
    }

    /// Tension in N at the start, at rest.
    #[getter]
    fn initial_tension(&self) -> PyResult<f64> {
        Ok(respond(&mut self.model.steps.clone(), 0.0).or_exception()?.tension)
    }

    /// Distance between the ends in m at the start, with the tendon if there is one.
    #[getter]
    fn initial_length(&self) -> f64 {
        distance(&self.model.steps)
    }

    /// Scenario of the actuator.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> Py<Scenario> {
        self.scenario.clone_ref(py)
    }

    fn __repr__(&self) -> String {
        let name = self.name.as_ref().map(|name| format!("`{name}` ")).unwrap_or_default();
        format!("<mckibben.Actuator {name}of {:?}>", self.scenario.get().title())
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py, (Py<Scenario>, Option<String>)>> {
        let named = [("pulse_frequency", self.pulse_frequency.into_bound_py_any(py)?)];
        Ok(((self.scenario.clone_ref(py), self.name.clone()), named.into()))
    }
}

impl Actuator {
    /// Where an actuator is, its tension, and its whole answer.
    fn answer(&self, actuator: &mut PlantSteps, velocity: f64) -> PyResult<(ActuatorState, f64, Response)> {
        let response = respond(actuator, velocity).or_exception()?;
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
        let numbers = answer.__getnewargs__();
        let numbers = [numbers.0, numbers.1, numbers.2, numbers.3, numbers.4, numbers.5, numbers.6, numbers.7];
        if !numbers.iter().all(|number| number.is_finite()) {
            let title = format!("at velocity = {velocity:?} m/s the actuator answers with numbers that are not finite");
            return Err(Failure::stopped(title)).or_exception();
        }
        let state = self.model.state_of(actuator).or_exception()?;
        Ok((state, answer.tension, answer))
    }
}
