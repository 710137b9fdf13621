//! One actuator with its load as a plant: the paper's four states, and those of air line, tendon and bristles.
//!
//! ```text
//! dL/dt = v
//! dv/dt = (W − F(L, v, P))/M                         (16)
//! dP/dt = by the process of the air                  (19)
//! dm/dt = flow through the open paths             (21)
//! ```
//!
//! A [`RigPlant`] knows where the rig's parts lie in its plant. Its runs are the plant's, read as those of a rig:
//! [`RigTrajectory`], [`RigStep`].
//!
//! ```
//! use mckibben::plant::RigPlant;
//! use mckibben::simulation::{Rig, State};
//!
//! # fn lifts(rig: &Rig, start: &State) -> Result<(), mckibben::Error> {
//! let run = RigPlant::new(rig).simulate(start, 1.0, 1e-8)?;
//! let length = run.at(0.5).length;
//! # Ok(())
//! # }
//! ```
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3. Checked by `tests/simulation.rs`, `tests/properties.rs` and, against an
//! independent program, `tests/reference.rs`.

pub(crate) mod linear;
pub(crate) mod point;
mod reading;
mod segments;

pub use reading::RigEvent;
pub use segments::simulate_in_segments;

use super::Plant;
use super::equipment::{Equipment, ROOM};
use super::feed::Feed;
use super::start::{InitialAir, PlantStart};
use super::steps::TimeStepping;
use super::view::{self, ViewReader, ViewRunEnd, ViewStep, ViewTrajectory};
use crate::command::Driver;
use crate::control::{Controller, Sampling, Sensors};
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::load::Load;
use crate::mechanism::{Coupling, Mass, Mechanism, Pull};
use crate::network::{Network, NodeKind};
use crate::simulation::{Rig, State};
use alloc::vec;
use core::fmt::Debug;

/// A rig with the plant that it is, and where the rig's parts lie in that.
#[derive(Clone, Debug, PartialEq)]
pub struct RigPlant<R: Instantiate = f64> {
    rig: Rig<R>,
    plant: Plant<R>,
    feed: Feed,
}

/// A run of a rig that is kept: samples at any time and the log of events.
pub type RigTrajectory<R = f64> = ViewTrajectory<RigPlant<R>, R>;
/// An accepted step of a rig's run: every sample within it, by dense output, and the event that ended it.
pub type RigStep<'s> = ViewStep<'s, RigPlant>;
/// Reads samples of a run of a rig, with room that is used again: quickest where the times do not fall from one to the next.
pub type RigReader<'t, R = f64> = ViewReader<'t, RigPlant<R>, R>;
/// Takes each accepted step of a rig's run in order of time; its error ends the run.
pub type RigConsumer<'c> = dyn FnMut(&RigStep<'_>) -> Result<(), Error> + 'c;
/// What holds at the end of a rig's run of which nothing else is kept.
pub type RigRunEnd = ViewRunEnd<RigPlant>;

impl<R: Instantiate> Plant<R> {
    /// The plant of a rig: its actuator on a mass, a fixed length or a given motion.
    pub fn of_rig(rig: &Rig<R>) -> Self {
        Self::with_feed(rig).0
    }

    /// The plant of a rig, and where what feeds the actuator lies in it.
    fn with_feed(rig: &Rig<R>) -> (Self, Feed) {
        let actuator = rig.actuator();
        let mut network = Network::new(actuator.air());
        let mechanism = match rig.load() {
            Load::HangingMass { mass, gravity } => Mechanism::Mass(Mass::assemble(*mass, Pull::Gravity(*gravity))),
            Load::ConstantForce { mass, force } => Mechanism::Mass(Mass::assemble(*mass, Pull::Force(*force))),
            Load::Isometric => Mechanism::Fixed,
            Load::Prescribed(motion) => Mechanism::Prescribed(motion.clone()),
        };
        let (line, tendon, pressure) = (rig.line(), rig.tendon(), rig.pressure_series());
        let equipment = Equipment { actuator, actuation: rig.actuation(), line, tendon, pressure };
        let mut mounted = vec![];
        let feed = equipment.mount((&mut mounted, &mut network), (0, Coupling::Direct { coordinate: 0 }), None);
        // Energy and exergy are counted from an atmosphere, also where nothing feeds the actuator.
        if network.nodes.is_empty() {
            network.node(NodeKind::Atmosphere, R::zero(), R::constant(ROOM));
        }
        (Self::assemble(mounted, network, vec![mechanism]), feed)
    }

    /// The start of the plant of a rig in a state of that rig.
    pub fn start_of_rig(rig: &Rig<R>, state: &State<R>) -> PlantStart<R> {
        let air = rig.actuator().air();
        let volume = rig.actuator().volume(state.length);
        let distance = match rig.tendon() {
            Some(tendon) => {
                let (least, most) = rig.holdable(state.length, state.pressure.0, R::zero());
                let middle = R::constant(0.5) * (least + most);
                let tension = rig.load().inertia().map_or(middle, |inertia| inertia.pull.larger(least).smaller(most));
                state.length + tendon.rest_length() + tension / tendon.stiffness()
            }
            None => state.length,
        };
        let is_held = matches!(rig.load(), Load::Isometric) && rig.tendon().is_some();
        let is_given = matches!(rig.load(), Load::Prescribed(_));
        let distance = match rig.load() {
            Load::Prescribed(motion) => motion.at(R::zero(), 0)[0],
            _ => distance,
        };
        PlantStart {
            positions: vec![vec![distance]],
            rates: vec![vec![if is_held { R::zero() } else { state.velocity }]],
            air: vec![InitialAir {
                gauge_pressure: state.pressure.gauge(air.atmosphere()),
                temperature: state.pressure.0 * volume / (state.air_mass * air.gas_constant()),
            }],
            lengths: vec![rig.tendon().filter(|_| !is_given).map(|_| state.length)],
            friction: vec![],
        }
    }
}

impl<R: Instantiate> RigPlant<R> {
    /// The plant of a rig.
    pub fn new(rig: &Rig<R>) -> Self {
        let (plant, feed) = Plant::with_feed(rig);
        Self { rig: rig.clone(), plant, feed }
    }

    /// The rig.
    pub fn rig(&self) -> &Rig<R> {
        &self.rig
    }

    /// The plant.
    pub fn plant(&self) -> &Plant<R> {
        &self.plant
    }

    /// The start of the plant in a state of the rig.
    pub fn start(&self, state: &State<R>) -> PlantStart<R> {
        Plant::start_of_rig(&self.rig, state)
    }

    /// A controller as the driver of the valve.
    ///
    /// # Errors
    /// [`Error::Misuse`] when the actuator has no valve, or one without seats.
    pub fn driver<C>(&self, controller: C, set_up: (Sampling<R>, Sensors<R>)) -> Result<Driver<R>, Error>
    where
        R: Send + Sync + 'static,
        C: Controller<R, Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        Ok(Driver::of_actuator(controller, 0, self.feed.poppet_valve(&self.plant)?, set_up))
    }

    /// Simulates the rig from a state at t = 0 for `duration` s: every event located, with a relative tolerance for each step,
    /// or by another [`TimeStepping`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a duration, tolerance or step outside its range; [`Error::TooMany`] for more pulses than a run may
    /// have; [`Error::Stopped`] when the simulation cannot reach its end: it says when, where and what to change.
    pub fn simulate(
        &self,
        state: &State<R>,
        duration: R,
        stepping: impl Into<TimeStepping>,
    ) -> Result<RigTrajectory<R>, Error> {
        self.record(state, (duration, stepping), None, &mut |_| Ok(()))
    }

    /// Simulates the rig as [`RigPlant::simulate`] does, with a [driver](RigPlant::driver) in place of its own command if there
    /// is one; `watch` is called with the time in s that has been reached now and then, and may end the run by an error such as
    /// [`Error::Interrupted`].
    ///
    /// # Errors
    /// As [`RigPlant::simulate`], those of the driver's controller, and those of `watch`.
    pub fn record(
        &self,
        state: &State<R>,
        (duration, stepping): (R, impl Into<TimeStepping>),
        driver: Option<Driver<R>>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<RigTrajectory<R>, Error> {
        view::record_view(self, state, (duration, stepping.into()), driver, watch).map(|(trajectory, _)| trajectory)
    }
}

impl RigPlant {
    /// Simulates the rig as [`RigPlant::record`] does and hands each accepted step to `consumer`; nothing is kept but the
    /// requests to the valve that a driver has.
    ///
    /// # Errors
    /// As [`RigPlant::simulate`], those of the driver's controller, and those of the consumer.
    pub fn stream(
        &self,
        state: &State,
        (duration, stepping): (f64, impl Into<TimeStepping>),
        driver: Option<Driver>,
        consumer: &mut RigConsumer<'_>,
    ) -> Result<RigRunEnd, Error> {
        view::stream_view(self, state, (duration, stepping.into()), driver, consumer)
    }
}

/// Simulates a rig from a state at t = 0 for `duration` s, every event located, with a relative tolerance for each step:
/// [`RigPlant::simulate`].
///
/// # Errors
/// As [`RigPlant::simulate`].
pub fn simulate<R: Instantiate>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
) -> Result<RigTrajectory<R>, Error> {
    RigPlant::new(rig).simulate(&start, duration, relative_tolerance)
}
