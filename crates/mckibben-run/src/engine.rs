//! Runs an actuator on its load or a joint, with or without a controller, by the engine that its scenario names.
//!
//! | a run is | for | memory |
//! |---|---|---|
//! | kept: every step as a polynomial | figures, events, values between samples | some hundred bytes for each step |
//! | streamed: each step goes to a consumer | samples and the figures of the summary | does not grow with the run |
//!
//! Both engines give events and an audit of energy, exergy and air. At fixed steps each sample interval is divided into the least
//! number of equal steps that are not longer than `run.step`, or than the step that `run.accuracy` needs. Checked by
//! the program's `tests/simulate.rs`.

use crate::closed_loop::{Closed, Goal, Goals};
use crate::observation::{Ended, Observes, Steps};
use crate::progress::Progress;
use crate::quantities::{self, given};
use crate::record::Field;
use mckibben::Error;
use mckibben::command::Driver;
use mckibben::engine::Statistics;
use mckibben::plant::{
    PlantRun, PlantStepError, PlantView, STEPS_WATCHED, TimeStepping, ViewRunEnd, ViewStep, ViewTrajectory,
    record_view, stream_view,
};
use mckibben::simulation::SampleTimes;
use mckibben_scenario::{Engine, Run};

/// What a scenario describes that is a view of a plant, with its controller if it has one.
pub(crate) trait Subject {
    /// The plant, read as what it is.
    type View: PlantView;
    /// Observes its runs.
    type Observer: Observes<Self::View>;

    /// How long is simulated, by which engine, and what is recorded.
    fn plan(&self) -> &Run;

    /// The plant.
    ///
    /// # Errors
    /// What the core finds contradictory.
    fn view(&self) -> Result<Self::View, Error>;

    /// Where it starts.
    fn start(&self) -> &<Self::View as PlantView>::State;

    /// How it goes through time, with the error of a step that is chosen for it.
    ///
    /// # Errors
    /// What the core finds when a step is chosen.
    fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error>;

    /// Its controller as a driver.
    ///
    /// # Errors
    /// What the core finds contradictory.
    fn driver(&self, view: &Self::View) -> Result<Option<Driver>, Error>;

    /// What the controller is to reach, before the first sample; none without a controller.
    fn goals(&self) -> Option<Vec<Goal>>;

    /// Adds to its goals what was to be reached and what was measured at a sampling instant.
    fn add(&self, goals: &mut [Goal], decision: &<Self::View as PlantView>::Decision);

    /// How often something else was requested of each valve.
    fn requests(rig: &<Self::View as PlantView>::Rig) -> Vec<usize>;

    /// The columns of its samples and goals.
    fn fields(rig: &<Self::View as PlantView>::Rig, goals: &Goals) -> Vec<Field<<Self::View as PlantView>::Sample>>;
}

/// Is called with the time in s that a run has reached, and may end it.
pub(crate) type Reached<'a> = dyn FnMut(f64) -> Result<(), Error> + 'a;

/// How a run goes through time, with the error of a step that was chosen for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stepping {
    pub(crate) how: TimeStepping,
    chosen: Option<PlantStepError>,
}

impl Stepping {
    /// What `choose` says; it may take a while where the step follows from an accuracy.
    ///
    /// # Errors
    /// Those of `choose`.
    pub(crate) fn of(
        run: &Run,
        choose: impl FnOnce() -> Result<(TimeStepping, Option<PlantStepError>), Error>,
    ) -> Result<Self, Error> {
        let tries = run.engine == Engine::FixedStep && run.step.is_none();
        let _progress = tries.then(|| Progress::begin("choosing the step", None));
        let (how, chosen) = choose()?;
        Ok(Self { how, chosen })
    }

    /// The fixed steps of a run, where it took such.
    pub(crate) fn steps(&self, counts: Statistics) -> Option<Steps> {
        let TimeStepping::Fixed { step, .. } = self.how else { return None };
        let chosen = self.chosen.map(|error| [error.compared, error.greatest]);
        Some(Steps { step, chosen, steps: counts.explicit_steps + counts.implicit_steps })
    }
}

/// A run that is kept.
#[derive(Clone, Debug)]
pub struct Kept<V: PlantView> {
    /// How long was simulated and what was recorded.
    pub plan: Run,
    /// The run.
    pub trajectory: ViewTrajectory<V>,
    /// The controller's part in it, if there is one.
    pub control: Option<Closed>,
    stepping: Stepping,
}

/// Runs a subject and keeps every step; with what is kept comes the run at its end. `reached` is called with the time in s now and
/// then, and may end the run.
///
/// # Errors
/// [`Error::Stopped`] when the simulation cannot go on, and what the core finds out of range.
pub(crate) fn run<S: Subject>(of: &S, reached: &mut Reached<'_>) -> Result<(Kept<S::View>, PlantRun), Error> {
    let (plan, view) = (*of.plan(), of.view()?);
    let stepping = Stepping::of(&plan, || of.stepping())?;
    let mut way = Way::begin(&plan).keeping(view.plant().bytes_per_step());
    let driver = of.driver(&view)?;
    let (trajectory, end) = record_view(&view, of.start(), (plan.duration, stepping.how), driver, &mut |time| {
        way.kept(time);
        reached(time)
    })?;
    let control = of.goals().map(|mut goals| {
        let decisions = trajectory.decisions();
        decisions.iter().for_each(|decision| of.add(&mut goals, decision));
        Closed { goals, samples: decisions.len(), requests: S::requests(trajectory.rig()) }
    });
    Ok((Kept { plan, trajectory, control, stepping }, end))
}

/// Takes each accepted step of a run; its error ends the run.
pub(crate) type Consumer<'c, V> = dyn FnMut(&ViewStep<'_, V>) -> Result<(), Error> + 'c;

/// Runs a subject, with its plant, and hands each accepted step to `consumer`; nothing is kept but what a controller did. What that
/// was to reach is added to `goals`, which have what was decided before a step when the step is handed on.
///
/// # Errors
/// As [`run`], and those of the consumer.
pub(crate) fn stream<S: Subject>(
    of: &S,
    (view, how): (&S::View, TimeStepping),
    goals: &Goals,
    consumer: &mut Consumer<'_, S::View>,
) -> Result<(ViewRunEnd<S::View>, Option<Closed>), Error> {
    let (plan, driver) = (of.plan(), of.driver(view)?);
    let (mut samples, mut way) = (0, Way::begin(plan));
    let end = stream_view(view, of.start(), (plan.duration, how), driver, &mut |step| {
        way.at(step.end());
        consumer(step)?;
        if let Some(decision) = step.decision() {
            samples += 1;
            of.add(&mut goals.borrow_mut(), &decision);
        }
        Ok(())
    })?;
    let closed = |_| Closed { goals: goals.borrow().clone(), samples, requests: S::requests(&end.rig) };
    let control = of.goals().map(closed);
    Ok((end, control))
}

impl<V: PlantView> Kept<V> {
    /// What was to be reached, and how far it was.
    pub(crate) fn goals(&self) -> &[Goal] {
        self.control.as_ref().map_or(&[], |closed| &closed.goals)
    }

    /// What an observer sees of it.
    ///
    /// # Errors
    /// None.
    pub(crate) fn observed<O: Observes<V>>(&self) -> Result<O::Observation, Error> {
        let Self { plan, trajectory, stepping, .. } = self;
        let mut observer = O::new(trajectory.rig(), plan);
        trajectory.replay(&mut |step| {
            observer.step(step);
            Ok(())
        })?;
        let counts = trajectory.statistics();
        let ended = Ended {
            counts,
            ledger: trajectory.ledger(),
            draws: !trajectory.plant().plant().network().valves.is_empty(),
            steps: stepping.steps(counts),
        };
        Ok(observer.finish(trajectory.at(trajectory.duration()), ended))
    }
}

/// How far a run is, and what it keeps.
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

    /// It has come to a time in s, at a call of the watcher of a run that keeps every step.
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
                 {duration}; a run of which only the samples are written keeps nothing"
            ));
        }
    }
}

/// Parts of a run that its progress bar counts.
const PARTS: f64 = 1000.0;

fn gigabytes(bytes: f64) -> String {
    format!("{} GB", quantities::digits(bytes / 1e9))
}

/// How many samples a run records.
pub fn rows(run: &Run) -> u64 {
    SampleTimes::new(run.duration, run.sample_interval).last() + 1
}
