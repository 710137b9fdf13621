//! The linear model of a file of many actuators: its point, in words, as JSON and as a script, with the names of the file.
//!
//! | requested | the valves | the point |
//! |---|---|---|
//! | nothing, with pulsed or proportional valves | by their commands, pulses on average | where all is balanced under these |
//! | `pwm` | by the commands that hold the initial gauge pressures, those of controllers held shut | the balance at these |
//! | else, and with controllers | held shut | the balance at the initial gauge pressures |

use super::account::{self, Account, Block, Line, around, is_held};
use super::{Request, export, oscillations};
use crate::failure::Failure;
use crate::quantities::{percent, quantity};
use mckibben::Error;
use mckibben::linearize::{Controllability, Pole, Signal, StateSpace};
use mckibben::network::{BranchKind, NodeKind};
use mckibben::plant::{
    Plant, PlantAir, PlantBalance, PlantInput, PlantLinearization, PlantOutput, PlantState, PlantStateSpace,
    linearize_plant,
};
use mckibben::valve::{Command, Port};
use mckibben_scenario::{Assumed, PlantControl, PlantExperiment};
use std::f64::consts::TAU;

/// Columns of the matrices that are printed at most.
const MOST_COLUMNS: usize = 10;

/// A mass flow in kg/s that is rounding.
const NO_FLOW: f64 = 1e-9;

/// A gauge pressure in Pa that is rounding of the atmosphere's.
const NO_PRESSURE: f64 = 1.0;

/// What stands in place of the Coulomb friction of an actuator.
pub(super) struct Damping<'m> {
    /// Name of the actuator.
    pub(super) of: &'m str,
    /// Of its oscillation in m.
    pub(super) amplitude: f64,
    /// Angular frequency of its oscillation in rad/s.
    pub(super) frequency: f64,
    /// Viscous damping in N·s/m.
    pub(super) damping: f64,
}

/// A plant's linear model with what is known about it.
pub(super) struct PlantModel {
    pub(super) name: String,
    pub(super) linear: PlantLinearization,
    pub(super) system: StateSpace,
    pub(super) poles: Vec<Pole>,
    /// What each input reaches.
    pub(super) reach: Vec<Controllability>,
    /// By how much later in s than each input its effect begins.
    pub(super) delays: Vec<f64>,
    /// Amplitude in m and angular frequency in rad/s of each actuator's oscillation, where Coulomb friction was replaced; none of
    /// an actuator that does not swing.
    pub(super) oscillations: Option<Vec<Option<(f64, f64)>>>,
    pub(super) assumed: Vec<Assumed>,
    experiment: PlantExperiment,
    balance: PlantBalance,
}

impl PlantModel {
    /// The requested model.
    pub(super) fn new(
        name: &str,
        of: &PlantExperiment,
        request: &Request,
        assumed: Vec<Assumed>,
    ) -> Result<Self, Failure> {
        refuse(request)?;
        let pressures = || of.start.air.iter().map(|air| air.gauge_pressure).collect();
        let driven = of.plant.network().valves.iter().any(|valve| valve.command.is_continuous());
        let balance = if request.pwm {
            PlantBalance::DrivenAt(pressures())
        } else if driven && of.controls.is_empty() {
            PlantBalance::Driven
        } else {
            PlantBalance::Shut(pressures())
        };
        let count = of.plant.actuators().len();
        let air = request.temperature.map_or(PlantAir::Start, |kelvin| PlantAir::Temperatures(vec![kelvin; count]));
        let plant = if request.pwm { without_controllers(of)? } else { of.plant.clone() };
        let mut linear = linearize_plant(&plant, &of.start, &balance, &air)
            .map_err(|error| if request.pwm { of_commands(of, error) } else { error.into() })?;
        let swings = request.amplitude.map(|amplitude| oscillations(&linear, amplitude)).transpose()?;
        if let Some(swings) = &swings {
            linear = linear.with_equivalent_damping(swings)?;
        }
        let system = if request.all_states { linear.system.clone() } else { linear.minimal() };
        let reach = (0..system.inputs.len()).map(|input| linear.controllability(&system, input));
        let (reach, poles) = (reach.collect::<Result<_, _>>()?, system.poles()?);
        let delays = system.inputs.iter().map(|input| linear.delay(input)).collect();
        let system = by_names(of, &linear, &system);
        let (name, experiment) = (name.to_owned(), of.clone());
        Ok(Self { name, linear, system, poles, reach, delays, oscillations: swings, assumed, experiment, balance })
    }

    /// How the valves are taken, in a word of the file.
    pub(super) fn kind(&self) -> &'static str {
        match self.balance {
            PlantBalance::Shut(_) => "plant-held-valves",
            _ => "plant-driven-valves",
        }
    }

    fn valves(&self) -> &'static str {
        match self.balance {
            PlantBalance::Shut(_) => "all valves held shut",
            PlantBalance::Driven => "valves by their commands, pulses on average",
            PlantBalance::DrivenAt(_) if self.experiment.controls.is_empty() => {
                "valves by the commands that hold the initial pressures"
            }
            PlantBalance::DrivenAt(_) => {
                "valves by the commands that hold the initial pressures, those under controllers held shut"
            }
        }
    }

    /// What a valve is of.
    pub(super) fn valve(&self, valve: usize) -> String {
        names_of(&self.experiment).valve(valve)
    }

    /// The outputs of a figure: the first coordinates that have names, else lengths.
    pub(super) fn drawn(&self) -> Vec<String> {
        let coordinates = self.experiment.coordinates();
        let angles =
            coordinates.iter().map(|of| format!("{}.{}", of.name, if of.is_angle { "angle" } else { "position" }));
        angles.chain(self.experiment.names.actuators.iter().map(|name| format!("{name}.length"))).collect()
    }

    /// The caption of a figure.
    pub(super) fn caption(&self) -> String {
        let point = &self.linear.point;
        let actuators = self.experiment.names.actuators.iter().enumerate();
        let gauge = actuators.map(|(i, name)| format!("{name} {}", quantity(point.gauge_pressure(i).0, "Pa")));
        let (gauge, delays) = (gauge.collect::<Vec<_>>().join(", "), account::left_out(&self.delays));
        format!("Gauge pressures: {gauge}; {}{delays}.", self.valves())
    }

    /// The values at the operating point, each name with its unit at the end.
    pub(super) fn point(&self) -> Vec<(String, f64)> {
        let (of, point) = (&self.experiment, &self.linear.point);
        let places = point.plant.indices();
        let mut values = Vec::new();
        for its in of.coordinates() {
            let column = if its.is_angle { "angle_rad" } else { "position_m" };
            let place = places.mechanisms[its.mechanism].position(its.index);
            values.push((format!("{}.{column}", its.name), point.state[place]));
        }
        for (i, name) in of.names.actuators.iter().enumerate() {
            let mut value = |column: &str, value: f64| values.push((format!("{name}.{column}"), value));
            value("length_m", point.lengths[i]);
            value("tension_n", point.tensions[i]);
            value("gauge_pressure_pa", point.gauge_pressure(i).0);
            value("temperature_k", point.temperature(i));
            let [less, more] = self.linear.coulomb_bounds(i);
            value("coulomb_bound_n", more);
            value("coulomb_bound_below_n", less);
        }
        for (name, node) in &of.names.nodes {
            let slot = places.nodes[*node];
            let gauge = slot.map(|slot| point.state[slot] - point.plant.network().atmosphere);
            values.extend(gauge.map(|gauge| (format!("{name}.gauge_pressure_pa"), gauge)));
        }
        let inputs = names_of(of);
        for (input, number) in &point.inputs {
            let Signal { name, unit, .. } = inputs.input(input, &point.plant);
            let unit = unit.to_lowercase().replace(['*', '/'], "_");
            let ending = if unit.is_empty() { String::new() } else { format!("_{unit}") };
            values.push((format!("{name}{ending}"), *number));
        }
        values
    }

    /// How an actuator oscillates where its Coulomb friction was replaced.
    fn damping(&self, actuator: usize) -> Option<Damping<'_>> {
        let (amplitude, frequency) = *self.oscillations.as_ref()?.get(actuator)?.as_ref()?;
        let damping = self.linear.equivalent_damping(actuator, amplitude, frequency).ok()?;
        Some(Damping { of: &self.experiment.names.actuators[actuator], amplitude, frequency, damping })
    }

    /// These of each actuator that has them; none where Coulomb friction was not replaced.
    pub(super) fn dampings(&self) -> Option<Vec<Damping<'_>>> {
        let actuators = 0..self.experiment.names.actuators.len();
        self.oscillations.as_ref().map(|_| actuators.filter_map(|i| self.damping(i)).collect())
    }

    /// The model in words and tables.
    pub(super) fn account(&self) -> Account {
        let (of, point) = (&self.experiment, &self.linear.point);
        let places = point.plant.indices();
        let mut lines = Vec::new();
        for its in of.coordinates() {
            let place = places.mechanisms[its.mechanism].position(its.index);
            lines.push(Line::new(its.name, quantity(point.state[place], if its.is_angle { "rad" } else { "m" })));
        }
        for (i, name) in of.names.actuators.iter().enumerate() {
            let taut = if point.is_taut(i) { ", on the taut braid" } else { "" };
            let bounds = self.linear.coulomb_bounds(i);
            let sticks =
                if is_held(bounds) { format!(", sticks within {}", around(bounds, "N")) } else { String::new() };
            let [gauge, length, tension] =
                [(point.gauge_pressure(i).0, "Pa"), (point.lengths[i], "m"), (point.tensions[i], "N")]
                    .map(|(value, unit)| quantity(value, unit));
            let flow = point.input(PlantInput::MassFlow { actuator: i }).unwrap_or_default();
            let (kept, doubt) = kept(flow, 0.0);
            let is_still = self.oscillations.as_ref().is_some_and(|all| all[i].is_none()) && is_held(bounds);
            let still = "it takes part in no oscillation, so its Coulomb friction is left out";
            let doubt = [doubt, if is_still { still } else { "" }].into_iter().filter(|doubt| !doubt.is_empty());
            let doubt = doubt.map(str::to_owned).reduce(|first, second| format!("{first}; {second}"));
            let warning = account::doubts(doubt, &point.plant.actuators()[i].actuator);
            let damped = self.damping(i).filter(|of| of.damping > 0.0);
            let damped = damped.map(|Damping { frequency, damping, .. }| {
                let [damping, frequency] = [quantity(damping, "N*s/m"), quantity(frequency / TAU, "Hz")];
                format!(", Coulomb friction as {damping} at {frequency}")
            });
            let damped = damped.unwrap_or_default();
            let value = format!("{gauge} gauge{kept}, {length}{taut}, {tension}{sticks}{damped}");
            lines.push(Line { warning, ..Line::new(name, value) });
        }
        lines.extend(self.supplies());
        for average in &self.linear.averages {
            let text = format!(
                "{} at {}, open to the supply for {} of the period",
                percent(average.duty),
                quantity(average.frequency, "Hz"),
                percent(average.shares[0]),
            );
            let warning = match average.follows() {
                true => account::of_ripple(average, "the ripple is too large for the mean flow to be trusted"),
                false => account::unanswered(average),
            };
            lines.push(Line { warning, ..Line::new(self.valve(average.valve), text) });
        }
        lines.extend(account::of_spools(&self.linear, |valve| self.valve(valve)));
        let StateSpace { states, inputs, outputs, .. } = &self.system;
        let mut blocks = vec![Block::of_lines("", lines)];
        if states.len() + inputs.len() <= MOST_COLUMNS {
            blocks.push(Block::of_table("Model", account::matrices(&self.system)));
        } else {
            let listed = |signals: &[Signal]| {
                let names: Vec<&str> = signals.iter().map(|signal| signal.name.as_str()).collect();
                format!("{}: {}", signals.len(), names.join(", "))
            };
            let lines = [("states", listed(states)), ("inputs", listed(inputs)), ("outputs", listed(outputs))];
            let lines = lines.into_iter().map(|(name, value)| Line::new(name, value)).collect();
            blocks.push(Block::of_lines("Model, whose matrices are in its files", lines));
        }
        blocks.extend(account::dynamics(&self.system, &self.poles, &self.reach));
        let notes = account::of_delays(&self.system, &self.delays).into_iter().collect();
        Account { title: format!("{}, {}", self.name, self.valves()), blocks, notes }
    }

    /// The pressures of reservoirs and outlets at the point.
    fn supplies(&self) -> Vec<Line> {
        let (of, point) = (&self.experiment, &self.linear.point);
        let line = |(name, node): &(String, usize)| {
            let pressure = point.state[point.plant.indices().nodes[*node]?];
            let network = point.plant.network();
            let delivery = match &network.nodes[*node].kind {
                NodeKind::Reservoir(reservoir) => reservoir.delivery(pressure),
                _ => 0.0,
            };
            let flow = point.input(PlantInput::NodeFlow { node: *node }).unwrap_or_default();
            let (text, warning) = kept(flow, delivery);
            let gauge = quantity(pressure - network.atmosphere, "Pa");
            Some(Line { warning: warning.to_owned(), ..Line::new(name, format!("{gauge} gauge{text}")) })
        };
        of.names.nodes.iter().filter_map(line).collect()
    }

    /// The model as a script for MATLAB and Octave.
    pub(super) fn matlab(&self) -> String {
        let kind = format!("plant, {}", self.valves());
        export::script((&self.name, &kind), &self.point(), (&self.system, &self.delays), &self.poles)
    }
}

/// A mass flow in kg/s from outside that keeps a pressure, in words, and a warning unless a compressor delivers as much.
fn kept(flow: f64, delivery: f64) -> (String, &'static str) {
    let warning = match delivery {
        _ if flow.abs() <= NO_FLOW => return (String::new(), ""),
        _ if (0.0..=delivery).contains(&flow) => "",
        0.0 => "no part of the file brings this mass flow: without it the pressure does not last",
        _ => "its compressor does not deliver this mass flow: without it the pressure does not last",
    };
    (format!(", kept by a mass flow of {} from outside", quantity(1e3 * flow, "g/s")), warning)
}

/// The plant with no request to the valves that controllers command, which a linear model holds shut.
fn without_controllers(of: &PlantExperiment) -> Result<Plant, Error> {
    let mut network = of.plant.network().clone();
    for control in &of.controls {
        let valves = match control {
            PlantControl::Actuator(of) => std::slice::from_ref(&of.valve),
            PlantControl::Joint(of) => &of.valves[..],
        };
        for valve in valves {
            network.valves[*valve].command = Command::Table { time: Vec::new(), request: Vec::new() };
        }
    }
    Plant::new(of.plant.actuators().to_vec(), network, of.plant.mechanisms().to_vec())
}

/// Refuses options of one actuator or of one joint alone.
fn refuse(request: &Request) -> Result<(), Failure> {
    match request.first_beyond(&["pwm", "amplitude"]) {
        None => Ok(()),
        Some(name) => Err(Failure::input(
            format!("the scenario has actuators with names, and `{name}` names no one of them"),
            "set values of the scenario by their paths, such as actuators.flexor.initial.gauge_pressure",
        )),
    }
}

/// An error of the search for commands, with the actuators that start at the atmosphere, whose pressure no command of a valve holds.
fn of_commands(of: &PlantExperiment, error: Error) -> Failure {
    let Error::NoSolution { what, remedy } = error else { return error.into() };
    let starts = of.names.actuators.iter().zip(&of.names.valves).zip(&of.start.air);
    let empty = starts.filter(|((_, valve), air)| valve.is_some() && air.gauge_pressure.0.abs() < NO_PRESSURE);
    let empty: Vec<&str> = empty.map(|((name, _), _)| name.as_str()).collect();
    let Some(first) = empty.first() else { return error.into() };
    Failure::input(
        format!("{what}; initial.gauge_pressure is 0 of {}", empty.join(", ")),
        format!("{remedy}; the pressure is actuators.{first}.initial.gauge_pressure"),
    )
}

/// What a file calls the parts that signals are of.
struct Names<'e>(&'e PlantExperiment);

fn names_of(of: &PlantExperiment) -> Names<'_> {
    Names(of)
}

impl Names<'_> {
    fn actuator(&self, index: usize) -> &str {
        self.0.names.actuators.get(index).map_or("", String::as_str)
    }

    /// A coordinate, by its own name or by that of the actuator whose load it is.
    fn coordinate(&self, mechanism: usize, coordinate: usize) -> (String, bool) {
        let named = self.0.coordinates().into_iter().find(|of| of.mechanism == mechanism && of.index == coordinate);
        match named {
            Some(of) => (of.name, of.is_angle),
            None => {
                let alone = self.0.plant.actuators().iter().position(|mounted| mounted.mechanism == mechanism);
                (format!("{}.load", self.actuator(alone.unwrap_or(usize::MAX))), false)
            }
        }
    }

    fn valve(&self, valve: usize) -> String {
        let names = &self.0.names;
        match names.valves.iter().position(|its| *its == Some(valve)) {
            Some(index) => self.actuator(index).to_owned(),
            None => {
                let of_supply = names.supply_valves.iter().find(|(_, its)| *its == valve);
                of_supply.map_or_else(|| self.inlet(valve), |(name, _)| name.clone())
            }
        }
    }

    /// The flow path without a command that feeds a supply, by that supply: it has no other valve.
    fn inlet(&self, valve: usize) -> String {
        let is_its = |kind: &BranchKind| matches!(kind, BranchKind::Path { valve: its, .. } if *its == valve);
        let path = self.0.plant.network().branches.iter().find(|branch| is_its(&branch.kind));
        match path.map_or("", |path| self.0.owner_of_node(path.to)) {
            "" => format!("valve-{valve}"),
            supply => supply.to_owned(),
        }
    }

    fn node(&self, node: usize) -> String {
        self.0.name_of_node(node, "pressure")
    }

    fn state(&self, of: &PlantState, unit: &'static str) -> Signal {
        let name = match *of {
            PlantState::Position { mechanism, coordinate } => match self.coordinate(mechanism, coordinate) {
                (name, true) => format!("{name}.angle"),
                (name, false) => format!("{name}.position"),
            },
            PlantState::Velocity { mechanism, coordinate } => match self.coordinate(mechanism, coordinate) {
                (name, true) => format!("{name}.angular_velocity"),
                (name, false) => format!("{name}.velocity"),
            },
            PlantState::Pressure { actuator } => format!("{}.pressure", self.actuator(actuator)),
            PlantState::AirMass { actuator } => format!("{}.air_mass", self.actuator(actuator)),
            PlantState::Length { actuator } => format!("{}.length", self.actuator(actuator)),
            PlantState::Bristles { actuator } => format!("{}.bristles", self.actuator(actuator)),
            PlantState::Branch { actuator, branch } => {
                format!("{}.relaxed_length_{}", self.actuator(actuator), branch + 1)
            }
            PlantState::NodePressure { node } => self.node(node),
            PlantState::BranchFlow { branch } => self.0.name_of_flow(branch, "flow"),
            PlantState::SpoolPosition { valve } => format!("{}.spool_position", self.valve(valve)),
            PlantState::SpoolVelocity { valve } => format!("{}.spool_velocity", self.valve(valve)),
        };
        Signal::new(name, unit)
    }

    fn input(&self, of: &PlantInput, plant: &Plant) -> Signal {
        let name = match *of {
            PlantInput::Duty { valve } => format!("{}.duty", self.valve(valve)),
            PlantInput::SetPoint { valve } => format!("{}.set_point", self.valve(valve)),
            PlantInput::SpoolCommand { valve } => format!("{}.spool_command", self.valve(valve)),
            PlantInput::Opening { valve, port: Port::Supply } => format!("{}.supply_opening", self.valve(valve)),
            PlantInput::Opening { valve, port: Port::Exhaust } => format!("{}.exhaust_opening", self.valve(valve)),
            PlantInput::SupplyPressure { node } => {
                let is_set = matches!(plant.network().nodes[node].kind, NodeKind::Outlet { .. });
                self.0.name_of_node(node, if is_set { "supply_set_point" } else { "supply_pressure" })
            }
            PlantInput::MassFlow { actuator } => format!("{}.mass_flow", self.actuator(actuator)),
            PlantInput::NodeFlow { node } => self.0.name_of_node(node, "mass_flow"),
            PlantInput::Force { mechanism, coordinate } => match self.coordinate(mechanism, coordinate) {
                (name, true) => format!("{name}.torque"),
                (name, false) => format!("{name}.force"),
            },
            PlantInput::Motion { mechanism, coordinate } => {
                format!("{}.motion", self.coordinate(mechanism, coordinate).0)
            }
            PlantInput::MotionRate { mechanism, coordinate } => {
                format!("{}.motion_rate", self.coordinate(mechanism, coordinate).0)
            }
            PlantInput::GivenPressure { actuator } => format!("{}.given_pressure", self.actuator(actuator)),
        };
        Signal::new(name, of.unit(plant))
    }

    fn output(&self, of: &PlantOutput, unit: &'static str) -> Signal {
        let name = match *of {
            PlantOutput::Length { actuator } => format!("{}.length", self.actuator(actuator)),
            PlantOutput::LengthRate { actuator } => format!("{}.velocity", self.actuator(actuator)),
            PlantOutput::Pressure { actuator } => format!("{}.pressure", self.actuator(actuator)),
            PlantOutput::Tension { actuator } => format!("{}.tension", self.actuator(actuator)),
            PlantOutput::Position { mechanism, coordinate } => match self.coordinate(mechanism, coordinate) {
                (name, true) => format!("{name}.angle"),
                (name, false) => format!("{name}.position"),
            },
            PlantOutput::Velocity { mechanism, coordinate } => match self.coordinate(mechanism, coordinate) {
                (name, true) => format!("{name}.angular_velocity"),
                (name, false) => format!("{name}.velocity"),
            },
            PlantOutput::ActuatorForce { mechanism, coordinate } => match self.coordinate(mechanism, coordinate) {
                (name, true) => format!("{name}.actuator_torque"),
                (name, false) => format!("{name}.actuator_force"),
            },
            PlantOutput::NodePressure { node } => self.node(node),
        };
        Signal::new(name, unit)
    }
}

/// The model with the names of the file.
fn by_names(of: &PlantExperiment, linear: &PlantLinearization, system: &PlantStateSpace) -> StateSpace {
    let (names, plant) = (names_of(of), &linear.point.plant);
    let states = system.states.iter().map(|state| names.state(state, state.unit(plant)));
    let inputs = system.inputs.iter().map(|input| names.input(input, plant));
    let outputs = system.outputs.iter().map(|output| names.output(output, output.unit(plant)));
    system.named([states.enumerate().collect(), inputs.enumerate().collect(), outputs.enumerate().collect()])
}
