//! The discrete state of a network: which formulas hold, and what its clocks remember.

use super::progress::Progress;
use super::setting::Setting;
use super::{Branch, BranchKind, Network, NodeKind};
use crate::line::{FlowRegime, Poppet};
use crate::scalar::Real;
use crate::simulation::Actuation;
use crate::valve::{Approach, FlowZone, Openings, Port, Ports};
use alloc::vec::Vec;

/// Which formula holds for the flow through a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchMode {
    /// The piece of an orifice's flow law; none while it is shut.
    pub zone: Option<FlowZone>,
    /// The regime of a lumped hose.
    pub regime: FlowRegime,
    /// Whether a compressor runs.
    pub runs: bool,
    /// Whether the air in a cell of a distributed hose goes at the speed of sound, and then whether forwards.
    pub sonic: Option<bool>,
}

/// Which formula holds for a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeMode {
    /// Of a regulator's outlet.
    pub poppet: Poppet,
    /// Whether the pressure of its inlet, and not what it is set to, limits a regulator's outlet.
    pub limited: bool,
    /// How a proportional regulator goes to its set point; at rest before the first takes effect.
    pub approach: Option<Approach>,
    /// How many set points have taken effect.
    pub set_points: u64,
    /// How many rows of a given pressure have passed.
    pub rows_passed: usize,
}

/// What a valve does.
#[derive(Debug)]
pub struct ValveMode<R> {
    /// Which of its ports are open.
    pub ports: Ports,
    /// How far along its command it is.
    pub(crate) progress: Progress<R>,
    /// How far its ports are open until the next instant.
    pub openings: Openings<R>,
    /// The setting made during the run, in place of its own command.
    pub(crate) setting: Option<alloc::boxed::Box<Setting<R>>>,
}

impl<R: Clone> Clone for ValveMode<R> {
    fn clone(&self) -> Self {
        let Self { ports, progress, openings, setting } = self;
        Self { ports: *ports, progress: progress.clone(), openings: openings.clone(), setting: setting.clone() }
    }

    /// Takes on another mode in the memory that is there.
    fn clone_from(&mut self, source: &Self) {
        let Self { ports, progress, openings, setting } = self;
        *ports = source.ports;
        progress.clone_from(&source.progress);
        openings.clone_from(&source.openings);
        setting.clone_from(&source.setting);
    }
}

/// The discrete state of a network.
#[derive(Debug)]
pub struct NetworkMode<R> {
    /// Of each branch.
    pub branches: Vec<BranchMode>,
    /// Of each node.
    pub nodes: Vec<NodeMode>,
    /// Of each valve.
    pub valves: Vec<ValveMode<R>>,
}

impl<R: Clone> Clone for NetworkMode<R> {
    fn clone(&self) -> Self {
        let Self { branches, nodes, valves } = self;
        Self { branches: branches.clone(), nodes: nodes.clone(), valves: valves.clone() }
    }

    /// Takes on another mode in the memory that is there.
    fn clone_from(&mut self, source: &Self) {
        let Self { branches, nodes, valves } = self;
        branches.clone_from(&source.branches);
        nodes.clone_from(&source.nodes);
        valves.clone_from(&source.valves);
    }
}

impl<R: Real> NetworkMode<R> {
    /// When in s the pulses of valves that have been set must be laid out next; infinite when never.
    pub(crate) fn pulse_edge(&self) -> f64 {
        let settings = self.valves.iter().filter_map(|valve| valve.setting.as_ref());
        settings.map(|setting| setting.edge().value()).fold(f64::INFINITY, f64::min)
    }
}

impl<R: Real> Network<R> {
    /// The mode at t = 0, before zones and regimes are entered.
    pub(crate) fn begin(&self) -> NetworkMode<R> {
        let valve = |actuation| {
            let mut progress = Progress::none();
            let ports = progress.pass(actuation, R::zero());
            ValveMode { ports, progress, openings: progress.openings(actuation), setting: None }
        };
        NetworkMode {
            branches: self.branches.iter().map(|_| BranchMode::AT_REST).collect(),
            nodes: self.nodes.iter().map(|_| NodeMode::AT_REST).collect(),
            valves: self.valves.iter().map(valve).collect(),
        }
    }

    /// Whether a branch is open as its valve stands; true for one without a valve.
    #[doc(hidden)]
    pub fn is_open(&self, branch: usize, mode: &NetworkMode<R>) -> bool {
        match self.branches[branch].kind {
            BranchKind::Path { valve, port, .. } => match port {
                Port::Supply => mode.valves[valve].ports.supply,
                Port::Exhaust => mode.valves[valve].ports.exhaust,
            },
            _ => true,
        }
    }

    /// Enters the pieces of all laws at the pressures of the nodes (Pa, absolute).
    pub(crate) fn enter(&self, pressure: &[R], mode: &mut NetworkMode<R>) {
        for branch in 0..self.branches.len() {
            let Branch { from, to, .. } = self.branches[branch];
            self.enter_branch(branch, [pressure[from], pressure[to]], mode);
        }
        for (node, of_node) in self.nodes.iter().zip(&mut mode.nodes) {
            if let NodeKind::Outlet { .. } = node.kind {
                of_node.poppet = Poppet::Rests;
            }
        }
    }

    /// Enters the piece of a branch's law at the pressures of its two nodes (Pa, absolute).
    pub(crate) fn enter_branch(&self, branch: usize, [from, to]: [R; 2], mode: &mut NetworkMode<R>) {
        let is_open = self.is_open(branch, mode);
        let of_branch = &self.branches[branch];
        let zone = |law: &crate::valve::FlowLaw<R>| {
            let below_end = |zone: &FlowZone| law.bounds(*zone, from).1.is_none_or(|end| to.value() <= end.value());
            FlowZone::RISING.into_iter().find(below_end)
        };
        let of_mode = &mut mode.branches[branch];
        match &of_branch.kind {
            BranchKind::Path { law, .. } => of_mode.zone = if is_open { zone(law) } else { None },
            BranchKind::Check { law } => of_mode.zone = zone(law).filter(|zone| zone.is_inward()),
            BranchKind::Loss(hose) => {
                let drive = hose.tube().drive(from, to).value();
                let holds = |regime: &FlowRegime| regime.bounds()[1].is_none_or(|end| drive <= end);
                of_mode.regime = FlowRegime::RISING.into_iter().find(holds).unwrap_or(FlowRegime::Laminar);
            }
            BranchKind::Compressor => {
                if let NodeKind::Reservoir(reservoir) = &self.nodes[of_branch.to].kind
                    && let Some([_, stops]) = reservoir.switch_pressures()
                {
                    of_mode.runs = to.value() < stops.value();
                }
            }
            BranchKind::Inertia(_) | BranchKind::Leak(_) => {}
        }
    }

    /// What drives a valve: its own command, or what it has been set to.
    pub(crate) fn actuation<'m>(&'m self, valve: usize, mode: &'m NetworkMode<R>) -> &'m Actuation<R> {
        mode.valves[valve].setting.as_ref().map_or(&self.valves[valve], |setting| setting.actuation())
    }

    /// The next instant in s, up to and with `until`, at which a valve does something, a set point takes effect or the rate of a
    /// given pressure jumps.
    pub(crate) fn next_instant(&self, mode: &NetworkMode<R>, until: R) -> Option<R> {
        let of_valves = (0..mode.valves.len()).filter_map(|valve| self.next_of_valve(valve, until, mode));
        let of_ports = (0..self.nodes.len()).filter_map(|node| self.next_set_point(node, mode, until));
        let rows = (0..self.nodes.len()).filter_map(|node| self.next_row(node, mode, until));
        of_valves.chain(of_ports).chain(rows).min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    /// The next instant in s, up to and with `until`, at which a set point of a port takes effect.
    fn next_set_point(&self, node: usize, mode: &NetworkMode<R>, until: R) -> Option<R> {
        let NodeKind::Port { valve, .. } = &self.nodes[node].kind else { return None };
        let actuation = self.actuation(*valve, mode);
        let (time, _) = actuation.command.set_point(mode.nodes[node].set_points)?;
        let instant = time + actuation.solenoid.latency();
        Some(instant).filter(|instant| crate::valve::is_due(*instant, until))
    }

    /// The next instant in s, up to and with `until`, at which the rate of a given pressure jumps.
    fn next_row(&self, node: usize, mode: &NetworkMode<R>, until: R) -> Option<R> {
        let NodeKind::Given { series, late } = self.nodes[node].kind else { return None };
        let instant = self.series[series].row(mode.nodes[node].rows_passed)? + late;
        Some(instant).filter(|instant| crate::valve::is_due(*instant, until))
    }

    /// Passes a row of a given pressure that is due at `time`; whether there was one.
    pub(crate) fn pass_row(&self, node: usize, time: R, mode: &mut NetworkMode<R>) -> bool {
        let is_due = self.next_row(node, mode, time).is_some();
        mode.nodes[node].rows_passed += usize::from(is_due);
        is_due
    }

    /// The absolute pressure in Pa that a port goes to, once a set point has taken effect.
    #[doc(hidden)]
    pub fn set_point(&self, node: usize, mode: &NetworkMode<R>) -> Option<R> {
        let NodeKind::Port { valve, .. } = &self.nodes[node].kind else { return None };
        let passed = mode.nodes[node].set_points.checked_sub(1)?;
        self.actuation(*valve, mode).command.set_point(passed).map(|(_, gauge)| self.absolute(gauge))
    }

    /// Lets the set points of a port up to and with `time` take effect at its pressure (Pa, absolute); whether there was one.
    pub(crate) fn pass_set_points(&self, node: usize, time: R, pressure: R, mode: &mut NetworkMode<R>) -> bool {
        let before = mode.nodes[node].set_points;
        while self.next_set_point(node, mode, time).is_some() {
            mode.nodes[node].set_points += 1;
        }
        if mode.nodes[node].set_points == before {
            return false;
        }
        if let (NodeKind::Port { regulator, .. }, Some(set)) = (&self.nodes[node].kind, self.set_point(node, mode)) {
            mode.nodes[node].approach = Some(regulator.approach(pressure, set));
        }
        true
    }

    /// Passes what is due at a time in s for a valve; whether it moved.
    pub(crate) fn pass_valve(&self, valve: usize, time: R, mode: &mut NetworkMode<R>) -> bool {
        let ValveMode { ports: ports_of_valve, progress, openings, setting } = &mut mode.valves[valve];
        let actuation = setting.as_ref().map_or(&self.valves[valve], |setting| setting.actuation());
        let (ports, counted) = (*ports_of_valve, progress.openings_counted());
        *ports_of_valve = progress.pass(actuation, time);
        let moved = *ports_of_valve != ports || progress.openings_counted() != counted;
        if moved {
            *openings = progress.openings(actuation);
        }
        moved
    }

    /// Whether a valve has something to pass at a time in s.
    pub(crate) fn is_valve_due(&self, valve: usize, time: R, mode: &NetworkMode<R>) -> bool {
        self.next_of_valve(valve, time, mode).is_some()
    }

    /// The next instant in s, up to and with `until`, at which a valve does something.
    fn next_of_valve(&self, valve: usize, until: R, mode: &NetworkMode<R>) -> Option<R> {
        mode.valves[valve].progress.next(self.actuation(valve, mode), until)
    }
}

impl BranchMode {
    pub(crate) const AT_REST: Self = Self { zone: None, regime: FlowRegime::Laminar, runs: false, sonic: None };
}

impl NodeMode {
    pub(crate) const AT_REST: Self =
        Self { poppet: Poppet::Rests, limited: false, approach: None, set_points: 0, rows_passed: 0 };
}
