//! Fixed steps with a controller in the loop.
//!
//! Checked by `tests/closed_loop.rs`.

use super::closed_loop::{ClosedLoop, Decision, OneValve};
use super::fixed_step::Journey;
use super::kernel::Method;
use super::rig::{Rig, State};
use super::sample::Sample;
use crate::control::{Controller, Sampling, Sensors};
use crate::error::Error;
use crate::scalar::Real;
use crate::valve::is_due;
use alloc::vec::Vec;

/// Steps one rig under control through time at fixed steps, as [`super::FixedStepper`] does; a step is divided at sampling
/// instants too.
#[derive(Debug)]
pub struct ControlledStepper<R: Real<Time = R>, C: Controller<R>> {
    rig: Rig<R>,
    method: Method,
    journey: Journey<R>,
    closed_loop: ClosedLoop<R, C>,
    clockwork: OneValve<R, C>,
    decisions: Vec<Decision<R>>,
}

impl<R: Real<Time = R>, C: Controller<R>> ControlledStepper<R, C> {
    /// Starts at t = 0 in a state, with a controller in place of the rig's own command: its own, or a reference to one.
    ///
    /// # Errors
    /// [`Error::Misuse`] when the rig has no valve or its valve cannot do what the controller asks.
    pub fn new(
        rig: &Rig<R>,
        start: State<R>,
        method: Method,
        controller: C,
        set_up: (Sampling<R>, Sensors<R>),
    ) -> Result<Self, Error> {
        let mut stepper = Self::begin(rig, start, method, controller, set_up)?;
        stepper.take_due()?;
        Ok(stepper)
    }

    /// The same before the first sample is taken.
    pub(crate) fn begin(
        rig: &Rig<R>,
        start: State<R>,
        method: Method,
        controller: C,
        (sampling, sensors): (Sampling<R>, Sensors<R>),
    ) -> Result<Self, Error> {
        let closed_loop = ClosedLoop { controller, sensors };
        let (clockwork, rig) = closed_loop.begin(rig, sampling)?;
        let journey = Journey::begin(&rig, start);
        Ok(Self { rig, method, journey, closed_loop, clockwork, decisions: Vec::new() })
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.journey.time()
    }

    /// Everything that is known at that time.
    pub fn sample(&self) -> Sample<R> {
        self.journey.sample(&self.rig)
    }

    /// The state at that time: the actuator's own where a tendon is in series.
    pub fn state(&self) -> State<R> {
        self.journey.state()
    }

    /// What has been decided, in order of time.
    pub fn decisions(&self) -> &[Decision<R>] {
        &self.decisions
    }

    /// The rig; its command is the table of all that the controller has asked for.
    pub fn rig(&self) -> &Rig<R> {
        &self.rig
    }

    /// Goes on to `until` in one step, divided where something switches and at sampling instants.
    ///
    /// # Errors
    /// As [`super::FixedStepper::advance_to`]; [`Error::Misuse`] when the valve cannot do what the controller asks.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        loop {
            let instant = self.clockwork.next();
            let due = is_due(instant, until);
            let end = if due { instant.smaller(until) } else { until };
            self.journey.advance_to(&self.rig, self.method, end)?;
            self.take_due()?;
            if until.le(self.time()) {
                return Ok(());
            }
        }
    }

    /// Takes the sample that is due at the time that has been reached.
    pub(crate) fn take_due(&mut self) -> Result<(), Error> {
        if is_due(self.clockwork.next(), self.time()) {
            let truth = self.sample();
            self.decisions.push(self.closed_loop.sample(&mut self.clockwork, &truth, &mut self.rig)?);
            self.journey.pass(&self.rig);
        }
        Ok(())
    }
}
