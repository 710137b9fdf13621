//! The controller's part in the run of a joint: what was to be reached, and how far it was.

use crate::closed_loop::Goal;
use mckibben::control::{Held, Quantity, SetPoint};
use mckibben::simulation::{JointDecision, JointRig};
use mckibben_scenario::ControlledJointExperiment;

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
pub(crate) fn add(goals: &mut [Goal], of: &ControlledJointExperiment, rig: &JointRig, decision: &JointDecision) {
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
