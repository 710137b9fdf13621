//! A stored run of a joint: samples at any time and the log of events.

use super::beside::{MOST, PLAIN};
use super::mode::{JointEventKind, JointMode};
use super::run::{AcceptedJointStep, FrontOfSize, JointConsumer, JointRunEnd, JointSimulation, OfSize, event};
use super::system::{JointPhase, JointSystem};
use super::{JointRig, JointState};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::integrator::{Counts, Piece};
use crate::simulation::sample::{Sample, SampleTimes};
use crate::simulation::stored::{Stored, keep_watch};
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

/// A joint's run that is kept: a consumer of its accepted steps among others.
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
    rig.check_counts(duration.value())?;
    let mut simulation = JointSimulation::begin(rig.clone(), start, relative_tolerance)?;
    let mut kept = Kept::of(&simulation);
    simulation.extend(duration, &mut |step| kept.take(step, &mut watch))?;
    kept.finish(simulation, &mut watch)
}

/// The steps of a run, kept as they come.
#[derive(Debug)]
pub(super) struct Kept<R: Real> {
    pieces: Pieces<R>,
    events: Vec<JointEvent<R>>,
}

#[derive(Debug)]
enum Pieces<R: Real> {
    Plain(Vec<Piece<R, JointPhase<R>, JointEventKind, PLAIN>>),
    Beside(Vec<Piece<R, JointPhase<R>, JointEventKind, MOST>>),
}

impl<R: Real> Kept<R> {
    /// Nothing yet of a run.
    pub(super) fn of(simulation: &JointSimulation<R>) -> Self {
        let pieces = match simulation.front() {
            FrontOfSize::Plain(_) => Pieces::Plain(Vec::new()),
            FrontOfSize::Beside(_) => Pieces::Beside(Vec::new()),
        };
        Self { pieces, events: Vec::new() }
    }

    /// Keeps a step; `watch` is called with the time in s now and then.
    pub(super) fn take(
        &mut self,
        step: &AcceptedJointStep<'_, R>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let kept = match (&mut self.pieces, &step.of) {
            (Pieces::Plain(pieces), OfSize::Plain(view)) => {
                self.events.extend(event(view.piece));
                pieces.push(*view.piece);
                pieces.len()
            }
            (Pieces::Beside(pieces), OfSize::Beside(view)) => {
                self.events.extend(event(view.piece));
                pieces.push(*view.piece);
                pieces.len()
            }
            // The size of a run does not change.
            _ => return Ok(()),
        };
        keep_watch(kept, step.end().value(), watch)
    }

    /// The trajectory of a run that has come to its end.
    pub(super) fn finish(
        mut self,
        mut simulation: JointSimulation<R>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<JointTrajectory<R>, Error> {
        simulation.hand_on(&mut |step| self.take(step, watch))?;
        let Self { pieces, events } = self;
        let (rig, relative_tolerance, front) = simulation.into_parts();
        let run = match (pieces, front) {
            (Pieces::Plain(pieces), FrontOfSize::Plain(front)) => Run::Plain(Box::new(Stored::of(pieces, &front))),
            (Pieces::Beside(pieces), FrontOfSize::Beside(front)) => Run::Beside(Box::new(Stored::of(pieces, &front))),
            // The size of a run does not change.
            (_, FrontOfSize::Plain(front)) => Run::Plain(Box::new(Stored::of(Vec::new(), &front))),
            (_, FrontOfSize::Beside(front)) => Run::Beside(Box::new(Stored::of(Vec::new(), &front))),
        };
        Ok(JointTrajectory { rig, relative_tolerance, run, events })
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

    /// Hands each step to `consumer` in order of time, as [`simulate_joint_into`](super::simulate_joint_into) did on the way.
    ///
    /// # Errors
    /// Those of the consumer.
    pub fn replay(&self, consumer: &mut JointConsumer<'_, R>) -> Result<JointRunEnd<R>, Error> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        match &self.run {
            Run::Plain(stored) => stored
                .views()
                .try_for_each(|view| consumer(&AcceptedJointStep { system: &system, of: OfSize::Plain(view) }))?,
            Run::Beside(stored) => stored
                .views()
                .try_for_each(|view| consumer(&AcceptedJointStep { system: &system, of: OfSize::Beside(view) }))?,
        }
        Ok(self.end())
    }

    /// What holds at the end.
    pub(super) fn end(&self) -> JointRunEnd<R> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let sample = with_run!(&self.run, stored => {
            let (time, state, phase) = stored.reached();
            system.sample(*time, state, phase)
        });
        JointRunEnd { rig: self.rig.clone(), sample, counts: self.counts() }
    }

    /// Calls `each` with every step.
    pub(super) fn each_step(&self, mut each: impl FnMut(&AcceptedJointStep<'_, R>)) {
        // Nothing fails that returns no error.
        let _ = self.replay(&mut |step| {
            each(step);
            Ok(())
        });
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of each step: `Σ weight · f` is the
    /// integral of f over the trajectory, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &JointSample<R>, &JointMode)) {
        self.each_step(|step| step.quadrature(&mut visit));
    }
}
