//! A rig of one actuator as a plant: the smallest network and mechanism.

use super::start::{InitialAir, PlantStart};
use super::{Mounted, Plant};
use crate::actuator::Actuator;
use crate::error::Error;
use crate::line::{Line, Regulator, Reservoir};
use crate::load::Load;
use crate::mechanism::{Coupling, Mass, Mechanism, Pull};
use crate::network::{BranchKind, Network, NodeKind};
use crate::pressure::GaugePressure;
use crate::scalar::Scalar;
use crate::simulation::{Actuation, Rig, State};
use crate::valve::{ExhaustTemperature, Port};
use alloc::vec;

/// Temperature in K of the surroundings of an actuator without a supply.
const ROOM: f64 = 293.15;

/// Where a supply lies in a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupplyNodes {
    /// The reservoir, if it has one.
    pub reservoir: Option<usize>,
    /// What valves draw from: the regulator's outlet, else the reservoir, else a source without end.
    pub outlet: usize,
}

impl<S: Scalar> Network<S> {
    /// Adds what feeds an actuator: its valve with the paths to supply and surroundings, its hose, its leak, and the
    /// reservoir and regulator of its own supply.
    pub fn feed(&mut self, index: usize, actuator: &Actuator<S>, actuation: Option<&Actuation<S>>, line: &Line<S>) {
        let temperature = actuator.valve().map_or(S::constant(ROOM), |valve| valve.supply.temperature());
        let outside = self.node(NodeKind::Atmosphere, S::zero(), temperature);
        let mut feed = outside;
        let mut copies = S::one();
        if let Some(valve) = actuator.valve().filter(|_| actuation.is_some()) {
            let gauge = valve.supply.gauge_pressure().0;
            let (reservoir, regulator) = match &line.supply {
                Some(supply) => {
                    copies = supply.actuators();
                    (supply.reservoir(), supply.regulator())
                }
                None => (None, None),
            };
            feed = self.supply([gauge, temperature], reservoir, regulator, None, outside).outlet;
        }
        self.draw(index, actuator, actuation, line, [feed, outside], copies);
    }

    /// Adds a supply at a gauge pressure (Pa) and a temperature (K): a source without end, or a reservoir, a regulator or both.
    /// A regulator without a reservoir draws from `inlet`, a node that stands before it, or from mains without end. `outside` is
    /// the atmosphere that a compressor draws from.
    pub fn supply(
        &mut self,
        [gauge, temperature]: [S; 2],
        reservoir: Option<&Reservoir<S>>,
        regulator: Option<&Regulator<S>>,
        inlet: Option<usize>,
        outside: usize,
    ) -> SupplyNodes {
        let reservoir = reservoir.map(|reservoir| {
            let tank = self.node(NodeKind::Reservoir(*reservoir), S::zero(), temperature);
            if reservoir.compressor().is_some() {
                self.branch(outside, tank, BranchKind::Compressor);
            }
            tank
        });
        let outlet = match (regulator, reservoir) {
            (Some(regulator), _) => {
                let kind = NodeKind::Outlet { regulator: *regulator, set: gauge, inlet: reservoir.or(inlet) };
                self.node(kind, gauge, temperature)
            }
            (None, Some(tank)) => tank,
            (None, None) => self.node(NodeKind::Source, gauge, temperature),
        };
        SupplyNodes { reservoir, outlet }
    }

    /// Adds what an actuator draws from a node: its valve with the paths from that node and to `outside`, its hose and its leak.
    /// `copies` actuators alike draw the same. The valve and the node that it opens into, if there is one.
    pub fn draw(
        &mut self,
        index: usize,
        actuator: &Actuator<S>,
        actuation: Option<&Actuation<S>>,
        line: &Line<S>,
        [mut feed, outside]: [usize; 2],
        copies: S,
    ) -> Option<[usize; 2]> {
        let temperature = self.nodes[outside].temperature;
        let mut drawn = None;
        if let (Some(valve), Some(Actuation { solenoid, command })) = (actuator.valve(), actuation) {
            let its = self.valve(Actuation { solenoid: *solenoid, command: command.clone() });
            if let Some(regulator) = solenoid.regulator() {
                let gauge = valve.supply.gauge_pressure().0;
                let kind = NodeKind::Port { regulator: *regulator, valve: its, feed: gauge };
                feed = self.node(kind, S::zero(), temperature);
            }
            let chamber = self.chamber(index, temperature);
            let into = match &line.hose {
                Some(hose) => self.hose(*hose, chamber, S::zero()),
                None => chamber,
            };
            let ambient = valve.exhaust_temperature == ExhaustTemperature::Ambient;
            for (from, port) in [(feed, Port::Supply), (outside, Port::Exhaust)] {
                let law = *valve.law_of(port);
                let copies = if port == Port::Supply { copies } else { S::one() };
                self.branch(from, into, BranchKind::Path { law, valve: its, port, ambient, copies });
            }
            drawn = Some([its, into]);
        }
        if let Some(leakage) = &line.leakage {
            let chamber = self.chamber(index, temperature);
            self.branch(outside, chamber, BranchKind::Leak(*leakage));
        }
        drawn
    }
}

impl Plant {
    /// The plant of a rig.
    ///
    /// # Errors
    /// As [`Plant::new`].
    pub fn of_rig(rig: &Rig) -> Result<Self, Error> {
        let actuator = rig.actuator();
        let mut network = Network::new(actuator.air());
        network.feed(0, actuator, rig.actuation(), rig.line());
        let mechanism = match rig.load() {
            Load::HangingMass { mass, gravity } => Mechanism::Mass(Mass::new(*mass, Pull::Gravity(*gravity), None)?),
            Load::ConstantForce { mass, force } => Mechanism::Mass(Mass::new(*mass, Pull::Force(*force), None)?),
            Load::Isometric => Mechanism::Fixed,
            Load::Prescribed(motion) => Mechanism::Prescribed(motion.clone()),
        };
        let mounted = Mounted {
            actuator: actuator.clone().without_valve(),
            mechanism: 0,
            coupling: Coupling::Direct { coordinate: 0 },
            tendon: rig.tendon().copied(),
            pressure: rig.pressure_course().cloned(),
        };
        Self::new(vec![mounted], network, vec![mechanism])
    }

    /// The start of the plant of a rig in a state of that rig.
    pub fn start_of_rig(rig: &Rig, state: &State) -> PlantStart {
        let air = rig.actuator().air();
        let volume = rig.actuator().volume(state.length);
        let gauge = state.pressure.gauge(air.atmosphere());
        let temperature = state.pressure.0 * volume / (state.air_mass * air.gas_constant());
        let distance = match rig.tendon() {
            Some(tendon) => {
                let (least, most) = rig.holdable(state.length, state.pressure.0, 0.0);
                let middle = 0.5 * (least + most);
                let tension = rig.load().inertia().map_or(middle, |inertia| inertia.pull.max(least).min(most));
                state.length + tendon.rest_length() + tension / tendon.stiffness()
            }
            None => state.length,
        };
        let held = rig.load().inertia().is_none() && rig.tendon().is_some();
        PlantStart {
            positions: vec![vec![distance]],
            rates: vec![vec![if held { 0.0 } else { state.velocity }]],
            air: vec![InitialAir { gauge_pressure: GaugePressure(gauge.0), temperature }],
            lengths: vec![rig.tendon().map(|_| state.length)],
            friction: vec![],
        }
    }
}
