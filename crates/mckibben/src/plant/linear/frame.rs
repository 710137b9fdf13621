//! A plant held in one mode, with every number that a linear model is differentiated by open to a derivative.
//!
//! Rates and outputs are those of the simulation, evaluated over dual numbers with one derivative. What the simulation knows
//! beforehand and a linear model has as an input gets its place here: how far flow paths are open, what a regulator is set
//! to, and mass flows from outside. Such a flow is that of a branch whose flow is a state, so that it passes through the
//! same formulas as every other.

use crate::dual::Dual;
use crate::error::Error;
use crate::line::{Hose, HoseKind};
use crate::mechanism::Mechanism;
use crate::network::{BranchKind, NodeKind};
use crate::plant::evaluation::{Evaluation, System};
use crate::plant::mode::PlantMode;
use crate::plant::{Mounted, Plant};
use crate::scalar::Scalar;
use crate::simulation::{Actuation, LengthRegime, Sliding};
use crate::valve::{Approach, Command, FlowZone, Openings, Port, Ports, actual_duty_cycle};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// A number with one derivative.
pub(super) type Number = Dual<f64, 1>;

/// Tolerance that separates the events of a run from rounding: no event happens at a point.
const TOLERANCE: f64 = 1e-10;
/// Part of a pressure up to which two are equal.
const EQUAL: f64 = 1e-9;
/// Share of a spool's stroke within which it is at an edge: to the sides of it λ is a straight line.
pub(super) const EDGE: f64 = 1e-9;
/// Temperature in K of a mass flow into an actuator that has no node.
const ROOM: f64 = 293.15;

/// What determines how far the flow paths of a valve are open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drive {
    /// The openings to supply and exhaust themselves.
    Openings([f64; 2]),
    /// The commanded duty of a PWM, by the actual duty cycle.
    Duty(f64),
    /// The commanded position of a spool.
    Spool(f64),
    /// The set point of a pressure regulator, as a gauge pressure in Pa, and whether its flow path is open.
    SetPoint(f64, bool),
}

/// Something to differentiate by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// A state of the plant, or position or velocity of a spool behind them.
    Slot(usize),
    /// What drives a valve.
    Drive(usize),
    /// The opening of a valve's paths to a port.
    Opening(usize, Port),
    /// The pressure of a source, or what an outlet is set to.
    Supply(usize),
}

/// Whose air a mass flow from outside enters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fed {
    Actuator(usize),
    Node(usize),
}

/// A plant in one mode.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub(super) plant: Plant<Number>,
    pub(super) drives: Vec<Drive>,
    /// States of the plant, and behind them position and velocity of each spool.
    pub(super) state: Vec<f64>,
    /// Mass flows from outside, and the state that is each.
    pub(super) feeds: Vec<(Fed, usize)>,
    /// Valves that are spools, and the state that is the position of each.
    pub(super) spools: Vec<(usize, usize)>,
    /// Whether actuators on tendons are kept from moving and viscoelastic branches relaxed: while their balance is looked for.
    pub(super) holds_ends: bool,
    /// On which side of their positions the openings of spools are differentiated: −1, 1, or 0 for neither.
    pub(super) side: f64,
}

/// Everything at an instant, with its derivative.
pub(super) struct Instant {
    pub(super) at: Evaluation<Number>,
    pub(super) mode: PlantMode<Number>,
    pub(super) rates: Vec<Number>,
    /// Generalised forces on all mechanisms, one after the other.
    pub(super) forces: Vec<Number>,
    /// Force of each actuator on a tendon less the tension of that.
    pub(super) excess: Vec<Option<Number>>,
}

impl Frame {
    /// A plant with its valves driven, from the states of a start; motions that are given are held where they start.
    ///
    /// # Errors
    /// As [`Plant::new`].
    pub(super) fn new(plant: &Plant, drives: Vec<Drive>, state: &[f64]) -> Result<Self, Error> {
        let Plant { actuators, network, mechanisms, .. } = plant.clone();
        let held = |mechanism| match mechanism {
            Mechanism::Prescribed(_) => Mechanism::External { distances: 1 },
            other => other,
        };
        let mut network = network;
        let mut fed = Vec::new();
        for (i, mounted) in actuators.iter().enumerate() {
            if mounted.pressure.is_none() {
                let chamber = network.chamber(i, ROOM);
                fed.push((Fed::Actuator(i), chamber, *mounted.actuator.air()));
            }
        }
        if let Some(first) = actuators.first() {
            for index in 0..plant.network.nodes.len() {
                if matches!(network.nodes[index].kind, NodeKind::Reservoir(_)) {
                    fed.push((Fed::Node(index), index, *first.actuator.air()));
                }
            }
        }
        let mut branches = Vec::new();
        for (whose, node, air) in fed {
            let (gauge, temperature) = (network.nodes[node].gauge, network.nodes[node].temperature);
            let from = network.node(NodeKind::Source, gauge, temperature);
            let carrier = Hose::new(HoseKind::Distributed { cells: 1 }, [1.0, 0.01], [1.8e-5, temperature, 1.0], &air)?;
            branches.push((whose, network.branch(from, node, BranchKind::Inertia(carrier))));
        }
        for (valve, drive) in drives.iter().enumerate() {
            if let Drive::SetPoint(gauge, _) = drive {
                network.valves[valve].command = Command::SetPoints { time: vec![0.0], gauge_pressure: vec![*gauge] };
            }
        }
        let whole = Plant::new(actuators, network, mechanisms.into_iter().map(held).collect())?;
        let feeds: Vec<(Fed, usize)> =
            branches.iter().filter_map(|(whose, branch)| Some((*whose, whole.places.branches[*branch]?))).collect();
        let mut states = state.to_vec();
        states.resize(whole.places.states, 0.0);
        let mut spools = Vec::new();
        for (valve, drive) in drives.iter().enumerate() {
            if let Drive::Spool(position) = drive {
                spools.push((valve, states.len()));
                states.extend([*position, 0.0]);
            }
        }
        let constant = |_, _: &'static _, value| Number::constant(value);
        Ok(Self { plant: whole.map(constant), drives, state: states, feeds, spools, holds_ends: true, side: 0.0 })
    }

    /// The state that is the mass flow from outside into something.
    pub(super) fn feed(&self, whose: Fed) -> Option<usize> {
        self.feeds.iter().find(|(its, _)| *its == whose).map(|(_, slot)| *slot)
    }

    /// The plant at its states on each side of the edges of its spools, and the share of each in a derivative along the seeded
    /// quantities: one half, as for the describing function of a small symmetric signal.
    pub(super) fn sides(&self, seeds: &[(Quantity, f64)]) -> Vec<(f64, Instant)> {
        let is_spool = |of: &Quantity| self.spools.iter().any(|(_, slot)| *of == Quantity::Slot(*slot));
        match seeds.iter().any(|(of, _)| is_spool(of)) {
            true => [-1.0, 1.0].map(|side| (0.5, Self { side, ..self.clone() }.evaluate(seeds))).into(),
            false => vec![(1.0, self.evaluate(seeds))],
        }
    }

    /// Evaluates the plant at its states, with the derivative along the seeded quantities.
    pub(super) fn evaluate(&self, seeds: &[(Quantity, f64)]) -> Instant {
        let of = |quantity: Quantity| -> f64 {
            seeds.iter().filter(|(its, _)| *its == quantity).map(|(_, slope)| slope).sum()
        };
        let number = |quantity: Quantity, value: f64| Number { value, slope: [of(quantity)] };
        let mut state: Vec<Number> =
            self.state.iter().enumerate().map(|(slot, value)| number(Quantity::Slot(slot), *value)).collect();
        let mut plant = self.plant.clone();
        for (valve, drive) in self.drives.iter().enumerate() {
            if let (Drive::SetPoint(gauge, _), Command::SetPoints { gauge_pressure, .. }) =
                (drive, &mut plant.network.valves[valve].command)
            {
                gauge_pressure[0] = number(Quantity::Drive(valve), *gauge);
            }
        }
        for (index, node) in plant.network.nodes.iter_mut().enumerate() {
            let slope = of(Quantity::Supply(index));
            match &mut node.kind {
                NodeKind::Source => node.gauge.slope[0] = slope,
                NodeKind::Outlet { set, .. } => set.slope[0] = slope,
                _ => {}
            }
        }
        let openings = (0..self.drives.len()).map(|valve| self.openings(valve, &state, &number)).collect();
        let plant = Arc::new(plant);
        let system = System::new(&plant, TOLERANCE);
        let mut at = Evaluation::new(&plant);
        let count = plant.places.states;
        if self.holds_ends {
            relax_branches(&system, &mut state[..count], &mut at);
        }
        let mode = enter_mode(&system, &state[..count], openings, self.holds_ends, &mut at);
        let zero = Number::constant(0.0);
        let mut rates = vec![zero; state.len()];
        system.rates(zero, &state[..count], &mode, &mut at, &mut rates[..count]);
        // Rates alone leave out the tensions to which no state answers.
        system.evaluate(zero, &state[..count], &mode, &mut at);
        for &(valve, slot) in &self.spools {
            if let (Some(spool), Drive::Spool(command)) =
                (plant.network.valves[valve].solenoid.spool(), self.drives[valve])
            {
                let command = number(Quantity::Drive(valve), command);
                rates[slot] = state[slot + 1];
                rates[slot + 1] = spool.acceleration(state[slot], state[slot + 1], command);
            }
        }
        let mut forces = Vec::new();
        for m in 0..plant.mechanisms.len() {
            system.enter_force(m, &state, &mode, &mut at);
            forces.extend_from_slice(&at.force[..plant.places.mechanisms[m].coordinates]);
        }
        let excess = plant.actuators.iter().enumerate().map(|(i, Mounted { tendon, .. })| {
            let (unit, deflections) = (&at.units[i], system.deflections(i, &state));
            let ends = [unit.distance, unit.length, state[plant.places.actuators[i].pressure]];
            tendon.as_ref().map(|tendon| system.excess(i, tendon, &mode, ends, deflections))
        });
        let excess = excess.collect();
        Instant { at, mode, rates, forces, excess }
    }

    /// How far the paths of a valve to supply and exhaust are open.
    pub(super) fn openings(
        &self,
        valve: usize,
        state: &[Number],
        number: &dyn Fn(Quantity, f64) -> Number,
    ) -> [Number; 2] {
        let constants = [Number::constant(0.0), Number::constant(1.0)];
        let Actuation { solenoid, command } = &self.plant.network.valves[valve];
        match self.drives[valve] {
            Drive::Openings(openings) => {
                let of = |port: Port| number(Quantity::Opening(valve, port), openings[port as usize]);
                [of(Port::Supply), of(Port::Exhaust)]
            }
            Drive::Duty(duty) => {
                let mut pulses = command.clone();
                if let Command::Pwm { duty: commanded, .. } = &mut pulses {
                    *commanded = number(Quantity::Drive(valve), duty);
                }
                actual_duty_cycle(solenoid, &pulses).unwrap_or([constants[0]; 2])
            }
            Drive::Spool(_) => {
                let slot = self.spools.iter().find(|(its, _)| *its == valve).map(|(_, slot)| *slot);
                match (solenoid.spool(), slot) {
                    (Some(spool), Some(slot)) => {
                        let (at, here) = (state[slot], spool.openings(state[slot]));
                        // A stop lets nothing beyond it.
                        let beside = (at.value + self.side * EDGE).clamp(-1.0, 1.0);
                        let beside = spool.openings(Number { value: beside, ..at });
                        [0, 1].map(|port| Number { value: here[port].value, ..beside[port] })
                    }
                    _ => [constants[0]; 2],
                }
            }
            Drive::SetPoint(_, open) => [constants[usize::from(open)], constants[0]],
        }
    }

    /// The mass matrix of a mechanism, factored.
    pub(super) fn factored_mass_matrix(&self, m: usize) -> Vec<f64> {
        let (here, zero) = (self.plant.places.mechanisms[m], Number::constant(0.0));
        let count = here.coordinates;
        let state: Vec<Number> = self.state.iter().map(|value| Number::constant(*value)).collect();
        let system = System::new(&Arc::new(self.plant.clone()), TOLERANCE);
        let mut directions = vec![[zero; 2]; here.accelerations().end];
        system.enter_directions(m, &state, &mut directions);
        let mut matrix = vec![zero; count * count];
        system.mass_matrix(m, &directions, &mut matrix);
        let mut matrix: Vec<f64> = matrix.into_iter().map(|entry| entry.value).collect();
        crate::plant::dense::factor(&mut matrix, count);
        matrix
    }

    /// Usual forces along the coordinates of each mechanism, by which residual forces are measured.
    pub(super) fn usual_forces(&self) -> Vec<f64> {
        let system = System::new(&Arc::new(self.plant.clone()), TOLERANCE);
        let own = self.plant.mechanisms.iter().map(|mechanism| match mechanism {
            Mechanism::Mass(mass) => mass.pull().value.abs(),
            Mechanism::Chain(chain) => chain.usual_torque(),
            _ => 0.0,
        });
        own.zip(&system.usual_torque).map(|(own, actuators)| own + actuators).collect()
    }
}

/// Relaxes the viscoelastic branches of all actuators at the lengths that they have in a state.
fn relax_branches(system: &System<Number>, state: &mut [Number], at: &mut Evaluation<Number>) {
    if system.plant.places.actuators.iter().all(|here| here.branches().is_empty()) {
        return;
    }
    let mode = system.first_mode(state);
    system.enter_distances(Number::constant(0.0), state, &mode, at);
    system.plant.relax_branches(at.units.iter().map(|unit| unit.length), state);
}

/// The mode that holds at rest in a state: no dry friction, hysteresis relaxed, every flow path in the piece of its law.
fn enter_mode(
    system: &System<Number>,
    state: &[Number],
    openings: Vec<[Number; 2]>,
    holds_ends: bool,
    at: &mut Evaluation<Number>,
) -> PlantMode<Number> {
    let plant = &*system.plant;
    let time = Number::constant(0.0);
    let mut mode = system.first_mode(state);
    for (i, its) in mode.actuators.iter_mut().enumerate() {
        if !system.wires[i].member.actuator.friction().has_direction() {
            its.mode.sliding = Sliding::Frictionless;
        }
    }
    for m in 0..plant.mechanisms.len() {
        system.enter_contacts(m, state, &mut mode);
    }
    system.enter_distances(time, state, &mode, at);
    for (i, Mounted { actuator, tendon, .. }) in plant.actuators.iter().enumerate() {
        let (member, unit, its) = (&system.wires[i].member, &at.units[i], &mut mode.actuators[i]);
        let limits = actuator.limits();
        let pressure = state[plant.places.actuators[i].pressure];
        // What is remembered stays as it is: it has no derivative.
        let length = Number::constant(unit.length.value);
        let is_slack = tendon.is_none() && length.value < limits.min_length().value;
        its.mode.length_regime = match length.value > limits.max_length().value {
            true => LengthRegime::Taut,
            false if is_slack => LengthRegime::Slack,
            false => LengthRegime::Free,
        };
        if holds_ends && tendon.is_some() {
            its.mode.sliding = Sliding::Stuck;
        }
        its.loose = tendon.as_ref().is_some_and(|it| (unit.distance - unit.length - it.rest_length()).value <= 0.0);
        its.mode.force_piece = member.force_piece(length, pressure);
        let relaxed = limits.actuator_length(length);
        its.trace = member.trace(relaxed);
        member.follow(&mut its.trace, relaxed, Sliding::Lengthening, false);
        if tendon.is_none() {
            let ends = [unit.length, unit.velocity, pressure];
            let deflections = system.deflections(i, state);
            let trace = its.trace;
            member.enter_clamp(ends, &mut its.mode, (&trace, deflections));
        }
    }
    let network = &plant.network;
    for (of_valve, openings) in mode.network.valves.iter_mut().zip(openings) {
        of_valve.ports = Ports { supply: true, exhaust: true };
        of_valve.openings = Openings::Shares(openings);
    }
    system.enter_distances(time, state, &mode, at);
    system.piping.enter_pressures(state, &mut at.network);
    let pressures: Vec<Number> = at.network.nodes.iter().map(|node| node.pressure).collect();
    network.enter(&pressures, &mut mode.network);
    // A check valve between equal pressures is open to what is drawn behind it; a solved pressure is equal but for rounding.
    for (branch, of_branch) in network.branches.iter().zip(&mut mode.network.branches) {
        let [from, to] = [branch.from, branch.to].map(|node| pressures[node].value);
        if matches!(branch.kind, BranchKind::Check { .. }) && (to - from).abs() <= EQUAL * from {
            of_branch.zone = Some(FlowZone::LaminarIn);
        }
    }
    // A compressor rests: what it delivers on average is an input.
    for of_branch in &mut mode.network.branches {
        of_branch.runs = false;
    }
    for (node, of_node) in network.nodes.iter().zip(&mut mode.network.nodes) {
        if let NodeKind::Port { .. } = node.kind {
            (of_node.approach, of_node.set_points) = (Some(Approach::Settles), 1);
        }
    }
    system.enter_poppets(time, state, &mut mode, at);
    mode
}
