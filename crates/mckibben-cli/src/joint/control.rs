//! The run of a joint with a controller: the closed loop, and how far its goals were missed.

use super::outcome::{Outcome, Stepped};
use crate::closed_loop::{Goal, asked};
use crate::engine;
use mckibben::Error;
use mckibben::control::{Held, Quantity};
use mckibben::simulation::{
    ControlledJoint, ControlledJointStepper, JointDecision, JointRig, simulate_joint_controlled_watched,
};
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
            let ControlledJoint { trajectory, decisions } =
                simulate_joint_controlled_watched(rig, *start, span, law, with, watch)?;
            let closed = closed(of, trajectory.rig(), &decisions);
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

fn closed(of: &ControlledJointExperiment, rig: &JointRig, decisions: &[JointDecision]) -> Closed {
    let requests = rig.driven().each_ref().map(|driven| asked(driven.actuation.as_ref()));
    Closed { goals: goals(of, rig, decisions), samples: decisions.len(), requests }
}

/// What is regulated, then what else the file gives set points of.
fn goals(of: &ControlledJointExperiment, rig: &JointRig, decisions: &[JointDecision]) -> Vec<Goal> {
    let held = if of.regulated == Quantity::Pressure { Held::Pressures } else { Held::AirMasses };
    let measured = |quantity: Quantity, whose: Option<usize>, decision: &JointDecision| {
        let seen = &decision.seen;
        match whose {
            Some(actuator) => quantity.of(&seen.actuators[actuator]),
            None if quantity == Quantity::Stiffness => {
                let atmosphere = |i: usize| rig.driven()[i].actuator.air().atmosphere();
                let pressure = [0, 1].map(|i| seen.actuators[i].pressure.absolute(atmosphere(i)));
                Some(rig.stiffness(seen.angle, pressure, held))
            }
            None => quantity.of_joint(seen),
        }
    };
    let mut goals = Vec::new();
    for index in 0..2 {
        let whose = (of.regulated != Quantity::Angle).then_some(index);
        let rows = decisions.iter().filter_map(|decision| {
            let (quantity, target) = decision.aim[index]?;
            Some((decision.seen.time, target, measured(quantity, whose, decision)?))
        });
        let goal = Goal { whose, ..Goal::new(of.regulated, true, rows) };
        goals.extend(Some(goal).filter(|goal| !goal.time.is_empty()));
    }
    for (quantity, set_point) in of.set_points.iter().filter(|(quantity, _)| *quantity != of.regulated) {
        let rows = decisions.iter().filter_map(|decision| {
            let time = decision.seen.time;
            Some((time, set_point.at(time), measured(*quantity, None, decision)?))
        });
        goals.push(Goal::new(*quantity, false, rows));
    }
    goals
}
