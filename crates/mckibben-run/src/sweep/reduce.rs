//! Reductions: a run as a few numbers, from its samples as they come.
//!
//! With samples `(tᵢ, xᵢ)` at t = 0, at every `run.sample_interval` and at the end T:
//!
//! | statistic | value |
//! |---|---|
//! | `final` | x at T |
//! | `mean` | `(1/T) ∫ x dt` by the trapezium rule |
//! | `min`, `max`, `peak` | the least, the greatest, the greatest magnitude |
//! | `ripple` | greatest less least over the last period of the PWM; over the last tenth of the run without PWM |
//! | `drift` | by how much the least or the greatest value of that interval differs from that of the interval before |
//! | `settling_time` | the first sample from which on `|x − x(T)| ≤ 2 % · |x(T) − x(0)|` |
//! | `overshoot` | how far x passes x(T) in the direction of `x(T) − x(0)`, as a share of that change |
//! | `used` | the air drawn from the supply |
//! | `rms`, `peak` of an error | of what a controller was to reach less what its sensors showed, at its sampling instants |
//!
//! What happens between two samples is not seen. `used` sums the gains of air mass between samples at which the flow path
//! to the supply is open at either end, as the fixed-step engine's steps keep the balance of the air; of an
//! event-located run it is the integral of the flow through that flow path instead.
//!
//! A reduction without a value (the overshoot of a quantity that ends where it began; a ripple over fewer than two
//! samples) has none: it is empty, never zero. Only `settling_time` keeps the samples of its quantity.
//!
//! Checked by the tests below against closed forms and by the program's `tests/sweep.rs` against files of `mckibben simulate`.

use crate::closed_loop::Goal;
use mckibben::control::{self, Held};
use mckibben::simulation::{JointRig, JointSample, Sample};
use mckibben::valve::Command;
use mckibben_scenario::Reduction;
use mckibben_scenario::sweep::{Quantity, Statistic};

/// The band of the settling time, as a share of the total change.
const SETTLED: f64 = 0.02;
/// The end of a run without PWM over which the ripple is taken, as a share of its duration.
pub(super) const LAST_PART: f64 = 0.1;
/// Two instants closer than this, relative to the run, are one.
const SIMULTANEOUS: f64 = 1e-9;

/// What is kept of a quantity.
#[derive(Clone, Debug)]
pub(super) struct Track<Q> {
    quantity: Q,
    first: f64,
    last: f64,
    least: f64,
    greatest: f64,
    /// `∫ x dt` so far.
    integral: f64,
    /// Least, greatest and number of the samples in the ripple's window and in the one before.
    windows: [(f64, f64, u64); 2],
    /// Every sample, where a settling time is asked for.
    series: Option<Vec<f64>>,
}

/// The reductions of one run under way.
#[derive(Clone, Debug)]
pub struct Reducer {
    tracks: Vec<Track<Quantity>>,
    /// The times of the samples, where a settling time is asked for.
    times: Option<Vec<f64>>,
    windows: Windows,
    before: Option<Before>,
    air_used: f64,
    goals: Vec<Goal>,
}

/// The interval over which ripples are taken, and the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Windows {
    start: f64,
    length: f64,
    /// Times closer than this are one.
    rounding: f64,
}

impl Windows {
    /// The last `length` s of a run of `duration` s, and as long before.
    pub(super) fn last(length: f64, duration: f64) -> Self {
        Self { start: duration - length, length, rounding: SIMULTANEOUS * duration }
    }

    /// Whether the last so many begin in the run.
    fn are_whole(self, count: u8) -> bool {
        self.start - f64::from(count - 1) * self.length > -self.rounding
    }

    /// The window of a time in s: 0 for the last, 1 for the one before.
    pub(super) fn of(self, time: f64) -> Option<usize> {
        if time >= self.start - self.rounding {
            Some(0)
        } else {
            (time >= self.start - self.length - self.rounding).then_some(1)
        }
    }
}

/// What is looked at: a sample of one actuator, or of a joint.
#[derive(Clone, Copy, Debug)]
pub enum Seen<'a> {
    /// Of one actuator, with the absolute pressure of its atmosphere in Pa.
    Actuator(&'a Sample, f64),
    /// Of a joint.
    Joint(&'a JointSample, &'a JointRig),
}

/// What is kept of the sample before.
#[derive(Clone, Copy, Debug)]
struct Before {
    time: f64,
    /// Whether each actuator's flow path to the supply is open, and the mass of its air in kg.
    air: [(bool, f64); 2],
}

impl Reducer {
    /// Begins a run of `duration` s whose valve has a command; of a joint, the agonist's.
    pub fn new(reductions: &[Reduction], command: Option<&Command>, duration: f64) -> Self {
        let period = match command {
            Some(Command::Pwm { frequency, .. }) => 1.0 / frequency,
            _ => LAST_PART * duration,
        };
        Self::with_windows(reductions, Windows::last(period, duration))
    }

    /// Begins a run with the windows of its ripples.
    fn with_windows(reductions: &[Reduction], windows: Windows) -> Self {
        let mut tracks: Vec<Track<Quantity>> = Vec::new();
        let of_samples = |of: &&Reduction| !matches!(of.quantity, Quantity::Air | Quantity::Error(_));
        for reduction in reductions.iter().filter(of_samples) {
            Track::add(&mut tracks, reduction.quantity, reduction.statistic);
        }
        let times = tracks.iter().any(|track| track.series.is_some()).then(Vec::new);
        Self { tracks, times, windows, before: None, air_used: 0.0, goals: Vec::new() }
    }

    /// Sees the next sample.
    pub fn see(&mut self, seen: Seen<'_>) {
        let Before { time, air } = seen.kept();
        for track in &mut self.tracks {
            let step = self.before.map(|before| time - before.time);
            track.see(seen.value(track.quantity), step, self.windows.of(time));
        }
        if let Some(times) = &mut self.times {
            times.push(time);
        }
        if let Some(before) = self.before.replace(Before { time, air }) {
            for ((was_open, was), (is_open, is)) in before.air.into_iter().zip(air) {
                if was_open || is_open {
                    self.air_used += (is - was).max(0.0);
                }
            }
        }
    }

    /// Replaces the air drawn from the supply by a better value in kg.
    pub fn set_air_used(&mut self, mass: f64) {
        self.air_used = mass;
    }

    /// Gives what a controller was to reach, with what was measured.
    pub fn set_goals(&mut self, goals: Vec<Goal>) {
        self.goals = goals;
    }

    /// The value of each reduction, where it has one.
    pub fn finish(&self, reductions: &[Reduction]) -> Vec<Option<f64>> {
        let duration = self.before.map_or(0.0, |last| last.time);
        let value = |reduction: &Reduction| {
            match reduction.quantity {
                Quantity::Air => return Some(self.air_used),
                Quantity::Error(of) => return self.missed(of, reduction.statistic),
                _ => {}
            }
            let track = self.tracks.iter().find(|track| track.quantity == reduction.quantity)?;
            track.reduced(reduction.statistic, self.times.as_deref(), (duration, self.windows))
        };
        reductions.iter().map(|reduction| value(reduction).filter(|value| value.is_finite())).collect()
    }

    /// How far a controller missed a quantity; none where it was not to reach it.
    fn missed(&self, of: control::Quantity, statistic: Statistic) -> Option<f64> {
        missed(self.goals.iter().filter(|goal| goal.quantity == of), statistic)
    }
}

/// How far goals were missed; none where there is none. Of a joint whose actuators are regulated one by one, both count.
pub(super) fn missed<'g>(goals: impl Iterator<Item = &'g Goal>, statistic: Statistic) -> Option<f64> {
    let misses: Vec<_> = goals.map(Goal::miss).collect();
    let squares: f64 = misses.iter().map(|miss| miss.rms * miss.rms).sum();
    let largest = misses.iter().map(|miss| miss.largest).reduce(f64::max)?;
    Some(if statistic == Statistic::Rms { (squares / misses.len() as f64).sqrt() } else { largest })
}

impl<Q: Copy + PartialEq> Track<Q> {
    /// Adds what a statistic of a quantity needs to tracks.
    pub(super) fn add(tracks: &mut Vec<Self>, quantity: Q, statistic: Statistic) {
        let settles = statistic == Statistic::SettlingTime;
        match tracks.iter_mut().find(|track| track.quantity == quantity) {
            Some(track) if settles => track.series = Some(Vec::new()),
            Some(_) => {}
            None => tracks.push(Self::new(quantity, settles)),
        }
    }

    /// The quantity.
    pub(super) fn quantity(&self) -> Q {
        self.quantity
    }

    /// Whether every sample is kept.
    pub(super) fn settles(&self) -> bool {
        self.series.is_some()
    }

    /// The value of a statistic over a run of `duration` s with its windows.
    pub(super) fn reduced(
        &self,
        statistic: Statistic,
        times: Option<&[f64]>,
        (duration, windows): (f64, Windows),
    ) -> Option<f64> {
        match statistic {
            Statistic::Ripple if !windows.are_whole(1) => None,
            Statistic::Drift if !windows.are_whole(2) => None,
            Statistic::SettlingTime => self.settling_time(times?),
            statistic => self.value(statistic, duration),
        }
    }

    fn new(quantity: Q, settles: bool) -> Self {
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        Self {
            quantity,
            first: 0.0,
            last: 0.0,
            least: nothing.0,
            greatest: nothing.1,
            integral: 0.0,
            windows: [(nothing.0, nothing.1, 0); 2],
            series: settles.then(Vec::new),
        }
    }

    /// Sees a value that comes a `step` in s after the one before.
    pub(super) fn see(&mut self, value: f64, step: Option<f64>, window: Option<usize>) {
        match step {
            None => self.first = value,
            Some(step) => self.integral += 0.5 * (self.last + value) * step,
        }
        self.last = value;
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
        if let Some(window) = window {
            let (least, greatest, count) = self.windows[window];
            self.windows[window] = (least.min(value), greatest.max(value), count + 1);
        }
        if let Some(series) = &mut self.series {
            series.push(value);
        }
    }

    fn value(&self, statistic: Statistic, duration: f64) -> Option<f64> {
        let change = self.last - self.first;
        match statistic {
            Statistic::Final => Some(self.last),
            Statistic::Mean => Some(self.integral / duration),
            Statistic::Min => Some(self.least),
            Statistic::Max => Some(self.greatest),
            Statistic::Peak => Some(self.greatest.abs().max(self.least.abs())),
            Statistic::Ripple => {
                let [(least, greatest, count), _] = self.windows;
                (count >= 2).then_some(greatest - least)
            }
            Statistic::Drift => {
                let [last, before] = self.windows;
                (last.2.min(before.2) >= 2).then(|| (last.0 - before.0).abs().max((last.1 - before.1).abs()))
            }
            Statistic::Overshoot if change > 0.0 => Some((self.greatest - self.last) / change),
            Statistic::Overshoot if change < 0.0 => Some((self.least - self.last) / change),
            Statistic::Overshoot | Statistic::SettlingTime | Statistic::Used | Statistic::Rms => None,
        }
    }

    fn settling_time(&self, times: &[f64]) -> Option<f64> {
        let series = self.series.as_ref()?;
        let band = SETTLED * (self.last - self.first).abs();
        let outside = series.iter().rposition(|value| (value - self.last).abs() > band);
        times.get(outside.map_or(0, |index| index + 1)).copied()
    }
}

impl Seen<'_> {
    fn kept(self) -> Before {
        let air = |of: &Sample| (of.ports.supply, of.air_mass + of.hose_air_mass);
        match self {
            Self::Actuator(sample, _) => Before { time: sample.time, air: [air(sample), (false, 0.0)] },
            Self::Joint(sample, _) => Before { time: sample.time, air: sample.actuators.each_ref().map(air) },
        }
    }

    /// The value of a quantity; of what both a joint and an actuator have, that of the joint's agonist.
    fn value(self, quantity: Quantity) -> f64 {
        match self {
            Self::Actuator(sample, atmosphere) => of(quantity, sample, atmosphere),
            Self::Joint(sample, rig) => {
                let [agonist, antagonist] = &sample.actuators;
                let atmosphere = rig.driven()[0].actuator.air().atmosphere().0;
                match quantity {
                    Quantity::Angle => sample.angle,
                    Quantity::AngularVelocity => sample.angular_velocity,
                    Quantity::Torque => sample.torque,
                    Quantity::Stiffness => {
                        rig.stiffness(sample.angle, [agonist.pressure, antagonist.pressure], Held::AirMasses)
                    }
                    Quantity::AntagonistLength => antagonist.length,
                    Quantity::AntagonistAbsolutePressure => antagonist.pressure.0,
                    Quantity::AntagonistGaugePressure => antagonist.pressure.0 - atmosphere,
                    Quantity::AntagonistAirMass => antagonist.air_mass,
                    Quantity::AntagonistTension => antagonist.tension,
                    quantity => of(quantity, agonist, atmosphere),
                }
            }
        }
    }
}

/// The value of a quantity of one actuator.
fn of(quantity: Quantity, sample: &Sample, atmosphere: f64) -> f64 {
    match quantity {
        Quantity::Length => sample.length,
        Quantity::Velocity => sample.velocity,
        Quantity::AbsolutePressure => sample.pressure.0,
        Quantity::GaugePressure => sample.pressure.0 - atmosphere,
        Quantity::AirMass | Quantity::Air => sample.air_mass,
        Quantity::Temperature => sample.temperature,
        Quantity::Tension => sample.tension,
        Quantity::MassFlow => sample.mass_flow,
        // What a joint alone has, and an error, are none of the sample's: the reading of a sweep has refused them.
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mckibben::AbsolutePressure;
    use mckibben::valve::Ports;
    use std::f64::consts::PI;

    /// The reductions of a length over `duration` s in samples of 1 ms, with the air's mass and the open ports beside it.
    fn reduced(
        names: &[(Quantity, Statistic)],
        (duration, window): (f64, f64),
        length: impl Fn(f64) -> f64,
        air: impl Fn(f64) -> (f64, Ports),
    ) -> Vec<Option<f64>> {
        let reductions: Vec<Reduction> = names
            .iter()
            .map(|(quantity, statistic)| Reduction { quantity: *quantity, statistic: *statistic })
            .collect();
        let mut reducer = Reducer::with_windows(&reductions, Windows::last(window, duration));
        for index in 0..=(duration * 1e3).round() as u32 {
            let time = f64::from(index) * 1e-3;
            let (air_mass, ports) = air(time);
            let sample = Sample {
                time,
                length: length(time),
                velocity: 0.0,
                pressure: AbsolutePressure(1e5),
                air_mass,
                temperature: 293.15,
                volume: 1e-6,
                tension: 10.0,
                mass_flow: 0.0,
                ports,
                hose_pressure: AbsolutePressure(1e5),
                hose_air_mass: 0.0,
                supply_pressure: None,
                load_distance: length(time),
                load_velocity: 0.0,
            };
            reducer.see(Seen::Actuator(&sample, 101_325.0));
        }
        reducer.finish(&reductions)
    }

    fn sealed(_: f64) -> (f64, Ports) {
        (1e-5, Ports::CLOSED)
    }

    fn near(found: Option<f64>, expected: f64, within: f64) {
        assert!(found.is_some_and(|found| (found - expected).abs() <= within), "{found:?} for {expected}");
    }

    #[test]
    fn a_rise_to_a_level_settles_when_its_exponential_says() {
        use Statistic::{Final, Max, Mean, Min, Overshoot, Peak, SettlingTime};
        let statistics = [Final, Mean, Min, Max, Peak, SettlingTime, Overshoot].map(|s| (Quantity::Length, s));
        let values = reduced(&statistics, (1.0, 0.1), |t| 0.1 - 0.04 * (1.0 - (-t / 0.05).exp()), sealed);
        near(values[0], 0.06, 1e-9);
        near(values[1], 0.06 + 0.04 * 0.05, 1e-6);
        near(values[2], 0.06, 1e-9);
        near(values[3], 0.1, 0.0);
        near(values[4], 0.1, 0.0);
        // ln 50 time constants, to the next sample.
        near(values[5], 0.05 * 50f64.ln() + 0.5e-3, 0.5e-3);
        near(values[6], 0.0, 1e-9);
    }

    #[test]
    fn the_overshoot_is_that_of_the_damping_and_the_ripple_that_of_the_period() {
        let (damping, frequency) = (0.2_f64, 60.0);
        let damped = (1.0 - damping * damping).sqrt();
        let step = |t: f64| {
            let phase = damped * frequency * t;
            let decay = (-damping * frequency * t).exp();
            0.08 + 0.01 * (1.0 - decay * (phase.cos() + damping / damped * phase.sin()))
        };
        let values = reduced(&[(Quantity::Length, Statistic::Overshoot)], (2.0, 0.1), step, sealed);
        near(values[0], (-PI * damping / damped).exp(), 2e-4);
        let ripple = [(Quantity::Length, Statistic::Ripple)];
        let wave = |t: f64| if t < 0.5 { 0.2 } else { 0.08 + 0.003 * (2.0 * PI * 25.0 * t).sin() };
        near(reduced(&ripple, (1.0, 0.04), wave, sealed)[0], 0.006, 1e-9);
        let drift =
            |wave: &dyn Fn(f64) -> f64| reduced(&[(Quantity::Length, Statistic::Drift)], (1.0, 0.04), wave, sealed)[0];
        near(drift(&wave), 0.0, 1e-9);
        // A mean that moves by 2 m/s moves the ends of a period of 40 ms by 80 mm.
        near(drift(&|t| wave(t) + 2.0 * t), 0.08, 3e-3);
        // A period longer than the run, or than two samples can show, has no ripple.
        assert_eq!(reduced(&ripple, (1.0, 1.5), wave, sealed), [None]);
        assert_eq!(reduced(&ripple, (1.0, 0.5e-3), wave, sealed), [None]);
    }

    #[test]
    fn what_ends_where_it_began_has_no_overshoot() {
        let statistics = [Statistic::Overshoot, Statistic::SettlingTime].map(|s| (Quantity::Length, s));
        assert_eq!(reduced(&statistics, (0.1, 0.01), |_| 0.09, sealed), [None, Some(0.0)]);
    }

    #[test]
    fn air_counts_while_the_supply_is_open() {
        // Ten periods of 40 ms: 20 ms of filling by 1 µg each ms, then 20 ms of emptying.
        let pulse = |t: f64| {
            let place = (t * 1e3).round() as u32 % 40;
            let filling = place < 20;
            let gain = if filling { place } else { 40 - place };
            (1e-5 + 1e-9 * f64::from(gain), Ports { supply: filling, exhaust: !filling })
        };
        let used = [(Quantity::Air, Statistic::Used)];
        near(reduced(&used, (0.4, 0.04), |_| 0.09, pulse)[0], 200e-9, 1e-15);
        // Air that comes in from the surroundings is not drawn from the supply.
        let drawn = |t: f64| (1e-5 + 1e-6 * t, Ports { supply: false, exhaust: true });
        assert_eq!(reduced(&used, (0.4, 0.04), |_| 0.09, drawn), [Some(0.0)]);
    }
}
