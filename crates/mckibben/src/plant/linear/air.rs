//! The air of a plant at rest, or flowing through on average.
//!
//! ```text
//! f(P, …) = 0        unknown: pressures and flows that are not given, or what keeps those that are
//! m = m₀ (V/V₀) (P/P₀)^(1/κ)   or   m = P V/(R T)
//! ```
//!
//! Flows depend on pressures and densities alone, so that the air is solved before the mechanisms, by implicit steps of
//! growing length from the start (pseudo-transient continuation): they end as Newton's method and go where the air itself
//! would. Where a pressure is given, what holds it is unknown in its place: a command, or a mass flow from outside. A
//! reservoir that an open path supplies comes to balance as the actuators do; one that nothing supplies keeps its pressure.
//!
//! Source: C. T. Kelley & D. E. Keyes, "Convergence analysis of pseudo-transient continuation", SIAM J. Numer. Anal. 35
//! (1998). Checked by `tests/plant_linear.rs` and `tests/plant_linear_closed_forms.rs`.

use super::frame::{Drive, Fed, Frame, Quantity};
use super::{PlantAir, matrix};
use crate::air::Process;
use crate::error::Error;
use crate::network::{BranchKind, NodeKind};
use crate::plant::Plant;
use crate::scalar::Scalar;
use alloc::vec;
use alloc::vec::Vec;

/// Steps after which there is no steady state.
const MOST_STEPS: usize = 1000;
/// First and longest step in s, and how much one grows on the one before.
const STEPS: (f64, f64, f64) = (1e-4, 1e9, 4.0);
/// The step in s below which a change that is too large is cut instead.
const SHORTEST: f64 = 1e-9;
/// The part of a pressure by which one step may change it.
const LARGEST_CHANGE: f64 = 0.3;
/// The part of its size below which a step is rounding, and below which it has come close.
const ROUNDING: f64 = 1e-14;
const CLOSE: f64 = 1e-10;
/// Relative rate in 1/s below which the air stands still but for rounding, and above which it does not.
const STILL: f64 = 1e-8;
const MOVING: f64 = 1e-3;
/// What a step must leave at most of what was left, or it is halved up to so many times.
const LESS: f64 = 0.9;
const MOST_HALVINGS: usize = 6;
/// Part of the range of a duty by which one is kept from its ends.
const WITHIN: f64 = 1e-9;
/// Usual size of a flow in kg/s, for scaling alone.
const USUAL_FLOW: f64 = 1e-3;

const NO_STEADY_AIR: Error = Error::NoSolution {
    what: "the air of the plant comes to no steady state under these commands",
    remedy: "give pressures that are to be held, or commands between whose fill and exhaust a balance exists",
};
const NO_DUTY: Error = Error::NoSolution {
    what: "no command that the valve can follow holds a given pressure: no duty that moves the seats does",
    remedy: "give a pressure well between supply and exhaust, or a lower command.frequency",
};
const NO_COMMAND: Error = Error::NoSolution {
    what: "no command that the valve can follow holds a given pressure",
    remedy: "give a pressure well between supply and exhaust",
};

/// That no command holds a pressure.
fn no_command(drive: &Drive) -> Error {
    match drive {
        Drive::Duty(_) => NO_DUTY,
        _ => NO_COMMAND,
    }
}

/// Ends a step at the pressure before each check valve that it would fill beyond: what is behind would rest there, too full.
fn stop_at_checks(before: &Frame, frame: &mut Frame) {
    let Plant { network, places, .. } = &before.plant;
    let pressure = |frame: &Frame, node: usize| match places.nodes[node] {
        Some(slot) => frame.state[slot],
        None => (network.nodes[node].gauge + network.atmosphere).value,
    };
    for branch in network.branches.iter().filter(|branch| matches!(branch.kind, BranchKind::Check { .. })) {
        let fills = pressure(before, branch.to) <= pressure(before, branch.from);
        let limit = pressure(frame, branch.from);
        if let Some(slot) = places.nodes[branch.to].filter(|_| fills && pressure(frame, branch.to) > limit) {
            frame.state[slot] = limit;
        }
    }
}

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
    /// A single state; whether it is a pressure.
    Slot(usize, bool),
    /// What drives a valve.
    Drive(usize),
}

/// Between which commands a valve follows. At an end of the range of a duty nothing answers to it on one side: the range ends before.
pub(super) fn command_range(plant: &Plant, valve: usize) -> [f64; 2] {
    let actuation = &plant.network.valves[valve];
    match crate::valve::duty_range(&actuation.solenoid, &actuation.command) {
        Some((low, high)) => {
            let inside = WITHIN * (high - low).abs();
            [low.min(high) + inside, high.max(low) - inside]
        }
        None if actuation.solenoid.spool().is_some() => [-1.0, 1.0],
        None => [0.0, f64::MAX],
    }
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
    /// Whether flows balance in each node; a reservoir in which they do not keeps its pressure by a flow from outside.
    pub(super) supplied: Vec<bool>,
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

    /// Mass in kg of an actuator's air at a pressure in Pa and a volume in m³, and its derivative with respect to the
    /// pressure.
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
                (NodeKind::Reservoir(_), Some(feed)) if !self.supplied[index] => {
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
                let [low, high] = command_range(self.plant, valve);
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

    /// Brings the rates of all unknown pressures and flows to zero.
    pub(super) fn solve(&self, frame: &mut Frame) -> Result<(), Error> {
        let begun = frame.clone();
        let Err(error) = self.solve_by(frame, false) else { return Ok(()) };
        if self.holders.iter().all(Option::is_none) {
            return Err(error);
        }
        // A command that holds a pressure in a muscle behind a hose in cells acts through one cell after the other: the shorter a
        // step, the more of the command it takes to change the muscle within it. Newton's steps have no end in time.
        *frame = begun;
        self.solve_by(frame, true).map_err(|_| error)
    }

    /// Brings them there by steps that begin short and grow, or by Newton's alone. Of these the first may leave more than there was:
    /// the flows through a hose settle before the pressures that drive them.
    fn solve_by(&self, frame: &mut Frame, newton: bool) -> Result<(), Error> {
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
        let (first, longest, growth) = STEPS;
        let (mut step, shortest) = if newton { (longest, longest) } else { (first, SHORTEST) };
        let mut residuals = residual(frame);
        let mut settled = 0;
        for _ in 0..MOST_STEPS {
            if norm(&residuals) == 0.0 {
                return self.check(frame, &unknowns, &residuals);
            }
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
            let Some(change) = matrix::solve(jacobian, residuals.clone()) else {
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
            // A shorter step, not a part of a long one: where pressures move freely at first, that leads elsewhere.
            if largest > 1.0 && step > shortest {
                step /= 2.0;
                continue;
            }
            let before = frame.clone();
            let tried = |part: f64, frame: &mut Frame| {
                frame.clone_from(&before);
                for (unknown, change) in unknowns.iter().zip(&change) {
                    self.shift(unknown, part * change * unknown.size, frame, &volumes);
                }
                stop_at_checks(&before, frame);
                residual(frame)
            };
            let whole = 1.0 / largest.max(1.0);
            let mut next = tried(whole, frame);
            // A flow goes with the root of a small difference of pressure, and a whole step goes as far beyond its end: less of
            // it may bring more. Where nothing does, air on its way may be farther from rest before it comes nearer.
            let brings = |next: &[f64]| norm(next) < LESS * norm(&residuals);
            if !brings(&next) {
                let mut part = whole;
                for _ in 0..MOST_HALVINGS {
                    part *= 0.5;
                    let other = tried(part, frame);
                    if brings(&other) {
                        next = other;
                        break;
                    }
                }
                if !brings(&next) {
                    next = tried(whole, frame);
                }
            }
            let is_better = norm(&next).is_finite() && (newton || norm(&next) <= 2.0 * norm(&residuals) + STILL);
            if !is_better && step > 1e-12 {
                *frame = before;
                step /= 2.0 * growth;
                continue;
            }
            residuals = next;
            if step < longest {
                step *= growth;
            } else if largest <= 1.0 && norm(&change) < CLOSE {
                settled += 1;
                if settled > 2 || norm(&change) < ROUNDING {
                    return self.check(frame, &unknowns, &residuals);
                }
            }
        }
        let mut holders = self.holders.iter().flatten();
        Err(holders.next().map_or(NO_STEADY_AIR, |valve| no_command(&frame.drives[*valve])))
    }

    /// Checks that nothing was kept from where it would go.
    fn check(&self, frame: &Frame, unknowns: &[Unknown], residuals: &[f64]) -> Result<(), Error> {
        for (unknown, residuals) in unknowns.iter().zip(residuals) {
            if let UnknownKind::Drive(valve) = unknown.kind
                && let Drive::Duty(command) | Drive::Spool(command) | Drive::SetPoint(command, _) = frame.drives[valve]
            {
                let [low, high] = command_range(self.plant, valve);
                if (command <= low || command >= high) && residuals.abs() > STILL {
                    return Err(no_command(&frame.drives[valve]));
                }
            }
            if residuals.abs() > MOVING {
                return Err(NO_STEADY_AIR);
            }
        }
        Ok(())
    }
}
