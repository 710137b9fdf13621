//! The supplies of a plant as nodes of its network, and what its actuators draw from them.

use super::{Inlet, PlantNames, PlantScenario, Store};
use crate::model::{core_actuation, core_hose, core_supply_line, core_valve};
use crate::scenario::{Scenario, Supply};
use mckibben::air::Air;
use mckibben::line::Line;
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{Drawn, SupplyNodes};
use mckibben::simulation::{Actuation, Driven, PressureSeries};
use mckibben::valve::{Command, ExhaustTemperature, FlowLaw, Port, Request, Solenoid, ValveKind};
use mckibben::{Error, parameter as p};

/// A network that is being built.
pub(super) struct Builder<'s> {
    pub(super) network: Network,
    stores: &'s [Store],
    nodes: Vec<SupplyNodes>,
    /// Nodes of the atmosphere, by its temperature in K.
    outside: Vec<(f64, usize)>,
}

impl<'s> Builder<'s> {
    /// The network of the supplies, and the supplies that contradict themselves: in place of each is a source, so that what it
    /// feeds can be checked all the same.
    pub(super) fn new(of: &'s PlantScenario, air: &Air, names: &mut PlantNames) -> (Self, Vec<(usize, Error)>) {
        let mut builder =
            Self { network: Network::new(air), stores: &of.stores, nodes: Vec::new(), outside: Vec::new() };
        let mut refused = Vec::new();
        for (index, store) in of.stores.iter().enumerate() {
            if let Err(error) = builder.store(store, air, names) {
                refused.push((index, error));
                let Supply { gauge_pressure, temperature, .. } = store.supply;
                let outside = builder.outside(temperature);
                builder.nodes.push(builder.network.supply([gauge_pressure, temperature], None, None, None, outside));
            }
        }
        (builder, refused)
    }

    /// The atmosphere at a temperature in K.
    fn outside(&mut self, temperature: f64) -> usize {
        match self.outside.iter().find(|(known, _)| *known == temperature) {
            Some((_, node)) => *node,
            None => {
                let node = self.network.node(NodeKind::Atmosphere, 0.0, temperature);
                self.outside.push((temperature, node));
                node
            }
        }
    }

    fn store(&mut self, store: &Store, air: &Air, names: &mut PlantNames) -> Result<(), Error> {
        let Store { name, supply, from, inlet, valve, hose } = store;
        let temperature = supply.temperature;
        let outside = self.outside(temperature);
        let line = core_supply_line(supply, air)?;
        let (reservoir, regulator) = line.as_ref().map_or((None, None), |line| (line.reservoir(), line.regulator()));
        let feeder = from.map(|from| self.nodes[from].outlet);
        let numbers = [supply.gauge_pressure, temperature];
        let nodes = self.network.supply(numbers, reservoir, regulator, feeder, outside);
        if let (Some(feeder), Some(tank)) = (feeder, nodes.reservoir) {
            let start = supply.reservoir_start();
            let hose = hose.map(|hose| core_hose(&hose, temperature, air)).transpose()?;
            let into = match hose {
                Some(hose) => self.network.hose(hose, tank, start),
                None => tank,
            };
            match (inlet, valve) {
                (Some(inlet), _) => self.inlet(inlet, [feeder, into], air)?,
                (None, Some((valve, command))) => {
                    let built = core_valve(valve, supply, air)?;
                    let its = self.network.valve(core_actuation(valve, command, 0)?);
                    let ambient = built.exhaust_temperature == ExhaustTemperature::Ambient;
                    for (from, port) in [(feeder, Port::Supply), (outside, Port::Exhaust)] {
                        let law = *built.law_of(port);
                        let kind = BranchKind::Path { law, valve: its, port, ambient, copies: 1.0 };
                        self.network.branch(from, into, kind);
                    }
                    names.supply_valves.push((name.clone(), its));
                }
                (None, None) => {}
            }
        }
        if let Some(tank) = nodes.reservoir.filter(|tank| *tank != nodes.outlet) {
            names.nodes.push((format!("{name}.reservoir"), tank));
        }
        names.nodes.push((name.clone(), nodes.outlet));
        self.nodes.push(nodes);
        Ok(())
    }

    /// A flow path that is always open, or open one way.
    fn inlet(&mut self, inlet: &Inlet, [from, to]: [usize; 2], air: &Air) -> Result<(), Error> {
        let standard = inlet.flow_path.standard();
        let law = FlowLaw::of_flow_path(Port::Supply, standard, inlet.efficiency, inlet.laminar_ratio, air)?;
        if inlet.one_way {
            self.network.branch(from, to, BranchKind::Check { law });
            return Ok(());
        }
        let solenoid = Solenoid::new(ValveKind::TwoWay, 0.0, 0.0)?;
        let valve = self.network.valve(Actuation { solenoid, command: Command::Constant(Request::Fill) });
        let kind = BranchKind::Path { law, valve, port: Port::Supply, ambient: false, copies: 1.0 };
        self.network.branch(from, to, kind);
        Ok(())
    }

    /// Adds what an actuator draws from its supply, or by a hose with a given pressure at its end.
    pub(super) fn draw(
        &mut self,
        index: usize,
        (driven, given): (&Driven, Option<&PressureSeries>),
        line: &Line,
        alone: &Scenario,
        supply: Option<&str>,
    ) -> Result<Drawn, Error> {
        let room = p::SUPPLY_TEMPERATURE.default.unwrap_or_default();
        let temperature = alone.supply.as_ref().map_or(room, |supply| supply.temperature);
        let outside = self.outside(temperature);
        let store = supply.and_then(|supply| self.stores.iter().position(|store| store.name == supply));
        let feed = store.map_or(outside, |store| self.nodes[store].outlet);
        let regulates = driven.actuation.as_ref().is_some_and(|actuation| actuation.solenoid.regulator().is_some());
        if regulates && store.is_some_and(|store| changes(&self.stores[store].supply)) {
            return Err(Error::NotImplemented(&mckibben::limit::REGULATOR_SUPPLY));
        }
        let driving = (driven.actuation.as_ref(), given);
        Ok(self.network.draw(index, &driven.actuator, driving, line, [feed, outside], 1.0))
    }
}

/// Whether the pressure of a supply is not constant.
fn changes(supply: &Supply) -> bool {
    supply.reservoir.is_some() || supply.regulator.is_some()
}
