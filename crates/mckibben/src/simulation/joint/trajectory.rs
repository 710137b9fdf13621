//! A stored run of a joint: samples at any time and the log of events.

use super::beside::{MOST, PLAIN};
use super::mode::{JointEventKind, JointMode};
use super::system::{JointPhase, JointSystem};
use super::{JointRig, JointState};
use crate::air::Flow;
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::integrator::{Counts, Piece};
use crate::simulation::sample::{Sample, SampleTimes};
use crate::simulation::stored::Stored;
use alloc::boxed::Box;
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
    run: Run<R>,
    events: Vec<JointEvent<R>>,
}

/// The run of a joint with `N` states.
type Of<R, const N: usize> = Stored<R, JointPhase<R>, JointEventKind, N>;

/// A run of a joint with its six states, or more beside.
#[derive(Clone, Debug)]
enum Run<R: Real> {
    Plain(Box<Of<R, PLAIN>>),
    Beside(Box<Of<R, MOST>>),
}

/// Does the same with a run of either kind.
macro_rules! with_run {
    ($run:expr, $stored:ident => $do:expr) => {
        match $run {
            Run::Plain($stored) => $do,
            Run::Beside($stored) => $do,
        }
    };
}

/// The run of a system with `N` states at its start.
fn begin<R: Real, const N: usize>(system: &JointSystem<'_, R>, start: JointState<R>) -> Of<R, N> {
    let state = system.start(start);
    Stored::begin(state, system.begin(&state))
}

/// Writes what ended a piece into a log.
fn log<R: Real, const N: usize>(events: &mut Vec<JointEvent<R>>, piece: &Piece<R, JointPhase<R>, JointEventKind, N>) {
    if let Some((kind, after)) = piece.event {
        events.push(JointEvent { time: piece.end, kind, before: piece.mode.mode, after: after.mode });
    }
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
    simulate_joint_watched(rig, start, duration, relative_tolerance, |_| Ok(()))
}

/// The same as [`simulate_joint`], calling `watch` with the time in s that has been reached, now and then: it may show it, or end the run by
/// an error such as [`Error::Interrupted`].
///
/// # Errors
/// As [`simulate_joint`], and those of `watch`.
pub fn simulate_joint_watched<R: Real>(
    rig: &JointRig<R>,
    start: JointState<R>,
    duration: R,
    relative_tolerance: f64,
    mut watch: impl FnMut(f64) -> Result<(), Error>,
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
        let system = JointSystem::new(&rig, relative_tolerance);
        let run = match system.beside.states {
            PLAIN => Run::Plain(Box::new(begin(&system, start))),
            _ => Run::Beside(Box::new(begin(&system, start))),
        };
        Ok(Self { rig, relative_tolerance, run, events: Vec::new() })
    }

    /// Goes on to `until` s.
    pub(super) fn extend(&mut self, until: R, watch: &mut dyn FnMut(f64) -> Result<(), Error>) -> Result<(), Error> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let events = &mut self.events;
        with_run!(&mut self.run, stored => {
            stored.extend(&system, until, self.relative_tolerance, &mut |piece| log(events, piece), watch)
        })
    }

    /// The sample at the time that has been reached.
    pub(super) fn reached(&self) -> JointSample<R> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        with_run!(&self.run, stored => {
            let (time, state, phase) = stored.reached();
            system.sample(*time, state, phase)
        })
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
        with_run!(&self.run, stored => stored.counts())
    }

    /// End of the trajectory in s.
    pub fn duration(&self) -> R {
        with_run!(&self.run, stored => stored.duration())
    }

    /// The sample at `time` in s, by dense output; at the instant of an event, after it. Times before the start and
    /// after the end give the first and the last sample.
    pub fn at(&self, time: R) -> JointSample<R> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        with_run!(&self.run, stored => {
            let (time, state, phase) = stored.at(&system, stored.begun(time.value()), time);
            system.sample(time, &state, &phase)
        })
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = JointSample<R>> + '_ {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let times = SampleTimes::new(self.duration().value(), interval);
        let mut place = 0;
        (0..=times.last()).map(move |index| {
            let time = times.time(index);
            with_run!(&self.run, stored => {
                place = stored.begun_after(place, time);
                let (time, state, phase) = stored.at(&system, place, R::constant(time));
                system.sample(time, &state, &phase)
            })
        })
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of each step: `Σ weight · f` is the
    /// integral of f over the trajectory, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &JointSample<R>, &JointMode)) {
        self.visit(|weight, sample, phase, _| visit(weight, sample, &phase.mode));
    }

    /// The same with the phase, and of each actuator the flow and the widths of its hysteresis.
    pub(super) fn visit(&self, mut visit: impl FnMut(R, &JointSample<R>, &JointPhase<R>, [(Flow<R>, [R; 2]); 2])) {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        with_run!(&self.run, stored => stored.quadrature(&system, |weight, time, state, phase| {
            let of = [0, 1].map(|i| (system.flow(i, time, state, phase), system.widths(i, state, phase)));
            visit(weight, &system.sample(time, state, phase), phase, of);
        }));
    }
}
