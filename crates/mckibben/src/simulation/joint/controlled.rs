//! A joint with a controller in the loop: one clockwork samples for both valves.
//!
//! Checked by `tests/joint_control.rs`.

use super::trajectory::{JointSample, JointTrajectory};
use super::{JointRig, JointState};
use crate::control::{Drive, JointController, JointMeasurement, JointSensors, Quantity, Sampling};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::closed_loop::{Clockwork, measurement};
use crate::simulation::rig::Actuation;
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
/// As [`super::simulate_joint`]; [`Error::Unsupported`] when an actuator has no valve or its valve cannot do what the
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
        |_| (),
    )
}

/// The same as [`simulate_joint_controlled`], calling `watch` with the time in s that has been reached, now and then.
///
/// # Errors
/// As [`simulate_joint_controlled`].
pub fn simulate_joint_controlled_watched<R: Real, C: JointController<R>>(
    rig: &JointRig<R>,
    start: JointState<R>,
    (duration, relative_tolerance): (R, f64),
    controller: &C,
    (sampling, sensors): (Sampling<R>, JointSensors<R>),
    mut watch: impl FnMut(f64),
) -> Result<ControlledJoint<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    let mut rig = rig.clone();
    let clockwork = Clockwork::begin(controller.begin(), sampling, rig.valves())?;
    let (trajectory, decisions) = clockwork.run(
        JointTrajectory::begin(rig, start, relative_tolerance)?,
        duration,
        |trajectory, until| trajectory.extend(until, &mut watch),
        |trajectory, clockwork| {
            let seen = sensors.show(&seen(clockwork.next(), &trajectory.reached(), trajectory.rig()));
            let drive = clockwork.sample(trajectory.rig_mut().valves(), |memory| controller.decide(&seen, memory))?;
            Ok(JointDecision { seen, aim: controller.aim(&seen), drive })
        },
    )?;
    Ok(ControlledJoint { trajectory, decisions })
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
