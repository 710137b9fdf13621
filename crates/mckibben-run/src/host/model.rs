//! What a scenario is for a host: names, commands, outputs, and how it begins.
//!
//! Plants of a host share it; what changes is in [`HostPlant`](super::HostPlant) and in [`HostBatch`](super::HostBatch).

use super::command::{CommandMode, Pulses};
use super::ends;
use super::experiment::described;
use super::mark::mark;
use crate::failure::Failure;
use mckibben::parameter::ACCURACY;
use mckibben::plant::{Plant, PlantRow, PlantRun, PlantSample, PlantStart, PlantSteps, TimeStepping};
use mckibben::simulation::{MOST_PARTS, Method};
use mckibben::valve::{RuntimeCommand, Solenoid};
use mckibben::{Error, GaugePressure};
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
    /// Whether the host integrates the states, as in model exchange: then no step is chosen, and the plant is not advanced by its
    /// own steps.
    pub host_integrates: bool,
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
    /// The index of the valve in the network.
    pub valve: usize,
}

impl CommandInput {
    /// Whether two inputs are commanded alike, in ranges that may differ.
    fn is_alike(&self, other: &Self) -> bool {
        let Self { name, actuators, mode, valve } = self;
        *name == other.name && *actuators == other.actuators && *valve == other.valve && mode.is_alike(&other.mode)
    }
}

/// A scenario as hosts have it.
#[derive(Clone, Debug)]
pub struct HostModel {
    experiment: PlantExperiment,
    motion: Motion,
    commands: Vec<CommandInput>,
    outputs: Vec<PlantColumn>,
    quantities: Vec<PlantQuantity>,
    /// Where the actuators end: see [`ends::limits`].
    pub(super) limits: Vec<Option<(&'static str, f64)>>,
    /// The longest part of a step in s.
    pub(super) longest: f64,
    stepping: TimeStepping,
    mark: f64,
}

impl HostModel {
    /// Reads it, as [`HostPlant::read`](super::HostPlant::read) says.
    pub(super) fn read(document: &Document, options: &HostOptions<'_>) -> Result<Self, Failure> {
        let failed = |error: mckibben::Error| Failure::of_core(&error, document);
        let (experiment, described) = described(document)?;
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
        let mode = ("command_mode", options.command_mode);
        let commands = command_inputs(&experiment, mode, options.pulse_frequency)?;
        let valves: Vec<usize> = commands.iter().map(|input| input.valve).collect();
        // The scenario's own commands say what a step has to follow; those of the host are not known yet.
        let step = match options.motion {
            Motion::Host => None,
            Motion::Scenario if options.host_integrates => Some(experiment.run.sample_interval),
            Motion::Scenario => Some(experiment.fixed_step().map_err(of_fixed_steps).map_err(failed)?),
        };
        let PlantExperiment { plant, start, run, names, .. } = experiment;
        let mut experiment =
            PlantExperiment { plant: plant.without_commands(&valves), start, run, names, controls: Vec::new() };
        let method = experiment.run.core_method();
        let stepping = match step {
            None => {
                let (plant, start) = experiment.plant.to_external(&experiment.start).map_err(failed)?;
                (experiment.plant, experiment.start) = (plant, start);
                experiment.names.mechanisms = vec![Default::default()];
                TimeStepping::Located { relative_tolerance: TOLERANCE }
            }
            Some(step) => TimeStepping::Fixed { method, step: step.min(longest) },
        };
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
        let (motion, limits) = (options.motion, ends::limits(&experiment.plant).map_err(failed)?);
        let commanded: String =
            commands.iter().map(|its| format!("{}{:?}", its.name, its.mode.pulse_frequency())).collect();
        let mark = mark(described, &experiment.names.actuators, &commanded, motion);
        Ok(Self { experiment, motion, commands, outputs, quantities, limits, longest, stepping, mark })
    }

    /// A number, exact as a float, that identifies the plant: hosts put it before a state that they hand out as numbers.
    pub fn mark(&self) -> f64 {
        self.mark
    }

    /// Refuses a state that stands behind the mark of another plant; `state` is how the host calls it.
    ///
    /// # Errors
    /// With what may differ.
    pub fn check_mark(&self, state: &str, mark: f64) -> Result<(), Failure> {
        if mark == self.mark {
            return Ok(());
        }
        let (motion, may_differ) = match self.motion {
            Motion::Host => ("", "load, mechanism, commands, controllers, start and run"),
            Motion::Scenario => (", motion", "commands, controllers, start and run"),
        };
        Err(Failure::input(
            format!("{state} is of another plant: its valves, its air or its law need not have such a state"),
            format!(
                "give one that a plant of an equal scenario{motion}, command mode and pulse frequency has saved; only what the \
                 scenario says of its {may_differ} may differ"
            ),
        ))
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

    /// What [`HostPlant::read_outputs`](super::HostPlant::read_outputs) writes: the columns of a run that are numbers, in their
    /// order, then the contraction of each actuator.
    pub fn outputs(&self) -> &[PlantColumn] {
        &self.outputs
    }

    /// The plant with its names.
    pub fn experiment(&self) -> &PlantExperiment {
        &self.experiment
    }

    /// How many distances a step takes: one for each actuator, or none where the scenario moves.
    pub fn distance_count(&self) -> usize {
        match self.motion {
            Motion::Host => self.actuators().len(),
            Motion::Scenario => 0,
        }
    }

    /// Whether a valve can be commanded a number.
    pub fn accepts(&self, input: usize, number: f64) -> bool {
        self.check_command(input, number).is_ok()
    }

    /// The numbers of the requests that a valve takes, in rising order: 1 fills, 0 holds, −1 exhausts. None of a valve that is
    /// commanded otherwise.
    pub fn requests(&self, input: usize) -> Vec<f64> {
        let of_requests = self.commands.get(input).filter(|its| its.mode == CommandMode::Request);
        let Some(its) = of_requests else { return Vec::new() };
        CommandMode::requests_of(std::iter::once(self.solenoid(its)))
    }

    /// Checks that a valve can be commanded a number, and returns the command.
    ///
    /// # Errors
    /// When there is no such valve, and for a number that it does not take, with those that it takes.
    pub fn check_command(&self, input: usize, number: f64) -> Result<RuntimeCommand, Failure> {
        let its = self.input(input)?;
        let mode = &its.mode;
        let network = self.experiment.plant.network();
        let command = mode.command(number).and_then(|command| {
            network.check_command(its.valve, &command)?;
            Ok(command)
        });
        command.map_err(|error| {
            let (low, high, unit) = mode.range();
            // Pulses may hold a request that the valve does not have, whatever the duty cycle.
            if matches!(mode, CommandMode::Duty(_)) && (low..=high).contains(&number) {
                return Failure::from(error).of(&its.name);
            }
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            let title = format!("`{}` = {number:?}{unit} is not among what the valve takes", its.name);
            Failure::input(title, format!("give {}", mode.words(&self.requests(input))))
        })
    }

    fn solenoid(&self, input: &CommandInput) -> &Solenoid {
        &self.experiment.plant.network().valves[input.valve].solenoid
    }

    /// The valve that is commanded by the number of this index.
    pub(super) fn input(&self, input: usize) -> Result<&CommandInput, Failure> {
        self.commands.get(input).ok_or_else(|| {
            Failure::input(
                format!("there is no command {input}: the plant has {}", self.commands.len()),
                "count the valves from 0, in their order",
            )
        })
    }

    /// Why plants of both cannot be stepped together, with a remedy; none where they are commanded, moved and read alike.
    pub(super) fn difference(&self, other: &Self) -> Option<(String, &'static str)> {
        const ALIKE: &str = "make a batch of plants of one scenario, or of scenarios that differ in numbers alone";
        let words = |what: &str| Some((what.to_owned(), ALIKE));
        if self.motion != other.motion || self.longest != other.longest {
            return Some((
                "it is moved by another, or has another max_step".to_owned(),
                "give all of them equal options",
            ));
        }
        if let (Some(one), Some(two)) = (self.step(), other.step())
            && one != two
        {
            let title = format!("its own step is {one:?} s, that of the first plant {two:?} s");
            return Some((title, "give all of them an equal run.step, or a max_step that is shorter than all"));
        }
        if self.stepping != other.stepping {
            return words("its run.method is another than that of the first plant");
        }
        if self.actuators() != other.actuators() {
            return words("its actuators are not those of the first plant");
        }
        let (mine, theirs) = (&self.commands, &other.commands);
        if let Some((one, two)) = mine.iter().zip(theirs).find(|(one, two)| !one.is_alike(two)) {
            return Some(match (one.mode.pulse_frequency(), two.mode.pulse_frequency()) {
                (Some(its), Some(first)) if its != first => {
                    let title =
                        format!("`{}` is pulsed at {its:?} Hz, that of the first plant at {first:?} Hz", one.name);
                    (title, "give all of them an equal pulse_frequency")
                }
                _ => (format!("its command `{}` is not `{}` of the first plant", one.name, two.name), ALIKE),
            });
        }
        if mine.len() != theirs.len() || self.outputs != other.outputs {
            return words("its valves or outputs are not those of the first plant");
        }
        None
    }

    /// The ends in s of the scenario's own steps, one after the other.
    ///
    /// # Errors
    /// For a time without end or before that, and for more than [`MOST_PARTS`] steps.
    pub(super) fn step_ends(&self, from: f64, until: f64) -> Result<impl Iterator<Item = f64> + use<>, Failure> {
        self.check_time(from, until)?;
        let stepping = self.stepping;
        if let TimeStepping::Fixed { step, .. } = stepping
            && (until - from) / step > MOST_PARTS
        {
            return Err(Failure::input(
                format!("a step to {until:?} s has more than ten million steps of {step:?} s"),
                "give a time that is nearer, and go on from there",
            ));
        }
        let end = move |time: f64| {
            let end = stepping.step_end(time, until);
            // The rest up to the end is no separate step.
            let is_last = until - end < ROUNDING * (end - time);
            (time < until).then_some(if is_last { until } else { end })
        };
        Ok(std::iter::successors(end(from), move |time| end(*time)))
    }

    /// Writes the outputs of a plant in a sample.
    ///
    /// # Errors
    /// Unless there is one number for each of [`HostModel::outputs`].
    pub(super) fn write_outputs(
        &self,
        (plant, sample): (&Plant, &PlantSample),
        into: &mut [f64],
    ) -> Result<(), Failure> {
        if into.len() != self.quantities.len() {
            return Err(Failure::input(
                format!("there are {} outputs, and memory for {}", self.quantities.len(), into.len()),
                "give as many numbers as there are outputs",
            ));
        }
        for (into, quantity) in into.iter_mut().zip(&self.quantities) {
            *into = quantity.of(plant, sample);
        }
        Ok(())
    }

    /// Steps from where the scenario begins.
    ///
    /// # Errors
    /// A start that the core finds impossible.
    pub(super) fn begin(&self) -> Result<PlantSteps, mckibben::Error> {
        let begun = PlantRun::new(&self.experiment.plant, &self.experiment.start, self.stepping)?;
        self.steps_of(begun.row(self.method()))
    }

    /// A plant that begins at t = 0, or at a time in s, with the ends of all actuators at `distances` in m and moving at `rates` in m/s, and
    /// all else as the scenario starts but the gauge pressures in Pa of the actuators for which one is given.
    ///
    /// # Errors
    /// For distances that the actuators cannot have, a pressure that is none, and where the scenario moves the ends.
    pub(super) fn begin_at(
        &self,
        distances: &[f64],
        rates: &[f64],
        gauges: &[Option<f64>],
        time: f64,
    ) -> Result<PlantRow, Failure> {
        if self.motion == Motion::Scenario {
            return Err(Failure::input(
                "the scenario moves the ends: they begin where it says",
                "set `initial` in the scenario, or read it with the motion of the host",
            ));
        }
        self.check_ends(distances, rates)?;
        self.check_reach(distances)?;
        let mut start = PlantStart {
            positions: vec![distances.to_vec()],
            rates: vec![rates.to_vec()],
            // On a tendon, that at which actuator and tendon balance.
            lengths: vec![None; self.experiment.start.lengths.len()],
            ..self.experiment.start.clone()
        };
        for (air, gauge) in start.air.iter_mut().zip(gauges) {
            air.gauge_pressure = gauge.map_or(air.gauge_pressure, GaugePressure);
        }
        let begun = PlantRun::new(&self.experiment.plant, &start, self.stepping)?;
        let begun = if time == 0.0 { begun } else { begun.begin_again(&start, time)? };
        Ok(begun.row(self.method()))
    }

    /// How a step is taken: with the host's distances by the method that is stable at any step.
    fn method(&self) -> Method {
        match self.stepping {
            TimeStepping::Located { .. } => Method::Stable,
            TimeStepping::Fixed { method, .. } => method,
        }
    }

    /// Steps of a plant, whose moves are divided as the host has said.
    pub(super) fn steps_of(&self, row: PlantRow) -> Result<PlantSteps, mckibben::Error> {
        let mut steps = PlantSteps::from(row);
        steps.limit_step(self.longest)?;
        // What steps need is laid out before the first one.
        steps.state_size();
        Ok(steps)
    }
}

/// The valves of the actuators, each once, with their modes: the named one, else each valve's own; `key` is how the host calls the choice,
/// in messages. Duty cycles are pulsed as each valve's own PWM says, but at a frequency in Hz where one is given.
///
/// # Errors
/// For a mode that a valve does not take, and for duty cycles without a frequency of their pulses.
pub fn command_inputs(
    experiment: &PlantExperiment,
    (key, mode): (&str, Option<&str>),
    pulse_frequency: Option<f64>,
) -> Result<Vec<CommandInput>, Failure> {
    let network = experiment.plant.network();
    let mut inputs: Vec<CommandInput> = Vec::new();
    // A valve without its own pulses has those of the first valve with some.
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
        let pulses = || Pulses::of(own.or(pulsed).or(Some(&its.command)), pulse_frequency);
        let mode = match mode {
            Some(mode) => {
                CommandMode::check(key, mode, &its.solenoid).map_err(|failure| failure.of(name))?;
                CommandMode::named(key, mode, pulses)?
            }
            None => CommandMode::of(&its.solenoid, pulses),
        };
        let mode = network.feed_of(valve).map_or(mode, |gauge| mode.fed_at(gauge));
        inputs.push(CommandInput { name: mode.title(name), actuators: vec![actuator], mode, valve });
    }
    Ok(inputs)
}

/// The error of a step that is not accurate enough, with what a user can do about it: a host has no event-located engine.
fn of_fixed_steps(error: Error) -> Error {
    match error {
        Error::Inconsistent { parameter, value, requirement, .. } if parameter.key == ACCURACY.key => {
            let remedy = "give run.step, or loosen run.accuracy: a host takes fixed steps alone";
            Error::Inconsistent { parameter, value, requirement, remedy }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mckibben::Requirement;

    /// A host has fixed steps alone, so another engine is no remedy for an accuracy that none of them reaches.
    #[test]
    fn an_accuracy_that_no_step_reaches_has_a_remedy_of_hosts() {
        let other = "the error of the shortest step that is tried";
        let error = |parameter| Error::Inconsistent {
            parameter,
            value: 1e-3,
            requirement: Requirement { relation: "must be at least", other, value: 2e-3, unit: "" },
            remedy: "set run.engine = \"event-located\"",
        };
        let text = of_fixed_steps(error(&ACCURACY)).to_string();
        assert!(text.contains("give run.step, or loosen run.accuracy") && !text.contains("event-located"), "{text}");
        let elsewhere = error(&mckibben::parameter::DURATION);
        assert_eq!(of_fixed_steps(elsewhere.clone()), elsewhere);
    }
}
