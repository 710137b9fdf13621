//! Actuators with their air lines as parts of a plant.

use super::Mounted;
use super::feed::Feed;
use crate::actuator::Actuator;
use crate::line::{Line, Regulator, Reservoir};
use crate::load::SeriesTendon;
use crate::mechanism::Coupling;
use crate::network::{BranchKind, Network, NodeKind};
use crate::scalar::Scalar;
use crate::simulation::{Actuation, PressureSeries};
use crate::valve::{ExhaustTemperature, Port};
use alloc::vec::Vec;

/// Temperature in K of the atmosphere around an actuator without a supply.
pub(super) const ROOM: f64 = 293.15;

/// Where a supply lies in a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupplyNodes {
    /// The reservoir, if it has one.
    pub reservoir: Option<usize>,
    /// What valves draw from: the regulator's outlet, else the reservoir, else a source without end.
    pub outlet: usize,
}

/// What an actuator draws by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Its valve.
    pub valve: Option<usize>,
    /// The node that the valve opens into, or whose pressure is given: the first of its hose, or its chamber.
    pub into: Option<usize>,
}

/// An actuator of a rig or a joint, with all that goes with it into a plant.
pub(super) struct Equipment<'a, S> {
    pub(super) actuator: &'a Actuator<S>,
    pub(super) actuation: Option<&'a Actuation<S>>,
    pub(super) line: &'a Line<S>,
    pub(super) tendon: Option<&'a SeriesTendon<S>>,
    /// A pressure that is given: at the inlet of the hose if there is one.
    pub(super) pressure: Option<&'a PressureSeries<S>>,
}

impl<S: Scalar> Equipment<'_, S> {
    /// Adds the actuator to those of a plant and what feeds it to the network, from its own supply or from one that is
    /// there already.
    pub(super) fn mount(
        self,
        (mounted, network): (&mut Vec<Mounted<S>>, &mut Network<S>),
        (mechanism, coupling): (usize, Coupling<S>),
        shared: Option<SupplyNodes>,
    ) -> Feed {
        let Self { actuator, actuation, line, tendon, pressure } = self;
        let of_hose = line.hose.as_ref().and(pressure);
        let pressure = if of_hose.is_some() { None } else { pressure };
        let feed = match actuation.is_none() && line.is_none() {
            true => Feed::default(),
            false => network.feed(mounted.len(), actuator, (actuation, of_hose), line, shared),
        };
        mounted.push(Mounted {
            actuator: actuator.clone().without_valve(),
            mechanism,
            coupling,
            tendon: tendon.copied(),
            pressure: pressure.cloned(),
        });
        feed
    }
}

impl<S: Scalar> Network<S> {
    /// Adds what feeds an actuator: its valve with the paths to supply and atmosphere, or a pressure that is given in its place,
    /// its hose, its leak, and the reservoir and regulator of its supply, or in their place a supply that is there already.
    pub fn feed(
        &mut self,
        index: usize,
        actuator: &Actuator<S>,
        (actuation, given): (Option<&Actuation<S>>, Option<&PressureSeries<S>>),
        line: &Line<S>,
        shared: Option<SupplyNodes>,
    ) -> Feed {
        let temperature = actuator.valve().map_or(S::constant(ROOM), |valve| valve.supply.temperature());
        let outside = self.node(NodeKind::Atmosphere, S::zero(), temperature);
        let supply = actuator.valve().filter(|_| actuation.is_some()).map(|valve| {
            let numbers = [valve.supply.gauge_pressure().0, temperature];
            let (reservoir, regulator) =
                line.supply.as_ref().map_or((None, None), |supply| (supply.reservoir(), supply.regulator()));
            shared.unwrap_or_else(|| self.supply(numbers, reservoir, regulator, None, outside))
        });
        let copies = line.supply.as_ref().map_or(S::one(), |supply| supply.actuators());
        let from = supply.map_or(outside, |supply| supply.outlet);
        let of_hose = |into: usize| line.hose.as_ref().map(|hose| [into, hose.cells()]);
        let (valve, into) = match self.draw(index, actuator, (actuation, given), line, [from, outside], copies) {
            Drawn { valve: Some(valve), into: Some(into) } => (valve, into),
            Drawn { into, .. } => return Feed { hose: into.and_then(of_hose), ..Feed::default() },
        };
        let path = |wanted: Port| {
            let is_it = |kind: &BranchKind<S>| matches!(kind, BranchKind::Path { valve: its, port, .. } if *its == valve && *port == wanted);
            self.branches.iter().position(|branch| is_it(&branch.kind))
        };
        let makes = |kind: &NodeKind<S>| matches!(kind, NodeKind::Port { valve: its, .. } if *its == valve);
        Feed {
            valve: Some(valve),
            paths: [path(Port::Supply), path(Port::Exhaust)],
            port: self.nodes.iter().position(|node| makes(&node.kind)),
            hose: of_hose(into),
            supply,
        }
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

    /// Adds what an actuator draws from a node: its valve with the paths from that node and to `outside`, or a pressure that is
    /// given in the valve's place, its hose and its leak. `copies` actuators alike draw the same.
    pub fn draw(
        &mut self,
        index: usize,
        actuator: &Actuator<S>,
        (actuation, given): (Option<&Actuation<S>>, Option<&PressureSeries<S>>),
        line: &Line<S>,
        [mut feed, outside]: [usize; 2],
        copies: S,
    ) -> Drawn {
        let temperature = self.nodes[outside].temperature;
        let mut drawn = Drawn::default();
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
            drawn = Drawn { valve: Some(its), into: Some(into) };
        } else if let (Some(series), Some(hose)) = (given, &line.hose) {
            let chamber = self.chamber(index, temperature);
            let into = self.hose(*hose, chamber, S::zero());
            self.give(into, series.clone());
            drawn.into = Some(into);
        }
        if let Some(leakage) = &line.leakage {
            let chamber = self.chamber(index, temperature);
            self.branch(outside, chamber, BranchKind::Leak(*leakage));
        }
        drawn
    }
}
