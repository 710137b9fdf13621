//! The run of a plant of several actuators: its columns, its events, and what it came to.
//!
//! | file | its idea |
//! |---|---|
//! | `columns` | columns with the names of the file: `flexor.absolute_pressure_pa`, `knee.angle_rad`, `tank.absolute_pressure_pa` |
//! | `control` | the controllers' part: what was to be reached, and how far it was |
//! | `events` | the log of events |
//! | `observation` | extremes, counts and the ledger, observed as the run is made |
//!
//! A run is kept, for figures, events and values between samples, or streamed: then memory does not grow with it. Checked by
//! the program's `tests/plant.rs`.

pub(crate) mod columns;
pub mod control;
pub(crate) mod events;
pub mod observation;

use crate::closed_loop::Goals;
use crate::engine::{Stepping, Way};
use crate::failure::Failure;
use crate::record::Field;
use crate::settle::{End, Settled};
use control::{Closed, Follower};
use mckibben::Error;
use mckibben::parameter;
use mckibben::plant::{Part, PlantConsumer, PlantRun, PlantSample, PlantTrajectory};
use mckibben_scenario::PlantExperiment;
use observation::{Observation, Observer};

/// A run of a plant that is kept.
#[derive(Clone, Debug)]
pub struct PlantOutcome {
    /// What was simulated.
    pub experiment: PlantExperiment,
    /// The run.
    pub trajectory: PlantTrajectory,
    /// What was observed.
    pub observation: Observation,
    /// The controllers' part in it, if there are any.
    pub control: Option<Closed>,
}

/// The figures of a run of a plant.
#[derive(Clone, Debug)]
pub struct PlantFigures {
    /// What was simulated.
    pub experiment: PlantExperiment,
    /// What was observed.
    pub observation: Observation,
    /// The controllers' part in it, if there are any.
    pub control: Option<Closed>,
}

impl PlantOutcome {
    /// Hands the sample at t = 0, at every sample interval and at the end to `each`.
    pub(crate) fn each_sample(&self, each: &mut dyn FnMut(&PlantSample) -> Result<(), Failure>) -> Result<(), Failure> {
        self.trajectory.samples(self.experiment.run.sample_interval).try_for_each(|sample| each(&sample))
    }

    /// Its columns.
    pub(crate) fn fields(&self) -> Vec<Field<PlantSample>> {
        let (goals, names) = self.control.as_ref().map_or((&[][..], &[][..]), |of| (&of.goals[..], &of.names[..]));
        columns::fields(&self.experiment, &Goals::new(goals.to_vec().into()), names)
    }

    /// Its figures.
    pub(crate) fn figures(&self) -> PlantFigures {
        let Self { experiment, observation, control, .. } = self.clone();
        PlantFigures { experiment, observation, control }
    }
}

/// A run with how it goes through time.
pub(crate) struct Made {
    pub(crate) run: PlantRun,
    pub(crate) stepping: Stepping,
}

/// A run before its first step, with its controllers.
pub(crate) fn begin(of: &PlantExperiment) -> Result<Made, Error> {
    parameter::DURATION.check(of.run.duration)?;
    let stepping = Stepping::of(&of.run, || of.stepping())?;
    let drivers = of.drivers();
    Ok(Made { run: PlantRun::with_drivers(&of.plant, &of.start, stepping.how, drivers)?, stepping })
}

/// Runs a plant and keeps every step up to `run.duration`; what it settles to is read where `end` says so. `reached` is called with the
/// time in s now and then, and may end the run.
///
/// # Errors
/// What the core finds.
pub fn run(
    of: PlantExperiment,
    end: End,
    reached: &mut dyn FnMut(f64) -> Result<(), Error>,
) -> Result<(PlantOutcome, Option<Settled>), Error> {
    let mut made = begin(&of)?;
    let mut way = Way::begin(&of.run).keeping(of.plant.bytes_per_step());
    let trajectory = made.run.record_to(of.run.duration, &mut |time| {
        way.kept(time);
        reached(time)
    })?;
    let mut follower = Follower::new(&of);
    trajectory.decisions().iter().for_each(|(driver, decision)| follower.see((*driver, decision)));
    let control = follower.finish();
    let mut observer = Observer::new(&of);
    trajectory.replay(&mut |step| {
        observer.step(step);
        Ok(())
    })?;
    let observation = observer.finish(&made);
    let settled = settle(&of, end, made.run)?;
    Ok((PlantOutcome { experiment: of, trajectory, observation, control }, settled))
}

/// Goes on with a run from its end, where that is wanted.
///
/// # Errors
/// What the core finds.
pub(crate) fn settle(of: &PlantExperiment, end: End, run: PlantRun) -> Result<Option<Settled>, Error> {
    end.go_on((run, &of.run), &columns::fields(of, &Goals::default(), &[]), PlantSample::clone)
}

/// Runs a plant and hands each accepted step to `consumer`; of the run nothing is kept but what the controllers did, which
/// the follower sees behind each step.
///
/// # Errors
/// What the core finds, and what the consumer fails by.
pub(crate) fn stream(
    of: &PlantExperiment,
    follower: &mut Follower<'_>,
    consumer: &mut PlantConsumer<'_>,
) -> Result<Made, Error> {
    let mut made = begin(of)?;
    let mut way = Way::begin(&of.run);
    made.run.stream_to(of.run.duration, &mut |step| {
        way.at(step.end());
        consumer(step)?;
        if let Some(decision) = step.decision() {
            follower.see(decision);
        }
        Ok(())
    })?;
    Ok(made)
}

/// The figures of a run that was streamed to its end.
pub(crate) fn figures(
    of: &PlantExperiment,
    (observer, follower): (Observer<'_>, Follower<'_>),
    made: &Made,
) -> PlantFigures {
    PlantFigures { experiment: of.clone(), observation: observer.finish(made), control: follower.finish() }
}

/// What the file calls a part; of what it does not name, what that belongs to.
pub(crate) fn name_of(of: &PlantExperiment, part: Part) -> &str {
    let names = &of.names;
    let actuator = |index: usize| names.actuators.get(index).map_or("", String::as_str);
    match part {
        Part::Actuator(index) => actuator(index),
        Part::Mechanism(index) => {
            let alone = || of.plant.actuators().iter().position(|mounted| mounted.mechanism == index);
            let named = names.mechanisms.get(index).and_then(|its| its.name.as_deref());
            named.or_else(|| Some(actuator(alone()?))).unwrap_or("")
        }
        Part::Joint(index, joint) => {
            names.mechanisms.get(index).and_then(|its| its.joints.get(joint)).map_or("", String::as_str)
        }
        Part::Valve(valve) => match names.valves.iter().position(|its| *its == Some(valve)) {
            Some(index) => actuator(index),
            None => names.supply_valves.iter().find(|(_, its)| *its == valve).map_or("", |(name, _)| name.as_str()),
        },
        Part::Node(index) => of.owner_of_node(index),
        Part::Branch(index) => of.plant.network().branches.get(index).map_or("", |branch| of.owner_of_node(branch.to)),
        Part::Driver(driver) => of.controls.get(driver).map_or("", |control| control::name(of, control)),
    }
}
