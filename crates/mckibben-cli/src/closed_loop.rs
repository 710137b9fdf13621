//! A run with a controller: the closed loop is run first; what it asked of the valve is then a command like any other.

use crate::engine::Way;
use crate::engine::{self, Outcome};
use mckibben::Error;
use mckibben::control::{Quantity, SetPoint};
use mckibben::plant::{RigConsumer, RigPlant, RigRunEnd, RigTrajectory};
use mckibben::simulation::{Actuation, ControlledStepper, Decision, Rig, Sample, SampleTimes};
use mckibben::valve::Command;
use mckibben_scenario::{ControlledExperiment, Engine, Experiment};
use std::cell::RefCell;
use std::rc::Rc;

/// Goals that grow while a run is made.
pub(crate) type Goals = Rc<RefCell<Vec<Goal>>>;

/// A closed loop that has been run.
#[derive(Clone, Debug)]
pub struct Closed {
    /// What was simulated, with the command that the controller made.
    pub experiment: Experiment,
    /// What was to be reached, and how far it was.
    pub goals: Vec<Goal>,
    /// The sampling instants in s.
    instants: Vec<f64>,
    /// By the event-located engine.
    trajectory: Option<RigTrajectory>,
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

/// Runs the closed loop and shows how far it is. `reached` hears the time in s now and then, and may end the run.
///
/// # Errors
/// What the core finds.
pub fn close(of: &ControlledExperiment, reached: &mut dyn FnMut(f64) -> Result<(), Error>) -> Result<Closed, Error> {
    let run = &of.experiment.run;
    let mut way = Way::begin(run);
    if run.engine == Engine::EventLocated {
        way = way.keeping(RigPlant::new(&of.experiment.rig).plant().bytes_per_step());
    }
    close_watched(of, |time| {
        way.kept(time);
        reached(time)
    })
}

/// Runs the closed loop, with its plant, by the event-located engine and hands each accepted step to `consumer`; of the run nothing is kept but
/// what the controller did, which is added to `goals` and not to the result. A goal has what was decided before a step when the step is handed on.
///
/// # Errors
/// What the core finds, and what the consumer fails by.
pub(crate) fn stream(
    of: &ControlledExperiment,
    plant: &RigPlant,
    goals: &Goals,
    consumer: &mut RigConsumer<'_>,
) -> Result<(RigRunEnd, Closed), Error> {
    let ControlledExperiment { experiment, law, sampling, sensors, .. } = of;
    let (run, mut instants, mut way) = (experiment.run, Vec::new(), Way::begin(&experiment.run));
    let driver = plant.driver(law.clone(), (*sampling, *sensors))?;
    let end = plant.stream(&experiment.start, (run.duration, run.relative_tolerance), Some(driver), &mut |step| {
        way.at(step.end());
        consumer(step)?;
        if let Some(decision) = step.decision() {
            instants.push(decision.seen.time);
            add(&mut goals.borrow_mut(), of, &decision);
        }
        Ok(())
    })?;
    let experiment = Experiment { rig: end.rig.clone(), ..experiment.clone() };
    Ok((end, Closed { experiment, goals: Vec::new(), instants, trajectory: None }))
}

/// Runs the closed loop, calling `watch` with the time in s that has been reached, now and then.
///
/// # Errors
/// What the core finds.
pub fn close_watched(
    of: &ControlledExperiment,
    mut watch: impl FnMut(f64) -> Result<(), Error>,
) -> Result<Closed, Error> {
    let ControlledExperiment { experiment, law, sampling, sensors, .. } = of;
    let (rig, start, run) = (&experiment.rig, experiment.start, experiment.run);
    let closed = |rig: &Rig, decisions: &[Decision], trajectory| Closed {
        experiment: Experiment { rig: rig.clone(), ..experiment.clone() },
        goals: goals(of, decisions),
        instants: decisions.iter().map(|decision| decision.seen.time).collect(),
        trajectory,
    };
    match run.engine {
        Engine::EventLocated => {
            let plant = RigPlant::new(rig);
            let driver = plant.driver(law.clone(), (*sampling, *sensors))?;
            let trajectory = plant.record(&start, (run.duration, run.relative_tolerance), Some(driver), &mut watch)?;
            Ok(closed(&trajectory.rig().clone(), &trajectory.decisions(), Some(trajectory)))
        }
        Engine::FixedStep => {
            let (step, _) = experiment.step()?;
            let mut stepper = ControlledStepper::new(rig, start, experiment.method(), law, (*sampling, *sensors))?;
            for (time, recorded) in SampleTimes::new(run.duration, run.sample_interval).steps(step) {
                stepper.advance_to(time)?;
                if recorded {
                    watch(time)?;
                }
            }
            Ok(closed(stepper.rig(), stepper.decisions(), None))
        }
    }
}

/// How often something else was asked of a valve.
pub(crate) fn asked(actuation: Option<&Actuation>) -> usize {
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
fn add(goals: &mut [Goal], of: &ControlledExperiment, decision: &Decision) {
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

/// The goals with all that was decided.
pub(crate) fn goals(of: &ControlledExperiment, decisions: &[Decision]) -> Vec<Goal> {
    let mut goals = begin_goals(of);
    decisions.iter().for_each(|decision| add(&mut goals, of, decision));
    goals
}

impl Closed {
    /// The run, where it is kept: by the event-located engine.
    pub fn located(&self) -> Option<&RigTrajectory> {
        self.trajectory.as_ref()
    }

    /// The sampling instants in s.
    pub fn instants(&self) -> &[f64] {
        &self.instants
    }

    /// How many samples the controller took.
    pub fn samples(&self) -> usize {
        self.instants.len()
    }

    /// How often it asked something else of the valve.
    pub fn requests(&self) -> usize {
        asked(self.experiment.rig.actuation())
    }

    /// The run, which is no longer held here; the fixed-step engine repeats it, divided at the sampling instants as before, and shows every step.
    ///
    /// # Errors
    /// What the core finds.
    pub fn outcome(&mut self, watch: &mut dyn FnMut(&Sample) -> Result<(), Error>) -> Result<Outcome, Error> {
        let experiment = &self.experiment;
        match self.trajectory.take() {
            Some(trajectory) => Ok(Outcome::Located(Box::new(trajectory))),
            None => engine::run_steps(experiment, experiment.step()?, self.instants.clone(), watch),
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
