//! Effectiveness at each nominal pressure: measured over ideal force, as the paper identifies it (9).
//!
//! ```text
//! Eff(P) = Σ F_i F(L_i, P) / Σ F(L_i, P)²         over the points at P that hold a tension; F by the law at effectiveness 1
//! ```
//!
//! which is least squares of one unknown, with its 95 % interval by the scatter about it. It goes with the geometry
//! as it was given: a braid of fitted turns has a factor `1/n²` in it and leaves no effectiveness to estimate.

use super::held_out::Grouping;
use super::{ForceMap, force};
use mckibben::{Actuator, Error};
use mckibben_scenario::{Effectiveness, Scenario};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The effectiveness at one pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Mean gauge pressure in Pa.
    pub gauge_pressure: f64,
    /// Measured over ideal force.
    pub value: f64,
    /// 95 % interval; `None` for a single point.
    pub interval: Option<[f64; 2]>,
    /// From how many points.
    pub points: usize,
}

/// The effectiveness at each pressure of a force map, rising.
///
/// # Errors
/// As [`Scenario::driven`].
pub fn ratios(map: &ForceMap, scenario: &Scenario) -> Result<Vec<Ratio>, Error> {
    let mut ideal = scenario.clone();
    ideal.actuator.effectiveness = Effectiveness::Constant(1.0);
    let actuator = ideal.driven()?.actuator;
    let at = |[low, high]: &[f64; 2]| ratio(map, &actuator, *low, *high);
    Ok(Grouping::Pressures.groups(map).iter().filter_map(at).collect())
}

fn ratio(map: &ForceMap, actuator: &Actuator, low: f64, high: f64) -> Option<Ratio> {
    let here = map.held().filter(|point| (low..=high).contains(&point.gauge_pressure));
    let pairs: Vec<[f64; 2]> = here.clone().map(|point| [force(actuator, point), point.tension]).collect();
    let points = pairs.len();
    let squares: f64 = pairs.iter().map(|[ideal, _]| ideal * ideal).sum();
    if squares <= 0.0 {
        return None;
    }
    let value = pairs.iter().map(|[ideal, measured]| ideal * measured).sum::<f64>() / squares;
    let freedom = points.checked_sub(1).filter(|freedom| *freedom > 0).map(|freedom| freedom as f64);
    let interval = freedom.and_then(|freedom| {
        let squares_of_residuals: f64 = pairs.iter().map(|[ideal, measured]| (measured - value * ideal).powi(2)).sum();
        let half = StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.975)
            * (squares_of_residuals / freedom / squares).sqrt();
        Some([value - half, value + half])
    });
    let gauge_pressure = here.map(|point| point.gauge_pressure).sum::<f64>() / points as f64;
    Some(Ratio { gauge_pressure, value, interval, points })
}
