//! Both engines with a controller in the loop.
//!
//! Checked by `tests/closed_loop.rs`.

use super::closed_loop::{ClosedLoop, Decision, OneValve};
use super::fixed_step::{Walk, stepped};
use super::kernel::Method;
use super::rig::{Rig, State};
use super::sample::Sample;
use super::trajectory::Trajectory;
use crate::control::{Controller, Sampling, Sensors};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::valve::is_due;
use alloc::vec::Vec;

/// A run under control.
#[derive(Clone, Debug)]
pub struct Controlled<R: Real = f64> {
    /// The run; the command of its rig is the table of all that the controller asked for.
    pub trajectory: Trajectory<R>,
    /// What was decided at each sampling instant, in order of time.
    pub decisions: Vec<Decision<R>>,
}

/// Simulates a rig from a state at t = 0 for `duration` s as [`super::simulate`] does, with a controller in place of the
/// rig's own command. Sampling instants, ends of pulses and motions of seats are exact instants.
///
/// # Errors
/// As [`super::simulate`]; [`Error::Unsupported`] when the rig has no valve or its valve cannot do what the controller asks.
pub fn simulate_controlled<R: Real, C: Controller<R>>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
    controller: &C,
    (sampling, sensors): (Sampling<R>, Sensors<R>),
) -> Result<Controlled<R>, Error> {
    simulate_controlled_watched(rig, start, (duration, relative_tolerance), controller, (sampling, sensors), |_| ())
}

/// The same as [`simulate_controlled`], calling `watch` with the time in s that has been reached, now and then.
///
/// # Errors
/// As [`simulate_controlled`].
pub fn simulate_controlled_watched<R: Real, C: Controller<R>>(
    rig: &Rig<R>,
    start: State<R>,
    (duration, relative_tolerance): (R, f64),
    controller: &C,
    (sampling, sensors): (Sampling<R>, Sensors<R>),
    mut watch: impl FnMut(f64),
) -> Result<Controlled<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    let closed_loop = ClosedLoop { controller, sensors };
    let (clockwork, rig) = closed_loop.begin(rig, sampling)?;
    let (trajectory, decisions) = clockwork.run(
        Trajectory::begin(rig, start, relative_tolerance)?,
        duration,
        |trajectory, until| trajectory.extend(until, &mut watch),
        |trajectory, clockwork| closed_loop.sample(clockwork, &trajectory.reached(), trajectory.rig_mut()),
    )?;
    Ok(Controlled { trajectory, decisions })
}

/// Steps one rig under control through time at fixed steps, as [`super::FixedStepper`] does; a step is divided at sampling
/// instants too.
#[derive(Debug)]
pub struct ControlledStepper<'c, R: Real<Time = R>, C: Controller<R>> {
    rig: Rig<R>,
    method: Method,
    walk: Walk<R>,
    closed_loop: ClosedLoop<'c, R, C>,
    clockwork: OneValve<R, C>,
    decisions: Vec<Decision<R>>,
}

impl<'c, R: Real<Time = R>, C: Controller<R>> ControlledStepper<'c, R, C> {
    /// Starts at t = 0 in a state, with a controller in place of the rig's own command.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when the rig has no valve or its valve cannot do what the controller asks.
    pub fn new(
        rig: &Rig<R>,
        start: State<R>,
        method: Method,
        controller: &'c C,
        (sampling, sensors): (Sampling<R>, Sensors<R>),
    ) -> Result<Self, Error> {
        let closed_loop = ClosedLoop { controller, sensors };
        let (clockwork, rig) = closed_loop.begin(rig, sampling)?;
        rig.check_four_states()?;
        let mut walk = Walk::new(&rig, stepped(&rig, start));
        walk.pass(&rig, &rig.timetable());
        let mut stepper = Self { rig, method, walk, closed_loop, clockwork, decisions: Vec::new() };
        stepper.take_due()?;
        Ok(stepper)
    }

    /// Everything that is known at the time that has been reached.
    pub fn sample(&self) -> Sample<R> {
        self.walk.sample(&self.rig)
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
    /// As [`super::FixedStepper::advance_to`]; [`Error::Unsupported`] when the valve cannot do what the controller asks.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        loop {
            let instant = self.clockwork.next();
            let due = is_due(instant, until);
            let end = if due { instant.smaller(until) } else { until };
            self.walk.advance_to(&self.rig, &self.rig.timetable(), self.method, end, None)?;
            self.take_due()?;
            if until.le(self.walk.course.time) {
                return Ok(());
            }
        }
    }

    /// Takes the sample that is due at the time that has been reached.
    fn take_due(&mut self) -> Result<(), Error> {
        if is_due(self.clockwork.next(), self.walk.course.time) {
            let truth = self.sample();
            self.decisions.push(self.closed_loop.sample(&mut self.clockwork, &truth, &mut self.rig)?);
            self.walk.pass(&self.rig, &self.rig.timetable());
        }
        Ok(())
    }
}
