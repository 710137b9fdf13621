//! Steps a hybrid system through time; each step ends where a mode ends.
//!
//! Between events the method is explicit, of order 8; where the step would be bounded by stability rather than by accuracy,
//! a linearly implicit method of order 5 takes over until the mode ends or the stiffness does.
//!
//! The error of a step is the root mean square over the states of the estimated error over
//! `relative_tolerance · scale`, where the system says what the scale of a state is in its mode.
//!
//! Everything is generic over a [`Real`] scalar: with dual numbers the trajectory carries its exact derivatives with
//! respect to any parameter, through every event. Decisions depend on values alone; steps are short enough for the
//! derivatives too.

use super::allowed::Allowed;
use super::arc::{Arc, POINTS};
use super::event::{self, Crossing, MAX_EVENTS_IN_AN_INSTANT, Room};
use super::{GuardForm, Halt, Hybrid, explicit, implicit};
use crate::dual::Dual;
use crate::error::Error;
use crate::scalar::{Real, Scalar};
use crate::valve::SIMULTANEOUS;
use alloc::vec;
use alloc::vec::Vec;

/// What a simulation cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Accepted steps of the explicit method.
    pub explicit_steps: u64,
    /// Accepted steps of the implicit method.
    pub implicit_steps: u64,
    /// Steps that were tried and repeated with a shorter length.
    pub rejected_steps: u64,
    /// Evaluations of the rates, those for Jacobians included.
    pub evaluations: u64,
    /// Events, instants included.
    pub events: u64,
}

/// A stretch of time within one mode: one step, cut where an event ended it.
pub struct Piece<'i, R, M, K> {
    /// The states over the step; valid from its start to `end`.
    pub arc: &'i Arc<R>,
    /// End of the piece in s.
    pub end: R,
    /// What ended it, and the mode after that; `None` when the step simply was over.
    pub event: Option<(K, &'i M)>,
}

/// How a run was going where it paused: what it needs in addition to state and mode to go on as if it had not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// Length of the next step in s; none before the first.
    step: Option<f64>,
    is_new: bool,
    is_implicit: bool,
    stiff_steps: u32,
    refused: u32,
    implicit_run: u32,
    events_here: u32,
    /// Where progress is measured from: attempted steps, and the time in s.
    measured_from: (u64, f64),
    statistics: Statistics,
}

impl Pace {
    /// Before the first step of a run that starts at a time in s.
    pub(crate) fn begin(time: f64) -> Self {
        Self {
            step: None,
            is_new: true,
            is_implicit: false,
            stiff_steps: 0,
            refused: 0,
            implicit_run: 0,
            events_here: 0,
            measured_from: (0, time),
            statistics: Statistics::default(),
        }
    }

    /// How it goes on from other states: without a step length, with the cost so far.
    pub(crate) fn restarted(&self) -> Self {
        Self { measured_from: self.measured_from, statistics: self.statistics, ..Self::begin(0.0) }
    }

    /// What it has cost so far.
    pub(crate) fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Adds to what it has cost.
    pub(crate) fn add(&mut self, more: Statistics) {
        let all = &mut self.statistics;
        all.explicit_steps += more.explicit_steps;
        all.implicit_steps += more.implicit_steps;
        all.rejected_steps += more.rejected_steps;
        all.evaluations += more.evaluations;
        all.events += more.events;
    }
}

/// Largest and smallest change of the step length from one step to the next, and the safety factor.
const GROWTH: (f64, f64, f64) = (6.0, 0.2, 0.9);
/// `h` times the fastest rate up to which the dense output of the explicit method follows a settling state to the
/// tolerance: what is aimed at, and what is refused in hindsight. The method itself would be stable to about 6.
const SETTLING: (f64, f64) = (2.0, 4.0);
/// Steps in a row that [`SETTLING`] and not accuracy has bounded, after which the implicit method takes over; one in which
/// accuracy would allow [`STIFF_RATIO`] times as much counts for several. The implicit method is of lower order and costs
/// more by the step.
const STIFF_STEPS: u32 = 40;
const CLEARLY_STIFF: u32 = 10;
const STIFF_RATIO: f64 = 4.0;
/// What a refused explicit step counts: for its error, and for what settles far faster at its end than at its beginning. A step that is
/// kept takes one off, and from [`MOST_REFUSED`] on the implicit method takes over as well: only what is stiff has so many refused.
const REFUSED: [u32; 2] = [2, 6];
const MOST_REFUSED: u32 = 40;
/// Steps in which the implicit method may grow before it is judged.
const GROWING: u32 = 6;

/// Attempted steps in which time must advance by [`LEAST_ADVANCE`] s, so that no run goes on without progress: the air of
/// a hose of a millimetre needs about 10⁶ steps in a second.
const CRAWL_STEPS: u64 = 100_000;
const LEAST_ADVANCE: f64 = 1e-4;

/// Steps a system through time; each call of [`Integrator::advance`] makes the next piece.
pub struct Integrator<'a, R: Real, S: Hybrid<R>> {
    system: &'a S,
    until: R,
    time: R,
    /// States, padded as the stages are.
    state: Vec<R>,
    states: usize,
    mode: S::Mode,
    guards: Vec<(S::Guard, GuardForm<R>)>,
    instant: Option<R>,
    slope: Vec<R>,
    has_slope: bool,
    /// Part of a state's own time scale that the first step in a mode takes.
    first_part: f64,
    /// Whether an instant has just made the last step length meaningless.
    fresh: bool,
    /// Whether the mode has just begun.
    is_new: bool,
    step: f64,
    is_implicit: bool,
    /// Whether the last step was made by the explicit method.
    by_explicit: bool,
    stiff_steps: u32,
    /// What refused explicit steps have counted, less those that were kept.
    refused: u32,
    implicit_run: u32,
    events_here: u32,
    /// Where progress is measured from: attempted steps, and the time in s.
    measured_from: (u64, f64),
    statistics: Statistics,
    explicit: explicit::Attempt<R>,
    implicit: implicit::Attempt<R>,
    allowed: Allowed,
    scales: Vec<f64>,
    work: S::Work<R>,
    along: S::Work<Dual<R, 1>>,
    room: Vec<R>,
    nodes: Vec<R>,
    seeded: Vec<Dual<R, 1>>,
    seeded_rates: Vec<Dual<R, 1>>,
    /// The piece that was made last.
    arc: Arc<R>,
    end: R,
    event: Option<S::Kind>,
}

impl<'a, R: Real, S: Hybrid<R>> Integrator<'a, R, S> {
    /// Starts at `time` in a state and mode, to go on until `until` (s) with a relative tolerance for each step.
    pub fn new(system: &'a S, time: R, state: &[R], mode: S::Mode, until: R, relative_tolerance: f64) -> Self {
        let states = system.states();
        let explicit = explicit::Attempt::new(states);
        let mut padded = vec![R::zero(); explicit.end.len()];
        padded[..states].copy_from_slice(&state[..states]);
        let zero = Dual::<R, 1>::constant(0.0);
        let mut integrator = Self {
            system,
            until,
            time,
            slope: vec![R::zero(); padded.len()],
            state: padded,
            states,
            mode,
            guards: Vec::new(),
            instant: None,
            has_slope: false,
            first_part: 4.0 * eighth_root(relative_tolerance),
            fresh: true,
            is_new: true,
            step: (until - time).value(),
            is_implicit: false,
            by_explicit: false,
            stiff_steps: 0,
            refused: 0,
            implicit_run: 0,
            events_here: 0,
            measured_from: (0, time.value()),
            statistics: Statistics::default(),
            explicit,
            implicit: implicit::Attempt::new(states),
            allowed: Allowed::new::<R>(states, relative_tolerance, system.influences()),
            scales: vec![0.0; states],
            work: system.work(),
            along: system.work(),
            room: vec![R::zero(); states],
            nodes: Vec::new(),
            seeded: vec![zero; states],
            seeded_rates: vec![zero; states],
            arc: Arc::new(states),
            end: time,
            event: None,
        };
        integrator.enter_mode();
        integrator
    }

    /// Goes on from a time (s), state and mode where a run paused, as [`Integrator::new`] starts.
    pub(crate) fn resume(
        system: &'a S,
        (time, state, mode): (R, &[R], S::Mode),
        until: R,
        relative_tolerance: f64,
        pace: Pace,
    ) -> Self {
        let mut integrator = Self::new(system, time, state, mode, until, relative_tolerance);
        if let Some(step) = pace.step {
            (integrator.step, integrator.fresh, integrator.is_new) = (step, false, pace.is_new);
            (integrator.is_implicit, integrator.stiff_steps) = (pace.is_implicit, pace.stiff_steps);
            integrator.refused = pace.refused;
        }
        (integrator.implicit_run, integrator.events_here) = (pace.implicit_run, pace.events_here);
        (integrator.measured_from, integrator.statistics) = (pace.measured_from, pace.statistics);
        integrator
    }

    /// How it is going.
    pub(crate) fn pace(&self) -> Pace {
        Pace {
            step: (!self.fresh).then_some(self.step),
            is_new: self.is_new,
            is_implicit: self.is_implicit,
            stiff_steps: self.stiff_steps,
            refused: self.refused,
            implicit_run: self.implicit_run,
            events_here: self.events_here,
            measured_from: self.measured_from,
            statistics: self.statistics,
        }
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.time
    }

    /// The states at that time, after any event there.
    pub fn state(&self) -> &[R] {
        &self.state[..self.states]
    }

    /// The mode at that time, after any event there.
    pub fn mode(&self) -> &S::Mode {
        &self.mode
    }

    /// What it has cost so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// The piece that was made last.
    pub fn piece(&self) -> Piece<'_, R, S::Mode, S::Kind> {
        Piece { arc: &self.arc, end: self.end, event: self.event.map(|kind| (kind, &self.mode)) }
    }

    fn enter_mode(&mut self) {
        self.is_new = true;
        self.system.guards(&self.mode, &mut self.guards);
        self.instant = self.system.next_instant(&self.mode, self.until);
        self.has_slope = false;
        self.is_implicit = false;
        (self.stiff_steps, self.refused) = (0, 0);
    }

    /// Makes the next piece; whether there was one before the end.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step length falls below the resolution of time, when events do not let time advance,
    /// or when the system itself cannot go on.
    pub fn advance(&mut self) -> Result<bool, Error> {
        let last_event = self.event.take();
        self.check_progress(last_event)?;
        let stop = self.instant.unwrap_or(self.until);
        if reached(self.time, stop) {
            if self.instant.is_none() {
                return Ok(false);
            }
            for index in 0..POINTS {
                self.arc.point_mut(index).copy_from_slice(&self.state[..self.states]);
            }
            (self.arc.start, self.arc.step) = (self.time, R::one());
            self.pass_instant()?;
            return Ok(true);
        }
        self.enter_slope();
        loop {
            let room = (stop - self.time).value();
            // The last step before a stop is not left to be a sliver.
            let step = if self.step >= 0.999 * room { room } else { Scalar::smaller(self.step, 0.5 * room) };
            let shortest = 4.0 * f64::EPSILON * self.time.value().abs();
            if step.is_nan() || step <= shortest {
                return Err(self.system.halts(self.time, self.state(), Halt::Step(self.fastest()), last_event));
            }
            // A stop is reached exactly, derivative included.
            let (length, end_time) = if step == room {
                (stop - self.time, stop)
            } else {
                (R::constant(step), self.time + R::constant(step))
            };
            self.by_explicit = !self.is_implicit;
            let kept = if self.is_implicit { self.try_implicit(length) } else { self.try_explicit(length) };
            if kept {
                let room = Room {
                    state: &mut self.room,
                    nodes: &mut self.nodes,
                    work: &mut self.work,
                    seeded: &mut self.seeded,
                    along: &mut self.along,
                };
                match event::first(self.system, &self.mode, &self.guards, &self.arc, room) {
                    Ok(crossing) => {
                        self.accept(end_time, crossing)?;
                        return Ok(true);
                    }
                    Err(event::NoValue) => {
                        self.step = 0.25 * length.value();
                        self.has_slope = true;
                    }
                }
            }
            self.statistics.rejected_steps += 1;
        }
    }

    /// That the last many steps have brought the time on.
    fn check_progress(&mut self, last_event: Option<S::Kind>) -> Result<(), Error> {
        let Statistics { explicit_steps, implicit_steps, rejected_steps, events, .. } = self.statistics;
        let steps = explicit_steps + implicit_steps + rejected_steps + events;
        let (from, since) = self.measured_from;
        if steps < from + CRAWL_STEPS {
            return Ok(());
        }
        let advance = self.time.value() - since;
        if advance < LEAST_ADVANCE {
            return Err(self.system.halts(self.time, self.state(), Halt::Crawls(advance), last_event));
        }
        self.measured_from = (steps, self.time.value());
        Ok(())
    }

    /// Computes the rates at the current state, once for a state and mode.
    fn enter_slope(&mut self) {
        if self.has_slope {
            return;
        }
        let states = self.states;
        let (system, mode) = (self.system, &self.mode);
        system.rates(self.time, &self.state[..states], mode, &mut self.work, &mut self.slope[..states]);
        self.statistics.evaluations += 1;
        self.has_slope = true;
        self.enter_scales();
        let first = if core::mem::take(&mut self.is_new) { self.first_step() } else { f64::INFINITY };
        self.step = if self.fresh { first } else { Scalar::smaller(self.step, first) };
        self.fresh = false;
        if !self.is_implicit {
            let settling = self.system.settling_rate(&self.state[..states], &self.mode, &mut self.work);
            self.step = Scalar::smaller(self.step, SETTLING.0 / settling);
        }
    }

    /// Computes the scales of the states, and the errors that the tolerance allows in a step.
    fn enter_scales(&mut self) {
        self.system.scales(&self.state[..self.states], &self.mode, &mut self.scales);
        self.allowed.enter(&self.scales, &self.state[..self.states]);
    }

    /// A first step in a new mode: a part of the time in which the rates would change a state by its own size.
    fn first_step(&self) -> f64 {
        let mut fastest: f64 = 0.0;
        for (slope, scale) in self.slope.iter().zip(&self.scales) {
            fastest = fastest.max(slope.value().abs() / scale);
        }
        if fastest > 0.0 { self.first_part / fastest } else { f64::INFINITY }
    }

    /// The state that changes fastest for its scale, or that has no rate.
    fn fastest(&self) -> usize {
        let speeds = self.slope.iter().zip(&self.scales).map(|(slope, scale)| slope.value().abs() / scale);
        let speeds = speeds.map(|speed| if speed.is_nan() { f64::INFINITY } else { speed });
        speeds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(place, _)| place)
    }

    fn try_explicit(&mut self, length: R) -> bool {
        let states = self.states;
        let (system, mode, work) = (self.system, &self.mode, &mut self.work);
        let mut rates = |time: R, state: &[R], rates: &mut [R]| system.rates(time, state, mode, work, rates);
        self.explicit.attempt(self.time, &self.state, &self.slope, length, &self.allowed, &mut rates);
        self.statistics.evaluations += explicit::EVALUATIONS[0];
        if !control(&mut self.step, length.value(), self.explicit.error, eighth_root) {
            return self.refuse(REFUSED[0]);
        }
        self.explicit.finish(self.time, length, states, &mut rates);
        self.statistics.evaluations += explicit::EVALUATIONS[1];
        let end = &self.explicit.end[..states];
        let settling = self.system.settling_rate(end, &self.mode, &mut self.work);
        let bound = SETTLING.0 / settling;
        if length.value() * settling > SETTLING.1 {
            self.step = bound;
            return self.refuse(REFUSED[1]);
        }
        let (system, mode, work) = (self.system, &self.mode, &mut self.work);
        let rates = |time: R, state: &[R], rates: &mut [R]| system.rates(time, state, mode, work, rates);
        self.explicit.dense(self.time, &self.state, length, &mut self.arc, rates);
        self.statistics.evaluations += explicit::EVALUATIONS[2];
        if !self.arc.is_finite() {
            // A stage of the dense output alone is not physical.
            self.step = 0.25 * length.value();
            return false;
        }
        self.statistics.explicit_steps += 1;
        self.refused = self.refused.saturating_sub(1);
        self.stiff_steps = match self.step / bound {
            ratio if ratio > STIFF_RATIO => self.stiff_steps + CLEARLY_STIFF,
            ratio if ratio >= 1.0 => self.stiff_steps + 1,
            _ => 0,
        };
        self.is_implicit = self.stiff_steps >= STIFF_STEPS;
        self.implicit_run = 0;
        if !self.is_implicit {
            self.step = Scalar::smaller(self.step, bound);
        }
        true
    }

    /// Refuses an explicit step, which counts so much.
    fn refuse(&mut self, count: u32) -> bool {
        self.refused += count;
        self.is_implicit = self.refused >= MOST_REFUSED;
        false
    }

    fn try_implicit(&mut self, length: R) -> bool {
        let states = self.states;
        self.implicit.linearise(
            self.system,
            self.time,
            &self.state[..states],
            &self.mode,
            (&mut self.seeded, &mut self.along),
            &mut self.seeded_rates,
        );
        let (system, mode, work) = (self.system, &self.mode, &mut self.work);
        let rates = |time: R, state: &[R], rates: &mut [R]| system.rates(time, state, mode, work, rates);
        self.implicit.attempt(self.time, &self.state, &self.slope, length, &self.allowed, rates);
        self.statistics.evaluations += implicit::EVALUATIONS + states as u64 + 1;
        if !control(&mut self.step, length.value(), self.implicit.error, fifth_root) {
            return false;
        }
        self.implicit.dense(self.time, &self.state, length, &mut self.arc);
        if !self.arc.is_finite() {
            self.step = 0.25 * length.value();
            return false;
        }
        self.statistics.implicit_steps += 1;
        // Back to the explicit method if, given time to grow, the steps stay near those that are stable for it.
        self.implicit_run += 1;
        if self.implicit_run > GROWING
            && length.value() * self.implicit.fastest_rate(&self.scales) < STIFF_RATIO * SETTLING.0
        {
            self.is_implicit = false;
            (self.stiff_steps, self.refused) = (0, 0);
        }
        true
    }

    fn accept(&mut self, end_time: R, crossing: Option<Crossing<S::Guard, R>>) -> Result<(), Error> {
        let states = self.states;
        if let Some(Crossing { guard, theta }) = crossing {
            let before = self.time.value();
            self.time = self.time + theta * self.arc.step;
            self.arc.at(theta, &mut self.state[..states]);
            self.system.project(self.time, &mut self.state[..states], &self.mode, &mut self.work);
            let kind =
                self.system.cross(guard, self.time, &mut self.state[..states], &mut self.mode, &mut self.work)?;
            self.count_event(before, kind)?;
            self.enter_mode();
            (self.end, self.event) = (self.time, Some(kind));
            return Ok(());
        }
        let used_explicit = self.by_explicit;
        self.time = end_time;
        for n in 0..states {
            self.state[n] = self.arc.points[7 * states + n];
        }
        self.system.project(self.time, &mut self.state[..states], &self.mode, &mut self.work);
        self.events_here = 0;
        self.end = self.time;
        if self.instant.is_some_and(|instant| reached(self.time, instant)) {
            return self.pass_instant();
        }
        // The rates at the end are the next step's first; what was projected has moved by no more than the tolerance.
        self.has_slope = used_explicit;
        if used_explicit {
            self.explicit.last(&mut self.slope);
            self.enter_scales();
        }
        Ok(())
    }

    /// Goes on to an instant that has come. Two instants of one value may differ in their derivatives: between them the state
    /// moves by its rates, as it would between instants that are apart.
    fn go_to(&mut self, instant: R) {
        if R::HAS_DERIVATIVES {
            let states = self.states;
            let (system, mode) = (self.system, &self.mode);
            system.rates(self.time, &self.state[..states], mode, &mut self.work, &mut self.slope[..states]);
            let apart = instant - self.time;
            for n in 0..states {
                self.state[n] = self.state[n] + self.slope[n] * apart;
            }
        }
        self.time = instant;
    }

    /// Passes the instant at the current time.
    fn pass_instant(&mut self) -> Result<(), Error> {
        let (before, states) = (self.time.value(), self.states);
        if let Some(instant) = self.instant {
            self.go_to(instant);
        }
        let kind = self.system.pass_instant(self.time, &mut self.state[..states], &mut self.mode, &mut self.work)?;
        self.count_event(before, kind)?;
        self.enter_mode();
        self.fresh = true;
        (self.end, self.event) = (self.time, Some(kind));
        Ok(())
    }

    fn count_event(&mut self, before: f64, event: S::Kind) -> Result<(), Error> {
        self.statistics.events += 1;
        let advanced = self.time.value() - before > SIMULTANEOUS * before.abs();
        self.events_here = if advanced { 0 } else { self.events_here + 1 };
        if self.events_here > MAX_EVENTS_IN_AN_INSTANT {
            return Err(self.system.halts(self.time, self.state(), Halt::Events, Some(event)));
        }
        Ok(())
    }
}

/// Sets the next step length from the error of this one; whether this one may be kept.
fn control(next: &mut f64, length: f64, error: f64, root: fn(f64) -> f64) -> bool {
    let (largest, smallest, safety) = GROWTH;
    if !error.is_finite() {
        *next = 0.25 * length;
        return false;
    }
    let factor = if error > 0.0 { safety / root(error) } else { largest };
    let kept = error <= 1.0;
    let proposal = length * factor.clamp(smallest, if kept { largest } else { 1.0 });
    // A step cut short to meet a stop says little about what is possible.
    *next = if kept && length < 0.99 * *next { next.max(proposal) } else { proposal };
    kept
}

/// Whether a time has come to an instant, up to the rounding of either.
fn reached<R: Real>(time: R, instant: R) -> bool {
    let (time, instant) = (time.value(), instant.value());
    time >= instant - SIMULTANEOUS * instant.abs()
}

fn eighth_root(x: f64) -> f64 {
    Scalar::sqrt(Scalar::sqrt(Scalar::sqrt(x)))
}

fn fifth_root(x: f64) -> f64 {
    Scalar::power(x, 0.2)
}
