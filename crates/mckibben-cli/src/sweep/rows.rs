//! The runs of a unit of work.
//!
//! Rows of the fixed-step engine whose times and words are the same go through time side by side, in a [`Batch`] of one
//! block, which stays on the unit's thread, with a controller too if it is asked for all samples of the run; rows of the
//! event-located engine, and those of a joint or of a controller with a tendon in series, run one by one. Either way a row is, bit for bit, what
//! it is by itself. A row that cannot be built or cannot go on gives its reason and nothing else.

use super::plant;
use super::reduce::{Reducer, Seen};
use super::step::{self, Choice};
use crate::closed_loop::{self, Goal};
use crate::engine;
use crate::joint;
use crate::observation::AirUse;
use crate::record::COLUMNS;
use mckibben::Error;
use mckibben::batch::{Batch, ControlledRow, Row, Width};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{JointRig, JointSample, Method, Sample, SampleTimes, simulate, steps_between};
use mckibben_scenario::sweep::Quantity;
use mckibben_scenario::{
    AxisValue, ControlledExperiment, ControlledJointExperiment, Engine, Experiment, JointExperiment, Record, Reduction,
    Run, Scenario, Sweep,
};
use std::ops::Range;

/// Rows that a thread steps side by side.
pub fn side_by_side() -> usize {
    Width::widest().rows()
}

/// What a run came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The value of each reduction that has one.
    Reduced(Vec<Option<f64>>),
    /// Samples in the order of time.
    Sampled(Samples),
    /// Why there is nothing.
    Failed(String),
}

/// Samples of one actuator, or of a joint with two.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Of one actuator.
    Actuator(Vec<Sample>),
    /// Of a joint.
    Joint(Vec<JointSample>),
    /// Of a plant: a line for each sample, the time before the columns of the sweep.
    Plant(Vec<Vec<PlantCell>>),
}

/// What stands in a line of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlantCell {
    /// A number.
    Number(f64),
    /// A word.
    Word(&'static str),
}

/// Simulates the rows, with a step for all of them where they have none by themselves.
pub fn simulate_rows(sweep: &Sweep, choice: Option<&Choice>, rows: Range<u64>) -> Vec<Outcome> {
    let (first, side_by_side) = (rows.start, side_by_side());
    let mut outcomes: Vec<Outcome> = Vec::new();
    let (mut open, mut closed) = (Groups::new(), Groups::new());
    for row in rows {
        let index = (row - first) as usize;
        // What a batch will compute is put in its place afterwards.
        let mut outcome = Outcome::Reduced(Vec::new());
        if let Some(built) = sweep.plant(row) {
            outcomes.push(match built.and_then(|of| within(sweep.record(), of.run.duration).map(|()| of)) {
                Ok(of) => plant::run(&of, sweep.plant_columns(), sweep.record()),
                Err(reason) => Outcome::Failed(reason),
            });
            continue;
        }
        match build(sweep, row) {
            Err(reason) => outcome = Outcome::Failed(reason),
            Ok(Built::Controlled(of)) if goes_along(&of.experiment, sweep.record()) => match of.experiment.step() {
                Err(error) => outcome = Outcome::Failed(error.to_string()),
                Ok((step, _)) => {
                    let kin = Kin::of(sweep, row, &of.experiment, step);
                    join(&mut closed, kin, (index, *of), side_by_side);
                }
            },
            Ok(Built::Controlled(of)) => outcome = control(&of, sweep.record()),
            Ok(Built::Joint(of)) => outcome = turn(&of, choice, sweep.record()),
            Ok(Built::ControlledJoint(of)) => outcome = turn_controlled(&of, sweep.record()),
            Ok(Built::Open(experiment)) if experiment.run.engine == Engine::EventLocated => {
                outcome = locate(&experiment, sweep.record());
            }
            Ok(Built::Open(experiment)) => {
                match step::of_row(&experiment.run, choice, || experiment.step().map(|(step, _)| step)) {
                    Err(error) => outcome = Outcome::Failed(error.to_string()),
                    Ok(step) => {
                        let kin = Kin::of(sweep, row, &experiment, step);
                        join(&mut open, kin, (index, *experiment), side_by_side);
                    }
                }
            }
        }
        outcomes.push(outcome);
    }
    for (kin, members) in open {
        advance(&kin, members, sweep.record(), &mut outcomes);
    }
    for (kin, members) in closed {
        advance_controlled(&kin, members, sweep.record(), &mut outcomes);
    }
    outcomes
}

/// Rows that go through time side by side, each with its place among the outcomes.
type Groups<'a, T> = Vec<(Kin<'a>, Vec<(usize, T)>)>;

/// Puts a row to its like, or begins a group.
fn join<'a, T>(groups: &mut Groups<'a, T>, kin: Kin<'a>, member: (usize, T), side_by_side: usize) {
    match groups.iter_mut().find(|(known, rows)| *known == kin && rows.len() < side_by_side) {
        Some((_, members)) => members.push(member),
        None => groups.push((kin, vec![member])),
    }
}

/// Whether a row with a controller may go side by side with others: at fixed steps, without a tendon in series, and where all
/// samples count. Where some are listed, steps end at those, and the loop is closed first with steps of its own.
fn goes_along(experiment: &Experiment, record: &Record) -> bool {
    let side_by_side = experiment.run.engine == Engine::FixedStep && experiment.rig.tendon().is_none();
    side_by_side && listed(record).is_none()
}

/// What a row describes.
enum Built {
    Open(Box<Experiment>),
    Controlled(Box<ControlledExperiment>),
    Joint(Box<JointExperiment>),
    ControlledJoint(Box<ControlledJointExperiment>),
}

fn build(sweep: &Sweep, row: u64) -> Result<Built, String> {
    let scenario = sweep.scenario(row).map_err(|error| error.error.to_string())?;
    within(sweep.record(), scenario.run.duration)?;
    describe(&scenario).map_err(|error| error.to_string())
}

/// That the times that are recorded lie within a run that ends at a time in s.
fn within(record: &Record, end: f64) -> Result<(), String> {
    match record {
        Record::Samples(times) => match times.iter().find(|time| **time > end) {
            Some(time) => Err(format!(
                "sweep.sample_times has {time} s, but this run ends at run.duration = {end} s; record earlier times"
            )),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

fn describe(scenario: &Scenario) -> Result<Built, Error> {
    let built = match (scenario.has_joint(), scenario.has_controller()) {
        (false, true) => scenario.controlled_experiment()?.map(|of| Built::Controlled(Box::new(of))),
        (true, false) => scenario.joint_experiment()?.map(|of| Built::Joint(Box::new(of))),
        (true, true) => scenario.controlled_joint_experiment()?.map(|of| Built::ControlledJoint(Box::new(of))),
        (false, false) => None,
    };
    built.map_or_else(|| scenario.experiment().map(|of| Built::Open(Box::new(of))), Ok)
}

/// What rows of the fixed-step engine share that go through time side by side: their times, and the words of the sweep,
/// on which the form of their laws hangs.
#[derive(Clone, Debug, PartialEq)]
struct Kin<'a> {
    duration: f64,
    sample_interval: f64,
    step: f64,
    method: Method,
    words: Vec<&'a str>,
}

impl<'a> Kin<'a> {
    fn of(sweep: &'a Sweep, row: u64, experiment: &Experiment, step: f64) -> Self {
        let (duration, sample_interval) = (experiment.run.duration, experiment.run.sample_interval);
        let word = |axis| match sweep.value(axis, row) {
            AxisValue::Word(word) => Some(word),
            AxisValue::Number(_) => None,
        };
        let words = (0..sweep.axes().len()).filter_map(word).collect();
        Self { duration, sample_interval, step, method: experiment.method(), words }
    }
}

/// The instants that a record looks at.
#[derive(Clone, Copy, Debug)]
enum Stops<'a> {
    Regular(SampleTimes),
    Listed(&'a [f64]),
}

impl<'a> Stops<'a> {
    fn of(record: &'a Record, duration: f64, interval: f64) -> Self {
        match record {
            Record::Samples(times) => Self::Listed(times),
            Record::Reductions(_) | Record::PlantReductions(_) | Record::Trajectories => {
                Self::Regular(SampleTimes::new(duration, interval))
            }
        }
    }

    fn times(self) -> impl Iterator<Item = f64> + 'a {
        let count = match self {
            Self::Regular(times) => times.last() + 1,
            Self::Listed(times) => times.len() as u64,
        };
        (0..count).map(move |index| match self {
            Self::Regular(times) => times.time(index),
            Self::Listed(times) => times[index as usize],
        })
    }
}

/// What is made of the samples of a run.
#[derive(Debug)]
enum Recorder<'a> {
    Reducing(&'a [Reduction], Reducer),
    Keeping(Vec<Sample>),
    KeepingJoint(Vec<JointSample>),
    Stopped(String),
}

impl<'a> Recorder<'a> {
    fn new(record: &'a Record, experiment: &Experiment) -> Self {
        match record {
            Record::Reductions(reductions) => {
                let command = experiment.rig.actuation().map(|actuation| &actuation.command);
                Self::Reducing(reductions, Reducer::new(reductions, command, experiment.run.duration))
            }
            // Those of plants have rows of their own.
            Record::Samples(_) | Record::Trajectories | Record::PlantReductions(_) => Self::Keeping(Vec::new()),
        }
    }

    fn see(&mut self, sample: &Sample) {
        if let Some(fault) = not_finite(sample) {
            *self = Self::Stopped(fault);
        }
        match self {
            Self::Reducing(_, reducer) => reducer.see(Seen::Actuator(sample)),
            Self::Keeping(samples) => samples.push(*sample),
            Self::KeepingJoint(_) | Self::Stopped(_) => {}
        }
    }

    fn see_joint(&mut self, sample: &JointSample, rig: &JointRig) {
        if let Some(fault) = sample.actuators.iter().find_map(not_finite) {
            *self = Self::Stopped(fault);
        }
        match self {
            Self::Reducing(_, reducer) => reducer.see(Seen::Joint(sample, rig)),
            Self::KeepingJoint(samples) => samples.push(*sample),
            Self::Keeping(_) | Self::Stopped(_) => {}
        }
    }

    /// The reductions under way, where one is of this quantity.
    fn reducing(&mut self, quantity: Quantity) -> Option<&mut Reducer> {
        match self {
            Self::Reducing(reductions, reducer) => {
                reductions.iter().any(|reduction| reduction.quantity == quantity).then_some(reducer)
            }
            _ => None,
        }
    }

    fn has_stopped(&self) -> bool {
        matches!(self, Self::Stopped(_))
    }

    fn finish(self) -> Outcome {
        match self {
            Self::Reducing(reductions, reducer) => Outcome::Reduced(reducer.finish(reductions)),
            Self::Keeping(samples) => Outcome::Sampled(Samples::Actuator(samples)),
            Self::KeepingJoint(samples) => Outcome::Sampled(Samples::Joint(samples)),
            Self::Stopped(reason) => Outcome::Failed(reason),
        }
    }
}

/// What of a sample is not finite, in words.
fn not_finite(sample: &Sample) -> Option<String> {
    let numbers = COLUMNS.iter().map(|column| (column.name, (column.value)(sample)));
    let (name, value) = numbers.into_iter().find(|(_, value)| !value.is_finite())?;
    Some(format!("{name} = {value} at t = {} s is not a finite number", sample.time))
}

/// Runs rows by the fixed-step engine, side by side.
fn advance(kin: &Kin<'_>, members: Vec<(usize, Experiment)>, record: &Record, outcomes: &mut [Outcome]) {
    let mut recorders: Vec<(usize, Recorder<'_>)> =
        members.iter().map(|(index, experiment)| (*index, Recorder::new(record, experiment))).collect();
    let rows = members.into_iter().map(|(_, Experiment { rig, start, .. })| Row { rig, start }).collect();
    record_batch(&mut Batch::new(rows, kin.method), kin, &mut recorders, record);
    for (index, recorder) in recorders {
        outcomes[index] = recorder.finish();
    }
}

/// The same with controllers.
fn advance_controlled(
    kin: &Kin<'_>,
    members: Vec<(usize, ControlledExperiment)>,
    record: &Record,
    outcomes: &mut [Outcome],
) {
    let row = |(_, of): &(usize, ControlledExperiment)| ControlledRow {
        rig: of.experiment.rig.clone(),
        start: of.experiment.start,
        controller: of.law.clone(),
        sampling: of.sampling,
        sensors: of.sensors,
    };
    let Ok(mut batch) = Batch::controlled(members.iter().map(row).collect(), kin.method) else {
        // Each says by itself why not.
        members.iter().for_each(|(index, of)| outcomes[*index] = control(of, record));
        return;
    };
    let mut recorders: Vec<(usize, Recorder<'_>)> =
        members.iter().map(|(index, of)| (*index, Recorder::new(record, &of.experiment))).collect();
    record_batch(&mut batch, kin, &mut recorders, record);
    for (row, ((index, of), (_, mut recorder))) in members.iter().zip(recorders).enumerate() {
        if let Recorder::Reducing(_, reducer) = &mut recorder {
            reducer.set_goals(closed_loop::goals(of, batch.decisions(row)));
        }
        outcomes[*index] = recorder.finish();
    }
}

/// Takes a batch through time and records what it shows.
fn record_batch(batch: &mut Batch, kin: &Kin<'_>, recorders: &mut [(usize, Recorder<'_>)], record: &Record) {
    for until in Stops::of(record, kin.duration, kin.sample_interval).times() {
        batch.advance(until, steps_between(batch.time(), until, kin.step));
        for ((_, recorder), sample) in recorders.iter_mut().zip(batch.samples()) {
            match sample {
                Ok(sample) => recorder.see(&sample),
                Err(error) if !recorder.has_stopped() => *recorder = Recorder::Stopped(error.to_string()),
                Err(_) => {}
            }
        }
        if recorders.iter().all(|(_, recorder)| recorder.has_stopped()) {
            break;
        }
    }
}

/// Runs a row by the event-located engine.
fn locate(experiment: &Experiment, record: &Record) -> Outcome {
    let (rig, run) = (&experiment.rig, &experiment.run);
    match simulate(rig, experiment.start, run.duration, run.relative_tolerance) {
        Ok(trajectory) => look_at(&trajectory, run, Recorder::new(record, experiment), record),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

/// Runs a row with a controller, as `mckibben simulate` does.
fn control(of: &ControlledExperiment, record: &Record) -> Outcome {
    let closed = match closed_loop::close_watched(of, |_| Ok(())) {
        Ok(closed) => closed,
        Err(error) => return Outcome::Failed(error.to_string()),
    };
    let experiment = &closed.experiment;
    let mut recorder = Recorder::new(record, experiment);
    if let Recorder::Reducing(_, reducer) = &mut recorder {
        reducer.set_goals(closed.goals.clone());
    }
    if let Some(trajectory) = closed.located() {
        return look_at(trajectory, &experiment.run, recorder, record);
    }
    let mut see = |sample: &Sample, recorded: bool| {
        if recorded {
            recorder.see(sample);
        }
        Ok(())
    };
    let run = experiment.step().and_then(|(step, _)| {
        let ends = engine::ends(&experiment.run, listed(record), step);
        engine::step_through(experiment, ends, closed.instants(), &mut see)
    });
    run.map_or_else(|error| Outcome::Failed(error.to_string()), |()| recorder.finish())
}

/// The times in s that alone are recorded, where they are listed.
fn listed(record: &Record) -> Option<&[f64]> {
    match record {
        Record::Samples(times) => Some(times),
        Record::Reductions(_) | Record::PlantReductions(_) | Record::Trajectories => None,
    }
}

/// Runs a row with a joint, as `mckibben simulate` does.
fn turn(of: &JointExperiment, choice: Option<&Choice>, record: &Record) -> Outcome {
    let run = match of.run.engine {
        Engine::EventLocated => joint::outcome::locate(of, |_| Ok(())),
        Engine::FixedStep => {
            let needed = || of.step().map(|(step, _)| step);
            step::of_row(&of.run, choice, needed).and_then(|step| {
                let ends = engine::ends(&of.run, listed(record), step);
                joint::outcome::step_through(of, (step, None), ends, |_| Ok(()))
            })
        }
    };
    run.map_or_else(|error| Outcome::Failed(error.to_string()), |run| look_at_joint(&run, of, Vec::new(), record))
}

/// Runs a row with a joint and a controller, as `mckibben simulate` does.
fn turn_controlled(of: &ControlledJointExperiment, record: &Record) -> Outcome {
    match joint::control::close(of, listed(record), |_| Ok(())) {
        Ok((run, closed)) => look_at_joint(&run, &of.experiment, closed.goals, record),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

/// Records the run of a joint.
fn look_at_joint(run: &joint::outcome::Outcome, of: &JointExperiment, goals: Vec<Goal>, record: &Record) -> Outcome {
    let command = of.rig.driven()[0].actuation.as_ref().map(|actuation| &actuation.command);
    let mut recorder = match record {
        Record::Reductions(reductions) => {
            let mut reducer = Reducer::new(reductions, command, of.run.duration);
            reducer.set_goals(goals);
            Recorder::Reducing(reductions, reducer)
        }
        Record::Samples(_) | Record::Trajectories | Record::PlantReductions(_) => Recorder::KeepingJoint(Vec::new()),
    };
    match (record, run.located()) {
        (Record::Samples(times), Some(trajectory)) => {
            trajectory.at_each(times.iter().copied()).for_each(|sample| recorder.see_joint(&sample, &of.rig));
        }
        _ => run.samples(of.run.sample_interval).for_each(|sample| recorder.see_joint(&sample, &of.rig)),
    }
    if let (Some(reducer), Some(trajectory)) = (recorder.reducing(Quantity::Air), run.located()) {
        reducer.set_air_used(joint::summary::used(trajectory).iter().map(|air| air.from_supply).sum());
    }
    recorder.finish()
}

/// Records a run of the event-located engine.
fn look_at(trajectory: &RigTrajectory, run: &Run, mut recorder: Recorder<'_>, record: &Record) -> Outcome {
    match record {
        Record::Samples(times) => times.iter().for_each(|time| recorder.see(&trajectory.at(*time))),
        Record::Reductions(_) | Record::PlantReductions(_) | Record::Trajectories => {
            trajectory.samples(run.sample_interval).for_each(|sample| recorder.see(&sample));
        }
    }
    if let Some(reducer) = recorder.reducing(Quantity::Air) {
        reducer.set_air_used(air_used(trajectory));
    }
    recorder.finish()
}

/// Air in kg that came from the supply.
fn air_used(trajectory: &RigTrajectory) -> f64 {
    let mut air = AirUse::default();
    trajectory.quadrature(|weight, _, flows| air.see(weight, flows));
    air.from_supply
}
