//! A joint that two antagonistic actuators turn, as a plant of two actuators on a chain of one segment.
//!
//! ```text
//! dθ/dt = ω
//! dω/dt = (r₁(θ) F₁ − r₂(θ) F₂ + W − M g d sin(θ − θ₀) − c ω − S)/J        (see `load::Joint`)
//! dP/dt, dm/dt of each actuator by its process (19) and its valve (21)
//! ```
//!
//! and the states of hoses, reservoir, regulators and tendons, where there are such.
//!
//! A [`JointPlant`] knows where the joint's parts lie in its plant. Its runs are the plant's, read as those of a joint:
//! [`JointTrajectory`], [`JointStep`].
//!
//! ```
//! use mckibben::plant::JointPlant;
//! use mckibben::simulation::{JointRig, JointState};
//!
//! # fn turns(rig: &JointRig, start: &JointState) -> Result<(), mckibben::Error> {
//! let run = JointPlant::new(rig)?.simulate(start, 1.0, 1e-8)?;
//! let angle = run.at(0.5).angle;
//! # Ok(())
//! # }
//! ```
//!
//! Checked by `tests/joint.rs`, `tests/joint_located.rs`, `tests/joint_control.rs` and `tests/moment_arm.rs`.

pub(crate) mod linear;
mod reading;
mod run;
mod view;

pub use reading::{JointEvent, JointEventKind, JointMode, Turning};
pub use run::{JointConsumer, JointRunEnd, JointStep, JointTrajectory};

use super::Plant;
use super::equipment::Equipment;
use super::feed::Feed;
use super::start::{InitialAir, PlantStart};
use crate::command::Driver;
use crate::control::{JointController, JointSensors, Sampling};
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::line::Line;
use crate::mechanism::{Arm, Chain, ChainSegment, Coupling, JointStops, Mechanism, Revolute};
use crate::network::Network;
use crate::simulation::{Driven, Fittings, JointRig, JointState};
use alloc::vec;
use core::fmt::Debug;

/// A joint with the plant that it is, and where the joint's parts lie in that.
#[derive(Clone, Debug, PartialEq)]
pub struct JointPlant<R: Instantiate = f64> {
    rig: JointRig<R>,
    plant: Plant<R>,
    feeds: [Feed; 2],
}

impl<S: Instantiate> Plant<S> {
    /// The plant of a joint: agonist and antagonist are its actuators 0 and 1, the joint that of its only mechanism.
    ///
    /// # Errors
    /// None for a joint that has been checked.
    pub fn of_joint(rig: &JointRig<S>) -> Result<Self, Error> {
        Ok(Self::with_feeds(rig).0)
    }

    /// The plant of a joint, and where what feeds agonist and antagonist lies in it.
    fn with_feeds(rig: &JointRig<S>) -> (Self, [Feed; 2]) {
        let joint = rig.joint();
        let limb = joint.limb();
        let segment =
            ChainSegment { length: S::zero(), mass: limb.mass, distance: limb.distance, inertia: limb.inertia };
        let stops = joint.stops();
        let stops = JointStops { ends: stops.ends, stiffness: stops.stiffness, damping: stops.damping };
        let revolute = Revolute { torque: joint.torque(), damping: joint.damping(), stops };
        let chain = Chain::assemble(vec![segment], vec![revolute], [limb.gravity, limb.hanging_angle], None);
        let mut network = Network::new(rig.driven()[0].actuator.air());
        let (mut mounted, mut shared) = (vec![], None);
        let feeds = [0, 1].map(|index| {
            let Driven { actuator, actuation } = &rig.driven()[index];
            let Fittings { line, tendon, pressure } = &rig.fittings()[index];
            let common = rig.shared_supply().filter(|_| actuation.is_some());
            let line = Line { supply: rig.shared_supply().map_or(line.supply, |_| common.copied()), ..*line };
            let over = &joint.tendons()[index];
            let sign = if index == 0 { 1.0 } else { -1.0 };
            let arms = vec![Arm { joint: 0, sign, arm: over.arm }];
            let coupling = Coupling::Arms { rest_length: over.rest_length, arms };
            let (actuation, line) = (actuation.as_ref(), &line);
            let equipment =
                Equipment { actuator, actuation, line, tendon: tendon.as_ref(), pressure: pressure.as_ref() };
            // The atmosphere has the temperature of the first supply.
            let feed = equipment.mount((&mut mounted, &mut network), (0, coupling), shared);
            shared = common.and(feed.supply).or(shared);
            feed
        });
        (Self::assemble(mounted, network, vec![Mechanism::Chain(chain)]), feeds)
    }

    /// The start of the plant of a joint in a state of that joint.
    pub fn start_of_joint(rig: &JointRig<S>, state: &JointState<S>) -> PlantStart<S> {
        let lengths = rig.lengths(state.angle, state.pressure);
        let air = [0, 1].map(|i| {
            let actuator = &rig.driven()[i].actuator;
            let air = actuator.air();
            let volume = actuator.volume(lengths[i]);
            InitialAir {
                gauge_pressure: state.pressure[i].gauge(air.atmosphere()),
                temperature: state.pressure[i].0 * volume / (state.air_mass[i] * air.gas_constant()),
            }
        });
        PlantStart {
            positions: vec![vec![state.angle]],
            rates: vec![vec![state.angular_velocity]],
            air: air.to_vec(),
            lengths: vec![None, None],
            friction: vec![],
        }
    }
}

impl<R: Instantiate> JointPlant<R> {
    /// The plant of a joint.
    ///
    /// # Errors
    /// As [`Plant::of_joint`].
    pub fn new(rig: &JointRig<R>) -> Result<Self, Error> {
        let (plant, feeds) = Plant::with_feeds(rig);
        Ok(Self { rig: rig.clone(), plant, feeds })
    }

    /// The joint.
    pub fn rig(&self) -> &JointRig<R> {
        &self.rig
    }

    /// The plant.
    pub fn plant(&self) -> &Plant<R> {
        &self.plant
    }

    /// The start of the plant in a state of the joint.
    pub fn start(&self, state: &JointState<R>) -> PlantStart<R> {
        Plant::start_of_joint(&self.rig, state)
    }

    /// A controller of agonist and antagonist as the driver of both valves.
    ///
    /// # Errors
    /// [`Error::Misuse`] when an actuator has no valve, or one without seats.
    pub fn driver<C>(&self, controller: C, set_up: (Sampling<R>, JointSensors<R>)) -> Result<Driver<R>, Error>
    where
        R: Send + Sync + 'static,
        C: JointController<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        let [agonist, antagonist] =
            [self.feeds[0].poppet_valve(&self.plant)?, self.feeds[1].poppet_valve(&self.plant)?];
        Ok(Driver::of_joint(controller, (0, 0), [0, 1], [agonist, antagonist], set_up))
    }

    /// The joint with the commands that the valves of its plant have come to have.
    fn rig_commanded(&self, network: &Network<R>) -> JointRig<R> {
        let commands = self.feeds.map(|feed| feed.valve.map(|valve| network.valves[valve].command.clone()));
        self.rig.commanded(commands)
    }
}
