//! What a scenario file describes, whatever that is, made ready and run; then its columns, its events and its figure.
//!
//! | kind of scenario | run by |
//! |---|---|
//! | an actuator on a load, with or without a controller | [`engine`], as `single_actuator` says |
//! | a joint of two actuators, with or without a controller | [`engine`], as `joint::pair` says |
//! | a plant of several actuators | [`plant`] |
//!
//! Every command and every other host that runs whole scenarios does so here. Checked by the program's `tests/simulate.rs`.

use crate::axis::TrajectoryAxis;
use crate::closed_loop::{Closed, Goals};
use crate::engine::{self, Kept, Reached, Stepping, Subject};
use crate::events::Log;
use crate::failure::Failure;
use crate::figure::{self, Picture, Request};
use crate::joint::{self, pair::Pair};
use crate::observation::{Ended, Observation, Observes as _};
use crate::plant::{self, PlantFigures, PlantOutcome};
use crate::record::{self, Field, Filled, Format, Provenance, Target, filled};
use crate::settle::{End, Settled};
use crate::single_actuator::SingleActuator;
use mckibben::plant::{
    JointPlant, PlantLedgerKeeper, PlantReader, PlantRun, PlantSample, PlantView, RigPlant, ViewReader, ViewRunEnd,
    ViewTrajectory,
};
use mckibben::simulation::{JointRig, Readable, Reading, Rig, SampleTimes};
use mckibben_scenario::{
    ControlledExperiment, ControlledJointExperiment, Document, Experiment, JointExperiment, PlantExperiment, Run,
};
use std::io::Write;
use std::path::Path;

/// What a scenario file describes, ready to run.
#[derive(Clone, Debug)]
pub enum Ready {
    /// An actuator on a load.
    Actuator(Box<Experiment>),
    /// An actuator on a load, under a controller.
    Controlled(Box<ControlledExperiment>),
    /// Two actuators that turn a joint.
    Joint(Box<JointExperiment>),
    /// Two actuators that turn a joint, under a controller.
    ControlledJoint(Box<ControlledJointExperiment>),
    /// Several actuators on their mechanisms and supplies.
    Plant(Box<PlantExperiment>),
}

/// A finished run.
#[derive(Clone, Debug)]
pub enum Finished {
    /// Of an actuator on a load.
    Actuator(Box<Kept<RigPlant>>),
    /// Of a joint.
    Joint(Box<Kept<JointPlant>>),
    /// Of a plant.
    Plant(Box<PlantOutcome>),
}

/// The figures of a run of which nothing else need be left.
#[derive(Clone, Debug)]
pub enum Figures {
    /// Of an actuator on a load.
    Actuator(Box<ViewFigures<Rig, Observation>>),
    /// Of a joint.
    Joint(Box<ViewFigures<JointRig, joint::observation::Observation>>),
    /// Of a plant.
    Plant(Box<PlantFigures>),
}

/// The figures of the run of an actuator on a load, or of a joint.
#[derive(Clone, Debug)]
pub struct ViewFigures<R, O> {
    /// What was simulated; under a controller with the commands that it made.
    pub rig: R,
    /// What was observed.
    pub observation: O,
    /// The controller's part in it, if there is one.
    pub control: Option<Closed>,
}

impl Ready {
    /// Reads what a document describes.
    ///
    /// # Errors
    /// Every mistake in the file; then the first contradiction that the model finds, shown in the file.
    pub fn of(document: &Document) -> Result<Self, Failure> {
        if let Some(plant) = document.plant_experiment()? {
            return Ok(Self::Plant(Box::new(plant)));
        }
        if let Some(controlled) = document.controlled_joint_experiment()? {
            return Ok(Self::ControlledJoint(Box::new(controlled)));
        }
        if let Some(joint) = document.joint_experiment()? {
            return Ok(Self::Joint(Box::new(joint)));
        }
        if let Some(controlled) = document.controlled_experiment()? {
            return Ok(Self::Controlled(Box::new(controlled)));
        }
        Ok(Self::Actuator(Box::new(document.experiment()?)))
    }

    /// How long is simulated, by which engine, and what is recorded.
    pub fn plan(&self) -> &Run {
        match self {
            Self::Actuator(of) => &of.run,
            Self::Controlled(of) => &of.experiment.run,
            Self::Joint(of) => &of.run,
            Self::ControlledJoint(of) => &of.experiment.run,
            Self::Plant(of) => &of.run,
        }
    }

    /// Whether there is more than one actuator, and so more than one length to draw over.
    pub fn has_several(&self) -> bool {
        matches!(self, Self::Joint(_) | Self::ControlledJoint(_) | Self::Plant(_))
    }

    /// Runs it and keeps every step up to `run.duration`; what it settles to is read where `end` says so. `reached` is called with the
    /// time in s now and then, and may end the run by an error such as [`mckibben::Error::Interrupted`].
    ///
    /// # Errors
    /// What the core finds, shown in the document.
    pub fn run(
        self,
        document: &Document,
        end: End,
        reached: &mut Reached<'_>,
    ) -> Result<(Finished, Option<Settled>), Failure> {
        let actuator = |(run, settled)| (Finished::Actuator(Box::new(run)), settled);
        let joint = |(run, settled)| (Finished::Joint(Box::new(run)), settled);
        let finished = match self {
            Self::Actuator(of) => keep(&SingleActuator::from(&*of), end, reached).map(actuator),
            Self::Controlled(of) => keep(&SingleActuator::from(&*of), end, reached).map(actuator),
            Self::Joint(of) => keep(&Pair::from(&*of), end, reached).map(joint),
            Self::ControlledJoint(of) => keep(&Pair::from(&*of), end, reached).map(joint),
            Self::Plant(of) => {
                plant::run(*of, end, reached).map(|(run, settled)| (Finished::Plant(Box::new(run)), settled))
            }
        };
        finished.map_err(|error| Failure::of_core(&error, document))
    }

    /// Runs it, writes its samples as they come if a target is given, and keeps nothing but what a controller did: memory does not
    /// grow with the run, and the bytes are those of a run that is kept. What it settles to is read where `end` says so.
    ///
    /// # Errors
    /// What the core finds, shown in the document; [`Failure::output`] when writing fails.
    pub fn stream(
        self,
        document: &Document,
        target: Option<Target<'_>>,
        end: End,
    ) -> Result<(Figures, Option<Settled>), Failure> {
        let of = (document, target, end);
        let actuator = |(figures, settled)| (Figures::Actuator(Box::new(figures)), settled);
        let joint = |(figures, settled)| (Figures::Joint(Box::new(figures)), settled);
        match self {
            Self::Actuator(subject) => stream(&SingleActuator::from(&*subject), of).map(actuator),
            Self::Controlled(subject) => stream(&SingleActuator::from(&*subject), of).map(actuator),
            Self::Joint(subject) => stream(&Pair::from(&*subject), of).map(joint),
            Self::ControlledJoint(subject) => stream(&Pair::from(&*subject), of).map(joint),
            Self::Plant(plant) => {
                stream_plant(&plant, of).map(|(figures, settled)| (Figures::Plant(Box::new(figures)), settled))
            }
        }
    }
}

/// Runs a subject and keeps every step up to `run.duration`; what it settles to is read where `end` says so.
fn keep<S: Subject>(
    of: &S,
    end: End,
    reached: &mut Reached<'_>,
) -> Result<(Kept<S::View>, Option<Settled>), mckibben::Error> {
    let (kept, run) = engine::run(of, reached)?;
    let settled = go_on(of, kept.trajectory.view(), end, run)?;
    Ok((kept, settled))
}

/// Goes on with a run of a subject from its end, where that is wanted.
fn go_on<S: Subject>(of: &S, view: &S::View, end: End, run: PlantRun) -> Result<Option<Settled>, mckibben::Error> {
    let fields = S::fields(view.rig(), &Goals::default());
    end.go_on((run, of.plan()), &fields, |sample| view.sample(sample))
}

/// What is made of a run, and how it ends.
type Wanted<'d, 't> = (&'d Document, Option<Target<'t>>, End);

/// The figures of the runs of a subject.
type FiguresOf<S> = ViewFigures<
    <<S as Subject>::View as PlantView>::Rig,
    <<S as Subject>::Observer as crate::observation::Observes<<S as Subject>::View>>::Observation,
>;

/// Runs a subject and writes its samples on the way.
fn stream<S: Subject>(
    of: &S,
    (document, target, end): Wanted<'_, '_>,
) -> Result<(FiguresOf<S>, Option<Settled>), Failure> {
    let shown = |error: mckibben::Error| Failure::of_core(&error, document);
    let (plan, view) = (*of.plan(), of.view().map_err(shown)?);
    let stepping = Stepping::of(&plan, || of.stepping()).map_err(shown)?;
    let mut observer = S::Observer::new(view.rig(), &plan);
    let mut keeper = PlantLedgerKeeper::new(view.plant(), stepping.how);
    let goals = Goals::new(of.goals().unwrap_or_default().into());
    let fields = S::fields(view.rig(), &goals);
    let (ended, control) = through(target, &fields, &plan, shown, |take| {
        let (end, control) = engine::stream(of, (&view, stepping.how), &goals, &mut |step| {
            keeper.step(step.plant());
            observer.step(step);
            take(step)
        })?;
        Ok((view.sample(&end.run.sample()), (end, control)))
    })?;
    let ViewRunEnd { rig, sample, run } = ended;
    let counts = run.statistics();
    let ended = Ended {
        counts,
        ledger: keeper.finish(&run),
        draws: !view.plant().network().valves.is_empty(),
        steps: stepping.steps(counts),
    };
    let figures = ViewFigures { rig, observation: observer.finish(sample, ended), control };
    let settled = go_on(of, &view, end, run).map_err(shown)?;
    Ok((figures, settled))
}

/// Runs a plant and writes its samples on the way.
fn stream_plant(
    of: &PlantExperiment,
    (document, target, end): Wanted<'_, '_>,
) -> Result<(PlantFigures, Option<Settled>), Failure> {
    let mut observer = plant::observation::Observer::new(of);
    let mut follower = plant::control::Follower::new(of);
    let fields = plant::columns::fields(of, follower.goals(), &follower.names());
    let shown = |error: mckibben::Error| Failure::of_core(&error, document);
    let made = through(target, &fields, &of.run, shown, |take| {
        let run = plant::stream(of, &mut follower, &mut |step| {
            observer.step(step);
            take(step)
        })?;
        Ok((run.run.sample(), run))
    })?;
    let figures = plant::figures(of, (observer, follower), &made);
    let settled = plant::settle(of, end, made.run).map_err(shown)?;
    Ok((figures, settled))
}

/// What of a step is written: its error ends the run.
type Take<'t, S> = &'t mut dyn FnMut(&dyn Readable<Sample = S>) -> Result<(), mckibben::Error>;

/// Makes a run by `simulate` and writes its samples on the way. `simulate` hands every step to what it is given, and returns the
/// last sample with what else there is at the end.
fn through<S, E>(
    target: Option<Target<'_>>,
    fields: &[Field<S>],
    run: &Run,
    shown: impl Fn(mckibben::Error) -> Failure,
    simulate: impl FnOnce(Take<'_, S>) -> Result<(S, E), mckibben::Error>,
) -> Result<E, Failure> {
    let Some(target) = target else {
        return simulate(&mut |_| Ok(())).map(|(_, end)| end).map_err(shown);
    };
    let (mut simulate, mut ended) = (Some(simulate), None);
    let rows: record::Rows<'_, S> = &mut |each| {
        let Some(simulate) = simulate.take() else { return Ok(()) };
        let mut reading = Reading::new(SampleTimes::new(run.duration, run.sample_interval).times(), run.duration);
        let mut failure = None;
        let made = simulate(&mut |step| {
            reading.step(step, &mut *each).map_err(|failed| {
                failure = Some(failed);
                mckibben::Error::Interrupted { time: 0.0 }
            })
        });
        // What writing failed by has ended the run.
        let (last, end) = failure.map_or_else(|| made.map_err(&shown), Err)?;
        reading.finish(&last, each)?;
        ended = Some(end);
        Ok(())
    };
    record::write(fields, rows, target)?;
    ended.ok_or_else(|| Failure::stopped("the run did not come to its end"))
}

/// The columns of a run that is kept.
fn fields<S: Subject>(of: &Kept<S::View>) -> Vec<Field<<S::View as PlantView>::Sample>> {
    S::fields(of.trajectory.rig(), &Goals::new(of.goals().to_vec().into()))
}

/// The figures of a run that is kept.
fn figures<S: Subject>(of: &Kept<S::View>) -> Result<FiguresOf<S>, Failure> {
    let observation = of.observed::<S::Observer>()?;
    Ok(ViewFigures { rig: of.trajectory.rig().clone(), observation, control: of.control.clone() })
}

/// Takes a sample; its error ends the run.
type Each<'e, S> = &'e mut dyn FnMut(&S) -> Result<(), Failure>;

/// Hands the samples of a run at an interval in s to `each`.
fn rows<V: PlantView>(of: &ViewTrajectory<V>, interval: f64, each: Each<'_, V::Sample>) -> Result<(), Failure> {
    of.samples(interval).try_for_each(|sample| each(&sample))
}

/// Hands the samples of a run at times in s to `each`.
fn rows_at<V: PlantView>(of: &ViewTrajectory<V>, times: &[f64], each: Each<'_, V::Sample>) -> Result<(), Failure> {
    let mut reader = ViewReader::new(of);
    times.iter().try_for_each(|time| each(&reader.read(*time)))
}

impl Finished {
    /// How long was simulated, by which engine, and what was recorded.
    pub fn plan(&self) -> &Run {
        match self {
            Self::Actuator(of) => &of.plan,
            Self::Joint(of) => &of.plan,
            Self::Plant(of) => &of.experiment.run,
        }
    }

    /// The columns of the run in their order, with a row at t = 0, every sample interval and the end.
    ///
    /// # Errors
    /// [`Failure::stopped`] for a number that is not finite.
    pub fn columns(&self) -> Result<Vec<Filled>, Failure> {
        let interval = self.plan().sample_interval;
        match self {
            Self::Actuator(of) => {
                filled(fields::<SingleActuator<'_>>(of), &mut |each| rows(&of.trajectory, interval, each))
            }
            Self::Joint(of) => filled(fields::<Pair<'_>>(of), &mut |each| rows(&of.trajectory, interval, each)),
            Self::Plant(of) => filled(of.fields(), &mut |each| of.each_sample(each)),
        }
    }

    /// The columns with a row at each of `times` in s, from the polynomials of the steps.
    ///
    /// # Errors
    /// [`Failure::input`] for a time outside the run.
    pub fn columns_at(&self, times: &[f64]) -> Result<Vec<Filled>, Failure> {
        let end = self.plan().duration;
        if let Some(outside) = times.iter().find(|time| !(0.0..=end).contains(*time)) {
            return Err(Failure::input(
                format!("time = {outside} s is outside the run"),
                format!("give a time from 0 s to {end} s, or a longer run.duration"),
            ));
        }
        match self {
            Self::Actuator(of) => {
                filled(fields::<SingleActuator<'_>>(of), &mut |each| rows_at(&of.trajectory, times, each))
            }
            Self::Joint(of) => filled(fields::<Pair<'_>>(of), &mut |each| rows_at(&of.trajectory, times, each)),
            Self::Plant(of) => {
                let mut reader = PlantReader::new(&of.trajectory);
                let rows: record::Rows<'_, PlantSample> =
                    &mut |each| times.iter().try_for_each(|time| each(&reader.read(*time)));
                filled(of.fields(), rows)
            }
        }
    }

    /// The log of events.
    pub fn log(&self) -> Log {
        match self {
            Self::Actuator(of) => Log::new(of.trajectory.events()),
            Self::Joint(of) => joint::events::log(of.trajectory.events()),
            Self::Plant(of) => plant::events::log(of),
        }
    }

    /// Writes the columns.
    ///
    /// # Errors
    /// [`Failure::output`], which names the path, when writing fails.
    pub fn write(
        &self,
        provenance: &Provenance<'_>,
        (path, format): (&Path, Format),
        out: &mut (dyn Write + Send),
    ) -> Result<(), Failure> {
        let (interval, target) = (self.plan().sample_interval, Target { provenance, path, format, out });
        match self {
            Self::Actuator(of) => record::write(
                &fields::<SingleActuator<'_>>(of),
                &mut |each| rows(&of.trajectory, interval, each),
                target,
            ),
            Self::Joint(of) => {
                record::write(&fields::<Pair<'_>>(of), &mut |each| rows(&of.trajectory, interval, each), target)
            }
            Self::Plant(of) => record::write(&of.fields(), &mut |each| of.each_sample(each), target),
        }
    }

    /// The figures of the run.
    ///
    /// # Errors
    /// None but those of the engine.
    pub fn figures(&self) -> Result<Figures, Failure> {
        Ok(match self {
            Self::Actuator(of) => Figures::Actuator(Box::new(figures::<SingleActuator<'_>>(of)?)),
            Self::Joint(of) => Figures::Joint(Box::new(figures::<Pair<'_>>(of)?)),
            Self::Plant(of) => Figures::Plant(Box::new(of.figures())),
        })
    }

    /// The usual figure of the run; that of several actuators is always over time.
    ///
    /// # Errors
    /// [`Failure::stopped`] for a number that is not finite.
    pub fn figure(&self, over: TrajectoryAxis, title: &str) -> Result<Picture, Failure> {
        let over = if matches!(self, Self::Actuator(_)) { over } else { TrajectoryAxis::Time };
        figure::draw(&[("", self)], &Request { over, title, columns: &[] })
    }
}
