//! Runs an experiment by the engine that its scenario names, and hands out what it found.
//!
//! | engine | kept | events | audit |
//! |---|---|---|---|
//! | event-located | the trajectory, as polynomials | all | energy and air |
//! | fixed-step | nothing: the run is repeated when it is read, to the same bits | none | air, by the net change of each step |
//!
//! The fixed-step engine divides each sample interval into the least number of equal steps that are not longer than
//! `run.step`, or than the step that `run.accuracy` needs. Checked by `tests/simulate.rs`.

use crate::progress::Progress;
use mckibben::Error;
use mckibben::simulation::accuracy::StepError;
use mckibben::simulation::{FixedStepper, Rig, Sample, SampleTimes, Trajectory, simulate_watched, steps_between};
use mckibben_scenario::{Engine, Experiment, Run};

/// A finished run.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// By the event-located engine.
    Located(Box<Trajectory>),
    /// By the fixed-step engine.
    Stepped {
        /// What is repeated to read it.
        experiment: Box<Experiment>,
        /// The longest step in s.
        step: f64,
        /// The error of that step, when it was chosen for the accuracy.
        chosen: Option<StepError>,
        /// How many steps that takes.
        steps: u64,
        /// Times in s at which steps are divided besides: the sampling instants of a controller.
        divisions: Vec<f64>,
    },
}

/// Runs an experiment. With the fixed-step engine `watch` sees the start and every step; the event-located engine
/// keeps everything, to be looked at afterwards. `reached` hears the time in s now and then, and may end the run.
///
/// # Errors
/// [`Error::Stopped`] when the simulation cannot go on, and what the core finds out of range.
pub fn run(
    experiment: &Experiment,
    watch: &mut dyn FnMut(&Sample),
    reached: &mut dyn FnMut(f64) -> Result<(), Error>,
) -> Result<Outcome, Error> {
    let run = &experiment.run;
    match run.engine {
        Engine::EventLocated => {
            const PARTS: f64 = 1000.0;
            let progress = Progress::begin("simulating", Some(PARTS as u64));
            let (rig, start) = (&experiment.rig, experiment.start);
            let trajectory = simulate_watched(rig, start, run.duration, run.relative_tolerance, |time| {
                progress.at((PARTS * time / run.duration) as u64);
                reached(time)
            })?;
            Ok(Outcome::Located(Box::new(trajectory)))
        }
        Engine::FixedStep => {
            let (step, chosen) = {
                let _progress = Progress::begin("choosing the step", None);
                experiment.step()?
            };
            run_steps(experiment, (step, chosen), Vec::new(), &mut |sample| {
                watch(sample);
                reached(sample.time)
            })
        }
    }
}

/// Runs an experiment by the fixed-step engine with steps of at most `step` s that are divided at `divisions` (s, rising).
///
/// # Errors
/// As [`run`].
pub fn run_steps(
    experiment: &Experiment,
    (step, chosen): (f64, Option<StepError>),
    divisions: Vec<f64>,
    watch: &mut dyn FnMut(&Sample) -> Result<(), Error>,
) -> Result<Outcome, Error> {
    let progress = Progress::begin("simulating", Some(rows(&experiment.run)));
    let (mut steps, mut row) = (0, 0);
    step_through(experiment, regular(&experiment.run, step), &divisions, &mut |sample, recorded| {
        watch(sample)?;
        steps += 1;
        row += u64::from(recorded);
        if recorded {
            progress.at(row);
        }
        Ok::<_, Error>(())
    })?;
    let experiment = Box::new(experiment.clone());
    Ok(Outcome::Stepped { experiment, step, chosen, steps: steps - 1, divisions })
}

impl Outcome {
    /// The rig that was run.
    pub fn rig(&self) -> &Rig {
        match self {
            Self::Located(trajectory) => trajectory.rig(),
            Self::Stepped { experiment, .. } => &experiment.rig,
        }
    }

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
            Self::Stepped { experiment, step, divisions, .. } => {
                let ends = regular(&experiment.run, *step);
                step_through(experiment, ends, divisions, &mut |sample, recorded| {
                    if recorded { each(sample) } else { Ok(()) }
                })
            }
        }
    }
}

/// How many samples a run records.
pub fn rows(run: &Run) -> u64 {
    SampleTimes::new(run.duration, run.sample_interval).last() + 1
}

/// The ends in s of the steps of a run that are not longer than `step` s, and whether each is recorded; also the start.
pub(crate) fn regular(run: &Run, step: f64) -> impl Iterator<Item = (f64, bool)> + use<> {
    std::iter::once((0.0, true)).chain(SampleTimes::new(run.duration, run.sample_interval).steps(step))
}

/// The same where only what holds at some times in s is recorded, and the run ends with the last.
pub(crate) fn listed(times: &[f64], step: f64) -> impl Iterator<Item = (f64, bool)> {
    let from = std::iter::once(0.0).chain(times.iter().copied());
    from.zip(times).flat_map(move |(from, until)| {
        let parts = steps_between(from, *until, step);
        let end = move |part| from + (until - from) * (part as f64 / parts as f64);
        (1..=parts).map(move |part| if part == parts { (*until, true) } else { (end(part), false) })
    })
}

/// One or the other.
pub(crate) fn ends<'t>(run: &Run, times: Option<&'t [f64]>, step: f64) -> Box<dyn Iterator<Item = (f64, bool)> + 't> {
    match times {
        Some(times) => Box::new(listed(times, step)),
        None => Box::new(regular(run, step)),
    }
}

/// Runs the fixed-step engine and shows every end of a step, and whether it is a recorded sample; steps are divided at
/// `divisions` besides.
pub(crate) fn step_through<F: From<Error>>(
    experiment: &Experiment,
    ends: impl Iterator<Item = (f64, bool)>,
    divisions: &[f64],
    each: &mut dyn FnMut(&Sample, bool) -> Result<(), F>,
) -> Result<(), F> {
    let mut stepper = FixedStepper::new(&experiment.rig, experiment.start, experiment.method());
    let mut divisions = divisions.iter().peekable();
    for (time, recorded) in ends {
        // A division that differs from the end by rounding is the end, as it is where the loop is closed.
        while let Some(division) = divisions.next_if(|division| **division <= time + 8.0 * f64::EPSILON * time) {
            stepper.advance_to(division.min(time))?;
        }
        if time > stepper.time() {
            stepper.advance_to(time)?;
        }
        each(&stepper.sample(), recorded)?;
    }
    Ok(())
}
