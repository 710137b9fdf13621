//! Runs an experiment by the engine that its scenario names, and hands out what it found.
//!
//! | engine | kept | events | audit |
//! |---|---|---|---|
//! | event-located | the trajectory, as polynomials | all | energy and air |
//! | fixed-step | nothing: the run is repeated when it is read, to the same bits | none | air, by the net change of each step |
//!
//! The fixed-step engine divides each sample interval into the least number of equal steps that are not longer than
//! `run.step`. Checked by `tests/simulate.rs`.

use crate::progress::Progress;
use mckibben::Error;
use mckibben::simulation::{FixedStepper, Sample, SampleTimes, Trajectory, simulate_watched};
use mckibben_scenario::{Engine, Experiment, Method};

/// A finished run.
#[derive(Clone, Debug)]
pub enum Outcome<'e> {
    /// By the event-located engine.
    Located(Box<Trajectory>),
    /// By the fixed-step engine.
    Stepped {
        /// What is repeated to read it.
        experiment: &'e Experiment,
        /// How many steps that takes.
        steps: u64,
    },
}

/// Runs an experiment. With the fixed-step engine `watch` sees the start and every step; the event-located engine
/// keeps everything, to be looked at afterwards.
///
/// # Errors
/// [`Error::Stopped`] when the simulation cannot go on, and what the core finds out of range.
pub fn run<'e>(experiment: &'e Experiment, watch: &mut dyn FnMut(&Sample)) -> Result<Outcome<'e>, Error> {
    let run = &experiment.run;
    match run.engine {
        Engine::EventLocated => {
            const PARTS: f64 = 1000.0;
            let progress = Progress::begin("simulating", Some(PARTS as u64));
            let (rig, start) = (&experiment.rig, experiment.start);
            let trajectory = simulate_watched(rig, start, run.duration, run.relative_tolerance, |time| {
                progress.at((PARTS * time / run.duration) as u64);
            })?;
            Ok(Outcome::Located(Box::new(trajectory)))
        }
        Engine::FixedStep => {
            let progress = Progress::begin("simulating", Some(rows(experiment)));
            let mut steps = 0;
            let mut row = 0;
            step_through(experiment, &mut |sample, recorded| {
                watch(sample);
                steps += 1;
                row += u64::from(recorded);
                if recorded {
                    progress.at(row);
                }
                Ok(())
            })?;
            Ok(Outcome::Stepped { experiment, steps: steps - 1 })
        }
    }
}

impl Outcome<'_> {
    /// Hands the sample at t = 0, at every sample interval and at the end to `each`.
    ///
    /// # Errors
    /// What `each` returns; and for a fixed-step run what [`run`] would have returned.
    pub fn each_sample<F: From<Error>>(
        &self,
        interval: f64,
        each: &mut dyn FnMut(&Sample) -> Result<(), F>,
    ) -> Result<(), F> {
        match self {
            Self::Located(trajectory) => trajectory.samples(interval).try_for_each(|sample| each(&sample)),
            Self::Stepped { experiment, .. } => {
                step_through(experiment, &mut |sample, recorded| if recorded { each(sample) } else { Ok(()) })
            }
        }
    }
}

/// How many samples an experiment records.
pub fn rows(experiment: &Experiment) -> u64 {
    SampleTimes::new(experiment.run.duration, experiment.run.sample_interval).last() + 1
}

/// The least number of equal steps from one time to another that are not longer than `step`, all in s.
pub fn steps_between(from: f64, until: f64, step: f64) -> u64 {
    // The quotient of two decimal numbers may lie a rounding above a whole one.
    ((until - from) / step * (1.0 - 1e-12)).ceil().max(1.0) as u64
}

/// The formula of the fixed-step engine, as the core names it.
pub fn method(method: Method) -> mckibben::simulation::Method {
    match method {
        Method::Stable => mckibben::simulation::Method::Stable,
        Method::Rk4 => mckibben::simulation::Method::Rk4,
    }
}

/// Runs the fixed-step engine and shows every step, and whether it is a recorded sample.
fn step_through<F: From<Error>>(
    experiment: &Experiment,
    each: &mut dyn FnMut(&Sample, bool) -> Result<(), F>,
) -> Result<(), F> {
    let run = &experiment.run;
    let mut stepper = FixedStepper::new(&experiment.rig, experiment.start, method(run.method));
    each(&stepper.sample(), true)?;
    let times = SampleTimes::new(run.duration, run.sample_interval);
    for row in 1..=times.last() {
        let (from, until) = (times.time(row - 1), times.time(row));
        let parts = steps_between(from, until, run.step);
        for part in 1..=parts {
            let to = if part == parts { until } else { from + (until - from) * (part as f64 / parts as f64) };
            stepper.advance_to(to)?;
            each(&stepper.sample(), part == parts)?;
        }
    }
    Ok(())
}
