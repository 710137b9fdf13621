//! How fast a valve must be pulsed so that a muscle keeps still in the middle of its stroke.
//!
//! The duty is that at which the mean flow holds the load there. The ripple of the length is that of the linear model of
//! [`mckibben::linearize`] with the harmonics of the pulses. It falls with the frequency above the resonance of load and muscle, so
//! the least frequency is found from above.

use super::Requirement;
use super::valve::{fed, valve_of};
use crate::failure::Failure;
use mckibben::linearize::{Aim, Balance, Content, Linearization, linearize_driven};
use mckibben_scenario::Document;

/// Frequencies in Hz between which the least is looked for, and by how much each is less than the one before.
const FREQUENCIES: [f64; 2] = [0.5, 1000.0];
const STEP: f64 = 0.8;
/// To which part a frequency is found.
const WITHIN: f64 = 1e-3;

/// Pulses that keep a muscle still.
#[derive(Clone, Debug, PartialEq)]
pub struct Pulses {
    /// The least frequency in Hz.
    pub frequency: f64,
    /// The duty that holds the load in the middle of the stroke.
    pub duty: f64,
    /// Gauge pressure in Pa there.
    pub gauge_pressure: f64,
    /// Whether each pulse and each pause is long enough to move the valve.
    pub follows: bool,
}

/// The keys of pulses that fill and exhaust.
pub(super) fn command(frequency: f64, duty: f64) -> String {
    format!("[command]\nkind = \"pwm\"\nfrequency = \"{frequency} Hz\"\nduty = {duty}\n")
}

/// The muscle in the middle of its stroke under pulses of a frequency in Hz; none where no duty holds the load there.
fn at(
    scenario: &str,
    requirement: &Requirement,
    valve: &str,
    frequency: f64,
) -> Result<Option<Linearization>, Failure> {
    let text = fed(scenario, requirement, [valve, &command(frequency, 0.5), ""]);
    // A muscle that does not hang unfilled has no start; of valves that follow set points there are no pulses.
    let Ok(experiment) = Document::parse(&text, "the candidate")?.experiment() else { return Ok(None) };
    let middle = experiment.rig.actuator().limits().max_length() - 0.5 * requirement.stroke;
    let aim = Aim::Balance(Balance::AtLength(middle));
    Ok(linearize_driven(&experiment.rig, aim, Content::Of(experiment.start)).ok())
}

/// The slowest pulses of a valve, by its keys, whose ripple of the length is no more than so many m; none where there are no such.
pub(super) fn pulses(
    scenario: &str,
    requirement: &Requirement,
    valve: &str,
    ripple: f64,
) -> Result<Option<Pulses>, Failure> {
    let of = |frequency: f64| -> Result<Option<(f64, Linearization)>, Failure> {
        let model = at(scenario, requirement, valve, frequency)?;
        Ok(model.and_then(|model| Some((model.ripple("length")?, model))))
    };
    let is_still = |found: &Option<(f64, Linearization)>| found.as_ref().is_some_and(|(swing, _)| *swing <= ripple);
    let [least, mut high] = FREQUENCIES;
    let mut best = of(high)?;
    if !is_still(&best) {
        return Ok(None);
    }
    let mut low = high;
    while low > least {
        low *= STEP;
        let found = of(low)?;
        if !is_still(&found) {
            break;
        }
        (high, best) = (low, found);
    }
    while high / low > 1.0 + WITHIN {
        let middle = (low * high).sqrt();
        let found = of(middle)?;
        if is_still(&found) { (high, best) = (middle, found) } else { low = middle }
    }
    Ok(best.and_then(|(_, model)| {
        let averaged = model.averaged()?;
        let (duty, follows) = (averaged.duty, averaged.follows());
        Some(Pulses { frequency: high, duty, gauge_pressure: model.point.gauge_pressure().0, follows })
    }))
}

/// The pulses of a valve by its sonic conductance in m³/(s·Pa).
pub(super) fn of_conductance(
    scenario: &str,
    requirement: &Requirement,
    conductance: f64,
    ripple: f64,
) -> Result<Option<Pulses>, Failure> {
    pulses(scenario, requirement, &valve_of(conductance), ripple)
}
