//! The modular actuator for a simulation loop that users write: the classes `Actuator`, `ActuatorState` and `Response`.

use crate::arguments;
use crate::exceptions::{OrException, exception};
use crate::scenario::Scenario;
use crate::signals::Watch;
use crate::typed::{MemberWord, NewArguments, Numbers, PortsWord, RequestWord, Sequence};
use mckibben::plant::{Plant, PlantRow, PlantRun, PlantStart, PlantSteps};
use mckibben::simulation::{MOST_PARTS, Method};
use mckibben::valve::{Request, RuntimeCommand};
use mckibben::{Error, GaugePressure, parameter};
use mckibben_run::failure::Failure;
use mckibben_run::host::Pulses;
use mckibben_scenario::{Experiment, InitialLength, Load};
use numpy::PyArray1;
use pyo3::IntoPyObjectExt;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyString;
use pyo3::{type_hint_identifier as name, type_hint_union};
use std::sync::{Mutex, PoisonError};

/// The actuator of a scenario as a plant whose ends a host moves, and how its valve is pulsed.
pub(crate) struct Model {
    /// Where it begins.
    pub(crate) steps: PlantSteps,
    /// The start of its plant.
    pub(crate) begin: PlantStart,
    /// How many numbers a state of the plant is.
    pub(crate) size: usize,
    pub(crate) pulses: Pulses,
    /// What its states begin with: of which actuator they are.
    pub(crate) mark: f64,
}

/// Sections of a scenario that an actuator in a user's loop does not use.
const ELSEWHERE: &[&str] = &["command", "controller", "initial", "load", "run", "sweep"];

/// Rates of change of a length in m/s beyond which nothing is believed.
const SWIFTEST: f64 = 1e6;
/// Parts of a step between two checks for Ctrl-C.
pub(crate) const PARTS_PER_CHECK: f64 = 2e4;
/// What a state of an actuator has before the numbers of the plant: mark, count, time, length, pressure, air mass, open ports.
const HEAD: usize = 7;
/// The ports by the number that stands for them.
const PORTS: [&str; 4] = ["closed", "supply", "exhaust", "both"];

impl Model {
    /// The scenario's actuator with its valve and all that feeds it, whatever the load; of a joint the one of this name. Pulses
    /// come at a frequency in Hz, else at that of the scenario's PWM.
    pub(crate) fn of(scenario: &Scenario, name: Option<&str>, pulse_frequency: Option<f64>) -> Result<Self, Failure> {
        let document = &scenario.document;
        let of_core = |error| Failure::of_core(&error, document);
        let alone = name.map(|name| member(scenario, name)).transpose()?;
        let experiment = match &alone {
            Some(alone) => alone.experiment().map_err(of_core)?,
            None => match document.controlled_experiment()? {
                Some(controlled) => controlled.experiment,
                None => document.experiment()?,
            },
        };
        let rig = &experiment.rig;
        let pulsed = rig.actuation().filter(|actuation| actuation.solenoid.has_poppets());
        let pulses = Pulses::of(pulsed.map(|actuation| &actuation.command), pulse_frequency)?;
        let (mut steps, begin) = begun(&experiment).map_err(of_core)?;
        let size = steps.state_size();
        let text = alone
            .as_ref()
            .map_or_else(|| scenario.of_one().map(mckibben_scenario::Scenario::to_toml), |of| Ok(of.to_toml()))?;
        let mut table: toml::Table = text.parse().unwrap_or_default();
        table.retain(|section, _| ELSEWHERE.iter().all(|elsewhere| section != *elsewhere));
        Ok(Self { steps, begin, size, pulses, mark: mark(&format!("{table}{}", pulses.frequency)) })
    }

    /// The command that a number is, in the kind of the valve.
    pub(crate) fn command(&self, name: &str, number: f64) -> Result<RuntimeCommand, Failure> {
        self.commanded(name, &ValveInput::Number(number))
    }

    /// The command that a request or a number is.
    pub(crate) fn commanded(&self, name: &str, given: &ValveInput) -> Result<RuntimeCommand, Failure> {
        let Some(valve) = self.steps.plant().network().valves.first() else {
            return Err(Failure::input(
                "there is a command to a valve, but the actuator has none",
                "give the actuator a valve, or leave it sealed",
            ));
        };
        let commanded = match *given {
            ValveInput::Request(request) => RuntimeCommand::Request(request),
            ValveInput::Number(gauge) if valve.solenoid.regulator().is_some() => {
                RuntimeCommand::SetPoint(GaugePressure(gauge))
            }
            ValveInput::Number(position) if valve.solenoid.spool().is_some() => RuntimeCommand::Position(position),
            ValveInput::Number(duty) => {
                arguments::number(name, duty, "", "a duty cycle from 0 to 1", (0.0..=1.0).contains(&duty))?;
                self.pulses.of_duty(duty)
            }
        };
        valve.solenoid.check_command(&commanded).map_err(|error| Failure::from(error).of(name))?;
        Ok(commanded)
    }

    /// Goes to where numbers say, which begin with the mark of this actuator.
    pub(crate) fn restore(&self, steps: &mut PlantSteps, state: &ActuatorState) -> Result<(), Failure> {
        Ok(steps.restore_from(self.own_numbers(state)?)?)
    }

    /// The numbers of the plant in a state of this actuator.
    pub(crate) fn own_numbers<'s>(&self, state: &'s ActuatorState) -> Result<&'s [f64], Failure> {
        if state.numbers[0] == self.mark {
            return Ok(&state.numbers[HEAD..]);
        }
        Err(Failure::input(
            "`state` is of another actuator: its valve, its air or its law need not have such a state",
            "give a state that this actuator, or one of the same scenario and pulse_frequency, has started or stepped to; \
             only what the scenario says of its load, command and run may differ",
        ))
    }

    /// Where the steps are.
    pub(crate) fn state_of(&self, steps: &mut PlantSteps) -> Result<ActuatorState, Failure> {
        let mut numbers = vec![0.0; HEAD + self.size];
        steps.save_to(&mut numbers[HEAD..])?;
        let here = steps.plant().indices().actuators[0];
        let valve = steps.mode().network.valves.first().map(|valve| valve.ports);
        let ports = valve.map_or(0, |ports| usize::from(ports.supply) + 2 * usize::from(ports.exhaust));
        let (air, count) = ([steps.state()[here.pressure], steps.state()[here.mass()]], self.size as f64);
        numbers[..HEAD].copy_from_slice(&[
            self.mark,
            count,
            steps.time(),
            distance(steps),
            air[0],
            air[1],
            ports as f64,
        ]);
        Ok(ActuatorState { numbers })
    }
}

/// Refuses a distance between the ends that is none; one that the actuator cannot be stretched to stops it.
pub(crate) fn check_length(of: &PlantSteps, name: &str, length: f64) -> Result<(), Failure> {
    reach(of.plant().end_distance(0)?, name, length)
}

/// Refuses a distance between the ends that is none, and one from the named limit on.
pub(crate) fn reach(limit: Option<(&'static str, f64)>, name: &str, length: f64) -> Result<(), Failure> {
    arguments::number(name, length, "m", "a distance between the ends in m above zero", length > 0.0)?;
    let Some((limit, end)) = limit.filter(|(_, end)| length >= *end) else { return Ok(()) };
    let limit = if limit == parameter::THREAD_LENGTH.key { "its thread" } else { limit };
    let longer = format!("{name} = {length:?} m is longer than {limit} of {:.1} mm", 1e3 * end);
    Err(Failure::stopped(format!("{longer}: keep the ends closer together")))
}

/// One actuator of a joint as a separate scenario, its ends held where the joint starts.
fn member(scenario: &Scenario, name: &str) -> Result<mckibben_scenario::Scenario, Failure> {
    let Some(of) = scenario.understood() else {
        return Err(Failure::input(
            format!("`{name}` is a part of a plant, which shares its air with the others"),
            "command the plant as a whole by `mckibben.VectorPlant`",
        ));
    };
    let index = ["agonist", "antagonist"].iter().position(|of| *of == name);
    let joint = of.open_loop().joint_experiment().map_err(|error| Failure::of_core(&error, &scenario.document))?;
    let (Some(index), Some(joint)) = (index, joint) else {
        let known = if of.has_joint() { "name \"agonist\" or \"antagonist\"" } else { "leave the name out" };
        return Err(Failure::input(format!("the scenario has no actuator `{name}`"), known));
    };
    let lengths = joint.rig.lengths(joint.start.angle, joint.start.pressure);
    let mut alone = of.open_loop();
    if let (1, Some(antagonist)) = (index, alone.of_antagonist()) {
        alone = antagonist;
    }
    alone.load = Load::Isometric;
    alone.initial.length = InitialLength::At(lengths[index]);
    Ok(alone)
}

/// The steps of the actuator of an experiment, whose ends a host moves.
pub(crate) fn steps_of(experiment: &Experiment) -> Result<PlantSteps, Error> {
    begun(experiment).map(|(steps, _)| steps)
}

/// Those with the start of their plant.
fn begun(experiment: &Experiment) -> Result<(PlantSteps, PlantStart), Error> {
    let plant = Plant::of_rig(&experiment.rig).without_commands(&[0]);
    let start = Plant::start_of_rig(&experiment.rig, &experiment.start);
    let (plant, start) = plant.to_external(&start)?;
    let steps = PlantRun::new(&plant, &start, TOLERANCE)?.steps(Method::Stable);
    Ok((steps, start))
}

/// Relative tolerance of the start against rounding.
pub(crate) const TOLERANCE: f64 = 1e-9;

/// The distance between the ends in m.
pub(crate) fn distance(steps: &PlantRow) -> f64 {
    steps.state()[steps.plant().indices().mechanisms[0].position(0)]
}

/// What the actuator answers while its ends move apart at a velocity in m/s.
pub(crate) fn respond(steps: &mut PlantSteps, velocity: f64) -> Result<mckibben::Response, Error> {
    let mut response = [mckibben::Response::default()];
    steps.compute_at(&[distance(steps)], &[velocity], &mut response)?;
    Ok(response[0])
}

/// A number that identifies a text, exact as a float.
fn mark(text: &str) -> f64 {
    // FNV-1a.
    let hash = text
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    (hash >> 11) as f64
}

/// Refuses a duration that no step can have.
pub(crate) fn check_dt(dt: f64) -> Result<(), Failure> {
    let title = format!("dt = {dt:?} s is no step in time: it must be above zero and finite");
    if dt > 0.0 && dt.is_finite() {
        Ok(())
    } else {
        Err(Failure::input(title, "give a time in s above zero, such as 1e-3"))
    }
}

/// The longest part of a step in s, without end where none is given.
pub(crate) fn longest_part(max_step: Option<f64>) -> Result<f64, Failure> {
    let Some(longest) = max_step else { return Ok(f64::INFINITY) };
    arguments::number(
        "max_step",
        longest,
        "s",
        "a time in s above zero, such as 1e-4, or None for whole steps",
        longest > 0.0,
    )?;
    Ok(longest)
}

/// Refuses more parts than a step may have.
pub(crate) fn check_parts(parts: f64, dt: f64) -> Result<(), Failure> {
    if parts <= MOST_PARTS {
        return Ok(());
    }
    Err(Failure::input(
        format!(
            "dt = {dt:?} s would be divided into {parts:.3e} parts by pulses and max_step, more than {MOST_PARTS:e}"
        ),
        "give a smaller dt, a lower pulse_frequency or a longer max_step",
    ))
}

/// Refuses a velocity of the ends that is none.
pub(crate) fn check_velocity(name: &str, velocity: f64) -> Result<(), Failure> {
    let is_in = velocity.abs() <= SWIFTEST;
    arguments::number(name, velocity, "m/s", "a velocity in m/s between -1e6 and 1e6", is_in)
}

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

/// Command of a valve in a step.
pub(crate) enum ValveInput {
    /// A duty cycle of poppets, the set point of a regulator (gauge pressure in Pa), or the position of a spool.
    Number(f64),
    Request(Request),
}

impl<'a, 'py> FromPyObject<'a, 'py> for ValveInput {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = type_hint_union!(name!("builtins", "float"), RequestWord::HINT);

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let Ok(word) = given.cast::<PyString>() else {
            return Ok(Self::Number(given.extract()?));
        };
        match word.to_cow()?.as_ref() {
            "fill" => Ok(Self::Request(Request::Fill)),
            "hold" => Ok(Self::Request(Request::Hold)),
            "exhaust" => Ok(Self::Request(Request::Exhaust)),
            other => Err(exception(&Failure::input(
                format!("command = {other:?} is no command that a valve can have"),
                "give a duty cycle from 0 to 1, or \"fill\", \"hold\" or \"exhaust\"",
            ))),
        }
    }
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
/// pulse_frequency : float, optional
///     Frequency in Hz, above zero, of the pulses of a duty cycle. By default that of the scenario's PWM. Required where the
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

/// State of an `Actuator`: its air, the poppets and pulses of its valve, and the memory of its hysteresis.
///
/// `Actuator.start` and `Actuator.step` return states. A state can be pickled. An actuator of the same scenario and pulse
/// frequency continues from it bit-identically; any other actuator refuses it.
///
/// Parameters
/// ----------
/// numbers : array_like
///     One-dimensional array that a pickle holds, made by the same version of the package.
///
/// Raises
/// ------
/// InputError
///     The numbers are not a state.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... }))
///     >>> state = muscle.start()
///     >>> state.time, state.length, state.valve
///     (0.0, 0.085, 'closed')
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct ActuatorState {
    /// Those of [`HEAD`] and those of the plant.
    numbers: Vec<f64>,
}

impl ActuatorState {
    /// The numbers that it is made of.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.numbers
    }

    /// What was kept as numbers; those of the plant are checked once its actuator goes there.
    pub(crate) fn of_numbers(numbers: &[f64]) -> Result<Self, Failure> {
        let is_number = |number: &f64| number.is_finite() || *number == f64::INFINITY;
        let is_state = match numbers {
            [mark, count, time, length, pressure, air_mass, ports, plant @ ..] => {
                let head = [mark, time, length, pressure, air_mass];
                *count == plant.len() as f64
                    && head.into_iter().all(|number| number.is_finite())
                    && *pressure > 0.0
                    && *air_mass > 0.0
                    && [0.0, 1.0, 2.0, 3.0].contains(ports)
                    && plant.iter().all(is_number)
            }
            _ => false,
        };
        if is_state {
            return Ok(Self { numbers: numbers.to_vec() });
        }
        Err(Failure::input(
            "these numbers are no state of an actuator",
            "give those that a state of this version was kept as, all of them in their order",
        ))
    }
}

/// Tension of an actuator with its partial derivatives, and the rates of its air.
///
/// `Actuator.step` and `Actuator.respond` return it; the constructor serves pickling.
///
/// Examples
/// --------
/// The tension rises with the length and with the pressure:
///
///     >>> import mckibben
///     >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... }))
///     >>> response = muscle.respond(muscle.start(), velocity=0.01)
///     >>> response.per_length > 0.0, response.per_pressure > 0.0
///     (True, True)
#[pyclass(frozen, get_all, module = "mckibben")]
#[derive(PartialEq)]
pub(crate) struct Response {
    /// Tension in N, zero or more.
    tension: f64,
    /// Partial derivative of the tension with respect to the length at constant pressure, in N/m.
    per_length: f64,
    /// Partial derivative of the tension with respect to the velocity, in N*s/m.
    per_velocity: f64,
    /// Partial derivative of the tension with respect to the pressure, in m^2.
    per_pressure: f64,
    /// Rate of change of the pressure in Pa/s.
    pressure_rate: f64,
    /// Net mass flow into the actuator in kg/s.
    mass_flow: f64,
    /// Temperature of the air in K.
    temperature: f64,
    /// Volume of the air in m^3, in the braid and outside it.
    volume: f64,
}

#[pymethods]
impl Actuator {
    #[new]
    #[pyo3(signature = (scenario, name = None, *, pulse_frequency = None))]
    fn new(scenario: Py<Scenario>, name: Option<MemberWord>, pulse_frequency: Option<f64>) -> PyResult<Self> {
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
    /// length : float
    ///     Distance between the ends in m at the end of the step, above zero, with the tendon if there is one.
    /// velocity : float
    ///     Velocity of the ends in m/s at the end of the step, above zero while lengthening, between -1e6 and 1e6. The
    ///     tension depends on it through friction; the motion during the step follows from `length` alone.
    /// command : float or {"fill", "hold", "exhaust"} or None
    ///     Command of the valve: a duty cycle from 0 to 1, or one of the words; of a pressure regulator the set point, a
    ///     gauge pressure in Pa; of a proportional spool the position from -1 to 1. With `None` the last command continues.
    ///     It must be `None` where there is no valve.
    /// dt : float
    ///     Duration of the step in s, above zero.
    /// max_step : float, optional
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
        length: f64,
        velocity: f64,
        command: Option<ValveInput>,
        dt: f64,
        max_step: Option<f64>,
    ) -> PyResult<(ActuatorState, f64, Response)> {
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
        let until = from + dt;
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
    /// velocity : float, optional
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
    #[pyo3(signature = (state, velocity = 0.0))]
    fn respond(&self, state: &Bound<'_, ActuatorState>, velocity: f64) -> PyResult<Response> {
        check_velocity("velocity", velocity).or_exception()?;
        let mut actuator = self.desk.lock().unwrap_or_else(PoisonError::into_inner);
        self.model.restore(&mut actuator, state.get()).or_exception()?;
        self.answer(&mut actuator, velocity).map(|(_, _, response)| response)
    }

    /// Return the longest distance between the ends at which the actuator does not pull, at rest and without friction.
    ///
    /// Parameters
    /// ----------
    /// gauge_pressure : float, optional
    ///     Gauge pressure of the air in Pa; that of the start by default.
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
    fn rest_length(&self, gauge_pressure: Option<f64>) -> PyResult<f64> {
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

#[pymethods]
impl ActuatorState {
    #[new]
    fn new(numbers: Sequence) -> PyResult<Self> {
        Self::of_numbers(&numbers.0).or_exception()
    }

    /// Time in s since the start.
    #[getter]
    pub(crate) fn time(&self) -> f64 {
        self.numbers[2]
    }

    /// Distance between the ends in m.
    #[getter]
    fn length(&self) -> f64 {
        self.numbers[3]
    }

    /// Absolute pressure of the air in Pa.
    #[getter]
    fn absolute_pressure(&self) -> f64 {
        self.numbers[4]
    }

    /// Mass of the air in kg.
    #[getter]
    fn air_mass(&self) -> f64 {
        self.numbers[5]
    }

    /// Open ports of the valve: "supply", "exhaust", "both" or "closed".
    #[getter]
    fn valve(&self) -> PortsWord {
        PORTS.get(self.numbers[6] as usize).copied().unwrap_or_default().into()
    }

    /// Return whether both states are bit-identical.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let bits = |state: &Self| state.numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        other.cast::<Self>().is_ok_and(|other| bits(other.get()) == bits(self))
    }

    fn __repr__(&self) -> String {
        let [_, _, time, length, pressure, ..] = self.numbers[..] else { return String::new() };
        format!("<mckibben.ActuatorState at {time:?} s, {length:?} m, {pressure:?} Pa>")
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> (Numbers<'py>,) {
        (Numbers(PyArray1::from_slice(py, &self.numbers).into_any()),)
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

    /// Return whether both responses have equal numbers.
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
