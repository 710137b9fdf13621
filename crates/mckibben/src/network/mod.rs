//! The air network: everything between sources of air and the chambers of actuators.
//!
//! A network is a tree of *nodes*, each with a pressure, joined by *branches*, each with a mass flow.
//!
//! | node | pressure | temperature of its air |
//! |---|---|---|
//! | [`NodeKind::Atmosphere`], [`NodeKind::Source`] | constant | its own |
//! | [`NodeKind::Given`] | a given function of time | its own |
//! | [`NodeKind::Chamber`] | of an actuator's air (19) | of the gas |
//! | [`NodeKind::Hose`] | `dP/dt = κRT/V ṁ` of a hose's volume or cell | the wall's |
//! | [`NodeKind::Reservoir`] | the same of a tank, a bottle or a manifold | the supply's |
//! | [`NodeKind::Outlet`] | of a regulator with droop, dead band and lag ([`line::Regulator`]) | the supply's |
//! | [`NodeKind::Port`] | of a proportional pressure regulator ([`valve::Regulator`]) | the supply's |
//!
//! | branch | flow |
//! |---|---|
//! | [`BranchKind::Path`] | a flow path of a valve: (21)(23) or ISO 6358, opened by the valve's poppets or spool |
//! | [`BranchKind::Check`] | an orifice that lets air through one way |
//! | [`BranchKind::Loss`] | friction of a lumped hose |
//! | [`BranchKind::Inertia`] | the air in a cell of a distributed hose: its flow is a state |
//! | [`BranchKind::Leak`] | a laminar leak |
//! | [`BranchKind::Compressor`] | delivery of a compressor that a pressure switch starts and stops |
//!
//! Positive flow goes from `from` to `to`. A regulator's outlet holds no air: what is drawn from it comes from its inlet.
//!
//! Flow zones of orifices, the regime of a lumped hose, the compressor's switch and the regulator's poppet are parts of the
//! mode; what the valves do over time is known beforehand.
//!
//! Source: each law's own file, in [`valve`], [`mod@line`] and [`air`](crate::air). Checked by
//! `tests/plant_ledger.rs`: mass, energy and exergy; by `tests/plant_linear_closed_forms.rs`: a leak and a resonator.

pub(crate) mod choke;
mod commands;
pub(crate) mod flow;
pub(crate) mod formulas;
pub(crate) mod guard;
pub(crate) mod implicit;
pub(crate) mod mode;
pub(crate) mod piping;
pub(crate) mod progress;
mod setting;

use crate::air::Air;
use crate::convert::Convert;
use crate::line::{self, Hose, Leakage, Reservoir};
use crate::parameter;
use crate::plant::Part;
use crate::scalar::Scalar;
use crate::simulation::{Actuation, PressureSeries};
use crate::valve::{self, FlowLaw, Port};
use alloc::vec::Vec;

/// What determines the pressure of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeKind<S = f64> {
    /// The atmosphere.
    Atmosphere,
    /// Mains or a tank without end.
    Source,
    /// A pressure that is given over time: what is measured at the valve's end of a hose, in place of the valve.
    Given {
        /// Which of the network's time series, from 0.
        series: usize,
        /// How much later in s than the series says the pressure is there: the delay of a lumped hose behind it.
        late: S,
    },
    /// The air of an actuator.
    Chamber {
        /// Which actuator, from 0.
        actuator: usize,
    },
    /// A lumped hose's volume, or one cell of a distributed hose.
    Hose(Hose<S>),
    /// A tank, a bottle or a manifold.
    Reservoir(Reservoir<S>),
    /// The outlet of a pressure regulator.
    Outlet {
        /// Droop, dead band and lag.
        regulator: line::Regulator<S>,
        /// Gauge pressure in Pa that it is set to.
        set: S,
        /// The node that feeds it; mains without end where there is none.
        inlet: Option<usize>,
    },
    /// What a proportional pressure regulator makes of its supply.
    Port {
        /// Time constant, dead time and rate limit.
        regulator: valve::Regulator<S>,
        /// The valve whose command holds its set points.
        valve: usize,
        /// Gauge pressure in Pa of what feeds it: it cannot make more, nor less than the atmosphere.
        feed: S,
    },
}

/// A place in the network with one pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<S = f64> {
    /// What determines its pressure.
    pub kind: NodeKind<S>,
    /// Gauge pressure in Pa: of a source always, of a hose, an outlet or a port at the start; zero for the others.
    pub gauge: S,
    /// Temperature in K of its air; of a chamber the temperature with which air from outside comes in.
    pub temperature: S,
}

/// What determines the flow through a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BranchKind<S = f64> {
    /// A flow path of a valve.
    Path {
        /// The flow law.
        law: FlowLaw<S>,
        /// The valve, whose poppets open it.
        valve: usize,
        /// Which of the valve's ports it leads to.
        port: Port,
        /// Whether air that comes back through it counts with the ambient temperature instead of its own.
        ambient: bool,
        /// How many branches alike there are: each draws from `from` what this one draws.
        copies: S,
    },
    /// A check valve: air goes from `from` to `to` alone.
    Check {
        /// The flow law.
        law: FlowLaw<S>,
    },
    /// Friction of a lumped hose.
    Loss(Hose<S>),
    /// The flow out of a cell of a distributed hose.
    Inertia(Hose<S>),
    /// A leak of a chamber (`to`) from the atmosphere (`from`).
    Leak(Leakage<S>),
    /// A compressor that fills the reservoir `to` from the atmosphere `from`.
    Compressor,
}

/// A connection between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<S = f64> {
    /// The node on the side of the source.
    pub from: usize,
    /// The node on the side of the actuator.
    pub to: usize,
    /// What determines its flow.
    pub kind: BranchKind<S>,
}

/// Nodes, branches and valves.
#[derive(Clone, Debug, PartialEq)]
pub struct Network<S = f64> {
    /// The nodes; an outlet stands behind its inlet.
    pub nodes: Vec<Node<S>>,
    /// The branches.
    pub branches: Vec<Branch<S>>,
    /// The valves: delays or dynamics, and the command of each.
    pub valves: Vec<Actuation<S>>,
    /// The pressures that are given over time.
    pub series: Vec<PressureSeries<S>>,
    /// Absolute pressure in Pa of the atmosphere, from which gauge pressures count.
    pub atmosphere: S,
}

impl<S: Scalar> Network<S> {
    /// Neither nodes nor branches, in the atmosphere of `air`.
    pub fn new(air: &Air<S>) -> Self {
        let atmosphere = air.atmosphere().0;
        Self { nodes: Vec::new(), branches: Vec::new(), valves: Vec::new(), series: Vec::new(), atmosphere }
    }

    /// Absolute pressure in Pa at a gauge pressure.
    #[inline(always)]
    pub fn absolute(&self, gauge: S) -> S {
        gauge + self.atmosphere
    }

    /// Adds a node at a gauge pressure (Pa) and a temperature (K); its index.
    pub fn node(&mut self, kind: NodeKind<S>, gauge: S, temperature: S) -> usize {
        self.nodes.push(Node { kind, gauge, temperature });
        self.nodes.len() - 1
    }

    /// Adds a branch; its index.
    pub fn branch(&mut self, from: usize, to: usize, kind: BranchKind<S>) -> usize {
        self.branches.push(Branch { from, to, kind });
        self.branches.len() - 1
    }

    /// Adds a valve; its index.
    pub fn valve(&mut self, actuation: Actuation<S>) -> usize {
        self.valves.push(actuation);
        self.valves.len() - 1
    }

    /// The chamber of an actuator; made if it is not there.
    pub fn chamber(&mut self, actuator: usize, temperature: S) -> usize {
        let is_it = |node: &Node<S>| matches!(node.kind, NodeKind::Chamber { actuator: its } if its == actuator);
        match self.nodes.iter().position(is_it) {
            Some(index) => index,
            None => self.node(NodeKind::Chamber { actuator }, S::zero(), temperature),
        }
    }

    /// A hose from a node to another: nodes and branches for its volumes. `gauge` (Pa) is what it starts at. The node at the
    /// hose's first volume, which its valve opens into.
    pub fn hose(&mut self, hose: Hose<S>, to: usize, gauge: S) -> usize {
        let temperature = hose.tube().temperature();
        let first = self.nodes.len();
        for _ in 0..hose.cells() {
            self.node(NodeKind::Hose(hose), gauge, temperature);
        }
        for cell in 0..hose.cells() {
            let next = if cell + 1 == hose.cells() { to } else { first + cell + 1 };
            let kind = match hose.kind() {
                line::HoseKind::Lumped => BranchKind::Loss(hose),
                line::HoseKind::Distributed { .. } => BranchKind::Inertia(hose),
            };
            self.branch(first + cell, next, kind);
        }
        first
    }

    /// Gives the pressure of a node over time, in place of what determined it.
    pub fn give(&mut self, node: usize, series: PressureSeries<S>) {
        self.nodes[node].kind = NodeKind::Given { series: self.series.len(), late: S::zero() };
        self.series.push(series);
    }

    /// The network over another scalar. A hose is given out as its first node, whichever node or branch holds a copy of it.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Network<T> {
        let nodes = self.nodes.iter().enumerate().map(|(index, node)| {
            let part = if matches!(node.kind, NodeKind::Hose(_)) { self.hose_start(index) } else { index };
            convert.turn_to(Some(Part::Node(part)));
            node.convert(convert)
        });
        let nodes = nodes.collect();
        let branches = self.branches.iter().enumerate().map(|(index, branch)| {
            convert.turn_to(Some(match branch.kind {
                BranchKind::Loss(_) | BranchKind::Inertia(_) => Part::Node(self.hose_start(branch.from)),
                _ => Part::Branch(index),
            }));
            branch.convert(convert)
        });
        let branches = branches.collect();
        let valves = self.valves.iter().enumerate().map(|(index, valve)| {
            convert.turn_to(Some(Part::Valve(index)));
            valve.convert(convert)
        });
        let valves = valves.collect();
        let series = self.series.iter().enumerate().map(|(index, series)| {
            let is_its = |node: &Node<S>| matches!(node.kind, NodeKind::Given { series, .. } if series == index);
            convert.turn_to(self.nodes.iter().position(is_its).map(Part::Node));
            series.convert(convert)
        });
        let series = series.collect();
        convert.turn_to(None);
        let atmosphere = convert.parameter(&parameter::ATMOSPHERIC_PRESSURE, self.atmosphere);
        Network { nodes, branches, valves, series, atmosphere }.seen_late()
    }

    /// The first node of the hose that a node belongs to: at the end that its valve opens into.
    pub fn hose_start(&self, mut node: usize) -> usize {
        for _ in 0..self.nodes.len() {
            // The cells of a hose lie one behind the other.
            let is_before = |branch: &Branch<S>| {
                matches!(branch.kind, BranchKind::Inertia(_)) && branch.to == node && branch.from + 1 == node
            };
            if !self.branches.iter().any(is_before) {
                break;
            }
            node -= 1;
        }
        node
    }

    /// Lets the valves that open into a lumped hose, and pressures that are given there, take effect by its delay later: a
    /// lumped hose has none. Of several such hoses behind one valve, the longest delay counts.
    pub(crate) fn seen_late(mut self) -> Self {
        for branch in &self.branches {
            if let BranchKind::Path { valve, .. } = branch.kind
                && let NodeKind::Hose(hose) = &self.nodes[branch.to].kind
                && let Some(actuation) = self.valves.get_mut(valve)
            {
                let late = actuation.solenoid.transport().larger(hose.transport_delay());
                actuation.solenoid = actuation.solenoid.seen_late(late);
            }
            if let (BranchKind::Loss(hose), NodeKind::Given { late, .. }) =
                (&branch.kind, &mut self.nodes[branch.from].kind)
            {
                *late = hose.transport_delay();
            }
        }
        self
    }
}

impl<S: Scalar> Node<S> {
    fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Node<T> {
        let gauge = match self.kind {
            NodeKind::Source => convert.parameter(&parameter::SUPPLY_GAUGE_PRESSURE, self.gauge),
            _ => convert.parameter(&parameter::INITIAL_GAUGE_PRESSURE, self.gauge),
        };
        let temperature = convert.parameter(&parameter::SUPPLY_TEMPERATURE, self.temperature);
        let kind = match self.kind {
            NodeKind::Atmosphere => NodeKind::Atmosphere,
            NodeKind::Source => NodeKind::Source,
            // Set again by what is behind it.
            NodeKind::Given { series, .. } => NodeKind::Given { series, late: T::zero() },
            NodeKind::Chamber { actuator } => NodeKind::Chamber { actuator },
            NodeKind::Hose(hose) => NodeKind::Hose(hose.convert(convert)),
            NodeKind::Reservoir(reservoir) => NodeKind::Reservoir(reservoir.convert(convert)),
            NodeKind::Outlet { regulator, set, inlet } => NodeKind::Outlet {
                regulator: regulator.convert(convert),
                set: convert.parameter(&parameter::SUPPLY_GAUGE_PRESSURE, set),
                inlet,
            },
            NodeKind::Port { regulator, valve, feed } => NodeKind::Port {
                regulator: regulator.convert(convert),
                valve,
                feed: convert.parameter(&parameter::SUPPLY_GAUGE_PRESSURE, feed),
            },
        };
        Node { kind, gauge, temperature }
    }
}

impl<S: Scalar> Branch<S> {
    fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Branch<T> {
        let kind = match self.kind {
            BranchKind::Path { law, valve, port, ambient, copies } => BranchKind::Path {
                law: law.convert(port, convert),
                valve,
                port,
                ambient,
                copies: convert.parameter(&parameter::ACTUATORS, copies),
            },
            BranchKind::Check { law } => BranchKind::Check { law: law.convert(Port::Supply, convert) },
            BranchKind::Loss(hose) => BranchKind::Loss(hose.convert(convert)),
            BranchKind::Inertia(hose) => BranchKind::Inertia(hose.convert(convert)),
            BranchKind::Leak(leakage) => BranchKind::Leak(leakage.convert(convert)),
            BranchKind::Compressor => BranchKind::Compressor,
        };
        Branch { from: self.from, to: self.to, kind }
    }
}
