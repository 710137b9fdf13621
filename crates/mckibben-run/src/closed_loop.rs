//! A controller's part in a run: what was to be reached, and how far it was.

use mckibben::control::{Quantity, SetPoint};
use mckibben::simulation::{Actuation, Decision};
use mckibben::valve::Command;
use mckibben_scenario::ControlledExperiment;
use std::cell::RefCell;
use std::rc::Rc;

/// Goals that grow while a run is made.
pub(crate) type Goals = Rc<RefCell<Vec<Goal>>>;

/// What a controller did in a run.
#[derive(Clone, Debug)]
pub struct Closed {
    /// What was to be reached, and how far it was.
    pub goals: Vec<Goal>,
    /// How many samples the controller took.
    pub samples: usize,
    /// How often it requested something else of each valve.
    pub requests: Vec<usize>,
}

/// A set point and what was measured of its quantity, at the sampling instants.
#[derive(Clone, Debug)]
pub struct Goal {
    /// Of what.
    pub quantity: Quantity,
    /// Of which actuator of a joint, 0 the agonist and 1 the antagonist; `None` for one actuator alone and for the joint.
    pub whose: Option<usize>,
    /// Whether the controller regulates it; what is not regulated is as near as the controller's model is right.
    pub regulated: bool,
    /// The instants in s.
    pub time: Vec<f64>,
    /// Where it was to be.
    pub target: Vec<f64>,
    /// Where it was, as the sensor showed it; a stiffness follows from what it showed.
    pub measured: Vec<f64>,
}

/// How far a goal was missed at the sampling instants, in the unit of its quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miss {
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub largest: f64,
    /// When that was, in s.
    pub at: f64,
}

impl Goal {
    /// Set points of a quantity with what was measured, as `(time, target, measured)`.
    pub fn new(quantity: Quantity, regulated: bool, rows: impl IntoIterator<Item = (f64, f64, f64)>) -> Self {
        let mut goal =
            Self { quantity, whose: None, regulated, time: Vec::new(), target: Vec::new(), measured: Vec::new() };
        rows.into_iter().for_each(|row| goal.push(row));
        goal
    }

    /// Adds a set point and what was measured, as `(time, target, measured)`.
    pub(crate) fn push(&mut self, (time, target, measured): (f64, f64, f64)) {
        self.time.push(time);
        self.target.push(target);
        self.measured.push(measured);
    }

    /// How far it was missed.
    pub fn miss(&self) -> Miss {
        let mut miss = Miss { rms: 0.0, largest: 0.0, at: 0.0 };
        for ((time, target), measured) in self.time.iter().zip(&self.target).zip(&self.measured) {
            let error = (target - measured).abs();
            miss.rms += error * error / self.time.len() as f64;
            if error > miss.largest {
                (miss.largest, miss.at) = (error, *time);
            }
        }
        Miss { rms: miss.rms.sqrt(), ..miss }
    }
}

/// How often something else was requested of a valve.
pub(crate) fn requests(actuation: Option<&Actuation>) -> usize {
    match actuation.map(|actuation| &actuation.command) {
        Some(Command::Table { time, .. }) => time.len(),
        _ => 0,
    }
}

/// What is regulated, then what else the file gives set points of, before the first sample.
pub(crate) fn begin_goals(of: &ControlledExperiment) -> Vec<Goal> {
    let others = others(of).map(|(quantity, _)| Goal::new(*quantity, false, []));
    std::iter::once(Goal::new(of.regulated, true, [])).chain(others).collect()
}

fn others(of: &ControlledExperiment) -> impl Iterator<Item = &(Quantity, SetPoint)> {
    of.set_points.iter().filter(|(quantity, _)| *quantity != of.regulated)
}

/// Adds what was to be reached and what was measured at a sampling instant.
pub(crate) fn add(goals: &mut [Goal], of: &ControlledExperiment, decision: &Decision) {
    let (time, measured) = (decision.seen.time, |quantity: Quantity| quantity.of(&decision.seen));
    let [regulated, rest @ ..] = goals else { return };
    if let Some((quantity, target)) = decision.aim
        && let Some(measured) = measured(quantity)
    {
        regulated.push((time, target, measured));
    }
    for ((quantity, set_point), goal) in others(of).zip(rest) {
        if let Some(measured) = measured(*quantity) {
            goal.push((time, set_point.at(time), measured));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_miss_is_root_mean_square_and_largest() {
        let goal = Goal::new(Quantity::Length, true, [(0.0, 1.0, 1.0), (0.5, 1.0, 4.0), (1.0, 1.0, -3.0)]);
        let Miss { rms, largest, at } = goal.miss();
        assert!((rms - (25.0f64 / 3.0).sqrt()).abs() < 1e-15, "{rms}");
        assert_eq!((largest, at), (4.0, 1.0));
    }
}
