//! Whether a force map is that of the muscle in other units than it says.
//!
//! A braid of known geometry pulls `P_g (3L² − b²)/(4πn²)` or somewhat less. When measured over ideal force is far
//! from that, and a unit that labs confuse brings it back, it is the likelier explanation. A fit would hide it: its
//! turns take up any factor.

use super::effectiveness::ratios;
use super::{ForceMap, Point, force};
use crate::median::median;
use mckibben::{Actuator, Error};
use mckibben_scenario::{Effectiveness, Force, Scenario};

/// Median of measured over ideal force of muscles as they are: outside it something is wrong.
const USUAL: [f64; 2] = [0.4, 1.7];
/// That median of no muscle, whatever its braid.
const POSSIBLE: [f64; 2] = [0.05, 20.0];
/// That median where a unit has been put right: within it the correction convinces.
const CONVINCING: [f64; 2] = [0.6, 1.4];

/// Units of pressures and of tensions that are taken for another, in SI.
const PRESSURES: [(&str, f64); 6] =
    [("Pa", 1.0), ("mbar", 1e2), ("kPa", 1e3), ("bar", 1e5), ("MPa", 1e6), ("psi", 6_894.757_293_168_361)];
const TENSIONS: [(&str, f64); 4] = [("N", 1.0), ("lbf", 4.448_221_615_260_5), ("kgf", 9.806_65), ("kN", 1e3)];
/// Part of the ideal force beyond which a tension has a direction.
const DIRECTED: f64 = 0.2;
/// How near, as a part of it, the pressure at which tensions vanish is to that of the atmosphere where gauge and absolute are mistaken.
const NEAR: f64 = 0.1;
/// How many times the largest pressure must be the least for tensions to show where they vanish.
const SPREAD: f64 = 1.5;
/// The part of its residual that a law with an offset of the pressure leaves at most where the offset is believed.
const EXPLAINED: f64 = 0.5;

/// Tensions at the end of a load cell: so many, that part of all, and the ratio of the ideal braid's at them beyond which they cannot be
/// one tension.
const MANY: usize = 4;
const AT_END: f64 = 0.05;
const APART: f64 = 1.2;

/// A finding about the units of a force map.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspicion {
    /// Median of measured over ideal force.
    pub ratio: f64,
    /// What may be the cause, likeliest first, each with the ratio that would be left.
    pub causes: Vec<(String, f64)>,
}

impl Suspicion {
    /// Whether no muscle has such tensions, so that a unit or the geometry is wrong even where no single unit explains it.
    pub fn is_impossible(&self) -> bool {
        !(POSSIBLE[0]..=POSSIBLE[1]).contains(&self.ratio)
    }
}

/// Tensions that have not the direction of the braid's.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Misdirected {
    /// They are below zero where the ideal braid pulls.
    Negative,
    /// They pull at lengths where the ideal braid pushes.
    Pulling,
}

/// Compares the signs of tensions, in the upper half of the pressures, with those of the ideal braid of a scenario.
///
/// # Errors
/// As [`Scenario::driven`].
pub fn misdirected(points: &[Point], scenario: &Scenario) -> Result<Option<Misdirected>, Error> {
    let actuator = braid(scenario)?;
    let mut points: Vec<&Point> = points.iter().filter(|point| point.tension.is_finite()).collect();
    points.sort_by(|a, b| a.gauge_pressure.total_cmp(&b.gauge_pressure));
    let upper = &points[points.len() / 2..];
    let (mut negative, mut pulling) = (0, 0);
    for point in upper.iter().filter(|point| point.gauge_pressure > 0.0) {
        let ideal = force(&actuator, point);
        negative += usize::from(ideal > 0.0 && point.tension < -DIRECTED * ideal);
        pulling += usize::from(ideal < 0.0 && point.tension > -DIRECTED * ideal);
    }
    Ok(match (2 * negative > upper.len(), 2 * pulling > upper.len()) {
        (true, _) => Some(Misdirected::Negative),
        (_, true) => Some(Misdirected::Pulling),
        _ => None,
    })
}

/// The gauge pressure in Pa at which the tensions of a force map vanish, where that is about the pressure of the atmosphere, as of
/// absolute pressures that are taken for gauge, or as far below zero, as of gauge pressures that are taken for absolute; `None` where
/// it is neither, or pressures are too alike to show it.
///
/// # Errors
/// As [`Scenario::driven`].
pub fn vanishes_at_atmosphere(map: &ForceMap, scenario: &Scenario) -> Result<Option<f64>, Error> {
    let actuator = braid(scenario)?;
    let pressures = || map.held().map(|point| point.gauge_pressure).filter(|pressure| *pressure > 0.0);
    let (least, largest) = (pressures().fold(f64::INFINITY, f64::min), pressures().fold(0.0, f64::max));
    if largest < SPREAD * least || map.held().count() < 4 {
        return Ok(None);
    }
    // F = s g P − s p₀ g with the ideal force g P, by the normal equations of both.
    let rows: Vec<[f64; 3]> = map
        .held()
        .filter(|point| point.gauge_pressure > 0.0)
        .map(|point| {
            let pulls = force(&actuator, point);
            [pulls, pulls / point.gauge_pressure * largest, point.tension]
        })
        .collect();
    let sum = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
    let determinant = sum(0, 0) * sum(1, 1) - sum(0, 1) * sum(0, 1);
    let slope = (sum(0, 2) * sum(1, 1) - sum(1, 2) * sum(0, 1)) / determinant;
    let offset = (sum(1, 2) * sum(0, 0) - sum(0, 2) * sum(0, 1)) / determinant;
    let through = sum(0, 2) / sum(0, 0);
    let left = |slope: f64, offset: f64| {
        rows.iter().map(|row| (slope * row[0] + offset * row[1] - row[2]).powi(2)).sum::<f64>().sqrt()
    };
    let at = -offset / slope * largest;
    let atmosphere = scenario.air.atmospheric_pressure;
    let is_believed = slope > 0.0 && left(slope, offset) < EXPLAINED * left(through, 0.0);
    Ok((is_believed && (at.abs() - atmosphere).abs() < NEAR * atmosphere).then_some(at))
}

/// Tensions of a load cell at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturated {
    /// The tension in N that it reads there.
    pub tension: f64,
    /// How many tensions are this one.
    pub count: usize,
    /// Of how many that were held.
    pub of: usize,
    /// The ideal braid's largest tension at these over its least.
    pub ratio: f64,
}

/// The largest tension of a force map, where so many are exactly this one at places where the ideal braid of a scenario pulls so
/// differently that a load cell at its end is the cause; where others repeat as well, as in a table of tensions that were set, it is
/// not.
///
/// # Errors
/// As [`Scenario::driven`].
pub fn saturated(map: &ForceMap, scenario: &Scenario) -> Result<Option<Saturated>, Error> {
    let actuator = braid(scenario)?;
    let tension = map.largest();
    let (at_end, below): (Vec<&Point>, Vec<&Point>) = map.held().partition(|point| point.tension == tension);
    let mut others: Vec<f64> = below.iter().map(|point| point.tension).collect();
    others.sort_by(f64::total_cmp);
    let repeated = others.windows(2).filter(|pair| pair[0] == pair[1]).count();
    let ideals = || at_end.iter().map(|point| force(&actuator, point));
    let (least, largest) = (ideals().fold(f64::INFINITY, f64::min), ideals().fold(0.0, f64::max));
    let (count, of) = (at_end.len(), at_end.len() + others.len());
    let are_many = count >= MANY && MANY <= others.len() && count as f64 >= AT_END * of as f64;
    let is_end = are_many && 2 * repeated < others.len() && least > 0.0 && largest > APART * least;
    Ok(is_end.then_some(Saturated { tension, count, of, ratio: largest / least }))
}

/// The scenario with the ideal braid alone.
fn ideal(scenario: &Scenario) -> Scenario {
    let mut ideal = scenario.clone();
    (ideal.actuator.force, ideal.actuator.bladder, ideal.actuator.wall_thickness) = (Force::IdealBraid, None, 0.0);
    ideal
}

/// The ideal braid of a scenario, which pulls in full.
fn braid(scenario: &Scenario) -> Result<Actuator, Error> {
    let mut ideal = ideal(scenario);
    ideal.actuator.effectiveness = Effectiveness::Constant(1.0);
    Ok(ideal.driven()?.actuator)
}

/// Holds a force map to the ideal braid of a scenario, whose geometry must have been measured; `None` when it may be.
///
/// # Errors
/// As [`Scenario::driven`].
pub fn suspect(map: &ForceMap, scenario: &Scenario) -> Result<Option<Suspicion>, Error> {
    let ideal = ideal(scenario);
    let Some(ratio) = typical(map, &ideal)? else { return Ok(None) };
    if (USUAL[0]..=USUAL[1]).contains(&ratio) {
        return Ok(None);
    }
    let mut causes: Vec<(String, f64)> = Vec::new();
    for (column, units, is_pressure) in [("gauge pressure", &PRESSURES[..], true), ("tension", &TENSIONS, false)] {
        let pairs = units.iter().flat_map(|stands| units.iter().map(move |said| (stands, said)));
        for ((stands, of), (said, in_si)) in pairs.filter(|(stands, said)| stands.0 != said.0) {
            let left = if is_pressure { ratio * in_si / of } else { ratio * of / in_si };
            if (CONVINCING[0]..=CONVINCING[1]).contains(&left) {
                causes.push((format!("the {column} is in {stands}, where {said} was said"), left));
            }
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
