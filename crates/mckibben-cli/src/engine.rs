//! Runs an experiment by the engine that its scenario names, and hands out what it found.
//!
//! | engine | kept | events | audit |
//! |---|---|---|---|
//! | event-located | the trajectory, as polynomials, where a figure or events are wanted; else nothing: each step goes to a consumer | all | energy and air |
//! | fixed-step | nothing: the run is repeated when it is read, to the same bits | none | air, by the net change of each step |
//!
//! The fixed-step engine divides each sample interval into the least number of equal steps that are not longer than
//! `run.step`, or than the step that `run.accuracy` needs. Checked by `tests/simulate.rs`.

use crate::progress::Progress;
use crate::quantities::{self, given};
use mckibben::Error;
use mckibben::plant::{RigConsumer, RigPlant, RigRunEnd, RigTrajectory, STEPS_WATCHED};
use mckibben::simulation::accuracy::StepError;
use mckibben::simulation::{FixedStepper, Rig, Sample, SampleTimes, steps_between};
use mckibben_scenario::{Engine, Experiment, Run};

/// A finished run.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// By the event-located engine.
    Located(Box<RigTrajectory>),
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
            let of = RigPlant::new(&experiment.rig);
            let mut way = Way::begin(run).keeping(of.plant().bytes_per_step());
            let span = (run.duration, run.relative_tolerance);
            let trajectory = of.record(&experiment.start, span, None, &mut |time| {
                way.kept(time);
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

/// Runs an experiment, with its plant, by the event-located engine and hands each accepted step to `consumer`; nothing is kept.
///
/// # Errors
/// As [`run`], and those of the consumer.
pub fn stream(experiment: &Experiment, of: &RigPlant, consumer: &mut RigConsumer<'_>) -> Result<RigRunEnd, Error> {
    let (run, mut way) = (&experiment.run, Way::begin(&experiment.run));
    of.stream(&experiment.start, (run.duration, run.relative_tolerance), None, &mut |step| {
        way.at(step.end());
        consumer(step)
    })
}

/// How far an event-located run is, and what it keeps.
#[derive(Debug)]
pub(crate) struct Way {
    progress: Progress,
    duration: f64,
    /// What a step takes in bytes where all are kept.
    bytes: Option<usize>,
    kept: u64,
}

/// Bytes that a run keeps before it says so.
const WORTH_SAYING: u64 = 256 << 20;

impl Way {
    /// Begins a run.
    pub(crate) fn begin(run: &Run) -> Self {
        let progress = Progress::begin("simulating", Some(PARTS as u64));
        Self { progress, duration: run.duration, bytes: None, kept: 0 }
    }

    /// Of a run that keeps every step, each of so many bytes.
    pub(crate) fn keeping(self, bytes: usize) -> Self {
        Self { bytes: Some(bytes), ..self }
    }

    /// It has come to a time in s.
    pub(crate) fn at(&mut self, time: f64) {
        self.progress.at((PARTS * time / self.duration) as u64);
    }

    /// The same, at a call of a watcher of a run that keeps every step.
    pub(crate) fn kept(&mut self, time: f64) {
        self.at(time);
        let before = self.kept;
        self.kept += STEPS_WATCHED as u64 * self.bytes.unwrap_or(0) as u64;
        if before < WORTH_SAYING && self.kept >= WORTH_SAYING && time > 0.0 {
            let (now, end) = (gigabytes(self.kept as f64), gigabytes(self.kept as f64 * self.duration / time));
            let (time, duration) = (given(time, "s"), given(self.duration, "s"));
            // Over a bar this would leave half a line.
            self.progress.say(&format!(
                "note: every step is kept, for figures, events and values between samples: {now} at {time}, about {end} at \
                 {duration}; `mckibben simulate` with --output alone keeps nothing"
            ));
        }
    }
}

/// Parts of a run that its bar shows.
const PARTS: f64 = 1000.0;

fn gigabytes(bytes: f64) -> String {
    format!("{} GB", quantities::digits(bytes / 1e9))
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
