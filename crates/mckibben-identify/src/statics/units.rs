//! Whether a force map is that of the muscle in other units than it says.
//!
//! A braid of known geometry pulls `P_g (3L² − b²)/(4πn²)` or somewhat less. When measured over ideal force is far
//! from that, and a unit that labs confuse brings it back, it is the likelier explanation. A fit would hide it: its
//! turns take up any factor.

use super::effectiveness::ratios;
use super::{ForceMap, Point};
use crate::median::median;
use mckibben::Error;
use mckibben_scenario::{Force, Scenario};

/// Median of measured over ideal force of muscles as they are: outside it something is wrong.
const USUAL: [f64; 2] = [0.4, 1.7];
/// That median where a unit has been put right: within it the correction convinces.
const CONVINCING: [f64; 2] = [0.6, 1.4];

/// Units that are taken for another, and the factor by which the true value is the larger.
const CONFUSED: [(What, &str, &str, f64); 16] = [
    (What::Pressure, "psi", "bar", 0.068_947_572_931_683_6),
    (What::Pressure, "bar", "psi", 14.503_773_773_020_92),
    (What::Pressure, "psi", "kPa", 6.894_757_293_168_36),
    (What::Pressure, "kPa", "psi", 0.145_037_737_730_209_2),
    (What::Pressure, "bar", "kPa", 100.0),
    (What::Pressure, "kPa", "bar", 0.01),
    (What::Pressure, "Pa", "kPa", 1e-3),
    (What::Pressure, "kPa", "Pa", 1e3),
    (What::Pressure, "Pa", "bar", 1e-5),
    (What::Pressure, "bar", "Pa", 1e5),
    (What::Pressure, "MPa", "bar", 10.0),
    (What::Pressure, "bar", "MPa", 0.1),
    (What::Tension, "lbf", "N", 4.448_221_615_260_5),
    (What::Tension, "N", "lbf", 0.224_808_943_099_710_5),
    (What::Tension, "kgf", "N", 9.806_65),
    (What::Tension, "N", "kgf", 0.101_971_621_297_792_8),
];

#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum What {
    Pressure,
    Tension,
}

/// A finding about the units of a force map.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspicion {
    /// Median of measured over ideal force.
    pub ratio: f64,
    /// What may be the cause, likeliest first, each with the ratio that would be left.
    pub causes: Vec<(String, f64)>,
}

/// Holds a force map to the ideal braid of a scenario, whose geometry must have been measured; `None` when it may be.
///
/// # Errors
/// As [`Scenario::driven`].
pub fn suspect(map: &ForceMap, scenario: &Scenario) -> Result<Option<Suspicion>, Error> {
    let ideal = {
        let mut ideal = scenario.clone();
        (ideal.actuator.force, ideal.actuator.bladder, ideal.actuator.wall_thickness) = (Force::IdealBraid, None, 0.0);
        ideal
    };
    let Some(ratio) = typical(map, &ideal)? else { return Ok(None) };
    if (USUAL[0]..=USUAL[1]).contains(&ratio) {
        return Ok(None);
    }
    let mut causes: Vec<(String, f64)> = Vec::new();
    for (what, stands, said, factor) in CONFUSED {
        let left = if what == What::Pressure { ratio / factor } else { ratio * factor };
        if (CONVINCING[0]..=CONVINCING[1]).contains(&left) {
            let column = if what == What::Pressure { "gauge pressure" } else { "tension" };
            causes.push((format!("the {column} is in {stands}, where {said} was said"), left));
        }
    }
    // An absolute pressure is too large by the same everywhere.
    let atmosphere = scenario.air.atmospheric_pressure;
    let shifted =
        map.points().iter().map(|point| Point { gauge_pressure: point.gauge_pressure - atmosphere, ..*point });
    let shifted = ForceMap::new(shifted.collect()).ok().map(|shifted| typical(&shifted, &ideal)).transpose()?.flatten();
    if let Some(left) = shifted.filter(|left| (CONVINCING[0]..=CONVINCING[1]).contains(left)) {
        causes.push(("the pressure is absolute, where gauge was said".to_owned(), left));
    }
    causes.sort_by(|(_, a), (_, b)| (a.ln().abs()).total_cmp(&b.ln().abs()));
    Ok(Some(Suspicion { ratio, causes }))
}

/// Median over the pressures, in the upper half of them, where a bladder matters least.
fn typical(map: &ForceMap, ideal: &Scenario) -> Result<Option<f64>, Error> {
    let all = ratios(map, ideal)?;
    let upper: Vec<f64> = all[all.len() / 2..].iter().map(|ratio| ratio.value).collect();
    Ok(median(&upper).filter(|ratio| *ratio > 0.0))
}
