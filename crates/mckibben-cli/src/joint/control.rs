//! The run of a joint with a controller: the closed loop, and how far its goals were missed.

use super::outcome::{Outcome, Stepped};
use crate::closed_loop::{Goal, Goals, asked};
use crate::engine::{self, Way};
use mckibben::Error;
use mckibben::control::{Held, Quantity, SetPoint};
use mckibben::plant::{JointConsumer, JointPlant, JointRunEnd};
use mckibben::simulation::{ControlledJointStepper, JointDecision, JointRig};
use mckibben_scenario::{ControlledJointExperiment, Engine, JointExperiment};

/// What a controller did in a run.
#[derive(Clone, Debug)]
pub struct Closed {
    /// What was to be reached, and how far it was.
    pub goals: Vec<Goal>,
    /// How many samples the controller took.
    pub samples: usize,
    /// How often it asked something else of the valves of agonist and antagonist.
    pub requests: [usize; 2],
}

/// Runs the closed loop, calling `watch` with the time in s that has been reached. With fixed steps what holds at `times` in
/// s is kept, or at every sample interval.
///
/// # Errors
/// What the core finds.
pub fn close(
    of: &ControlledJointExperiment,
    times: Option<&[f64]>,
    mut watch: impl FnMut(f64) -> Result<(), Error>,
) -> Result<(Outcome, Closed), Error> {
    let ControlledJointExperiment { experiment, law, sampling, sensors, .. } = of;
    let JointExperiment { rig, start, run } = experiment;
    let with = (*sampling, *sensors);
    match run.engine {
        Engine::EventLocated => {
            let span = (run.duration, run.relative_tolerance);
            let joint = JointPlant::new(rig)?;
            let driver = joint.driver(law.clone(), with)?;
            let trajectory = joint.record(start, span, Some(driver), &mut watch)?;
            let closed = closed(of, trajectory.rig(), &trajectory.decisions());
            Ok((Outcome::Located(Box::new(trajectory)), closed))
        }
        Engine::FixedStep => {
            let (step, chosen) = experiment.step()?;
            let mut stepper = ControlledJointStepper::new(rig, *start, experiment.method(), law, with)?;
            let (mut samples, mut steps, mut reached) = (Vec::new(), 0, 0.0);
            for (time, recorded) in engine::ends(run, times, step) {
                if time > reached {
                    stepper.advance_to(time)?;
                    steps += 1;
                    reached = time;
                }
                if recorded {
                    samples.push(stepper.sample());
                    watch(time)?;
                }
            }
            let closed = closed(of, stepper.rig(), stepper.decisions());
            let rig = stepper.rig().clone();
            Ok((Outcome::Stepped(Box::new(Stepped { rig, samples, step, chosen, steps })), closed))
        }
    }
}

/// Runs the closed loop by the event-located engine and hands each accepted step to `consumer`; of the run nothing is kept but
/// what the controller did, which is added to `goals` and not to the result. A goal has what was decided before a step when the step is handed on.
///
/// # Errors
/// What the core finds, and what the consumer fails by.
pub(crate) fn stream(
    of: &ControlledJointExperiment,
    joint: &JointPlant,
    goals: &Goals,
    consumer: &mut JointConsumer<'_>,
) -> Result<(JointRunEnd, Closed), Error> {
    let ControlledJointExperiment { experiment, law, sampling, sensors, .. } = of;
    let JointExperiment { rig, start, run } = experiment;
    let (mut samples, mut way) = (0, Way::begin(run));
    let driver = joint.driver(law.clone(), (*sampling, *sensors))?;
    let end = joint.stream(start, (run.duration, run.relative_tolerance), Some(driver), &mut |step| {
        way.at(step.end());
        consumer(step)?;
        if let Some(decision) = step.decision() {
            samples += 1;
            add(&mut goals.borrow_mut(), of, rig, &decision);
        }
        Ok(())
    })?;
    let requests = requests(&end.rig);
    Ok((end, Closed { goals: Vec::new(), samples, requests }))
}

fn closed(of: &ControlledJointExperiment, rig: &JointRig, decisions: &[JointDecision]) -> Closed {
    let mut goals = begin_goals(of);
    decisions.iter().for_each(|decision| add(&mut goals, of, rig, decision));
    Closed { goals, samples: decisions.len(), requests: requests(rig) }
}

fn requests(rig: &JointRig) -> [usize; 2] {
    rig.driven().each_ref().map(|driven| asked(driven.actuation.as_ref()))
}

/// What is regulated, of the joint or of each actuator, then what else the file gives set points of, before the first sample.
pub(crate) fn begin_goals(of: &ControlledJointExperiment) -> Vec<Goal> {
    let whose = |whose| Goal { whose, ..Goal::new(of.regulated, true, []) };
    let mut goals = match of.regulated {
        Quantity::Angle => vec![whose(None)],
        _ => vec![whose(Some(0)), whose(Some(1))],
    };
    goals.extend(others(of).map(|(quantity, _)| Goal::new(*quantity, false, [])));
    goals
}

fn others(of: &ControlledJointExperiment) -> impl Iterator<Item = &(Quantity, SetPoint)> {
    of.set_points.iter().filter(|(quantity, _)| *quantity != of.regulated)
}

/// Adds what was to be reached and what was measured at a sampling instant.
fn add(goals: &mut [Goal], of: &ControlledJointExperiment, rig: &JointRig, decision: &JointDecision) {
    let (seen, time) = (&decision.seen, decision.seen.time);
    let held = if of.regulated == Quantity::Pressure { Held::Pressures } else { Held::AirMasses };
    let measured = |quantity: Quantity, whose: Option<usize>| match whose {
        Some(actuator) => quantity.of(&seen.actuators[actuator]),
        None if quantity == Quantity::Stiffness => {
            let atmosphere = |i: usize| rig.driven()[i].actuator.air().atmosphere();
            let pressure = [0, 1].map(|i| seen.actuators[i].pressure.absolute(atmosphere(i)));
            Some(rig.stiffness(seen.angle, pressure, held))
        }
        None => quantity.of_joint(seen),
    };
    let regulated = if of.regulated == Quantity::Angle { 1 } else { 2 };
    let Some((regulated, rest)) = goals.split_at_mut_checked(regulated) else { return };
    for (aim, goal) in decision.aim.iter().zip(regulated) {
        if let Some((quantity, target)) = *aim
            && let Some(measured) = measured(quantity, goal.whose)
        {
            goal.push((time, target, measured));
        }
    }
    for ((quantity, set_point), goal) in others(of).zip(rest) {
        if let Some(measured) = measured(*quantity, None) {
            goal.push((time, set_point.at(time), measured));
        }
    }
}
