//! A run of a joint as it is made: each accepted step goes to whoever takes it, and nothing is kept, as by
//! [`simulate_into`](crate::simulation::simulate_into).
//!
//! Checked by `tests/run.rs`.

use super::beside::{MOST, PLAIN};
use super::mode::{JointEventKind, JointMode};
use super::system::{JointPhase, JointSystem};
use super::trajectory::{JointEvent, JointSample};
use super::{JointRig, JointState};
use crate::air::Flow;
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::integrator::{Counts, Piece};
use crate::simulation::run::Readable;
use crate::simulation::stored::{Front, View};
use alloc::boxed::Box;

/// The view of a step of a joint with `N` states.
pub(super) type Of<'a, R, const N: usize> = View<'a, R, JointPhase<R>, JointEventKind, N>;

/// An accepted step of a joint's run: every sample within it, by dense output, and the event that ended it.
#[derive(Clone, Copy, Debug)]
pub struct AcceptedJointStep<'a, R: Real = f64> {
    pub(super) system: &'a JointSystem<'a, R>,
    pub(super) of: OfSize<'a, R>,
}

/// The step of a joint with its six states, or with auxiliary states.
#[derive(Clone, Copy, Debug)]
pub(super) enum OfSize<'a, R: Real> {
    Plain(Of<'a, R, PLAIN>),
    Beside(Of<'a, R, MOST>),
}

/// Does the same with a step of either kind.
macro_rules! with_view {
    ($step:expr, $view:ident => $do:expr) => {
        match &$step.of {
            OfSize::Plain($view) => $do,
            OfSize::Beside($view) => $do,
        }
    };
}

/// Takes each accepted step of a joint's run in order of time; its error ends the run.
pub type JointConsumer<'c, R = f64> = dyn FnMut(&AcceptedJointStep<'_, R>) -> Result<(), Error> + 'c;

/// What holds at the end of a joint's run.
#[derive(Clone, Debug)]
pub struct JointRunEnd<R: Real = f64> {
    /// The joint; under a controller its commands are the tables of all that the controller requested.
    pub rig: JointRig<R>,
    /// The last sample.
    pub sample: JointSample<R>,
    /// Steps, evaluations and events.
    pub counts: Counts,
}

/// Simulates a joint as [`simulate_joint`](super::simulate_joint) does and hands each accepted step to `consumer`; nothing is
/// kept.
///
/// # Errors
/// As [`simulate_joint`](super::simulate_joint), and those of the consumer, such as [`Error::Interrupted`].
pub fn simulate_joint_into<R: Real>(
    rig: &JointRig<R>,
    start: JointState<R>,
    duration: R,
    relative_tolerance: f64,
    consumer: &mut JointConsumer<'_, R>,
) -> Result<JointRunEnd<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    rig.check_counts(duration.value())?;
    let mut simulation = JointSimulation::begin(rig.clone(), start, relative_tolerance)?;
    simulation.extend(duration, consumer)?;
    simulation.finish(consumer)
}

/// A run under way, in parts between which the commands of the valves may be continued.
#[derive(Debug)]
pub(super) struct JointSimulation<R: Real> {
    rig: JointRig<R>,
    relative_tolerance: f64,
    front: FrontOfSize<R>,
}

#[derive(Debug)]
pub(super) enum FrontOfSize<R: Real> {
    Plain(Box<Front<R, JointPhase<R>, JointEventKind, PLAIN>>),
    Beside(Box<Front<R, JointPhase<R>, JointEventKind, MOST>>),
}

/// Does the same with a front of either kind.
macro_rules! with_front {
    ($front:expr, $now:ident => $do:expr) => {
        match $front {
            FrontOfSize::Plain($now) => $do,
            FrontOfSize::Beside($now) => $do,
        }
    };
}

impl<R: Real> JointSimulation<R> {
    /// At t = 0 in a state.
    pub(super) fn begin(rig: JointRig<R>, start: JointState<R>, relative_tolerance: f64) -> Result<Self, Error> {
        parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
        let system = JointSystem::new(&rig, relative_tolerance);
        let front = match system.beside.states {
            PLAIN => FrontOfSize::Plain(Box::new(begin(&system, start))),
            _ => FrontOfSize::Beside(Box::new(begin(&system, start))),
        };
        Ok(Self { rig, relative_tolerance, front })
    }

    /// Goes on to `until` s.
    pub(super) fn extend(&mut self, until: R, consumer: &mut JointConsumer<'_, R>) -> Result<(), Error> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        let tolerance = self.relative_tolerance;
        match &mut self.front {
            FrontOfSize::Plain(front) => front.extend(&system, until, tolerance, &mut |view| {
                consumer(&AcceptedJointStep { system: &system, of: OfSize::Plain(*view) })
            }),
            FrontOfSize::Beside(front) => front.extend(&system, until, tolerance, &mut |view| {
                consumer(&AcceptedJointStep { system: &system, of: OfSize::Beside(*view) })
            }),
        }
    }

    /// Hands on the last step and says what holds at the end.
    pub(super) fn finish(mut self, consumer: &mut JointConsumer<'_, R>) -> Result<JointRunEnd<R>, Error> {
        self.hand_on(consumer)?;
        let sample = self.reached();
        let counts = with_front!(&self.front, front => front.counts());
        Ok(JointRunEnd { rig: self.rig, sample, counts })
    }

    /// Hands on the last step: no other follows.
    pub(super) fn hand_on(&mut self, consumer: &mut JointConsumer<'_, R>) -> Result<(), Error> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        match &mut self.front {
            FrontOfSize::Plain(front) => {
                front.finish(&mut |view| consumer(&AcceptedJointStep { system: &system, of: OfSize::Plain(*view) }))
            }
            FrontOfSize::Beside(front) => {
                front.finish(&mut |view| consumer(&AcceptedJointStep { system: &system, of: OfSize::Beside(*view) }))
            }
        }
    }

    /// The front of the run.
    pub(super) fn front(&self) -> &FrontOfSize<R> {
        &self.front
    }

    /// The joint, the tolerance and the front of a run that has come to its end.
    pub(super) fn into_parts(self) -> (JointRig<R>, f64, FrontOfSize<R>) {
        (self.rig, self.relative_tolerance, self.front)
    }

    /// The sample at the time that has been reached.
    pub(super) fn reached(&self) -> JointSample<R> {
        let system = JointSystem::new(&self.rig, self.relative_tolerance);
        with_front!(&self.front, front => {
            let (time, state, phase) = front.reached();
            system.sample(*time, state, phase)
        })
    }

    /// The joint, whose commands may be continued.
    pub(super) fn rig_mut(&mut self) -> &mut JointRig<R> {
        &mut self.rig
    }
}

impl<R: Real> JointRig<R> {
    /// What a kept trajectory of this joint takes in bytes for each step.
    pub fn bytes_per_step(&self) -> usize {
        match JointSystem::new(self, 1e-8).beside.states {
            PLAIN => size_of::<Piece<R, JointPhase<R>, JointEventKind, PLAIN>>(),
            _ => size_of::<Piece<R, JointPhase<R>, JointEventKind, MOST>>(),
        }
    }
}

/// The front of a system with `N` states at its start.
fn begin<R: Real, const N: usize>(
    system: &JointSystem<'_, R>,
    start: JointState<R>,
) -> Front<R, JointPhase<R>, JointEventKind, N> {
    let state = system.start(start);
    Front::begin(state, system.begin(&state))
}

impl<R: Real> AcceptedJointStep<'_, R> {
    /// The joint as it is now.
    pub fn rig(&self) -> &JointRig<R> {
        self.system.rig()
    }

    /// Start of the step in s.
    pub fn start(&self) -> R {
        with_view!(self, view => view.piece.arc.start)
    }

    /// End of the step in s.
    pub fn end(&self) -> R {
        with_view!(self, view => view.piece.end)
    }

    /// The event that ended the step, if one did.
    pub fn event(&self) -> Option<JointEvent<R>> {
        with_view!(self, view => event(view.piece))
    }

    /// The sample at `time` in s, kept within the step.
    pub fn at(&self, time: R) -> JointSample<R> {
        let system = self.system;
        with_view!(self, view => system.sample(time, &view.at(system, time), &view.piece.mode))
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of the step: `Σ weight · f` over all steps
    /// is the integral of f over the run, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &JointSample<R>, &JointMode)) {
        self.visit(|weight, sample, phase, _| visit(weight, sample, &phase.mode));
    }

    /// As [`AcceptedJointStep::quadrature`], with the phase, and of each actuator the flow and the friction lengths of its
    /// hysteresis.
    pub(super) fn visit(&self, mut visit: impl FnMut(R, &JointSample<R>, &JointPhase<R>, [(Flow<R>, [R; 2]); 2])) {
        let system = self.system;
        with_view!(self, view => view.quadrature(system, |weight, time, state, phase| {
            let of = [0, 1].map(|i| (system.flow(i, time, state, phase), system.widths(i, state, phase)));
            visit(weight, &system.sample(time, state, phase), phase, of);
        }));
    }

    /// Whether the step holds the time 0, at which a run starts.
    pub(super) fn holds_start(&self) -> bool {
        with_view!(self, view => view.holds(0.0))
    }
}

impl Readable for AcceptedJointStep<'_> {
    type Sample = JointSample;

    fn holds(&self, time: f64) -> bool {
        with_view!(self, view => view.holds(time))
    }

    fn read(&self, time: f64) -> JointSample {
        self.at(time)
    }
}

/// What ended a step of a joint.
pub(super) fn event<R: Real, const N: usize>(
    piece: &Piece<R, JointPhase<R>, JointEventKind, N>,
) -> Option<JointEvent<R>> {
    let (kind, after) = piece.event?;
    Some(JointEvent { time: piece.end, kind, before: piece.mode.mode, after: after.mode })
}
