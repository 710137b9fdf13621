//! A plant near an operating point: `dx/dt = A x + B u`, `y = C x + D u`, by exact derivatives.
//!
//! ```text
//! x = every state that is independent      u = commands, supply pressures, mass flows, forces      y = what is measured
//!
//! A = ∂f/∂x, B = ∂f/∂u of the rates f of the simulation        C = ∂g/∂x, D = ∂g/∂u of the outputs g
//!
//! pulsed valve     ṁ = s(d) ṁ(open)        s the actual duty cycle of each flow path: the mean flow over a period
//! spool            ẍ = ω² (u − x) − 2ζω ẋ,  ṁ = λ(x) ṁ(open);  at an edge dλ/dx is the mean of both sides
//! regulator        ṗ = (u − p)/τ
//! ```
//!
//! Flows add up, and each is proportional to its own opening, so the mean over several pulsed valves of any frequencies is
//! that of each valve over its own period. At an edge of a spool λ has a corner: a small signal `X sin ωt` about it meets
//! the describing function `(k₋ + k₊)/2` of the gains k on both sides ([`PlantLinearization::spool_gains`]).
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
//! without Coulomb friction: within ± ρ F_c at rest an actuator sticks and no linear model moves it
//! ([`PlantLinearization::coulomb_bounds`]); [`PlantLinearization::with_equivalent_damping`] puts in its place the viscous
//! damping with the same loss. Hysteresis is relaxed at the point. A compressor rests, and what it delivers on average is an
//! input; so is what keeps a leaking actuator or a bottle at the pressure that is given. A reservoir that an open path supplies
//! is where its flows balance. Delays are left out of the matrices: dead times, and those of lumped hoses
//! ([`PlantLinearization::delay`]).
//!
//! Source: differentiation of (12) to (21) of Colbrunn, Nelson & Quinn (2001) and of the components; averaging: Sanders &
//! Verhulst, Averaging Methods in Nonlinear Dynamical Systems (1985); edges: Gelb & Vander Velde, Multiple-Input Describing
//! Functions (1968), for a gain that changes at zero. Checked by `tests/plant_linear.rs`,
//! `tests/plant_linear_pulses.rs` and `tests/plant_linear_closed_forms.rs`.

mod air;
#[cfg(feature = "analysis")]
mod analysis;
mod average;
mod balance;
mod begin;
mod derivatives;
mod frame;
mod matrix;
mod signal;

pub use average::ValveAverage;
pub use signal::{PlantInput, PlantOutput, PlantState};

use super::start::PlantStart;
use super::{InitialAir, Mounted, Part, Plant};
use crate::error::Error;
use crate::limit;
use crate::linearize::StateSpace;
use crate::mechanism::Mechanism;
use crate::network::{Branch, BranchKind, NodeKind};
use crate::parameter;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::Scalar;
use alloc::borrow::Cow;
use alloc::vec::Vec;
use core::f64::consts::PI;
use derivatives::{derivatives, length_seed};
use frame::{Drive, Fed, Frame, Instant};

/// Parts of the way of an oscillation, an even number, over which dry friction that falls with velocity is averaged.
const PARTS: usize = 1000;

/// The linear model of a plant.
pub type PlantStateSpace = StateSpace<PlantState, PlantInput, PlantOutput>;

/// What determines the pressures at the operating point; the mechanisms come to balance at them.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantBalance {
    /// The gauge pressure of each actuator, with all valves held shut. Openings of flow paths are inputs. A flow path without a
    /// valve stays open: that of a two-way valve which is commanded to fill and has no path to the atmosphere.
    Shut(Vec<GaugePressure>),
    /// The commands: the duty of a PWM on average, the last position of a spool, the last set point of a regulator, the last
    /// request of a schedule. An actuator that nothing feeds keeps the pressure of the start.
    Driven,
    /// The gauge pressure of each actuator, with commands of the pulsed and proportional valves that hold them. A valve with
    /// seats whose command has no request, such as that of a controller, is held shut.
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
    /// Its states, as [`Plant::indices`] orders them.
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
/// or given, and the first guess for masses, chains and tendons. A pressure that is given at the end of a hose stays at its first
/// value, and is an input of the model as a supply is.
///
/// # Errors
/// As [`Plant::start`]; [`Error::Table`] unless there is one pressure or temperature for each actuator;
/// [`Error::OutOfRange`] or [`Error::Inconsistent`] for one that is not physical; [`Error::NoSolution`] when there is no
/// balance, when no command holds a pressure, or when the point lies on a corner of the model; [`Error::NotImplemented`] for a
/// given pressure in an actuator on a tendon without viscous friction.
pub fn linearize_plant(
    plant: &Plant,
    start: &PlantStart,
    balance: &PlantBalance,
    air: &PlantAir,
) -> Result<PlantLinearization, Error> {
    let follows_rate =
        |of: &Mounted| of.pressure.is_some() && of.tendon.is_some() && of.actuator.friction().viscous() == 0.0;
    if plant.actuators.iter().any(follows_rate) {
        return Err(Error::NotImplemented(&limit::PRESSURE_LINEAR));
    }
    let plant = plant.with_sources();
    let frame = begin::begin(&plant, start, balance, air)?;
    begin::check_corners(&frame)?;
    PlantLinearization::of(&plant, frame)
}

/// Pressure, and temperature in K, of the air of each actuator as it is at rest or flows through on average, with the mechanisms
/// kept where they start: neither depends on where that is.
///
/// # Errors
/// As [`linearize_plant`], but for the request for mechanisms in balance.
pub(in crate::plant) fn steady_air(
    plant: &Plant,
    start: &PlantStart,
    balance: &PlantBalance,
    air: &PlantAir,
) -> Result<Vec<(AbsolutePressure, f64)>, Error> {
    let plant = &*plant.with_sources();
    let begin::Filled { frame, heats, .. } = begin::fill(plant, start, balance, air)?;
    let of = |i: usize| {
        let of_actuator = plant.actuators[i].actuator.air();
        (AbsolutePressure(frame.state[plant.places.actuators[i].pressure]), heats[i] / of_actuator.gas_constant())
    };
    Ok((0..plant.actuators.len()).map(of).collect())
}

impl Plant {
    /// The plant with sources at the nodes whose pressures are given over time, each at its pressure at t = 0.
    fn with_sources(&self) -> Cow<'_, Self> {
        if self.network.series.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut network = self.network.clone();
        for node in &mut network.nodes {
            if let NodeKind::Given { series, .. } = node.kind {
                node.gauge = self.network.series[series].gauge_at(0.0);
                node.kind = NodeKind::Source;
            }
        }
        network.series.clear();
        Cow::Owned(Self::assemble(self.actuators.clone(), network, self.mechanisms.clone()))
    }
}

impl PlantLinearization {
    fn of(plant: &Plant, frame: Frame) -> Result<Self, Error> {
        let system = derivatives(&frame);
        let point = point_of(plant, &frame, &system);
        let averages = average::averages(plant, &frame);
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
                        per_length /= along.at.units[i].length.slope[0];
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

    /// By how much the pressure of what a spool opens into rises in Pa/s for each stroke of the spool from its position: for a
    /// small motion towards the exhaust and for one towards the supply. Where they differ the spool is at an edge, and the model
    /// has their mean. `None` for a valve that is no spool.
    pub fn spool_gains(&self, valve: usize) -> Option<[f64; 2]> {
        let (_, slot) = self.frame.spools.iter().find(|(its, _)| *its == valve)?;
        let Plant { network, places, .. } = &self.frame.plant;
        let opens =
            |kind: &BranchKind<frame::Number>| matches!(kind, BranchKind::Path { valve: its, .. } if *its == valve);
        let into = network.branches.iter().find(|branch| opens(&branch.kind))?.to;
        let row = match network.nodes[into].kind {
            NodeKind::Chamber { actuator } => places.actuators[actuator].pressure,
            _ => places.nodes[into]?,
        };
        let gain = |side: f64| {
            let beside = Frame { side, ..self.frame.clone() };
            beside.evaluate(&[(frame::Quantity::Slot(*slot), 1.0)]).rates[row].slope[0]
        };
        Some([-1.0, 1.0].map(gain))
    }

    /// Whether a spool rests in its dead zone, where both of its flow paths are shut and small motions open neither.
    pub fn is_in_dead_zone(&self, valve: usize) -> bool {
        let Some(spool) = self.point.plant.network.valves[valve].solenoid.spool() else { return false };
        let Some((_, slot)) = self.frame.spools.iter().find(|(its, _)| *its == valve) else { return false };
        let at = self.frame.state[*slot];
        [-frame::EDGE, frame::EDGE].iter().all(|by| spool.openings(at + by) == [0.0; 2])
    }

    /// By how much later in s than an input its effect begins: the dead time of a valve, and the delay of a lumped hose behind it
    /// or behind a pressure that is given over time. The matrices leave it out: it lowers the phase of a response by ω times it.
    pub fn delay(&self, input: &PlantInput) -> f64 {
        let network = &self.point.plant.network;
        match *input {
            PlantInput::Duty { valve } | PlantInput::SetPoint { valve } | PlantInput::SpoolCommand { valve } => {
                network.valves[valve].solenoid.latency()
            }
            // An opening is that of the flow path itself: no dead time lies before it.
            PlantInput::Opening { valve, .. } => network.valves[valve].solenoid.transport(),
            PlantInput::SupplyPressure { node } => {
                let delay = |branch: &Branch| match &branch.kind {
                    BranchKind::Loss(hose) if branch.from == node => hose.transport_delay(),
                    _ => 0.0,
                };
                network.branches.iter().map(delay).fold(0.0, f64::max)
            }
            _ => 0.0,
        }
    }

    /// By how much less and by how much more tension than that of the balance, in N, the dry friction of an actuator holds at rest,
    /// (P.2): `ρ F_c` with Stribeck's ratio ρ both ways, but no tension below zero, and none where the braid is slack. Within
    /// them it sticks.
    pub fn coulomb_bounds(&self, actuator: usize) -> [f64; 2] {
        let Some((force, kinetic)) = self.pull(actuator) else { return [0.0; 2] };
        let bound = self.point.plant.actuators[actuator].actuator.friction().coulomb().holding(kinetic);
        [bound.min(force.max(0.0)), (bound + force.min(0.0)).max(0.0)]
    }

    /// The force in N of an actuator at the point, below zero where it would push, and its dry friction `F_c` in N in motion fast
    /// enough; none where the braid is slack.
    fn pull(&self, actuator: usize) -> Option<(f64, f64)> {
        let PlantPoint { plant, state, lengths, .. } = &self.point;
        let (its, length) = (&plant.actuators[actuator].actuator, lengths[actuator]);
        let pressure = state[plant.places.actuators[actuator].pressure];
        let force = its.static_force(length, pressure) + its.limits().force(length, 0.0);
        (!its.limits().is_slack(length)).then(|| (force, its.coulomb_bound(length, pressure)))
    }

    /// The viscous damping in N·s/m that takes as much energy from an actuator's oscillation of `amplitude` (m) at
    /// `angular_frequency` (rad/s), both above zero, as its Coulomb friction: `c_eq = 4 F̄/(π ω X)`, with the mean F̄ over the way
    /// of a cycle of `F_c s(v)`, or of half of what the tensions of both ways differ by where one of them is zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn equivalent_damping(&self, actuator: usize, amplitude: f64, angular_frequency: f64) -> Result<f64, Error> {
        let amplitude = crate::linearize::AMPLITUDE.check(amplitude)?;
        let frequency = crate::linearize::ANGULAR_FREQUENCY.check(angular_frequency)?;
        let coulomb = self.point.plant.actuators[actuator].actuator.friction().coulomb();
        let Some((force, kinetic)) = self.pull(actuator) else { return Ok(0.0) };
        // Half of what the tensions of both ways differ by.
        let loss = |friction: f64| if friction <= force { friction } else { 0.5 * (force + friction).max(0.0) };
        // At 1 − w² of the amplitude the velocity is ω X w √(2 − w²), and the way goes with 2 w dw: smooth at both ends.
        let more = |w: f64| {
            let velocity = amplitude * frequency * w * Scalar::sqrt(2.0 - w * w);
            2.0 * w * (loss(coulomb.sliding(1.0, velocity, kinetic)) - loss(kinetic))
        };
        // Simpson's rule; at w = 0 there is nothing to add.
        let part = |n: usize| if n.is_multiple_of(2) { 2.0 } else { 4.0 } * more(n as f64 / PARTS as f64);
        let sum: f64 = (1..PARTS).map(part).sum::<f64>() + more(1.0);
        let mean = loss(kinetic) + sum / (3.0 * PARTS as f64);
        Ok(4.0 * mean / (PI * frequency * amplitude))
    }

    /// The model with Coulomb friction replaced by the viscous damping of equal loss, for an oscillation of each actuator by its
    /// amplitude (m) and angular frequency (rad/s), all above zero. `None` leaves the Coulomb friction of an actuator out.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Table`] unless there is one entry for each actuator.
    pub fn with_equivalent_damping(&self, oscillations: &[Option<(f64, f64)>]) -> Result<Self, Error> {
        if oscillations.len() != self.point.lengths.len() {
            return Err(Error::Table {
                name: crate::linearize::AMPLITUDE.key,
                problem: "there is not one entry for each actuator",
                entry: oscillations.len().min(self.point.lengths.len()) + 1,
                remedy: "give as many entries as there are actuators",
            });
        }
        let damping = |(i, of): (usize, &Option<(f64, f64)>)| match *of {
            Some((amplitude, angular_frequency)) => self.equivalent_damping(i, amplitude, angular_frequency),
            None => Ok(0.0),
        };
        let dampings: Vec<f64> = oscillations.iter().enumerate().map(damping).collect::<Result<_, _>>()?;
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

    /// The start of a run from the point. Air in hoses starts at rest, at the pressure of their actuators, and reservoirs start
    /// at the pressures that the plant states.
    pub fn start(&self) -> PlantStart {
        let mechanisms = self.plant.places.mechanisms.iter();
        let slice = |from: usize, count: usize| self.state[from..from + count].to_vec();
        let air = |i: usize| InitialAir { gauge_pressure: self.gauge_pressure(i), temperature: self.temperature(i) };
        PlantStart {
            positions: mechanisms.clone().map(|here| slice(here.first, here.coordinates)).collect(),
            rates: mechanisms.map(|here| slice(here.rate(0), here.coordinates)).collect(),
            air: (0..self.lengths.len()).map(air).collect(),
            lengths: self.plant.places.actuators.iter().map(|here| here.length.map(|slot| self.state[slot])).collect(),
            friction: Vec::new(),
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
