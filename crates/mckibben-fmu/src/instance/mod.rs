//! An instance of a unit between two calls of its host: what FMI 2.0 and FMI 3.0 have in common.
//!
//! ```text
//! Instantiated ─ enter ─ Initialization ─ exit ─┬─ Step ⇄ Event            co-simulation
//!                                               └─ Event ⇄ Continuous      model exchange
//! any ─ terminate ─ Terminated ─ reset ─ Instantiated
//! ```
//!
//! Every verb says in which of these phases it may be called; in another it is refused with a message and changes nothing.
//! Checked by `tests/abi.rs` and `tests/fuzz.rs`.

mod exchange;
mod log;
mod partial;
mod saved;
mod steps;
mod values;

pub use log::{Logger, Sink};
pub use saved::Saved;
pub use steps::StepEnd;

use crate::model::{Model, TOLERANCE};
use mckibben::parameter;
use mckibben::plant::{EventUpdate, PlantExchange};
use mckibben_run::failure::{Failure, Reason};
use mckibben_run::host::{HostPlant, Motion};

/// A time in s that differs by less, relative to the time, is the same.
const SAME: f64 = 1e-9;

/// What a call has come to; the numbers are those of both versions of FMI.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(i32)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Not with these values; with others, or a shorter step, the instance goes on.
    Discard = 2,
    /// Refused.
    Error = 3,
}

/// Why a call was not done. Nothing has changed then, unless the verb says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// What the host gets.
    pub status: Status,
    /// What its log gets.
    pub message: String,
}

impl Refusal {
    /// An error of the caller.
    pub fn error(message: impl Into<String>) -> Self {
        Self { status: Status::Error, message: message.into() }
    }

    /// Values from which the plant does not go on.
    pub fn discard(message: impl Into<String>) -> Self {
        Self { status: Status::Discard, message: message.into() }
    }

    /// Names the variable that a message is about, in place of the key that its parameter has in every section.
    fn of_variable(self, key: &str, name: &str) -> Self {
        match self.message.strip_prefix(key) {
            Some(rest) => Self { message: format!("`{name}`{rest}"), ..self },
            None => self,
        }
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        let status = if failure.reason() == Reason::Stopped { Status::Discard } else { Status::Error };
        Self { status, message: failure.sentence() }
    }
}

impl From<mckibben::Error> for Refusal {
    fn from(error: mckibben::Error) -> Self {
        Failure::from(error).into()
    }
}

/// What an instance is made for.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Kind {
    /// It is stepped.
    CoSimulation {
        /// Whether the host handles events between steps.
        event_mode: bool,
        /// Whether a step may end before its end.
        early_return: bool,
    },
    /// It is integrated.
    ModelExchange,
}

/// Where an instance is in its life.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Phase {
    /// Before initialisation.
    Instantiated,
    /// Between its beginning and its end.
    Initialization,
    /// At an event.
    Event,
    /// Between events, of co-simulation.
    Step,
    /// Between events, of model exchange.
    Continuous,
    /// Ended.
    Terminated,
}

/// The values of the inputs. While the run has not begun, distances and rates that the host has not set are those at which the
/// parameters have the plant begin.
#[derive(Clone, Debug, PartialEq)]
struct Inputs {
    /// Numbers by which valves are commanded.
    commands: Vec<f64>,
    /// In m; none where the scenario moves.
    distances: Vec<f64>,
    /// In m/s.
    rates: Vec<f64>,
    /// Whether the host has set each distance, be it to the value that it had.
    are_distances_set: Vec<bool>,
    /// The rates likewise.
    are_rates_set: Vec<bool>,
}

/// An instance of a unit.
#[derive(Debug)]
pub struct Instance {
    log: Logger,
    model: Model,
    kind: Kind,
    phase: Phase,
    plant: HostPlant,
    /// What the host has set.
    parameters: Vec<f64>,
    /// What the plant has.
    built: Vec<f64>,
    inputs: Inputs,
    /// The commands that the plant has been given.
    sent: Vec<Option<f64>>,
    /// The rates of the ends that the modes of the plant have been entered by.
    entered: Vec<f64>,
    /// Whether the plant is not yet as parameters and inputs say, before initialisation has ended.
    is_stale: bool,
    /// The host's time in s at which the plant's is zero.
    offset: f64,
    /// The host's time in s at which its run ends; infinite where it gives none.
    stop: f64,
    /// The relative tolerance of the host.
    tolerance: f64,
    exchange: Option<PlantExchange>,
    /// What a parameter has had passed before it was changed at an event, which the next update reports.
    passed: Option<EventUpdate>,
    outputs: Vec<f64>,
    are_outputs_known: bool,
    /// Targets of a step, rates and a direction: memory that is used again.
    scratch: [Vec<f64>; 3],
}

impl Instance {
    /// A new instance of a model.
    pub fn new(model: Model, kind: Kind, log: Logger) -> Self {
        let plant = model.plant().clone();
        let parameters = model.parameters();
        let inputs = Inputs::of_start(&model);
        let (commands, states) = (plant.commands().len(), plant.steps().state().len());
        let mut instance = Self {
            log,
            kind,
            phase: Phase::Instantiated,
            built: parameters.clone(),
            parameters,
            entered: inputs.rates.clone(),
            inputs,
            sent: vec![None; commands],
            is_stale: false,
            offset: 0.0,
            stop: f64::INFINITY,
            tolerance: TOLERANCE,
            exchange: None,
            passed: None,
            outputs: vec![0.0; plant.outputs().len()],
            are_outputs_known: false,
            scratch: [Vec::new(), vec![0.0; states], vec![0.0; states]],
            plant,
            model,
        };
        instance.log.event(|| "the instance begins".to_owned());
        instance.plant.state_size();
        instance
    }

    /// Where it is in its life.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// What it is made for.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Its model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The log of its host.
    pub fn log(&mut self) -> &mut Logger {
        &mut self.log
    }

    /// The time in s of the host.
    pub fn time(&self) -> f64 {
        self.offset + self.plant.steps().time()
    }

    /// That the phase is one of these.
    fn check_phase(&self, phases: &[Phase]) -> Result<(), Refusal> {
        if phases.contains(&self.phase) {
            return Ok(());
        }
        let known: Vec<String> = phases.iter().map(|phase| format!("{phase:?}")).collect();
        let known = known.join(" or ");
        Err(Refusal::error(format!("called in the phase {:?}; call it in the phase {known}", self.phase)))
    }

    /// That initialisation has begun, before which a host may read neither states nor derivatives. Until its end they are those of
    /// parameters and inputs.
    fn check_begun(&mut self) -> Result<(), Refusal> {
        use Phase::{Continuous, Event, Initialization, Step, Terminated};
        self.check_phase(&[Initialization, Event, Step, Continuous, Terminated])?;
        if self.phase == Initialization { self.refresh_start() } else { Ok(()) }
    }

    /// That it is made for model exchange.
    fn check_exchange(&self) -> Result<(), Refusal> {
        match self.kind {
            Kind::ModelExchange => Ok(()),
            Kind::CoSimulation { .. } => Err(Refusal::error("the instance was made for co-simulation")),
        }
    }

    /// Takes the tolerance of an experiment and its start and stop times in s. The unit is not computed beyond the stop time.
    ///
    /// # Errors
    /// In another phase than Instantiated; for a start that is not finite, a stop before it, and a tolerance that is not above zero.
    pub fn set_up(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<(), Refusal> {
        self.check_phase(&[Phase::Instantiated])?;
        if !start.is_finite() {
            return Err(Refusal::error(format!("the start time {start:?} s is none; give a finite one")));
        }
        if let Some(stop) = stop.filter(|stop| stop.is_nan() || *stop < start) {
            let wrong = if stop.is_nan() { "is none" } else { "is before the start" };
            return Err(Refusal::error(format!(
                "the stop time {stop:?} s {wrong}; give one at or after the start time of {start:?} s, or none"
            )));
        }
        let range = parameter::RELATIVE_TOLERANCE.range;
        match tolerance {
            Some(given) if given.is_finite() && given > 0.0 => {
                // A host may request less than the plant can give; its borders are then as narrow as they can be.
                self.tolerance = given.clamp(range.low.max(1e-12), range.high.min(1e-3));
            }
            Some(given) => {
                return Err(Refusal::error(format!("a tolerance of {given:?} is none; give one above zero")));
            }
            None => {}
        }
        (self.offset, self.stop) = (start, stop.unwrap_or(f64::INFINITY));
        Ok(())
    }

    /// That a time in s of the host is not beyond the stop time by more than rounding, or than `allowance` of the run.
    fn check_stop(&self, time: f64, allowance: f64) -> Result<(), Refusal> {
        let rounding = SAME * time.abs().max(self.stop.abs()).max(1.0);
        if time <= self.stop + rounding.max(allowance * (self.stop - self.offset)) {
            return Ok(());
        }
        Err(Refusal::error(format!("the time {time:?} s is beyond the stop time of {:?} s", self.stop)))
    }

    /// Begins initialisation.
    ///
    /// # Errors
    /// In another phase than Instantiated; for parameters that the scenario cannot have.
    pub fn enter_initialization(&mut self) -> Result<(), Refusal> {
        self.check_phase(&[Phase::Instantiated])?;
        self.refresh_start()?;
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// Ends initialisation: the plant begins by parameters and inputs.
    ///
    /// # Errors
    /// In another phase than Initialization; for parameters, distances or commands that the plant cannot have.
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.check_phase(&[Phase::Initialization])?;
        self.refresh_start()?;
        self.send_commands()?;
        self.phase = match self.kind {
            Kind::CoSimulation { event_mode: false, .. } => Phase::Step,
            Kind::CoSimulation { .. } => Phase::Event,
            Kind::ModelExchange => {
                self.exchange = Some(PlantExchange::new(self.plant.steps(), self.tolerance)?);
                Phase::Event
            }
        };
        Ok(())
    }

    /// Brings the plant to where parameters and inputs have it begin.
    fn refresh_start(&mut self) -> Result<(), Refusal> {
        if !self.is_stale {
            return Ok(());
        }
        let mut plant = self.model.build(&self.parameters)?;
        let mut inputs = self.inputs.clone();
        if inputs.follow(&plant) {
            plant.begin_at(&inputs.distances, &inputs.rates)?;
        }
        plant.state_size();
        (self.plant, self.inputs) = (plant, inputs);
        // What was evaluated for is the plant of other parameters.
        self.exchange = None;
        self.built.clone_from(&self.parameters);
        self.sent.fill(None);
        self.entered.clone_from(&self.inputs.rates);
        (self.is_stale, self.are_outputs_known) = (false, false);
        Ok(())
    }

    /// Gives the plant that runs the parameters that the host has set, in the state in which it is: in model exchange, once all
    /// that is due at this instant has been passed by those that it had.
    fn retune(&mut self) -> Result<(), Refusal> {
        if self.parameters == self.built {
            return self.check_commands(&self.plant);
        }
        let mut plant = self.model.build(&self.parameters)?;
        if plant.state_size() != self.plant.state_size() {
            return Err(Refusal::error(
                "these values change which parts there are: set them before initialisation has ended",
            ));
        }
        self.check_commands(&plant)?;
        if self.kind == Kind::ModelExchange {
            self.pass_due()?;
        }
        plant.restore(&self.plant_state()?)?;
        if self.exchange.is_some() {
            self.exchange = Some(PlantExchange::new(plant.steps(), self.tolerance)?);
        }
        (self.plant, self.are_outputs_known) = (plant, false);
        self.built.clone_from(&self.parameters);
        Ok(())
    }

    /// Checks that the valves of a plant take the commands that the host has set: a supply may no longer feed a set point.
    fn check_commands(&self, plant: &HostPlant) -> Result<(), Refusal> {
        let mut commands = self.inputs.commands.iter().enumerate();
        Ok(commands.try_for_each(|(index, number)| plant.check_command(index, *number).map(drop))?)
    }

    /// Gives the plant the commands that it has not been given.
    fn send_commands(&mut self) -> Result<(), Refusal> {
        for (index, command) in self.inputs.commands.iter().enumerate() {
            if self.sent[index] != Some(*command) {
                self.plant.command(index, *command)?;
                self.sent[index] = Some(*command);
                self.are_outputs_known = false;
            }
        }
        Ok(())
    }

    /// Ends the run; values can still be read.
    ///
    /// # Errors
    /// Before initialisation has ended, and where it has ended already.
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.check_phase(&[Phase::Event, Phase::Step, Phase::Continuous])?;
        self.phase = Phase::Terminated;
        self.log.event(|| "the instance is terminated".to_owned());
        Ok(())
    }

    /// Returns to where the instance was made: parameters and inputs have their start values.
    ///
    /// # Errors
    /// Never; the result is that of the other verbs.
    pub fn reset(&mut self) -> Result<(), Refusal> {
        self.plant = self.model.plant().clone();
        self.parameters = self.model.parameters();
        self.built.clone_from(&self.parameters);
        self.inputs = Inputs::of_start(&self.model);
        self.entered.clone_from(&self.inputs.rates);
        self.sent.fill(None);
        (self.offset, self.stop, self.tolerance, self.exchange) = (0.0, f64::INFINITY, TOLERANCE, None);
        self.passed = None;
        (self.is_stale, self.are_outputs_known) = (false, false);
        self.phase = Phase::Instantiated;
        Ok(())
    }
}

impl Inputs {
    /// The start values.
    fn of_start(model: &Model) -> Self {
        use crate::variables::Slot;
        let starts = |wanted: fn(Slot) -> bool| -> Vec<f64> {
            let all = model.variables().all.iter().filter(|its| wanted(its.slot));
            all.filter_map(|its| its.start.first().copied()).collect()
        };
        let distances = starts(|slot| matches!(slot, Slot::Distance(_)));
        Self {
            commands: starts(|slot| matches!(slot, Slot::Command(_))),
            rates: starts(|slot| matches!(slot, Slot::Rate(_))),
            are_distances_set: vec![false; distances.len()],
            are_rates_set: vec![false; distances.len()],
            distances,
        }
    }

    /// Takes the distances and rates that the host has not set from where a plant begins; whether one that it has set is another.
    fn follow(&mut self, plant: &HostPlant) -> bool {
        let (indices, state) = (plant.steps().plant().indices(), plant.steps().state());
        let Some(here) = indices.mechanisms.first().filter(|_| plant.motion() == Motion::Host) else { return false };
        let mut is_elsewhere = false;
        let mut take = |value: &mut f64, is_set: bool, start: f64| {
            is_elsewhere |= is_set && *value != start;
            *value = if is_set { *value } else { start };
        };
        for index in 0..self.distances.len() {
            take(&mut self.distances[index], self.are_distances_set[index], state[here.position(index)]);
            take(&mut self.rates[index], self.are_rates_set[index], state[here.rate(index)]);
        }
        is_elsewhere
    }
}
