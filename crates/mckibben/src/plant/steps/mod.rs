//! The fixed-step engine: bounded cost, valve edges inside a step honoured exactly, any plant.
//!
//! A step is divided at every instant that is known beforehand (a poppet moves, a given motion turns, a controller samples) and
//! where a mode ends: a velocity comes to rest, friction lets go, a length or a stop is reached, a tendon comes loose. What
//! follows there is what follows in the event-located engine: the discrete state and its rules are the plant's, and are the
//! same for both. Only the way from one instant to the next is another: one step of a [`Method`] in place of as many as a
//! tolerance takes.
//!
//! | within a step | |
//! |---|---|
//! | borders between pieces of a law that agree there | each stage takes the piece of its state: [`pieces`] |
//! | the end of a mode | is located by the method's own step: [`part`] |
//! | more air than there is | shorter steps by backward Euler: [`method`] |
//! | what is stiff | a linear system over what it is in: [`implicit`] |
//! | ends that a host moves | [`host`] |
//! | a host that has its own integrator | [`exchange`] |
//!
//! What error a step leaves is in `docs/accuracy.md`.
//!
//! Checked by `tests/plant_steps.rs`: against the event-located engine, by the order of the error in the step.

mod accuracy;
mod exchange;
mod host;
mod implicit;
mod method;
mod part;
mod pieces;
mod response;
mod row;
mod saved;

pub use accuracy::{PILOT, PlantReference, PlantStepError, SHORTEST, plant_step_for_accuracy};
pub use exchange::{EventUpdate, PlantExchange};
pub use host::MOST_PARTS;
pub(crate) use host::TOO_MANY_PARTS;
pub use host::{NO_ACTUATOR, check_longest_part, check_move, host_mechanisms, part_end, parts_of};
pub use method::{MOST_AIR, Method, Stages};
pub use row::PlantRow;

use super::evaluation::System;
use super::run::{Keep, PlantRun, PlantSnapshot};
use super::sample::{Observer, PlantSample};
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::parameter;
use crate::valve::RuntimeCommand;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use part::{Course, Workspace};

/// The relative width of the borders of modes: no step is controlled by an error, so that only rounding lies within
/// them.
pub(super) const NARROW: f64 = 1e-12;
/// Part of a step below which the rest up to the end of a run is no separate step.
const SLIVER: f64 = 1e-9;

/// How a run goes through time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStepping {
    /// By the event-located engine: adaptive steps of high order, every event located.
    Located {
        /// Of each step.
        relative_tolerance: f64,
    },
    /// By the fixed-step engine.
    Fixed {
        /// How a step is taken.
        method: Method,
        /// Its length in s; steps end at its multiples, counted from t = 0, and where the run is to pause.
        step: f64,
    },
}

impl From<f64> for TimeStepping {
    /// By the event-located engine with a relative tolerance for each step.
    fn from(relative_tolerance: f64) -> Self {
        Self::Located { relative_tolerance }
    }
}

impl TimeStepping {
    /// That its numbers are within their ranges.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Located { relative_tolerance } => parameter::RELATIVE_TOLERANCE.check(*relative_tolerance).map(drop),
            Self::Fixed { step, .. } => parameter::STEP.check(*step).map(drop),
        }
    }

    /// The end in s of the fixed step that begins at a time, of a run that goes on to `until`: the next multiple of the step. By the
    /// event-located engine, whose steps are not known beforehand, `until`.
    pub fn step_end(&self, time: f64, until: f64) -> f64 {
        match self {
            Self::Located { .. } => until,
            Self::Fixed { step, .. } => step_end(time, *step, until),
        }
    }

    /// The relative tolerance by which borders of modes are discerned from rounding: that of each step, at fixed steps 10⁻¹².
    pub fn tolerance(&self) -> f64 {
        match self {
            Self::Located { relative_tolerance } => *relative_tolerance,
            Self::Fixed { .. } => NARROW,
        }
    }
}

/// The end in s of the step that begins at a time, of a run that goes on to `until`.
fn step_end<R: Instantiate>(time: R, step: f64, until: R) -> R {
    let count = (time.value() / step * (1.0 + SLIVER)) as u64 + 1;
    let end = step * count as f64;
    if end < until.value() - SLIVER * step { R::constant(end) } else { until }
}

/// Advances a run from where it is to `until` in s at fixed steps, and hands each part to `keep`.
pub(super) fn extend<R: Instantiate>(
    system: &System<R>,
    (method, step): (Method, f64),
    reached: &mut PlantSnapshot<R>,
    until: R,
    keep: &mut Keep<'_, R>,
) -> Result<(), Error> {
    let (mut work, mut course) = (Workspace::new(&system.plant), Course::default());
    while reached.time().lt(until) {
        let end = step_end(reached.time(), step, until);
        part::advance(system, method, reached, end, (&mut work, &mut course), Some(&mut *keep))?;
    }
    reached.pace_mut().add(course.statistics);
    Ok(())
}

/// Takes a run of a plant on at fixed steps.
///
/// ```
/// use mckibben::plant::{Plant, PlantRun, PlantStart};
/// use mckibben::simulation::Method;
/// use mckibben::valve::Request;
///
/// # fn lifts(plant: &Plant, start: &PlantStart) -> Result<(), mckibben::Error> {
/// let run = PlantRun::new(plant, start, 1e-6)?;
/// let mut steps = run.steps(Method::Stable);
/// for count in 1..=1000 {
///     let fill = steps.state()[0] > 0.09;
///     steps.set(0, if fill { Request::Fill } else { Request::Exhaust })?;
///     steps.advance_to(f64::from(count) * 1e-3)?;
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PlantSteps<R: Instantiate = f64> {
    row: Box<PlantRow<R>>,
    work: Workspace<R>,
    /// Whose numbers the workspace has.
    adapted_to: Arc<System<R>>,
    /// What is restored from numbers, until all of it is known to be a state.
    before: PlantSnapshot<R>,
    /// How many numbers a state is, where that is known.
    state_size: Option<usize>,
}

impl<R: Instantiate> PlantRun<R> {
    /// Steps of a method from where the run is; the run itself stays there.
    pub fn steps(&self, method: Method) -> PlantSteps<R> {
        self.row(method).into()
    }
}

impl<R: Instantiate> PlantSteps<R> {
    pub(crate) fn generic_of_row(row: PlantRow<R>) -> Self {
        let (work, adapted_to, before) = (Workspace::new(row.plant()), row.system.clone(), row.save());
        Self { row: Box::new(row), work, adapted_to, before, state_size: None }
    }

    /// Goes back, or on, to where a run or steps of the same plant were.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a snapshot of another plant.
    pub fn restore(&mut self, snapshot: &PlantSnapshot<R>) -> Result<(), Error> {
        self.row.forget_guards();
        self.row.reached.restore(snapshot)
    }

    /// Returns to where the steps began.
    pub fn reset(&mut self) {
        let PlantRow { reached, start, course, .. } = &mut *self.row;
        course.forget_guards();
        reached.clone_from(start);
    }

    /// Writes the rates of change of all states, per second, at the time that has been reached.
    ///
    /// # Errors
    /// [`Error::Table`] unless there is one rate for each state.
    pub fn derivative(&mut self, rates: &mut [R]) -> Result<(), Error> {
        R::derive_plant_steps(self, rates)
    }

    pub(crate) fn generic_derivative(&mut self, rates: &mut [R]) -> Result<(), Error> {
        let Self { row, work, .. } = self;
        let PlantRow { system, reached, .. } = &mut **row;
        let (time, state, mode) = reached.parts();
        if rates.len() != state.len() {
            return Err(Error::Table {
                name: "rates",
                problem: "there is not one rate for each state",
                entry: rates.len().min(state.len()) + 1,
                remedy: "give as many rates as `Plant::indices` has states",
            });
        }
        system.enter_pieces(*time, state, mode, &mut work.at);
        system.rates(*time, state, mode, &mut work.at, rates);
        Ok(())
    }

    /// Sets what a valve does from now on, in place of all that was to come.
    ///
    /// # Errors
    /// As [`PlantRun::set`].
    pub fn set(&mut self, valve: usize, command: impl Into<RuntimeCommand<R>>) -> Result<(), Error> {
        self.row.set(valve, command.into())
    }

    /// Goes on to `until` in s in one step, divided where something switches; nothing where that has been reached.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step was so long that it left the physics, or when the plant cannot go on;
    /// [`Error::OutOfRange`] for a time that is not finite; those of a driver. The steps then stay where they were.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        R::advance_plant_steps(self, until)
    }

    pub(crate) fn generic_advance_to(&mut self, until: R) -> Result<(), Error> {
        let span = (until - self.time()).value();
        if span <= 0.0 {
            return Ok(());
        }
        parameter::DURATION.check(span)?;
        let Self { row, work, .. } = self;
        let PlantRow { system, method, reached, course, .. } = &mut **row;
        reached.pulse(&system.plant, until)?;
        work.begin(reached.time(), reached.state());
        let done = part::advance(system, *method, reached, until, (&mut *work, &mut *course), None);
        if done.is_err() {
            work.return_to_begin(reached, course);
        }
        done
    }
}

impl PlantSteps {
    /// Sets the rates (m/s or rad/s) of a mechanism whose motion a host gives.
    ///
    /// # Errors
    /// As [`PlantRun::set_rates`].
    pub fn set_rates(&mut self, mechanism: usize, rates: &[f64]) -> Result<(), Error> {
        let Self { row, work, .. } = self;
        row.forget_guards();
        let PlantRow { system, reached, .. } = &mut **row;
        reached.set_rates(system, mechanism, rates, &mut work.at)
    }

    /// Passes what is due at the time that has been reached, such as the first sample of a controller, which else the next step
    /// passes first.
    ///
    /// # Errors
    /// Those of a driver.
    pub fn pass_due(&mut self) -> Result<(), Error> {
        let (row, work) = (&mut *self.row, &mut self.work);
        let now = row.time();
        part::advance(&row.system, row.method, &mut row.reached, now, (work, &mut row.course), None)
    }

    /// Lays pulses out to `until` in s.
    #[doc(hidden)]
    pub fn lay_out(&mut self, until: f64) -> Result<(), Error> {
        self.row.lay_out(until)
    }

    /// Takes on a time in s and a state that have been reached in the mode that holds.
    #[doc(hidden)]
    pub fn put(&mut self, time: f64, state: impl Fn(usize) -> f64) {
        let PlantRow { system, reached, .. } = &mut *self.row;
        let (own_time, own_state, mode) = reached.parts();
        *own_time = time;
        for (place, number) in own_state.iter_mut().enumerate() {
            *number = state(place);
        }
        system.enter_pieces(time, own_state, mode, &mut self.work.at);
    }

    /// Passes what is due at the time that has been reached, on the way to `until` in s.
    #[doc(hidden)]
    pub fn pass_on_the_way(&mut self, until: f64) -> Result<(), Error> {
        let (row, work) = (&mut *self.row, &mut self.work);
        part::pass_on_the_way(&row.system, row.method, &mut row.reached, until, (work, &mut row.course))
    }

    /// Goes on to `until` in s, before which nothing is due, where the stages of the step have come to `end`.
    #[doc(hidden)]
    pub fn advance_to_end(&mut self, until: f64, end: &[f64]) -> Result<(), Error> {
        let Self { row, work, .. } = self;
        let PlantRow { system, method, reached, course, .. } = &mut **row;
        work.begin(reached.time(), reached.state());
        let done = part::advance_to_end(system, *method, reached, (until, end), (&mut *work, &mut *course));
        if done.is_err() {
            work.return_to_begin(reached, course);
        }
        done
    }
}

/// Reads samples of steps of a plant, with memory that is used again.
#[derive(Debug)]
pub struct PlantSampler {
    observer: Observer<f64>,
    state: Vec<f64>,
    sample: PlantSample,
}

impl PlantSampler {
    /// For steps of a plant.
    pub fn new(steps: &PlantRow) -> Self {
        let fixed = TimeStepping::Fixed { method: steps.method, step: 1.0 };
        let plant = &steps.system.plant;
        Self { observer: Observer::new(plant, fixed), state: Vec::new(), sample: PlantSample::new(plant) }
    }

    /// Everything that is known where the steps of that plant are, at a time in s that differs from theirs by rounding alone.
    pub fn read(&mut self, steps: &PlantRow, time: f64) -> &PlantSample {
        let Self { observer, state, sample } = self;
        state.clear();
        state.extend_from_slice(steps.state());
        observer.read(time, state, steps.mode(), sample);
        sample
    }

    /// Everything that follows from the states as a host that integrates has placed them: what is known exactly, as the pressure of
    /// air without heat from its mass and volume, is not put in their place.
    pub fn read_placed(&mut self, steps: &PlantRow) -> &PlantSample {
        self.observer.observe(steps.time(), steps.state(), steps.mode(), &mut self.sample);
        &self.sample
    }

    /// The last sample.
    pub fn into_sample(self) -> PlantSample {
        self.sample
    }
}
