//! What is known at an instant, whichever engine computed it.

use crate::pressure::AbsolutePressure;
use crate::valve::{Ports, SIMULTANEOUS};

/// Everything that is known at an instant: the columns of a result file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<R = f64> {
    /// Time in s.
    pub time: R,
    /// Distance between the attachments in m.
    pub length: R,
    /// Its rate in m/s.
    pub velocity: R,
    /// Absolute pressure.
    pub pressure: AbsolutePressure<R>,
    /// Mass of the air in kg.
    pub air_mass: R,
    /// Temperature of the air in K.
    pub temperature: R,
    /// Volume of the air, braid and hose, in m³.
    pub volume: R,
    /// Tension in N.
    pub tension: R,
    /// Net mass flow into the actuator in kg/s.
    pub mass_flow: R,
    /// Which flow paths of the valve are open, as the actuator sees it: late behind a lumped hose.
    pub ports: Ports,
    /// Absolute pressure at the valve's end of the hose; the actuator's own without a hose.
    pub hose_pressure: AbsolutePressure<R>,
    /// Mass of the air in the hose in kg; zero without one.
    pub hose_air_mass: R,
    /// Absolute pressure behind the valve's port to the supply where it changes: of the reservoir, of the supply's regulator,
    /// or what a pressure regulator in the valve's place makes.
    pub supply_pressure: Option<AbsolutePressure<R>>,
    /// Distance in m of what actuator and tendon in series pull together; the length without such a tendon.
    pub load_distance: R,
    /// Its rate in m/s.
    pub load_velocity: R,
}

/// The times of samples: 0, every interval, and the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleTimes {
    duration: f64,
    interval: f64,
    last: u64,
}

impl SampleTimes {
    /// The times of a run of `duration` s sampled every `interval` s, both above zero. An end that differs from a whole
    /// number of intervals by rounding is one of them. A caller that takes the interval from outside checks the count
    /// first, by [`Parameter::check_count`](crate::parameter::Parameter::check_count).
    pub fn new(duration: f64, interval: f64) -> Self {
        let whole = (duration / interval * (1.0 + SIMULTANEOUS)) as u64;
        let rest = duration - whole as f64 * interval;
        let ends_whole = rest.max(-rest) <= 4.0 * SIMULTANEOUS * duration;
        Self { duration, interval, last: whole.saturating_add(u64::from(!ends_whole)) }
    }

    /// Index of the last sample, which is at the end.
    pub fn last(&self) -> u64 {
        self.last
    }

    /// Time in s of the sample of index `index`, from 0.
    pub fn time(&self, index: u64) -> f64 {
        if index >= self.last { self.duration } else { index as f64 * self.interval }
    }

    /// The times in s of all samples, in order.
    pub fn times(self) -> impl Iterator<Item = f64> {
        (0..=self.last).map(move |index| self.time(index))
    }

    /// The ends in s of the steps that divide every interval into the least number of equal parts not longer than `step`
    /// s (above zero), and whether each is the time of a sample.
    pub fn steps(self, step: f64) -> impl Iterator<Item = (f64, bool)> {
        (1..=self.last).flat_map(move |index| {
            let (from, until) = (self.time(index - 1), self.time(index));
            let parts = steps_between(from, until, step);
            let end =
                move |part| if part == parts { until } else { from + (until - from) * (part as f64 / parts as f64) };
            (1..=parts).map(move |part| (end(part), part == parts))
        })
    }
}

/// The least number of equal steps not longer than `step` (above zero) from one time to a later one, all in s.
pub fn steps_between(from: f64, until: f64, step: f64) -> u64 {
    // The quotient of two decimal numbers may lie a rounding above a whole one.
    let quotient = (until - from) / step * (1.0 - 1e-12);
    (quotient as u64).saturating_add(1)
}
