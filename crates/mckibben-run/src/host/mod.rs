//! A scenario as a plant that a host steps: commands in, tensions and pressures out, by names and by numbers.
//!
//! ```text
//! read        a scenario of any kind: one actuator, a joint, many actuators on one air network
//! command     a number for each valve, in the mode of that valve: see `command`
//! advance     all ends go in straight lines to their distances, in m, and everything else to a time, in s
//! compute_at  tensions with their derivatives, where the ends are
//! outputs     the columns of a run, as many numbers in the same order
//! begin_at    begin again, with the ends where the host has them
//! save, restore   the whole state as numbers in the host's memory
//! ```
//!
//! A plug-in of a robot's simulator, a functional mock-up unit and a library for C are adapters over this: they hold no physics,
//! and a test of each proves that its trajectory is this one's. Nothing here is global, and once begun no step
//! allocates.
//!
//! The ends are either the host's ([`Motion::Host`]): it owns masses, joints and contacts, gives distances and takes
//! tensions; or the scenario's ([`Motion::Scenario`]): then loads and mechanisms move as the file says.
//!
//! ```
//! use mckibben_run::host::{HostOptions, HostPlant};
//! use mckibben_scenario::Document;
//!
//! let text = r#"
//! [supply]
//! gauge_pressure = "100 psi"
//! [valve]
//! preset = "matrix-eight-channel"
//! [command]
//! kind = "pwm"
//! frequency = "25 Hz"
//! duty = 0.5
//! [load]
//! kind = "isometric"
//! [initial]
//! length = "90 mm"
//! [run]
//! duration = "1 s"
//! "#;
//! let document = Document::parse(text, "muscle.toml")?;
//! let mut host = HostPlant::read(&document, &HostOptions::default())?;
//! assert_eq!(host.commands()[0].name, "actuator.duty");
//! host.command(0, 0.8)?;
//! for step in 1..=500 {
//!     host.advance(f64::from(step) * 1e-3, &[0.09])?;
//! }
//! assert!(host.steps_mut().compute(0)?.tension > 100.0);
//! # Ok::<(), mckibben_run::failure::Failure>(())
//! ```
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 4, the modular actuator. Checked by `tests/host.rs`.

pub mod command;
mod experiment;

pub use command::{COMMAND_MODES, CommandMode, Pulses};
pub use experiment::{experiment_of, experiment_of_one, open};

use crate::failure::Failure;
use mckibben::Response;
use mckibben::plant::{PlantRun, PlantSampler, PlantStart, PlantSteps, TimeStepping, plant_step_for_accuracy};
use mckibben::simulation::{MOST_PARTS, Method};
use mckibben_scenario::{Document, PlantColumn, PlantExperiment, PlantQuantity};

/// The relative tolerance by which a start is discerned from rounding.
const TOLERANCE: f64 = 1e-9;
/// Part of a step by which a time may miss its end and be there.
const ROUNDING: f64 = 1e-9;

/// What moves the ends of the actuators.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Motion {
    /// The host: each actuator has a distance between its ends.
    #[default]
    Host,
    /// The scenario: its loads and mechanisms.
    Scenario,
}

/// What a host chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HostOptions<'o> {
    /// What moves the ends.
    pub motion: Motion,
    /// What the numbers are that valves are commanded by, by name; each valve's own where none is chosen.
    pub command_mode: Option<&'o str>,
    /// Frequency of the pulses of a duty cycle in Hz, in place of that of the scenario's PWM.
    pub pulse_frequency: Option<f64>,
    /// The longest part of a step in s; whole steps where none is given, and where the scenario moves, its `run.step`.
    pub max_step: Option<f64>,
}

/// A valve that a host commands by a number.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandInput {
    /// Name of the actuator, or of both, and of the mode: `biceps.duty`.
    pub name: String,
    /// The actuators that it feeds, by their indices.
    pub actuators: Vec<usize>,
    /// What the number is.
    pub mode: CommandMode,
    /// Its index in the network.
    valve: usize,
}

/// A scenario that a host steps.
#[derive(Debug)]
pub struct HostPlant {
    experiment: PlantExperiment,
    motion: Motion,
    commands: Vec<CommandInput>,
    outputs: Vec<PlantColumn>,
    quantities: Vec<PlantQuantity>,
    /// The number that each valve is commanded, where that is known.
    commanded: Vec<Option<f64>>,
    /// The longest part of a step in s.
    longest: f64,
    stepping: TimeStepping,
    steps: PlantSteps,
    sampler: PlantSampler,
    /// Where the scenario's steps began, to return there if one fails.
    before: Vec<f64>,
}

impl Clone for HostPlant {
    fn clone(&self) -> Self {
        let Self { experiment, motion, commands, outputs, quantities, commanded, longest, stepping, steps, .. } = self;
        Self {
            experiment: experiment.clone(),
            commands: commands.clone(),
            outputs: outputs.clone(),
            quantities: quantities.clone(),
            commanded: commanded.clone(),
            sampler: PlantSampler::new(steps),
            before: self.before.clone(),
            steps: steps.clone(),
            motion: *motion,
            longest: *longest,
            stepping: *stepping,
        }
    }
}

impl HostPlant {
    /// Reads the plant of a scenario. The actuators' own commands and the controllers are not used; supplies follow theirs.
    ///
    /// # Errors
    /// Every mistake in the scenario, with its place; a mode that a valve does not take; an option that is out of
    /// range.
    pub fn read(document: &Document, options: &HostOptions<'_>) -> Result<Self, Failure> {
        let failed = |error: mckibben::Error| Failure::of_core(&error, document);
        let experiment = experiment_of(document)?;
        let longest = match options.max_step {
            Some(longest) if !(longest.is_finite() && longest > 0.0) => {
                return Err(Failure::input(
                    format!("max_step = {longest:?} s is out of range"),
                    "give a time in s above zero, such as 1e-4, or leave it out for whole steps",
                ));
            }
            longest => longest.unwrap_or(f64::INFINITY),
        };
        // A frequency that is none must not turn duty cycles into requests.
        Pulses::of(None, options.pulse_frequency)?;
        let commands = inputs(&experiment, options)?;
        let valves: Vec<usize> = commands.iter().map(|input| input.valve).collect();
        let PlantExperiment { plant, start, run, names, .. } = experiment;
        let mut experiment =
            PlantExperiment { plant: plant.without_commands(&valves), start, run, names, controls: Vec::new() };
        let method = experiment.run.core_method();
        let stepping = match options.motion {
            Motion::Host => {
                let (plant, start) = experiment.plant.to_external(&experiment.start).map_err(failed)?;
                (experiment.plant, experiment.start) = (plant, start);
                experiment.names.mechanisms = vec![Default::default()];
                TimeStepping::Located { relative_tolerance: TOLERANCE }
            }
            Motion::Scenario => {
                let chosen = || {
                    let times = (run.duration, run.sample_interval);
                    let of = (&experiment.plant, &experiment.start);
                    plant_step_for_accuracy(of, &Vec::new, times, method, run.accuracy).map(|chosen| chosen.step)
                };
                let step = run.step.map_or_else(chosen, Ok).map_err(failed)?;
                TimeStepping::Fixed { method, step: step.min(longest) }
            }
        };
        let begun = PlantRun::new(&experiment.plant, &experiment.start, stepping).map_err(failed)?;
        let mut steps = begun.steps(method_of(stepping));
        steps.limit_step(longest).map_err(failed)?;
        let is_output = |column: &PlantColumn| {
            // What a valve is commanded is the host's own.
            column.quantity().filter(|quantity| !matches!(quantity, PlantQuantity::SetPoint(..)))
        };
        let columns = experiment.columns();
        let mut outputs: Vec<PlantColumn> = columns.into_iter().filter(|column| is_output(column).is_some()).collect();
        for (actuator, name) in experiment.names.actuators.iter().enumerate() {
            let name = format!("{name}.contraction");
            outputs.push(PlantColumn::number(name, "", PlantQuantity::Contraction(actuator)));
        }
        let quantities = outputs.iter().filter_map(is_output).collect();
        let (commanded, sampler) = (vec![None; commands.len()], PlantSampler::new(&steps));
        let motion = options.motion;
        // What steps need is laid out before the first one.
        let before = vec![0.0; steps.state_size()];
        Ok(Self {
            experiment,
            motion,
            commands,
            outputs,
            quantities,
            commanded,
            longest,
            stepping,
            steps,
            sampler,
            before,
        })
    }

    /// The names of the actuators.
    pub fn actuators(&self) -> &[String] {
        &self.experiment.names.actuators
    }

    /// What moves the ends.
    pub fn motion(&self) -> Motion {
        self.motion
    }

    /// The step in s by which the scenario's own motion is advanced; none where the host moves the ends.
    pub fn step(&self) -> Option<f64> {
        match self.stepping {
            TimeStepping::Fixed { step, .. } => Some(step),
            TimeStepping::Located { .. } => None,
        }
    }

    /// The valves that are commanded.
    pub fn commands(&self) -> &[CommandInput] {
        &self.commands
    }

    /// What [`HostPlant::read_outputs`] writes: the columns of a run that are numbers, in their order, then the contraction of
    /// each actuator.
    pub fn outputs(&self) -> &[PlantColumn] {
        &self.outputs
    }

    /// The plant with its names.
    pub fn experiment(&self) -> &PlantExperiment {
        &self.experiment
    }

    /// The plant where it is.
    pub fn steps(&self) -> &PlantSteps {
        &self.steps
    }

    /// The plant where it is, to be computed.
    pub fn steps_mut(&mut self) -> &mut PlantSteps {
        &mut self.steps
    }

    /// How many distances [`HostPlant::advance`] takes: one for each actuator, or none where the scenario moves.
    pub fn distance_count(&self) -> usize {
        match self.motion {
            Motion::Host => self.actuators().len(),
            Motion::Scenario => 0,
        }
    }

    /// The distance in m between the ends of an actuator whose ends the host moves, with its tendon.
    pub fn distance(&self, actuator: usize) -> f64 {
        self.steps.state()[self.steps.plant().indices().mechanisms[0].position(actuator)]
    }

    /// Sets what a valve does from now on. A number that it has been set to already changes nothing.
    ///
    /// # Errors
    /// When there is no such valve, and for a number that it does not take. Then nothing has changed.
    pub fn command(&mut self, input: usize, number: f64) -> Result<(), Failure> {
        let Some(CommandInput { name, mode, valve, .. }) = self.commands.get(input) else {
            return Err(Failure::input(
                format!("there is no command {input}: the plant has {}", self.commands.len()),
                "count the valves from 0, in their order",
            ));
        };
        if self.commanded[input] == Some(number) {
            return Ok(());
        }
        let set = mode.command(number).and_then(|command| self.steps.set(*valve, command));
        set.map_err(|error| Failure::from(error).of(name))?;
        self.commanded[input] = Some(number);
        Ok(())
    }

    /// Whether a valve can be commanded a number.
    pub fn accepts(&self, input: usize, number: f64) -> bool {
        let Some(CommandInput { mode, valve, .. }) = self.commands.get(input) else { return false };
        let solenoid = &self.steps.plant().network().valves[*valve].solenoid;
        mode.command(number).is_ok_and(|command| solenoid.check_command(&command).is_ok())
    }

    /// The number that a valve was last commanded since the state was restored; none where it has not been.
    pub fn commanded(&self, input: usize) -> Option<f64> {
        self.commanded.get(input).copied().flatten()
    }

    /// Goes on to `until` in s; the ends go in straight lines to `distances` in m: one for each actuator, none where the scenario
    /// moves. Nothing where that time has been reached.
    ///
    /// # Errors
    /// For a distance that an actuator cannot have, a time that is not later, more than [`MOST_PARTS`] steps of the scenario, and
    /// when the plant leaves the physics. Then the plant is where it was.
    pub fn advance(&mut self, until: f64, distances: &[f64]) -> Result<(), Failure> {
        match self.motion {
            Motion::Host => Ok(self.steps.move_to(until, distances)?),
            Motion::Scenario if distances.is_empty() => self.go_on(until),
            Motion::Scenario => Err(Failure::input(
                format!("{} distances are given, but the scenario moves the ends", distances.len()),
                "give none, or read the scenario with the motion of the host",
            )),
        }
    }

    /// Goes on by the scenario's own steps.
    fn go_on(&mut self, until: f64) -> Result<(), Failure> {
        if !until.is_finite() {
            return Err(Failure::input(format!("a step to {until:?} s has no end"), "give a finite time in s"));
        }
        if let TimeStepping::Fixed { step, .. } = self.stepping
            && (until - self.steps.time()) / step > MOST_PARTS
        {
            return Err(Failure::input(
                format!("a step to {until:?} s has more than ten million steps of {step:?} s"),
                "give a time that is nearer, and go on from there",
            ));
        }
        // A state with more commands on their way than a row of numbers has places for is kept as it is.
        let kept = self.steps.save_to(&mut self.before).is_err().then(|| self.steps.save());
        while self.steps.time() < until {
            let mut end = self.stepping.step_end(self.steps.time(), until);
            // The rest up to the end is no separate step.
            if until - end < ROUNDING * (end - self.steps.time()) {
                end = until;
            }
            if let Err(error) = self.steps.advance_to(end) {
                match kept {
                    Some(kept) => self.steps.restore(&kept)?,
                    None => self.steps.restore_from(&self.before)?,
                }
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// Begins again at t = 0, with the ends of all actuators at `distances` in m and moving at `rates` in m/s, and all else as the
    /// scenario starts. Allocates.
    ///
    /// # Errors
    /// For distances that the actuators cannot have, and where the scenario moves the ends.
    pub fn begin_at(&mut self, distances: &[f64], rates: &[f64]) -> Result<(), Failure> {
        if self.motion == Motion::Scenario {
            return Err(Failure::input(
                "the scenario moves the ends: they begin where it says",
                "set `initial` in the scenario, or read it with the motion of the host",
            ));
        }
        distances.iter().try_for_each(|its| mckibben::parameter::INITIAL_LENGTH.check(*its).map(drop))?;
        let start = PlantStart {
            positions: vec![distances.to_vec()],
            rates: vec![rates.to_vec()],
            // On a tendon, that at which actuator and tendon balance.
            lengths: vec![None; self.experiment.start.lengths.len()],
            ..self.experiment.start.clone()
        };
        let begun = PlantRun::new(&self.experiment.plant, &start, self.stepping)?;
        self.steps = begun.steps(method_of(self.stepping));
        self.steps.limit_step(self.longest)?;
        self.steps.state_size();
        self.commanded.fill(None);
        Ok(())
    }

    /// Returns to where the plant began.
    pub fn reset(&mut self) {
        self.steps.reset();
        self.commanded.fill(None);
    }

    /// Responses of all actuators with the ends at `distances` in m and moving at `rates` in m/s: see
    /// [`PlantSteps::compute_at`].
    ///
    /// # Errors
    /// As there.
    pub fn compute_at(&mut self, distances: &[f64], rates: &[f64], responses: &mut [Response]) -> Result<(), Failure> {
        Ok(self.steps.compute_at(distances, rates, responses)?)
    }

    /// Writes the outputs where the plant is.
    ///
    /// # Errors
    /// Unless there is one number for each of [`HostPlant::outputs`].
    pub fn read_outputs(&mut self, into: &mut [f64]) -> Result<(), Failure> {
        if into.len() != self.quantities.len() {
            return Err(Failure::input(
                format!("there are {} outputs, and memory for {}", self.quantities.len(), into.len()),
                "give as many numbers as there are outputs",
            ));
        }
        let sample = self.sampler.read(&self.steps, self.steps.time());
        for (into, quantity) in into.iter_mut().zip(&self.quantities) {
            *into = quantity.of(self.steps.plant(), sample);
        }
        Ok(())
    }

    /// How many numbers a state is.
    pub fn state_size(&mut self) -> usize {
        self.steps.state_size()
    }

    /// Saves the whole state as numbers: see [`PlantSteps::save_to`].
    ///
    /// # Errors
    /// As there.
    pub fn save(&mut self, numbers: &mut [f64]) -> Result<(), Failure> {
        Ok(self.steps.save_to(numbers)?)
    }

    /// Returns to a state that a plant of the same scenario has saved.
    ///
    /// # Errors
    /// As [`PlantSteps::restore_from`].
    pub fn restore(&mut self, numbers: &[f64]) -> Result<(), Failure> {
        self.steps.restore_from(numbers)?;
        self.commanded.fill(None);
        Ok(())
    }
}

/// How a step is taken: with the host's distances by the method that is stable at any step.
fn method_of(stepping: TimeStepping) -> Method {
    match stepping {
        TimeStepping::Located { .. } => Method::Stable,
        TimeStepping::Fixed { method, .. } => method,
    }
}

/// The valves of the actuators, each once, with their modes.
fn inputs(experiment: &PlantExperiment, options: &HostOptions<'_>) -> Result<Vec<CommandInput>, Failure> {
    let network = experiment.plant.network();
    let mut inputs: Vec<CommandInput> = Vec::new();
    // A valve without its own pulse frequency has that of the first valve with one.
    let pulsed = experiment.names.valves.iter().flatten().map(|valve| &network.valves[*valve].command);
    let pulsed = pulsed.clone().find(|command| matches!(command, mckibben::valve::Command::Pwm { .. }));
    for (actuator, valve) in experiment.names.valves.iter().enumerate() {
        let Some(valve) = *valve else { continue };
        let name = &experiment.names.actuators[actuator];
        if let Some(input) = inputs.iter_mut().find(|input| input.valve == valve) {
            input.actuators.push(actuator);
            let names: Vec<&str> =
                input.actuators.iter().map(|its| experiment.names.actuators[*its].as_str()).collect();
            input.name = input.mode.title(&names.join("+"));
            continue;
        }
        let its = &network.valves[valve];
        let own = matches!(its.command, mckibben::valve::Command::Pwm { .. }).then_some(&its.command);
        let pulses = || Pulses::of(own.or(pulsed).or(Some(&its.command)), options.pulse_frequency);
        let mode = match options.command_mode {
            Some(mode) => {
                CommandMode::check("command_mode", mode, &its.solenoid).map_err(|failure| failure.of(name))?;
                CommandMode::named("command_mode", mode, pulses)?
            }
            None => CommandMode::of(&its.solenoid, pulses),
        };
        inputs.push(CommandInput { name: mode.title(name), actuators: vec![actuator], mode, valve });
    }
    Ok(inputs)
}
