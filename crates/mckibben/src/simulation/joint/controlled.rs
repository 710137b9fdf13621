//! A joint with a controller in the loop at fixed steps: one clockwork samples for both valves.
//!
//! With every event located [`JointPlant::driver`](crate::plant::JointPlant::driver) takes the controller. Checked by `tests/joint_control.rs`.

use super::sample::JointSample;
use super::stepper::{JointCourse, JointStepper};
use super::{JointRig, JointState};
use crate::control::{Drive, JointController, JointMeasurement, JointSensors, Quantity, Sampling};
use crate::error::Error;
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
    /// [`Error::Misuse`] when an actuator has no valve or its valve cannot do what the controller asks;
    /// [`Error::NotImplemented`] as [`JointStepper::new`].
    pub fn new(
        rig: &JointRig<R>,
        start: JointState<R>,
        method: Method,
        controller: C,
        (sampling, sensors): (Sampling<R>, JointSensors<R>),
    ) -> Result<Self, Error> {
        let mut rig = rig.clone();
        let clockwork = Clockwork::begin(controller.begin(), sampling, rig.valves())?;
        let stepper = JointStepper::new(rig, method)?;
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
