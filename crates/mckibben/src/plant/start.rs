//! The start of a plant: its states and its first mode.

use super::evaluation::{Evaluation, System};
use super::friction_start::{InitialFriction, force_at_start};
use super::mode::PlantMode;
use super::{Mounted, Plant};
use crate::actuator::Actuator;
use crate::error::{Error, Requirement};
use crate::force::Statics;
use crate::friction::Memory;
use crate::instantiate::Instantiate;
use crate::mechanism::{Contact, Mechanism};
use crate::network::NodeKind;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Real, Scalar};
use crate::simulation::LengthRegime;
use crate::valve::below_vacuum;
use alloc::vec;
use alloc::vec::Vec;

/// Part of its shortest length by which an actuator may miss it and be on it.
const ON_THE_STOP: f64 = 1e-14;

/// The air of an actuator at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialAir<S = f64> {
    /// Gauge pressure.
    pub gauge_pressure: GaugePressure<S>,
    /// Temperature in K, which fixes the mass of air.
    pub temperature: S,
}

/// The start of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantStart<S = f64> {
    /// Coordinates of each mechanism, in m or rad.
    pub positions: Vec<Vec<S>>,
    /// Their rates.
    pub rates: Vec<Vec<S>>,
    /// The air of each actuator.
    pub air: Vec<InitialAir<S>>,
    /// Lengths in m of actuators on a tendon; where there is none, that at which tendon and actuator balance.
    pub lengths: Vec<Option<S>>,
    /// The friction of each actuator; all relaxed where there is no entry.
    pub friction: Vec<InitialFriction<S>>,
}

impl<S> Default for PlantStart<S> {
    /// The start of a plant without parts; what a start says of each part is added.
    fn default() -> Self {
        Self { positions: Vec::new(), rates: Vec::new(), air: Vec::new(), lengths: Vec::new(), friction: Vec::new() }
    }
}

/// A number of a start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum StartNumber {
    /// A coordinate of a mechanism, by their indices.
    Position(usize, usize),
    /// The rate of a coordinate of a mechanism, by their indices.
    Rate(usize, usize),
    /// The gauge pressure of an actuator.
    GaugePressure(usize),
    /// The temperature of an actuator's air.
    Temperature(usize),
    /// The length of an actuator on a tendon.
    Length(usize),
    /// The force that the hysteresis of an actuator holds.
    Friction(usize),
}

impl<S: Scalar> PlantStart<S> {
    /// The start over another scalar; `function` gets each number with what it is.
    pub fn map<T: Scalar>(&self, mut function: impl FnMut(StartNumber, S) -> T) -> PlantStart<T> {
        let mut each = |numbers: &[Vec<S>], of: fn(usize, usize) -> StartNumber| -> Vec<Vec<T>> {
            let coordinates = numbers.iter().enumerate();
            coordinates
                .map(|(m, its)| its.iter().enumerate().map(|(k, it)| function(of(m, k), *it)).collect())
                .collect()
        };
        let (positions, rates) = (each(&self.positions, StartNumber::Position), each(&self.rates, StartNumber::Rate));
        let air = self.air.iter().enumerate().map(|(i, InitialAir { gauge_pressure, temperature })| InitialAir {
            gauge_pressure: GaugePressure(function(StartNumber::GaugePressure(i), gauge_pressure.0)),
            temperature: function(StartNumber::Temperature(i), *temperature),
        });
        let air = air.collect();
        let lengths = self.lengths.iter().enumerate();
        let lengths =
            lengths.map(|(i, length)| length.map(|length| function(StartNumber::Length(i), length))).collect();
        let friction = self.friction.iter().enumerate().map(|(i, friction)| match *friction {
            InitialFriction::Relaxed => InitialFriction::Relaxed,
            InitialFriction::Loading => InitialFriction::Loading,
            InitialFriction::Unloading => InitialFriction::Unloading,
            InitialFriction::Held(force) => InitialFriction::Held(function(StartNumber::Friction(i), force)),
        });
        let friction = friction.collect();
        PlantStart { positions, rates, air, lengths, friction }
    }
}

impl<R: Instantiate> Plant<R> {
    /// The states at t = 0. Air in hoses starts at the pressure of the chamber that they lead to, bristles as the friction of
    /// the start says, viscoelastic branches with their initial stretch.
    ///
    /// # Errors
    /// [`Error::Table`] unless there are as many coordinates, rates and airs as the plant has; [`Error::OutOfRange`] for a
    /// pressure or temperature that is not physical; [`Error::Misuse`] for a start of friction that remembers nothing;
    /// [`Error::Inconsistent`] for a force that friction cannot hold, and for a length that an actuator cannot have.
    pub fn start(&self, start: &PlantStart<R>) -> Result<Vec<R>, Error> {
        R::start_plant(self, start)
    }

    /// The states of a start at a time in s, and what hysteresis remembers then: motions and pressures that are given over time are
    /// where they are at that time.
    #[allow(clippy::type_complexity)]
    pub(crate) fn start_with_memories(
        &self,
        start: &PlantStart<R>,
        time: R,
    ) -> Result<(Vec<R>, Vec<Option<Memory<R>>>), Error> {
        let fault = |name, entry: usize| {
            Err(Error::Table {
                name,
                problem: "there is not one entry for each part of the plant",
                entry: entry + 1,
                remedy: "give as many entries as there are parts",
            })
        };
        if start.positions.len() != self.mechanisms.len() || start.rates.len() != self.mechanisms.len() {
            return fault("initial.positions", start.positions.len().min(start.rates.len()));
        }
        if start.air.len() != self.actuators.len() || start.lengths.len() != self.actuators.len() {
            return fault("initial.gauge_pressure", start.air.len().min(start.lengths.len()));
        }
        let mut state = vec![R::zero(); self.places.states];
        let mut lengths = Vec::with_capacity(self.actuators.len());
        for (m, here) in self.places.mechanisms.iter().enumerate() {
            if start.positions[m].len() != here.coordinates || start.rates[m].len() != here.coordinates {
                return fault("initial.positions", m);
            }
            for k in 0..here.coordinates {
                state[here.position(k)] = start.positions[m][k];
                state[here.rate(k)] = start.rates[m][k];
            }
            if let Mechanism::Prescribed(motion) = &self.mechanisms[m] {
                let [length, velocity, _] = motion.at(time, motion.passed(time));
                (state[here.position(0)], state[here.rate(0)]) = (length, velocity);
            }
        }
        for (i, Mounted { actuator, mechanism, coupling, tendon, pressure }) in self.actuators.iter().enumerate() {
            let InitialAir { gauge_pressure, temperature } = start.air[i];
            let air = actuator.air();
            parameter::INITIAL_GAUGE_PRESSURE.check(gauge_pressure.0.value())?;
            parameter::INITIAL_TEMPERATURE.check(temperature.value())?;
            let gauge = match pressure {
                Some(given) => GaugePressure(given.gauge_at(time)),
                None => gauge_pressure,
            };
            let absolute = gauge.absolute(air.atmosphere());
            if absolute.0.le(R::zero()) {
                let gauge = GaugePressure(gauge.0.value());
                return Err(below_vacuum(&parameter::INITIAL_GAUGE_PRESSURE, gauge, air));
            }
            let here = self.places.mechanisms[*mechanism];
            let (position, _) = here.of(&state);
            let chain = match &self.mechanisms[*mechanism] {
                Mechanism::Chain(chain) => Some(chain),
                _ => None,
            };
            let mut gradient = vec![R::zero(); here.coordinates];
            let distance = coupling.distance_at(chain, position, &mut gradient);
            let length = match (tendon, start.lengths[i]) {
                (Some(_), Some(length)) => length,
                (Some(tendon), None) => {
                    let initial = start.friction.get(i).copied().unwrap_or_default();
                    let friction = |length| force_at_start(actuator, initial, length, absolute.0);
                    tendon.balance_with(actuator, distance, absolute.0, &friction)
                }
                (None, _) => distance,
            };
            check_length(actuator, length, tendon.is_some())?;
            lengths.push(length);
            let own = self.places.actuators[i];
            state[own.pressure] = absolute.0;
            state[own.pressure + 1] = air.mass(absolute, actuator.volume(length), temperature);
            if let Some(place) = own.length {
                state[place] = length;
            }
        }
        for (index, node) in self.network.nodes.iter().enumerate() {
            let Some(place) = self.places.nodes[index] else { continue };
            state[place] = match &node.kind {
                NodeKind::Reservoir(reservoir) => reservoir.start().0,
                NodeKind::Outlet { set, inlet, .. } => {
                    let set = self.network.absolute(*set);
                    match inlet.and_then(|inlet| self.places.nodes[inlet]) {
                        Some(inlet) => set.smaller(state[inlet]),
                        None => set,
                    }
                }
                NodeKind::Port { feed, .. } => {
                    let own = self.chamber_behind(index).map(|i| state[self.places.actuators[i].pressure]);
                    let own = own.unwrap_or(self.network.atmosphere);
                    own.larger(self.network.atmosphere).smaller(self.network.absolute(*feed))
                }
                NodeKind::Given { series, late } => {
                    self.network.absolute(self.network.series[*series].gauge_at(time - *late))
                }
                NodeKind::Hose(_) => match self.chamber_behind(index) {
                    Some(i) => state[self.places.actuators[i].pressure],
                    None => self.network.absolute(node.gauge),
                },
                NodeKind::Atmosphere | NodeKind::Source | NodeKind::Chamber { .. } => self.network.absolute(node.gauge),
            };
        }
        let memories = self.start_memories(start, &state, &lengths)?;
        for (own, memory) in self.places.actuators.iter().zip(&memories) {
            if let (Some(place), Some(memory)) = (own.bristles, memory) {
                state[place] = memory.elements[0];
            }
        }
        self.relax_branches(lengths.iter().copied(), &mut state);
        self.stretch_branches(&mut state);
        Ok((state, memories))
    }

    /// The actuator whose chamber branches lead to from a node, without a reservoir between.
    pub fn chamber_behind(&self, mut node: usize) -> Option<usize> {
        for _ in 0..=self.network.branches.len() {
            match self.network.nodes[node].kind {
                NodeKind::Chamber { actuator } => return Some(actuator),
                NodeKind::Reservoir(_) => return None,
                _ => {}
            }
            node = self.network.branches.iter().find(|branch| branch.from == node)?.to;
        }
        None
    }
}

/// That an actuator can have a length in m; one on a tendon is never shorter than its shortest.
fn check_length<R: Real>(actuator: &Actuator<R>, length: R, on_tendon: bool) -> Result<(), Error> {
    let law = &actuator.law().law;
    let (shortest, end) = (actuator.limits().min_length().value(), law.end_length().value());
    let value = length.value();
    let wrong = |relation, other, bound| {
        Err(Error::Inconsistent {
            parameter: &parameter::INITIAL_LENGTH,
            value,
            requirement: Requirement { relation, other, value: bound, unit: "m" },
            remedy: "start the mechanism where its actuators are between their shortest and their end length",
        })
    };
    if value.is_nan() || value >= end {
        return wrong("must be less than", law.end_name(), end);
    }
    if on_tendon && value < shortest * (1.0 - ON_THE_STOP) {
        return wrong("on a tendon must be at least", parameter::MIN_LENGTH.key, shortest);
    }
    Ok(())
}

impl<R: Real> System<R> {
    /// The mode at a time in s in a state, which may be set on a border that it lies on; valves and drivers go on as in a former
    /// mode if there is one. Hysteresis without a memory is relaxed.
    pub(crate) fn begin(
        &self,
        (time, former): (R, Option<&PlantMode<R>>),
        state: &mut [R],
        memories: &[Option<Memory<R>>],
        at: &mut Evaluation<R>,
    ) -> PlantMode<R> {
        let plant = &*self.plant;
        let mut mode = self.first_mode(state);
        if let Some(former) = former {
            mode.network.valves.clone_from(&former.network.valves);
            mode.drivers.clone_from(&former.drivers);
        }
        for (i, mounted) in plant.actuators.iter().enumerate() {
            if let Some(given) = &mounted.pressure {
                mode.actuators[i].rows_passed = given.passed(time);
            }
        }
        for node in 0..plant.network.nodes.len() {
            while plant.network.pass_row(node, time, &mut mode.network) {}
        }
        for (m, mechanism) in plant.mechanisms.iter().enumerate() {
            if let Mechanism::Prescribed(motion) = mechanism {
                mode.mechanisms[m].corners_passed = motion.passed(time);
            }
        }
        self.enter_distances(time, state, &mode, at);
        for i in 0..plant.actuators.len() {
            let (member, here) = (&self.wires[i].member, &plant.places.actuators[i]);
            let length = at.units[i].length;
            let [pressure, mass] = [state[here.pressure], state[here.pressure + 1]];
            let its = &mut mode.actuators[i];
            its.mode.force_piece = member.force_piece(length, pressure);
            its.isothermal = member.isothermal_content(length, [pressure, mass]);
            its.trace = match memories.get(i).copied().flatten() {
                Some(memory) => member.trace_from(memory),
                None => member.trace(member.actuator.limits().actuator_length(length)),
            };
        }
        let network = &plant.network;
        self.piping.enter_pressures(state, &mut at.network);
        let pressures: Vec<R> = at.network.nodes.iter().map(|node| node.pressure).collect();
        network.enter(&pressures, &mut mode.network);
        for (node, place) in plant.places.nodes.iter().enumerate() {
            if let Some(place) = place {
                network.pass_set_points(node, time, state[*place], &mut mode.network);
            }
        }
        for m in 0..plant.mechanisms.len() {
            self.enter_contacts(m, state, &mut mode);
            self.enter_length_regimes(m, time, state, &mut mode, at);
        }
        self.enter_poppets(time, state, &mut mode, at);
        for i in 0..plant.actuators.len() {
            if plant.actuators[i].tendon.is_some() {
                self.begin_end(i, time, state, &mut mode, at);
            }
        }
        for m in 0..plant.mechanisms.len() {
            self.settle(m, time, state, &mut mode, at);
        }
        self.follow_all(time, state, &mut mode, at, None);
        self.settle_ends(time, state, &mut mode, at);
        mode
    }

    /// The contacts of a mechanism in a state.
    pub(crate) fn enter_contacts(&self, m: usize, state: &[R], mode: &mut PlantMode<R>) {
        let Mechanism::Chain(chain) = &self.plant.mechanisms[m] else { return };
        let (angle, rate) = self.plant.places.mechanisms[m].of(state);
        let its = &mut mode.mechanisms[m];
        let contact = |beyond: f64, outwards: f64, press: f64| {
            if beyond > 0.0 || (beyond == 0.0 && outwards > 0.0) {
                if press >= 0.0 { Contact::Pressed } else { Contact::Rebound }
            } else {
                Contact::None
            }
        };
        for (k, joint) in chain.joints().iter().enumerate() {
            for end in 0..2 {
                if joint.stops.ends[end].is_some() {
                    let outwards = if end == 0 { -rate[k].value() } else { rate[k].value() };
                    let press = chain.stop_torque(k, end, angle[k], rate[k]).value();
                    its.stops[k][end] = contact(chain.beyond_stop(k, end, angle[k]).value(), outwards, press);
                }
            }
        }
        if let Some((depth, [_, up])) = chain.foot(angle, rate) {
            its.foot = contact(depth.value(), -up.value(), chain.foot_press(angle, rate).value());
        }
    }

    /// The length regimes of a mechanism's actuators in a state that may lie on a limit: then the velocity, or at rest the balance,
    /// decides.
    pub(crate) fn enter_length_regimes(
        &self,
        m: usize,
        time: R,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) {
        self.enter_distances(time, state, mode, at);
        let pushed = match &self.plant.mechanisms[m] {
            Mechanism::Mass(mass) => mass.pull().value() < 0.0,
            _ => false,
        };
        for &i in &self.plant.places.members[m] {
            if self.plant.places.actuators[i].length.is_some() {
                continue;
            }
            let (member, unit) = (&self.wires[i].member, &at.units[i]);
            let limits = member.actuator.limits();
            let above = [limits.min_length(), limits.max_length()].map(|limit| unit.distance.value() - limit.value());
            // On its shortest length, up to rounding, it is on the stop.
            let on_stop = above[0].abs() <= ON_THE_STOP * limits.min_length().value();
            let above = if on_stop { [0.0, above[1]] } else { above };
            let its = &mut mode.actuators[i];
            its.mode.length_regime = member.length_regime_at([unit.distance, unit.rate], above, pushed);
            its.on_stop = on_stop && its.mode.length_regime == LengthRegime::Free && unit.rate.value() == 0.0;
        }
    }
}
