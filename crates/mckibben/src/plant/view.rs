//! Plants that are something smaller, an actuator on its load or a joint, and their runs read as runs of that.
//!
//! A [`PlantView`] knows where the parts of the smaller thing lie in its plant. Everything else is the plant's: a
//! [`ViewTrajectory`] is a [`PlantTrajectory`], a [`ViewStep`] a [`PlantStep`], read by the view.
//!
//! Checked by `tests/simulation.rs`, `tests/joint.rs` and `tests/run.rs`.

use super::steps::TimeStepping;
use super::{
    Part, Plant, PlantEvent, PlantLedger, PlantMode, PlantReader, PlantRun, PlantSample, PlantStart, PlantStep,
    PlantTrajectory,
};
use crate::command::{Driver, PlantDecision};
use crate::engine::Statistics;
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::network::Network;
use crate::parameter;
use crate::simulation::{Readable, SampleTimes};
use alloc::vec::Vec;
use core::fmt::Debug;

/// Something smaller that a plant is.
pub trait PlantView<R: Instantiate = f64>: Clone + Debug {
    /// What it is, with the commands of its valves.
    type Rig: Clone + Debug;
    /// Its states.
    type State;
    /// What is known of it at an instant.
    type Sample;
    /// Which formulas hold.
    type Mode;
    /// A change of mode.
    type Event: Clone + Debug;
    /// What its controller saw and decided.
    type Decision;
    /// Flows through the flow paths of its valves, to the supply and to the atmosphere.
    type Flows;

    /// What it is.
    fn rig(&self) -> &Self::Rig;

    /// The plant.
    fn plant(&self) -> &Plant<R>;

    /// The start of the plant in a state.
    fn start(&self, state: &Self::State) -> PlantStart<R>;

    /// That a run of so many seconds has no more pulses and periods than one may have.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    fn check_counts(&self, duration: f64) -> Result<(), Error>;

    /// A sample of the plant as one of it.
    fn sample(&self, of: &PlantSample<R>) -> Self::Sample;

    /// The flows into what each valve opens into. What flows out to a pressure regulator it lets go to the atmosphere.
    fn valve_flows(&self, of: &PlantSample<R>) -> Self::Flows;

    /// A mode of the plant as one of it.
    fn mode(&self, of: &PlantMode<R>) -> Self::Mode;

    /// An event of the plant between two modes as one of it; none for a sample that a driver took, which changes no mode.
    fn event(&self, of: &PlantEvent<R>, modes: [&PlantMode<R>; 2]) -> Option<Self::Event>;

    /// What a driver decided as a decision of it.
    fn decision(&self, of: &PlantDecision<R>) -> Option<Self::Decision>;

    /// What it is with the commands that the valves of a network have come to have.
    fn commanded(&self, network: &Network<R>) -> Self::Rig;
}

/// A run that is kept: samples at any time and the log of events.
#[derive(Clone, Debug)]
pub struct ViewTrajectory<V: PlantView<R>, R: Instantiate = f64> {
    view: V,
    rig: V::Rig,
    trajectory: PlantTrajectory<R>,
    events: Vec<V::Event>,
}

/// An accepted step of a run: every sample within it, by dense output, and the event that ended it.
#[derive(Clone, Copy, Debug)]
pub struct ViewStep<'s, V> {
    view: &'s V,
    step: &'s PlantStep<'s>,
}

/// Reads samples of a run, with room that is used again: quickest where the times do not fall from one to the next.
#[derive(Debug)]
pub struct ViewReader<'t, V, R: Instantiate = f64> {
    view: &'t V,
    reader: PlantReader<'t, R>,
    sample: PlantSample<R>,
}

/// What holds at the end of a run of which nothing else is kept.
#[derive(Clone, Debug)]
pub struct ViewRunEnd<V: PlantView> {
    /// What was run; under a controller its commands are the tables of all that the controller requested.
    pub rig: V::Rig,
    /// The last sample.
    pub sample: V::Sample,
    /// The run of the plant.
    pub run: PlantRun,
}

impl<'t, V: PlantView<R>, R: Instantiate> ViewReader<'t, V, R> {
    /// Reads a run.
    pub fn new(of: &'t ViewTrajectory<V, R>) -> Self {
        let sample = PlantSample::new(of.trajectory.plant());
        Self { view: &of.view, reader: PlantReader::new(&of.trajectory), sample }
    }

    /// The sample at a time in s: see [`ViewTrajectory::at`].
    pub fn read(&mut self, time: R) -> V::Sample {
        self.reader.read_into(time, &mut self.sample);
        self.view.sample(&self.sample)
    }
}

/// A run from a state at t = 0, with a driver in place of the commands of its valves if there is one, that is to go on for
/// `duration` s.
fn begin<V: PlantView<R>, R: Instantiate>(
    view: &V,
    state: &V::State,
    (duration, stepping): (R, TimeStepping),
    driver: Option<Driver<R>>,
) -> Result<PlantRun<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    stepping.check()?;
    view.check_counts(duration.value())?;
    PlantRun::with_drivers(view.plant(), &view.start(state), stepping, driver.into_iter().collect())
}

/// Simulates what a plant is from a state at t = 0 for `duration` s and keeps every step, with a driver in place of its own
/// commands if there is one. `watch` is called with the time in s now and then, and may end the run. With what was kept comes the
/// run, which can go on.
///
/// # Errors
/// As [`RigPlant::record`](super::RigPlant::record).
pub fn record_view<V: PlantView<R>, R: Instantiate>(
    view: &V,
    state: &V::State,
    (duration, stepping): (R, TimeStepping),
    driver: Option<Driver<R>>,
    watch: &mut dyn FnMut(f64) -> Result<(), Error>,
) -> Result<(ViewTrajectory<V, R>, PlantRun<R>), Error> {
    let mut run = begin(view, state, (duration, stepping), driver)?;
    let trajectory = run.record_to(duration, watch)?;
    Ok((ViewTrajectory::of(view, trajectory), run))
}

/// Simulates what a plant is as [`record_view`] does and hands each accepted step to `consumer`; nothing is kept but the requests
/// to valves that a driver has.
///
/// # Errors
/// As [`RigPlant::stream`](super::RigPlant::stream).
pub fn stream_view<V: PlantView>(
    view: &V,
    state: &V::State,
    span: (f64, TimeStepping),
    driver: Option<Driver>,
    consumer: &mut dyn FnMut(&ViewStep<'_, V>) -> Result<(), Error>,
) -> Result<ViewRunEnd<V>, Error> {
    let mut run = begin(view, state, span, driver)?;
    let mut network = run.plant().network().clone();
    run.stream_to(span.0, &mut |step| {
        if let (Some(event), Some(after)) = (step.event(), step.mode_after())
            && let Part::Driver(driver) = event.kind.part
        {
            network.record_settings(after.drivers[driver].valves(), event.time, &after.network);
        }
        consumer(&ViewStep { view, step })
    })?;
    Ok(ViewRunEnd { rig: view.commanded(&network), sample: view.sample(&run.sample()), run })
}

impl<V: PlantView<R>, R: Instantiate> ViewTrajectory<V, R> {
    /// The run of the plant of a view.
    pub(crate) fn of(view: &V, trajectory: PlantTrajectory<R>) -> Self {
        let mut events = Vec::new();
        trajectory.each_event(|event, modes| events.extend(view.event(event, modes)));
        let rig = view.commanded(trajectory.plant().network());
        Self { view: view.clone(), rig, trajectory, events }
    }

    /// What was run; under a controller its commands are the tables of all that the controller requested.
    pub fn rig(&self) -> &V::Rig {
        &self.rig
    }

    /// Where its parts lie in the plant.
    pub fn view(&self) -> &V {
        &self.view
    }

    /// The run of the plant.
    pub fn plant(&self) -> &PlantTrajectory<R> {
        &self.trajectory
    }

    /// The run of the plant alone.
    pub fn into_plant(self) -> PlantTrajectory<R> {
        self.trajectory
    }

    /// The events in order of time.
    pub fn events(&self) -> &[V::Event] {
        &self.events
    }

    /// What the controller saw and decided, in order of time.
    pub fn decisions(&self) -> Vec<V::Decision> {
        let decision = |(_, decision): &(usize, PlantDecision<R>)| self.view.decision(decision);
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
    /// after the end give the first and the last sample. For many use a [`ViewReader`].
    pub fn at(&self, time: R) -> V::Sample {
        self.view.sample(&self.trajectory.sample(time))
    }

    /// Samples at times in s, quickest where these do not fall.
    pub fn at_each(&self, times: impl Iterator<Item = R>) -> impl Iterator<Item = V::Sample> {
        let mut reader = ViewReader::new(self);
        times.map(move |time| reader.read(time))
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = V::Sample> + '_ {
        let times = SampleTimes::new(self.duration().value(), interval);
        self.at_each(times.times().map(R::constant))
    }
}

impl<V: PlantView> ViewTrajectory<V> {
    /// Hands each step to `consumer` in order of time, as a run of which nothing is kept does on the way.
    ///
    /// # Errors
    /// Those of the consumer.
    pub fn replay(&self, consumer: &mut dyn FnMut(&ViewStep<'_, V>) -> Result<(), Error>) -> Result<(), Error> {
        self.trajectory.replay(&mut |step| consumer(&ViewStep { view: &self.view, step }))
    }

    /// Calls `visit` with the weight in s, the sample, and the flows as of [`PlantView::valve_flows`], at the Gauss points of
    /// each step: `Σ weight · f` is the integral of f over the run, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(f64, &V::Sample, V::Flows)) {
        // Nothing fails.
        let _ = self.replay(&mut |step| {
            step.quadrature(&mut visit);
            Ok(())
        });
    }

    /// The ledger of energy and exergy of the whole run.
    pub fn ledger(&self) -> PlantLedger {
        self.trajectory.ledger()
    }
}

impl<'s, V: PlantView> ViewStep<'s, V> {
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

    /// The mode within the step.
    pub fn mode(&self) -> V::Mode {
        self.view.mode(self.step.mode())
    }

    /// The event that ended the step, if one did.
    pub fn event(&self) -> Option<V::Event> {
        let (event, after) = (self.step.event()?, self.step.mode_after()?);
        self.view.event(event, [self.step.mode(), after])
    }

    /// What the controller decided at the sampling instant that ended the step, if one did.
    pub fn decision(&self) -> Option<V::Decision> {
        let (_, decision) = self.step.decision()?;
        self.view.decision(decision)
    }

    /// The sample at a time in s, kept within the step.
    pub fn at(&self, time: f64) -> V::Sample {
        self.view.sample(&self.step.read(time))
    }

    /// Calls `visit` with the weight in s, the sample, and the flows as of [`PlantView::valve_flows`], at the Gauss points of the
    /// step: `Σ weight · f` over all steps is the integral of f over the run, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(f64, &V::Sample, V::Flows)) {
        self.step.quadrature(|weight, sample| {
            visit(weight, &self.view.sample(sample), self.view.valve_flows(sample));
        });
    }
}

impl<V: PlantView> Readable for ViewStep<'_, V> {
    type Sample = V::Sample;

    fn holds(&self, time: f64) -> bool {
        self.step.holds(time)
    }

    fn read(&self, time: f64) -> V::Sample {
        self.at(time)
    }
}
