//! A run with a controller: the closed loop is run first; what it asked of the valve is then a command like
//! any other.

use crate::engine::{self, Outcome};
use crate::progress::Progress;
use mckibben::Error;
use mckibben::simulation::{
    Controlled, ControlledStepper, Decision, Rig, Sample, SampleTimes, Trajectory, simulate_controlled_watched,
};
use mckibben_scenario::{ControlledExperiment, Engine, Experiment};

/// A closed loop that has been run.
pub(crate) struct Closed {
    /// What was simulated, with the command that the controller made.
    pub(crate) experiment: Experiment,
    /// What was decided at each sampling instant.
    pub(crate) decisions: Vec<Decision>,
    /// By the event-located engine.
    trajectory: Option<Trajectory>,
}

/// Runs the closed loop.
pub(crate) fn close(of: &ControlledExperiment) -> Result<Closed, Error> {
    const PARTS: f64 = 1000.0;
    let ControlledExperiment { experiment, law, sampling, sensors, .. } = of;
    let (rig, start, run) = (&experiment.rig, experiment.start, experiment.run);
    let with = |rig: &Rig| Experiment { rig: rig.clone(), ..experiment.clone() };
    let progress = Progress::begin("simulating", Some(PARTS as u64));
    let watch = |time: f64| progress.at((PARTS * time / run.duration) as u64);
    match run.engine {
        Engine::EventLocated => {
            let span = (run.duration, run.relative_tolerance);
            let Controlled { trajectory, decisions } =
                simulate_controlled_watched(rig, start, span, law, (*sampling, *sensors), watch)?;
            Ok(Closed { experiment: with(trajectory.rig()), decisions, trajectory: Some(trajectory) })
        }
        Engine::FixedStep => {
            let (step, _) = experiment.step()?;
            let mut stepper = ControlledStepper::new(rig, start, experiment.method(), law, (*sampling, *sensors))?;
            for (time, recorded) in SampleTimes::new(run.duration, run.sample_interval).steps(step) {
                stepper.advance_to(time)?;
                if recorded {
                    watch(time);
                }
            }
            let decisions = stepper.decisions().to_vec();
            Ok(Closed { experiment: with(stepper.rig()), decisions, trajectory: None })
        }
    }
}

impl Closed {
    /// The run; the fixed-step engine repeats it, divided at the sampling instants as before, and shows every step.
    pub(crate) fn outcome<'e>(
        &self,
        experiment: &'e Experiment,
        watch: &mut dyn FnMut(&Sample),
    ) -> Result<Outcome<'e>, Error> {
        match &self.trajectory {
            Some(trajectory) => Ok(Outcome::Located(Box::new(trajectory.clone()))),
            None => {
                let instants = self.decisions.iter().map(|decision| decision.seen.time).collect();
                engine::run_steps(experiment, experiment.step()?, instants, watch)
            }
        }
    }
}
