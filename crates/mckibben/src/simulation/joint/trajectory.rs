//! A stored run of a joint: samples at any time and the log of events.

use super::mode::{JointEventKind, JointMode};
use super::system::{JointPhase, JointSystem};
use super::{JointRig, JointState};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::integrator::{Counts, PieceOf};
use crate::simulation::sample::{Sample, SampleTimes};
use crate::simulation::stored::Stored;
use alloc::vec::Vec;

/// A change of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointEvent<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened, and to whom.
    pub kind: JointEventKind,
    /// The mode before.
    pub before: JointMode,
    /// The mode after.
    pub after: JointMode,
}

/// Everything that is known at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSample<R = f64> {
    /// Time in s.
    pub time: R,
    /// Angle in rad.
    pub angle: R,
    /// Angular velocity in rad/s.
    pub angular_velocity: R,
    /// Torque of both actuators in N·m, `r₁ F₁ − r₂ F₂`.
    pub torque: R,
    /// Agonist and antagonist.
    pub actuators: [Sample<R>; 2],
}

impl<R: Real> JointSample<R> {
    /// The six states.
    pub fn state(&self) -> JointState<R> {
        let Self { angle, angular_velocity, actuators, .. } = *self;
        let (pressure, air_mass) = (actuators.map(|of| of.pressure), actuators.map(|of| of.air_mass));
        JointState { angle, angular_velocity, pressure, air_mass }
    }
}

/// A simulated stretch of time.
#[derive(Clone, Debug)]
pub struct JointTrajectory<R: Real = f64> {
    rig: JointRig<R>,
    relative_tolerance: f64,
    stored: Stored<R, JointPhase<R>, JointEventKind, 6>,
    events: Vec<JointEvent<R>>,
}

/// Simulates a joint from a state at t = 0 for `duration` s, every event located, with `relative_tolerance` for each step.
///
/// # Errors
/// [`Error::OutOfRange`] for a duration or tolerance outside its range; [`Error::Stopped`] when the simulation cannot
/// reach its end: it says when, where and what to change.
pub fn simulate_joint<R: Real>(
    rig: &JointRig<R>,
    start: JointState<R>,
    duration: R,
    relative_tolerance: f64,
) -> Result<JointTrajectory<R>, Error> {
    simulate_joint_watched(rig, start, duration, relative_tolerance, |_| ())
}

/// The same as [`simulate_joint`], calling `watch` with the time in s that has been reached, now and then.
///
/// # Errors
/// As [`simulate_joint`].
pub fn simulate_joint_watched<R: Real>(
    rig: &JointRig<R>,
    start: JointState<R>,
    duration: R,
    relative_tolerance: f64,
    mut watch: impl FnMut(f64),
) -> Result<JointTrajectory<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    let mut trajectory = JointTrajectory::begin(rig.clone(), start, relative_tolerance)?;
    trajectory.extend(duration, &mut watch)?;
    Ok(trajectory)
}

/// In the making: in parts, between which the commands of the valves may be continued.
impl<R: Real> JointTrajectory<R> {
    /// Nothing yet, at t = 0 in a state.
    pub(super) fn begin(rig: JointRig<R>, start: JointState<R>, relative_tolerance: f64) -> Result<Self, Error> {
        parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
        if rig.driven().iter().any(|driven| driven.actuator.friction().lugre().is_some()) {
            return Err(Error::Unsupported {
                what: "an antagonistic joint has no states for the bristles of LuGre's law yet",
                remedy: "set hysteresis.law = \"bouc-wen\" with gamma = 0, which is the same law at one velocity, or \
                         \"maxwell-slip\"",
            });
        }
        let state = start.to_array();
        rig.check_located()?;
        let phase = JointSystem::new(&rig, relative_tolerance).begin(&state);
        Ok(Self { rig, relative_tolerance, stored: Stored::begin(state, phase), events: Vec::new() })
    }

    /// Goes on to `until` s.
    pub(super) fn extend(&mut self, until: R, watch: &mut dyn FnMut(f64)) -> Result<(), Error> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let events = &mut self.events;
        let mut see = |piece: &PieceOf<R, JointSystem<'_, R>, 6>| {
            if let Some((kind, after)) = piece.event {
                events.push(JointEvent { time: piece.end, kind, before: piece.mode.mode, after: after.mode });
            }
        };
        self.stored.extend(&system, until, self.relative_tolerance, &mut see, watch)
    }

    /// The sample at the time that has been reached.
    pub(super) fn reached(&self) -> JointSample<R> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let (time, state, phase) = self.stored.reached();
        system.sample(*time, state, phase)
    }

    /// The rig, to be told more.
    pub(super) fn rig_mut(&mut self) -> &mut JointRig<R> {
        &mut self.rig
    }
}

impl<R: Real> JointTrajectory<R> {
    /// The rig that was simulated.
    pub fn rig(&self) -> &JointRig<R> {
        &self.rig
    }

    /// The events in order of time.
    pub fn events(&self) -> &[JointEvent<R>] {
        &self.events
    }

    /// Steps, evaluations and events.
    pub fn counts(&self) -> Counts {
        self.stored.counts()
    }

    /// End of the trajectory in s.
    pub fn duration(&self) -> R {
        self.stored.duration()
    }

    /// The sample at `time` in s, by dense output; at the instant of an event, after it. Times before the start and
    /// after the end give the first and the last sample.
    pub fn at(&self, time: R) -> JointSample<R> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let (time, state, phase) = self.stored.at(&system, self.stored.begun(time.value()), time);
        system.sample(time, &state, &phase)
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = JointSample<R>> + '_ {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let times = SampleTimes::new(self.duration().value(), interval);
        let mut place = 0;
        (0..=times.last()).map(move |index| {
            let time = times.time(index);
            place = self.stored.begun_after(place, time);
            let (time, state, phase) = self.stored.at(&system, place, R::constant(time));
            system.sample(time, &state, &phase)
        })
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of each step: `Σ weight · f` is the
    /// integral of f over the trajectory, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &JointSample<R>, &JointMode)) {
        self.visit(|weight, sample, phase| visit(weight, sample, &phase.mode));
    }

    pub(super) fn visit(&self, mut visit: impl FnMut(R, &JointSample<R>, &JointPhase<R>)) {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        self.stored.quadrature(&system, |weight, time, state, phase| {
            visit(weight, &system.sample(time, state, phase), phase);
        });
    }
}
