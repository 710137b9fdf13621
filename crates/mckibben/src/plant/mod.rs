//! The plant: actuators, their air network, the mechanism that they move, and what drives the valves.
//!
//! ```text
//! Plant = actuators + air network + mechanisms + commands
//! ```
//!
//! | part | states |
//! |---|---|
//! | mechanism | coordinates `q` and their rates `q̇` |
//! | actuator | absolute pressure P (19) and mass m of its air; the length L on an elastic tendon; bristles of LuGre's law; relaxed lengths of viscoelastic branches |
//! | network | pressures of hoses, reservoirs, outlets and ports; flows in distributed hoses |
//!
//! States lie in one slice, in the order of this table; [`Plant::indices`] says where each is. Parameters are values, states
//! belong to the caller, and the discrete state is a [`PlantMode`].
//!
//! The smallest plant is the paper's: one actuator at a constant supply with a hanging mass (15)(19)(21).

mod acceleration;
mod bookkeeping;
mod crossing;
pub(crate) mod dense;
mod distances;
mod ends;
mod equipment;
pub(crate) mod evaluation;
mod exergy;
mod feed;
pub(crate) mod formulas;
mod friction_start;
pub(crate) mod guard;
mod held_motion;
mod holding;
mod hybrid;
mod joint;
mod ledger;
mod linear;
mod measure;
mod mode;
mod named;
#[cfg(feature = "analysis")]
mod orbit;
mod progress;
mod rig;
mod run;
mod sample;
mod saved;
mod scale;
mod shares;
pub(crate) mod sliding;
mod start;
pub(crate) mod steps;
mod stream;
pub(crate) mod tendon;
mod trajectory;
mod view;
mod viscoelastic;
pub(crate) mod wire;

pub use crossing::{Part, PlantEventKind};
pub use equipment::{Drawn, SupplyNodes};
pub use feed::Feed;
pub use friction_start::{INITIAL_FRICTION_FORCE, InitialFriction};
pub use guard::{ContactEvent, PlantGuard};
pub(crate) use joint::linear as joint_linear;
pub use joint::{
    JointConsumer, JointEvent, JointEventKind, JointMode, JointPlant, JointRunEnd, JointStep, JointTrajectory, Turning,
};
pub use ledger::{
    ActuatorLedger, Balance, BranchLedger, Carried, LedgerTotal, MechanismLedger, NodeLedger, PlantLedger,
};
pub use linear::{
    PlantAir, PlantBalance, PlantInput, PlantLinearization, PlantOutput, PlantPoint, PlantState, PlantStateSpace,
    ValveAverage, linearize_plant,
};
pub use mode::{ActuatorMode, MechanismMode, PlantMode};
#[cfg(feature = "analysis")]
pub use orbit::Orbit;
pub use rig::{
    RigConsumer, RigEvent, RigPlant, RigReader, RigRunEnd, RigStep, RigTrajectory, simulate, simulate_in_segments,
};
pub(crate) use rig::{linear as rig_linear, point as rig_point};
pub use run::{PlantRun, PlantSnapshot};
pub use sample::{ActuatorSample, BranchSample, MechanismSample, NodeSample, PlantReader, PlantSample, ValveSample};
pub use start::{InitialAir, PlantStart, StartNumber};
pub use steps::{
    EventUpdate, PILOT, PlantExchange, PlantReference, PlantRow, PlantSampler, PlantStepError, PlantSteps, SHORTEST,
    TimeStepping, plant_step_for_accuracy,
};
pub use stream::{PlantConsumer, PlantLedgerKeeper, PlantStep};
pub use trajectory::{PlantEvent, PlantTrajectory, STEPS_WATCHED, simulate_plant};
pub use view::{PlantView, ViewReader, ViewRunEnd, ViewStep, ViewTrajectory, record_view, stream_view};

use crate::actuator::Actuator;
use crate::air::Process;
use crate::convert::{Convert, ConvertEachOf};
use crate::error::Error;
use crate::friction::Viscoelastic;
use crate::load::SeriesTendon;
use crate::mechanism::{Coupling, Mechanism};
use crate::network::{BranchKind, Network, NodeKind};
use crate::parameter::Parameter;
use crate::scalar::{Real, Scalar};
use crate::simulation::PressureSeries;
use crate::valve::Command;
use alloc::vec::Vec;

/// An actuator and where it is mounted.
#[derive(Clone, Debug, PartialEq)]
pub struct Mounted<S = f64> {
    /// The actuator. Its valve is a part of the network.
    pub actuator: Actuator<S>,
    /// The mechanism that it pulls on.
    pub mechanism: usize,
    /// How it spans that mechanism.
    pub coupling: Coupling<S>,
    /// An elastic tendon in series.
    pub tendon: Option<SeriesTendon<S>>,
    /// Its pressure over time, where that is given in place of its air.
    pub pressure: Option<PressureSeries<S>>,
}

/// Actuators, air network, mechanisms and commands as one system.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant<S = f64> {
    actuators: Vec<Mounted<S>>,
    network: Network<S>,
    mechanisms: Vec<Mechanism<S>>,
    places: StateIndices,
}

/// Where the states of a mechanism lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MechanismIndices {
    /// The first coordinate; the first rate lies `coordinates` behind it.
    pub first: usize,
    /// How many coordinates there are.
    pub coordinates: usize,
    /// Its first acceleration among those of all mechanisms.
    pub(crate) acceleration: usize,
}

impl MechanismIndices {
    /// The place of a coordinate.
    #[inline(always)]
    pub fn position(&self, coordinate: usize) -> usize {
        self.first + coordinate
    }

    /// The place of its rate.
    #[inline(always)]
    pub fn rate(&self, coordinate: usize) -> usize {
        self.first + self.coordinates + coordinate
    }

    /// The places of its accelerations, and of all else that each coordinate has one of.
    #[inline(always)]
    pub(crate) fn accelerations(&self) -> core::ops::Range<usize> {
        self.acceleration..self.acceleration + self.coordinates
    }

    /// Coordinates and rates.
    #[doc(hidden)]
    #[inline(always)]
    pub fn of<'s, T>(&self, state: &'s [T]) -> (&'s [T], &'s [T]) {
        state[self.first..self.first + 2 * self.coordinates].split_at(self.coordinates)
    }
}

/// Where the states of an actuator lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActuatorIndices {
    /// Absolute pressure; the mass of the air is behind it.
    pub pressure: usize,
    /// The actuator's length, where a tendon makes it a state.
    pub length: Option<usize>,
    /// The deflection of bristles.
    pub bristles: Option<usize>,
    /// The relaxed lengths of viscoelastic branches: the first, and how many.
    pub(crate) branches: [usize; 2],
    /// Its entries in the gradients of all actuators.
    pub(crate) gradient: usize,
    /// Its entries in the pieces of all moment arms.
    pub(crate) arms: usize,
}

impl ActuatorIndices {
    /// The place of the mass of its air.
    #[inline(always)]
    pub fn mass(&self) -> usize {
        self.pressure + 1
    }

    /// The places of the relaxed lengths of its viscoelastic branches.
    #[inline(always)]
    pub fn branches(&self) -> core::ops::Range<usize> {
        let [first, count] = self.branches;
        first..first + count
    }
}

/// Where each state lies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StateIndices {
    /// Of each mechanism.
    pub mechanisms: Vec<MechanismIndices>,
    /// Of each actuator.
    pub actuators: Vec<ActuatorIndices>,
    /// The pressure of each node of the network, where it is a state that no actuator has.
    pub nodes: Vec<Option<usize>>,
    /// The flow of each branch, where it is a state.
    pub branches: Vec<Option<usize>>,
    /// The nodes and branches that have a state, each with its place.
    pub(crate) state_nodes: Vec<[usize; 2]>,
    pub(crate) state_branches: Vec<[usize; 2]>,
    /// The actuators of each mechanism.
    pub members: Vec<Vec<usize>>,
    /// Whether the air of each actuator keeps an energy balance.
    pub(crate) keeps_heat: Vec<bool>,
    /// The node of the network that is each actuator's chamber.
    pub(crate) chambers: Vec<Option<usize>>,
    /// How many states there are.
    pub states: usize,
    pub(crate) gradients: usize,
    pub(crate) arms: usize,
}

impl StateIndices {
    /// The states that runs are compared by: of mechanisms, actuators and nodes.
    pub(crate) fn compared(&self) -> impl Iterator<Item = usize> + '_ {
        let of_mechanisms = self.mechanisms.iter().flat_map(|here| here.first..here.first + 2 * here.coordinates);
        let of_actuators =
            self.actuators.iter().flat_map(|here| [here.pressure, here.mass()].into_iter().chain(here.length));
        of_mechanisms.chain(of_actuators).chain(self.nodes.iter().flatten().copied())
    }
}

impl Plant {
    /// A plant of actuators on mechanisms, fed by a network.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a reference to a part that is not there, an actuator with its own valve, a given
    /// pressure in an actuator that the network feeds, or a command that its valve cannot follow.
    pub fn new(actuators: Vec<Mounted>, network: Network, mechanisms: Vec<Mechanism>) -> Result<Self, Error> {
        let wrong = |what, remedy| Err(Error::Misuse { what, remedy });
        for (index, mounted) in actuators.iter().enumerate() {
            let Some(mechanism) = mechanisms.get(mounted.mechanism) else {
                return wrong("an actuator pulls on a mechanism that is not there", "name one of the mechanisms");
            };
            if let (Coupling::Direct { .. }, Mechanism::Chain(_)) = (&mounted.coupling, mechanism) {
                return wrong(
                    "an actuator's distance is directly a coordinate, but the coordinates of a chain are angles",
                    "couple it by moment arms or points: an arm gives the metres for each radian",
                );
            }
            let spans = match &mounted.coupling {
                Coupling::Direct { coordinate } => *coordinate < mechanism.coordinates(),
                Coupling::Arms { arms, .. } => {
                    matches!(mechanism, Mechanism::Chain(_))
                        && arms.iter().all(|arm| arm.joint < mechanism.coordinates())
                }
                Coupling::Points(ends) => {
                    let there = |segment: Option<usize>| segment.is_none_or(|it| it < mechanism.coordinates());
                    matches!(mechanism, Mechanism::Chain(_)) && ends.iter().all(|end| there(end.segment))
                }
            };
            if !spans {
                return wrong(
                    "an actuator spans joints that its mechanism does not have",
                    "name joints of the mechanism",
                );
            }
            if mounted.actuator.valve().is_some() {
                return wrong(
                    "the valve of an actuator in a plant is a part of the network",
                    "add its flow paths to the network, or make the plant by `Plant::of_rig`",
                );
            }
            let is_fed =
                |node: usize| matches!(network.nodes[node].kind, NodeKind::Chamber { actuator } if actuator == index);
            let fed = network.branches.iter().any(|branch| is_fed(branch.from) || is_fed(branch.to));
            if mounted.pressure.is_some() && fed {
                return wrong(
                    "the pressure in an actuator is given over time, and a valve or a leak would change it too",
                    "leave out [valve], [hose] and actuator.leakage, or leave out [pressure]",
                );
            }
        }
        if actuators.is_empty() && !network.branches.is_empty() {
            return wrong(
                "air flows in a plant without an actuator, and no part says which gas it is",
                "add an actuator",
            );
        }
        sliding::check_facets(&actuators, &mechanisms)?;
        network.valves.iter().try_for_each(|valve| valve.solenoid.check(&valve.command))?;
        Ok(Self::assemble(actuators, network, mechanisms))
    }
}

impl<S: Scalar> Plant<S> {
    /// A plant of parts that fit each other.
    fn assemble(actuators: Vec<Mounted<S>>, network: Network<S>, mechanisms: Vec<Mechanism<S>>) -> Self {
        let network = network.seen_late();
        let places = StateIndices::new(&actuators, &network, &mechanisms);
        Self { actuators, network, mechanisms, places }
    }

    /// The plant over another scalar; `function` gets each parameter with the part that it belongs to, none for the
    /// atmosphere of the whole network.
    ///
    /// Moment arms, attachments and tendons belong to their actuator; segment and joint of a chain to [`Part::Joint`]; of a
    /// chain what all joints share, its gravity and belt, to the mechanism. A hose belongs to its first node, at the valve's
    /// end, whichever cell, node or branch holds a copy of it.
    ///
    /// Over [`Dual`](crate::Dual) numbers a run of the plant carries its derivatives with respect to every seeded parameter,
    /// through all events: see [`simulate_plant`].
    pub fn map<T: Scalar>(&self, function: impl FnMut(Option<Part>, &'static Parameter, S) -> T) -> Plant<T> {
        self.convert(&mut ConvertEachOf { function, part: None })
    }

    #[doc(hidden)]
    pub fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Plant<T> {
        let actuators = self.actuators.iter().enumerate().map(|(index, mounted)| {
            convert.turn_to(Some(Part::Actuator(index)));
            Mounted {
                actuator: mounted.actuator.convert(convert),
                mechanism: mounted.mechanism,
                coupling: mounted.coupling.convert(convert),
                tendon: mounted.tendon.as_ref().map(|tendon| tendon.convert(convert)),
                pressure: mounted.pressure.as_ref().map(|series| series.convert(convert)),
            }
        });
        let actuators = actuators.collect();
        let network = self.network.convert(convert);
        let mechanisms = self.mechanisms.iter().enumerate().map(|(index, mechanism)| mechanism.convert(index, convert));
        Plant { actuators, network, mechanisms: mechanisms.collect(), places: self.places.clone() }
    }

    /// The plant with nothing commanded of some valves of its network.
    pub fn without_commands(mut self, valves: &[usize]) -> Self {
        for (index, valve) in self.network.valves.iter_mut().enumerate() {
            if valves.contains(&index) {
                valve.command = Command::nothing_of(&valve.solenoid);
            }
        }
        self
    }

    /// The actuators with their couplings.
    pub fn actuators(&self) -> &[Mounted<S>] {
        &self.actuators
    }

    /// The air network.
    pub fn network(&self) -> &Network<S> {
        &self.network
    }

    /// The mechanisms.
    pub fn mechanisms(&self) -> &[Mechanism<S>] {
        &self.mechanisms
    }

    /// Where each state lies.
    pub fn indices(&self) -> &StateIndices {
        &self.places
    }
}

impl<R: Real> Plant<R> {
    /// That the commands of its valves and the motions that are prescribed have no more than
    /// [`MAX_COUNT`](crate::parameter::MAX_COUNT) pulses and periods in a run of `duration` s.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub fn check_counts(&self, duration: f64) -> Result<(), Error> {
        for mechanism in &self.mechanisms {
            if let Mechanism::Prescribed(motion) = mechanism {
                motion.check_counts(duration)?;
            }
        }
        self.network.valves.iter().try_for_each(|valve| valve.check_counts(duration))
    }
}

impl StateIndices {
    fn new<S: Scalar>(actuators: &[Mounted<S>], network: &Network<S>, mechanisms: &[Mechanism<S>]) -> Self {
        let mut places = Self::default();
        for mechanism in mechanisms {
            let coordinates = mechanism.coordinates();
            let acceleration = places.states / 2;
            places.mechanisms.push(MechanismIndices { first: places.states, coordinates, acceleration });
            places.members.push(Vec::new());
            places.states += 2 * coordinates;
        }
        for (index, Mounted { actuator, mechanism, coupling, tendon, .. }) in actuators.iter().enumerate() {
            let pressure = places.take(2);
            let length = tendon.is_some().then(|| places.take(1));
            let bristles = actuator.friction().lugre().is_some().then(|| places.take(1));
            let count = actuator.friction().viscoelastic().map_or(0, Viscoelastic::count);
            let branches = [places.take(count), count];
            let (gradient, arms) = (places.gradients, places.arms);
            places.gradients += places.mechanisms[*mechanism].coordinates;
            places.arms += coupling.arm_count();
            places.members[*mechanism].push(index);
            places.keeps_heat.push(matches!(actuator.air().process(), Process::EnergyBalance { .. }));
            places.actuators.push(ActuatorIndices { pressure, length, bristles, branches, gradient, arms });
        }
        places.chambers = actuators.iter().map(|_| None).collect();
        for (index, node) in network.nodes.iter().enumerate() {
            let is_state = match node.kind {
                NodeKind::Chamber { actuator } => {
                    if let Some(chamber) = places.chambers.get_mut(actuator) {
                        *chamber = Some(index);
                    }
                    false
                }
                NodeKind::Atmosphere | NodeKind::Source => false,
                _ => true,
            };
            let place = is_state.then(|| places.take(1));
            places.nodes.push(place);
        }
        for branch in &network.branches {
            let place = matches!(branch.kind, BranchKind::Inertia(_)).then(|| places.take(1));
            places.branches.push(place);
        }
        let stated = |places: &[Option<usize>]| {
            places.iter().enumerate().filter_map(|(index, place)| place.map(|place| [index, place])).collect()
        };
        places.state_nodes = stated(&places.nodes);
        places.state_branches = stated(&places.branches);
        places
    }

    /// Takes so many places; the first of them.
    fn take(&mut self, count: usize) -> usize {
        self.states += count;
        self.states - count
    }
}
