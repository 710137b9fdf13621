//! Integrates the [ledger](super::ledger) over the steps of a run.

use super::exergy::DeadState;
use super::feed::Inlets;
use super::ledger::{Carried, PlantLedger};
use super::mode::PlantMode;
use super::sample::Observer;
use super::steps::TimeStepping;
use super::trajectory::PieceView;
use super::{Plant, tendon};
use crate::engine::arc;
use crate::force::Statics as _;
use crate::mechanism::Mechanism;
use crate::mechanism::chain::Contacts;
use crate::network::{BranchKind, NodeKind};
use crate::scalar::Scalar;
use crate::simulation::LengthRegime;
use crate::simulation::member::Trace;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// Nodes and weights of Gauss–Legendre quadrature with five points on `[0, 1]`, exact to degree 9.
pub(super) const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// ε of a state: it is a sum of as many control points.
const ROUNDING: f64 = arc::POINTS as f64 * f64::EPSILON;

/// What flows through a node at an instant.
#[derive(Clone, Copy, Debug, Default)]
struct Passing {
    pressure: f64,
    temperature: f64,
    /// In kg/s.
    inward: f64,
    outward: f64,
    /// `Σ ṁ T` of what flows in, its exergy at the node's pressure, and what that destroys as it mixes.
    warmth: f64,
    worth: f64,
    mixed: f64,
}

/// A ledger under way.
#[derive(Debug)]
pub(super) struct Bookkeeper<'a> {
    plant: &'a Plant,
    observer: Observer<f64>,
    dead: Option<DeadState>,
    ledger: PlantLedger,
    nodes: Vec<Passing>,
    state: Vec<f64>,
    /// How fast the length of each actuator goes along the dense output, in m/s, where it is a state.
    moves: Vec<Option<f64>>,
    has_begun: bool,
    tolerance: f64,
    steps: f64,
    /// Energies of the work and of the air in J, and the mass of the air in kg, at an instant; and the largest so far.
    sizes: [f64; 3],
    largest: [f64; 3],
    /// `Σ ∫ ṁ P/ΔP dt` of the flows, with the enthalpy in J, and in kg.
    steepness: [f64; 2],
}

impl<'a> Bookkeeper<'a> {
    pub(super) fn new(plant: &'a Plant, stepping: TimeStepping) -> Self {
        let (network, dead) = (plant.network(), DeadState::of(plant));
        let ledger = PlantLedger {
            actuators: vec![Default::default(); plant.actuators().len()],
            mechanisms: vec![Default::default(); plant.mechanisms().len()],
            nodes: vec![Default::default(); network.nodes.len()],
            branches: vec![Default::default(); network.branches.len()],
            inlets: Inlets::of(plant),
            reference_temperature: dead.map(|dead| dead.temperature),
            errors: [[0.0; 2]; 3],
        };
        Self {
            plant,
            observer: Observer::new(&Arc::new(plant.clone()), stepping),
            dead,
            ledger,
            nodes: vec![Passing::default(); network.nodes.len()],
            state: vec![0.0; plant.indices().states],
            moves: vec![None; plant.actuators().len()],
            has_begun: false,
            tolerance: stepping.tolerance(),
            steps: 0.0,
            sizes: [0.0; 3],
            largest: [0.0; 3],
            steepness: [0.0; 2],
        }
    }

    /// Adds a step.
    pub(super) fn add(&mut self, piece: PieceView<'_>) {
        let PieceView { start, step, end, points, mode } = piece;
        let mut state = core::mem::take(&mut self.state);
        if !self.has_begun {
            self.has_begun = true;
            arc::at(points, 0.0, &mut state);
            self.level(-1.0, start, &state, mode);
        }
        let length = end - start;
        if length > 0.0 {
            self.steps += 1.0;
            for (node, weight) in GAUSS {
                let time = start + length * node;
                let theta = (time - start) / step;
                arc::at(points, theta, &mut state);
                let lengths = self.plant.indices().actuators.iter().map(|here| here.length);
                let states = state.len();
                for (moves, length) in self.moves.iter_mut().zip(lengths) {
                    *moves = length.map(|place| arc::slope(points, states, place, theta) / step);
                }
                self.observer.system.project(time, &mut state, mode, &mut self.observer.at);
                let own = self.observer.mode_with_pieces(time, &state, mode);
                self.instant(length * weight, time, &state, own.as_ref().unwrap_or(mode));
            }
        }
        self.state = state;
    }

    /// The ledger of a run that ends in a state.
    pub(super) fn finish(mut self, time: f64, state: &[f64], mode: &PlantMode) -> PlantLedger {
        if self.has_begun {
            self.level(1.0, time, state, mode);
        }
        let [enthalpy, mass] = self.steepness;
        for ((errors, largest), steep) in self.ledger.errors.iter_mut().zip(self.largest).zip([0.0, enthalpy, mass]) {
            errors[0] += ROUNDING * steep;
            errors[1] = self.tolerance * (self.steps * largest + steep);
        }
        self.ledger
    }

    /// Adds what is stored in a state, with a sign.
    fn level(&mut self, sign: f64, time: f64, state: &[f64], mode: &PlantMode) {
        let Self { plant, observer, dead, ledger, .. } = self;
        observer.evaluate_flows(time, state, mode);
        for (i, of) in ledger.actuators.iter_mut().enumerate() {
            let (unit, chamber) = (&observer.at.units[i], &observer.at.chambers[i]);
            let mounted = &plant.actuators()[i];
            let limits = mounted.actuator.limits();
            let bladder = mounted.actuator.law().law.stored_energy(limits.actuator_length(unit.length));
            of.bladder_storage += sign * bladder;
            of.effectiveness_loss -= sign * bladder;
            of.braid_storage += sign * limits.stored_energy(unit.length);
            if let Some(tendon) = &mounted.tendon {
                let pull = tendon::tension(tendon, mode.actuators[i].loose, unit.distance, unit.length).larger(0.0);
                of.tendon_storage += sign * 0.5 * pull * pull / tendon.stiffness();
            }
            let Some(dead) = dead else { continue };
            of.air_gain += sign * chamber.mass;
            of.internal_energy += sign * chamber.pressure * chamber.volume / dead.excess;
            of.atmosphere_work += sign * dead.pressure * chamber.volume;
            let temperature = mounted.actuator.air().temperature(chamber);
            of.exergy_gain += sign * dead.contents(chamber.mass, [chamber.pressure, temperature, chamber.volume]);
        }
        for (m, of) in ledger.mechanisms.iter_mut().enumerate() {
            let (position, rate) = plant.indices().mechanisms[m].of(state);
            let [kinetic, potential] = plant.mechanisms()[m].energies(position, rate);
            of.kinetic += sign * kinetic;
            of.potential += sign * potential;
        }
        let Some(dead) = dead else { return };
        for (n, of) in ledger.nodes.iter_mut().enumerate() {
            let node = &plant.network().nodes[n];
            let Some([volume, stiffness]) = volume(&node.kind) else { continue };
            let pressure = observer.at.network.nodes[n].pressure;
            of.air_gain += sign * pressure / stiffness;
            of.internal_energy += sign * pressure * volume / dead.excess;
            of.exergy_gain += sign * dead.line_contents([pressure, node.temperature, volume], stiffness);
        }
    }

    /// Adds what happens in an instant of `weight` s.
    fn instant(&mut self, weight: f64, time: f64, state: &[f64], mode: &PlantMode) {
        self.observer.evaluate_flows(time, state, mode);
        self.follow_lengths(mode);
        self.sizes = [0.0; 3];
        for i in 0..self.ledger.actuators.len() {
            self.actuator(i, weight, state, mode);
        }
        for m in 0..self.ledger.mechanisms.len() {
            self.mechanism(m, weight, state, mode);
        }
        if let Some(dead) = self.dead {
            self.pass(weight, &dead);
            for n in 0..self.nodes.len() {
                self.node(n, weight, mode, &dead);
            }
            for i in 0..self.ledger.actuators.len() {
                self.chamber(i, weight, &dead);
            }
        }
        for ((errors, largest), size) in self.ledger.errors.iter_mut().zip(&mut self.largest).zip(self.sizes) {
            errors[0] += ROUNDING * size;
            *largest = largest.larger(size);
        }
    }

    /// Lets volumes grow with the lengths as they go. The velocity of an end on a tendon follows from a balance of stiff forces, and errs
    /// by much more than the length where steps are long: forces are by that velocity, powers by the way.
    fn follow_lengths(&mut self, mode: &PlantMode) {
        let Self { plant, observer, moves, .. } = self;
        for (i, moves) in moves.iter().enumerate() {
            let Some(moves) = moves.filter(|_| mode.actuators[i].mode.length_regime != LengthRegime::Slack) else {
                continue;
            };
            let actuator = &plant.actuators()[i].actuator;
            let (unit, chamber) = (&mut observer.at.units[i], &mut observer.at.chambers[i]);
            let rate = actuator.law().law.volume_and_slope(unit.length)[1] * moves;
            unit.pressure_rate -=
                actuator.air().index() * chamber.pressure * (rate - chamber.volume_rate) / chamber.volume;
            chamber.volume_rate = rate;
        }
    }

    /// The work of an actuator.
    fn actuator(&mut self, i: usize, weight: f64, state: &[f64], mode: &PlantMode) {
        let Self { plant, observer, ledger, sizes, moves, .. } = self;
        let (of, of_actuator) = (&mut ledger.actuators[i], &mode.actuators[i]);
        let (unit, chamber) = (&observer.at.units[i], &observer.at.chambers[i]);
        let actuator = &plant.actuators()[i].actuator;
        of.work -= weight * unit.tension * unit.rate;
        sizes[0] += chamber.pressure * chamber.volume + (unit.tension * unit.distance).abs();
        let branches = observer.system.branch_powers(i, state, mode, (unit, chamber));
        of.branches += weight * branches.dissipated;
        of.branch_exchange += weight * branches.exchanged;
        of.branch_storage -= weight * (branches.dissipated + branches.exchanged);
        if of_actuator.mode.length_regime == LengthRegime::Slack {
            return;
        }
        let (limits, friction) = (actuator.limits(), actuator.friction());
        let (length, velocity, pressure) = (unit.length, unit.velocity, chamber.pressure);
        let gauge = actuator.gauge(pressure);
        let moves = moves[i].unwrap_or(velocity);
        let gas_power = gauge.0 * chamber.volume_rate;
        let static_force: f64 = actuator.static_force(length, pressure);
        of.gas_work += weight * gas_power;
        of.effectiveness_loss += weight * (gas_power + static_force * moves);
        let direction = of_actuator.mode.sliding.direction();
        let deflections = observer.system.deflections(i, state);
        let widths = match (deflections.bristles, observer.system.wires[i].member.lugre()) {
            (Some(bent), Some(law)) => {
                [law.width_at(bent, velocity, direction), law.dissipating(bent, velocity, direction)]
            }
            _ => Trace::widths(&of_actuator.trace, limits.actuator_length(length)),
        };
        let pressing = actuator.normal_load(length, pressure, of_actuator.mode.touch());
        let coulomb: f64 = friction.coulomb().sliding(direction, velocity, friction.coulomb().kinetic(pressing));
        let secant = pressing.secant_stiffness();
        let viscous = friction.viscous_at::<f64>(secant) * velocity;
        let branch_force = observer.system.branch_force(i, state, mode, [length, pressure]);
        let (hysteresis, slipping) = (secant * widths[0], direction * secant * widths[1]);
        let taut = of_actuator.mode.length_regime == LengthRegime::Taut;
        let limit: f64 = if taut { limits.taut_force(length, velocity) } else { 0.0 };
        let stretch = (length - limits.max_length()).larger(0.0);
        of.viscous += weight * viscous * moves;
        of.coulomb += weight * coulomb * moves;
        of.slip += weight * slipping * moves;
        of.branch_storage += weight * branch_force * moves;
        of.hysteresis_storage += weight * (hysteresis - slipping) * moves;
        of.braid += weight * (limit - limits.stiffness() * stretch) * moves;
        let sum = static_force + viscous + coulomb + hysteresis + branch_force + limit;
        of.slack += weight * (unit.tension - sum) * moves;
    }

    /// The losses of a mechanism, and the work on a motion that is given.
    fn mechanism(&mut self, m: usize, weight: f64, state: &[f64], mode: &PlantMode) {
        let (plant, of) = (self.plant, &mut self.ledger.mechanisms[m]);
        let places = plant.indices();
        let (position, rate) = places.mechanisms[m].of(state);
        let energies = plant.mechanisms()[m].energies(position, rate);
        self.sizes[0] += energies[0].abs() + energies[1].abs();
        match &plant.mechanisms()[m] {
            Mechanism::Chain(chain) => {
                let its = &mode.mechanisms[m];
                let contacts = Contacts { stops: &its.stops, foot: its.foot };
                let powers = chain.powers(position, rate, contacts);
                of.damping += weight * powers.damping;
                of.stops += weight * powers.stops;
                of.belt += weight * powers.belt;
                of.belt_work += weight * powers.belt_drive;
            }
            Mechanism::Prescribed(_) | Mechanism::Fixed | Mechanism::External { .. } => {
                let units = places.members[m].iter().map(|&i| &self.observer.at.units[i]);
                of.driven -= weight * units.map(|unit| unit.tension * unit.rate).sum::<f64>();
            }
            Mechanism::Mass(_) => {}
        }
    }

    /// Takes the flows through all branches and regulators to the nodes.
    fn pass(&mut self, weight: f64, dead: &DeadState) {
        let Self { plant, observer, ledger, nodes, steepness, .. } = self;
        let (network, at) = (plant.network(), &observer.at);
        let air = plant.actuators()[0].actuator.air();
        for (n, node) in nodes.iter_mut().enumerate() {
            let temperature = network.temperature(n, &at.chambers, air);
            *node = Passing { pressure: at.network.nodes[n].pressure, temperature, ..Passing::default() };
        }
        let is_outside = |n: usize| matches!(network.nodes[n].kind, NodeKind::Atmosphere);
        for ((branch, flow), of) in network.branches.iter().zip(&at.network.flows).zip(&mut ledger.branches) {
            let (amount, sign) = (flow.abs(), if *flow < 0.0 { -1.0 } else { 1.0 });
            if amount == 0.0 {
                continue;
            }
            let (up, down) = if *flow < 0.0 { (branch.to, branch.from) } else { (branch.from, branch.to) };
            let throttled = weight * pass(nodes, [up, down], amount, dead);
            let Passing { temperature, pressure, .. } = nodes[up];
            let (enthalpy, exergy) = (dead.heat_capacity * temperature, dead.stream(temperature, pressure));
            // Of the air in a cell of a distributed hose the flow itself is a state.
            let apart = match branch.kind {
                BranchKind::Inertia(_) => 1.0,
                _ => (pressure - nodes[down].pressure).abs() / pressure,
            };
            if apart > 0.0 {
                let steep = weight * amount / apart;
                steepness[0] += steep * enthalpy;
                steepness[1] += steep;
            }
            of.carried.add(sign * weight * amount, enthalpy, exergy);
            match (&branch.kind, is_outside(up), is_outside(down)) {
                (BranchKind::Compressor, ..) => {
                    of.released -= weight * amount * exergy;
                    of.compressed -= throttled;
                }
                (_, false, true) => of.released += weight * amount * exergy,
                (_, true, false) => {
                    of.released -= weight * amount * exergy;
                    of.throttled += throttled;
                }
                _ => of.throttled += throttled,
            }
            if let BranchKind::Path { copies, .. } = branch.kind
                && copies != 1.0
            {
                // Those alike exchange the same with `from`, and with actuators that are not there.
                let others = (copies - 1.0) * amount;
                let worth = dead.stream(temperature, nodes[branch.from].pressure);
                of.others.add(sign * weight * others, enthalpy, worth);
                let from = &mut nodes[branch.from];
                if *flow < 0.0 {
                    from.take(others, temperature, dead);
                } else {
                    from.outward += others;
                }
            }
        }
        for n in (0..nodes.len()).rev() {
            let of = &mut ledger.nodes[n];
            let drawn = -at.network.nodes[n].net();
            let Passing { temperature, pressure, .. } = nodes[n];
            let mut outside = |of: &mut Carried, from: f64| {
                of.add(weight * drawn, dead.heat_capacity * temperature, dead.stream(temperature, from));
                // What comes in is as warm as the node, and so is what goes out.
                if drawn > 0.0 {
                    nodes[n].take(drawn, temperature, dead);
                } else {
                    nodes[n].outward -= drawn;
                }
            };
            match network.nodes[n].kind {
                NodeKind::Outlet { inlet: Some(inlet), .. } => {
                    let ends = if drawn < 0.0 { [n, inlet] } else { [inlet, n] };
                    of.throttled += weight * pass(nodes, ends, drawn.abs(), dead);
                }
                NodeKind::Outlet { set, inlet: None, .. } => {
                    let mains = network.absolute(set);
                    outside(&mut of.supplied, mains);
                    of.throttled += weight * drawn * dead.throttle(mains, pressure);
                    of.least_work += weight * drawn * dead.throttle(mains, dead.pressure);
                }
                NodeKind::Port { feed, .. } if drawn > 0.0 => {
                    let mains = network.absolute(feed);
                    outside(&mut of.supplied, mains);
                    of.throttled += weight * drawn * dead.throttle(mains, pressure);
                    of.least_work += weight * drawn * dead.throttle(mains, dead.pressure);
                }
                NodeKind::Port { .. } => {
                    let mut released = Carried::default();
                    outside(&mut released, pressure);
                    of.supplied.mass += released.mass;
                    of.supplied.enthalpy += released.enthalpy;
                    of.released -= released.exergy;
                    of.vented -= released.mass;
                }
                _ => {}
            }
        }
    }

    /// What the flows through a node do there.
    fn node(&mut self, n: usize, weight: f64, mode: &PlantMode, dead: &DeadState) {
        let network = self.plant.network();
        let (kind, of) = (&network.nodes[n].kind, &mut self.ledger.nodes[n]);
        let Passing { pressure, temperature, inward, outward, warmth, worth, mixed } = self.nodes[n];
        let enthalpy = dead.heat_capacity * (temperature * outward - warmth);
        let mut heat = enthalpy;
        match kind {
            NodeKind::Atmosphere | NodeKind::Source | NodeKind::Given { .. } => {
                of.supplied.mass += weight * (outward - inward);
                of.supplied.enthalpy += weight * enthalpy;
                if matches!(kind, NodeKind::Given { .. }) {
                    of.vented += weight * inward;
                }
                if !matches!(kind, NodeKind::Atmosphere) {
                    of.supplied.exergy += weight * (outward * dead.stream(temperature, pressure) - worth);
                    of.least_work += weight * (outward - inward) * dead.throttle(pressure, dead.pressure);
                }
                return;
            }
            NodeKind::Chamber { actuator } => {
                self.ledger.actuators[*actuator].mixed += weight * mixed;
                return;
            }
            NodeKind::Hose(_) | NodeKind::Reservoir(_) => {
                of.air_in += weight * (inward - outward);
                if let Some([volume, stiffness]) = volume(kind) {
                    heat += volume / dead.excess * network.node_rate(n, &mode.network, &self.observer.at.network);
                    let mass = pressure / stiffness;
                    self.sizes[1] += pressure * volume / dead.excess + mass * dead.heat_capacity * temperature;
                    self.sizes[2] += mass;
                }
            }
            NodeKind::Outlet { .. } | NodeKind::Port { .. } => {}
        }
        of.heat += weight * heat;
        of.heat_loss += weight * dead.lost_with(heat, temperature);
        of.mixed += weight * mixed;
    }

    /// Heat into the air of an actuator, and what comes in where its pressure is given.
    fn chamber(&mut self, i: usize, weight: f64, dead: &DeadState) {
        let Self { plant, observer, ledger, sizes, .. } = self;
        let (of, mounted) = (&mut ledger.actuators[i], &plant.actuators()[i]);
        let (unit, chamber) = (&observer.at.units[i], &observer.at.chambers[i]);
        let temperature = mounted.actuator.air().temperature(chamber);
        let heat = observer.heat(i);
        of.heat += weight * heat;
        of.heat_loss += weight * dead.lost_with(heat, temperature);
        if mounted.pressure.is_some() {
            let worth = dead.stream(temperature, chamber.pressure);
            of.given.add(weight * unit.flow.net(), dead.heat_capacity * temperature, worth);
            of.vented += weight * unit.flow.outward;
        }
        sizes[1] += chamber.mass * dead.heat_capacity * temperature;
        sizes[2] += chamber.mass;
    }
}

impl Passing {
    /// Takes in an amount (kg/s) at a temperature.
    fn take(&mut self, amount: f64, temperature: f64, dead: &DeadState) {
        self.inward += amount;
        self.warmth += amount * temperature;
        self.worth += amount * dead.stream(temperature, self.pressure);
        self.mixed += amount * dead.mixed(temperature, self.temperature);
    }
}

/// Lets an amount (kg/s) pass from one node to another; the exergy in W that the throttling on the way destroys.
fn pass(nodes: &mut [Passing], [up, down]: [usize; 2], amount: f64, dead: &DeadState) -> f64 {
    let temperature = nodes[up].temperature;
    nodes[up].outward += amount;
    nodes[down].take(amount, temperature, dead);
    amount * dead.throttle(nodes[up].pressure, nodes[down].pressure)
}

/// Volume in m³ and stiffness in Pa/kg of a node that holds air of a temperature that stays.
fn volume(kind: &NodeKind) -> Option<[f64; 2]> {
    match kind {
        NodeKind::Hose(hose) => Some([hose.tube().volume(), hose.stiffness()]),
        NodeKind::Reservoir(reservoir) => Some([reservoir.volume(), reservoir.pressure_rate(1.0)]),
        _ => None,
    }
}
