//! The figures of a run: extremes, the last periods under PWM, the air through each port.
//!
//! A run is evaluated in five points of every step, at both ends of the step, at every sample, and where a quantity turns at an
//! extreme, as it is made: nothing of it is kept.

use crate::warnings::Reached;
use mckibben::Actuator;
use mckibben::air::Flow;
use mckibben::engine::Statistics;
use mckibben::plant::{PlantLedger, PlantView, RigPlant, ViewStep};
use mckibben::simulation::{EventKind, Readable, Reading, Rig, Sample, SampleTimes};
use mckibben::valve::Command;
use mckibben_scenario::Run;
use std::collections::BTreeMap;

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
        // What is no number stays, to be found: the least and the greatest of two would pass over it.
        if value.is_nan() || self.least.is_nan() {
            *self = Self { least: f64::NAN, greatest: f64::NAN };
            return;
        }
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
    /// The quantities of a sample, in the order of the fields.
    fn values(of: &Sample) -> [f64; 5] {
        [of.length, of.velocity, of.tension, of.pressure.0, of.temperature]
    }
}

/// Extremes of quantities over the steps of a run. A quantity may be extreme just before an event, where it jumps, and between two of
/// the points at which a step is read: there the parabola through three of them says where.
#[derive(Clone, Debug)]
pub(crate) struct Peaks<V> {
    ranges: Vec<Range>,
    /// Times in s and values within the step that is being seen.
    points: Vec<(f64, V)>,
}

impl<V: AsRef<[f64]>> Peaks<V> {
    /// Of so many quantities.
    pub(crate) fn new(count: usize) -> Self {
        Self { ranges: vec![Range::NONE; count], points: Vec::new() }
    }

    /// Takes the values at a time in s within a step.
    pub(crate) fn see(&mut self, time: f64, values: V) {
        self.widen(&values);
        self.points.push((time, values));
    }

    /// Takes values whose time does not matter.
    pub(crate) fn widen(&mut self, values: &V) {
        self.ranges.iter_mut().zip(values.as_ref()).for_each(|(range, value)| range.see(*value));
    }

    /// Ends a step: reads it where quantities turn about what is an extreme so far, and again there, since a parabola through points far
    /// apart turns beside them.
    pub(crate) fn turn(&mut self, mut read: impl FnMut(f64) -> V) {
        for _ in 0..TURNS {
            let times = self.turns();
            if times.is_empty() {
                break;
            }
            times.into_iter().for_each(|time| self.see(time, read(time)));
        }
        self.points.clear();
    }

    /// The times in s, other than those seen, at which quantities turn about what is an extreme so far.
    fn turns(&mut self) -> Vec<f64> {
        let Self { ranges, points } = self;
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        points.dedup_by(|one, other| one.0 == other.0);
        let mut times: Vec<f64> = Vec::new();
        for three in points.windows(3) {
            let [before, at, after] = three else { continue };
            let values = before.1.as_ref().iter().zip(at.1.as_ref()).zip(after.1.as_ref());
            for (range, ((before_it, it), after_it)) in ranges.iter().zip(values) {
                let (left, right) = (it - before_it, it - after_it);
                if left * right > 0.0 && (*it == range.least || *it == range.greatest) {
                    let (back, forth) = (at.0 - before.0, after.0 - at.0);
                    let from_middle = (forth * forth * left - back * back * right) / (forth * left + back * right);
                    if from_middle.abs() > NEAR * (after.0 - before.0) {
                        times.push(at.0 + 0.5 * from_middle);
                    }
                }
            }
        }
        times
    }

    /// The extremes, in the order of the values.
    pub(crate) fn ranges(&self) -> &[Range] {
        &self.ranges
    }
}

/// The times in s of the samples of a run, with as many between them as make at least `least` in all: a long step, as of a mass in
/// free flight, may hold an extreme between two of its points, and no figure may contradict the file.
pub(crate) fn dense_times(plan: &Run, least: f64) -> Times {
    let times = SampleTimes::new(plan.duration, plan.sample_interval).steps(plan.duration / least);
    Box::new(std::iter::once(0.0).chain(times.map(|(time, _)| time)))
}

/// Air in kg through the ports of the valve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirUse {
    /// In from the supply.
    pub from_supply: f64,
    /// Back into the supply, as with a vacuum.
    pub to_supply: f64,
    /// In from the atmosphere.
    pub from_atmosphere: f64,
    /// Out to the atmosphere.
    pub to_atmosphere: f64,
}

impl AirUse {
    /// Adds the flows to the supply and to the atmosphere at a point of a quadrature with its weight in s.
    pub fn see(&mut self, weight: f64, [supply, atmosphere]: [Flow; 2]) {
        self.from_supply += weight * supply.inward;
        self.to_supply += weight * supply.outward;
        self.from_atmosphere += weight * atmosphere.inward;
        self.to_atmosphere += weight * atmosphere.outward;
    }
}

/// The length over the last whole periods of PWM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// How many periods were looked at.
    pub periods: u64,
    /// The mean length in m of the last period.
    pub mean: f64,
    /// The greatest minus the least length in m in the last period.
    pub peak_to_peak: f64,
    /// The greatest minus the least length in m over all periods that were looked at.
    pub travel: f64,
    /// The mean length of the last period minus that of the one before, in m.
    pub drift: Option<f64>,
    /// Whether the periods are alike, so that mean and ripple are those of a settled run.
    pub settled: bool,
}

impl Ripple {
    /// Whether it is more than rounding.
    pub fn is_seen(&self) -> bool {
        self.peak_to_peak > ROUNDING * self.mean.abs()
    }
}

/// What is known of a run once it has come to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Steps, evaluations and events.
    pub counts: Statistics,
    /// Where the work of the gas and the exergy of the supply's air went.
    pub ledger: PlantLedger,
    /// Whether there is a valve, through which air is drawn.
    pub draws: bool,
    /// The fixed steps, where it took such.
    pub steps: Option<Steps>,
}

/// The fixed steps of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// The longest step in s.
    pub step: f64,
    /// When it was chosen for an accuracy: the time in s that was compared, and the greatest error.
    pub chosen: Option<[f64; 2]>,
    /// How many there were.
    pub steps: u64,
}

/// Observes a run of what a plant is on its way.
pub(crate) trait Observes<V: PlantView> {
    /// What it comes to.
    type Observation: Clone;

    /// Begins to observe.
    fn new(rig: &V::Rig, plan: &Run) -> Self;

    /// Observes an accepted step.
    fn step(&mut self, step: &ViewStep<'_, V>);

    /// The figures of a run that has come to its end, with the last sample.
    fn finish(self, last: V::Sample, ended: Ended) -> Self::Observation;
}

/// Everything that is observed.
#[derive(Clone, Debug, PartialEq)]
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
    /// How many events of each kind there were.
    pub events: BTreeMap<EventKind, u64>,
    /// What the actuator reached, for the warnings.
    pub(crate) reached: [Reached; 1],
    /// Steps and ledger.
    pub ended: Ended,
}

/// Periods of PWM that are looked at.
const PERIODS: u64 = 5;
/// Periods are alike whose means and ends differ by less than this part of the ripple.
const ALIKE: f64 = 0.02;
/// A part of a length that is no ripple.
const ROUNDING: f64 = 1e-7;
/// Points in each of them.
const POINTS: u64 = 400;
/// Samples in which extremes are looked for at least.
const LEAST_SAMPLES: f64 = 5000.0;

/// How often an extreme within a step is looked for between the points next to the last one, at most.
const TURNS: usize = 6;
/// Part of the time between these points by which it is found: its value then is to some millionths of how much that falls off there.
const NEAR: f64 = 1e-3;

/// Times at which a run is read.
pub(crate) type Times = Box<dyn Iterator<Item = f64> + Send>;

/// Observes a run on its way.
pub struct Observer {
    first: Option<Sample>,
    peaks: Peaks<[f64; 5]>,
    air: AirUse,
    window: Option<Window>,
    events: BTreeMap<EventKind, u64>,
    actuator: Actuator,
    reached: Reached,
    samples: Reading<Times>,
    points: Reading<Times>,
}

/// The last periods of a run under PWM.
#[derive(Clone, Debug)]
struct Window {
    start: f64,
    end: f64,
    period: f64,
    /// For each period the integral of length and its time, and the range.
    periods: Vec<(f64, f64, Range)>,
}

impl Window {
    fn of(rig: &Rig, plan: &Run) -> Option<Self> {
        let Command::Pwm { frequency, .. } = rig.actuation()?.command else { return None };
        let period = 1.0 / frequency;
        // A run of 50 periods may miss the fiftieth by a rounding.
        let whole = (plan.duration / period * (1.0 + 1e-12)) as u64;
        let count = whole.min(PERIODS);
        let start = plan.duration - count as f64 * period;
        let end = plan.duration;
        (count > 0).then(|| Self { start, end, period, periods: vec![(0.0, 0.0, Range::NONE); count as usize] })
    }

    /// The time in s between two of the points at which a run is read.
    fn step(&self) -> f64 {
        (self.end - self.start) / (self.periods.len() as u64 * POINTS) as f64
    }

    /// The times in s of those points.
    fn points(&self) -> impl Iterator<Item = f64> + use<> {
        let (start, step) = (self.start, self.step());
        (0..self.periods.len() as u64 * POINTS).map(move |point| start + (point as f64 + 0.5) * step)
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
        let mean = |(integral, covered, _): &(f64, f64, Range)| integral / covered;
        let mut all = Range::NONE;
        for (.., range) in &self.periods {
            all.see(range.least);
            all.see(range.greatest);
        }
        let last = self.periods.last()?;
        let peak_to_peak = last.2.greatest - last.2.least;
        let near = (ALIKE * peak_to_peak).max(ROUNDING * mean(last).abs());
        let is_like_the_last = |of: &(f64, f64, Range)| {
            let ends = [(mean(of), mean(last)), (of.2.least, last.2.least), (of.2.greatest, last.2.greatest)];
            ends.into_iter().all(|(one, other)| (one - other).abs() <= near)
        };
        let drift = match self.periods.as_slice() {
            [.., before, last] => Some(mean(last) - mean(before)),
            _ => None,
        };
        Some(Ripple {
            periods: self.periods.len() as u64,
            mean: mean(last),
            peak_to_peak,
            travel: all.greatest - all.least,
            drift,
            settled: self.periods.len() as u64 == PERIODS && self.periods.iter().all(is_like_the_last),
        })
    }
}

impl Observes<RigPlant> for Observer {
    type Observation = Observation;

    fn new(rig: &Rig, plan: &Run) -> Self {
        let (window, end) = (Window::of(rig, plan), plan.duration);
        let points: Times = match &window {
            Some(window) => Box::new(window.points()),
            None => Box::new(std::iter::empty()),
        };
        Self {
            first: None,
            peaks: Peaks::new(5),
            air: AirUse::default(),
            window,
            events: BTreeMap::new(),
            actuator: rig.actuator().clone(),
            reached: Reached::NONE,
            samples: Reading::new(dense_times(plan, LEAST_SAMPLES), end),
            points: Reading::new(points, end),
        }
    }

    fn step(&mut self, step: &ViewStep<'_, RigPlant>) {
        let Self { first, peaks, air, window, events, actuator, reached, samples, points } = self;
        let mut see = |time, sample: &Sample| {
            peaks.see(time, Extremes::values(sample));
            reached.see(actuator, sample);
        };
        step.quadrature(|weight, sample, flows| {
            see(sample.time, sample);
            air.see(weight, flows);
        });
        let Ok(()) = samples.step(step, |sample| {
            first.get_or_insert(*sample);
            see(sample.time, sample);
            Ok::<_, std::convert::Infallible>(())
        });
        // What is passed within an instant has no place in the run.
        if step.holds(step.start()) {
            [step.start(), step.end()].into_iter().for_each(|time| see(time, &step.at(time)));
        }
        peaks.turn(|time| {
            let sample = step.at(time);
            reached.see(actuator, &sample);
            Extremes::values(&sample)
        });
        let Ok(()) = points.step(step, |sample| {
            if let Some(window) = window {
                let weight = window.step();
                window.see(sample.time, weight, sample.length);
            }
            Ok::<_, std::convert::Infallible>(())
        });
        if let Some(happened) = step.event() {
            *events.entry(happened.kind).or_insert(0) += 1;
        }
    }

    fn finish(mut self, last: Sample, ended: Ended) -> Observation {
        self.peaks.widen(&Extremes::values(&last));
        self.reached.see(&self.actuator, &last);
        let ripple = self.window.as_ref().and_then(Window::ripple);
        let Self { first, peaks, air, events, reached, .. } = self;
        let of = |index: usize| peaks.ranges()[index];
        let [length, velocity, tension, pressure, temperature] = [0, 1, 2, 3, 4].map(of);
        let extremes = Extremes { length, velocity, tension, pressure, temperature };
        Observation { first: first.unwrap_or(last), last, extremes, air, ripple, events, reached: [reached], ended }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_what_is_no_number_is_none() {
        let mut range = Range::NONE;
        [1.0, f64::NAN, 2.0].into_iter().for_each(|value| range.see(value));
        assert!(range.least.is_nan() && range.greatest.is_nan());
    }

    /// Extremes are read where they are, whatever the distances of the points; what only rises has no turn, nor has what turns below an
    /// extreme that was seen before.
    #[test]
    fn peaks_are_read_where_they_are() {
        let of = |time: f64| [3.0 - (time - 0.37).powi(2), time];
        let mut peaks = Peaks::new(2);
        [0.0, 0.5, 0.2, 1.0].into_iter().for_each(|time| peaks.see(time, of(time)));
        let mut read = Vec::new();
        peaks.turn(|time| {
            read.push(time);
            of(time)
        });
        assert!((read[0] - 0.37).abs() < 1e-12 && read.len() == 1, "{read:?}");
        assert!((peaks.ranges()[0].greatest - 3.0).abs() < 1e-12 && peaks.ranges()[1].greatest == 1.0);
        [0.0, 0.2, 0.6].into_iter().for_each(|time| peaks.see(time, of(time)));
        peaks.turn(|time| panic!("what turns below is read at {time}"));
    }

    /// A pulse that decays turns beside the parabola through points far apart: at 1 it is 1.
    #[test]
    fn a_skew_peak_is_found() {
        let of = |time: f64| [time * (1.0 - time).exp()];
        let mut peaks = Peaks::new(1);
        [0.0, 0.75, 1.5, 2.25, 3.0].into_iter().for_each(|time| peaks.see(time, of(time)));
        peaks.turn(of);
        assert!((peaks.ranges()[0].greatest - 1.0).abs() < 1e-6, "{:?}", peaks.ranges());
    }
}
