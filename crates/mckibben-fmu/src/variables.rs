//! The variables of a unit: names, value references, units, ranges and start values.
//!
//! | block | variables | causality |
//! |---|---|---|
//! | 0 | `time` | independent |
//! | 1 | commands of valves: `biceps.duty` | input |
//! | 2, 3 | `biceps.distance`, `biceps.rate`, where the host moves the ends | input |
//! | 4 | the columns of a run: `biceps.tension` | output |
//! | 5 | the numbers that the scenario says, by their paths | parameter, fixed or tunable |
//! | 6, 7 | states and their derivatives, for model exchange | local |
//! | 8 | event indicators, for model exchange | local |
//! | 9 | arrays of the actuators, in FMI 3.0: `distances`, `rates`, `commands`, `tensions`, `pressures`, `mass_flows` | input, output |
//!
//! A value reference is 65536 times the block plus the index in it: it stays while other blocks grow. An array is in addition
//! to its elements; of two settings of one input the later counts.
//!
//! Checked by `tests/description.rs`.

use crate::tunable::is_tunable;
use mckibben::parameter::Parameter;
use mckibben::plant::StateIndices;
use mckibben_run::host::{CommandMode, HostPlant, Motion};
use mckibben_scenario::{Document, DocumentNumber, PlantQuantity};

/// What a value reference stands for; the number is the index in its block.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Slot {
    /// The time in s.
    Time,
    /// A command.
    Command(usize),
    /// The distance between the ends of an actuator in m.
    Distance(usize),
    /// Its rate in m/s.
    Rate(usize),
    /// An output.
    Output(usize),
    /// A parameter.
    Parameter(usize),
    /// A continuous state.
    State(usize),
    /// The rate of a continuous state.
    Derivative(usize),
    /// An event indicator.
    Indicator(usize),
    /// An array.
    Array(Array),
}

/// An array of all actuators.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Array {
    /// All commands.
    Commands,
    /// All distances in m.
    Distances,
    /// All rates in m/s.
    Rates,
    /// All tensions in N.
    Tensions,
    /// All gauge pressures in Pa.
    Pressures,
    /// All mass flows in kg/s.
    MassFlows,
}

impl Array {
    /// All arrays, in the order of their references.
    pub const ALL: [Self; 6] =
        [Self::Commands, Self::Distances, Self::Rates, Self::Tensions, Self::Pressures, Self::MassFlows];
}

/// The part that a variable has in a model.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Causality {
    /// Time.
    Independent,
    /// Set by the host at any time; of discrete variability where it takes effect at once, as a command does.
    Input {
        /// Whether it changes at events alone.
        is_discrete: bool,
    },
    /// Computed.
    Output,
    /// Set by the host before initialisation has ended.
    Parameter {
        /// Whether it may change later too.
        is_tunable: bool,
    },
    /// Inner.
    Local,
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its value reference.
    pub reference: u32,
    /// What that stands for.
    pub slot: Slot,
    /// Its part.
    pub causality: Causality,
    /// SI unit; empty for a pure number.
    pub unit: &'static str,
    /// The least value, where there is one.
    pub min: Option<f64>,
    /// The greatest value, where there is one.
    pub max: Option<f64>,
    /// Start values, one for each element; none where the value is computed.
    pub start: Vec<f64>,
    /// How many elements it has; none of a scalar.
    pub dimension: Option<usize>,
    /// One sentence.
    pub description: String,
}

/// The variables of a unit, in the order of their references.
#[derive(Clone, Debug)]
pub struct Variables {
    /// All of them.
    pub all: Vec<Variable>,
    /// The numbers of the scenario that are parameters.
    pub parameters: Vec<DocumentNumber>,
    /// Which states of the plant are continuous states of the unit.
    pub states: Vec<usize>,
    /// How many event indicators there are.
    pub indicators: usize,
    /// The output that is an element of an array, for each actuator.
    pub(crate) of_arrays: [Vec<usize>; 3],
}

/// Sections whose numbers say how a scenario is run or commanded, which is the host's.
const NOT_PARAMETERS: [&str; 5] = ["run", "sweep", "command", "controller", "control"];

/// The block of a reference.
pub const BLOCK: u32 = 1 << 16;

impl Slot {
    /// Its value reference.
    pub fn reference(self) -> u32 {
        let of = |block: u32, index: usize| block * BLOCK + index as u32;
        match self {
            Self::Time => 0,
            Self::Command(index) => of(1, index),
            Self::Distance(index) => of(2, index),
            Self::Rate(index) => of(3, index),
            Self::Output(index) => of(4, index),
            Self::Parameter(index) => of(5, index),
            Self::State(index) => of(6, index),
            Self::Derivative(index) => of(7, index),
            Self::Indicator(index) => of(8, index),
            Self::Array(array) => of(9, Array::ALL.iter().position(|its| *its == array).unwrap_or(0)),
        }
    }
}

impl Variables {
    /// The variables of a plant that a document describes; `indicators` is the number of event indicators.
    pub fn new(document: &Document, plant: &HostPlant, indicators: usize) -> Self {
        let parameters: Vec<DocumentNumber> = document.numbers().into_iter().filter(is_parameter).collect();
        let states = continuous_states(plant);
        let mut all = vec![Variable {
            name: "time".to_owned(),
            reference: 0,
            slot: Slot::Time,
            causality: Causality::Independent,
            unit: "s",
            min: None,
            max: None,
            start: Vec::new(),
            dimension: None,
            description: "Time.".to_owned(),
        }];
        all.extend(inputs(plant));
        all.extend(outputs(plant));
        all.extend(parameters.iter().enumerate().map(|(index, number)| parameter(index, number)));
        all.extend(inner(plant, &states, indicators));
        let of_arrays = elements(plant);
        all.extend(arrays(plant, &of_arrays));
        // A path of the scenario and a column may have one name.
        for index in 1..all.len() {
            if all[..index].iter().any(|before| before.name == all[index].name) {
                all[index].name.insert_str(0, "scenario.");
            }
        }
        all.sort_by_key(|variable| variable.reference);
        Self { all, parameters, states, indicators, of_arrays }
    }

    /// The variable of a value reference.
    pub fn find(&self, reference: u32) -> Option<&Variable> {
        let place = self.all.binary_search_by_key(&reference, |variable| variable.reference).ok()?;
        Some(&self.all[place])
    }
}

fn is_parameter(number: &DocumentNumber) -> bool {
    !number.path.split('.').any(|name| NOT_PARAMETERS.contains(&name)) && number.parameter.check(number.value).is_ok()
}

/// The states of a plant that a host integrates: not the ends that it moves.
fn continuous_states(plant: &HostPlant) -> Vec<usize> {
    let indices = plant.steps().plant().indices();
    let is_given = |place: &usize| {
        let of_host =
            |here: &mckibben::plant::MechanismIndices| (here.first..here.first + 2 * here.coordinates).contains(place);
        plant.motion() == Motion::Host && indices.mechanisms.iter().any(of_host)
    };
    (0..indices.states).filter(|place| !is_given(place)).collect()
}

fn scalar(slot: Slot, name: String, causality: Causality, unit: &'static str, description: String) -> Variable {
    Variable {
        name,
        reference: slot.reference(),
        slot,
        causality,
        unit,
        min: None,
        max: None,
        start: Vec::new(),
        dimension: None,
        description,
    }
}

/// The sentence of a command.
fn of_command(mode: &CommandMode) -> &'static str {
    match mode {
        CommandMode::Duty(_) => "Duty cycle of the pulses of the valve.",
        CommandMode::Request => "Request to the valve: 1 to fill, 0 to hold, -1 to exhaust.",
        CommandMode::Position => "Position of the spool, -1 (exhaust open) to 1 (supply open).",
        CommandMode::SetPoint { .. } => "Set point of the pressure regulator, gauge.",
    }
}

/// A command that the valve of an input can be given.
fn least_command(plant: &HostPlant, index: usize) -> f64 {
    let input = &plant.commands()[index];
    let (low, high, _) = input.mode.range();
    [0.0, low, high].into_iter().find(|number| plant.accepts(index, *number)).unwrap_or(0.0)
}

fn inputs(plant: &HostPlant) -> Vec<Variable> {
    let mut inputs = Vec::new();
    for (index, input) in plant.commands().iter().enumerate() {
        let (low, high, unit) = input.mode.range();
        let causality = Causality::Input { is_discrete: true };
        let of = scalar(Slot::Command(index), input.name.clone(), causality, unit, of_command(&input.mode).to_owned());
        inputs.push(Variable {
            min: Some(low),
            max: Some(high).filter(|high| high.is_finite()),
            start: vec![least_command(plant, index)],
            ..of
        });
    }
    if plant.motion() == Motion::Scenario {
        return inputs;
    }
    let (indices, state) = (plant.steps().plant().indices().mechanisms[0], plant.steps().state());
    let causality = Causality::Input { is_discrete: false };
    for (index, name) in plant.actuators().iter().enumerate() {
        let sentence = "Distance between the ends of the actuator, with its tendon.".to_owned();
        let of = scalar(Slot::Distance(index), format!("{name}.distance"), causality, "m", sentence);
        let most = plant.steps().plant().end_distance(index).ok().flatten().map(|(_, length)| length);
        inputs.push(Variable { min: Some(0.0), max: most, start: vec![state[indices.position(index)]], ..of });
        let sentence = "Rate of that distance, positive when it grows.".to_owned();
        let of = scalar(Slot::Rate(index), format!("{name}.rate"), causality, "m/s", sentence);
        inputs.push(Variable { start: vec![state[indices.rate(index)]], ..of });
    }
    inputs
}

fn outputs(plant: &HostPlant) -> Vec<Variable> {
    let of = |(index, column): (usize, &mckibben_scenario::PlantColumn)| {
        let (of, what) = column.name.rsplit_once('.').unwrap_or(("", &column.name));
        let sentence = format!("{} of {of}.", capital(&what.replace('_', " ")));
        scalar(Slot::Output(index), column.name.clone(), Causality::Output, column.unit, sentence)
    };
    plant.outputs().iter().enumerate().map(of).collect()
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn parameter(index: usize, number: &DocumentNumber) -> Variable {
    let Parameter { unit, range, meaning, .. } = number.parameter;
    let causality = Causality::Parameter { is_tunable: is_tunable(number) };
    let of = scalar(Slot::Parameter(index), number.path.clone(), causality, unit, (*meaning).to_owned());
    let finite = |number: f64| Some(number).filter(|number| number.is_finite());
    Variable { min: finite(range.low), max: finite(range.high), start: vec![number.value], ..of }
}

/// States, their derivatives and event indicators.
fn inner(plant: &HostPlant, states: &[usize], indicators: usize) -> Vec<Variable> {
    let names = state_names(plant);
    let mut inner = Vec::new();
    for (index, place) in states.iter().enumerate() {
        let (name, unit, rate) = &names[*place];
        let sentence = "Continuous state.".to_owned();
        inner.push(scalar(Slot::State(index), format!("state.{name}"), Causality::Local, unit, sentence));
        let sentence = "Rate of the continuous state.".to_owned();
        inner.push(scalar(Slot::Derivative(index), format!("der(state.{name})"), Causality::Local, rate, sentence));
    }
    for index in 0..indicators {
        let sentence = "Positive while the mode lasts.".to_owned();
        inner.push(scalar(Slot::Indicator(index), format!("indicator[{index}]"), Causality::Local, "", sentence));
    }
    inner
}

/// Name, unit and unit of the rate of every state of a plant.
fn state_names(plant: &HostPlant) -> Vec<(String, &'static str, &'static str)> {
    let indices = plant.steps().plant().indices();
    let StateIndices { mechanisms, actuators, nodes, branches, states, .. } = indices;
    let mut names: Vec<_> = (0..*states).map(|place| (format!("{place}"), "", "1/s")).collect();
    let experiment = plant.experiment();
    let coordinates = experiment.coordinates();
    for (m, here) in mechanisms.iter().enumerate() {
        for k in 0..here.coordinates {
            let of = coordinates.iter().find(|its| its.mechanism == m && its.index == k);
            // What has no name in the file is the load of one actuator.
            let own = || indices.members[m].first().map(|actuator| format!("{}.load", plant.actuators()[*actuator]));
            let name = of.map(|its| its.name.clone()).or_else(own).unwrap_or_else(|| format!("mechanism_{m}.{k}"));
            let (unit, rate, acceleration) = match of {
                Some(its) if its.is_angle => ("rad", "rad/s", "rad/s^2"),
                _ => ("m", "m/s", "m/s^2"),
            };
            names[here.position(k)] = (format!("{name}.position"), unit, rate);
            names[here.rate(k)] = (format!("{name}.rate"), rate, acceleration);
        }
    }
    for (i, here) in actuators.iter().enumerate() {
        let name = &plant.actuators()[i];
        names[here.pressure] = (format!("{name}.absolute_pressure"), "Pa", "Pa/s");
        names[here.mass()] = (format!("{name}.air_mass"), "kg", "kg/s");
        for (place, what) in [(here.length, "length"), (here.bristles, "deflection")] {
            if let Some(place) = place {
                names[place] = (format!("{name}.{what}"), "m", "m/s");
            }
        }
        for (branch, place) in here.branches().enumerate() {
            names[place] = (format!("{name}.relaxed_length_{}", branch + 1), "m", "m/s");
        }
    }
    for (node, place) in nodes.iter().enumerate() {
        if let Some(place) = place {
            names[*place] = (experiment.name_of_node(node, "absolute_pressure"), "Pa", "Pa/s");
        }
    }
    for (branch, place) in branches.iter().enumerate() {
        if let Some(place) = place {
            names[*place] = (experiment.name_of_flow(branch, "mass_flow"), "kg/s", "kg/s^2");
        }
    }
    names
}

/// The outputs that are elements of arrays.
fn elements(plant: &HostPlant) -> [Vec<usize>; 3] {
    let mut of = [Vec::new(), Vec::new(), Vec::new()];
    for (index, column) in plant.outputs().iter().enumerate() {
        match column.quantity() {
            Some(PlantQuantity::Tension(_)) => of[0].push(index),
            Some(PlantQuantity::GaugePressure(_)) => of[1].push(index),
            Some(PlantQuantity::MassFlow(_)) => of[2].push(index),
            _ => {}
        }
    }
    of
}

fn arrays(plant: &HostPlant, elements: &[Vec<usize>; 3]) -> Vec<Variable> {
    let inputs = inputs(plant);
    let starts = |wanted: fn(Slot) -> bool| -> Vec<f64> {
        inputs.iter().filter(|its| wanted(its.slot)).map(|its| its.start[0]).collect()
    };
    let (discrete, smooth) = (Causality::Input { is_discrete: true }, Causality::Input { is_discrete: false });
    let mut units = plant.commands().iter().map(|input| input.mode.range().2);
    let first = units.next().unwrap_or("");
    let unit = if units.all(|unit| unit == first) { first } else { "" };
    let rows = [
        ("commands", discrete, unit, starts(|slot| matches!(slot, Slot::Command(_))), "Commands of all valves."),
        ("distances", smooth, "m", starts(|slot| matches!(slot, Slot::Distance(_))), "Distances of all actuators."),
        ("rates", smooth, "m/s", starts(|slot| matches!(slot, Slot::Rate(_))), "Rates of the distances."),
        ("tensions", Causality::Output, "N", Vec::new(), "Tensions of all actuators."),
        ("pressures", Causality::Output, "Pa", Vec::new(), "Gauge pressures in all actuators."),
        ("mass_flows", Causality::Output, "kg/s", Vec::new(), "Mass flows into all actuators."),
    ];
    let mut arrays = Vec::new();
    for (place, (name, causality, unit, start, sentence)) in rows.into_iter().enumerate() {
        let count = if place < 3 { start.len() } else { elements[place - 3].len() };
        if count > 0 {
            let of = scalar(Slot::Array(Array::ALL[place]), name.to_owned(), causality, unit, sentence.to_owned());
            arrays.push(Variable { start, dimension: Some(count), ..of });
        }
    }
    arrays
}
