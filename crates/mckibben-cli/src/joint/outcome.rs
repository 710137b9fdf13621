//! A joint's run by the engine that its scenario names.
//!
//! The event-located engine keeps the trajectory; of the fixed-step engine the recorded samples are kept, and no events.

use crate::engine::{self, Way};
use mckibben::Error;
use mckibben::plant::{JointConsumer, JointEvent, JointPlant, JointRunEnd, JointTrajectory};
use mckibben::simulation::{JointRig, JointSample, JointStepError, JointStepper};
use mckibben_scenario::{Engine, JointExperiment};

/// A joint's finished run.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// By the event-located engine.
    Located(Box<JointTrajectory>),
    /// By the fixed-step engine.
    Stepped(Box<Stepped>),
}

/// What is kept of a run at fixed steps.
#[derive(Clone, Debug)]
pub struct Stepped {
    /// What was run.
    pub rig: JointRig,
    /// The samples at the recording interval.
    pub samples: Vec<JointSample>,
    /// The longest step in s.
    pub step: f64,
    /// The error of that step, when it was chosen for the accuracy.
    pub chosen: Option<JointStepError>,
    /// How many steps were taken.
    pub steps: u64,
}

/// Runs a joint without a controller and shows how far it is. `reached` hears the time in s now and then, and may end the run.
///
/// # Errors
/// What the core finds.
pub fn run(of: &JointExperiment, reached: &mut dyn FnMut(f64) -> Result<(), Error>) -> Result<Outcome, Error> {
    let mut way = way(of);
    let watch = |time: f64| {
        way.kept(time);
        reached(time)
    };
    match of.run.engine {
        Engine::EventLocated => locate(of, watch),
        Engine::FixedStep => {
            let (step, chosen) = of.step()?;
            step_through(of, (step, chosen), engine::regular(&of.run, step), watch)
        }
    }
}

/// How far a run is that keeps every step where the engine is the event-located one.
pub(crate) fn way(of: &JointExperiment) -> Way {
    match of.run.engine {
        Engine::EventLocated => keeping(of),
        Engine::FixedStep => Way::begin(&of.run),
    }
}

/// How far a run is that keeps every step.
fn keeping(of: &JointExperiment) -> Way {
    let way = Way::begin(&of.run);
    match JointPlant::new(&of.rig) {
        Ok(joint) => way.keeping(joint.plant().bytes_per_step()),
        // What cannot be run says so when it is run.
        Err(_) => way,
    }
}

/// Runs a joint, with its plant, by the event-located engine and hands each accepted step to `consumer`; nothing is kept.
///
/// # Errors
/// What the core finds, and what the consumer fails by.
pub(crate) fn stream(
    of: &JointExperiment,
    joint: &JointPlant,
    consumer: &mut JointConsumer<'_>,
) -> Result<JointRunEnd, Error> {
    let (run, mut way) = (&of.run, Way::begin(&of.run));
    joint.stream(&of.start, (run.duration, run.relative_tolerance), None, &mut |step| {
        way.at(step.end());
        consumer(step)
    })
}

/// Runs a joint by the event-located engine, calling `watch` with the time in s that has been reached.
///
/// # Errors
/// What the core finds.
pub fn locate(of: &JointExperiment, mut watch: impl FnMut(f64) -> Result<(), Error>) -> Result<Outcome, Error> {
    let span = (of.run.duration, of.run.relative_tolerance);
    let trajectory = JointPlant::new(&of.rig)?.record(&of.start, span, None, &mut watch)?;
    Ok(Outcome::Located(Box::new(trajectory)))
}

/// Runs a joint at fixed steps with these ends, of which some are recorded; the longest step in s stands beside its error.
///
/// # Errors
/// What the core finds.
pub fn step_through(
    of: &JointExperiment,
    (step, chosen): (f64, Option<JointStepError>),
    ends: impl Iterator<Item = (f64, bool)>,
    mut watch: impl FnMut(f64) -> Result<(), Error>,
) -> Result<Outcome, Error> {
    let stepper = JointStepper::new(of.rig.clone(), of.method())?;
    let mut course = stepper.begin(of.start);
    let (mut samples, mut steps) = (Vec::new(), 0);
    for (time, recorded) in ends {
        if time > course.time() {
            stepper.advance_to(&mut course, time)?;
            steps += 1;
        }
        if recorded {
            samples.push(stepper.sample(&course));
            watch(time)?;
        }
    }
    Ok(Outcome::Stepped(Box::new(Stepped { rig: of.rig.clone(), samples, step, chosen, steps })))
}

impl Outcome {
    /// The joint that was run.
    pub fn rig(&self) -> &JointRig {
        match self {
            Self::Located(trajectory) => trajectory.rig(),
            Self::Stepped(stepped) => &stepped.rig,
        }
    }

    /// The trajectory, where there is one.
    pub fn located(&self) -> Option<&JointTrajectory> {
        match self {
            Self::Located(trajectory) => Some(trajectory),
            Self::Stepped(_) => None,
        }
    }

    /// The events in order of time; the fixed-step engine keeps none.
    pub fn events(&self) -> &[JointEvent] {
        self.located().map_or(&[], JointTrajectory::events)
    }

    /// Samples at `interval` s and at the end; of fixed steps those that were recorded.
    pub fn samples(&self, interval: f64) -> Box<dyn Iterator<Item = JointSample> + '_> {
        match self {
            Self::Located(trajectory) => Box::new(trajectory.samples(interval)),
            Self::Stepped(stepped) => Box::new(stepped.samples.iter().copied()),
        }
    }
}
