//! Both engines with a controller in the loop.
//!
//! Checked by `tests/closed_loop.rs`.

use super::closed_loop::{ClosedLoop, Decision, OneValve};
use super::fixed_step::Journey;
use super::kernel::Method;
use super::rig::{Rig, State};
use super::run::{Consumer, RunEnd, Simulation};
use super::sample::Sample;
use super::trajectory::{Kept, Trajectory};
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
/// As [`super::simulate`]; [`Error::Misuse`] when the rig has no valve or its valve cannot do what the controller asks.
pub fn simulate_controlled<R: Real, C: Controller<R>>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
    controller: &C,
    (sampling, sensors): (Sampling<R>, Sensors<R>),
) -> Result<Controlled<R>, Error> {
    simulate_controlled_watched(rig, start, (duration, relative_tolerance), controller, (sampling, sensors), |_| Ok(()))
}

/// The same as [`simulate_controlled`], calling `watch` with the time in s that has been reached, now and then: it may show it, or end the run by
/// an error such as [`Error::Interrupted`].
///
/// # Errors
/// As [`simulate_controlled`], and those of `watch`.
pub fn simulate_controlled_watched<R: Real, C: Controller<R>>(
    rig: &Rig<R>,
    start: State<R>,
    (duration, relative_tolerance): (R, f64),
    controller: &C,
    set_up: (Sampling<R>, Sensors<R>),
    mut watch: impl FnMut(f64) -> Result<(), Error>,
) -> Result<Controlled<R>, Error> {
    let (mut kept, mut decisions) = (None, Vec::new());
    let simulation = run(
        rig,
        start,
        (duration, relative_tolerance),
        controller,
        set_up,
        &mut |simulation, until| {
            let kept = kept.get_or_insert_with(|| Kept::of(simulation));
            simulation.extend(until, &mut |step| kept.take(step, &mut watch))
        },
        &mut |decision| decisions.push(decision),
    )?;
    let kept = kept.unwrap_or_else(|| Kept::of(&simulation));
    Ok(Controlled { trajectory: kept.finish(simulation, &mut watch)?, decisions })
}

/// Simulates a rig under control as [`simulate_controlled`] does and hands each accepted step to `consumer` and each decision to
/// `decided`; nothing is kept but the requests to the valve, which are the rig's command. A decision comes before the steps that
/// follow its sampling instant.
///
/// # Errors
/// As [`simulate_controlled`], and those of the consumer.
pub fn simulate_controlled_into<R: Real, C: Controller<R>>(
    rig: &Rig<R>,
    start: State<R>,
    span: (R, f64),
    controller: &C,
    set_up: (Sampling<R>, Sensors<R>),
    consumer: &mut Consumer<'_, R>,
    decided: &mut dyn FnMut(Decision<R>),
) -> Result<RunEnd<R>, Error> {
    let mut extend = |simulation: &mut Simulation<R>, until| simulation.extend(until, consumer);
    let simulation = run(rig, start, span, controller, set_up, &mut extend, decided)?;
    simulation.finish(consumer)
}

/// Takes a run on to a time in s.
type Extend<'e, R> = dyn FnMut(&mut Simulation<R>, R) -> Result<(), Error> + 'e;

/// Takes a run under control to its end by `extend`; the last step is not handed on yet.
fn run<R: Real, C: Controller<R>>(
    rig: &Rig<R>,
    start: State<R>,
    (duration, relative_tolerance): (R, f64),
    controller: &C,
    (sampling, sensors): (Sampling<R>, Sensors<R>),
    extend: &mut Extend<'_, R>,
    decided: &mut dyn FnMut(Decision<R>),
) -> Result<Simulation<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    rig.check_counts(duration.value())?;
    sampling.check_counts(duration.value())?;
    let closed_loop = ClosedLoop { controller, sensors };
    let (clockwork, rig) = closed_loop.begin(rig, sampling)?;
    clockwork.run(Simulation::begin(rig, start, relative_tolerance)?, duration, extend, |simulation, clockwork| {
        decided(closed_loop.sample(clockwork, &simulation.reached(), simulation.rig_mut())?);
        Ok(())
    })
}

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
