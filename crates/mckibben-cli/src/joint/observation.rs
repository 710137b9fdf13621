//! The figures of a joint's run: extremes, the air of both actuators, energy and exergy.
//!
//! An event-located run is evaluated in five points of every step and at every sample, as it is made; a run at fixed steps at its
//! samples.

use super::outcome::Outcome;
use crate::observation::{AirUse, Range, Steps};
use mckibben::Error;
use mckibben::engine::Statistics;
use mckibben::plant::{JointPlant, JointStep, PlantLedger, PlantLedgerKeeper, PlantRun};
use mckibben::simulation::{EventKind, JointSample, Reading, SampleTimes};
use mckibben_scenario::Run;
use std::collections::BTreeMap;

/// Samples in which extremes are looked for at least.
const LEAST_SAMPLES: f64 = 5000.0;

/// Everything that is observed of a joint's run.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The sample at the end.
    pub last: JointSample,
    /// Of the angle in rad, the angular velocity in rad/s and the torque in N·m.
    pub joint: [Range; 3],
    /// Of each actuator's length in m, tension in N and absolute pressure in Pa.
    pub actuators: [[Range; 3]; 2],
    /// By the event-located engine.
    pub located: Option<Located>,
    /// By the fixed-step engine.
    pub steps: Option<Steps>,
}

/// What only the event-located engine gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// Steps, evaluations and events.
    pub counts: Statistics,
    /// How many events of each kind there were.
    pub events: BTreeMap<EventKind, u64>,
    /// Air of agonist and antagonist.
    pub air: [AirUse; 2],
    /// Where the work of both gases and the exergy of the supplies' air went.
    pub ledger: PlantLedger,
    /// Whether an actuator has a valve, through which it draws air.
    pub draws: bool,
}

/// Observes a joint's run on its way.
pub struct Observer<'j> {
    joint: [Range; 3],
    actuators: [[Range; 3]; 2],
    air: [AirUse; 2],
    events: BTreeMap<EventKind, u64>,
    /// Of a run by the event-located engine.
    ledger: Option<PlantLedgerKeeper<'j>>,
    samples: Reading<Box<dyn Iterator<Item = f64>>>,
}

impl<'j> Observer<'j> {
    /// Begins to observe a run of a joint: by the event-located engine, of its plant.
    pub fn new(joint: Option<&'j JointPlant>, run: &Run) -> Self {
        let interval = run.sample_interval.min(run.duration / LEAST_SAMPLES);
        let times: Box<dyn Iterator<Item = f64>> = Box::new(SampleTimes::new(run.duration, interval).times());
        Self {
            joint: [Range::NONE; 3],
            actuators: [[Range::NONE; 3]; 2],
            air: [AirUse::default(); 2],
            events: BTreeMap::new(),
            ledger: joint.map(|joint| PlantLedgerKeeper::new(joint.plant(), run.relative_tolerance)),
            samples: Reading::new(times, run.duration),
        }
    }

    /// Observes an accepted step of the event-located engine.
    pub fn step(&mut self, step: &JointStep<'_>) {
        let Self { joint, actuators, air, events, ledger, samples } = self;
        if let Some(ledger) = ledger {
            ledger.step(step.plant());
        }
        step.quadrature(|weight, sample, flows| {
            see(joint, actuators, sample);
            for (air, flows) in air.iter_mut().zip(flows) {
                air.see(weight, flows);
            }
        });
        let Ok(()) = samples.step(step, |sample| {
            see(joint, actuators, sample);
            Ok::<_, std::convert::Infallible>(())
        });
        if let Some(event) = step.event() {
            *events.entry(event.kind.kind).or_insert(0) += 1;
        }
    }

    /// The figures of a run of the event-located engine that has come to its end.
    pub fn finish(mut self, last: JointSample, run: &PlantRun) -> Observation {
        let ledger = self.ledger.take().map(|ledger| ledger.finish(run)).unwrap_or_default();
        self.close(last, (run.statistics(), !run.plant().network().valves.is_empty()), ledger)
    }

    fn close(mut self, last: JointSample, (counts, draws): (Statistics, bool), ledger: PlantLedger) -> Observation {
        see(&mut self.joint, &mut self.actuators, &last);
        let Self { joint, actuators, air, events, .. } = self;
        let located = Some(Located { counts, events, air, ledger, draws });
        Observation { last, joint, actuators, located, steps: None }
    }

    /// The figures of a run that was kept, or made at fixed steps; none without a sample.
    ///
    /// # Errors
    /// None but those of the engine.
    pub fn finish_of(mut self, outcome: &Outcome) -> Result<Option<Observation>, Error> {
        match outcome {
            Outcome::Located(trajectory) => {
                self.ledger = None;
                trajectory.replay(&mut |step| {
                    self.step(step);
                    Ok(())
                })?;
                let draws = !trajectory.plant().plant().network().valves.is_empty();
                let last = trajectory.at(trajectory.duration());
                Ok(Some(self.close(last, (trajectory.statistics(), draws), trajectory.ledger())))
            }
            Outcome::Stepped(stepped) => {
                let Self { mut joint, mut actuators, .. } = self;
                stepped.samples.iter().for_each(|sample| see(&mut joint, &mut actuators, sample));
                let chosen = stepped.chosen.map(|error| [error.compared, error.greatest]);
                let steps = Some(Steps { step: stepped.step, chosen, steps: stepped.steps });
                let last = stepped.samples.last();
                Ok(last.map(|last| Observation { last: *last, joint, actuators, located: None, steps }))
            }
        }
    }
}

fn see(joint: &mut [Range; 3], actuators: &mut [[Range; 3]; 2], sample: &JointSample) {
    for (range, value) in joint.iter_mut().zip([sample.angle, sample.angular_velocity, sample.torque]) {
        range.see(value);
    }
    for (ranges, of) in actuators.iter_mut().zip(&sample.actuators) {
        for (range, value) in ranges.iter_mut().zip([of.length, of.tension, of.pressure.0]) {
            range.see(value);
        }
    }
}
