//! The event-located integrator: adaptive steps that end where a mode ends.
//!
//! Each step is taken by the formulas of one mode, kept as a polynomial ([`Arc`]), and searched for events; the first
//! event cuts it. Between events the method is explicit, of order 8; where the step would be bounded by stability rather
//! than by accuracy, a linearly implicit method of order 5 takes over until the mode ends or the stiffness does.
//!
//! The error of a step is the root mean square over the states of the estimated error over
//! `relative_tolerance · scale`, where the system says what the scale of a state is in its mode.
//!
//! Everything is generic over a [`Real`] scalar: with dual numbers the trajectory carries its exact derivatives with
//! respect to any parameter, through every event. Step sizes and decisions look at values alone.

use super::arc::Arc;
use super::event::{self, Crossing, MAX_EVENTS_IN_AN_INSTANT};
use super::system::{Guards, HybridSystem};
use super::{explicit, rosenbrock};
use crate::error::Error;
use crate::scalar::{Real, Scalar};
use crate::valve::SIMULTANEOUS;

/// What a simulation cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
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

#[cfg(feature = "alloc")]
impl Counts {
    /// The cost of one after the other.
    pub(super) fn and(self, next: Self) -> Self {
        Self {
            explicit_steps: self.explicit_steps + next.explicit_steps,
            implicit_steps: self.implicit_steps + next.implicit_steps,
            rejected_steps: self.rejected_steps + next.rejected_steps,
            evaluations: self.evaluations + next.evaluations,
            events: self.events + next.events,
        }
    }
}

/// A stretch of time within one mode: one step, cut where an event ended it.
#[derive(Clone, Copy, Debug)]
pub struct Piece<R, M, K, const N: usize> {
    /// The states over the step; valid from its start to `end`.
    pub arc: Arc<R, N>,
    /// The mode during the step.
    pub mode: M,
    /// End of the piece in s.
    pub end: R,
    /// What ended it, and the mode after that; `None` when the step simply was over.
    pub event: Option<(K, M)>,
}

/// The piece of a system's trajectory that a step gives.
pub type PieceOf<R, S, const N: usize> = Piece<R, <S as HybridSystem<R, N>>::Mode, <S as HybridSystem<R, N>>::Kind, N>;

/// Steps a system through time; each call of [`Integrator::advance`] gives the next piece.
pub struct Integrator<'a, R: Real, const N: usize, S: HybridSystem<R, N>> {
    system: &'a S,
    relative_tolerance: f64,
    until: R,
    time: R,
    state: [R; N],
    mode: S::Mode,
    guards: Guards<S::Guard>,
    instant: Option<R>,
    slope: Option<[R; N]>,
    /// Part of a state's own time scale that the first step in a mode takes.
    first_part: f64,
    /// Whether an instant has just made the last step length meaningless.
    fresh: bool,
    explicit: explicit::Attempt<R, N>,
    step: f64,
    implicit: bool,
    stiff_steps: u32,
    implicit_run: u32,
    events_here: u32,
    counts: Counts,
}

/// Largest and smallest change of the step length from one step to the next, and the safety factor.
const GROWTH: (f64, f64, f64) = (6.0, 0.2, 0.9);
/// `h` times the fastest rate up to which the dense output of the explicit method follows a settling state to the
/// tolerance: what is aimed at, and what is refused in hindsight. The method itself would be stable to about 6.
const SETTLING: (f64, f64) = (2.0, 4.0);
/// Steps in a row that [`SETTLING`] and not accuracy has bounded, after which the implicit method takes over; one in which
/// accuracy would allow [`STIFF_RATIO`] times as much counts for several. The implicit method is of lower order and dearer
/// by the step.
const STIFF_STEPS: u32 = 40;
const CLEARLY_STIFF: u32 = 10;
const STIFF_RATIO: f64 = 4.0;
/// Steps in which the implicit method may grow before it is judged.
const GROWING: u32 = 6;

impl<'a, R: Real, const N: usize, S: HybridSystem<R, N>> Integrator<'a, R, N, S> {
    /// Starts at `time` in a state and mode, to go on until `until` (s) with a relative tolerance for each step.
    pub fn new(system: &'a S, time: R, state: [R; N], mode: S::Mode, until: R, relative_tolerance: f64) -> Self {
        let mut integrator = Self {
            system,
            relative_tolerance,
            until,
            time,
            state,
            mode,
            guards: Guards::new(),
            instant: None,
            slope: None,
            first_part: 4.0 * eighth_root(relative_tolerance),
            fresh: true,
            explicit: explicit::Attempt::new(),
            step: (until - time).value(),
            implicit: false,
            stiff_steps: 0,
            implicit_run: 0,
            events_here: 0,
            counts: Counts::default(),
        };
        integrator.enter_mode();
        integrator
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.time
    }

    /// The states at [`Integrator::time`], after any event there.
    pub fn state(&self) -> &[R; N] {
        &self.state
    }

    /// The mode at [`Integrator::time`], after any event there.
    pub fn mode(&self) -> &S::Mode {
        &self.mode
    }

    /// What it has cost so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    fn enter_mode(&mut self) {
        self.guards = self.system.guards(&self.mode);
        self.instant = self.system.next_instant(&self.mode, self.until);
        self.slope = None;
        self.implicit = false;
        self.stiff_steps = 0;
    }

    /// The next piece, or `None` at the end.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step length falls below the resolution of time, when events do not let time advance,
    /// or when the system itself cannot go on.
    pub fn advance(&mut self) -> Result<Option<PieceOf<R, S, N>>, Error> {
        let stop = self.instant.unwrap_or(self.until);
        if reached(self.time, stop) {
            return if self.instant.is_some() { self.pass_instant().map(Some) } else { Ok(None) };
        }
        let slope = self.current_slope();
        loop {
            let room = (stop - self.time).value();
            // The last step before a stop is not left to be a sliver.
            let step = if self.step >= 0.999 * room { room } else { self.step.min(0.5 * room) };
            if step <= 4.0 * f64::EPSILON * self.time.value().abs() {
                return Err(self.system.stuck(self.time, &self.state, &self.mode));
            }
            // A stop is reached exactly, derivative included.
            let (length, end_time) = if step == room {
                (stop - self.time, stop)
            } else {
                (R::constant(step), self.time + R::constant(step))
            };
            let tried =
                if self.implicit { self.try_implicit(&slope, length) } else { self.try_explicit(&slope, length) };
            if let Some((arc, end)) = tried {
                match event::first_crossing(self.system, &self.mode, &self.guards, &arc) {
                    Ok(crossing) => return self.accept(arc, end, end_time, crossing).map(Some),
                    Err(event::NoValue) => (self.step, self.slope) = (0.25 * length.value(), Some(slope)),
                }
            }
            self.counts.rejected_steps += 1;
        }
    }

    /// Rates at the current state, computed once for a state and mode.
    fn current_slope(&mut self) -> [R; N] {
        if let Some(slope) = self.slope {
            return slope;
        }
        let slope = self.system.rates(self.time, &self.state, &self.mode);
        self.counts.evaluations += 1;
        self.slope = Some(slope);
        let first = self.first_step(&slope);
        self.step = if self.fresh { first } else { self.step.min(first) };
        self.fresh = false;
        if !self.implicit {
            let settling = self.system.settling_rate(self.time, &self.state, &self.mode);
            self.step = self.step.min(SETTLING.0 / settling);
        }
        slope
    }

    fn scales(&self) -> [f64; N] {
        self.system.scales(&self.state, &self.mode)
    }

    /// A first step in a new mode: a part of the time in which the rates would change a state by its own size.
    fn first_step(&self, slope: &[R; N]) -> f64 {
        let scales = self.scales();
        let fastest = (0..self.system.states()).map(|n| slope[n].value().abs() / scales[n]).fold(0.0, f64::max);
        if fastest > 0.0 { self.first_part / fastest } else { f64::INFINITY }
    }

    /// Errors that the tolerance allows in a step.
    fn allowed(&self) -> [f64; N] {
        self.scales().map(|scale| self.relative_tolerance * scale)
    }

    fn try_explicit(&mut self, slope: &[R; N], length: R) -> Option<(Arc<R, N>, [R; N])> {
        let (system, mode) = (self.system, self.mode);
        let rates = |time: R, state: &[R; N]| system.rates(time, state, &mode);
        let allowed = self.allowed();
        self.explicit.attempt(self.time, &self.state, slope, length, &allowed[..system.states()], rates);
        self.counts.evaluations += explicit::EVALUATIONS.0;
        if !self.control(length.value(), self.explicit.error, eighth_root) {
            return None;
        }
        let end = self.explicit.end;
        let settling = self.system.settling_rate(self.time + length, &end, &mode);
        let bound = SETTLING.0 / settling;
        if length.value() * settling > SETTLING.1 {
            self.step = bound;
            return None;
        }
        let (arc, slope) = self.explicit.accept(self.time, &self.state, length, rates);
        self.counts.evaluations += explicit::EVALUATIONS.1;
        if !arc.is_finite() {
            // A stage of the dense output alone left the physics.
            self.step = 0.25 * length.value();
            return None;
        }
        self.counts.explicit_steps += 1;
        self.slope = Some(slope);
        self.stiff_steps = match self.step / bound {
            ratio if ratio > STIFF_RATIO => self.stiff_steps + CLEARLY_STIFF,
            ratio if ratio >= 1.0 => self.stiff_steps + 1,
            _ => 0,
        };
        self.implicit = self.stiff_steps >= STIFF_STEPS;
        self.implicit_run = 0;
        if !self.implicit {
            self.step = self.step.min(bound);
        }
        Some((arc, end))
    }

    fn try_implicit(&mut self, slope: &[R; N], length: R) -> Option<(Arc<R, N>, [R; N])> {
        let (system, mode) = (self.system, self.mode);
        let linear = rosenbrock::Linearisation::at(self.time, &self.state, system.states(), |time, state| {
            system.rates(time, state, &mode)
        });
        let allowed = self.allowed();
        let attempt = rosenbrock::attempt(self.time, &self.state, slope, &linear, length, &allowed, |time, state| {
            system.rates(time, state, &mode)
        });
        self.counts.evaluations += rosenbrock::EVALUATIONS + system.states() as u64 + 1;
        if !self.control(length.value(), attempt.error, fifth_root) {
            return None;
        }
        self.counts.implicit_steps += 1;
        let arc = attempt.arc(self.time, &self.state, length);
        self.slope = None;
        // Back to the explicit method if, given time to grow, the steps stay near those that are stable for it.
        self.implicit_run += 1;
        if self.implicit_run > GROWING
            && length.value() * linear.fastest_rate(&self.scales()) < STIFF_RATIO * SETTLING.0
        {
            self.implicit = false;
            self.stiff_steps = 0;
        }
        Some((arc, attempt.end))
    }

    /// Sets the next step length from the error of this one; whether this one may be kept.
    fn control(&mut self, length: f64, error: f64, root: fn(f64) -> f64) -> bool {
        let (largest, smallest, safety) = GROWTH;
        if !error.is_finite() {
            self.step = 0.25 * length;
            return false;
        }
        let factor = if error > 0.0 { safety / root(error) } else { largest };
        let kept = error <= 1.0;
        let proposal = length * factor.clamp(smallest, if kept { largest } else { 1.0 });
        // A step cut short to meet a stop says little about what is possible.
        self.step = if kept && length < 0.99 * self.step { self.step.max(proposal) } else { proposal };
        kept
    }

    fn accept(
        &mut self,
        arc: Arc<R, N>,
        end: [R; N],
        end_time: R,
        crossing: Option<Crossing<S::Guard, R>>,
    ) -> Result<PieceOf<R, S, N>, Error> {
        let mode = self.mode;
        if let Some(Crossing { guard, theta }) = crossing {
            let before = self.time.value();
            self.time = self.time + theta * arc.step;
            self.state = arc.at(theta);
            self.system.project(self.time, &mut self.state, &mode);
            let kind = self.system.cross(guard, self.time, &mut self.state, &mut self.mode)?;
            self.count_event(before)?;
            self.enter_mode();
            return Ok(Piece { arc, mode, end: self.time, event: Some((kind, self.mode)) });
        }
        self.time = end_time;
        self.state = end;
        self.system.project(self.time, &mut self.state, &mode);
        self.events_here = 0;
        if self.instant.is_some_and(|instant| reached(self.time, instant)) {
            let passed = self.pass_instant()?;
            return Ok(Piece { arc, mode, end: self.time, event: passed.event });
        }
        Ok(Piece { arc, mode, end: self.time, event: None })
    }

    /// Passes the instant at the current time: a piece without length.
    fn pass_instant(&mut self) -> Result<PieceOf<R, S, N>, Error> {
        let (before, mode) = (self.time.value(), self.mode);
        let arc = Arc { start: self.time, step: R::one(), points: [self.state; super::arc::POINTS] };
        if let Some(instant) = self.instant {
            self.time = instant;
        }
        let kind = self.system.pass_instant(self.time, &mut self.state, &mut self.mode)?;
        self.count_event(before)?;
        self.enter_mode();
        self.fresh = true;
        Ok(Piece { arc, mode, end: self.time, event: Some((kind, self.mode)) })
    }

    fn count_event(&mut self, before: f64) -> Result<(), Error> {
        self.counts.events += 1;
        let advanced = self.time.value() - before > SIMULTANEOUS * before.abs();
        self.events_here = if advanced { 0 } else { self.events_here + 1 };
        if self.events_here > MAX_EVENTS_IN_AN_INSTANT {
            return Err(self.system.stuck(self.time, &self.state, &self.mode));
        }
        Ok(())
    }
}

fn eighth_root(x: f64) -> f64 {
    Scalar::sqrt(Scalar::sqrt(Scalar::sqrt(x)))
}

fn fifth_root(x: f64) -> f64 {
    Scalar::exp(Scalar::ln(x) / 5.0)
}

/// Whether a time has come to an instant, up to the rounding of either.
fn reached<R: Real>(time: R, instant: R) -> bool {
    let (time, instant) = (time.value(), instant.value());
    time >= instant - SIMULTANEOUS * instant.abs()
}
