//! A stored trajectory: samples at any time, the log of events, and what it cost.

use super::hybrid::{Phase, RigSystem};
use super::integrator::{Counts, PieceOf};
use super::mode::{EventKind, Mode};
use super::rig::{Rig, State};
use super::sample::{Sample, SampleTimes};
use super::stored::Stored;
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use alloc::vec::Vec;

/// A change of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened.
    pub kind: EventKind,
    /// The mode before.
    pub before: Mode,
    /// The mode after.
    pub after: Mode,
}

/// A simulated stretch of time.
#[derive(Clone, Debug)]
pub struct Trajectory<R: Real = f64> {
    rig: Rig<R>,
    relative_tolerance: f64,
    stored: Stored<R, Phase<R>, EventKind, 4>,
    events: Vec<Event<R>>,
}

/// Simulates a rig from a state at t = 0 for `duration` s, every event located, with `relative_tolerance` for each step.
///
/// # Errors
/// [`Error::OutOfRange`] for a duration or tolerance outside its range; [`Error::Stopped`] when the simulation cannot
/// reach its end: it says when, where and what to change.
pub fn simulate<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
) -> Result<Trajectory<R>, Error> {
    simulate_watched(rig, start, duration, relative_tolerance, |_| ())
}

/// The same as [`simulate`], calling `watch` with the time in s that has been reached, now and then.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_watched<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
    watch: impl FnMut(f64),
) -> Result<Trajectory<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    let mut trajectory = Trajectory::begin(rig.clone(), start, relative_tolerance)?;
    trajectory.extend(duration, watch)?;
    Ok(trajectory)
}

/// Writes what ended a piece into a log.
fn log<R: Real>(events: &mut Vec<Event<R>>, piece: &PieceOf<R, RigSystem<'_, R>, 4>) {
    if let Some((kind, after)) = piece.event {
        events.push(Event { time: piece.end, kind, before: piece.mode.mode, after: after.mode });
    }
}

/// In the making: in parts, between which the rig's command may be continued.
impl<R: Real> Trajectory<R> {
    /// Nothing yet, at t = 0 in a state.
    pub(super) fn begin(rig: Rig<R>, start: State<R>, relative_tolerance: f64) -> Result<Self, Error> {
        parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
        let state = start.to_array();
        let phase = RigSystem::new(&rig, relative_tolerance).begin(&state);
        Ok(Self { rig, relative_tolerance, stored: Stored::begin(state, phase), events: Vec::new() })
    }

    /// Goes on to `until` s.
    pub(super) fn extend(&mut self, until: R, watch: impl FnMut(f64)) -> Result<(), Error> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let events = &mut self.events;
        self.stored.extend(&system, until, self.relative_tolerance, |piece| log(events, piece), watch)
    }

    /// The sample at the time that has been reached.
    pub(super) fn reached(&self) -> Sample<R> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let (time, state, phase) = self.stored.reached();
        sample(&system, *time, state, phase)
    }

    /// The rig, to be told more.
    pub(super) fn rig_mut(&mut self) -> &mut Rig<R> {
        &mut self.rig
    }
}

impl<R: Real> Trajectory<R> {
    /// The rig that was simulated.
    pub fn rig(&self) -> &Rig<R> {
        &self.rig
    }

    /// The events in order of time.
    pub fn events(&self) -> &[Event<R>] {
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
    pub fn at(&self, time: R) -> Sample<R> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        self.sample_with(&system, self.stored.begun(time.value()), time)
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = Sample<R>> + '_ {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let times = SampleTimes::new(self.duration().value(), interval);
        let mut place = 0;
        (0..=times.last()).map(move |index| {
            let time = times.time(index);
            place = self.stored.begun_after(place, time);
            self.sample_with(&system, place, R::constant(time))
        })
    }

    /// Reads the four states at times in s that do not fall from one call to the next.
    pub(super) fn states(&self) -> impl FnMut(f64) -> [R; 4] + '_ {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let mut place = 0;
        move |time| {
            place = self.stored.begun_after(place, time);
            self.stored.at(&system, place, R::constant(time)).1
        }
    }

    /// The least and the greatest value of each state, at five points of each step.
    pub(super) fn ranges(&self) -> [(f64, f64); 4] {
        self.stored.ranges()
    }

    fn sample_with(&self, system: &RigSystem<'_, R>, begun: usize, time: R) -> Sample<R> {
        let (time, state, phase) = self.stored.at(system, begun, time);
        sample(system, time, &state, &phase)
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of each step: `Σ weight · f` is the
    /// integral of f over the trajectory, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &Sample<R>, &Mode)) {
        self.visit(|weight, sample, phase| visit(weight, sample, &phase.mode));
    }

    pub(super) fn visit(&self, mut visit: impl FnMut(R, &Sample<R>, &Phase<R>)) {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        self.stored.quadrature(&system, |weight, time, state, phase| {
            visit(weight, &sample(&system, time, state, phase), phase);
        });
    }
}

fn sample<R: Real>(system: &RigSystem<'_, R>, time: R, state: &[R; 4], phase: &Phase<R>) -> Sample<R> {
    system.member().sample(time, state, system.tension(state, phase), &phase.mode)
}
