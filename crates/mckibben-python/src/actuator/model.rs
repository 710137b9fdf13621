//! The actuator of a scenario as a plant whose ends a host moves.

use super::state::{ActuatorState, HEAD};
use crate::arguments;
use crate::scenario::Scenario;
use crate::typed::{PRESSURE, RequestWord, SHARE, is_truth, kind, si_of_text};
use mckibben::plant::{Plant, PlantRow, PlantRun, PlantStart, PlantSteps};
use mckibben::simulation::Method;
use mckibben::valve::{Request, RuntimeCommand};
use mckibben::{Error, GaugePressure};
use mckibben_run::failure::Failure;
use mckibben_run::host::{Motion, Pulses, mark};
use mckibben_scenario::{Document, Experiment, InitialLength, Load};
use pyo3::exceptions::PyTypeError;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyString;
use pyo3::{type_hint_identifier as name, type_hint_union};

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

impl Model {
    /// The scenario's actuator with its valve and all that feeds it, whatever the load; of a joint the one of this name. Pulses
    /// come at a frequency in Hz, else at that of the scenario's PWM.
    pub(crate) fn of(scenario: &Scenario, name: Option<&str>, pulse_frequency: Option<f64>) -> Result<Self, Failure> {
        // Of several actuators: what serves them is in the message.
        scenario.of_one()?;
        let document = &scenario.document;
        let of_core = |error| Failure::of_core(&error, document);
        if name.is_none() && scenario.understood().is_some_and(mckibben_scenario::Scenario::has_joint) {
            return Err(Failure::input(
                "`name` is missing: the scenario is a joint, which has two actuators",
                "give name=\"agonist\" or name=\"antagonist\"",
            ));
        }
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
        let described = Document::parse(&text, document.source().name())?;
        let mark = mark(described, &[], &pulses.frequency.to_string(), Motion::Host);
        Ok(Self { steps, begin, size, pulses, mark })
    }

    /// The command that a number is, in the kind of the valve.
    pub(crate) fn command(&self, name: &str, number: f64) -> Result<RuntimeCommand, Failure> {
        self.commanded(name, &ValveInput::Number(number))
    }

    /// The command that a request or a number is.
    pub(crate) fn commanded(&self, name: &str, given: &ValveInput) -> Result<RuntimeCommand, Failure> {
        let network = self.steps.plant().network();
        let Some(valve) = network.valves.first() else {
            return Err(Failure::input(
                "there is a command to a valve, but the actuator has none",
                "give the actuator a valve, or leave it sealed",
            ));
        };
        let number = match given {
            ValveInput::Request(request) => {
                let request = RuntimeCommand::Request(*request);
                network.check_command(0, &request).map_err(|error| Failure::from(error).of(name))?;
                return Ok(request);
            }
            ValveInput::Number(number) => *number,
            ValveInput::Text(text) => self.number_of(name, text)?,
        };
        let commanded = match number {
            gauge if valve.solenoid.regulator().is_some() => RuntimeCommand::SetPoint(GaugePressure(gauge)),
            position if valve.solenoid.spool().is_some() => RuntimeCommand::Position(position),
            duty => {
                arguments::number(name, duty, "", "a duty cycle from 0 to 1", (0.0..=1.0).contains(&duty))?;
                self.pulses.of_duty(duty)
            }
        };
        network.check_command(0, &commanded).map_err(|error| Failure::from(error).of(name))?;
        Ok(commanded)
    }

    /// The number of a command that is text, such as "40 %", or "2 bar" of a pressure regulator.
    pub(crate) fn number_of(&self, name: &str, text: &str) -> Result<f64, Failure> {
        let valve = self.steps.plant().network().valves.first();
        let measured = if valve.is_some_and(|valve| valve.solenoid.regulator().is_some()) { PRESSURE } else { SHARE };
        si_of_text(name, text, measured).map_err(|_| {
            Failure::input(
                format!("{name} = {text:?} is no command that this valve can have"),
                "give a number, a duty cycle such as \"40 %\", the gauge pressure of a regulator such as \"2 bar\", or of a step \
                 \"fill\", \"hold\" or \"exhaust\"",
            )
        })
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

/// Command of a valve in a step.
pub(crate) enum ValveInput {
    /// A duty cycle of poppets, the set point of a regulator (gauge pressure in Pa), or the position of a spool.
    Number(f64),
    /// Such a number as text.
    Text(String),
    Request(Request),
}

impl<'a, 'py> FromPyObject<'a, 'py> for ValveInput {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr =
        type_hint_union!(name!("builtins", "float"), name!("builtins", "str"), RequestWord::HINT);

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let Ok(word) = given.cast::<PyString>() else {
            return match given.extract() {
                Ok(number) if !is_truth(&given) => Ok(Self::Number(number)),
                _ => Err(PyTypeError::new_err(format!(
                    "`command` is of type {}; give a number, or \"fill\", \"hold\" or \"exhaust\"",
                    kind(&given)
                ))),
            };
        };
        match word.to_cow()?.as_ref() {
            "fill" => Ok(Self::Request(Request::Fill)),
            "hold" => Ok(Self::Request(Request::Hold)),
            "exhaust" => Ok(Self::Request(Request::Exhaust)),
            other => Ok(Self::Text(other.to_owned())),
        }
    }
}
