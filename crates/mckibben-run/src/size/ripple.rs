//! How fast a valve must be pulsed so that a muscle keeps still in the middle of its stroke.
//!
//! The duty is that at which the mean flow holds the load there. The ripple of the length is that of the linear model of
//! [`mckibben::linearize`] with the harmonics of the pulses. It falls with the frequency above the resonance of load and muscle, so
//! the least frequency is found from above.

use super::valve::fed;
use super::{Check, Requirement};
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

/// The keys of a start that was filled at a gauge pressure in Pa.
pub(super) fn start(gauge_pressure: f64) -> String {
    format!("[initial]\ngauge_pressure = \"{gauge_pressure} Pa\"\n")
}

/// The keys of pulses that fill and exhaust.
pub(super) fn command(frequency: f64, duty: f64) -> String {
    format!("[command]\nkind = \"pwm\"\nfrequency = \"{frequency} Hz\"\nduty = {duty}\n")
}

/// The muscle in the middle of its stroke under pulses of a frequency in Hz, with air that was filled in at a gauge pressure in Pa; none
/// where no duty holds the load there.
fn at(
    (scenario, valve): (&str, &str),
    requirement: &Requirement,
    frequency: f64,
    filled_at: f64,
) -> Result<Option<Linearization>, Failure> {
    let text = fed(scenario, requirement, [valve, &command(frequency, 0.5), &start(filled_at)]);
    // Of valves that follow set points there are no pulses.
    let Ok(experiment) = Document::parse(&text, "the candidate")?.experiment() else { return Ok(None) };
    let middle = experiment.rig.actuator().limits().max_length() - 0.5 * requirement.stroke;
    let aim = Aim::Balance(Balance::AtLength(middle));
    Ok(linearize_driven(&experiment.rig, aim, Content::Of(experiment.start)).ok())
}

/// The slowest pulses of a valve, by its keys, whose ripple of the length is no more than so many m; none where the valve is too slow
/// for such, or takes no pulses.
pub(super) fn pulses(
    scenario: &str,
    requirement: &Requirement,
    valve: &str,
    ripple: f64,
    check: &Check<'_>,
) -> Result<Option<Pulses>, Failure> {
    let [least, most] = FREQUENCIES;
    let mut frequencies = std::iter::successors(Some(most), |frequency| Some(STEP * frequency))
        .take_while(|frequency| *frequency > STEP * least);
    // The fastest pulses that the valve can make hold the load at a pressure, at which the muscle was filled.
    let mut fastest = None;
    for frequency in frequencies.by_ref() {
        check(0.0).map_err(|error| Failure::stopped(error.to_string()))?;
        if let Some(model) = at((scenario, valve), requirement, frequency, 0.5 * requirement.gauge_pressure)? {
            fastest = Some((frequency, model.point.gauge_pressure().0));
            break;
        }
    }
    let Some((mut high, gauge)) = fastest else { return Ok(None) };
    let of = |frequency: f64| -> Result<Option<Linearization>, Failure> {
        check(0.0).map_err(|error| Failure::stopped(error.to_string()))?;
        let model = at((scenario, valve), requirement, frequency, gauge)?;
        Ok(model.filter(|model| model.ripple("length").is_some_and(|swing| swing <= ripple)))
    };
    let Some(mut best) = of(high)? else { return Ok(None) };
    let mut low = None;
    for frequency in frequencies {
        match of(frequency)? {
            Some(model) => (high, best) = (frequency, model),
            None => {
                low = Some(frequency);
                break;
            }
        }
    }
    while let Some(below) = low.filter(|below| high / below > 1.0 + WITHIN) {
        let middle = (below * high).sqrt();
        match of(middle)? {
            Some(model) => (high, best) = (middle, model),
            None => low = Some(middle),
        }
    }
    Ok(best.averaged().map(|averaged| {
        let (duty, follows) = (averaged.duty, averaged.follows());
        Pulses { frequency: high, duty, gauge_pressure: gauge, follows }
    }))
}
