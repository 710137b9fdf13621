//! The plant that a scenario file describes, with other values of some of its numbers.

use super::columns::{self, Column};
use crate::scenario::Scenario;
use mckibben::parameter::{self, Parameter};
use mckibben::plant::{Plant, PlantStart, plant_step_for_accuracy};
use mckibben::simulation::Method;
use mckibben::valve::Solenoid;
use mckibben_identify::adjustable::Adjustable;
use mckibben_run::failure::Failure;
use mckibben_run::host::{CommandInput, CommandMode, command_inputs, experiment_of_one, open};
use mckibben_scenario::{Document, PlaceError, PlantExperiment, PlantPlace, Run};
use pyo3::prelude::*;

/// A plant whose valves are commanded at run time, and its start.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Begin {
    pub(super) plant: Plant,
    pub(super) start: PlantStart,
}

/// A scenario file, and the numbers that are given for each plant.
pub(super) struct File {
    scenario: Py<Scenario>,
    numbers: Numbers,
    given: Vec<f64>,
    begin: Begin,
    /// The valves that actions go to, by their indices in the network: those of the actuators, in their order.
    pub(super) valves: Vec<usize>,
    /// What actions are at each of them.
    pub(super) modes: Vec<CommandMode>,
    /// The names of the actuators behind each of them.
    pub(super) owners: Vec<String>,
    pub(super) columns: Vec<Column>,
    pub(super) run: Run,
    /// The longest step in s.
    pub(super) step: f64,
}

/// How numbers are put into the file.
enum Numbers {
    /// Of a file of one actuator or of a joint.
    Short(Box<Adjustable>),
    /// Of a file in which actuators have names.
    Named(Vec<PlantPlace>),
}

/// What is observed of the plant of a scenario.
pub(super) fn columns_of(scenario: &Scenario) -> Result<Vec<Column>, Failure> {
    match scenario.understood() {
        Some(understood) => {
            let begin = short(&open(understood));
            Ok(columns::of_short(&begin.map_err(|error| Failure::of_core(&error, &scenario.document))?.plant))
        }
        None => Ok(columns::of_named(&named(&scenario.document)?)),
    }
}

impl File {
    /// Reads the plant, whose valves take actions of a mode, pulsed at a frequency in Hz or as in the file, and finds the numbers at these
    /// paths.
    pub(super) fn read(
        scenario: Py<Scenario>,
        by: &[String],
        (mode, pulse_frequency): (&str, Option<f64>),
    ) -> Result<Self, Failure> {
        let Scenario { document, .. } = scenario.get();
        let refused = |error: PlaceError| Failure::input(error.to_string(), "name another in `parameters`");
        let failed = |error: mckibben::Error| Failure::of_core(&error, document);
        let (numbers, given, begin, run, inputs, owners, columns);
        match scenario.get().understood() {
            Some(understood) => {
                let mut base = open(understood);
                let paths = || by.iter().map(String::as_str);
                let places = paths().map(|path| document.find(path, paths(), &mut base).map_err(refused));
                let places = places.collect::<Result<Vec<_>, _>>()?;
                given = places.iter().map(|place| place.value(&mut base).unwrap_or(f64::NAN)).collect();
                let experiment = experiment_of_one(&base).map_err(failed)?;
                (run, columns) = (base.run, columns::of_short(&experiment.plant));
                inputs = inputs_of(&experiment, mode, pulse_frequency)?;
                owners = owners_of(&experiment, &inputs);
                begin = Begin { plant: experiment.plant, start: experiment.start };
                let said = document.says_of_each(parameter::MIN_LENGTH.key);
                numbers = Numbers::Short(Box::new(Adjustable::new(base, places, said)));
            }
            None => {
                let places = by.iter().map(|path| document.find_in_plant(path).map_err(refused));
                let places: Vec<PlantPlace> = places.collect::<Result<_, _>>()?;
                let experiment = named(document)?;
                given = places.iter().map(PlantPlace::value).collect();
                (run, columns) = (experiment.run, columns::of_named(&experiment));
                inputs = inputs_of(&experiment, mode, pulse_frequency)?;
                owners = owners_of(&experiment, &inputs);
                begin = Begin { plant: experiment.plant, start: experiment.start };
                numbers = Numbers::Named(places);
            }
        }
        let chosen = || {
            let (of, times) = ((&begin.plant, &begin.start), (run.duration, run.sample_interval));
            plant_step_for_accuracy(of, &Vec::new, times, run.core_method(), run.accuracy).map(|chosen| chosen.step)
        };
        let step = run.step.map_or_else(chosen, Ok).map_err(failed)?;
        let (valves, modes): (Vec<usize>, Vec<CommandMode>) =
            inputs.iter().map(|input| (input.valve, input.mode)).unzip();
        let begin = Begin { plant: begin.plant.without_commands(&valves), ..begin };
        Ok(Self { scenario, numbers, given, begin, valves, modes, owners, columns, run, step })
    }

    /// The formula of a step.
    pub(super) fn method(&self) -> Method {
        self.run.core_method()
    }

    /// What the file has for each number, in SI.
    pub(super) fn given(&self) -> &[f64] {
        &self.given
    }

    /// The plant of the file.
    pub(super) fn begin(&self) -> &Begin {
        &self.begin
    }

    /// The valves that actions go to.
    pub(super) fn solenoids(&self) -> impl Iterator<Item = &Solenoid> {
        self.valves.iter().map(|valve| &self.begin.plant.network().valves[*valve].solenoid)
    }

    /// Whether all plants are that of the file.
    pub(super) fn are_alike(&self) -> bool {
        self.given.is_empty()
    }

    /// The plant with these values.
    pub(super) fn with(&self, values: &[f64]) -> Result<Begin, Failure> {
        if self.are_alike() {
            return Ok(self.begin.clone());
        }
        // The values are the caller's: no line of the file is at fault.
        let refused = |words: String| Failure::input(words, "give another value, or draw from another range");
        let begin = match &self.numbers {
            Numbers::Short(adjustable) => adjustable
                .at(values)
                .and_then(|scenario| short(&scenario))
                .map_err(|error| refused(self.in_paths(&error, values)))?,
            Numbers::Named(places) => {
                let document = &self.scenario.get().document;
                let adjusted = document.with_plant_values(places, values);
                let adjusted = adjusted.map_err(|error| refused(self.in_paths(&error, values)))?;
                let experiment = named(&adjusted).map_err(|failure| refused(failure.to_string()))?;
                Begin { plant: experiment.plant, start: experiment.start }
            }
        };
        Ok(Begin { plant: begin.plant.without_commands(&self.valves), ..begin })
    }

    /// An error of the core in words. A value out of range is named by its path: its row of the table of parameters knows the key, but no
    /// name of a part and no entry of a list.
    fn in_paths(&self, error: &mckibben::Error, values: &[f64]) -> String {
        let words = error.to_string();
        let mckibben::Error::OutOfRange { parameter, .. } = error else { return words };
        let is_meant = |of: &Parameter, value: &f64| of.key == parameter.key && !of.range.contains(*value);
        let path = match &self.numbers {
            Numbers::Short(adjustable) => {
                let mut places = adjustable.places().iter().zip(values);
                places.find(|(place, value)| is_meant(place.parameter(), value)).map(|(place, _)| place.path())
            }
            Numbers::Named(places) => {
                let mut places = places.iter().zip(values);
                places.find(|(place, value)| is_meant(place.parameter(), value)).map(|(place, _)| place.path())
            }
        };
        path.map_or_else(|| words.clone(), |path| words.replacen(parameter.key, &path, 1))
    }

    /// An error of the core, with its place in the file unless its values came from elsewhere.
    pub(super) fn failed(&self, error: &mckibben::Error) -> Failure {
        match self.are_alike() {
            true => Failure::of_core(error, &self.scenario.get().document),
            false => error.clone().into(),
        }
    }
}

/// The valves that actions of a mode go to. All are pulsed at one frequency, which the phase of an observation is of, each with the
/// requests that its PWM has.
fn inputs_of(
    experiment: &PlantExperiment,
    mode: &str,
    pulse_frequency: Option<f64>,
) -> Result<Vec<CommandInput>, Failure> {
    let inputs = |frequency| command_inputs(experiment, ("action_mode", Some(mode)), frequency);
    let each = inputs(pulse_frequency)?;
    // That of the first valve is that of the first PWM, which a valve under another command takes.
    match each.first().and_then(|first| first.mode.pulse_frequency()) {
        Some(common) => inputs(Some(common)),
        None => Ok(each),
    }
}

/// The names of the actuators behind each valve.
fn owners_of(experiment: &PlantExperiment, inputs: &[CommandInput]) -> Vec<String> {
    let name = |actuator: &usize| experiment.names.actuators[*actuator].as_str();
    inputs.iter().map(|input| input.actuators.iter().map(name).collect::<Vec<_>>().join(", ")).collect()
}

/// The plant of a file of one actuator or of a joint.
fn short(scenario: &mckibben_scenario::Scenario) -> Result<Begin, mckibben::Error> {
    experiment_of_one(scenario).map(|PlantExperiment { plant, start, .. }| Begin { plant, start })
}

/// The plant of a file in which actuators have names.
fn named(document: &Document) -> Result<PlantExperiment, Failure> {
    document.plant_experiment()?.ok_or_else(|| {
        Failure::input("the scenario names no actuators", "write [actuators.NAME], or a scenario of one actuator")
    })
}
