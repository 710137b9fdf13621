//! The figures of a run: extremes, the last periods under PWM, the air through each port.
//!
//! An event-located run is looked at in five points of every step, at every event and at every sample; a fixed-step run at every step.

use crate::engine::Outcome;
use mckibben::Actuator;
use mckibben::air::Flow;
use mckibben::simulation::{Extent, Mode, Sample, Trajectory};
use mckibben::valve::Command;
use mckibben_scenario::Experiment;

/// The least and the greatest value of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
}

impl Range {
    pub(crate) const NONE: Self = Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY };

    pub(crate) fn see(&mut self, value: f64) {
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
    }

    /// The greater of the two magnitudes.
    pub fn peak(&self) -> f64 {
        self.least.abs().max(self.greatest.abs())
    }
}

/// Extremes over a whole run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Of the distance between the attachments in m.
    pub length: Range,
    /// Of its rate in m/s.
    pub velocity: Range,
    /// Of the tension in N.
    pub tension: Range,
    /// Of the absolute pressure in Pa.
    pub pressure: Range,
    /// Of the air's temperature in K.
    pub temperature: Range,
}

impl Extremes {
    const NONE: Self = Self {
        length: Range::NONE,
        velocity: Range::NONE,
        tension: Range::NONE,
        pressure: Range::NONE,
        temperature: Range::NONE,
    };

    fn see(&mut self, sample: &Sample) {
        self.length.see(sample.length);
        self.velocity.see(sample.velocity);
        self.tension.see(sample.tension);
        self.pressure.see(sample.pressure.0);
        self.temperature.see(sample.temperature);
    }
}

/// Air in kg through the ports of the valve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirUse {
    /// In from the supply; with the fixed-step engine, from any side.
    pub from_supply: f64,
    /// Back into the supply, as with a vacuum; not told apart by the fixed-step engine.
    pub to_supply: f64,
    /// In from the surroundings; not told apart by the fixed-step engine.
    pub from_surroundings: f64,
    /// Out to the surroundings; with the fixed-step engine, to any side.
    pub to_surroundings: f64,
}

impl AirUse {
    /// Adds the flow of an actuator without an air line at a point of a quadrature with its weight in s.
    pub fn see_actuator(&mut self, actuator: &Actuator, weight: f64, sample: &Sample, mode: &Mode) {
        let (length, velocity, pressure, mass) = (sample.length, sample.velocity, sample.pressure.0, sample.air_mass);
        let chamber = actuator.chamber(length, velocity, pressure, mass, mode.extent == Extent::Slack);
        let supply = actuator.flow(&chamber, sample.ports.supply, false);
        let surroundings = actuator.flow(&chamber, false, sample.ports.exhaust);
        self.see(weight, [supply, surroundings]);
    }

    /// Adds the flows to the supply and to the surroundings at a point of a quadrature with its weight in s.
    pub fn see(&mut self, weight: f64, [supply, surroundings]: [Flow; 2]) {
        self.from_supply += weight * supply.inward;
        self.to_supply += weight * supply.outward;
        self.from_surroundings += weight * surroundings.inward;
        self.to_surroundings += weight * surroundings.outward;
    }
}

/// The length over the last whole periods of PWM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// How many periods were looked at.
    pub periods: u64,
    /// The mean length in m.
    pub mean: f64,
    /// The greatest minus the least length in m.
    pub peak_to_peak: f64,
    /// The mean length of the last period minus that of the one before, in m.
    pub drift: Option<f64>,
}

/// Everything that is observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The sample at the start.
    pub first: Sample,
    /// The sample at the end.
    pub last: Sample,
    /// Extremes.
    pub extremes: Extremes,
    /// Air through the ports.
    pub air: AirUse,
    /// Ripple, when the command is PWM and at least one period is over.
    pub ripple: Option<Ripple>,
}

/// Periods of PWM that are looked at.
const PERIODS: u64 = 5;
/// Points in each of them.
const POINTS: u64 = 400;
/// Samples in which extremes are looked for at least.
const LEAST_SAMPLES: f64 = 5000.0;

/// Collects what a fixed-step run shows on its way.
#[derive(Clone, Debug)]
pub struct Observer {
    first: Option<Sample>,
    last: Option<Sample>,
    extremes: Extremes,
    air: AirUse,
    window: Option<Window>,
    /// The sample interval of the run in s.
    interval: f64,
}

/// The last periods of a run under PWM.
#[derive(Clone, Debug)]
struct Window {
    start: f64,
    period: f64,
    /// For each period the integral of length and its time, and the range.
    periods: Vec<(f64, f64, Range)>,
}

impl Window {
    fn of(experiment: &Experiment) -> Option<Self> {
        let Command::Pwm { frequency, .. } = experiment.rig.actuation()?.command else { return None };
        let period = 1.0 / frequency;
        // A run of 50 periods may miss the fiftieth by a rounding.
        let whole = (experiment.run.duration / period * (1.0 + 1e-12)) as u64;
        let count = whole.min(PERIODS);
        let start = experiment.run.duration - count as f64 * period;
        (count > 0).then(|| Self { start, period, periods: vec![(0.0, 0.0, Range::NONE); count as usize] })
    }

    fn see(&mut self, time: f64, weight: f64, length: f64) {
        let index = ((time - self.start) / self.period).floor();
        if index < 0.0 {
            return;
        }
        let last = self.periods.len() - 1;
        let (integral, covered, range) = &mut self.periods[(index as usize).min(last)];
        *integral += weight * length;
        *covered += weight;
        range.see(length);
    }

    fn ripple(&self) -> Option<Ripple> {
        // Steps longer than a period leave some without a point: nothing can be said then.
        if self.periods.iter().any(|(_, covered, _)| *covered <= 0.0) {
            return None;
        }
        let means: Vec<f64> = self.periods.iter().map(|(integral, covered, _)| integral / covered).collect();
        let mut all = Range::NONE;
        for (.., range) in &self.periods {
            all.see(range.least);
            all.see(range.greatest);
        }
        let drift = match means.as_slice() {
            [.., before, last] => Some(last - before),
            _ => None,
        };
        Some(Ripple {
            periods: self.periods.len() as u64,
            mean: means.iter().sum::<f64>() / means.len() as f64,
            peak_to_peak: all.greatest - all.least,
            drift,
        })
    }
}

impl Observer {
    /// Begins to observe a run.
    pub fn new(experiment: &Experiment) -> Self {
        Self {
            first: None,
            last: None,
            extremes: Extremes::NONE,
            air: AirUse::default(),
            window: Window::of(experiment),
            interval: experiment.run.sample_interval,
        }
    }

    /// Sees the state after a step of the fixed-step engine, or the start.
    pub fn see(&mut self, sample: &Sample) {
        self.extremes.see(sample);
        self.first.get_or_insert(*sample);
        if let Some(before) = self.last.replace(*sample) {
            let air = |sample: &Sample| sample.air_mass + sample.hose_air_mass;
            let gain = air(sample) - air(&before);
            self.air.from_supply += gain.max(0.0);
            self.air.to_surroundings += (-gain).max(0.0);
            if let Some(window) = &mut self.window {
                let (weight, middle) = (sample.time - before.time, 0.5 * (sample.time + before.time));
                window.see(middle, weight, 0.5 * (sample.length + before.length));
            }
        }
    }

    /// The figures of the run.
    pub fn finish(mut self, outcome: &Outcome) -> Observation {
        if let Outcome::Located(trajectory) = outcome {
            self.look_over(trajectory);
        }
        // The engines show at least their start; the stand-in keeps this free of a panic.
        let nothing = || experiment_without_samples(outcome);
        let first = self.first.unwrap_or_else(nothing);
        let last = self.last.unwrap_or(first);
        let ripple = self.window.as_ref().and_then(Window::ripple);
        Observation { first, last, extremes: self.extremes, air: self.air, ripple }
    }

    /// Looks at a whole trajectory.
    fn look_over(&mut self, trajectory: &Trajectory) {
        trajectory.quadrature(|_, sample, _| self.extremes.see(sample));
        trajectory.valve_flows(|weight, flows| self.air.see(weight, flows));
        let end = trajectory.duration();
        let (first, last) = (trajectory.at(0.0), trajectory.at(end));
        let at_events = trajectory.events().iter().map(|event| trajectory.at(event.time));
        // A long step, as of a mass in free flight, may hold an extreme between two of its points; and no figure may
        // contradict the file.
        let interval = self.interval.min(end / LEAST_SAMPLES);
        at_events.chain(trajectory.samples(interval)).for_each(|sample| self.extremes.see(&sample));
        (self.first, self.last) = (Some(first), Some(last));
        if let Some(window) = &mut self.window {
            let points = window.periods.len() as u64 * POINTS;
            let step = (end - window.start) / points as f64;
            for point in 0..points {
                let time = window.start + (point as f64 + 0.5) * step;
                window.see(time, step, trajectory.at(time).length);
            }
        }
    }
}

/// The start of a run as a sample, for a run that showed none.
fn experiment_without_samples(outcome: &Outcome) -> Sample {
    match outcome {
        Outcome::Located(trajectory) => trajectory.at(0.0),
        Outcome::Stepped { experiment, .. } => {
            mckibben::simulation::FixedStepper::new(&experiment.rig, experiment.start, experiment.method()).sample()
        }
    }
}
