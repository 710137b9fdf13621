//! From one instant to the next: parts of a step that end where a mode ends.
//!
//! The mode at the beginning of a part is taken to last to its end. Where a guard is below zero by then, the place at which the
//! first of them comes to zero is searched for; each trial is one step of the method from the beginning of the part. There
//! the plant crosses the guard, and the rest of the step follows in the new mode.
//!
//! A guard that begins at zero, from rest or on a limit, is first evaluated a little after the beginning, and then over the
//! part of the step: that has no root at the beginning.

use super::super::Plant;
use super::super::crossing::PlantEventKind;
use super::super::evaluation::{Evaluation, System};
use super::super::guard::PlantGuard;
use super::super::mode::{ActuatorMode, MechanismMode, PlantMode};
use super::super::run::{Keep, PlantSnapshot};
use super::method::Stages;
use super::pieces::is_between_pieces;
use crate::engine::{Arc, GuardForm, Piece, Statistics};
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::root::Search;
use crate::scalar::Real;
use crate::simulation::Method;
use alloc::vec;
use alloc::vec::Vec;

/// Events within a part after which the rest of the step is taken as it is: so many for each actuator and mechanism.
const MOST_EVENTS: usize = 4;
/// Part of a step by which the last trial may move an event: the remaining error is far smaller, since each error of
/// the search is of the order of the product of those before.
const LOCATION_TOLERANCE: f64 = 1e-5;
/// Part of a step after which a guard that begins at zero is first evaluated.
const FROM_REST: f64 = 1e-3;
/// Trials after which an event is taken to be where the last one was.
const MOST_TRIALS: usize = 60;

/// How the steps of a plant go on: what ends its mode, and what they have cost.
#[derive(Clone, Debug)]
pub(super) struct Course<R> {
    /// The guards that end the mode with an event, as long as it lasts.
    guards: Vec<(PlantGuard, GuardForm<R>)>,
    has_guards: bool,
    pub(super) statistics: Statistics,
}

impl<R> Default for Course<R> {
    fn default() -> Self {
        Self { guards: Vec::new(), has_guards: false, statistics: Statistics::default() }
    }
}

impl<R: Instantiate> Course<R> {
    /// Notes that a mode has been changed by others.
    pub(super) fn forget_guards(&mut self) {
        self.has_guards = false;
    }

    /// The guards that end a mode with an event, listed unless they are known.
    pub(super) fn guards(&mut self, system: &System<R>, mode: &PlantMode<R>) -> &[(PlantGuard, GuardForm<R>)] {
        if !self.has_guards {
            system.guards(mode, &mut self.guards);
            self.guards.retain(|(guard, _)| !is_between_pieces(*guard));
            self.has_guards = true;
        }
        &self.guards
    }
}

/// What a step computes with: allocated once, for all plants of one structure.
#[derive(Clone, Debug)]
pub(super) struct Workspace<R: Real> {
    pub(super) at: Evaluation<R>,
    pub(super) stages: Stages<R>,
    /// The end of the part that is tried.
    end: Vec<R>,
    /// Those of the guards that are below zero at the end, and their values at the beginning.
    violated: Vec<(usize, R)>,
    /// Where the step began, to return there if it fails: the mode once it has changed, in memory that is kept.
    begun: (R, Vec<R>),
    mode_begun: Option<PlantMode<R>>,
    has_mode_begun: bool,
    /// What a jump of the rates of ends may change of a mode, as it was before.
    motion: (Vec<ActuatorMode<R>>, Vec<MechanismMode>),
    /// The part as a polynomial, for those that keep it.
    arc: Arc<R>,
}

impl<R: Instantiate> Workspace<R> {
    pub(super) fn new(plant: &Plant<R>) -> Self {
        let states = plant.indices().states;
        Self {
            at: Evaluation::new(plant),
            stages: Stages::new(plant),
            end: vec![R::zero(); states],
            violated: Vec::new(),
            begun: (R::zero(), vec![R::zero(); states]),
            mode_begun: None,
            has_mode_begun: false,
            motion: (Vec::new(), Vec::new()),
            arc: Arc::new(states),
        }
    }

    /// Notes where a step begins, to return there if it fails.
    pub(super) fn begin(&mut self, time: R, state: &[R]) {
        self.begun.0 = time;
        self.begun.1.copy_from_slice(state);
        self.has_mode_begun = false;
    }

    /// Takes on the numbers of another plant of equal structure.
    pub(super) fn adapt(&mut self, plant: &Plant<R>) {
        self.at.adapt(plant);
        self.stages.adapt(plant);
    }

    /// Notes that a mode is about to change.
    fn mode_changes(&mut self, mode: &PlantMode<R>) {
        if !core::mem::replace(&mut self.has_mode_begun, true) {
            match &mut self.mode_begun {
                Some(begun) => begun.clone_from(mode),
                None => self.mode_begun = Some(mode.clone()),
            }
        }
    }

    /// Notes what a jump of the rates of ends may change of a mode.
    pub(super) fn rates_jump(&mut self, mode: &PlantMode<R>) {
        let (actuators, mechanisms) = &mut self.motion;
        actuators.clone_from(&mode.actuators);
        mechanisms.clone_from(&mode.mechanisms);
    }

    /// Whether a mode has changed since then; where it has, the one before is kept for a step that fails.
    pub(super) fn has_turned(&mut self, mode: &mut PlantMode<R>) -> bool {
        let turned = mode.actuators != self.motion.0 || mode.mechanisms != self.motion.1;
        if turned && !self.has_mode_begun {
            self.swap_motion(mode);
            self.mode_changes(mode);
            self.swap_motion(mode);
        }
        turned
    }

    /// Returns to where the ends were when their rates jumped, if no step has been taken since. Which pieces of laws of the air
    /// hold follows from pressures, which have stayed.
    pub(super) fn return_ends(&mut self, reached: &mut PlantSnapshot<R>) {
        let (_, state, mode) = reached.parts();
        state.copy_from_slice(&self.begun.1);
        self.swap_motion(mode);
    }

    fn swap_motion(&mut self, mode: &mut PlantMode<R>) {
        core::mem::swap(&mut mode.actuators, &mut self.motion.0);
        core::mem::swap(&mut mode.mechanisms, &mut self.motion.1);
    }

    /// Returns to where the step began that failed.
    pub(super) fn return_to_begin(&mut self, reached: &mut PlantSnapshot<R>, course: &mut Course<R>) {
        let (time, state, mode) = reached.parts();
        *time = self.begun.0;
        state.copy_from_slice(&self.begun.1);
        if let Some(begun) = self.mode_begun.as_ref().filter(|_| self.has_mode_begun) {
            mode.clone_from(begun);
            course.forget_guards();
        }
    }
}

/// Advances a plant to `until` in s, through every instant up to then, and hands each part to `keep`, if anybody keeps it.
pub(super) fn advance<R: Instantiate>(
    system: &System<R>,
    method: Method,
    reached: &mut PlantSnapshot<R>,
    until: R,
    (work, course): (&mut Workspace<R>, &mut Course<R>),
    mut keep: Option<&mut Keep<'_, R>>,
) -> Result<(), Error> {
    let (time, state, mode) = reached.parts();
    loop {
        let instant = system.next_instant(mode, until);
        let target = match instant {
            // Its derivatives are how it moves, also where it is due at the end by rounding.
            Some(instant) if until.lt(instant) => until + (instant - R::constant(instant.value())),
            Some(instant) => instant,
            None => until,
        };
        let keep = keep.as_deref_mut();
        let mut part =
            Part { system, method, time: &mut *time, state: &mut *state, mode: &mut *mode, work, course, keep };
        part.advance(target, None)?;
        if instant.is_none() {
            return Ok(());
        }
        part.pass_instant()?;
    }
}

/// Advances a plant to a time in s before which nothing is due, where the stages of a step have come to an end.
pub(super) fn advance_to_end<R: Instantiate>(
    system: &System<R>,
    method: Method,
    reached: &mut PlantSnapshot<R>,
    (until, end): (R, &[R]),
    (work, course): (&mut Workspace<R>, &mut Course<R>),
) -> Result<(), Error> {
    let (time, state, mode) = reached.parts();
    let mut part = Part { system, method, time, state, mode, work, course, keep: None };
    part.advance(until, Some(end))
}

/// Passes what is due at the time that a plant has reached, on the way to `until` in s.
pub(super) fn pass_on_the_way<R: Instantiate>(
    system: &System<R>,
    method: Method,
    reached: &mut PlantSnapshot<R>,
    until: R,
    (work, course): (&mut Workspace<R>, &mut Course<R>),
) -> Result<(), Error> {
    let (time, state, mode) = reached.parts();
    while let Some(instant) = system.next_instant(mode, until) {
        if time.lt(until) && time.lt(instant) {
            break;
        }
        let mut part =
            Part { system, method, time: &mut *time, state: &mut *state, mode: &mut *mode, work, course, keep: None };
        part.pass_instant()?;
    }
    Ok(())
}

/// A plant on its way from one instant to the next.
struct Part<'p, 'k, R: Real> {
    system: &'p System<R>,
    method: Method,
    time: &'p mut R,
    state: &'p mut [R],
    mode: &'p mut PlantMode<R>,
    work: &'p mut Workspace<R>,
    course: &'p mut Course<R>,
    keep: Option<&'p mut Keep<'k, R>>,
}

impl<R: Instantiate> Part<'_, '_, R> {
    /// Goes on to `until`; `end` is where the stages of that step come to, if it is known.
    fn advance(&mut self, until: R, mut end: Option<&[R]>) -> Result<(), Error> {
        let parts = self.system.wires.len() + self.system.assemblies.len();
        for _ in 0..MOST_EVENTS * parts {
            let step = until - *self.time;
            if step.le(R::zero()) {
                return self.take_empty_step(step, until);
            }
            match end.take() {
                Some(end) => self.come_to(step, end),
                None => self.take(step),
            }
            self.find_violated(step);
            if self.work.violated.is_empty() {
                self.arrive(step, until)?;
                return self.hand_on(None);
            }
            let (part, guard) = self.locate(step);
            let end = *self.time + part;
            self.arrive(part, end)?;
            let kind = self.cross(guard)?;
            self.hand_on(Some(kind))?;
        }
        let step = until - *self.time;
        self.take(step);
        self.find_violated(step);
        self.arrive(step, until)?;
        self.hand_on(None)?;
        for violated in 0..self.work.violated.len() {
            let (guard, _) = self.course.guards[self.work.violated[violated].0];
            let kind = self.cross(guard)?;
            self.stay();
            self.hand_on(Some(kind))?;
        }
        Ok(())
    }

    /// Takes a step of no length, which carries derivatives with respect to the times of its ends.
    fn take_empty_step(&mut self, step: R, until: R) -> Result<(), Error> {
        if !R::HAS_DERIVATIVES || step.lt(R::zero()) {
            return Ok(());
        }
        self.take(step);
        self.arrive(step, until)?;
        self.stay();
        self.hand_on(None)
    }

    /// Passes the instant at the current time.
    fn pass_instant(&mut self) -> Result<(), Error> {
        self.course.forget_guards();
        self.work.mode_changes(self.mode);
        let kind = self.system.pass_instant(*self.time, self.state, self.mode, &mut self.work.at)?;
        self.stay();
        self.course.statistics.events += 1;
        self.hand_on(Some(kind))
    }

    /// Crosses a guard at the current time.
    fn cross(&mut self, guard: PlantGuard) -> Result<PlantEventKind, Error> {
        self.course.forget_guards();
        self.work.mode_changes(self.mode);
        self.course.statistics.events += 1;
        self.system.cross(guard, *self.time, self.state, self.mode, &mut self.work.at)
    }

    /// Takes a step of the method to the trial end.
    fn take(&mut self, step: R) {
        let (system, Workspace { at, stages, end, .. }) = (self.system, &mut *self.work);
        let time = *self.time;
        self.course.statistics.evaluations +=
            stages.take(system, self.method, (time, step), self.state, self.mode, at, end);
        system.enter_actuator_pieces(time + step, end, self.mode, at);
        system.project(time + step, end, self.mode, at);
        self.land(step);
    }

    /// Takes a trial end that has been computed elsewhere, with what a step knows exactly.
    fn come_to(&mut self, step: R, end: &[R]) {
        self.work.end.copy_from_slice(end);
        self.course.statistics.evaluations += if self.method == Method::Rk4 { 4 } else { 2 };
        self.land(step);
    }

    /// Enters what holds at the trial end.
    fn land(&mut self, step: R) {
        let (system, time, Workspace { at, end, .. }) = (self.system, *self.time, &mut *self.work);
        // As if it were in vain, until it arrives.
        self.course.statistics.rejected_steps += 1;
        system.enter_pieces(time + step, end, self.mode, at);
    }

    /// Comes to the trial end of a step of a length in s.
    fn arrive(&mut self, step: R, time: R) -> Result<(), Error> {
        let (system, Workspace { at, stages, end, arc, .. }) = (self.system, &mut *self.work);
        let statistics = &mut self.course.statistics;
        system.check_step(time, end)?;
        if self.keep.is_some() {
            arc.start = *self.time;
            arc.step = step;
            match self.method {
                Method::Rk4 => {
                    let [first, last] = stages.slopes_at_ends(system, time, end, self.mode, at);
                    arc.set_cubic([self.state, first], [end, last]);
                    // Far beyond its stability the method has no smooth trajectory.
                    if !system.holds_air(arc) {
                        arc.set_line(self.state, end);
                    }
                }
                Method::Stable => arc.set_line(self.state, end),
            }
        }
        self.state.copy_from_slice(end);
        *self.time = time;
        statistics.rejected_steps -= 1;
        match self.method {
            Method::Rk4 => statistics.explicit_steps += 1,
            Method::Stable => statistics.implicit_steps += 1,
        }
        Ok(())
    }

    /// A part without a length at the current time.
    fn stay(&mut self) {
        if self.keep.is_some() {
            (self.work.arc.start, self.work.arc.step) = (*self.time, R::one());
            self.work.arc.set_line(self.state, self.state);
        }
    }

    /// Hands the finished part to its owner.
    fn hand_on(&mut self, kind: Option<PlantEventKind>) -> Result<(), Error> {
        match &mut self.keep {
            None => Ok(()),
            Some(keep) => {
                let event = kind.map(|kind| (kind, &*self.mode));
                keep(&Piece { arc: &self.work.arc, end: *self.time, event })
            }
        }
    }

    /// The value of a guard at the trial end, after a part of a step in s.
    fn guard_at_end(&mut self, guard: usize, step: R) -> R {
        let Workspace { at, end, .. } = &mut *self.work;
        value_of(self.system, self.course.guards[guard], *self.time + step, end, self.mode, at)
    }

    /// Finds the guards that are below zero at the trial end.
    fn find_violated(&mut self, step: R) {
        let count = self.course.guards(self.system, self.mode).len();
        self.work.violated.clear();
        for place in 0..count {
            if self.guard_at_end(place, step).lt(R::zero()) {
                let (guard, at) = (self.course.guards[place], &mut self.work.at);
                let at_begin = value_of(self.system, guard, *self.time, self.state, self.mode, at);
                self.work.violated.push((place, at_begin));
            }
        }
    }

    /// The least of the violated guards at the trial end after a part of a step, and which it is; of those that begin at zero
    /// the value over the part.
    fn least(&mut self, step: R, theta: R) -> (R, usize) {
        let mut least = (R::constant(f64::INFINITY), 0);
        for violated in 0..self.work.violated.len() {
            let (guard, at_begin) = self.work.violated[violated];
            let value = self.guard_at_end(guard, step);
            let value = if at_begin.le(R::zero()) { value / theta } else { value };
            // What is not a number is below zero as well.
            if !least.0.le(value) {
                least = (value, guard);
            }
        }
        least
    }

    /// Locates the first of the violated guards within a step; the trial end is there. Returns the part of the step in s, and the
    /// guard.
    fn locate(&mut self, step: R) -> (R, PlantGuard) {
        let from_rest = self.work.violated.iter().any(|(_, at_begin)| at_begin.le(R::zero()));
        let (at_end, mut first) = self.least(step, R::one());
        let mut at_begin = R::constant(f64::INFINITY);
        for (_, value) in &self.work.violated {
            at_begin = if value.lt(at_begin) { *value } else { at_begin };
        }
        let mut part = step;
        let mut search = Search::between([R::zero(), at_begin], at_end);
        if from_rest {
            let theta = R::constant(FROM_REST);
            part = theta * step;
            self.take(part);
            let (value, guard) = self.least(part, theta);
            if !R::zero().le(value) {
                return (part, self.course.guards[guard].0);
            }
            search = Search::between([theta, value], at_end);
        }
        for _ in 0..MOST_TRIALS {
            let theta = search.proposal();
            part = theta * step;
            self.take(part);
            let (value, guard) = self.least(part, theta);
            first = guard;
            let is_nil = value.le(R::zero()) && R::zero().le(value);
            if is_nil || search.away(theta).le(R::constant(LOCATION_TOLERANCE)) {
                break;
            }
            search.learn([theta, value], !R::zero().le(value));
        }
        (part, self.course.guards[first].0)
    }
}

/// The value of a guard in a state.
fn value_of<R: Real>(
    system: &System<R>,
    (guard, form): (PlantGuard, GuardForm<R>),
    time: R,
    state: &[R],
    mode: &PlantMode<R>,
    at: &mut Evaluation<R>,
) -> R {
    match form {
        GuardForm::Above { index, bound } => state[index] - bound,
        GuardForm::Below { index, bound } => bound - state[index],
        GuardForm::Function => system.guard(guard, time, state, mode, at),
    }
}
