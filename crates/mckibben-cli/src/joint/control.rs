//! The run of a joint with a controller: the closed loop, and how far its goals were missed.

use crate::closed_loop::{Goal, asked};
use mckibben::Error;
use mckibben::control::{Held, Quantity};
use mckibben::simulation::{
    ControlledJoint, JointDecision, JointRig, JointTrajectory, simulate_joint_controlled_watched,
};
use mckibben_scenario::ControlledJointExperiment;

/// A closed loop that has been run.
#[derive(Clone, Debug)]
pub struct Closed {
    /// The run.
    pub trajectory: JointTrajectory,
    /// What was to be reached, and how far it was.
    pub goals: Vec<Goal>,
    /// How many samples the controller took.
    pub samples: usize,
}

/// Runs the closed loop, calling `watch` with the time in s that has been reached.
///
/// # Errors
/// What the core finds.
pub fn close(of: &ControlledJointExperiment, watch: impl FnMut(f64)) -> Result<Closed, Error> {
    let ControlledJointExperiment { experiment, law, sampling, sensors, .. } = of;
    let span = (experiment.run.duration, experiment.run.relative_tolerance);
    let ControlledJoint { trajectory, decisions } =
        simulate_joint_controlled_watched(&experiment.rig, experiment.start, span, law, (*sampling, *sensors), watch)?;
    Ok(Closed { goals: goals(of, trajectory.rig(), &decisions), samples: decisions.len(), trajectory })
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

impl Closed {
    /// How often it asked something else of the valves of agonist and antagonist.
    pub fn requests(&self) -> [usize; 2] {
        self.trajectory.rig().driven().each_ref().map(|driven| asked(driven.actuation.as_ref()))
    }
}
