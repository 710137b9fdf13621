//! A rig of one actuator and a joint of two as plants: the smallest networks and mechanisms.

use super::start::{InitialAir, PlantStart};
use super::{Mounted, Plant};
use crate::actuator::Actuator;
use crate::error::Error;
use crate::line::{Line, Regulator, Reservoir};
use crate::load::Load;
use crate::mechanism::{Arm, Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute};
use crate::network::{BranchKind, Network, NodeKind};
use crate::pressure::GaugePressure;
use crate::simulation::{Actuation, Driven, JointRig, JointState, Rig, State};
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

impl Network {
    /// Adds what feeds an actuator: its valve with the paths to supply and surroundings, its hose, its leak, and the
    /// reservoir and regulator of its own supply.
    pub fn feed(&mut self, index: usize, actuator: &Actuator, actuation: Option<&Actuation>, line: &Line) {
        let temperature = actuator.valve().map_or(ROOM, |valve| valve.supply.temperature());
        let outside = self.node(NodeKind::Atmosphere, 0.0, temperature);
        let mut feed = outside;
        let mut copies = 1.0;
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
        [gauge, temperature]: [f64; 2],
        reservoir: Option<&Reservoir>,
        regulator: Option<&Regulator>,
        inlet: Option<usize>,
        outside: usize,
    ) -> SupplyNodes {
        let reservoir = reservoir.map(|reservoir| {
            let tank = self.node(NodeKind::Reservoir(*reservoir), 0.0, temperature);
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
        actuator: &Actuator,
        actuation: Option<&Actuation>,
        line: &Line,
        [mut feed, outside]: [usize; 2],
        copies: f64,
    ) -> Option<[usize; 2]> {
        let temperature = self.nodes[outside].temperature;
        let mut drawn = None;
        if let (Some(valve), Some(Actuation { solenoid, command })) = (actuator.valve(), actuation) {
            let its = self.valve(Actuation { solenoid: *solenoid, command: command.clone() });
            if let Some(regulator) = solenoid.regulator() {
                let gauge = valve.supply.gauge_pressure().0;
                let kind = NodeKind::Port { regulator: *regulator, valve: its, feed: gauge };
                feed = self.node(kind, 0.0, temperature);
            }
            let chamber = self.chamber(index, temperature);
            let into = match &line.hose {
                Some(hose) => self.hose(*hose, chamber, 0.0),
                None => chamber,
            };
            let ambient = valve.exhaust_temperature == ExhaustTemperature::Ambient;
            for (from, port) in [(feed, Port::Supply), (outside, Port::Exhaust)] {
                let law = *valve.law_of(port);
                let copies = if port == Port::Supply { copies } else { 1.0 };
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

    /// The plant of a joint.
    ///
    /// # Errors
    /// As [`Plant::new`].
    pub fn of_joint(rig: &JointRig) -> Result<Self, Error> {
        let joint = rig.joint();
        let limb = joint.limb();
        let segment = ChainSegment { length: 0.0, mass: limb.mass, distance: limb.distance, inertia: limb.inertia };
        let stops = joint.stops();
        let stops = JointStops { ends: stops.ends, stiffness: stops.stiffness, damping: stops.damping };
        let revolute = Revolute { torque: joint.torque(), damping: joint.damping(), stops };
        let chain = Chain::new(vec![segment], vec![revolute], [limb.gravity, limb.hanging_angle], None)?;
        let mut network = Network::new(rig.driven()[0].actuator.air());
        let mut mounted = vec![];
        for (index, Driven { actuator, actuation }) in rig.driven().iter().enumerate() {
            network.feed(index, actuator, actuation.as_ref(), &Line::NONE);
            let tendon = &joint.tendons()[index];
            let sign = if index == 0 { 1.0 } else { -1.0 };
            let arms = vec![Arm { joint: 0, sign, arm: tendon.arm }];
            mounted.push(Mounted {
                actuator: actuator.clone().without_valve(),
                mechanism: 0,
                coupling: Coupling::Arms { rest_length: tendon.rest_length, arms },
                tendon: None,
                pressure: None,
            });
        }
        Self::new(mounted, network, vec![Mechanism::Chain(chain)])
    }

    /// The start of the plant of a joint in a state of that joint.
    pub fn start_of_joint(rig: &JointRig, state: &JointState) -> PlantStart {
        let lengths = rig.joint().lengths(state.angle);
        let air = [0, 1].map(|i| {
            let actuator = &rig.driven()[i].actuator;
            let air = actuator.air();
            let volume = actuator.volume(lengths[i]);
            InitialAir {
                gauge_pressure: state.pressure[i].gauge(air.atmosphere()),
                temperature: state.pressure[i].0 * volume / (state.air_mass[i] * air.gas_constant()),
            }
        });
        PlantStart {
            positions: vec![vec![state.angle]],
            rates: vec![vec![state.angular_velocity]],
            air: air.to_vec(),
            lengths: vec![None; 2],
            friction: vec![],
        }
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
