//! What feeds an actuator of a plant, and what the plant's samples and modes say of both.

use super::equipment::SupplyNodes;
use super::{Plant, PlantMode, PlantSample};
use crate::air::Flow;
use crate::error::Error;
use crate::network::NodeKind;
use crate::scalar::Real;
use crate::simulation::decision::with_poppets;
use crate::simulation::{Mode, Sample};
use crate::valve::Ports;

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
