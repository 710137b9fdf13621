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
//! | `used` | the air that came in through valves and where a pressure is given, by the ledger of the run |
//! | `efficiency` of the exergy | the work on the load over the exergy that was supplied, by the ledger of the run |
//! | `rms`, `peak` of an error | of what a controller was to reach less what its sensors showed, at its sampling instants |
//!
//! What happens between two samples is not seen, but for what the ledger has.
//!
//! A reduction without a value (the overshoot of a quantity that ends where it began; a ripple over fewer than two
//! samples) has none: it is empty, never zero. Only `settling_time` keeps the samples of its quantity.
//!
//! Over the orbit (`sweep.over`) the run goes on behind T until its states return after a period. `final`, `mean`, `min`, `max`,
//! `peak`, `ripple` and `drift` are then of two periods there, and empty where the run does not settle; the others say something of
//! the way there and stay those of the run. There `mean` integrates over each step of the engine, so that what jumps at an event, as a
//! mass flow does, has no part in its error, and extremes have the values on both sides of events.
//!
//! Checked by the tests below against closed forms and by the program's `tests/sweep.rs` against files of `mckibben simulate`.

use super::series::{LAST_PART, Series, Windows};
use crate::closed_loop::Goal;
use mckibben::control::{self, Held};
use mckibben::simulation::{JointRig, JointSample, Sample};
use mckibben::valve::Command;
use mckibben_scenario::Reduction;
use mckibben_scenario::sweep::{Quantity, Statistic};

/// The reductions of one run under way.
#[derive(Clone, Debug)]
pub struct Reducer {
    series: Series<Quantity>,
    /// In kg, where a ledger was kept.
    air_used: Option<f64>,
    efficiency: Option<f64>,
    goals: Vec<Goal>,
}

/// What is looked at: a sample of one actuator, or of a joint.
#[derive(Clone, Copy, Debug)]
pub enum Seen<'a> {
    /// Of one actuator, with the absolute pressure of its atmosphere in Pa.
    Actuator(&'a Sample, f64),
    /// Of a joint.
    Joint(&'a JointSample, &'a JointRig),
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
        let of_samples =
            |of: &&Reduction| !matches!(of.quantity, Quantity::Air | Quantity::Exergy | Quantity::Error(_));
        let of = reductions.iter().filter(of_samples).map(|of| (of.quantity, of.statistic));
        Self { series: Series::new(of, windows), air_used: None, efficiency: None, goals: Vec::new() }
    }

    /// Sees the next sample.
    pub fn see(&mut self, seen: Seen<'_>) {
        self.series.see(seen.time(), |quantity| seen.value(quantity));
    }

    /// What comes is of the orbit, over whose last two periods the windows lie; without them there is none.
    pub(super) fn turn_to_orbit(&mut self, windows: Option<Windows>) {
        self.series.turn_to_orbit(windows);
    }

    /// Sees a sample of the orbit, in a window of ripples as of [`Windows::of`], with its weight in s in integrals.
    pub(super) fn see_orbit(&mut self, seen: Seen<'_>, window: usize, weight: f64) {
        self.series.see_orbit((seen.time(), window, weight), |quantity| seen.value(quantity));
    }

    /// Gives the air in kg that was used.
    pub fn set_air_used(&mut self, mass: Option<f64>) {
        self.air_used = mass;
    }

    /// Gives the work on the load over the exergy that was supplied.
    pub fn set_efficiency(&mut self, efficiency: Option<f64>) {
        self.efficiency = efficiency;
    }

    /// Gives what a controller was to reach, with what was measured.
    pub fn set_goals(&mut self, goals: Vec<Goal>) {
        self.goals = goals;
    }

    /// The value of each reduction, where it has one.
    pub fn finish(&self, reductions: &[Reduction]) -> Vec<Option<f64>> {
        let value = |reduction: &Reduction| match reduction.quantity {
            Quantity::Air => self.air_used,
            Quantity::Exergy => self.efficiency,
            Quantity::Error(of) => self.missed(of, reduction.statistic),
            quantity => self.series.reduced(quantity, reduction.statistic),
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

impl Seen<'_> {
    fn time(self) -> f64 {
        match self {
            Self::Actuator(sample, _) => sample.time,
            Self::Joint(sample, _) => sample.time,
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

    /// The reductions of a length over `duration` s in samples of 1 ms.
    fn reduced(
        names: &[(Quantity, Statistic)],
        (duration, window): (f64, f64),
        length: impl Fn(f64) -> f64,
    ) -> Vec<Option<f64>> {
        let reductions: Vec<Reduction> = names
            .iter()
            .map(|(quantity, statistic)| Reduction { quantity: *quantity, statistic: *statistic })
            .collect();
        let mut reducer = Reducer::with_windows(&reductions, Windows::last(window, duration));
        for index in 0..=(duration * 1e3).round() as u32 {
            let time = f64::from(index) * 1e-3;
            let sample = Sample {
                time,
                length: length(time),
                velocity: 0.0,
                pressure: AbsolutePressure(1e5),
                air_mass: 1e-5,
                temperature: 293.15,
                volume: 1e-6,
                tension: 10.0,
                mass_flow: 0.0,
                ports: Ports { supply: false, exhaust: true },
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

    fn near(found: Option<f64>, expected: f64, within: f64) {
        assert!(found.is_some_and(|found| (found - expected).abs() <= within), "{found:?} for {expected}");
    }

    #[test]
    fn a_rise_to_a_level_settles_when_its_exponential_says() {
        use Statistic::{Final, Max, Mean, Min, Overshoot, Peak, SettlingTime};
        let statistics = [Final, Mean, Min, Max, Peak, SettlingTime, Overshoot].map(|s| (Quantity::Length, s));
        let values = reduced(&statistics, (1.0, 0.1), |t| 0.1 - 0.04 * (1.0 - (-t / 0.05).exp()));
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
        let values = reduced(&[(Quantity::Length, Statistic::Overshoot)], (2.0, 0.1), step);
        near(values[0], (-PI * damping / damped).exp(), 2e-4);
        let ripple = [(Quantity::Length, Statistic::Ripple)];
        let wave = |t: f64| if t < 0.5 { 0.2 } else { 0.08 + 0.003 * (2.0 * PI * 25.0 * t).sin() };
        near(reduced(&ripple, (1.0, 0.04), wave)[0], 0.006, 1e-9);
        let drift = |wave: &dyn Fn(f64) -> f64| reduced(&[(Quantity::Length, Statistic::Drift)], (1.0, 0.04), wave)[0];
        near(drift(&wave), 0.0, 1e-9);
        // A mean that moves by 2 m/s moves the ends of a period of 40 ms by 80 mm.
        near(drift(&|t| wave(t) + 2.0 * t), 0.08, 3e-3);
        // A period longer than the run, or than two samples can show, has no ripple.
        assert_eq!(reduced(&ripple, (1.0, 1.5), wave), [None]);
        assert_eq!(reduced(&ripple, (1.0, 0.5e-3), wave), [None]);
    }

    #[test]
    fn what_ends_where_it_began_has_no_overshoot() {
        let statistics = [Statistic::Overshoot, Statistic::SettlingTime].map(|s| (Quantity::Length, s));
        assert_eq!(reduced(&statistics, (0.1, 0.01), |_| 0.09), [None, Some(0.0)]);
    }
}
