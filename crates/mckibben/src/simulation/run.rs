//! A run of a rig as it is made: each accepted step goes to whoever takes it, and nothing is kept.
//!
//! [`simulate_into`] hands every [`AcceptedStep`] to a consumer, in order of time: one that writes samples ([`Reading`]), one
//! that sums energies ([`Ledger`](super::Ledger)), one that keeps all of them, which is a [`Trajectory`](super::Trajectory).
//! So memory is what the consumer takes, and the results of a run do not depend on what was kept of it.
//!
//! Checked by `tests/run.rs`: what is read on the way is what a trajectory gives, bit by bit.

use super::hybrid::{Phase, RigSystem};
use super::integrator::{Counts, Piece};
use super::mode::{EventKind, Mode};
use super::plumbing::MOST;
use super::rig::{Rig, State};
use super::sample::Sample;
use super::stored::{Front, View, is_end};
use super::trajectory::Event;
use super::zones::Places;
use crate::air::Flow;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::Real;
use alloc::boxed::Box;
use core::iter::Peekable;

/// The view of a step of a rig with `N` states.
pub(super) type Of<'a, R, const N: usize> = View<'a, R, Phase<R>, EventKind, N>;

/// An accepted step of a run: every sample within it, by dense output, and the event that ended it.
#[derive(Clone, Copy, Debug)]
pub struct AcceptedStep<'a, R: Real = f64> {
    pub(super) system: &'a RigSystem<'a, R>,
    pub(super) of: OfSize<'a, R>,
}

/// The step of a rig alone, or with an air line, bristles or a tendon in series.
#[derive(Clone, Copy, Debug)]
pub(super) enum OfSize<'a, R: Real> {
    Rig(Of<'a, R, 4>),
    Line(Of<'a, R, MOST>),
}

/// Does the same with a step of either kind.
macro_rules! with_view {
    ($step:expr, $view:ident => $do:expr) => {
        match &$step.of {
            OfSize::Rig($view) => $do,
            OfSize::Line($view) => $do,
        }
    };
}

/// Takes each accepted step of a run in order of time; its error ends the run.
pub type Consumer<'c, R = f64> = dyn FnMut(&AcceptedStep<'_, R>) -> Result<(), Error> + 'c;

/// What holds at the end of a run.
#[derive(Clone, Debug)]
pub struct RunEnd<R: Real = f64> {
    /// The rig; under a controller its command is the table of all that the controller requested.
    pub rig: Rig<R>,
    /// The last sample.
    pub sample: Sample<R>,
    /// Steps, evaluations and events.
    pub counts: Counts,
}

/// A step from which samples can be read at times.
pub trait Readable {
    /// What is read.
    type Sample;

    /// Whether the next step begins after a time in s. Of the steps that have begun by a time the last one holds it.
    fn holds(&self, time: f64) -> bool;

    /// The sample at a time in s, kept within the step.
    fn read(&self, time: f64) -> Self::Sample;
}

/// Samples at given times of a run of known length, read as it is made: exactly those that a kept trajectory gives.
#[derive(Clone, Debug)]
pub struct Reading<I: Iterator<Item = f64>> {
    times: Peekable<I>,
    end: f64,
}

impl<I: Iterator<Item = f64>> Reading<I> {
    /// Reads at `times` in s, which do not fall, of a run of `duration` s.
    pub fn new(times: I, duration: f64) -> Self {
        Self { times: times.peekable(), end: duration }
    }

    /// Hands to `each` the samples that a step holds.
    ///
    /// # Errors
    /// Those of `each`.
    pub fn step<S: Readable + ?Sized, E>(
        &mut self,
        step: &S,
        mut each: impl FnMut(&S::Sample) -> Result<(), E>,
    ) -> Result<(), E> {
        let end = self.end;
        while let Some(time) = self.times.next_if(|time| !is_end(*time, end) && step.holds(*time)) {
            each(&step.read(time))?;
        }
        Ok(())
    }

    /// Hands to `each` the sample at the end of the run once for every time that is left.
    ///
    /// # Errors
    /// Those of `each`.
    pub fn finish<S, E>(self, last: &S, mut each: impl FnMut(&S) -> Result<(), E>) -> Result<(), E> {
        self.times.into_iter().try_for_each(|_| each(last))
    }
}

/// Simulates a rig as [`simulate`](super::simulate) does and hands each accepted step to `consumer`; nothing is kept.
///
/// # Errors
/// As [`simulate`](super::simulate), and those of the consumer, such as [`Error::Interrupted`].
pub fn simulate_into<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
    consumer: &mut Consumer<'_, R>,
) -> Result<RunEnd<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    rig.check_counts(duration.value())?;
    let mut simulation = Simulation::begin(rig.clone(), start, relative_tolerance)?;
    simulation.extend(duration, consumer)?;
    simulation.finish(consumer)
}

/// A run under way, in parts between which the rig's command may be continued.
#[derive(Debug)]
pub(crate) struct Simulation<R: Real> {
    rig: Rig<R>,
    relative_tolerance: f64,
    front: FrontOfSize<R>,
}

#[derive(Debug)]
pub(super) enum FrontOfSize<R: Real> {
    Rig(Box<Front<R, Phase<R>, EventKind, 4>>),
    Line(Box<Front<R, Phase<R>, EventKind, MOST>>),
}

/// Does the same with a front of either kind.
macro_rules! with_front {
    ($front:expr, $now:ident => $do:expr) => {
        match $front {
            FrontOfSize::Rig($now) => $do,
            FrontOfSize::Line($now) => $do,
        }
    };
}

impl<R: Real> Simulation<R> {
    /// At t = 0 in a state.
    pub(super) fn begin(rig: Rig<R>, start: State<R>, relative_tolerance: f64) -> Result<Self, Error> {
        R::begin_simulation(rig, start, relative_tolerance)
    }

    pub(crate) fn generic_begin(rig: Rig<R>, start: State<R>, relative_tolerance: f64) -> Result<Self, Error> {
        parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
        rig.check_located(&start)?;
        let system = RigSystem::new(&rig, relative_tolerance);
        let front = match rig.is_alone() {
            true => FrontOfSize::Rig(Box::new(begin(&system, start))),
            false => FrontOfSize::Line(Box::new(begin(&system, start))),
        };
        Ok(Self { rig, relative_tolerance, front })
    }

    /// Goes on to `until` s.
    pub(super) fn extend(&mut self, until: R, consumer: &mut Consumer<'_, R>) -> Result<(), Error> {
        R::extend_simulation(self, until, consumer)
    }

    pub(crate) fn generic_extend(&mut self, until: R, consumer: &mut Consumer<'_, R>) -> Result<(), Error> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let tolerance = self.relative_tolerance;
        match &mut self.front {
            FrontOfSize::Rig(front) => front.extend(&system, until, tolerance, &mut |view| {
                consumer(&AcceptedStep { system: &system, of: OfSize::Rig(*view) })
            }),
            FrontOfSize::Line(front) => front.extend(&system, until, tolerance, &mut |view| {
                consumer(&AcceptedStep { system: &system, of: OfSize::Line(*view) })
            }),
        }
    }

    /// Hands on the last step and says what holds at the end.
    pub(super) fn finish(mut self, consumer: &mut Consumer<'_, R>) -> Result<RunEnd<R>, Error> {
        self.hand_on(consumer)?;
        Ok(self.end())
    }

    /// Hands on the last step: no other follows.
    pub(super) fn hand_on(&mut self, consumer: &mut Consumer<'_, R>) -> Result<(), Error> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        match &mut self.front {
            FrontOfSize::Rig(front) => {
                front.finish(&mut |view| consumer(&AcceptedStep { system: &system, of: OfSize::Rig(*view) }))
            }
            FrontOfSize::Line(front) => {
                front.finish(&mut |view| consumer(&AcceptedStep { system: &system, of: OfSize::Line(*view) }))
            }
        }
    }

    /// What holds at the end.
    pub(super) fn end(self) -> RunEnd<R> {
        let sample = self.reached();
        let counts = with_front!(&self.front, front => front.counts());
        RunEnd { rig: self.rig, sample, counts }
    }

    /// The front of the run.
    pub(super) fn front(&self) -> &FrontOfSize<R> {
        &self.front
    }

    /// The rig, the tolerance and the front of a run that has come to its end.
    pub(super) fn into_parts(self) -> (Rig<R>, f64, FrontOfSize<R>) {
        (self.rig, self.relative_tolerance, self.front)
    }

    /// The four states at the time that has been reached.
    pub(super) fn state_reached(&self) -> State<R> {
        with_front!(&self.front, front => State::from_array(four(front.reached().1)))
    }

    /// Goes on from other states; valve, command and a pressure that is given go on as they were. For a rig without an air line
    /// or a memory.
    pub(super) fn resume(&mut self, state: State<R>) {
        R::resume_simulation(self, state);
    }

    pub(crate) fn generic_resume(&mut self, mut state: State<R>) {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        with_front!(&mut self.front, front => {
            let (time, _, phase) = *front.reached();
            if let Some([gauge, _]) = system.given(time, &phase) {
                state.pressure = GaugePressure(gauge).absolute(self.rig.actuator().air().atmosphere());
            }
            let state = system.start(state);
            front.resume(state, system.resume(time, &state, &phase));
        });
    }

    /// The sample at the time that has been reached.
    pub(super) fn reached(&self) -> Sample<R> {
        R::sample_simulation(self)
    }

    pub(crate) fn generic_reached(&self) -> Sample<R> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        with_front!(&self.front, front => {
            let (time, state, phase) = front.reached();
            sample(&system, *time, state, phase)
        })
    }

    /// The rig, whose command may be continued.
    pub(super) fn rig_mut(&mut self) -> &mut Rig<R> {
        &mut self.rig
    }
}

impl<R: Real> Rig<R> {
    /// What a kept trajectory of this rig takes in bytes for each step.
    pub fn bytes_per_step(&self) -> usize {
        match self.is_alone() {
            true => size_of::<Piece<R, Phase<R>, EventKind, 4>>(),
            false => size_of::<Piece<R, Phase<R>, EventKind, MOST>>(),
        }
    }

    /// Whether its four states are all.
    fn is_alone(&self) -> bool {
        !(self.has_plumbing() || self.actuator().friction().lugre().is_some() || self.tendon().is_some())
    }
}

/// The front of a system with `N` states at its start.
fn begin<R: Real, const N: usize>(system: &RigSystem<'_, R>, start: State<R>) -> Front<R, Phase<R>, EventKind, N> {
    let state = system.start(start);
    Front::begin(state, system.begin(&state))
}

impl<R: Real> AcceptedStep<'_, R> {
    /// The rig as it is now.
    pub fn rig(&self) -> &Rig<R> {
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
    pub fn event(&self) -> Option<Event<R>> {
        with_view!(self, view => event(view.piece))
    }

    /// The sample at `time` in s, kept within the step.
    pub fn at(&self, time: R) -> Sample<R> {
        R::read_accepted_step(self, time)
    }

    pub(crate) fn generic_at(&self, time: R) -> Sample<R> {
        let system = self.system;
        with_view!(self, view => sample(system, time, &view.at(system, time), &view.piece.mode))
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of the step: `Σ weight · f` over all steps
    /// is the integral of f over the run, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &Sample<R>, &Mode)) {
        R::quadrature_of_step(self, &mut visit);
    }

    pub(crate) fn generic_quadrature(&self, visit: &mut dyn FnMut(R, &Sample<R>, &Mode)) {
        let system = self.system;
        with_view!(self, view => view.quadrature(system, |weight, time, state, phase| {
            visit(weight, &sample(system, time, state, phase), &phase.mode);
        }));
    }

    /// Calls `visit` with the weight in s and the flows through the valve's flow paths to the supply and to the atmosphere,
    /// into hose or actuator, at the Gauss points of the step. What flows out to a pressure regulator it lets go to the
    /// atmosphere.
    pub fn valve_flows(&self, mut visit: impl FnMut(R, [Flow<R>; 2])) {
        R::valve_flows_of_step(self, &mut visit);
    }

    pub(crate) fn generic_valve_flows(&self, visit: &mut dyn FnMut(R, [Flow<R>; 2])) {
        let system = self.system;
        with_view!(self, view => view.quadrature(system, |weight, time, state, phase| {
            visit(weight, system.valve_flows(time, state, phase));
        }));
    }

    /// As [`AcceptedStep::quadrature`], with the phase, the flow between the rig, its hose included, and the supply or the
    /// atmosphere, and the friction lengths of the hysteresis.
    pub(super) fn visit(&self, mut visit: impl FnMut(R, &Sample<R>, &Phase<R>, &Flow<R>, [R; 2])) {
        let system = self.system;
        with_view!(self, view => view.quadrature(system, |weight, time, state, phase| {
            let flow = system.exchange(time, state, phase);
            visit(weight, &sample(system, time, state, phase), phase, &flow, system.widths(time, state, phase));
        }));
    }
}

impl Readable for AcceptedStep<'_> {
    type Sample = Sample;

    fn holds(&self, time: f64) -> bool {
        with_view!(self, view => view.holds(time))
    }

    fn read(&self, time: f64) -> Sample {
        self.at(time)
    }
}

impl<R: Real> AcceptedStep<'_, R> {
    /// Whether the step holds the time 0, at which a run starts.
    pub(super) fn holds_start(&self) -> bool {
        with_view!(self, view => view.holds(0.0))
    }
}

/// What ended a step of a rig.
pub(super) fn event<R: Real, const N: usize>(piece: &Piece<R, Phase<R>, EventKind, N>) -> Option<Event<R>> {
    let (kind, after) = piece.event?;
    Some(Event { time: piece.end, kind, before: piece.mode.mode, after: after.mode })
}

/// The first four of the states.
pub(super) fn four<T: Copy, const N: usize>(states: [T; N]) -> [T; 4] {
    [states[0], states[1], states[2], states[3]]
}

/// The sample of states in a phase.
pub(super) fn sample<R: Real, const N: usize>(
    system: &RigSystem<'_, R>,
    time: R,
    state: &[R; N],
    phase: &Phase<R>,
) -> Sample<R> {
    let (mode, Places { valve, supply, .. }) = (&phase.mode, system.places());
    let (tension, flow) = (system.tension(state, phase), system.inflow(time, state, phase));
    let mut own = four(*state);
    own[1] = system.velocity(time, state, phase);
    let sample = system.member().sample(time, &own, tension, mode, flow);
    let sample = sample.with_line([state[valve], system.hose_content(state)], supply.map(|place| state[place]));
    match system.far_end(state) {
        Some([load_distance, load_velocity]) => Sample { load_distance, load_velocity, ..sample },
        None => sample,
    }
}
