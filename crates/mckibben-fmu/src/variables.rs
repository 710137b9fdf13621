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

mod sentences;

use crate::tunable::is_tunable;
use mckibben::parameter::Parameter;
use mckibben::plant::StateIndices;
use mckibben_run::host::{CommandInput, CommandMode, HostPlant, Motion};
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
        all.extend(parameters.iter().enumerate().map(|(index, number)| parameter(document, index, number)));
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
        unit: unit_of(unit),
        min: None,
        max: None,
        start: Vec::new(),
        dimension: None,
        description,
    }
}

/// A unit as keys write it: columns of a run write a power by its digit alone.
fn unit_of(unit: &'static str) -> &'static str {
    match unit {
        "m2" => "m^2",
        "m3" => "m^3",
        other => other,
    }
}

/// The sentence of a command.
fn of_command(plant: &HostPlant, input: &CommandInput) -> String {
    let parts: Vec<String> =
        input.actuators.iter().map(|actuator| sentences::actuator(&plant.actuators()[*actuator])).collect();
    let of = parts.join(" and ");
    match input.mode {
        CommandMode::Duty(_) => format!("Duty cycle of the pulses of the valve of {of}."),
        CommandMode::Request => format!("Request to the valve of {of}: 1 to fill, 0 to hold, -1 to exhaust."),
        CommandMode::Position => {
            format!("Position of the spool of the valve of {of}, -1 (exhaust open) to 1 (supply open).")
        }
        CommandMode::SetPoint { .. } => format!("Set point of the gauge pressure of the regulator of {of}."),
    }
}

/// A command that leaves a valve as it is before the first one, where the valve can be given it: a set point is the initial gauge
/// pressure of the actuator, and other valves rest at zero.
fn first_command(plant: &HostPlant, index: usize) -> f64 {
    let input = &plant.commands()[index];
    let (low, high, _) = input.mode.range();
    let initial = input.actuators.first().map(|actuator| plant.experiment().start.air[*actuator].gauge_pressure.0);
    let rest = initial.filter(|_| matches!(input.mode, CommandMode::SetPoint { .. })).unwrap_or(0.0);
    [rest, 0.0, low, high].into_iter().find(|number| plant.accepts(index, *number)).unwrap_or(0.0)
}

fn inputs(plant: &HostPlant) -> Vec<Variable> {
    let mut inputs = Vec::new();
    for (index, input) in plant.commands().iter().enumerate() {
        let (low, high, unit) = input.mode.range();
        let causality = Causality::Input { is_discrete: true };
        let of = scalar(Slot::Command(index), input.name.clone(), causality, unit, of_command(plant, input));
        inputs.push(Variable {
            min: Some(low),
            max: Some(high).filter(|high| high.is_finite()),
            start: vec![first_command(plant, index)],
            ..of
        });
    }
    if plant.motion() == Motion::Scenario {
        return inputs;
    }
    let (indices, state) = (plant.steps().plant().indices().mechanisms[0], plant.steps().state());
    let causality = Causality::Input { is_discrete: false };
    for (index, name) in plant.actuators().iter().enumerate() {
        let of_actuator = sentences::actuator(name);
        let sentence =
            format!("Distance between the ends of {of_actuator}, with its tendon. Must be greater than 0 m.");
        let of = scalar(Slot::Distance(index), format!("{name}.distance"), causality, "m", sentence);
        let most = plant.steps().plant().end_distance(index).ok().flatten().map(|(_, length)| length);
        inputs.push(Variable { max: most, start: vec![state[indices.position(index)]], ..of });
        let sentence = format!("Rate of the distance between the ends of {of_actuator}, positive when it grows.");
        let of = scalar(Slot::Rate(index), format!("{name}.rate"), causality, "m/s", sentence);
        inputs.push(Variable { start: vec![state[indices.rate(index)]], ..of });
    }
    inputs
}

fn outputs(plant: &HostPlant) -> Vec<Variable> {
    let of = |(index, column): (usize, &mckibben_scenario::PlantColumn)| {
        let sentence = sentences::column(plant, column);
        scalar(Slot::Output(index), column.name.clone(), Causality::Output, column.unit, sentence)
    };
    plant.outputs().iter().enumerate().map(of).collect()
}

/// A parameter. FMI's ranges include their ends, so an end that is excluded stands in the description alone.
fn parameter(document: &Document, index: usize, number: &DocumentNumber) -> Variable {
    let Parameter { unit, range, .. } = number.parameter;
    let causality = Causality::Parameter { is_tunable: is_tunable(document, number) };
    let sentence = sentences::parameter(number.parameter);
    let of = scalar(Slot::Parameter(index), number.path.clone(), causality, unit, sentence);
    let end = |number: f64, is_included: bool| Some(number).filter(|number| is_included && number.is_finite());
    let (min, max) = (end(range.low, range.low_included), end(range.high, range.high_included));
    Variable { min, max, start: vec![number.value], ..of }
}

/// States, their derivatives and event indicators.
fn inner(plant: &HostPlant, states: &[usize], indicators: usize) -> Vec<Variable> {
    let names = state_names(plant);
    let mut inner = Vec::new();
    for (index, place) in states.iter().enumerate() {
        let StateName { name, unit, rate, sentence } = &names[*place];
        inner.push(scalar(Slot::State(index), format!("state.{name}"), Causality::Local, unit, sentence.clone()));
        let sentence = format!("Time derivative of `state.{name}`.");
        inner.push(scalar(Slot::Derivative(index), format!("der(state.{name})"), Causality::Local, rate, sentence));
    }
    for index in 0..indicators {
        let place = index + 1;
        let sentence = format!(
            "Guard {place} of the present discrete state, positive until its event; 1 where there are fewer guards."
        );
        inner.push(scalar(Slot::Indicator(index), format!("indicator[{index}]"), Causality::Local, "", sentence));
    }
    inner
}

/// What a state of a plant is called.
struct StateName {
    name: String,
    unit: &'static str,
    /// The unit of its rate.
    rate: &'static str,
    /// What it is.
    sentence: String,
}

/// Name, units and sentence of every state of a plant.
fn state_names(plant: &HostPlant) -> Vec<StateName> {
    let of = |name: String, unit, rate, sentence: String| StateName { name, unit, rate, sentence };
    let indices = plant.steps().plant().indices();
    let StateIndices { mechanisms, actuators, nodes, branches, states, .. } = indices;
    let unnamed = |place| of(format!("{place}"), "", "1/s", format!("State {place} of the plant."));
    let mut names: Vec<StateName> = (0..*states).map(unnamed).collect();
    let experiment = plant.experiment();
    let coordinates = experiment.coordinates();
    for (m, here) in mechanisms.iter().enumerate() {
        for k in 0..here.coordinates {
            let its = coordinates.iter().find(|its| its.mechanism == m && its.index == k);
            // What has no name in the file is the load of one actuator.
            let owner = indices.members[m].first().map(|actuator| &plant.actuators()[*actuator]);
            let own = || owner.map(|owner| format!("{owner}.load"));
            let name = its.map(|its| its.name.clone()).or_else(own).unwrap_or_else(|| format!("mechanism_{m}.{k}"));
            let part = match (its, owner) {
                (Some(its), _) if its.is_angle => format!("the joint `{name}`"),
                (None, Some(owner)) => format!("the load of {}", sentences::actuator(owner)),
                _ => format!("`{name}`"),
            };
            let (unit, rate, acceleration, words) = match its {
                Some(its) if its.is_angle => ("rad", "rad/s", "rad/s^2", ["Angle", "Angular velocity"]),
                _ => ("m", "m/s", "m/s^2", ["Position", "Velocity"]),
            };
            let [position, velocity] = words.map(|word| format!("{word} of {part}."));
            names[here.position(k)] = of(format!("{name}.position"), unit, rate, position);
            names[here.rate(k)] = of(format!("{name}.rate"), rate, acceleration, velocity);
        }
    }
    for (i, here) in actuators.iter().enumerate() {
        let name = &plant.actuators()[i];
        let part = sentences::actuator(name);
        let pressure = format!("Absolute pressure of the air in {part}.");
        names[here.pressure] = of(format!("{name}.absolute_pressure"), "Pa", "Pa/s", pressure);
        names[here.mass()] = of(format!("{name}.air_mass"), "kg", "kg/s", format!("Mass of the air in {part}."));
        for (place, what, words) in [
            (here.length, "length", format!("Length of {part}, between its attachments.")),
            (here.bristles, "deflection", format!("Bristle deflection of the friction of {part}.")),
        ] {
            if let Some(place) = place {
                names[place] = of(format!("{name}.{what}"), "m", "m/s", words);
            }
        }
        for (branch, place) in here.branches().enumerate() {
            let branch = branch + 1;
            let words = format!("Length at which viscoelastic branch {branch} of {part} is relaxed.");
            names[place] = of(format!("{name}.relaxed_length_{branch}"), "m", "m/s", words);
        }
    }
    for (node, place) in nodes.iter().enumerate() {
        if let Some(place) = place {
            let name = experiment.name_of_node(node, "absolute_pressure");
            let sentence = sentences::of_air(plant, &name);
            names[*place] = of(name, "Pa", "Pa/s", sentence);
        }
    }
    for (branch, place) in branches.iter().enumerate() {
        if let Some(place) = place {
            let name = experiment.name_of_flow(branch, "mass_flow");
            let sentence = sentences::of_air(plant, &name);
            names[*place] = of(name, "kg/s", "kg/s^2", sentence);
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
