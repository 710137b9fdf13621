//! Runs of the plant of a joint, kept or handed on step by step, read as those of the joint.

use super::{JointEvent, JointPlant};
use crate::air::Flow;
use crate::command::{Driver, PlantDecision};
use crate::engine::Statistics;
use crate::error::Error;
use crate::parameter;
use crate::plant::{
    Part, PlantEvent, PlantLedger, PlantMode, PlantReader, PlantRun, PlantSample, PlantStep, PlantTrajectory,
};
use crate::scalar::Real;
use crate::simulation::{JointDecision, JointRig, JointSample, JointState, Readable, SampleTimes};
use alloc::vec::Vec;

/// A run of a joint that is kept: samples at any time and the log of events.
#[derive(Clone, Debug)]
pub struct JointTrajectory<R: Real = f64> {
    joint: JointPlant<R>,
    rig: JointRig<R>,
    trajectory: PlantTrajectory<R>,
    events: Vec<JointEvent<R>>,
}

/// An accepted step of a joint's run: every sample within it, by dense output, and the event that ended it.
#[derive(Clone, Copy, Debug)]
pub struct JointStep<'s> {
    joint: &'s JointPlant,
    step: &'s PlantStep<'s>,
}

/// Reads samples of a run of a joint, with room that is used again: quickest where the times do not fall from one to the next.
#[derive(Debug)]
pub struct JointReader<'t, R: Real = f64> {
    joint: &'t JointPlant<R>,
    reader: PlantReader<'t, R>,
    sample: PlantSample<R>,
}

impl<'t, R: Real> JointReader<'t, R> {
    /// Reads a run.
    pub fn new(of: &'t JointTrajectory<R>) -> Self {
        let sample = PlantSample::new(of.trajectory.plant());
        Self { joint: &of.joint, reader: PlantReader::new(&of.trajectory), sample }
    }

    /// The sample at a time in s: see [`JointTrajectory::at`].
    pub fn read(&mut self, time: R) -> JointSample<R> {
        self.reader.read_into(time, &mut self.sample);
        self.joint.sample(&self.sample)
    }
}

/// Takes each accepted step of a joint's run in order of time; its error ends the run.
pub type JointConsumer<'c> = dyn FnMut(&JointStep<'_>) -> Result<(), Error> + 'c;

/// What holds at the end of a joint's run of which nothing else is kept.
#[derive(Clone, Debug)]
pub struct JointRunEnd {
    /// The joint; under a controller its commands are the tables of all that the controller requested.
    pub rig: JointRig,
    /// The last sample.
    pub sample: JointSample,
    /// The run of the plant.
    pub run: PlantRun,
}

impl<R: Real> JointPlant<R> {
    /// A run of the plant from a state of the joint at t = 0, with a driver in place of the joint's own commands if there is
    /// one, that is to go on for `duration` s.
    fn begin(
        &self,
        state: &JointState<R>,
        (duration, relative_tolerance): (R, f64),
        driver: Option<Driver<R>>,
    ) -> Result<PlantRun<R>, Error> {
        parameter::DURATION.check(duration.value())?;
        parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
        self.rig.check_counts(duration.value())?;
        PlantRun::with_drivers(&self.plant, &self.start(state), relative_tolerance, driver.into_iter().collect())
    }

    /// Simulates the joint from a state at t = 0 for `duration` s, every event located, with a relative tolerance for each
    /// step.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a duration or tolerance outside its range; [`Error::TooMany`] for more pulses than a run may
    /// have; [`Error::Stopped`] when the simulation cannot reach its end: it says when, where and what to change.
    pub fn simulate(
        &self,
        state: &JointState<R>,
        duration: R,
        relative_tolerance: f64,
    ) -> Result<JointTrajectory<R>, Error> {
        self.record(state, (duration, relative_tolerance), None, &mut |_| Ok(()))
    }

    /// Simulates the joint as [`JointPlant::simulate`] does, with a [driver](JointPlant::driver) in place of its own commands if
    /// there is one; `watch` is called with the time in s that has been reached now and then, and may end the run by an error
    /// such as [`Error::Interrupted`].
    ///
    /// # Errors
    /// As [`JointPlant::simulate`], those of the driver's controller, and those of `watch`.
    pub fn record(
        &self,
        state: &JointState<R>,
        (duration, relative_tolerance): (R, f64),
        driver: Option<Driver<R>>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<JointTrajectory<R>, Error> {
        R::record_joint(self, state, (duration, relative_tolerance), driver, watch)
    }

    pub(crate) fn generic_record(
        &self,
        state: &JointState<R>,
        (duration, relative_tolerance): (R, f64),
        driver: Option<Driver<R>>,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<JointTrajectory<R>, Error> {
        let mut run = self.begin(state, (duration, relative_tolerance), driver)?;
        let trajectory = run.record_to(duration, watch)?;
        let rig = self.rig_commanded(trajectory.plant().network());
        let modes = trajectory.modes().windows(2);
        let event = |(event, modes): (&PlantEvent<R>, &[PlantMode<R>])| {
            let kind = self.event_kind(event.kind)?;
            let [before, after] = [0, 1].map(|which| self.mode(&modes[which]));
            Some(JointEvent { time: event.time, kind, before, after })
        };
        let events = trajectory.events().iter().zip(modes).filter_map(event).collect();
        Ok(JointTrajectory { joint: self.clone(), rig, trajectory, events })
    }
}

impl JointPlant {
    /// Simulates the joint as [`JointPlant::record`] does and hands each accepted step to `consumer`; nothing is kept but the
    /// requests to valves that a driver has.
    ///
    /// # Errors
    /// As [`JointPlant::simulate`], those of the driver's controller, and those of the consumer.
    pub fn stream(
        &self,
        state: &JointState,
        span: (f64, f64),
        driver: Option<Driver>,
        consumer: &mut JointConsumer<'_>,
    ) -> Result<JointRunEnd, Error> {
        let mut run = self.begin(state, span, driver)?;
        let mut network = run.plant().network().clone();
        run.stream_to(span.0, &mut |step| {
            if let (Some(event), Some(after)) = (step.event(), step.mode_after())
                && let Part::Driver(driver) = event.kind.part
            {
                network.record_settings(after.drivers[driver].valves(), event.time, &after.network);
            }
            consumer(&JointStep { joint: self, step })
        })?;
        Ok(JointRunEnd { rig: self.rig_commanded(&network), sample: self.sample(&run.sample()), run })
    }

    /// The sizes by which the errors of the joint's six states are scaled in a state: angle, angular velocity, and pressure and
    /// mass of air of agonist and antagonist.
    pub(crate) fn usual_sizes(&self, state: &JointState, relative_tolerance: f64) -> Result<[f64; 6], Error> {
        let run = PlantRun::new(&self.plant, &self.start(state), relative_tolerance)?;
        let places = run.plant().places();
        let (mechanism, of) = (places.mechanisms[0], &places.actuators);
        let scales = run.scales();
        let places =
            [mechanism.position(0), mechanism.rate(0), of[0].pressure, of[0].mass(), of[1].pressure, of[1].mass()];
        Ok(places.map(|place| scales[place]))
    }
}

impl<R: Real> JointTrajectory<R> {
    /// The joint that was simulated; under a controller its commands are the tables of all that the controller requested.
    pub fn rig(&self) -> &JointRig<R> {
        &self.rig
    }

    /// The joint as a plant.
    pub fn joint(&self) -> &JointPlant<R> {
        &self.joint
    }

    /// The run of the plant.
    pub fn plant(&self) -> &PlantTrajectory<R> {
        &self.trajectory
    }

    /// The events in order of time.
    pub fn events(&self) -> &[JointEvent<R>] {
        &self.events
    }

    /// What the controller saw and decided, in order of time.
    pub fn decisions(&self) -> Vec<JointDecision<R>> {
        let decision = |(_, decision): &(usize, PlantDecision<R>)| self.joint.decision(decision);
        self.trajectory.decisions().iter().filter_map(decision).collect()
    }

    /// Steps, evaluations and events, those of the controller included.
    pub fn statistics(&self) -> Statistics {
        self.trajectory.statistics()
    }

    /// End of the trajectory in s.
    pub fn duration(&self) -> R {
        self.trajectory.duration()
    }

    /// The sample at `time` in s, by dense output; at the instant of an event, after it. Times before the start and
    /// after the end give the first and the last sample.
    pub fn at(&self, time: R) -> JointSample<R> {
        self.joint.sample(&self.trajectory.sample(time))
    }

    /// Samples at times in s, quickest where these do not fall.
    pub fn at_each(&self, times: impl Iterator<Item = R>) -> impl Iterator<Item = JointSample<R>> {
        let mut reader = JointReader::new(self);
        times.map(move |time| reader.read(time))
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = JointSample<R>> + '_ {
        let times = SampleTimes::new(self.duration().value(), interval);
        self.at_each(times.times().map(R::constant))
    }
}

impl JointTrajectory {
    /// Hands each step to `consumer` in order of time, as [`JointPlant::stream`] did on the way.
    ///
    /// # Errors
    /// Those of the consumer.
    pub fn replay(&self, consumer: &mut JointConsumer<'_>) -> Result<(), Error> {
        self.trajectory.replay(&mut |step| consumer(&JointStep { joint: &self.joint, step }))
    }

    /// The ledger of energy and exergy of the whole run.
    pub fn ledger(&self) -> PlantLedger {
        self.trajectory.ledger()
    }
}

impl<'s> JointStep<'s> {
    /// The step of the plant.
    pub fn plant(&self) -> &'s PlantStep<'s> {
        self.step
    }

    /// Start of the step in s.
    pub fn start(&self) -> f64 {
        self.step.start()
    }

    /// End of the step in s.
    pub fn end(&self) -> f64 {
        self.step.end()
    }

    /// The event that ended the step, if one did.
    pub fn event(&self) -> Option<JointEvent> {
        let (event, after) = (self.step.event()?, self.step.mode_after()?);
        let kind = self.joint.event_kind(event.kind)?;
        let (before, after) = (self.joint.mode(self.step.mode()), self.joint.mode(after));
        Some(JointEvent { time: event.time, kind, before, after })
    }

    /// What the controller decided at the sampling instant that ended the step, if one did.
    pub fn decision(&self) -> Option<JointDecision> {
        let (_, decision) = self.step.decision()?;
        self.joint.decision(decision)
    }

    /// Calls `visit` with the weight in s, the sample, and each actuator's flows as of [`JointPlant::valve_flows`], at the Gauss
    /// points of the step: `Σ weight · f` over all steps is the integral of f over the run, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(f64, &JointSample, [[Flow; 2]; 2])) {
        self.step.quadrature(|weight, sample| {
            visit(weight, &self.joint.sample(sample), self.joint.valve_flows(sample));
        });
    }
}

impl Readable for JointStep<'_> {
    type Sample = JointSample;

    fn holds(&self, time: f64) -> bool {
        self.step.holds(time)
    }

    fn read(&self, time: f64) -> JointSample {
        self.joint.sample(&self.step.read(time))
    }
}
