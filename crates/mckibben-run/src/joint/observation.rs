//! The figures of a joint's run: extremes, the air of both actuators, energy and exergy.
//!
//! A run is evaluated in five points of every step and at every sample, as it is made: nothing of it is kept.

use crate::observation::{AirUse, Ended, Observes, Range};
use crate::warnings::Reached;
use mckibben::Actuator;
use mckibben::plant::{JointPlant, ViewStep};
use mckibben::simulation::{EventKind, JointRig, JointSample, Reading, SampleTimes};
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
    /// How many events of each kind there were.
    pub events: BTreeMap<EventKind, u64>,
    /// What each actuator reached, for the warnings.
    pub(crate) reached: [Reached; 2],
    /// Air of agonist and antagonist.
    pub air: [AirUse; 2],
    /// Steps and ledger.
    pub ended: Ended,
}

/// Observes a joint's run on its way.
pub struct Observer {
    joint: [Range; 3],
    actuators: [[Range; 3]; 2],
    air: [AirUse; 2],
    events: BTreeMap<EventKind, u64>,
    driven: [Actuator; 2],
    reached: [Reached; 2],
    samples: Reading<Box<dyn Iterator<Item = f64>>>,
}

impl Observes<JointPlant> for Observer {
    type Observation = Observation;

    fn new(rig: &JointRig, plan: &Run) -> Self {
        let interval = plan.sample_interval.min(plan.duration / LEAST_SAMPLES);
        let times: Box<dyn Iterator<Item = f64>> = Box::new(SampleTimes::new(plan.duration, interval).times());
        Self {
            joint: [Range::NONE; 3],
            actuators: [[Range::NONE; 3]; 2],
            air: [AirUse::default(); 2],
            events: BTreeMap::new(),
            driven: [0, 1].map(|index| rig.driven()[index].actuator.clone()),
            reached: [Reached::NONE; 2],
            samples: Reading::new(times, plan.duration),
        }
    }

    fn step(&mut self, step: &ViewStep<'_, JointPlant>) {
        let Self { joint, actuators, air, events, driven, reached, samples } = self;
        step.quadrature(|weight, sample, flows| {
            see(joint, actuators, sample);
            reach(reached, driven, sample);
            for (air, flows) in air.iter_mut().zip(flows) {
                air.see(weight, flows);
            }
        });
        let Ok(()) = samples.step(step, |sample| {
            see(joint, actuators, sample);
            reach(reached, driven, sample);
            Ok::<_, std::convert::Infallible>(())
        });
        if let Some(event) = step.event() {
            *events.entry(event.kind.kind).or_insert(0) += 1;
        }
    }

    fn finish(mut self, last: JointSample, ended: Ended) -> Observation {
        see(&mut self.joint, &mut self.actuators, &last);
        reach(&mut self.reached, &self.driven, &last);
        let Self { joint, actuators, air, events, reached, .. } = self;
        Observation { last, joint, actuators, events, reached, air, ended }
    }
}

fn reach(reached: &mut [Reached; 2], driven: &[Actuator; 2], sample: &JointSample) {
    for ((reached, actuator), sample) in reached.iter_mut().zip(driven).zip(&sample.actuators) {
        reached.see(actuator, sample);
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
