//! What there is to record of a plant, by names: the numbers of each actuator, mechanism and supply.
//!
//! A column is called as the file calls the part: `flexor.gauge_pressure`, in a table `flexor.gauge_pressure_pa`.

use super::{MechanismNames, PlantExperiment};
use crate::sweep::column_of;
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::network::{Network, NodeKind};
use mckibben::plant::{Plant, PlantSample};
use mckibben::{Real, Scalar};

/// A quantity of a plant, with the indices of its part.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum PlantQuantity {
    /// Length of an actuator in m: the distance between its attachments, which may be below the shortest where it is slack.
    Length(usize),
    /// Contraction of an actuator, `(L_max − L)/L_max`.
    Contraction(usize),
    /// Velocity of lengthening of an actuator in m/s.
    Velocity(usize),
    /// Absolute pressure in an actuator in Pa.
    Pressure(usize),
    /// Gauge pressure in an actuator in Pa.
    GaugePressure(usize),
    /// Mass of the air in an actuator in kg.
    AirMass(usize),
    /// Temperature of the air in an actuator in K.
    Temperature(usize),
    /// Volume of the air in an actuator in m³.
    Volume(usize),
    /// Tension of an actuator in N.
    Tension(usize),
    /// Mass flow into an actuator in kg/s.
    MassFlow(usize),
    /// Distance in m that an actuator and its tendon span.
    LoadDistance(usize),
    /// Rate of that distance in m/s.
    LoadVelocity(usize),
    /// Coordinate of a mechanism in m or rad.
    Position(usize, usize),
    /// Rate of a coordinate in m/s or rad/s.
    Rate(usize, usize),
    /// Force (N) or torque (N·m) of the actuators along a coordinate.
    Force(usize, usize),
    /// Absolute pressure of a node of the air network in Pa.
    NodePressure(usize),
    /// Gauge pressure of a node of the air network in Pa.
    NodeGaugePressure(usize),
    /// Gauge pressure in Pa that the regulating valve of this index is commanded; that of its port, the second index, before
    /// the first command.
    SetPoint(usize, usize),
}

/// What a column holds.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum PlantContent {
    /// A number.
    Number(PlantQuantity),
    /// The open ports of a valve in a word; closed where there is none.
    Ports(Option<usize>),
}

/// A column of a plant's run.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PlantColumn {
    /// Its name without the unit, such as `flexor.gauge_pressure`.
    pub name: String,
    /// SI unit; empty for words.
    pub unit: &'static str,
    /// What it holds.
    pub content: PlantContent,
}

impl PlantQuantity {
    /// Its place among the states of a plant, where it is one of them.
    pub fn state<S: Scalar>(self, plant: &Plant<S>) -> Option<usize> {
        let indices = plant.indices();
        match self {
            Self::Length(i) | Self::LoadDistance(i) => {
                let mounted = &plant.actuators()[i];
                let on_tendon = mounted.tendon.is_some() && matches!(self, Self::Length(_));
                match mounted.coupling {
                    _ if on_tendon => None,
                    Coupling::Direct { coordinate } => Some(indices.mechanisms[mounted.mechanism].position(coordinate)),
                    _ => None,
                }
            }
            Self::Pressure(i) => Some(indices.actuators[i].pressure),
            Self::Position(m, k) => Some(indices.mechanisms[m].position(k)),
            Self::Rate(m, k) => Some(indices.mechanisms[m].rate(k)),
            Self::NodePressure(node) => indices.nodes[node],
            _ => None,
        }
    }

    /// The value in a sample of a plant.
    pub fn of<R: Real>(self, plant: &Plant<R>, sample: &PlantSample<R>) -> R {
        let has_tendon = |i: usize| plant.actuators()[i].tendon.is_some();
        let (actuator, mechanism) = (|i: usize| &sample.actuators[i], |m: usize| &sample.mechanisms[m]);
        match self {
            Self::Length(i) if has_tendon(i) => actuator(i).length,
            Self::Contraction(i) => plant.actuators()[i].actuator.limits().contraction(actuator(i).length),
            Self::Velocity(i) if has_tendon(i) => actuator(i).velocity,
            Self::Length(i) | Self::LoadDistance(i) => actuator(i).distance,
            Self::Velocity(i) | Self::LoadVelocity(i) => actuator(i).rate,
            Self::Pressure(i) => actuator(i).pressure.0,
            Self::GaugePressure(i) => actuator(i).pressure.0 - plant.network().atmosphere,
            Self::AirMass(i) => actuator(i).air_mass,
            Self::Temperature(i) => actuator(i).temperature,
            Self::Volume(i) => actuator(i).volume,
            Self::Tension(i) => actuator(i).tension,
            Self::MassFlow(i) => actuator(i).mass_flow,
            Self::Position(m, k) => mechanism(m).position[k],
            Self::Rate(m, k) => mechanism(m).rate[k],
            Self::Force(m, k) => mechanism(m).actuator_force[k],
            Self::NodePressure(node) => sample.nodes[node].pressure.0,
            Self::NodeGaugePressure(node) => sample.nodes[node].pressure.0 - plant.network().atmosphere,
            Self::SetPoint(valve, port) => {
                let network = plant.network();
                let commanded = network.valves[valve].command.set_point_at(sample.time);
                commanded.unwrap_or_else(|| sample.nodes[port].pressure.0 - network.atmosphere)
            }
        }
    }
}

impl PlantColumn {
    /// A column of a number, by its name without the unit.
    pub fn number(name: String, unit: &'static str, quantity: PlantQuantity) -> Self {
        Self { name, unit, content: PlantContent::Number(quantity) }
    }

    /// Its name in a table, with the unit at its end: `flexor.gauge_pressure_pa`.
    pub fn title(&self) -> String {
        let ending = column_of("", self.unit);
        format!("{}{ending}", self.name)
    }

    /// The quantity, where it is a number.
    pub fn quantity(&self) -> Option<PlantQuantity> {
        match self.content {
            PlantContent::Number(quantity) => Some(quantity),
            PlantContent::Ports(_) => None,
        }
    }
}

/// A coordinate of a mechanism with the name that it has in columns and figures.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Coordinate {
    /// Its name.
    pub name: String,
    /// The mechanism.
    pub mechanism: usize,
    /// The coordinate of that.
    pub index: usize,
    /// Whether it is an angle.
    pub is_angle: bool,
}

impl PlantExperiment {
    /// The coordinates that have names: of every mechanism but the loads of single actuators, whose length says it.
    pub fn coordinates(&self) -> Vec<Coordinate> {
        let mut coordinates = Vec::new();
        for (mechanism, (names, its)) in self.names.mechanisms.iter().zip(self.plant.mechanisms()).enumerate() {
            let MechanismNames { name: Some(name), joints } = names else { continue };
            let of = |name: &String, index, is_angle| Coordinate { name: name.clone(), mechanism, index, is_angle };
            match its {
                Mechanism::Chain(_) => {
                    coordinates.extend(joints.iter().enumerate().map(|(index, joint)| of(joint, index, true)));
                }
                _ => coordinates.push(of(name, 0, false)),
            }
        }
        coordinates
    }

    /// The columns of a run behind that of the time, in their order: those of each actuator, then those of the mechanisms and
    /// of the air.
    pub fn columns(&self) -> Vec<PlantColumn> {
        use PlantQuantity as Q;
        let mut columns = Vec::new();
        let (network, names) = (self.plant.network(), &self.names);
        for (i, name) in names.actuators.iter().enumerate() {
            let mut number = |column: &str, unit, quantity| {
                columns.push(PlantColumn::number(format!("{name}.{column}"), unit, quantity));
            };
            number("length", "m", Q::Length(i));
            number("velocity", "m/s", Q::Velocity(i));
            number("absolute_pressure", "Pa", Q::Pressure(i));
            number("gauge_pressure", "Pa", Q::GaugePressure(i));
            number("air_mass", "kg", Q::AirMass(i));
            number("temperature", "K", Q::Temperature(i));
            number("volume", "m3", Q::Volume(i));
            number("tension", "N", Q::Tension(i));
            number("mass_flow", "kg/s", Q::MassFlow(i));
            columns.push(PlantColumn {
                name: format!("{name}.valve"),
                unit: "",
                content: PlantContent::Ports(names.valves[i]),
            });
            let mut number = |column: &str, unit, quantity| {
                columns.push(PlantColumn::number(format!("{name}.{column}"), unit, quantity));
            };
            if let Some(node) = names.hoses[i] {
                number("hose_absolute_pressure", "Pa", Q::NodePressure(node));
                number("hose_gauge_pressure", "Pa", Q::NodeGaugePressure(node));
            }
            if let Some((valve, node)) = names.valves[i].and_then(|valve| Some((valve, port_of(network, valve)?))) {
                number("regulated_absolute_pressure", "Pa", Q::NodePressure(node));
                number("regulated_gauge_pressure", "Pa", Q::NodeGaugePressure(node));
                number("set_point", "Pa", Q::SetPoint(valve, node));
            }
            if self.plant.actuators()[i].tendon.is_some() {
                number("load_distance", "m", Q::LoadDistance(i));
                number("load_velocity", "m/s", Q::LoadVelocity(i));
            }
        }
        for Coordinate { name, mechanism, index, is_angle } in self.coordinates() {
            let [position, rate, force] = match is_angle {
                true => [("angle", "rad"), ("angular_velocity", "rad/s"), ("torque", "N*m")],
                false => [("position", "m"), ("velocity", "m/s"), ("force", "N")],
            };
            let of = [Q::Position(mechanism, index), Q::Rate(mechanism, index), Q::Force(mechanism, index)];
            for ((column, unit), quantity) in [position, rate, force].into_iter().zip(of) {
                columns.push(PlantColumn::number(format!("{name}.{column}"), unit, quantity));
            }
        }
        for (name, node) in &names.nodes {
            columns.push(PlantColumn::number(format!("{name}.absolute_pressure"), "Pa", Q::NodePressure(*node)));
            columns.push(PlantColumn::number(format!("{name}.gauge_pressure"), "Pa", Q::NodeGaugePressure(*node)));
        }
        for (name, valve) in &names.supply_valves {
            let content = PlantContent::Ports(Some(*valve));
            columns.push(PlantColumn { name: format!("{name}.valve"), unit: "", content });
        }
        columns
    }
}

/// The node that a regulating valve makes its pressure in.
fn port_of(network: &Network, valve: usize) -> Option<usize> {
    network.nodes.iter().position(|node| matches!(node.kind, NodeKind::Port { valve: its, .. } if its == valve))
}
