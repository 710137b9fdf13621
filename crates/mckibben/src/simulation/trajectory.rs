//! A stored trajectory: samples at any time, the log of events, and what it cost.

use super::hybrid::{Phase, RigSystem};
use super::integrator::{Counts, Piece};
use super::mode::{EventKind, Mode};
use super::plumbing::MOST;
use super::rig::{Rig, State};
use super::run::{AcceptedStep, Consumer, FrontOfSize, OfSize, RunEnd, Simulation, event, four, sample};
use super::sample::{Sample, SampleTimes};
use super::stored::{Stored, keep_watch};
use crate::air::Flow;
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use alloc::boxed::Box;
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

/// A run that is kept: a consumer of its accepted steps among others.
#[derive(Clone, Debug)]
pub struct Trajectory<R: Real = f64> {
    rig: Rig<R>,
    relative_tolerance: f64,
    run: Run<R>,
    events: Vec<Event<R>>,
}

/// The run of a rig with `N` states.
type Of<R, const N: usize> = Stored<R, Phase<R>, EventKind, N>;

/// A run of a rig alone, or with an air line, bristles or a tendon in series.
#[derive(Clone, Debug)]
enum Run<R: Real> {
    Rig(Of<R, 4>),
    Line(Box<Of<R, MOST>>),
}

/// Does the same with a run of either kind.
macro_rules! with_run {
    ($run:expr, $stored:ident => $do:expr) => {
        match $run {
            Run::Rig($stored) => $do,
            Run::Line($stored) => $do,
        }
    };
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
    simulate_watched(rig, start, duration, relative_tolerance, |_| Ok(()))
}

/// The same as [`simulate`], calling `watch` with the time in s that has been reached, now and then: it may show it, or end the run by
/// an error such as [`Error::Interrupted`].
///
/// # Errors
/// As [`simulate`], and those of `watch`.
pub fn simulate_watched<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
    mut watch: impl FnMut(f64) -> Result<(), Error>,
) -> Result<Trajectory<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    R::simulate_rig(rig, start, (duration, relative_tolerance), &mut watch)
}

pub(crate) fn generic_simulate<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    (duration, relative_tolerance): (R, f64),
    watch: &mut dyn FnMut(f64) -> Result<(), Error>,
) -> Result<Trajectory<R>, Error> {
    rig.check_counts(duration.value())?;
    let mut simulation = Simulation::begin(rig.clone(), start, relative_tolerance)?;
    let mut kept = Kept::of(&simulation);
    simulation.extend(duration, &mut |step| kept.take(step, watch))?;
    kept.finish(simulation, watch)
}

/// The steps of a run, kept as they come.
#[derive(Debug)]
pub(crate) struct Kept<R: Real> {
    pieces: Pieces<R>,
    events: Vec<Event<R>>,
}

#[derive(Debug)]
enum Pieces<R: Real> {
    Rig(Vec<Piece<R, Phase<R>, EventKind, 4>>),
    Line(Vec<Piece<R, Phase<R>, EventKind, MOST>>),
}

impl<R: Real> Kept<R> {
    /// Nothing yet of a run.
    pub(super) fn of(simulation: &Simulation<R>) -> Self {
        let pieces = match simulation.front() {
            FrontOfSize::Rig(_) => Pieces::Rig(Vec::new()),
            FrontOfSize::Line(_) => Pieces::Line(Vec::new()),
        };
        Self { pieces, events: Vec::new() }
    }

    /// Keeps a step; `watch` is called with the time in s now and then.
    pub(super) fn take(
        &mut self,
        step: &AcceptedStep<'_, R>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        R::keep_step(self, step, watch)
    }

    pub(crate) fn generic_take(
        &mut self,
        step: &AcceptedStep<'_, R>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let kept = match (&mut self.pieces, &step.of) {
            (Pieces::Rig(pieces), OfSize::Rig(view)) => {
                self.events.extend(event(view.piece));
                pieces.push(*view.piece);
                pieces.len()
            }
            (Pieces::Line(pieces), OfSize::Line(view)) => {
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
        self,
        simulation: Simulation<R>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<Trajectory<R>, Error> {
        R::finish_kept(self, simulation, watch)
    }

    pub(crate) fn generic_finish(
        mut self,
        mut simulation: Simulation<R>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<Trajectory<R>, Error> {
        simulation.hand_on(&mut |step| self.take(step, watch))?;
        let Self { pieces, events } = self;
        let (rig, relative_tolerance, front) = simulation.into_parts();
        let run = match (pieces, front) {
            (Pieces::Line(pieces), FrontOfSize::Line(front)) => Run::Line(Box::new(Stored::of(pieces, &front))),
            (Pieces::Rig(pieces), FrontOfSize::Rig(front)) => Run::Rig(Stored::of(pieces, &front)),
            // The size of a run does not change.
            (_, FrontOfSize::Line(front)) => Run::Line(Box::new(Stored::of(Vec::new(), &front))),
            (_, FrontOfSize::Rig(front)) => Run::Rig(Stored::of(Vec::new(), &front)),
        };
        Ok(Trajectory { rig, relative_tolerance, run, events })
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
        with_run!(&self.run, stored => stored.counts())
    }

    /// End of the trajectory in s.
    pub fn duration(&self) -> R {
        with_run!(&self.run, stored => stored.duration())
    }

    fn system(&self) -> RigSystem<'_, R> {
        RigSystem::new(&self.rig, self.relative_tolerance)
    }

    /// The sample at `time` in s, by dense output; at the instant of an event, after it. Times before the start and
    /// after the end give the first and the last sample.
    pub fn at(&self, time: R) -> Sample<R> {
        R::read_trajectory(self, &mut None, time)
    }

    /// The sample at a time in s. A place is that of the step that was read last: from there on times do not fall.
    pub(crate) fn generic_read(&self, last: &mut Option<usize>, time: R) -> Sample<R> {
        let system = self.system();
        with_run!(&self.run, stored => {
            let place = match last {
                None => stored.begun(time.value()),
                Some(place) => stored.begun_after(*place, time.value()),
            };
            *last = Some(place);
            let (time, state, phase) = stored.at(&system, place, time);
            sample(&system, time, &state, &phase)
        })
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = Sample<R>> + '_ {
        let times = SampleTimes::new(self.duration().value(), interval);
        let mut place = Some(0);
        (0..=times.last()).map(move |index| R::read_trajectory(self, &mut place, R::constant(times.time(index))))
    }

    /// Reads the rig's four states at times in s that do not fall from one call to the next.
    pub(super) fn states(&self) -> impl FnMut(f64) -> [R; 4] + '_ {
        let system = self.system();
        let mut place = 0;
        move |time| {
            with_run!(&self.run, stored => {
                place = stored.begun_after(place, time);
                four(stored.at(&system, place, R::constant(time)).1)
            })
        }
    }

    /// The states of the air line at `time` in s, in the order of its parts: the pressures (Pa, absolute) of the hose's
    /// volumes from the valve on, the flows (kg/s) out of the cells of a distributed hose, the pressures of reservoir and
    /// regulator, or of a regulated port. As far as there are such parts.
    pub fn line_at(&self, time: R) -> Vec<R> {
        R::read_line(self, time)
    }

    pub(crate) fn generic_line_at(&self, time: R) -> Vec<R> {
        let system = self.system();
        with_run!(&self.run, stored => {
            let (_, state, _) = stored.at(&system, stored.begun(time.value()), time);
            state[4..system.line_states()].to_vec()
        })
    }

    /// The deflection in m of the bristles of LuGre's law at `time` in s, if that is the rig's friction.
    pub fn bristles_at(&self, time: R) -> Option<R> {
        R::read_bristles(self, time)
    }

    pub(crate) fn generic_bristles_at(&self, time: R) -> Option<R> {
        let system = self.system();
        with_run!(&self.run, stored => {
            let (_, state, _) = stored.at(&system, stored.begun(time.value()), time);
            system.bristles(&state)
        })
    }

    /// The least and the greatest value of each of the rig's four states, at five points of each step: length in m, velocity
    /// in m/s, absolute pressure in Pa, mass of the air in kg.
    pub fn ranges(&self) -> [(f64, f64); 4] {
        R::ranges_of_trajectory(self)
    }

    pub(crate) fn generic_ranges(&self) -> [(f64, f64); 4] {
        with_run!(&self.run, stored => four(stored.ranges()))
    }

    /// Hands each step to `consumer` in order of time, as [`simulate_into`](super::simulate_into) did on the way.
    ///
    /// # Errors
    /// Those of the consumer.
    pub fn replay(&self, consumer: &mut Consumer<'_, R>) -> Result<RunEnd<R>, Error> {
        R::replay_trajectory(self, consumer)
    }

    pub(crate) fn generic_replay(&self, consumer: &mut Consumer<'_, R>) -> Result<RunEnd<R>, Error> {
        let system = self.system();
        match &self.run {
            Run::Rig(stored) => stored
                .views()
                .try_for_each(|view| consumer(&AcceptedStep { system: &system, of: OfSize::Rig(view) }))?,
            Run::Line(stored) => stored
                .views()
                .try_for_each(|view| consumer(&AcceptedStep { system: &system, of: OfSize::Line(view) }))?,
        }
        Ok(self.end())
    }

    /// What holds at the end.
    pub(super) fn end(&self) -> RunEnd<R> {
        let system = self.system();
        let sample = with_run!(&self.run, stored => {
            let (time, state, phase) = stored.reached();
            sample(&system, *time, state, phase)
        });
        RunEnd { rig: self.rig.clone(), sample, counts: self.counts() }
    }

    /// Calls `each` with every step.
    pub(super) fn each_step(&self, mut each: impl FnMut(&AcceptedStep<'_, R>)) {
        // Nothing fails that returns no error.
        let _ = self.replay(&mut |step| {
            each(step);
            Ok(())
        });
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of each step: `Σ weight · f` is the
    /// integral of f over the trajectory, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &Sample<R>, &Mode)) {
        self.each_step(|step| step.quadrature(&mut visit));
    }

    /// Calls `visit` with the weight in s and the flows through the valve's flow paths to the supply and to the atmosphere,
    /// into hose or actuator, at the Gauss points of each step. What flows out to a pressure regulator it lets go to the
    /// atmosphere.
    pub fn valve_flows(&self, mut visit: impl FnMut(R, [Flow<R>; 2])) {
        self.each_step(|step| step.valve_flows(&mut visit));
    }
}
