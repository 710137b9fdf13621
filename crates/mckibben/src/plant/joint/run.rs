//! Runs of the plant of a joint, kept or handed on step by step, read as those of the joint.

use super::JointPlant;
use crate::command::Driver;
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::plant::steps::TimeStepping;
use crate::plant::view::{self, ViewRunEnd, ViewStep, ViewTrajectory};
use crate::simulation::JointState;

/// A run of a joint that is kept: samples at any time and the log of events.
pub type JointTrajectory<R = f64> = ViewTrajectory<JointPlant<R>, R>;
/// An accepted step of a joint's run: every sample within it, by dense output, and the event that ended it.
pub type JointStep<'s> = ViewStep<'s, JointPlant>;
/// Takes each accepted step of a joint's run in order of time; its error ends the run.
pub type JointConsumer<'c> = dyn FnMut(&JointStep<'_>) -> Result<(), Error> + 'c;
/// What holds at the end of a joint's run of which nothing else is kept.
pub type JointRunEnd = ViewRunEnd<JointPlant>;

impl<R: Instantiate> JointPlant<R> {
    /// Simulates the joint from a state at t = 0 for `duration` s: every event located, with a relative tolerance for each step,
    /// or by another [`TimeStepping`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a duration, tolerance or step outside its range; [`Error::TooMany`] for more pulses than a run may
    /// have; [`Error::Stopped`] when the simulation cannot reach its end: it says when, where and what to change.
    pub fn simulate(
        &self,
        state: &JointState<R>,
        duration: R,
        stepping: impl Into<TimeStepping>,
    ) -> Result<JointTrajectory<R>, Error> {
        self.record(state, (duration, stepping), None, &mut |_| Ok(()))
    }

    /// Simulates the joint as [`JointPlant::simulate`] does, with a [driver](JointPlant::driver) in place of its own commands if
    /// there is one; `watch` is called with the time in s that has been reached now and then, and may end the run by an error
    /// such as [`Error::Interrupted`].
    ///
    /// # Errors
    /// As [`JointPlant::simulate`], those of the driver's controller, and those of `watch`.
    pub fn record(
        &self,
        state: &JointState<R>,
        (duration, stepping): (R, impl Into<TimeStepping>),
        driver: Option<Driver<R>>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<JointTrajectory<R>, Error> {
        view::record_view(self, state, (duration, stepping.into()), driver, watch).map(|(trajectory, _)| trajectory)
    }
}

impl JointPlant {
    /// Simulates the joint as [`JointPlant::record`] does and hands each accepted step to `consumer`; nothing is kept but the
    /// requests to valves that a driver has.
    ///
    /// # Errors
    /// As [`JointPlant::simulate`], those of the driver's controller, and those of the consumer.
    pub fn stream(
        &self,
        state: &JointState,
        (duration, stepping): (f64, impl Into<TimeStepping>),
        driver: Option<Driver>,
        consumer: &mut JointConsumer<'_>,
    ) -> Result<JointRunEnd, Error> {
        view::stream_view(self, state, (duration, stepping.into()), driver, consumer)
    }
}
