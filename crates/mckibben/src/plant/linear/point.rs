//! Where a plant is linearised: its mechanisms in balance, its air at rest or flowing through on average.
//!
//! ```text
//! air           f(P, …) = 0        unknown: pressures and flows that are not given, or what keeps those that are
//! mechanisms    τ(q) − Σ Jᵀ F = 0, F(L, P) = T(x, L)      unknown: coordinates, and lengths on tendons
//! content       m = m₀ (V/V₀) (P/P₀)^(1/κ)   or   m = P V/(R T)
//! ```
//!
//! Flows depend on pressures and densities alone, so the air is solved first, by implicit steps of growing length from the
//! start (pseudo-transient continuation): they end at Newton's method and go where the air itself would. The mechanisms are
//! solved by Newton steps that are shortened, and shifted towards stiffness, until they go downhill: the balance that a plant
//! would creep into. A start that is in balance stays where it is, stable or not.
//!
//! Source: C. T. Kelley & D. E. Keyes, "Convergence analysis of pseudo-transient continuation" (1998); J. Nocedal &
//! S. J. Wright, Numerical Optimization (2006), chapter 3. Checked by `tests/plant_linear.rs`.

use super::frame::{Drive, Fed, Frame, Instant, Quantity};
use super::{PlantAir, matrix};
use crate::air::Process;
use crate::error::Error;
use crate::force::Statics;
use crate::mechanism::Mechanism;
use crate::network::{BranchKind, NodeKind};
use crate::plant::Plant;
use crate::scalar::Scalar;
use alloc::vec;
use alloc::vec::Vec;

/// Steps of either solver.
const MOST_STEPS: usize = 400;
/// First and last step of the air in s, and how much one grows on the one before.
const AIR_STEPS: (f64, f64, f64) = (1e-4, 1e9, 4.0);
/// The part of a pressure by which one step may change it.
const LARGEST_CHANGE: f64 = 0.3;
/// The part of its size below which a step is rounding.
const ROUNDING: f64 = 1e-14;
/// Relative rate in 1/s below which the air stands still but for rounding.
const STILL: f64 = 1e-8;
/// Usual sizes of a flow in kg/s and of a temperature change, for scaling alone.
const USUAL_FLOW: f64 = 1e-3;
/// The largest step of an angle in rad, and of a length as a part of an actuator's longest.
const LARGEST_STEP: (f64, f64) = (0.2, 0.05);
/// Part of the usual force below which a residual is rounding.
const FORCE_ROUNDING: f64 = 1e-13;

const NO_BALANCE: Error = Error::NoSolution {
    what: "the mechanisms of the plant come to no balance near their start at these pressures",
    remedy: "give positions nearer to a balance, other pressures or another load; an actuator on its shortest length or a \
             stop that is just touched has no linear model",
};
const NO_STEADY_AIR: Error = Error::NoSolution {
    what: "the air of the plant comes to no steady state under these commands",
    remedy: "give pressures that are to be held, or commands between whose fill and exhaust a balance exists",
};
const NO_COMMAND: Error = Error::NoSolution {
    what: "no command that the valve can follow holds a given pressure",
    remedy: "give a pressure well between supply and exhaust, or a lower command.frequency",
};

/// An unknown of the air, and the state whose rate it brings to zero.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unknown {
    kind: UnknownKind,
    row: usize,
    /// Usual sizes of the unknown and of the state.
    size: f64,
    row_size: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum UnknownKind {
    /// Pressure of an actuator, whose air mass goes with it where the process ties it.
    Pressure(usize),
    /// A state by itself; whether it is a pressure.
    Slot(usize, bool),
    /// What drives a valve.
    Drive(usize),
}

/// Brings the air of a plant to rest.
pub(super) struct AirSolver<'a> {
    pub(super) plant: &'a Plant,
    pub(super) air: &'a PlantAir,
    /// Pressure and mass of each actuator's air at the start, and its volume there.
    pub(super) start: Vec<[f64; 3]>,
    /// Whether the pressure of each actuator is given.
    pub(super) given: Vec<bool>,
    /// The valve that is to hold each given pressure, if one is.
    pub(super) holders: Vec<Option<usize>>,
}

impl AirSolver<'_> {
    fn keeps_heat(&self, i: usize) -> bool {
        self.plant.places.keeps_heat[i]
    }

    /// Temperature in K at which the air of an actuator rests, where the wall sets it.
    pub(super) fn wall(&self, i: usize) -> Option<f64> {
        match self.plant.actuators[i].actuator.air().process() {
            Process::EnergyBalance { heat_transfer, wall_temperature } if heat_transfer > 0.0 => Some(wall_temperature),
            _ => None,
        }
    }

    /// Mass in kg of an actuator's air at a pressure in Pa and a volume in m³, and its derivative by the pressure.
    pub(super) fn mass(&self, i: usize, pressure: f64, volume: f64) -> [f64; 2] {
        let air = self.plant.actuators[i].actuator.air();
        let at = |temperature: f64| {
            let mass = pressure * volume / (air.gas_constant() * temperature);
            [mass, mass / pressure]
        };
        let [before, content, room] = self.start[i];
        match self.air {
            PlantAir::Temperatures(kelvin) => at(self.wall(i).unwrap_or(kelvin[i])),
            PlantAir::Start if self.keeps_heat(i) => {
                let kelvin = before * room / (content * air.gas_constant());
                at(self.wall(i).unwrap_or(kelvin))
            }
            PlantAir::Start => {
                let mass = content * (volume / room) * Scalar::power(pressure / before, 1.0 / air.index());
                [mass, mass / (air.index() * pressure)]
            }
        }
    }

    fn unknowns(&self, frame: &Frame) -> Vec<Unknown> {
        let (places, network) = (&frame.plant.places, &frame.plant.network);
        let atmosphere = self.plant.network.atmosphere;
        let mut unknowns = Vec::new();
        let mut add = |kind, row, size, row_size| unknowns.push(Unknown { kind, row, size, row_size });
        for (i, mounted) in self.plant.actuators.iter().enumerate() {
            if mounted.pressure.is_some() {
                continue;
            }
            let (slot, mass) = (places.actuators[i].pressure, frame.state[places.actuators[i].mass()]);
            let holder = if !self.given[i] {
                UnknownKind::Pressure(i)
            } else {
                match (self.holders[i], frame.feed(Fed::Actuator(i))) {
                    (Some(valve), _) => UnknownKind::Drive(valve),
                    (None, Some(feed)) => UnknownKind::Slot(feed, false),
                    (None, None) => continue,
                }
            };
            let size = match holder {
                UnknownKind::Pressure(_) => atmosphere,
                UnknownKind::Slot(..) => USUAL_FLOW,
                UnknownKind::Drive(valve) => {
                    if let Drive::SetPoint(..) = frame.drives[valve] {
                        atmosphere
                    } else {
                        1.0
                    }
                }
            };
            add(holder, slot, size, atmosphere);
            if self.keeps_heat(i) {
                add(UnknownKind::Slot(slot + 1, false), slot + 1, mass, mass);
            }
        }
        for (index, node) in network.nodes.iter().enumerate() {
            let Some(slot) = places.nodes[index] else { continue };
            match (&node.kind, frame.feed(Fed::Node(index))) {
                (NodeKind::Reservoir(_), Some(feed)) => {
                    add(UnknownKind::Slot(feed, false), slot, USUAL_FLOW, atmosphere);
                }
                _ => add(UnknownKind::Slot(slot, true), slot, atmosphere, atmosphere),
            }
        }
        for (index, place) in places.branches.iter().enumerate() {
            let Some(slot) = *place else { continue };
            if !frame.feeds.iter().any(|(_, feed)| *feed == slot) {
                let per_pressure = match &network.branches[index].kind {
                    BranchKind::Inertia(hose) => hose.per_inertance().value,
                    _ => 1.0,
                };
                add(UnknownKind::Slot(slot, false), slot, USUAL_FLOW, USUAL_FLOW.max(per_pressure * 1e-3));
            }
        }
        unknowns
    }

    fn seeds(&self, unknown: &Unknown, frame: &Frame, volumes: &[f64]) -> Vec<(Quantity, f64)> {
        match unknown.kind {
            UnknownKind::Slot(slot, _) => vec![(Quantity::Slot(slot), 1.0)],
            UnknownKind::Pressure(i) => {
                let slot = frame.plant.places.actuators[i].pressure;
                let mut seeds = vec![(Quantity::Slot(slot), 1.0)];
                if !self.keeps_heat(i) {
                    let [_, slope] = self.mass(i, frame.state[slot], volumes[i]);
                    seeds.push((Quantity::Slot(slot + 1), slope));
                }
                seeds
            }
            UnknownKind::Drive(valve) => {
                let mut seeds = vec![(Quantity::Drive(valve), 1.0)];
                // At rest a spool is where it is sent.
                seeds.extend(
                    frame.spools.iter().filter(|(it, _)| *it == valve).map(|(_, at)| (Quantity::Slot(*at), 1.0)),
                );
                seeds
            }
        }
    }

    /// Changes an unknown; a command is kept to what its valve can follow.
    fn shift(&self, unknown: &Unknown, by: f64, frame: &mut Frame, volumes: &[f64]) {
        match unknown.kind {
            UnknownKind::Slot(slot, _) => frame.state[slot] += by,
            UnknownKind::Pressure(i) => {
                let slot = frame.plant.places.actuators[i].pressure;
                frame.state[slot] += by;
                if !self.keeps_heat(i) {
                    frame.state[slot + 1] = self.mass(i, frame.state[slot], volumes[i])[0];
                }
            }
            UnknownKind::Drive(valve) => {
                let [low, high] = self.command_range(valve);
                match &mut frame.drives[valve] {
                    Drive::Duty(command) | Drive::Spool(command) | Drive::SetPoint(command, _) => {
                        *command = (*command + by).clamp(low, high);
                        for (_, slot) in frame.spools.iter().filter(|(it, _)| *it == valve) {
                            frame.state[*slot] = *command;
                        }
                    }
                    Drive::Openings(_) => {}
                }
            }
        }
    }

    fn command_range(&self, valve: usize) -> [f64; 2] {
        let actuation = &self.plant.network.valves[valve];
        match crate::valve::duty_range(&actuation.solenoid, &actuation.command) {
            Some((low, high)) => [low.min(high), high.max(low)],
            None if actuation.solenoid.spool().is_some() => [-1.0, 1.0],
            None => [0.0, f64::MAX],
        }
    }

    /// Brings the rates of all unknown pressures and flows to zero.
    pub(super) fn solve(&self, frame: &mut Frame) -> Result<(), Error> {
        let unknowns = self.unknowns(frame);
        let count = unknowns.len();
        if count == 0 {
            return Ok(());
        }
        let volumes: Vec<f64> = frame.evaluate(&[]).at.chambers.iter().map(|chamber| chamber.volume.value).collect();
        for (i, volume) in volumes.iter().enumerate() {
            let slot = frame.plant.places.actuators[i].pressure;
            frame.state[slot + 1] = self.mass(i, frame.state[slot], *volume)[0];
        }
        let residual = |frame: &Frame| -> Vec<f64> {
            let rates = frame.evaluate(&[]).rates;
            unknowns.iter().map(|unknown| rates[unknown.row].value / unknown.row_size).collect()
        };
        let norm = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let (mut step, longest, growth) = AIR_STEPS;
        let mut left = residual(frame);
        let mut settled = 0;
        for _ in 0..MOST_STEPS {
            let mut jacobian = vec![0.0; count * count];
            for (column, unknown) in unknowns.iter().enumerate() {
                let rates = frame.evaluate(&self.seeds(unknown, frame, &volumes)).rates;
                for (row, other) in unknowns.iter().enumerate() {
                    jacobian[row * count + column] = -rates[other.row].slope[0] * unknown.size / other.row_size;
                }
                // What is not the state itself answers at once.
                let own = matches!(unknown.kind, UnknownKind::Pressure(_))
                    || matches!(unknown.kind, UnknownKind::Slot(slot, _) if slot == unknown.row);
                if own {
                    jacobian[column * count + column] += unknown.size / unknown.row_size / step;
                }
            }
            let Some(change) = matrix::solve(jacobian, left.clone()) else {
                step /= growth;
                continue;
            };
            let largest = unknowns.iter().zip(&change).fold(0.0_f64, |most, (unknown, change)| match unknown.kind {
                UnknownKind::Pressure(_) | UnknownKind::Slot(_, true) => {
                    let now = frame.state[unknown.row];
                    most.max((change * unknown.size / now).abs() / LARGEST_CHANGE)
                }
                UnknownKind::Slot(slot, _)
                    if slot == unknown.row && frame.state[slot] > 0.0 && unknown.size != USUAL_FLOW =>
                {
                    most.max((change * unknown.size / frame.state[slot]).abs() / LARGEST_CHANGE)
                }
                _ => most,
            });
            let part = 1.0 / largest.max(1.0);
            let before = frame.clone();
            for (unknown, change) in unknowns.iter().zip(&change) {
                self.shift(unknown, part * change * unknown.size, frame, &volumes);
            }
            let next = residual(frame);
            let is_better = norm(&next).is_finite() && norm(&next) <= 2.0 * norm(&left) + STILL;
            if !is_better && step > 1e-12 {
                *frame = before;
                step /= 2.0 * growth;
                continue;
            }
            left = next;
            if step < longest {
                step *= growth;
            } else if part == 1.0 && norm(&change) < 1e-10 {
                settled += 1;
                if settled > 2 || norm(&change) < ROUNDING {
                    return self.check(frame, &unknowns, &left);
                }
            }
        }
        Err(if self.holders.iter().any(Option::is_some) { NO_COMMAND } else { NO_STEADY_AIR })
    }

    /// Checks that nothing was kept from where it would go.
    fn check(&self, frame: &Frame, unknowns: &[Unknown], left: &[f64]) -> Result<(), Error> {
        for (unknown, left) in unknowns.iter().zip(left) {
            if let UnknownKind::Drive(valve) = unknown.kind
                && let Drive::Duty(command) | Drive::Spool(command) | Drive::SetPoint(command, _) = frame.drives[valve]
            {
                let [low, high] = self.command_range(valve);
                if (command <= low || command >= high) && left.abs() > 1e-6 {
                    return Err(NO_COMMAND);
                }
            }
            if left.abs() > 1e-3 {
                return Err(NO_STEADY_AIR);
            }
        }
        Ok(())
    }
}

/// Brings the mechanisms of a plant, and the actuators on tendons, into balance at the pressures that there are.
pub(super) fn balance(frame: &mut Frame) -> Result<(), Error> {
    let unknowns = Mechanical::of(frame);
    let count = unknowns.slots.len();
    if count == 0 {
        return Ok(());
    }
    let mut instant = frame.evaluate(&[]);
    let mut left = unknowns.residual(&instant);
    let mut shift = 0.0;
    for _ in 0..MOST_STEPS {
        let mut stiffness = vec![0.0; count * count];
        for (column, slot) in unknowns.slots.iter().enumerate() {
            let along = frame.evaluate(&[(Quantity::Slot(*slot), 1.0)]);
            for row in 0..count {
                stiffness[row * count + column] = -unknowns.slope(&along, row);
            }
        }
        let rests = left.iter().zip(&unknowns.usual).all(|(left, usual)| left.abs() <= FORCE_ROUNDING * usual);
        let (change, used) = unknowns.step(&stiffness, &left, shift);
        let part = change
            .iter()
            .zip(&unknowns.largest)
            .fold(1.0_f64, |part, (change, largest)| part.min(largest / change.abs().max(1e-300)));
        if rests {
            // One step more takes off what rounding has left, if the balance is a firm one.
            if used == 0.0 && part == 1.0 {
                unknowns.shift(frame, &change, 1.0);
            }
            return Ok(());
        }
        let power = |left: &[f64]| left.iter().zip(&change).map(|(left, change)| left * change).sum::<f64>();
        let downhill = power(&left);
        let before = frame.state.clone();
        let mut part = part;
        let mut accepted = false;
        for _ in 0..60 {
            frame.state.clone_from(&before);
            unknowns.shift(frame, &change, part);
            instant = frame.evaluate(&[]);
            let next = unknowns.residual(&instant);
            let is_inside = unknowns.is_inside(frame, &instant);
            if is_inside && next.iter().all(|value| value.is_finite()) && power(&next) >= -0.5 * downhill {
                left = next;
                accepted = true;
                break;
            }
            part *= 0.5;
        }
        if !accepted {
            return Err(NO_BALANCE);
        }
        let moved =
            change.iter().zip(&unknowns.largest).fold(0.0_f64, |most, (by, size)| most.max((part * by / size).abs()));
        if used == 0.0 && moved < ROUNDING {
            return Ok(());
        }
        shift = if used > 1e-9 { 0.1 * used } else { 0.0 };
    }
    Err(NO_BALANCE)
}

/// The coordinates and lengths that balance.
struct Mechanical {
    slots: Vec<usize>,
    kinds: Vec<MechanicalKind>,
    /// Usual force along each, and the largest step of each.
    usual: Vec<f64>,
    largest: Vec<f64>,
}

#[derive(Clone, Copy)]
enum MechanicalKind {
    /// A coordinate, by its place among the forces on all.
    Coordinate(usize),
    /// Length of an actuator on a tendon.
    Length(usize),
}

impl Mechanical {
    fn of(frame: &Frame) -> Self {
        let Plant { actuators, mechanisms, places, .. } = &frame.plant;
        let mut these = Self { slots: vec![], kinds: vec![], usual: vec![], largest: vec![] };
        let usual = frame.usual_forces();
        let mut first = 0;
        for (m, mechanism) in mechanisms.iter().enumerate() {
            let here = places.mechanisms[m];
            for k in (0..here.coordinates).filter(|_| mechanism.is_dynamic()) {
                these.slots.push(here.position(k));
                these.kinds.push(MechanicalKind::Coordinate(first + k));
                these.usual.push(usual[m]);
                let longest = places.members[m].iter().map(|i| actuators[*i].actuator.limits().max_length().value);
                let longest = longest.fold(0.0, f64::max);
                these.largest.push(match mechanism {
                    Mechanism::Chain(_) => LARGEST_STEP.0,
                    _ if longest > 0.0 => LARGEST_STEP.1 * longest,
                    _ => 1.0,
                });
            }
            first += here.coordinates;
        }
        for (i, mounted) in actuators.iter().enumerate() {
            if let (Some(slot), Some(_)) = (places.actuators[i].length, &mounted.tendon) {
                these.slots.push(slot);
                these.kinds.push(MechanicalKind::Length(i));
                these.usual.push(usual[mounted.mechanism].max(1.0));
                these.largest.push(LARGEST_STEP.1 * mounted.actuator.limits().max_length().value);
            }
        }
        these
    }

    fn number(&self, instant: &Instant, row: usize) -> super::frame::Number {
        match self.kinds[row] {
            MechanicalKind::Coordinate(place) => instant.forces[place],
            MechanicalKind::Length(i) => -instant.excess[i].unwrap_or(Scalar::zero()),
        }
    }

    fn residual(&self, instant: &Instant) -> Vec<f64> {
        (0..self.slots.len()).map(|row| self.number(instant, row).value).collect()
    }

    fn slope(&self, instant: &Instant, row: usize) -> f64 {
        self.number(instant, row).slope[0]
    }

    fn shift(&self, frame: &mut Frame, change: &[f64], part: f64) {
        for (slot, change) in self.slots.iter().zip(change) {
            frame.state[*slot] += part * change;
        }
    }

    /// Whether no actuator is as long as its thread.
    fn is_inside(&self, frame: &Frame, instant: &Instant) -> bool {
        frame
            .plant
            .actuators
            .iter()
            .zip(&instant.at.units)
            .all(|(mounted, unit)| unit.length.value < mounted.actuator.law().law.end_length().value)
    }

    /// The step of a stiffness that is shifted, if it must be, until it is positive; and by how much it was.
    fn step(&self, stiffness: &[f64], left: &[f64], mut shift: f64) -> (Vec<f64>, f64) {
        let count = left.len();
        let size: Vec<f64> =
            (0..count).map(|k| stiffness[k * count + k].abs().max(1e-3 * self.usual[k] / self.largest[k])).collect();
        loop {
            let mut shifted = stiffness.to_vec();
            for k in 0..count {
                shifted[k * count + k] += shift * size[k];
            }
            let mut symmetric: Vec<f64> =
                (0..count * count).map(|n| 0.5 * (shifted[n] + shifted[(n % count) * count + n / count])).collect();
            crate::plant::dense::factor(&mut symmetric, count);
            let is_positive = (0..count).all(|k| symmetric[k * count + k] > 1e-12 * size[k]);
            if is_positive && let Some(change) = matrix::solve(shifted, left.to_vec()) {
                return (change, shift);
            }
            if shift > 1e12 {
                return (vec![0.0; count], shift);
            }
            shift = (10.0 * shift).max(1e-3);
        }
    }
}
