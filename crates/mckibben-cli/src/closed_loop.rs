//! A run with a controller: the closed loop is run first; what it asked of the valve is then a command like any other.

use crate::engine::{self, Outcome};
use crate::progress::Progress;
use mckibben::Error;
use mckibben::control::Quantity;
use mckibben::simulation::{
    Actuation, Controlled, ControlledStepper, Decision, Rig, Sample, SampleTimes, Trajectory,
    simulate_controlled_watched,
};
use mckibben::valve::Command;
use mckibben_scenario::{ControlledExperiment, Engine, Experiment};

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
    trajectory: Option<Trajectory>,
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
        for (time, target, measured) in rows {
            goal.time.push(time);
            goal.target.push(target);
            goal.measured.push(measured);
        }
        goal
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
    const PARTS: f64 = 1000.0;
    let progress = Progress::begin("simulating", Some(PARTS as u64));
    close_watched(of, |time| {
        progress.at((PARTS * time / of.experiment.run.duration) as u64);
        reached(time)
    })
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
            let span = (run.duration, run.relative_tolerance);
            let Controlled { trajectory, decisions } =
                simulate_controlled_watched(rig, start, span, law, (*sampling, *sensors), watch)?;
            Ok(closed(&trajectory.rig().clone(), &decisions, Some(trajectory)))
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

/// What is regulated, then what else the file gives set points of.
pub(crate) fn goals(of: &ControlledExperiment, decisions: &[Decision]) -> Vec<Goal> {
    let measured = |quantity: Quantity, decision: &Decision| quantity.of(&decision.seen);
    let regulated = decisions.iter().filter_map(|decision| {
        let (quantity, target) = decision.aim?;
        Some((decision.seen.time, target, measured(quantity, decision)?))
    });
    let mut goals = vec![Goal::new(of.regulated, true, regulated)];
    for (quantity, set_point) in of.set_points.iter().filter(|(quantity, _)| *quantity != of.regulated) {
        let rows = decisions.iter().filter_map(|decision| {
            let time = decision.seen.time;
            Some((time, set_point.at(time), measured(*quantity, decision)?))
        });
        goals.push(Goal::new(*quantity, false, rows));
    }
    goals
}

impl Closed {
    /// The run, where it is kept: by the event-located engine.
    pub fn located(&self) -> Option<&Trajectory> {
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

    /// The run; the fixed-step engine repeats it, divided at the sampling instants as before, and shows every step.
    ///
    /// # Errors
    /// What the core finds.
    pub fn outcome(&self, watch: &mut dyn FnMut(&Sample) -> Result<(), Error>) -> Result<Outcome, Error> {
        let experiment = &self.experiment;
        match &self.trajectory {
            Some(trajectory) => Ok(Outcome::Located(Box::new(trajectory.clone()))),
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
