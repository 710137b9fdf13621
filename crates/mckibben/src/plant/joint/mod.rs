//! A joint that two antagonistic actuators turn, as a plant of two actuators on a chain of one segment.
//!
//! ```text
//! dθ/dt = ω
//! dω/dt = (r₁(θ) F₁ − r₂(θ) F₂ + W − M g d sin(θ − θ₀) − c ω − S)/J        (see `load::Joint`)
//! dP/dt, dm/dt of each actuator by its process (19) and its valve (21)
//! ```
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

mod reading;
mod run;

pub use reading::{JointEvent, JointEventKind, JointMode, Turning};
pub use run::{JointConsumer, JointReader, JointRunEnd, JointStep, JointTrajectory};

use super::start::{InitialAir, PlantStart};
use super::{Mounted, Plant};
use crate::command::Driver;
use crate::control::{JointController, JointSensors, Sampling};
use crate::error::Error;
use crate::line::Line;
use crate::mechanism::{Arm, Chain, ChainSegment, Coupling, JointStops, Mechanism, Revolute};
use crate::network::{BranchKind, Network, NodeKind};
use crate::scalar::{Real, Scalar};
use crate::simulation::{Driven, JointRig, JointState};
use crate::valve::Port;
use alloc::vec;
use core::fmt::Debug;

/// What feeds an actuator of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Feed {
    /// The valve.
    valve: usize,
    /// The flow paths to the supply and to the atmosphere.
    paths: [Option<usize>; 2],
    /// The node whose pressure a regulator in the valve's place makes.
    port: Option<usize>,
}

/// A joint with the plant that it is, and where the joint's parts lie in that.
#[derive(Clone, Debug, PartialEq)]
pub struct JointPlant<R: Real = f64> {
    rig: JointRig<R>,
    plant: Plant<R>,
    feeds: [Option<Feed>; 2],
}

impl<S: Scalar> Plant<S> {
    /// The plant of a joint: agonist and antagonist are its actuators 0 and 1, the joint that of its only mechanism.
    ///
    /// # Errors
    /// As [`Plant::new`]; none for a joint that has been checked.
    pub fn of_joint(rig: &JointRig<S>) -> Result<Self, Error> {
        let joint = rig.joint();
        let limb = joint.limb();
        let segment =
            ChainSegment { length: S::zero(), mass: limb.mass, distance: limb.distance, inertia: limb.inertia };
        let stops = joint.stops();
        let stops = JointStops { ends: stops.ends, stiffness: stops.stiffness, damping: stops.damping };
        let revolute = Revolute { torque: joint.torque(), damping: joint.damping(), stops };
        let chain = Chain::assemble(vec![segment], vec![revolute], [limb.gravity, limb.hanging_angle], None);
        let mut network = Network::new(rig.driven()[0].actuator.air());
        let mut mounted = vec![];
        for (index, Driven { actuator, actuation }) in rig.driven().iter().enumerate() {
            // The atmosphere has the temperature of the first supply.
            if actuation.is_some() {
                network.feed(index, actuator, actuation.as_ref(), &Line::NONE);
            }
            let tendon = &joint.tendons()[index];
            let sign = if index == 0 { 1.0 } else { -1.0 };
            let arms = vec![Arm { joint: 0, sign, arm: tendon.arm }];
            mounted.push(Mounted {
                actuator: actuator.clone().without_valve(),
                mechanism: 0,
                coupling: Coupling::Arms { rest_length: tendon.rest_length, arms },
                tendon: None,
                pressure: None,
            });
        }
        Ok(Self::assemble(mounted, network, vec![Mechanism::Chain(chain)]))
    }

    /// The start of the plant of a joint in a state of that joint.
    pub fn start_of_joint(rig: &JointRig<S>, state: &JointState<S>) -> PlantStart<S> {
        let lengths = rig.joint().lengths(state.angle);
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
            lengths: vec![None; 2],
            friction: vec![],
        }
    }
}

impl<R: Real> JointPlant<R> {
    /// The plant of a joint.
    ///
    /// # Errors
    /// As [`Plant::of_joint`].
    pub fn new(rig: &JointRig<R>) -> Result<Self, Error> {
        R::new_joint_plant(rig)
    }

    pub(crate) fn generic_new(rig: &JointRig<R>) -> Result<Self, Error> {
        let plant = Plant::of_joint(rig)?;
        let network = plant.network();
        let mut valves = 0..network.valves.len();
        let feeds = rig.driven().each_ref().map(|driven| {
            let valve = driven.actuation.as_ref().and_then(|_| valves.next())?;
            let path = |wanted: Port| {
                let is_it = |kind: &BranchKind<R>| {
                    matches!(kind, BranchKind::Path { valve: its, port, .. } if *its == valve && *port == wanted)
                };
                network.branches.iter().position(|branch| is_it(&branch.kind))
            };
            let makes = |kind: &NodeKind<R>| matches!(kind, NodeKind::Port { valve: its, .. } if *its == valve);
            let port = network.nodes.iter().position(|node| makes(&node.kind));
            Some(Feed { valve, paths: [path(Port::Supply), path(Port::Exhaust)], port })
        });
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
        let [Some(agonist), Some(antagonist)] = self.feeds else {
            return Err(Error::Misuse {
                what: "a controller is given, but the actuator has no valve",
                remedy: "give the actuator a valve, or simulate it without a controller",
            });
        };
        if self.plant.network().valves.iter().any(|valve| !valve.solenoid.has_seats()) {
            return Err(Error::Misuse {
                what: "a controller drives the seats of a valve, and a pressure regulator or a proportional spool has none",
                remedy: "choose a valve such as valve.kind = \"three-way\", or give set points or positions",
            });
        }
        Ok(Driver::of_joint(controller, (0, 0), [0, 1], [agonist.valve, antagonist.valve], set_up))
    }

    /// The joint with the commands that the valves of its plant have come to have.
    fn rig_commanded(&self, network: &Network<R>) -> JointRig<R> {
        let commands = self.feeds.map(|feed| feed.map(|feed| network.valves[feed.valve].command.clone()));
        self.rig.commanded(commands)
    }
}
