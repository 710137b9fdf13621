//! A joint with a controller in the loop, by both engines: one clockwork samples for both valves.
//!
//! Checked by `tests/joint_control.rs`.

use super::run::{JointConsumer, JointRunEnd, JointSimulation};
use super::stepper::{JointCourse, JointStepper};
use super::trajectory::{JointSample, JointTrajectory, Kept};
use super::{JointRig, JointState};
use crate::control::{Drive, JointController, JointMeasurement, JointSensors, Quantity, Sampling};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::closed_loop::{Clockwork, measurement};
use crate::simulation::kernel::Method;
use crate::simulation::rig::Actuation;
use crate::valve::is_due;
use alloc::vec::Vec;

/// What a controller of a joint saw at a sampling instant and what it decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointDecision<R = f64> {
    /// What the sensors showed; its time is the sampling instant.
    pub seen: JointMeasurement<R>,
    /// What the controller tried to reach and in which quantity, for the joint or for agonist and antagonist.
    pub aim: [Option<(Quantity, R)>; 2],
    /// What the valves of agonist and antagonist are to do once the decision takes effect.
    pub drive: [Drive<R>; 2],
}

/// The run of a joint under control.
#[derive(Clone, Debug)]
pub struct ControlledJoint<R: Real = f64> {
    /// The run; the commands of its rig are the tables of all that the controller asked for.
    pub trajectory: JointTrajectory<R>,
    /// What was decided at each sampling instant, in order of time.
    pub decisions: Vec<JointDecision<R>>,
}

/// Simulates a joint from a state at t = 0 for `duration` s as [`super::simulate_joint`] does, with a controller in place of
/// the rig's own commands. Sampling instants, ends of pulses and motions of seats are exact instants.
///
/// # Errors
/// As [`super::simulate_joint`]; [`Error::Misuse`] when an actuator has no valve or its valve cannot do what the
/// controller asks.
pub fn simulate_joint_controlled<R: Real, C: JointController<R>>(
    rig: &JointRig<R>,
    start: JointState<R>,
    duration: R,
    relative_tolerance: f64,
    controller: &C,
    (sampling, sensors): (Sampling<R>, JointSensors<R>),
) -> Result<ControlledJoint<R>, Error> {
    simulate_joint_controlled_watched(
        rig,
        start,
        (duration, relative_tolerance),
        controller,
        (sampling, sensors),
        |_| Ok(()),
    )
}

/// The same as [`simulate_joint_controlled`], calling `watch` with the time in s that has been reached, now and then: it may show it, or end the run by
/// an error such as [`Error::Interrupted`].
///
/// # Errors
/// As [`simulate_joint_controlled`], and those of `watch`.
pub fn simulate_joint_controlled_watched<R: Real, C: JointController<R>>(
    rig: &JointRig<R>,
    start: JointState<R>,
    (duration, relative_tolerance): (R, f64),
    controller: &C,
    set_up: (Sampling<R>, JointSensors<R>),
    mut watch: impl FnMut(f64) -> Result<(), Error>,
) -> Result<ControlledJoint<R>, Error> {
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
        &mut |_, decision| decisions.push(decision),
    )?;
    let kept = kept.unwrap_or_else(|| Kept::of(&simulation));
    Ok(ControlledJoint { trajectory: kept.finish(simulation, &mut watch)?, decisions })
}

/// Simulates a joint under control as [`simulate_joint_controlled`] does and hands each accepted step to `consumer` and each
/// decision, with the joint, to `decided`; nothing is kept but the requests to the valves, which are the joint's commands. A
/// decision comes before the steps that follow its sampling instant.
///
/// # Errors
/// As [`simulate_joint_controlled`], and those of the consumer.
pub fn simulate_joint_controlled_into<R: Real, C: JointController<R>>(
    rig: &JointRig<R>,
    start: JointState<R>,
    span: (R, f64),
    controller: &C,
    set_up: (Sampling<R>, JointSensors<R>),
    consumer: &mut JointConsumer<'_, R>,
    decided: &mut dyn FnMut(&JointRig<R>, JointDecision<R>),
) -> Result<JointRunEnd<R>, Error> {
    let mut extend = |simulation: &mut JointSimulation<R>, until| simulation.extend(until, consumer);
    let simulation = run(rig, start, span, controller, set_up, &mut extend, decided)?;
    simulation.finish(consumer)
}

/// Takes a run on to a time in s.
type Extend<'e, R> = dyn FnMut(&mut JointSimulation<R>, R) -> Result<(), Error> + 'e;

/// Takes a run under control to its end by `extend`; the last step is not handed on yet.
fn run<R: Real, C: JointController<R>>(
    rig: &JointRig<R>,
    start: JointState<R>,
    (duration, relative_tolerance): (R, f64),
    controller: &C,
    (sampling, sensors): (Sampling<R>, JointSensors<R>),
    extend: &mut Extend<'_, R>,
    decided: &mut dyn FnMut(&JointRig<R>, JointDecision<R>),
) -> Result<JointSimulation<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    rig.check_counts(duration.value())?;
    sampling.check_counts(duration.value())?;
    let mut rig = rig.clone();
    let clockwork: TwoValves<R, C> = Clockwork::begin(controller.begin(), sampling, rig.valves())?;
    clockwork.run(JointSimulation::begin(rig, start, relative_tolerance)?, duration, extend, |simulation, clockwork| {
        let truth = simulation.reached();
        let decision = decide(clockwork, (controller, &sensors), &truth, simulation.rig_mut())?;
        decided(simulation.rig_mut(), decision);
        Ok(())
    })
}

/// Takes the sample that is due, and continues the commands of the rig up to the next.
fn decide<R: Real, C: JointController<R>>(
    clockwork: &mut TwoValves<R, C>,
    (controller, sensors): (&C, &JointSensors<R>),
    truth: &JointSample<R>,
    rig: &mut JointRig<R>,
) -> Result<JointDecision<R>, Error> {
    let seen = sensors.show(&seen(clockwork.next(), truth, rig));
    let drive = clockwork.sample(rig.valves(), |memory| controller.decide(&seen, memory))?;
    Ok(JointDecision { seen, aim: controller.aim(&seen), drive })
}

/// The clockwork of a controller of both valves.
type TwoValves<R, C> = Clockwork<R, <C as JointController<R>>::Memory, 2>;

/// Steps one joint under control through time at fixed steps, as [`JointStepper`] does; a step is divided at sampling instants
/// too.
#[derive(Debug)]
pub struct ControlledJointStepper<R: Real<Time = R>, C: JointController<R>> {
    stepper: JointStepper<R>,
    course: JointCourse<R>,
    controller: C,
    sensors: JointSensors<R>,
    clockwork: TwoValves<R, C>,
    decisions: Vec<JointDecision<R>>,
}

impl<R: Real<Time = R>, C: JointController<R>> ControlledJointStepper<R, C> {
    /// Starts at t = 0 in a state, with a controller in place of the rig's own commands: its own, or a reference to one.
    ///
    /// # Errors
    /// [`Error::Misuse`] when an actuator has no valve or its valve cannot do what the controller asks.
    pub fn new(
        rig: &JointRig<R>,
        start: JointState<R>,
        method: Method,
        controller: C,
        (sampling, sensors): (Sampling<R>, JointSensors<R>),
    ) -> Result<Self, Error> {
        let mut rig = rig.clone();
        let clockwork = Clockwork::begin(controller.begin(), sampling, rig.valves())?;
        let stepper = JointStepper::new(rig, method);
        let course = stepper.begin(start);
        let mut controlled = Self { stepper, course, controller, sensors, clockwork, decisions: Vec::new() };
        controlled.take_due()?;
        Ok(controlled)
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.course.time()
    }

    /// Everything that is known at that time.
    pub fn sample(&self) -> JointSample<R> {
        self.stepper.sample(&self.course)
    }

    /// What has been decided, in order of time.
    pub fn decisions(&self) -> &[JointDecision<R>] {
        &self.decisions
    }

    /// The joint; the commands of its valves are the tables of all that the controller has asked for.
    pub fn rig(&self) -> &JointRig<R> {
        self.stepper.rig()
    }

    /// Goes on to `until` s in one step, divided where something switches and at sampling instants.
    ///
    /// # Errors
    /// As [`JointStepper::advance_to`]; [`Error::Misuse`] when a valve cannot do what the controller asks.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        loop {
            let instant = self.clockwork.next();
            let end = if is_due(instant, until) { instant.smaller(until) } else { until };
            self.stepper.advance_to(&mut self.course, end)?;
            self.take_due()?;
            if is_due(until, self.course.time()) {
                return Ok(());
            }
        }
    }

    /// Takes the sample that is due at the time that has been reached.
    fn take_due(&mut self) -> Result<(), Error> {
        if is_due(self.clockwork.next(), self.course.time()) {
            let truth = self.sample();
            let of = (&self.controller, &self.sensors);
            self.decisions.push(decide(&mut self.clockwork, of, &truth, self.stepper.rig_mut())?);
            self.stepper.pass(&mut self.course);
        }
        Ok(())
    }
}

/// What there is to measure of a joint at a sampling instant in s.
fn seen<R: Real>(time: R, truth: &JointSample<R>, rig: &JointRig<R>) -> JointMeasurement<R> {
    let JointSample { angle, angular_velocity, .. } = *truth;
    let actuators = [0, 1].map(|i| measurement(time, &truth.actuators[i], &rig.driven()[i].actuator));
    JointMeasurement { time, angle, angular_velocity, actuators }
}

impl<R: Real> JointRig<R> {
    /// What drives the two valves, to be told more.
    fn valves(&mut self) -> [Option<&mut Actuation<R>>; 2] {
        self.driven.each_mut().map(|driven| driven.actuation.as_mut())
    }
}
