//! What feeds an actuator of a plant, what the plant's samples and modes say of both, and where its air comes in.

use super::equipment::SupplyNodes;
use super::{Plant, PlantMode, PlantSample};
use crate::air::Flow;
use crate::error::Error;
use crate::network::{Branch, BranchKind, Network, NodeKind};
use crate::scalar::Real;
use crate::simulation::decision::with_poppets;
use crate::simulation::{Mode, Sample};
use crate::valve::{Port, Ports};
use alloc::vec;
use alloc::vec::Vec;

/// Where what feeds an actuator lies in a network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Feed {
    /// The valve.
    pub valve: Option<usize>,
    /// The flow paths of the valve to the supply and to the atmosphere.
    pub paths: [Option<usize>; 2],
    /// The node whose pressure a regulator in the valve's place makes.
    pub port: Option<usize>,
    /// The nodes of the hose: the first, which the valve opens into, and how many there are.
    pub hose: Option<[usize; 2]>,
    /// What the valve draws from.
    pub supply: Option<SupplyNodes>,
}

/// Where air comes into the actuators of a plant, for its ledger.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Inlets {
    /// Which branches are leaks.
    pub(super) leaks: Vec<bool>,
    /// Which branches are flow paths of valves from what feeds an actuator to that actuator.
    pub(super) branches: Vec<bool>,
    /// Which nodes feed an actuator in place of a valve: regulators that are valves, and pressures that are given.
    pub(super) nodes: Vec<bool>,
    /// Which nodes store air that came from tanks alone, on its way to inlets: what they lost went in.
    pub(super) stores: Vec<bool>,
    /// How many actuators alike each actuator stands for.
    pub(super) copies: Vec<f64>,
    /// Whether a pressure is given, of an actuator or at its hose.
    pub(super) has_given: bool,
}

impl Inlets {
    pub(super) fn of(plant: &Plant) -> Self {
        let Network { nodes, branches, .. } = plant.network();
        let is_given = |kind: &NodeKind| matches!(kind, NodeKind::Given { .. });
        // A regulator in a valve's place is a node, and draws as one.
        let is_inlet = |branch: &Branch| {
            matches!(branch.kind, BranchKind::Path { port: Port::Supply, .. })
                && plant.chamber_behind(branch.to).is_some()
                && !matches!(nodes[branch.from].kind, NodeKind::Port { .. })
        };
        let feeds = |(index, kind): (usize, &NodeKind)| {
            is_given(kind) || matches!(kind, NodeKind::Port { .. }) && plant.chamber_behind(index).is_some()
        };
        let stores = |(index, kind): (usize, &NodeKind)| {
            matches!(kind, NodeKind::Reservoir(_) | NodeKind::Hose(_))
                && plant.chamber_behind(index).is_none()
                && matches!(nodes[root(plant.network(), index)].kind, NodeKind::Reservoir(_))
        };
        let mut copies = vec![1.0; plant.actuators().len()];
        for branch in branches {
            if let (BranchKind::Path { port: Port::Supply, copies: alike, .. }, Some(actuator)) =
                (&branch.kind, plant.chamber_behind(branch.to))
            {
                copies[actuator] = *alike;
            }
        }
        let kinds = || nodes.iter().map(|node| &node.kind);
        Self {
            leaks: branches.iter().map(|branch| matches!(branch.kind, BranchKind::Leak(_))).collect(),
            branches: branches.iter().map(is_inlet).collect(),
            nodes: kinds().enumerate().map(feeds).collect(),
            stores: kinds().enumerate().map(stores).collect(),
            copies,
            has_given: plant.actuators().iter().any(|mounted| mounted.pressure.is_some()) || kinds().any(is_given),
        }
    }
}

/// The node from which all air comes that a node gets: what a compressor takes from the atmosphere is the tank's.
fn root(network: &Network, mut node: usize) -> usize {
    for _ in 0..network.nodes.len() {
        let brings = |of: &&Branch| of.to == node && !matches!(network.nodes[of.from].kind, NodeKind::Atmosphere);
        let before = match network.nodes[node].kind {
            NodeKind::Outlet { inlet, .. } => inlet,
            _ => network.branches.iter().find(brings).map(|of| of.from),
        };
        let Some(before) = before else { break };
        node = before;
    }
    node
}

impl Feed {
    /// The valve, whose poppets a controller can drive.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no valve, or one without seats.
    pub(super) fn poppet_valve<R: Real>(&self, plant: &Plant<R>) -> Result<usize, Error> {
        with_poppets(self.valve, |valve| plant.network().valves[*valve].solenoid.has_poppets())
    }

    /// The sample of an actuator and of what feeds it.
    pub(super) fn sample<R: Real>(&self, plant: &Plant<R>, actuator: usize, of: &PlantSample<R>) -> Sample<R> {
        let its = &of.actuators[actuator];
        let is_on_tendon = plant.actuators()[actuator].tendon.is_some();
        let (length, velocity) = if is_on_tendon { (its.length, its.velocity) } else { (its.distance, its.rate) };
        let air_of_hose = |[first, count]: [usize; 2]| {
            of.nodes[first..first + count].iter().fold(R::zero(), |sum, node| sum + node.air_mass)
        };
        // What a source without end gives is no news.
        let changes = |node: &usize| !matches!(plant.network().nodes[*node].kind, NodeKind::Source);
        let supply = self.port.or(self.supply.map(|nodes| nodes.outlet).filter(changes));
        Sample {
            time: of.time,
            length,
            velocity,
            pressure: its.pressure,
            air_mass: its.air_mass,
            temperature: its.temperature,
            volume: its.volume,
            tension: its.tension,
            mass_flow: its.mass_flow,
            ports: self.valve.map_or(Ports::CLOSED, |valve| of.valves[valve].ports),
            hose_pressure: self.hose.map_or(its.pressure, |[first, _]| of.nodes[first].pressure),
            hose_air_mass: self.hose.map_or(R::zero(), air_of_hose),
            supply_pressure: supply.map(|node| of.nodes[node].pressure),
            load_distance: its.distance,
            load_velocity: its.rate,
        }
    }

    /// The flows through the valve's flow paths to the supply and to the atmosphere. What flows out to a pressure regulator it
    /// lets go to the atmosphere.
    pub(super) fn flows<R: Real>(&self, of: &PlantSample<R>) -> [Flow<R>; 2] {
        let flow = |path: Option<usize>| {
            let Some(path) = path else { return Flow::none() };
            let flow = of.branches[path].mass_flow;
            Flow { inward: flow.larger(R::zero()), outward: (-flow).larger(R::zero()) }
        };
        let [supply, exhaust] = self.paths.map(flow);
        match self.port {
            None => [supply, exhaust],
            Some(_) => [
                Flow { outward: R::zero(), ..supply },
                Flow { inward: exhaust.inward, outward: exhaust.outward + supply.outward },
            ],
        }
    }

    /// The mode of an actuator with that of its valve.
    pub(super) fn mode<R: Real>(&self, actuator: usize, of: &PlantMode<R>) -> Mode {
        let mode = of.actuators[actuator].mode;
        let Some(valve) = self.valve else { return mode };
        let [supply_zone, exhaust_zone] = self.paths.map(|path| of.network.branches[path?].zone);
        Mode { ports: of.network.valves[valve].ports, supply_zone, exhaust_zone, ..mode }
    }
}
