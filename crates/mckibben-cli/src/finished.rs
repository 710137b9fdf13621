//! What a scenario file describes, whatever that is, made ready and run; then its columns, its events and its figure.
//!
//! | kind of scenario | run by |
//! |---|---|
//! | an actuator on a load | [`engine`] |
//! | the same under a controller | [`closed_loop`] |
//! | a joint of two actuators | [`joint::outcome`] |
//! | the same under a controller | [`joint::control`] |
//! | a plant of several actuators | [`plant`] |
//!
//! Every command and every other host that runs whole scenarios does so here. Checked by `tests/simulate.rs`.

use crate::closed_loop::{self, Closed, Goal, Goals};
use crate::engine::{self, Outcome};
use crate::events::{self, Log};
use crate::failure::Failure;
use crate::joint;
use crate::observation::{Observation, Observer};
use crate::plant::{self, PlantFigures, PlantOutcome};
use crate::plot::Figure;
use crate::portrait::{self, Over};
use crate::record::{self, Field, Filled, Format, Provenance, Target, filled, of_controlled, of_joint};
use mckibben::plant::{JointPlant, PlantReader, PlantSample, RigPlant};
use mckibben::simulation::{JointRig, JointSample, Readable, Reading, Sample, SampleTimes};
use mckibben_scenario::{
    ControlledExperiment, ControlledJointExperiment, Document, Engine, Experiment, JointExperiment, PlantExperiment,
    Run,
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
    Actuator(Box<ActuatorRun>),
    /// Of a joint.
    Joint(Box<JointRun>),
    /// Of a plant.
    Plant(Box<PlantOutcome>),
}

/// The run of an actuator on a load.
#[derive(Clone, Debug)]
pub struct ActuatorRun {
    /// What was simulated; under a controller with the command that it made.
    pub experiment: Experiment,
    /// The run.
    pub outcome: Outcome,
    /// The controller's part in it, if there is one.
    pub control: Option<Closed>,
}

/// The run of a joint.
#[derive(Clone, Debug)]
pub struct JointRun {
    /// How long was simulated and what was recorded.
    pub run: Run,
    /// The run.
    pub outcome: joint::outcome::Outcome,
    /// The controller's part in it, if there is one.
    pub control: Option<joint::control::Closed>,
}

/// The figures of a run of which nothing else need be left.
#[derive(Clone, Debug)]
pub enum Figures {
    /// Of an actuator on a load.
    Actuator(Box<ActuatorFigures>),
    /// Of a joint.
    Joint(Box<JointFigures>),
    /// Of a plant.
    Plant(Box<PlantFigures>),
}

/// The figures of the run of an actuator on a load.
#[derive(Clone, Debug)]
pub struct ActuatorFigures {
    /// What was simulated; under a controller with the command that it made.
    pub experiment: Experiment,
    /// What was observed.
    pub observation: Observation,
    /// The controller's part in it, if there is one.
    pub control: Option<Closed>,
}

/// The figures of the run of a joint.
#[derive(Clone, Debug)]
pub struct JointFigures {
    /// The joint; under a controller with the commands that it made.
    pub rig: JointRig,
    /// What was observed.
    pub observation: joint::observation::Observation,
    /// The controller's part in it, if there is one.
    pub control: Option<joint::control::Closed>,
}

/// Hears the time in s that a run has reached, and may end it.
type Reached<'a> = dyn FnMut(f64) -> Result<(), mckibben::Error> + 'a;

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

    /// Whether the run will have a log of events.
    pub fn logs_events(&self) -> bool {
        matches!(self, Self::Plant(_)) || self.plan().engine == Engine::EventLocated
    }

    /// Runs it. `watch` sees the start and every step of an actuator at fixed steps, with what is run; `reached` hears the time
    /// in s now and then, and may end the run by an error such as [`mckibben::Error::Interrupted`].
    ///
    /// # Errors
    /// What the core finds, shown in the document.
    pub fn run(
        self,
        document: &Document,
        watch: &mut dyn FnMut(&Experiment, &Sample),
        reached: &mut Reached<'_>,
    ) -> Result<Finished, Failure> {
        self.finish(watch, reached).map_err(|error| Failure::of_core(&error, document))
    }

    /// Runs it by the event-located engine, writes its samples as they come if a target is given, and keeps nothing but what a
    /// controller did: memory does not grow with the run, and the bytes are those of a run that is kept.
    ///
    /// # Errors
    /// What the core finds, shown in the document; [`Failure::output`] when writing fails.
    pub(crate) fn stream(self, document: &Document, target: Option<Target<'_>>) -> Result<Figures, Failure> {
        let run = *self.plan();
        let shown = |error: mckibben::Error| Failure::of_core(&error, document);
        match self {
            Self::Actuator(experiment) => {
                let plant = RigPlant::new(&experiment.rig);
                let mut observer = Observer::new(Some(&plant), &experiment);
                let fields = of_controlled(&experiment.rig, &Goals::default());
                let end = through(target, &fields, &run, shown, |take| {
                    let end = engine::stream(&experiment, &plant, &mut |step| {
                        observer.step(step);
                        take(step)
                    })?;
                    Ok((end.sample, end))
                })?;
                let observation = observer.finish(end.sample, &end.run);
                Ok(Figures::Actuator(Box::new(ActuatorFigures { experiment: *experiment, observation, control: None })))
            }
            Self::Controlled(of) => {
                let plant = RigPlant::new(&of.experiment.rig);
                let mut observer = Observer::new(Some(&plant), &of.experiment);
                let goals = Goals::new(closed_loop::begin_goals(&of).into());
                let fields = of_controlled(&of.experiment.rig, &goals);
                let (end, mut closed) = through(target, &fields, &run, shown, |take| {
                    let (end, closed) = closed_loop::stream(&of, &plant, &goals, &mut |step| {
                        observer.step(step);
                        take(step)
                    })?;
                    Ok((end.sample, (end, closed)))
                })?;
                closed.goals = goals.take();
                let (experiment, observation) = (closed.experiment.clone(), observer.finish(end.sample, &end.run));
                let figures = ActuatorFigures { experiment, observation, control: Some(closed) };
                Ok(Figures::Actuator(Box::new(figures)))
            }
            Self::Joint(of) => {
                let plant = JointPlant::new(&of.rig).map_err(shown)?;
                let mut observer = joint::observation::Observer::new(Some(&plant), &run);
                let end = through(target, &of_joint(Some(&of.rig), &Goals::default()), &run, shown, |take| {
                    let end = joint::outcome::stream(&of, &plant, &mut |step| {
                        observer.step(step);
                        take(step)
                    })?;
                    Ok((end.sample, end))
                })?;
                let observation = observer.finish(end.sample, &end.run);
                Ok(Figures::Joint(Box::new(JointFigures { rig: end.rig, observation, control: None })))
            }
            Self::ControlledJoint(of) => {
                let plant = JointPlant::new(&of.experiment.rig).map_err(shown)?;
                let mut observer = joint::observation::Observer::new(Some(&plant), &run);
                let goals = Goals::new(joint::control::begin_goals(&of).into());
                let (end, mut closed) =
                    through(target, &of_joint(Some(&of.experiment.rig), &goals), &run, shown, |take| {
                        let (end, closed) = joint::control::stream(&of, &plant, &goals, &mut |step| {
                            observer.step(step);
                            take(step)
                        })?;
                        Ok((end.sample, (end, closed)))
                    })?;
                closed.goals = goals.take();
                let observation = observer.finish(end.sample, &end.run);
                Ok(Figures::Joint(Box::new(JointFigures { rig: end.rig, observation, control: Some(closed) })))
            }
            Self::Plant(of) => {
                let mut observer = plant::observation::Observer::new(&of);
                let mut follower = plant::control::Follower::new(&of);
                let fields = plant::columns::fields(&of, follower.goals(), &follower.names());
                let made = through(target, &fields, &run, shown, |take| {
                    let run = plant::stream(&of, &mut follower, &mut |step| {
                        observer.step(step);
                        take(step)
                    })?;
                    Ok((run.run.sample(), run))
                })?;
                Ok(Figures::Plant(Box::new(plant::figures(&of, (observer, follower), &made))))
            }
        }
    }

    fn finish(
        self,
        watch: &mut dyn FnMut(&Experiment, &Sample),
        reached: &mut Reached<'_>,
    ) -> Result<Finished, mckibben::Error> {
        Ok(match self {
            Self::Actuator(experiment) => {
                let outcome = engine::run(&experiment, &mut |sample| watch(&experiment, sample), reached)?;
                Finished::Actuator(Box::new(ActuatorRun { experiment: *experiment, outcome, control: None }))
            }
            Self::Controlled(of) => {
                let mut closed = closed_loop::close(&of, reached)?;
                let experiment = closed.experiment.clone();
                let outcome = closed.outcome(&mut |sample| {
                    watch(&experiment, sample);
                    reached(sample.time)
                })?;
                Finished::Actuator(Box::new(ActuatorRun { experiment, outcome, control: Some(closed) }))
            }
            Self::Joint(of) => {
                let outcome = joint::outcome::run(&of, reached)?;
                Finished::Joint(Box::new(JointRun { run: of.run, outcome, control: None }))
            }
            Self::ControlledJoint(of) => {
                let (run, mut way) = (of.experiment.run, joint::outcome::way(&of.experiment));
                let watch = |time: f64| {
                    way.kept(time);
                    reached(time)
                };
                let (outcome, closed) = joint::control::close(&of, None, watch)?;
                Finished::Joint(Box::new(JointRun { run, outcome, control: Some(closed) }))
            }
            Self::Plant(of) => Finished::Plant(Box::new(plant::run(*of, reached)?)),
        })
    }
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

impl ActuatorRun {
    fn goals(&self) -> &[Goal] {
        self.control.as_ref().map_or(&[], |closed| &closed.goals)
    }

    fn fields(&self) -> Vec<Field<Sample>> {
        of_controlled(self.outcome.rig(), &Goals::new(self.goals().to_vec().into()))
    }
}

impl JointRun {
    fn goals(&self) -> &[Goal] {
        self.control.as_ref().map_or(&[], |closed| &closed.goals)
    }

    fn fields(&self) -> Vec<Field<JointSample>> {
        of_joint(Some(self.outcome.rig()), &Goals::new(self.goals().to_vec().into()))
    }
}

impl Finished {
    /// How long was simulated, by which engine, and what was recorded.
    pub fn plan(&self) -> &Run {
        match self {
            Self::Actuator(of) => &of.experiment.run,
            Self::Joint(of) => &of.run,
            Self::Plant(of) => &of.experiment.run,
        }
    }

    /// The columns of the run in their order, with a row at t = 0, every sample interval and the end.
    ///
    /// # Errors
    /// What the core finds when a fixed-step run is repeated to be read.
    pub fn columns(&self) -> Result<Vec<Filled>, Failure> {
        let interval = self.plan().sample_interval;
        match self {
            Self::Actuator(of) => {
                let rows: record::Rows<'_, Sample> = &mut |each| of.outcome.each_sample(interval, each);
                filled(of.fields(), rows)
            }
            Self::Joint(of) => {
                let rows: record::Rows<'_, JointSample> =
                    &mut |each| of.outcome.samples(interval).try_for_each(|sample| each(&sample));
                filled(of.fields(), rows)
            }
            Self::Plant(of) => filled(of.fields(), &mut |each| of.each_sample(each)),
        }
    }

    /// The columns with a row at each of `times` in s, from the polynomials of the event-located engine.
    ///
    /// # Errors
    /// [`Failure::input`] for a time outside the run, and for a run at fixed steps, which has only its samples.
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
                let Outcome::Located(trajectory) = &of.outcome else { return Err(between_samples()) };
                let rows: record::Rows<'_, Sample> =
                    &mut |each| times.iter().try_for_each(|time| each(&trajectory.at(*time)));
                filled(of.fields(), rows)
            }
            Self::Joint(of) => {
                let Some(trajectory) = of.outcome.located() else { return Err(between_samples()) };
                let rows: record::Rows<'_, JointSample> =
                    &mut |each| trajectory.at_each(times.iter().copied()).try_for_each(|sample| each(&sample));
                filled(of.fields(), rows)
            }
            Self::Plant(of) => {
                let mut reader = PlantReader::new(&of.trajectory);
                let rows: record::Rows<'_, PlantSample> =
                    &mut |each| times.iter().try_for_each(|time| each(&reader.read(*time)));
                filled(of.fields(), rows)
            }
        }
    }

    /// The log of events, or `None` where the engine keeps none.
    pub fn log(&self) -> Option<Log> {
        match self {
            Self::Actuator(of) => events::of(&of.outcome).map(Log::new),
            Self::Joint(of) => of.outcome.located().map(|trajectory| joint::events::log(trajectory.events())),
            Self::Plant(of) => Some(plant::events::log(of)),
        }
    }

    /// The log of events as a table for people.
    pub fn table(&self) -> Option<String> {
        match self {
            Self::Actuator(of) => events::of(&of.outcome).map(events::table),
            Self::Joint(of) => of.outcome.located().map(|trajectory| joint::events::table(trajectory.events())),
            Self::Plant(of) => Some(plant::events::table(of)),
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
        let interval = self.plan().sample_interval;
        match self {
            Self::Actuator(of) => {
                let rows: record::Rows<'_, Sample> = &mut |each| of.outcome.each_sample(interval, each);
                record::write(&of.fields(), rows, Target { provenance, path, format, out })
            }
            Self::Joint(of) => {
                let rows: record::Rows<'_, JointSample> =
                    &mut |each| of.outcome.samples(interval).try_for_each(|sample| each(&sample));
                record::write(&of.fields(), rows, Target { provenance, path, format, out })
            }
            Self::Plant(of) => {
                let target = Target { provenance, path, format, out };
                record::write(&of.fields(), &mut |each| of.each_sample(each), target)
            }
        }
    }

    /// The figures of the run; those of fixed steps of an actuator as an observer has seen them.
    ///
    /// # Errors
    /// None but those of the engine.
    pub fn figures(&self, observer: Option<Observer>) -> Result<Figures, Failure> {
        Ok(match self {
            Self::Actuator(of) => {
                let ActuatorRun { experiment, outcome, control } = of.as_ref();
                let observation = observer.unwrap_or_else(|| Observer::new(None, experiment)).finish_of(outcome)?;
                let (experiment, control) = (experiment.clone(), control.clone());
                Figures::Actuator(Box::new(ActuatorFigures { experiment, observation, control }))
            }
            Self::Joint(of) => {
                let JointRun { run, outcome, control } = of.as_ref();
                let observer = joint::observation::Observer::new(None, run);
                let observation = observer.finish_of(outcome)?;
                let observation = observation.ok_or_else(|| Failure::stopped("the run has no sample"))?;
                let (rig, control) = (outcome.rig().clone(), control.clone());
                Figures::Joint(Box::new(JointFigures { rig, observation, control }))
            }
            Self::Plant(of) => Figures::Plant(Box::new(of.figures())),
        })
    }

    /// The figure of the run; that of several actuators is always over time.
    ///
    /// # Errors
    /// What the core finds when a fixed-step run is repeated to be read.
    pub fn figure(&self, over: Over, title: &str) -> Result<Figure, Failure> {
        match self {
            Self::Actuator(of) => Ok(portrait::figure(&of.experiment, &of.outcome, of.goals(), over, title)?),
            Self::Joint(of) => Ok(joint::portrait::figure(&of.outcome, of.goals(), of.run.sample_interval, title)),
            Self::Plant(of) => Ok(plant::portrait::figure(of, title)),
        }
    }
}

fn between_samples() -> Failure {
    Failure::input(
        "the fixed-step engine keeps nothing between its samples",
        "set run.engine = \"event-located\", or take the samples of the run",
    )
}
