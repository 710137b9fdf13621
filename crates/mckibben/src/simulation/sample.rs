//! What is known at an instant, whichever engine computed it.

use super::kernel::Observed;
use crate::pressure::AbsolutePressure;
use crate::scalar::Scalar;
use crate::valve::{Ports, SIMULTANEOUS};
#[cfg(feature = "batch")]
use crate::{air::Flow, scalar::Vector};

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
    /// Which passages of the valve are open.
    pub ports: Ports,
}

impl<R: Scalar> Sample<R> {
    /// The sample of four states with what has been computed from them.
    pub(super) fn new(
        time: R,
        &[length, velocity, pressure, air_mass]: &[R; 4],
        observed: &Observed<R>,
        ports: Ports,
    ) -> Self {
        let &Observed { tension, volume, temperature, flow } = observed;
        let tension = tension.larger(R::zero());
        let (pressure, mass_flow) = (AbsolutePressure(pressure), flow.net());
        Self { time, length, velocity, pressure, air_mass, temperature, volume, tension, mass_flow, ports }
    }
}

impl Sample {
    /// The sample of one lane.
    #[cfg(feature = "batch")]
    pub(crate) fn of_lane<S: Vector<Lane = f64>>(
        time: f64,
        state: &[S; 4],
        observed: &Observed<S>,
        lane: usize,
        ports: Ports,
    ) -> Self {
        let flow = Flow { inward: observed.flow.inward.lane(lane), outward: observed.flow.outward.lane(lane) };
        let observed = Observed {
            tension: observed.tension.lane(lane),
            volume: observed.volume.lane(lane),
            temperature: observed.temperature.lane(lane),
            flow,
        };
        Self::new(time, &state.map(|number| number.lane(lane)), &observed, ports)
    }
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
    /// number of intervals by rounding is one of them.
    pub fn new(duration: f64, interval: f64) -> Self {
        let whole = (duration / interval * (1.0 + SIMULTANEOUS)) as u64;
        let rest = duration - whole as f64 * interval;
        let ends_whole = rest.max(-rest) <= 4.0 * SIMULTANEOUS * duration;
        Self { duration, interval, last: whole + u64::from(!ends_whole) }
    }

    /// Index of the last sample, which is at the end.
    pub fn last(&self) -> u64 {
        self.last
    }

    /// Time in s of the sample of index `index`, from 0.
    pub fn time(&self, index: u64) -> f64 {
        if index >= self.last { self.duration } else { index as f64 * self.interval }
    }
}
