//! The controllers' part in a run of a plant: what was to be reached, and how far it was.

use crate::closed_loop::{Goal, Goals};
use mckibben::GaugePressure;
use mckibben::command::{PlantDecision, PlantMeasurement};
use mckibben::control::{Held, Quantity};
use mckibben::valve::RuntimeCommand;
use mckibben_scenario::{JointControl, PlantControl, PlantExperiment};

/// What the controllers of a plant did in a run.
#[derive(Clone, Debug)]
pub struct Closed {
    /// What was to be reached, and how far it was: of the controllers in their order.
    pub goals: Vec<Goal>,
    /// What each goal is of, as the file calls it.
    pub names: Vec<String>,
    /// How many samples each controller took.
    pub samples: Vec<u64>,
    /// How often each changed what it requests of its valves.
    pub requests: Vec<u64>,
}

/// Follows what controllers decide while a run is made.
pub(crate) struct Follower<'e> {
    experiment: &'e PlantExperiment,
    goals: Goals,
    /// The first goal of each controller.
    first: Vec<usize>,
    samples: Vec<u64>,
    requests: Vec<u64>,
    last: Vec<Vec<Option<RuntimeCommand>>>,
}

impl<'e> Follower<'e> {
    pub(crate) fn new(experiment: &'e PlantExperiment) -> Self {
        let (mut goals, mut first) = (Vec::new(), Vec::new());
        for control in &experiment.controls {
            first.push(goals.len());
            goals.extend(begin(control));
        }
        let count = experiment.controls.len();
        Self {
            experiment,
            goals: Goals::new(goals.into()),
            first,
            samples: vec![0; count],
            requests: vec![0; count],
            last: vec![Vec::new(); count],
        }
    }

    /// The goals, which grow as the run is made.
    pub(crate) fn goals(&self) -> &Goals {
        &self.goals
    }

    /// What each goal is of.
    pub(crate) fn names(&self) -> Vec<String> {
        self.experiment.controls.iter().flat_map(|control| names(self.experiment, control)).collect()
    }

    /// Which controller each goal is of.
    pub(crate) fn owners(&self) -> Vec<usize> {
        let of = |index| self.first.partition_point(|first| *first <= index) - 1;
        (0..self.goals.borrow().len()).map(of).collect()
    }

    /// Takes what a controller decided.
    pub(crate) fn see(&mut self, (driver, decision): (usize, &PlantDecision)) {
        let Some(control) = self.experiment.controls.get(driver) else { return };
        self.samples[driver] += 1;
        if self.last[driver] != decision.commands {
            self.requests[driver] += 1;
            self.last[driver].clone_from(&decision.commands);
        }
        let mut goals = self.goals.borrow_mut();
        let own = self.first[driver]..self.first.get(driver + 1).copied().unwrap_or(goals.len());
        add(&mut goals[own], control, self.experiment, decision);
    }

    /// What the controllers did; none where there is no controller.
    pub(crate) fn finish(self) -> Option<Closed> {
        let names = self.names();
        let Self { experiment, goals, samples, requests, .. } = self;
        // Columns may still read the goals.
        let goals = goals.borrow().clone();
        (!experiment.controls.is_empty()).then_some(Closed { goals, names, samples, requests })
    }
}

/// What a controller regulates, then what else the file gives set points of, before the first sample.
fn begin(control: &PlantControl) -> Vec<Goal> {
    let regulated = control.regulated();
    let count = if is_of_pair(control) { 2 } else { 1 };
    let own = (0..count).map(|_| Goal::new(regulated, true, []));
    own.chain(others(control).map(|(quantity, _)| Goal::new(*quantity, false, []))).collect()
}

/// Whether the two actuators of a joint are regulated one by one.
fn is_of_pair(control: &PlantControl) -> bool {
    matches!(control, PlantControl::Joint(_)) && control.regulated() != Quantity::Angle
}

fn others(control: &PlantControl) -> impl Iterator<Item = &(Quantity, mckibben::control::SetPoint)> {
    let regulated = control.regulated();
    control.set_points().iter().filter(move |(quantity, _)| *quantity != regulated)
}

/// What the goals of a controller are of.
fn names(of: &PlantExperiment, control: &PlantControl) -> Vec<String> {
    let actuator = |index: usize| of.names.actuators[index].clone();
    let own = match control {
        PlantControl::Actuator(control) => vec![actuator(control.actuator)],
        PlantControl::Joint(of_joint) if is_of_pair(control) => of_joint.actuators.map(actuator).to_vec(),
        PlantControl::Joint(_) => vec![name(of, control).to_owned()],
    };
    own.into_iter().chain(others(control).map(|_| name(of, control).to_owned())).collect()
}

/// What a controller is of.
pub fn name<'n>(of: &'n PlantExperiment, control: &PlantControl) -> &'n str {
    let names = &of.names;
    match control {
        PlantControl::Actuator(control) => names.actuators.get(control.actuator),
        PlantControl::Joint(control) => {
            let (mechanism, joint) = control.joint;
            names.mechanisms.get(mechanism).and_then(|names| names.joints.get(joint))
        }
    }
    .map_or("", String::as_str)
}

fn add(goals: &mut [Goal], control: &PlantControl, of: &PlantExperiment, decision: &PlantDecision) {
    let (seen, time) = (&decision.seen, decision.seen.time);
    let regulated = if is_of_pair(control) { 2 } else { 1 };
    let Some((own, rest)) = goals.split_at_mut_checked(regulated) else { return };
    for (index, (goal, (quantity, target))) in own.iter_mut().zip(&decision.aims).enumerate() {
        let measured = match control {
            PlantControl::Actuator(control) => quantity.of(&seen.actuators[control.actuator]),
            PlantControl::Joint(joint) if regulated == 2 => quantity.of(&seen.actuators[joint.actuators[index]]),
            PlantControl::Joint(joint) => of_joint(*quantity, joint, of, seen),
        };
        if let Some(measured) = measured {
            goal.push((time, *target, measured));
        }
    }
    for ((quantity, set_point), goal) in others(control).zip(rest) {
        let measured = match control {
            PlantControl::Actuator(control) => quantity.of(&seen.actuators[control.actuator]),
            PlantControl::Joint(joint) => of_joint(*quantity, joint, of, seen),
        };
        if let Some(measured) = measured {
            goal.push((time, set_point.at(time), measured));
        }
    }
}

/// A quantity of a joint, as sensors showed it.
fn of_joint(quantity: Quantity, joint: &JointControl, of: &PlantExperiment, seen: &PlantMeasurement) -> Option<f64> {
    let shown = seen.of_joint(joint.joint, joint.actuators)?;
    if quantity != Quantity::Stiffness {
        return quantity.of_joint(&shown);
    }
    let rig = joint.model.as_ref()?;
    let held = if joint.regulated == Quantity::Pressure { Held::Pressures } else { Held::AirMasses };
    let atmosphere = |i: usize| of.plant.actuators()[joint.actuators[i]].actuator.air().atmosphere();
    let pressure = [0, 1].map(|i| GaugePressure(shown.actuators[i].pressure.0).absolute(atmosphere(i)));
    Some(rig.stiffness(shown.angle, pressure, held))
}
