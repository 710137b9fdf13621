//! The runs of a unit of work.
//!
//! | a row goes through time | when |
//! |---|---|
//! | side by side with others, in a [`PlantBatch`] | at fixed steps, if its samples are all that is looked at |
//! | individually, each step handed on and not kept | by the event-located engine; where steps are looked at: for air that sources gave and its exergy, and for how far a controller missed; and where it goes on to its orbit |
//!
//! Rows of a batch have the same times and words, so that the batch is one group and stays on the unit's thread. A row is
//! bit-identical to its individual run. A row that cannot be built or cannot go on gives its reason and nothing else.

use super::plant;
use super::reduce::{Reducer, Seen};
use super::series::Windows;
use super::step::{self, Choice};
use crate::closed_loop::Goal;
use crate::engine::Subject;
use crate::joint::pair::Pair;
use crate::record::{Field, of_actuator, of_joint_alone};
use crate::run::Ready;
use crate::settle::{self, OnOrbit};
use crate::single_actuator::SingleActuator;
use crate::table::Cell;
use crate::warnings::{Reached, Warning};
use mckibben::command::Driver;
use mckibben::plant::{
    Plant, PlantLedger, PlantLedgerKeeper, PlantRun, PlantSample, PlantSampler, PlantStart, PlantStep, PlantSteps,
    PlantView, TimeStepping,
};
use mckibben::simulation::{JointRig, JointSample, Reading, Rig, Sample, SampleTimes};
use mckibben::valve::Command;
use mckibben::{Actuator, Error};
use mckibben_batch::{PlantBatch, Width};
use mckibben_scenario::sweep::Quantity;
use mckibben_scenario::{AxisValue, Record, Reduction, Run, Scenario, StatisticsOver, Sweep};
use std::ops::Range;

/// Rows that a thread steps side by side.
pub fn side_by_side() -> usize {
    Width::widest().rows()
}

/// Called now and then, by any thread, with the time in s that a run has reached. Its error, [`Error::Interrupted`], ends all runs.
pub type Check<'a> = dyn Fn(f64) -> Result<(), Error> + Sync + 'a;

/// The check of a caller that waits for the end.
pub const UNCHECKED: &Check<'static> = &|_| Ok(());

/// What a run came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The value of each reduction that has one.
    Reduced(Vec<Option<f64>>),
    /// A row of cells for each sample, in the order of time and of the sweep's columns.
    Sampled(Vec<Vec<Cell<'static>>>),
    /// Why there is nothing.
    Failed(String),
}

/// Makes something of what a run shows, in the order of time.
pub(super) trait Recorder {
    /// Takes a sample.
    fn see(&mut self, sample: &PlantSample);

    /// The samples that come are of the orbit behind the run, with the windows of ripples there; without them there is none.
    fn turn_to_orbit(&mut self, windows: Option<Windows>);

    /// Takes a sample of the orbit, with its weight in s in integrals, in a window of ripples as of [`Windows::of`].
    fn see_orbit(&mut self, window: usize, weight: f64, sample: &PlantSample);

    /// Whether it takes steps besides.
    fn takes_steps(&self) -> bool;

    /// Takes a step, after the samples within it.
    fn step(&mut self, step: &PlantStep<'_>);

    /// What the run came to; it is given where steps were taken.
    fn finish(self: Box<Self>, run: Option<&PlantRun>) -> Outcome;
}

/// A recorder, and what of the actuators the warnings need: extremes of the samples.
struct Watch<'r> {
    recorder: Box<dyn Recorder + 'r>,
    actuators: Vec<Actuator>,
    reached: Vec<Reached>,
    /// That there is no orbit, where statistics are taken over that.
    unsettled: Option<Warning>,
}

impl<'r> Watch<'r> {
    fn new(plant: &Plant, recorder: Box<dyn Recorder + 'r>) -> Self {
        let actuators: Vec<Actuator> = plant.actuators().iter().map(|mounted| mounted.actuator.clone()).collect();
        Self { recorder, reached: vec![Reached::NONE; actuators.len()], actuators, unsettled: None }
    }

    fn see(&mut self, sample: &PlantSample) {
        self.reach(sample);
        self.recorder.see(sample);
    }

    /// Sees a sample of the last so many periods, those in which ripples are looked for.
    fn see_orbit(&mut self, OnOrbit { period, weight, sample }: OnOrbit<'_>, periods: u32) {
        self.reach(sample);
        self.recorder.see_orbit((periods - 1 - period) as usize, weight, sample);
    }

    fn reach(&mut self, sample: &PlantSample) {
        for ((reached, actuator), sample) in self.reached.iter_mut().zip(&self.actuators).zip(&sample.actuators) {
            reached.see_briefly(actuator, sample);
        }
    }

    fn finish(self, run: Option<&PlantRun>) -> Ended {
        let outcome = self.recorder.finish(run);
        let reached = if matches!(outcome, Outcome::Failed(_)) { Vec::new() } else { self.reached };
        Ended { outcome, reached, unsettled: self.unsettled }
    }
}

/// A row before its first step.
pub(super) struct Row<'r> {
    plan: Run,
    run: PlantRun,
    watch: Watch<'r>,
}

impl<'r> Row<'r> {
    /// A run of a plant from its start, that goes through time as said.
    pub(super) fn new(
        plan: Run,
        (plant, start): (&Plant, &PlantStart),
        how: TimeStepping,
        drivers: Vec<Driver>,
        recorder: Box<dyn Recorder + 'r>,
    ) -> Result<Self, Error> {
        Ok(Self { plan, run: PlantRun::with_drivers(plant, start, how, drivers)?, watch: Watch::new(plant, recorder) })
    }

    /// Simulates the row individually, and on to the orbit where statistics are taken over that.
    fn simulate(mut self, record: &Record, over: StatisticsOver, check: &Check<'_>) -> Result<Ended, Error> {
        let Self { plan, run, watch } = &mut self;
        let mut reading = Reading::new(times(record, plan), plan.duration);
        run.stream_to(plan.duration, &mut |step| {
            check(step.end())?;
            watch.recorder.step(step);
            reading.step(step, |sample: &PlantSample| {
                watch.see(sample);
                Ok(())
            })
        })?;
        reading.finish(&run.sample(), |sample| {
            watch.see(sample);
            Ok::<_, Error>(())
        })?;
        if over == StatisticsOver::Orbit {
            over_orbit((run.clone(), plan), watch)?;
        }
        Ok(self.watch.finish(Some(&self.run)))
    }
}

/// Takes a run on from its end to its orbit, and over two periods of it.
fn over_orbit((mut run, plan): (PlantRun, &Run), watch: &mut Watch<'_>) -> Result<(), Error> {
    const PERIODS: u32 = 2;
    let orbit = settle::to_orbit(&mut run, plan)?;
    let end = run.time() + f64::from(PERIODS) * orbit.period;
    watch.unsettled = settle::unsettled(&orbit);
    watch.recorder.turn_to_orbit(orbit.settled.then(|| Windows::last(orbit.period, end)));
    if orbit.settled {
        settle::over_periods(&mut run, orbit.period, PERIODS, &mut |seen| watch.see_orbit(seen, PERIODS))?;
    }
    Ok(())
}

/// The times in s at which a run is looked at.
fn times<'t>(record: &'t Record, plan: &Run) -> Box<dyn Iterator<Item = f64> + 't> {
    match record {
        Record::Samples(times) => Box::new(times.iter().copied()),
        _ => Box::new(SampleTimes::new(plan.duration, plan.sample_interval).times()),
    }
}

/// What rows came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simulated {
    /// The outcome of each.
    pub outcomes: Vec<Outcome>,
    /// The warnings of each.
    pub warnings: Vec<Vec<Warning>>,
}

impl Simulated {
    /// The rows with what they came to and their warnings.
    pub fn rows(&self, rows: Range<u64>) -> impl Iterator<Item = (u64, &Outcome, &[Warning])> {
        let warnings = self.warnings.iter().map(Vec::as_slice);
        rows.zip(self.outcomes.iter().zip(warnings)).map(|(row, (outcome, warnings))| (row, outcome, warnings))
    }
}

/// Simulates the rows, with a common step for those that give none.
///
/// # Errors
/// [`Error::Interrupted`] where `check` ends a run. An error of a row is its outcome.
pub fn simulate_rows(
    sweep: &Sweep,
    choice: Option<&Choice>,
    rows: Range<u64>,
    check: &Check<'_>,
) -> Result<Simulated, Error> {
    let record = sweep.record();
    let built: Vec<(u64, Result<Built, String>)> = rows.map(|row| (row, build(sweep, row))).collect();
    let mut groups: Vec<Group<'_>> = Vec::new();
    let mut ended: Vec<Ended> = Vec::new();
    for (index, (row, built)) in built.iter().enumerate() {
        let ready = match built {
            Err(reason) => Err(reason.clone()),
            Ok(built) => built.row(sweep, choice).map_err(|error| error.to_string()),
        };
        ended.push(match ready {
            Err(reason) => Ended::failed(reason),
            Ok(ready) if ready.goes_along() && sweep.over() == StatisticsOver::Run => {
                Group::join(&mut groups, GroupKey::of(sweep, *row, &ready), (index, ready));
                // What the batch will compute is put in its place afterwards.
                Ended::failed(String::new())
            }
            Ok(ready) => match ready.simulate(record, sweep.over(), check) {
                Err(error @ Error::Interrupted { .. }) => return Err(error),
                came => came.unwrap_or_else(Ended::failed),
            },
        });
    }
    groups.into_iter().try_for_each(|group| group.simulate(record, &mut ended, check))?;
    let mut simulated = Simulated::default();
    for ((_, built), ended) in built.iter().zip(ended) {
        let mut warnings = built.as_ref().map(|built| built.ready.warnings_with(&ended.reached)).unwrap_or_default();
        warnings.extend(ended.unsettled);
        simulated.warnings.push(warnings);
        simulated.outcomes.push(ended.outcome);
    }
    Ok(simulated)
}

/// What a row came to, and what of its actuators the warnings need.
struct Ended {
    outcome: Outcome,
    /// Empty where it did not come to its end.
    reached: Vec<Reached>,
    /// That it has no orbit, where statistics are taken over that.
    unsettled: Option<Warning>,
}

impl Ended {
    fn failed(reason: impl ToString) -> Self {
        Self { outcome: Outcome::Failed(reason.to_string()), reached: Vec::new(), unsettled: None }
    }
}

/// Rows that go through time side by side, each with its place among the outcomes.
struct Group<'a> {
    key: GroupKey<'a>,
    rows: Vec<(usize, Row<'a>)>,
    /// How many it may have.
    most: usize,
}

/// A step's part by which two times that differ are the same.
const ROUNDING: f64 = 1e-9;

impl<'a> Group<'a> {
    /// Puts a row to its like, or begins a group.
    fn join(groups: &mut Vec<Self>, key: GroupKey<'a>, row: (usize, Row<'a>)) {
        match groups.iter_mut().find(|group| group.key == key && group.rows.len() < group.most) {
            Some(group) => group.rows.push(row),
            None => {
                let most = if PlantBatch::covers(row.1.run.plant()) { side_by_side() } else { 1 };
                groups.push(Self { key, rows: vec![row], most });
            }
        }
    }

    /// Takes all of them through time.
    fn simulate(self, record: &Record, ended: &mut [Ended], check: &Check<'_>) -> Result<(), Error> {
        let Self { key: GroupKey { how: TimeStepping::Fixed { method, step }, .. }, rows, .. } = self else {
            return Ok(());
        };
        let Some(plan) = rows.first().map(|(_, row)| row.plan) else { return Ok(()) };
        let mut steps: Vec<_> = rows.iter().map(|(_, row)| row.run.steps(method)).collect();
        let mut samplers: Vec<_> = steps.iter().map(|its| PlantSampler::new(its)).collect();
        // What is due at the start is passed before the first sample.
        let began = steps.iter_mut().map(PlantSteps::pass_due);
        let (places, mut watches): (Vec<_>, Vec<_>) =
            rows.into_iter().zip(began).map(|((index, row), began)| (index, began.map(|()| row.watch))).unzip();
        let mut batch = match PlantBatch::new(steps) {
            Ok(batch) => batch,
            Err(error) => {
                places.iter().for_each(|index| ended[*index] = Ended::failed(&error));
                return Ok(());
            }
        };
        let how = TimeStepping::Fixed { method, step };
        for time in times(record, &plan) {
            while time - batch.time() > ROUNDING * step {
                check(batch.time())?;
                let end = how.step_end(batch.time(), plan.duration);
                // A time at which no step ends divides one.
                let until = if end - time > ROUNDING * step { time } else { end };
                if let Err(error) = batch.advance_to(until) {
                    watches.iter_mut().for_each(|watch| *watch = Err(error.clone()));
                    break;
                }
            }
            for (row, (watch, sampler)) in watches.iter_mut().zip(&mut samplers).enumerate() {
                let Ok(living) = watch else { continue };
                match batch.row(row) {
                    Ok(steps) => living.see(sampler.read(steps, time)),
                    Err(error) => *watch = Err(error),
                }
            }
            if watches.iter().all(Result::is_err) {
                break;
            }
        }
        for (index, watch) in places.into_iter().zip(watches) {
            ended[index] = watch.map_or_else(Ended::failed, |watch| watch.finish(None));
        }
        Ok(())
    }
}

impl Row<'_> {
    /// Whether it may go side by side with others.
    fn goes_along(&self) -> bool {
        matches!(self.run.stepping(), TimeStepping::Fixed { .. }) && !self.watch.recorder.takes_steps()
    }
}

/// What rows that are stepped side by side share: their times, and the words of the sweep, on which the form of their laws
/// depends.
#[derive(Clone, Debug, PartialEq)]
struct GroupKey<'a> {
    span: [f64; 2],
    how: TimeStepping,
    words: Vec<&'a str>,
}

impl<'a> GroupKey<'a> {
    fn of(sweep: &'a Sweep, index: u64, row: &Row<'_>) -> Self {
        let word = |axis| match sweep.value(axis, index) {
            AxisValue::Word(word) => Some(word),
            AxisValue::Number(_) => None,
        };
        let words = (0..sweep.axes().len()).filter_map(word).collect();
        Self { span: [row.plan.duration, row.plan.sample_interval], how: row.run.stepping(), words }
    }
}

/// What a row describes.
struct Built {
    ready: Ready,
    /// The plant of one actuator or a joint, where its ledger is kept.
    plant: Option<Plant>,
}

fn build(sweep: &Sweep, row: u64) -> Result<Built, String> {
    let ready = ready_of(sweep, row)?;
    let is_of_ledger = |of: &Reduction| matches!(of.quantity, Quantity::Air | Quantity::Exergy);
    let records = matches!(sweep.record(), Record::Reductions(list) if list.iter().any(is_of_ledger));
    let plant = if records { ready.plant().map_err(|error| error.to_string())? } else { None };
    Ok(Built { ready, plant })
}

fn ready_of(sweep: &Sweep, row: u64) -> Result<Ready, String> {
    if let Some(plant) = sweep.plant(row) {
        let plant = plant?;
        within(sweep.record(), plant.run.duration)?;
        return Ok(Ready::Plant(Box::new(plant)));
    }
    let scenario = sweep.scenario(row).map_err(|error| reason(&error.error))?;
    within(sweep.record(), scenario.run.duration)?;
    describe(&scenario).map_err(|error| reason(&error))
}

/// Why a row has no run. An entry of a list has the name by which it varies, counted from 0.
fn reason(error: &Error) -> String {
    match error {
        Error::Table { name, problem, entry, remedy } => {
            let entry = entry.saturating_sub(1);
            format!("{name}: {problem} at {name}[{entry}], the first entry being {name}[0]; {remedy}")
        }
        other => other.to_string(),
    }
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

fn describe(scenario: &Scenario) -> Result<Ready, Error> {
    let built = match (scenario.has_joint(), scenario.has_controller()) {
        (false, true) => scenario.controlled_experiment()?.map(|of| Ready::Controlled(Box::new(of))),
        (true, false) => scenario.joint_experiment()?.map(|of| Ready::Joint(Box::new(of))),
        (true, true) => scenario.controlled_joint_experiment()?.map(|of| Ready::ControlledJoint(Box::new(of))),
        (false, false) => None,
    };
    built.map_or_else(|| scenario.experiment().map(|of| Ready::Actuator(Box::new(of))), Ok)
}

impl Ready {
    /// The plant that one actuator or a joint is; none of a plant with names.
    fn plant(&self) -> Result<Option<Plant>, Error> {
        let plant = match self {
            Self::Actuator(of) => SingleActuator::from(&**of).view()?.plant().clone(),
            Self::Controlled(of) => SingleActuator::from(&**of).view()?.plant().clone(),
            Self::Joint(of) => Pair::from(&**of).view()?.plant().clone(),
            Self::ControlledJoint(of) => Pair::from(&**of).view()?.plant().clone(),
            Self::Plant(_) => return Ok(None),
        };
        Ok(Some(plant))
    }
}

impl Built {
    /// Before its first step.
    fn row<'b>(&'b self, sweep: &'b Sweep, choice: Option<&Choice>) -> Result<Row<'b>, Error> {
        let recorded = (sweep.record(), self.plant.as_ref());
        match &self.ready {
            Ready::Actuator(of) => ready(SingleActuator::from(&**of), choice, recorded),
            Ready::Controlled(of) => ready(SingleActuator::from(&**of), choice, recorded),
            Ready::Joint(of) => ready(Pair::from(&**of), choice, recorded),
            Ready::ControlledJoint(of) => ready(Pair::from(&**of), choice, recorded),
            Ready::Plant(of) => plant::ready(of, choice, sweep),
        }
    }
}

/// A subject before its first step; with its plant where its ledger is recorded.
fn ready<'b, S: Swept + 'b>(
    of: S,
    choice: Option<&Choice>,
    (record, kept): (&'b Record, Option<&'b Plant>),
) -> Result<Row<'b>, Error>
where
    S::View: 'b,
    <S::View as PlantView>::Sample: 'b,
{
    let (plan, view) = (*of.plan(), of.view()?);
    let how = step::stepping(&plan, choice, || of.stepping())?;
    let drivers = of.driver(&view)?.into_iter().collect();
    let (plant, start) = (view.plant().clone(), view.start(of.start()));
    let keeper = kept.map(|plant| PlantLedgerKeeper::new(plant, how));
    let recorder = ViewRecorder { keeper, ..ViewRecorder::new(of, view, record) };
    Row::new(plan, (&plant, &start), how, drivers, Box::new(recorder))
}

/// What a sweep looks at of the runs of a subject.
trait Swept: Subject {
    /// A sample as reductions see it.
    fn seen<'s>(rig: &'s RigOf<Self>, sample: &'s SampleOf<Self>) -> Seen<'s>;

    /// The columns of samples that are kept.
    fn columns(rig: &RigOf<Self>) -> Vec<Field<SampleOf<Self>>>;

    /// The command whose period is that of a ripple.
    fn command(rig: &RigOf<Self>) -> Option<&Command>;
}

type RigOf<S> = <<S as Subject>::View as PlantView>::Rig;
type SampleOf<S> = <<S as Subject>::View as PlantView>::Sample;

impl Swept for SingleActuator<'_> {
    fn seen<'s>(rig: &'s Rig, sample: &'s Sample) -> Seen<'s> {
        Seen::Actuator(sample, rig.actuator().air().atmosphere().0)
    }

    fn columns(rig: &Rig) -> Vec<Field<Sample>> {
        of_actuator(rig.actuator().air().atmosphere().0)
    }

    fn command(rig: &Rig) -> Option<&Command> {
        rig.actuation().map(|actuation| &actuation.command)
    }
}

impl Swept for Pair<'_> {
    fn seen<'s>(rig: &'s JointRig, sample: &'s JointSample) -> Seen<'s> {
        Seen::Joint(sample, rig)
    }

    fn columns(rig: &JointRig) -> Vec<Field<JointSample>> {
        of_joint_alone(rig.driven()[0].actuator.air().atmosphere().0)
    }

    fn command(rig: &JointRig) -> Option<&Command> {
        rig.driven()[0].actuation.as_ref().map(|actuation| &actuation.command)
    }
}

/// Makes reductions of the samples of a subject, or keeps them.
struct ViewRecorder<'r, S: Swept> {
    of: S,
    view: S::View,
    reductions: Option<(&'r [Reduction], Reducer)>,
    fields: Vec<Field<SampleOf<S>>>,
    rows: Vec<Vec<Cell<'static>>>,
    /// The cells of the last sample.
    cells: Vec<Cell<'static>>,
    fault: Option<String>,
    /// The set points of a controller, where they are recorded.
    goals: Option<Vec<Goal>>,
    /// The ledger, where the air that is used or its exergy is recorded.
    keeper: Option<PlantLedgerKeeper<'r>>,
}

impl<'r, S: Swept> ViewRecorder<'r, S> {
    fn new(of: S, view: S::View, record: &'r Record) -> Self {
        let reductions = match record {
            Record::Reductions(reductions) => Some(reductions.as_slice()),
            // Those of plants have separate recorders.
            Record::Samples(_) | Record::Trajectories | Record::PlantReductions(_) => None,
        };
        let records = |wanted: fn(Quantity) -> bool| reductions.into_iter().flatten().any(|of| wanted(of.quantity));
        let goals = if records(|quantity| matches!(quantity, Quantity::Error(_))) { of.goals() } else { None };
        let reducer = |list| Reducer::new(list, S::command(view.rig()), of.plan().duration);
        let reductions = reductions.map(|list| (list, reducer(list)));
        let fields = S::columns(view.rig());
        Self { of, reductions, view, fields, rows: Vec::new(), cells: Vec::new(), fault: None, goals, keeper: None }
    }
}

impl<S: Swept> ViewRecorder<'_, S> {
    /// Takes the cells of a sample, and what of them is not finite.
    fn check(&mut self, sample: &SampleOf<S>) {
        self.cells.clear();
        self.cells.extend(self.fields.iter().map(|field| (field.cell)(sample)));
        self.fault = not_finite(&self.cells, |place| self.fields[place].column.name.clone());
    }
}

impl<S: Swept> Recorder for ViewRecorder<'_, S> {
    fn see(&mut self, sample: &PlantSample) {
        if self.fault.is_some() {
            return;
        }
        let sample = self.view.sample(sample);
        self.check(&sample);
        match &mut self.reductions {
            Some((_, reducer)) => reducer.see(S::seen(self.view.rig(), &sample)),
            None => self.rows.push(self.cells.clone()),
        }
    }

    fn see_orbit(&mut self, window: usize, weight: f64, sample: &PlantSample) {
        if self.fault.is_some() {
            return;
        }
        let sample = self.view.sample(sample);
        self.check(&sample);
        if let Some((_, reducer)) = &mut self.reductions {
            reducer.see_orbit(S::seen(self.view.rig(), &sample), window, weight);
        }
    }

    fn turn_to_orbit(&mut self, windows: Option<Windows>) {
        if let Some((_, reducer)) = &mut self.reductions {
            reducer.turn_to_orbit(windows);
        }
    }

    fn takes_steps(&self) -> bool {
        self.goals.is_some() || self.keeper.is_some()
    }

    fn step(&mut self, step: &PlantStep<'_>) {
        let Self { of, view, goals, keeper, .. } = self;
        if let Some(keeper) = keeper {
            keeper.step(step);
        }
        if let (Some(goals), Some((_, decision))) = (goals, step.decision())
            && let Some(decision) = view.decision(decision)
        {
            of.add(goals, &decision);
        }
    }

    fn finish(self: Box<Self>, run: Option<&PlantRun>) -> Outcome {
        if let Some(fault) = self.fault {
            return Outcome::Failed(fault);
        }
        let Some((reductions, mut reducer)) = self.reductions else {
            return Outcome::Sampled(self.rows);
        };
        reducer.set_goals(self.goals.unwrap_or_default());
        let ledger = self.keeper.zip(run).map(|(keeper, run)| keeper.finish(run));
        reducer.set_air_used(ledger.as_ref().map(PlantLedger::air_used));
        // As in a summary: without a valve no exergy is drawn.
        let has_valves = run.is_some_and(|run| !run.plant().network().valves.is_empty());
        reducer.set_efficiency(ledger.filter(|_| has_valves).and_then(|ledger| ledger.total().efficiency()));
        Outcome::Reduced(reducer.finish(reductions))
    }
}

/// Which number of a sample is not finite, in words; `name` gives that of a column. The time is the first cell.
pub(super) fn not_finite(cells: &[Cell<'_>], name: impl Fn(usize) -> String) -> Option<String> {
    let is_fault = |cell: &Cell<'_>| matches!(cell, Cell::Number(value) if !value.is_finite());
    let place = cells.iter().position(is_fault)?;
    match (&cells[0], &cells[place]) {
        (Cell::Number(time), Cell::Number(value)) => {
            Some(format!("{} = {value} at t = {time} s is not a finite number", name(place)))
        }
        _ => None,
    }
}
