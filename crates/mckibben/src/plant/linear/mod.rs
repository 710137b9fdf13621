//! A plant near an operating point: `dx/dt = A x + B u`, `y = C x + D u`, by exact derivatives.
//!
//! ```text
//! x = every state that is independent      u = commands, supply pressures, mass flows, forces      y = what is measured
//!
//! A = ∂f/∂x, B = ∂f/∂u of the rates f of the simulation        C = ∂g/∂x, D = ∂g/∂u of the outputs g
//!
//! pulsed valve     ṁ = s(d) ṁ(open)        s the actual duty cycle of each flow path: the mean flow over a period
//! spool            ẍ = ω² (u − x) − 2ζω ẋ,  ṁ = λ(x) ṁ(open)
//! regulator        ṗ = (u − p)/τ
//! ```
//!
//! Flows add up, and each is proportional to its own opening, so the mean over several pulsed valves of any frequencies is
//! that of each valve over its own period.
//!
//! | state | where it is none |
//! |---|---|
//! | coordinates and rates of masses and chains | a fixed length is at rest; a given motion is an input |
//! | pressure and mass of an actuator's air | a pressure that is given is an input; [`PlantLinearization::minimal`] ties the mass by `P (V/m)^κ` |
//! | length on a tendon | without viscous friction both tensions give it: it is eliminated, exactly |
//! | bristles of LuGre's law | [`PlantLinearization::minimal`]: at rest they follow the length |
//! | pressures of hoses, reservoirs, outlets, ports; flows in cells of hoses; spools | – |
//!
//! Valid near the point, in the mode that holds there: flow zones, taut and slack actuators, pressed stops. The plant slides
//! without Coulomb friction: within ± Q k_sec an actuator sticks and no linear model moves it
//! ([`PlantLinearization::coulomb_bound`]); [`PlantLinearization::with_equivalent_damping`] puts in its place the viscous
//! damping with the same loss. Hysteresis is relaxed at the point. A compressor rests, and what it delivers on average is an
//! input; so is what keeps a leaking actuator or a bottle at the pressure that is given. Dead times are left out.
//!
//! Source: differentiation of (12) to (21) of Colbrunn, Nelson & Quinn (2001) and of the components; averaging: Sanders &
//! Verhulst, Averaging Methods in Nonlinear Dynamical Systems (1985). Checked by `tests/plant_linear.rs`,
//! `tests/plant_linear_pulses.rs` and `tests/plant_linear_closed_forms.rs`.

mod frame;
mod matrix;
mod point;
mod signal;

pub use signal::{PlantInput, PlantOutput, PlantState};

use super::start::PlantStart;
use super::{InitialAir, Part, Plant};
use crate::error::Error;
use crate::linearize::StateSpace;
use crate::mechanism::Mechanism;
use crate::network::{BranchKind, NodeKind};
use crate::parameter;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::Scalar;
use crate::simulation::Actuation;
use crate::valve::{Command, Port, Request, SeatClock, Solenoid, ValveKind, duty_range, period};
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use frame::{Drive, Fed, Frame, Instant, Quantity};
use point::AirSolver;

/// The linear model of a plant.
pub type PlantStateSpace = StateSpace<PlantState, PlantInput, PlantOutput>;

/// What determines the pressures at the operating point; the mechanisms come to balance at them.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantBalance {
    /// The gauge pressure of each actuator, with all valves held shut. Openings of flow paths are inputs.
    Shut(Vec<GaugePressure>),
    /// The commands: the duty of a PWM on average, the last position of a spool, the last set point of a regulator, the last
    /// request of a schedule. An actuator that nothing feeds keeps the pressure of the start.
    Driven,
    /// The gauge pressure of each actuator, with commands of the pulsed and proportional valves that hold them.
    DrivenAt(Vec<GaugePressure>),
}

/// How much air each actuator has at the operating point.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantAir {
    /// As much as has a temperature in K. Air that exchanges heat with a wall and is at rest has the wall's.
    Temperatures(Vec<f64>),
    /// As much as its process leaves, coming from the start.
    Start,
}

/// Where a plant is linearised.
#[derive(Clone, Debug)]
pub struct PlantPoint {
    /// The plant; a motion that is given is held where it starts.
    pub plant: Plant,
    /// Its states, as [`Plant::places`] orders them.
    pub state: Vec<f64>,
    /// The values of the inputs in the order of the model's, those that keep given pressures included.
    pub inputs: Vec<(PlantInput, f64)>,
    /// Length in m of each actuator.
    pub lengths: Vec<f64>,
    /// Tension in N of each actuator, without friction.
    pub tensions: Vec<f64>,
    /// Volume of the air of each actuator in m³.
    volumes: Vec<f64>,
}

/// A pulsed valve on average, and how far that holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValveAverage {
    /// The valve.
    pub valve: usize,
    /// Frequency f in Hz.
    pub frequency: f64,
    /// Commanded duty d.
    pub duty: f64,
    /// Actual duty cycles of the flow paths to supply and surroundings: mean openings over a period.
    pub shares: [f64; 2],
    /// Commanded duties between which every pulse and every gap moves the seats.
    pub duty_range: (f64, f64),
    /// Peak to peak ripple in Pa of the pressure that the valve opens into, at a fixed length.
    pub pressure_ripple: f64,
    /// Pressure in Pa from there to the nearest pressure beyond a path.
    pub pressure_margin: f64,
}

impl ValveAverage {
    /// Whether every pulse and every gap moves the seats.
    pub fn follows(&self) -> bool {
        (self.duty_range.0..=self.duty_range.1).contains(&self.duty)
    }

    /// Whether the ripple is smaller than the margin, so that the flow keeps its direction and about its size.
    pub fn ripple_is_small(&self) -> bool {
        self.pressure_ripple < self.pressure_margin
    }
}

/// A plant near an operating point.
#[derive(Clone, Debug)]
pub struct PlantLinearization {
    /// Where.
    pub point: PlantPoint,
    /// The model with every state but lengths that both tensions give.
    pub system: PlantStateSpace,
    /// The pulsed valves that the model averages.
    pub averages: Vec<ValveAverage>,
    frame: Frame,
}

/// Linearises a plant at the operating point that a balance determines, looked for from a start: positions of what is fixed
/// or given, and the first guess for masses, chains and tendons.
///
/// # Errors
/// As [`Plant::start`]; [`Error::Table`] unless there is one pressure or temperature for each actuator;
/// [`Error::OutOfRange`] or [`Error::Inconsistent`] for one that is not physical; [`Error::NoSolution`] when there is no
/// balance, when no command holds a pressure, or when the point lies on a corner of the model.
pub fn linearize_plant(
    plant: &Plant,
    start: &PlantStart,
    balance: &PlantBalance,
    air: &PlantAir,
) -> Result<PlantLinearization, Error> {
    let mut frame = begin(plant, start, balance, air)?;
    check_corners(&frame)?;
    // Rounding of what balances is no velocity.
    for (m, here) in plant.places.mechanisms.iter().enumerate() {
        let _ = m;
        frame.state[here.rate(0)..here.rate(0) + here.coordinates].fill(0.0);
    }
    PlantLinearization::of(plant, frame)
}

/// The plant in balance.
fn begin(plant: &Plant, start: &PlantStart, what: &PlantBalance, air: &PlantAir) -> Result<Frame, Error> {
    let mut state = plant.start(start)?;
    let count = plant.actuators.len();
    let listed = |name, given: usize| match given == count {
        true => Ok(()),
        false => Err(Error::Table {
            name,
            problem: "there is not one entry for each actuator",
            entry: given.min(count) + 1,
            remedy: "give as many entries as there are actuators",
        }),
    };
    if let PlantAir::Temperatures(kelvin) = air {
        listed(parameter::INITIAL_TEMPERATURE.key, kelvin.len())?;
        kelvin.iter().try_for_each(|kelvin| parameter::INITIAL_TEMPERATURE.check(*kelvin).map(drop))?;
    }
    let content: Vec<[f64; 2]> =
        plant.places.actuators.iter().map(|here| [state[here.pressure], state[here.mass()]]).collect();
    let mut given = vec![true; count];
    if let PlantBalance::Shut(gauges) | PlantBalance::DrivenAt(gauges) = what {
        listed(parameter::INITIAL_GAUGE_PRESSURE.key, gauges.len())?;
        for (i, gauge) in gauges.iter().enumerate() {
            let of_actuator = plant.actuators[i].actuator.air();
            parameter::INITIAL_GAUGE_PRESSURE.check(gauge.0)?;
            let absolute = gauge.absolute(of_actuator.atmosphere()).0;
            if absolute <= 0.0 {
                return Err(crate::valve::below_vacuum(&parameter::INITIAL_GAUGE_PRESSURE, *gauge, of_actuator));
            }
            state[plant.places.actuators[i].pressure] = absolute;
        }
    }
    for (i, mounted) in plant.actuators.iter().enumerate() {
        let (here, limits) = (plant.places.actuators[i], mounted.actuator.limits());
        if let (Some(slot), Some(tendon), None) = (here.length, &mounted.tendon, start.lengths[i]) {
            // Without a length of its own it starts between its limits, its tendon straight.
            let longest = limits.max_length();
            state[slot] = (state[slot] - tendon.rest_length()).clamp(limits.min_length(), longest);
        }
    }
    for here in &plant.places.mechanisms {
        state[here.rate(0)..here.rate(0) + here.coordinates].fill(0.0);
    }
    let shut = matches!(what, PlantBalance::Shut(_));
    let valves = plant.network.valves.iter().enumerate();
    let drives: Vec<Drive> = valves.map(|(valve, actuation)| drive(plant, valve, actuation, shut, &state)).collect();
    let mut frame = Frame::new(plant, drives, &state)?;
    if let PlantBalance::Driven = what {
        let fed = fed(&frame);
        given = (0..count).map(|i| plant.actuators[i].pressure.is_some() || !fed[i]).collect();
    }
    let mut holders = vec![None; count];
    if let PlantBalance::DrivenAt(_) = what {
        holders = (0..count).map(|i| holder(&frame, i)).collect();
        let repeats = |i: usize| holders[i].is_some() && holders[..i].contains(&holders[i]);
        if (0..count).any(repeats) {
            return Err(Error::NoSolution {
                what: "one valve cannot hold the pressures of two actuators: its one command gives one pressure",
                remedy: "give the commands instead of the pressures, or a valve to each actuator",
            });
        }
    }
    let volumes = volumes(&frame);
    let start = content.iter().zip(&volumes).map(|([pressure, mass], volume)| [*pressure, *mass, *volume]).collect();
    let solver = AirSolver { plant, air, start, given, holders };
    solver.solve(&mut frame)?;
    let temperatures: Vec<f64> = (0..count)
        .map(|i| {
            let here = plant.places.actuators[i];
            volumes[i] * frame.state[here.pressure] / frame.state[here.mass()]
        })
        .collect();
    point::balance(&mut frame)?;
    frame.holds_ends = false;
    for (i, volume) in self::volumes(&frame).into_iter().enumerate() {
        let here = plant.places.actuators[i];
        let pressure = frame.state[here.pressure];
        // Flows leave a temperature, a process that is kept leaves a content.
        frame.state[here.mass()] = match plant.places.keeps_heat[i] {
            true => volume * pressure / temperatures[i],
            false => solver.mass(i, pressure, volume)[0],
        };
    }
    Ok(frame)
}

fn volumes(frame: &Frame) -> Vec<f64> {
    frame.evaluate(&[]).at.chambers.iter().map(|chamber| chamber.volume.value).collect()
}

/// What drives a valve at the point.
fn drive(plant: &Plant, valve: usize, actuation: &Actuation, shut: bool, state: &[f64]) -> Drive {
    let Actuation { solenoid, command } = actuation;
    if solenoid.regulator().is_some() {
        let last = (0..).map_while(|index| command.set_point(index)).last();
        let port = plant.network.nodes.iter().zip(&plant.places.nodes).find_map(|(node, place)| match node.kind {
            NodeKind::Port { valve: its, .. } if its == valve => place.map(|place| state[place]),
            _ => None,
        });
        let kept = port.map_or(0.0, |pressure| pressure - plant.network.atmosphere);
        return Drive::SetPoint(last.map_or(kept, |(_, gauge)| gauge), !shut);
    }
    if shut {
        return Drive::Openings([0.0; 2]);
    }
    match command {
        Command::Pwm { duty, .. } if solenoid.has_seats() => Drive::Duty(*duty),
        Command::Positions { .. } => {
            let last = (0..).map_while(|index| command.position(index)).last();
            Drive::Spool(last.map_or(0.0, |(_, position)| position))
        }
        Command::Constant(request) => Drive::Openings(resting(solenoid, Some(*request))),
        _ => {
            let last = match command {
                Command::Table { request, .. } => request.last().copied(),
                _ => None,
            };
            Drive::Openings(resting(solenoid, last))
        }
    }
}

/// The openings of a valve long after a request.
fn resting(solenoid: &Solenoid, request: Option<Request>) -> [f64; 2] {
    let mut clock = SeatClock::released();
    let command = request.map_or(Command::nothing(), Command::Constant);
    let late = solenoid.delays().into_iter().chain(solenoid.ramp().times()).sum::<f64>() + solenoid.transport() + 1.0;
    clock.advance(late, solenoid, &command);
    let ports = clock.ports(solenoid);
    [ports.supply, ports.exhaust].map(|open| f64::from(u8::from(open)))
}

/// The node that is each actuator's chamber, with the nodes that air can come to from there.
fn reachable(frame: &Frame, from: usize, passes: &dyn Fn(usize) -> bool) -> Vec<usize> {
    let network = &frame.plant.network;
    let mut reached = vec![from];
    let mut next = 0;
    while next < reached.len() {
        let node = reached[next];
        next += 1;
        let is_fixed = !matches!(network.nodes[node].kind, NodeKind::Chamber { .. } | NodeKind::Hose(_));
        if is_fixed {
            continue;
        }
        for (index, branch) in network.branches.iter().enumerate() {
            let is_feed = frame.plant.places.branches[index]
                .is_some_and(|slot| frame.feeds.iter().any(|(_, feed)| *feed == slot));
            if is_feed || !passes(index) {
                continue;
            }
            for (one, other) in [(branch.from, branch.to), (branch.to, branch.from)] {
                if one == node && !reached.contains(&other) {
                    reached.push(other);
                }
            }
        }
    }
    reached
}

/// Whether air comes to or goes from each actuator by way of an open path or a leak.
fn fed(frame: &Frame) -> Vec<bool> {
    let network = &frame.plant.network;
    let state: Vec<frame::Number> = frame.state.iter().map(|value| Scalar::constant(*value)).collect();
    let number = |_, value| Scalar::constant(value);
    let openings: Vec<[frame::Number; 2]> =
        (0..frame.drives.len()).map(|valve| frame.openings(valve, &state, &number)).collect();
    let passes = |index: usize| match network.branches[index].kind {
        BranchKind::Path { valve, port, .. } => openings[valve][port as usize].value > 0.0,
        _ => true,
    };
    let chamber = |i: usize| frame.plant.places.chambers[i];
    let fixed = |node: &usize| !matches!(network.nodes[*node].kind, NodeKind::Chamber { .. } | NodeKind::Hose(_));
    (0..frame.plant.actuators.len())
        .map(|i| chamber(i).is_some_and(|node| reachable(frame, node, &passes).iter().any(fixed)))
        .collect()
}

/// The valve whose command can hold the pressure of an actuator.
fn holder(frame: &Frame, i: usize) -> Option<usize> {
    let network = &frame.plant.network;
    let chamber = frame.plant.places.chambers[i]?;
    let nodes = reachable(frame, chamber, &|index| !matches!(network.branches[index].kind, BranchKind::Path { .. }));
    network.branches.iter().find_map(|branch| match branch.kind {
        BranchKind::Path { valve, .. }
            if nodes.contains(&branch.to) && !matches!(frame.drives[valve], Drive::Openings(_)) =>
        {
            Some(valve)
        }
        _ => None,
    })
}

/// Refuses a point on a corner of the model.
fn check_corners(frame: &Frame) -> Result<(), Error> {
    let Instant { at, mode, .. } = frame.evaluate(&[]);
    for (i, mounted) in frame.plant.actuators.iter().enumerate() {
        let (unit, limits) = (&at.units[i], mounted.actuator.limits());
        let moves = frame.plant.mechanisms[mounted.mechanism].is_dynamic() || mounted.tendon.is_some();
        let shortest = limits.min_length().value;
        let on_tendon = mounted.tendon.is_some();
        let least = if on_tendon { f64::MIN } else { shortest * (1.0 - 1e-12) };
        if moves && (least..=shortest * (1.0 + 1e-12)).contains(&unit.length.value) {
            return Err(Error::NoSolution {
                what: "an actuator is at its shortest length at this point, where it rests on the stop: nothing is linear \
                       there",
                remedy: "lower the pressure, or give a heavier load or a longer length",
            });
        }
        if on_tendon && (mode.actuators[i].loose || unit.tension.value <= 0.0) {
            return Err(Error::NoSolution {
                what: "a tendon carries nothing at this point: it goes slack on one side of it",
                remedy: "give a load above zero, a higher pressure or a shorter tendon",
            });
        }
    }
    Ok(())
}

impl PlantLinearization {
    fn of(plant: &Plant, frame: Frame) -> Result<Self, Error> {
        let system = derivatives(&frame);
        let point = point_of(plant, &frame, &system);
        let averages = averages(plant, &frame);
        Ok(Self { point, system, averages, frame })
    }

    /// The model without the states that follow from others: the air mass of an actuator whose process keeps `P (V/m)^κ`, and
    /// the bristles of LuGre's law, which follow the length at rest. The inputs, outputs and poles are those of
    /// [`PlantLinearization::system`], less the poles at zero of what is kept, which no input reaches.
    pub fn minimal(&self) -> PlantStateSpace {
        let mut system = self.system.clone();
        for (i, mounted) in self.frame.plant.actuators.iter().enumerate() {
            let here = self.frame.plant.places.actuators[i];
            let Some(row) = system.outputs.iter().position(|it| *it == PlantOutput::Length { actuator: i }) else {
                continue;
            };
            let ties_mass = !self.frame.plant.places.keeps_heat[i];
            for which in [PlantState::AirMass { actuator: i }, PlantState::Bristles { actuator: i }] {
                let is_mass = matches!(which, PlantState::AirMass { .. });
                let gone = system.states.iter().position(|it| *it == which);
                let Some(gone) = gone.filter(|_| !is_mass || ties_mass) else { continue };
                let [mut per_length, mut per_pressure] = [1.0, 0.0];
                if is_mass {
                    let mass = self.frame.state[here.mass()];
                    let along = self.frame.evaluate(&length_seed(&self.frame, i));
                    per_length = mass * along.at.chambers[i].volume.slope[0] / along.at.chambers[i].volume.value;
                    per_pressure = mass / (mounted.actuator.air().index().value * self.frame.state[here.pressure]);
                    if along.at.units[i].length.slope[0] == 0.0 {
                        per_length = 0.0;
                    } else {
                        per_length = per_length / along.at.units[i].length.slope[0];
                    }
                }
                let (by_states, by_inputs) = (system.c[row].clone(), system.d[row].clone());
                let pressure = PlantState::Pressure { actuator: i };
                let states = system.states.clone();
                system = system.eliminate(
                    gone,
                    |n| per_length * by_states[n] + if states[n] == pressure { per_pressure } else { 0.0 },
                    |k| per_length * by_inputs[k],
                );
            }
        }
        system
    }

    /// Coulomb friction `Q k_sec` of an actuator in N: at rest it sticks while its tension lies within ± this of the
    /// balance.
    pub fn coulomb_bound(&self, actuator: usize) -> f64 {
        let PlantPoint { plant, state, lengths, .. } = &self.point;
        let pressure = state[plant.places.actuators[actuator].pressure];
        plant.actuators[actuator].actuator.coulomb_bound(lengths[actuator], pressure)
    }

    /// The viscous damping in N·s/m that takes as much energy from an actuator's oscillation of `amplitude` (m) at
    /// `angular_frequency` (rad/s), both above zero, as its Coulomb friction: `c_eq = 4 Q k_sec/(π ω X)`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn equivalent_damping(&self, actuator: usize, amplitude: f64, angular_frequency: f64) -> Result<f64, Error> {
        let amplitude = crate::linearize::AMPLITUDE.check(amplitude)?;
        let frequency = crate::linearize::ANGULAR_FREQUENCY.check(angular_frequency)?;
        Ok(4.0 * self.coulomb_bound(actuator) / (PI * frequency * amplitude))
    }

    /// The model with Coulomb friction replaced by the viscous damping of the same loss, for an oscillation of `amplitudes`
    /// (m, one for each actuator) at `angular_frequency` (rad/s), all above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Table`] unless there is one amplitude for each
    /// actuator.
    pub fn with_equivalent_damping(&self, amplitudes: &[f64], angular_frequency: f64) -> Result<Self, Error> {
        if amplitudes.len() != self.point.lengths.len() {
            return Err(Error::Table {
                name: crate::linearize::AMPLITUDE.key,
                problem: "there is not one entry for each actuator",
                entry: amplitudes.len().min(self.point.lengths.len()) + 1,
                remedy: "give as many entries as there are actuators",
            });
        }
        let dampings = amplitudes.iter().enumerate();
        let dampings: Vec<f64> = dampings
            .map(|(i, amplitude)| self.equivalent_damping(i, *amplitude, angular_frequency))
            .collect::<Result<_, _>>()?;
        let mut frame = self.frame.clone();
        frame.plant = frame.plant.map(|part, row, value: frame::Number| match part {
            Some(Part::Actuator(i)) if core::ptr::eq(row, &raw const parameter::VISCOUS) => {
                value + Scalar::constant(dampings[i])
            }
            _ => value,
        });
        Self::of(&self.point.plant, frame)
    }
}

/// A direction in which the length of an actuator changes.
fn length_seed(frame: &Frame, i: usize) -> Vec<(Quantity, f64)> {
    let places = &frame.plant.places;
    if let Some(slot) = places.actuators[i].length {
        return vec![(Quantity::Slot(slot), 1.0)];
    }
    let here = places.mechanisms[frame.plant.actuators[i].mechanism];
    let gradient = frame.evaluate(&[]).at.gradient;
    let own = &gradient[places.actuators[i].gradient..][..here.coordinates];
    own.iter().enumerate().map(|(k, entry)| (Quantity::Slot(here.position(k)), entry.value)).collect()
}

impl PlantPoint {
    /// Gauge pressure of an actuator.
    pub fn gauge_pressure(&self, actuator: usize) -> GaugePressure {
        let air = self.plant.actuators[actuator].actuator.air();
        AbsolutePressure(self.state[self.plant.places.actuators[actuator].pressure]).gauge(air.atmosphere())
    }

    /// Temperature in K of the air of an actuator.
    pub fn temperature(&self, actuator: usize) -> f64 {
        let (here, air) = (self.plant.places.actuators[actuator], self.plant.actuators[actuator].actuator.air());
        self.state[here.pressure] * self.volumes[actuator] / (self.state[here.mass()] * air.gas_constant())
    }

    /// Whether the taut braid of an actuator carries a part of its tension.
    pub fn is_taut(&self, actuator: usize) -> bool {
        self.lengths[actuator] > self.plant.actuators[actuator].actuator.limits().max_length()
    }

    /// The start of a run from the point. Air in hoses starts at rest, at the pressure of their actuators.
    pub fn start(&self) -> PlantStart {
        let mechanisms = self.plant.places.mechanisms.iter();
        let slice = |from: usize, count: usize| self.state[from..from + count].to_vec();
        let air = |i: usize| InitialAir { gauge_pressure: self.gauge_pressure(i), temperature: self.temperature(i) };
        PlantStart {
            positions: mechanisms.clone().map(|here| slice(here.first, here.coordinates)).collect(),
            rates: mechanisms.map(|here| slice(here.rate(0), here.coordinates)).collect(),
            air: (0..self.lengths.len()).map(air).collect(),
            lengths: self.plant.places.actuators.iter().map(|here| here.length.map(|slot| self.state[slot])).collect(),
        }
    }

    /// The value of an input at the point.
    pub fn input(&self, input: PlantInput) -> Option<f64> {
        self.inputs.iter().find(|(its, _)| *its == input).map(|(_, value)| *value)
    }
}

/// The point as its users see it.
fn point_of(plant: &Plant, frame: &Frame, system: &PlantStateSpace) -> PlantPoint {
    let Instant { at, .. } = frame.evaluate(&[]);
    let value = |input: &PlantInput| match *input {
        PlantInput::Duty { valve } | PlantInput::SetPoint { valve } | PlantInput::SpoolCommand { valve } => {
            match frame.drives[valve] {
                Drive::Duty(command) | Drive::Spool(command) | Drive::SetPoint(command, _) => command,
                Drive::Openings(_) => 0.0,
            }
        }
        PlantInput::Opening { valve, port } => match frame.drives[valve] {
            Drive::Openings(openings) => openings[port as usize],
            _ => 0.0,
        },
        PlantInput::SupplyPressure { node } => match &frame.plant.network.nodes[node].kind {
            NodeKind::Outlet { set, .. } => set.value + plant.network.atmosphere,
            _ => frame.plant.network.nodes[node].gauge.value + plant.network.atmosphere,
        },
        PlantInput::MassFlow { actuator } => frame.feed(Fed::Actuator(actuator)).map_or(0.0, |slot| frame.state[slot]),
        PlantInput::NodeFlow { node } => frame.feed(Fed::Node(node)).map_or(0.0, |slot| frame.state[slot]),
        PlantInput::Force { .. } | PlantInput::MotionRate { .. } => 0.0,
        PlantInput::Motion { mechanism, coordinate } => {
            frame.state[plant.places.mechanisms[mechanism].position(coordinate)]
        }
        PlantInput::GivenPressure { actuator } => frame.state[plant.places.actuators[actuator].pressure],
    };
    let mut whole = plant.clone();
    for mechanism in &mut whole.mechanisms {
        if let Mechanism::Prescribed(_) = mechanism {
            *mechanism = Mechanism::External { distances: 1 };
        }
    }
    PlantPoint {
        plant: whole,
        state: frame.state[..plant.places.states].to_vec(),
        inputs: system.inputs.iter().map(|input| (*input, value(input))).collect(),
        lengths: at.units.iter().map(|unit| unit.length.value).collect(),
        tensions: at.units.iter().map(|unit| unit.tension.value).collect(),
        volumes: at.chambers.iter().map(|chamber| chamber.volume.value).collect(),
    }
}

/// The states of the model, each with the place of it and of its rate.
fn states(frame: &Frame) -> Vec<(PlantState, usize)> {
    let Plant { actuators, network, mechanisms, places } = &frame.plant;
    let mut states = Vec::new();
    for (m, here) in places.mechanisms.iter().enumerate().filter(|(m, _)| mechanisms[*m].is_dynamic()) {
        states.extend(
            (0..here.coordinates).map(|k| (PlantState::Position { mechanism: m, coordinate: k }, here.position(k))),
        );
        states.extend(
            (0..here.coordinates).map(|k| (PlantState::Velocity { mechanism: m, coordinate: k }, here.rate(k))),
        );
    }
    for (actuator, here) in places.actuators.iter().enumerate() {
        if actuators[actuator].pressure.is_none() {
            states.push((PlantState::Pressure { actuator }, here.pressure));
            states.push((PlantState::AirMass { actuator }, here.mass()));
        }
        states.extend(here.length.map(|slot| (PlantState::Length { actuator }, slot)));
        states.extend(here.bristles.map(|slot| (PlantState::Bristles { actuator }, slot)));
    }
    for node in 0..network.nodes.len() {
        states.extend(places.nodes[node].map(|slot| (PlantState::NodePressure { node }, slot)));
    }
    for branch in 0..network.branches.len() {
        let own = places.branches[branch].filter(|slot| !frame.feeds.iter().any(|(_, feed)| feed == slot));
        states.extend(own.map(|slot| (PlantState::BranchFlow { branch }, slot)));
    }
    for &(valve, slot) in &frame.spools {
        states.push((PlantState::SpoolPosition { valve }, slot));
        states.push((PlantState::SpoolVelocity { valve }, slot + 1));
    }
    states
}

/// The inputs of the model, each with what to differentiate by; forces have a column of their own.
fn inputs(frame: &Frame) -> Vec<(PlantInput, Option<Quantity>)> {
    let Plant { actuators, network, mechanisms, places } = &frame.plant;
    let mut inputs = Vec::new();
    for (valve, drive) in frame.drives.iter().enumerate() {
        let of_drive = |input| (input, Some(Quantity::Drive(valve)));
        match drive {
            Drive::Duty(_) => inputs.push(of_drive(PlantInput::Duty { valve })),
            Drive::Spool(_) => inputs.push(of_drive(PlantInput::SpoolCommand { valve })),
            Drive::SetPoint(..) => inputs.push(of_drive(PlantInput::SetPoint { valve })),
            Drive::Openings(_) => {
                let ports = match network.valves[valve].solenoid.kind() {
                    ValveKind::TwoWay => &[Port::Supply][..],
                    _ => &[Port::Supply, Port::Exhaust][..],
                };
                let of_port =
                    |port: &Port| (PlantInput::Opening { valve, port: *port }, Some(Quantity::Opening(valve, *port)));
                inputs.extend(ports.iter().map(of_port));
            }
        }
    }
    let is_feed = |node: usize| {
        let of_feed = |(branch, slot): (usize, &Option<usize>)| {
            network.branches[branch].from == node
                && slot.is_some_and(|slot| frame.feeds.iter().any(|(_, it)| *it == slot))
        };
        places.branches.iter().enumerate().any(of_feed)
    };
    for (node, its) in network.nodes.iter().enumerate() {
        if matches!(its.kind, NodeKind::Source | NodeKind::Outlet { .. }) && !is_feed(node) {
            inputs.push((PlantInput::SupplyPressure { node }, Some(Quantity::Supply(node))));
        }
    }
    for (whose, slot) in &frame.feeds {
        let input = match *whose {
            Fed::Actuator(actuator) => PlantInput::MassFlow { actuator },
            Fed::Node(node) => PlantInput::NodeFlow { node },
        };
        inputs.push((input, Some(Quantity::Slot(*slot))));
    }
    for (mechanism, here) in places.mechanisms.iter().enumerate() {
        for coordinate in 0..here.coordinates {
            match &mechanisms[mechanism] {
                Mechanism::Mass(_) | Mechanism::Chain(_) => {
                    inputs.push((PlantInput::Force { mechanism, coordinate }, None));
                }
                Mechanism::External { .. } => {
                    let (position, rate) = (here.position(coordinate), here.rate(coordinate));
                    inputs.push((PlantInput::Motion { mechanism, coordinate }, Some(Quantity::Slot(position))));
                    inputs.push((PlantInput::MotionRate { mechanism, coordinate }, Some(Quantity::Slot(rate))));
                }
                Mechanism::Prescribed(_) | Mechanism::Fixed => {}
            }
        }
    }
    for (actuator, mounted) in actuators.iter().enumerate() {
        if mounted.pressure.is_some() {
            let slot = places.actuators[actuator].pressure;
            inputs.push((PlantInput::GivenPressure { actuator }, Some(Quantity::Slot(slot))));
        }
    }
    inputs
}

/// The outputs of the model with their derivatives at an instant.
fn outputs(frame: &Frame, instant: &Instant, seeds: &[(Quantity, f64)]) -> Vec<(PlantOutput, f64)> {
    let Plant { actuators, network, mechanisms, places } = &frame.plant;
    let of = |slot: usize| seeds.iter().filter(|(its, _)| *its == Quantity::Slot(slot)).map(|(_, slope)| slope).sum();
    let mut outputs = Vec::new();
    for (actuator, unit) in instant.at.units.iter().enumerate() {
        outputs.push((PlantOutput::Length { actuator }, unit.length.slope[0]));
        outputs.push((PlantOutput::LengthRate { actuator }, unit.velocity.slope[0]));
        outputs.push((PlantOutput::Pressure { actuator }, of(places.actuators[actuator].pressure)));
        outputs.push((PlantOutput::Tension { actuator }, unit.tension.slope[0]));
    }
    for (mechanism, here) in places.mechanisms.iter().enumerate().filter(|(m, _)| mechanisms[*m].is_dynamic()) {
        for coordinate in 0..here.coordinates {
            outputs.push((PlantOutput::Position { mechanism, coordinate }, of(here.position(coordinate))));
            outputs.push((PlantOutput::Velocity { mechanism, coordinate }, of(here.rate(coordinate))));
            let pulls = places.members[mechanism].iter().map(|&i| {
                let along = instant.at.gradient[places.actuators[i].gradient + coordinate];
                -(along * instant.at.units[i].tension).slope[0]
            });
            outputs.push((PlantOutput::ActuatorForce { mechanism, coordinate }, pulls.sum()));
        }
    }
    let _ = actuators;
    for node in 0..network.nodes.len() {
        outputs.extend(places.nodes[node].map(|slot| (PlantOutput::NodePressure { node }, of(slot))));
    }
    outputs
}

/// The matrices.
fn derivatives(frame: &Frame) -> PlantStateSpace {
    let (states, inputs) = (states(frame), inputs(frame));
    let none = frame.evaluate(&[]);
    let names: Vec<PlantOutput> = outputs(frame, &none, &[]).into_iter().map(|(output, _)| output).collect();
    let blank = |rows: usize, columns: usize| vec![vec![0.0; columns]; rows];
    let mut system = PlantStateSpace {
        a: blank(states.len(), states.len()),
        b: blank(states.len(), inputs.len()),
        c: blank(names.len(), states.len()),
        d: blank(names.len(), inputs.len()),
        states: states.iter().map(|(state, _)| *state).collect(),
        inputs: inputs.iter().map(|(input, _)| *input).collect(),
        outputs: names,
    };
    let actuators = frame.plant.actuators.len();
    // How the excess force of each actuator on a tendon depends on states and inputs.
    let mut excess = vec![[vec![0.0; states.len()], vec![0.0; inputs.len()]]; actuators];
    let mut column = |seeds: &[(Quantity, f64)], place: usize, is_input: bool, system: &mut PlantStateSpace| {
        let along = frame.evaluate(seeds);
        let (rates, shown) = if is_input { (&mut system.b, &mut system.d) } else { (&mut system.a, &mut system.c) };
        for ((_, slot), row) in states.iter().zip(rates) {
            row[place] = along.rates[*slot].slope[0];
        }
        for ((_, slope), row) in outputs(frame, &along, seeds).into_iter().zip(shown) {
            row[place] = slope;
        }
        for (of_actuator, number) in excess.iter_mut().zip(&along.excess) {
            of_actuator[usize::from(is_input)][place] = number.map_or(0.0, |number| number.slope[0]);
        }
    };
    for (place, (_, slot)) in states.iter().enumerate() {
        column(&[(Quantity::Slot(*slot), 1.0)], place, false, &mut system);
    }
    for (place, (input, quantity)) in inputs.iter().enumerate() {
        match (quantity, input) {
            (Some(quantity), _) => column(&[(*quantity, 1.0)], place, true, &mut system),
            (None, PlantInput::Force { mechanism, coordinate }) => {
                let here = frame.plant.places.mechanisms[*mechanism];
                let mut answer = vec![0.0; here.coordinates];
                answer[*coordinate] = 1.0;
                super::dense::solve(&frame.factored_mass_matrix(*mechanism), here.coordinates, &mut answer);
                for ((state, _), row) in states.iter().zip(&mut system.b) {
                    if let PlantState::Velocity { mechanism: its, coordinate } = state
                        && its == mechanism
                    {
                        row[place] = answer[*coordinate];
                    }
                }
            }
            (None, _) => {}
        }
    }
    // Without viscous friction both tensions give the length.
    for (i, mounted) in frame.plant.actuators.iter().enumerate() {
        if mounted.tendon.is_none() || super::tendon::is_damped(&mounted.actuator, &none.mode.actuators[i]) {
            continue;
        }
        let length = PlantState::Length { actuator: i };
        let Some(gone) = system.states.iter().position(|state| *state == length) else { continue };
        let of = |state: PlantState| states.iter().position(|(its, _)| *its == state);
        let own = of(length).map_or(1.0, |place| excess[i][0][place]);
        let now = system.states.clone();
        system = system.eliminate(
            gone,
            |n| of(now[n]).map_or(0.0, |place| -excess[i][0][place] / own),
            |k| -excess[i][1][k] / own,
        );
    }
    system
}

/// The pulsed valves on average, and how far that holds.
fn averages(plant: &Plant, frame: &Frame) -> Vec<ValveAverage> {
    let mut open = frame.clone();
    open.drives.iter_mut().for_each(|drive| *drive = Drive::Openings([1.0; 2]));
    let flows: Vec<f64> = open.evaluate(&[]).at.network.flows.iter().map(|flow| flow.value).collect();
    let now = frame.evaluate(&[]);
    let mut averages = Vec::new();
    for (valve, drive) in frame.drives.iter().enumerate() {
        let (Drive::Duty(duty), Actuation { solenoid, command }) = (drive, &plant.network.valves[valve]) else {
            continue;
        };
        let pulses = crate::valve::with_duty(command, *duty);
        let Some(intervals) = pulses.as_ref().and_then(|pulses| period(solenoid, pulses)) else { continue };
        let Command::Pwm { frequency, .. } = *command else { continue };
        let (mut ripple, mut margin) = (0.0_f64, f64::INFINITY);
        let paths = || {
            plant.network.branches.iter().enumerate().filter_map(move |(index, branch)| match branch.kind {
                BranchKind::Path { valve: its, port, .. } if its == valve => Some((index, branch, port)),
                _ => None,
            })
        };
        for (_, first, _) in paths() {
            let node = first.to;
            let into = |openings: [f64; 2]| -> f64 {
                paths()
                    .filter(|(_, it, _)| it.to == node)
                    .map(|(index, _, port)| flows[index] * openings[port as usize])
                    .sum()
            };
            let mean: f64 = intervals.iter().map(|part| part.share * into(part.openings)).sum();
            let (mut beside, mut least, mut greatest) = (0.0_f64, 0.0_f64, 0.0_f64);
            for part in &intervals {
                beside += (into(part.openings) - mean) * part.share / frequency;
                (least, greatest) = (least.min(beside), greatest.max(beside));
            }
            ripple = ripple.max((greatest - least) * per_mass(frame, node));
            let [here, beyond] = [node, first.from].map(|node| now.at.network.nodes[node].pressure.value);
            margin = margin.min((here - beyond).abs());
        }
        let shares = [0, 1].map(|port| intervals.iter().map(|part| part.share * part.openings[port]).sum());
        averages.push(ValveAverage {
            valve,
            frequency,
            duty: *duty,
            shares,
            duty_range: duty_range(solenoid, command).unwrap_or((0.0, 1.0)),
            pressure_ripple: ripple,
            pressure_margin: margin,
        });
    }
    averages
}

/// By how much the pressure of a node rises with the air that comes in, in Pa/kg, at a fixed length.
fn per_mass(frame: &Frame, node: usize) -> f64 {
    match &frame.plant.network.nodes[node].kind {
        NodeKind::Chamber { actuator } => {
            let Some(slot) = frame.feed(Fed::Actuator(*actuator)) else { return 0.0 };
            let along = frame.evaluate(&[(Quantity::Slot(slot), 1.0)]);
            let (unit, chamber) = (&along.at.units[*actuator], &along.at.chambers[*actuator]);
            let air = frame.plant.actuators[*actuator].actuator.air();
            let held = crate::air::Chamber { volume_rate: Scalar::constant(0.0), ..*chamber };
            air.pressure_rate_by(&held, &unit.flow, || unit.warmth).slope[0]
        }
        NodeKind::Hose(hose) => hose.stiffness().value,
        NodeKind::Reservoir(reservoir) => reservoir.pressure_rate(frame::Number::constant(1.0)).value,
        _ => 0.0,
    }
}
