//! The figures of a joint's run: extremes, the air of both actuators, energy and exergy.
//!
//! A run is evaluated in five points of every step, at both ends of the step, at every sample, and where a quantity turns at an
//! extreme, as it is made: nothing of it is kept.

use crate::observation::{AirUse, Ended, Observes, Peaks, Range, Times, dense_times};
use crate::warnings::Reached;
use mckibben::Actuator;
use mckibben::plant::{JointPlant, ViewStep};
use mckibben::simulation::{EventKind, JointRig, JointSample, Readable as _, Reading};
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
    peaks: Peaks<[f64; 9]>,
    air: [AirUse; 2],
    events: BTreeMap<EventKind, u64>,
    driven: [Actuator; 2],
    reached: [Reached; 2],
    samples: Reading<Times>,
}

impl Observes<JointPlant> for Observer {
    type Observation = Observation;

    fn new(rig: &JointRig, plan: &Run) -> Self {
        Self {
            peaks: Peaks::new(9),
            air: [AirUse::default(); 2],
            events: BTreeMap::new(),
            driven: [0, 1].map(|index| rig.driven()[index].actuator.clone()),
            reached: [Reached::NONE; 2],
            samples: Reading::new(dense_times(plan, LEAST_SAMPLES), plan.duration),
        }
    }

    fn step(&mut self, step: &ViewStep<'_, JointPlant>) {
        let Self { peaks, air, events, driven, reached, samples } = self;
        let mut see = |time, sample: &JointSample| {
            peaks.see(time, values(sample));
            reach(reached, driven, sample);
        };
        step.quadrature(|weight, sample, flows| {
            see(sample.time, sample);
            for (air, flows) in air.iter_mut().zip(flows) {
                air.see(weight, flows);
            }
        });
        let Ok(()) = samples.step(step, |sample| {
            see(sample.time, sample);
            Ok::<_, std::convert::Infallible>(())
        });
        // What is passed within an instant has no place in the run.
        if step.holds(step.start()) {
            [step.start(), step.end()].into_iter().for_each(|time| see(time, &step.at(time)));
        }
        peaks.turn(|time| {
            let sample = step.at(time);
            reach(reached, driven, &sample);
            values(&sample)
        });
        if let Some(event) = step.event() {
            *events.entry(event.kind.kind).or_insert(0) += 1;
        }
    }

    fn finish(mut self, last: JointSample, ended: Ended) -> Observation {
        self.peaks.widen(&values(&last));
        reach(&mut self.reached, &self.driven, &last);
        let Self { peaks, air, events, reached, .. } = self;
        let three = |first: usize| [0, 1, 2].map(|index| peaks.ranges()[first + index]);
        let (joint, actuators) = (three(0), [three(3), three(6)]);
        Observation { last, joint, actuators, events, reached, air, ended }
    }
}

fn reach(reached: &mut [Reached; 2], driven: &[Actuator; 2], sample: &JointSample) {
    for ((reached, actuator), sample) in reached.iter_mut().zip(driven).zip(&sample.actuators) {
        reached.see(actuator, sample);
    }
}

/// The quantities of a sample: those of the joint, then those of each actuator, in the order of [`Observation`].
fn values(of: &JointSample) -> [f64; 9] {
    let [agonist, antagonist] = &of.actuators;
    [
        of.angle,
        of.angular_velocity,
        of.torque,
        agonist.length,
        agonist.tension,
        agonist.pressure.0,
        antagonist.length,
        antagonist.tension,
        antagonist.pressure.0,
    ]
}
