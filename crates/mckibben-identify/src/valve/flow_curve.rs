//! Sonic conductance C and critical ratio b from a flow curve.
//!
//! As the standard goes about it, C is found from the choked points and b from the subsonic ones with that C; the data sheets
//! of SMC (after ISO 6358:1989) average the b of single points, here it is fitted by least squares. Both at once by least
//! squares over all points use the same data better, and are the result.
//!
//! A point is choked when its ratio is at or below the b of the joint fit. The points must have at least one that is and two
//! that are not, and the falling part must stand out: all points with one conductance fit no better with a b than without.

use super::ValveError;
use super::steady::{LAMINAR_RATIO, Proportional, Scatter, SteadyPoint, check};
use crate::least_squares::{Estimate, Evaluation, Fit, FitError, Model, Search, Unknown, fit};
use crate::propagation::estimate;
use mckibben::air::Air;
use mckibben::parameter;
use mckibben::valve::{FlowLaw, FlowStandard};
use mckibben::{Dual, Over};

/// Points that it takes: two unknowns, and some for the scatter.
const LEAST_POINTS: usize = 5;
/// Where the search for b begins.
const STARTS: [f64; 4] = [0.15, 0.3, 0.45, 0.6];
/// Between which it stays: somewhat beyond what a flow path can have, so that wrong units are noticed.
const RATIOS: [f64; 2] = [-1.0, 0.98];
/// Gain in the sum of squares by a b, over the variance, below which it may be chance (about once in a thousand).
const GAIN: f64 = 12.0;
/// Part of the flows below which the scatter is rounding.
const EXACT: f64 = 1e-9;

/// C and b of a flow path.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowCurve {
    /// C in m³/(s·Pa) of the reference atmosphere, from all points.
    pub sonic_conductance: Estimate,
    /// b, from all points. A flow path with a b near zero may come out below zero, as far as its interval reaches zero.
    pub critical_ratio: Estimate,
    /// C from the choked points alone; without an interval when there is only one.
    pub choked_conductance: Estimate,
    /// b from the subsonic points with that C; its interval includes the standard error of C.
    pub subsonic_ratio: Estimate,
    /// How many points are choked.
    pub choked: usize,
    /// How many are not.
    pub subsonic: usize,
    /// The least squares over all points.
    pub fit: Fit,
}

impl FlowCurve {
    /// Of points in any order.
    ///
    /// # Errors
    /// [`ValveError::TooFewPoints`] for less than five, [`ValveError::Implausible`] for numbers that cannot be right,
    /// [`ValveError::NoChoked`] and [`ValveError::NoSubsonic`] for a curve without one of its parts,
    /// [`ValveError::CriticalRatio`] for a b outside 0 to 1, [`ValveError::Fit`] when nothing fits.
    pub fn fit(points: &[SteadyPoint], air: &Air, scatter: Scatter) -> Result<Self, ValveError> {
        check(points, LEAST_POINTS)?;
        let ratios = || points.iter().map(SteadyPoint::ratio);
        let (least, most) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max));
        let all: Vec<&SteadyPoint> = points.iter().collect();
        let flat = as_choked(&all, air, scatter)?;
        // The largest single conductance is near that of a choked point.
        let per_conductance = choked_flows(&all, air)?;
        let largest = all.iter().zip(per_conductance).map(|(point, flow)| point.mass_flow / flow).fold(0.0, f64::max);
        let curve = Curve { points: &all, law: law(largest, STARTS[0], air)?, scatter, conductance: None };
        let fits = STARTS.map(|ratio| {
            let conductance = Unknown::new("sonic_conductance", "m^3/(s*Pa)", largest).between(0.0, f64::INFINITY);
            fit(&curve, &[conductance, unknown_ratio(ratio)], &Search::default())
        });
        let joint = best(fits)?;
        let gain = (flat.cost - joint.cost) / (joint.cost / joint.degrees_of_freedom as f64);
        if flat.scatter <= EXACT || gain <= GAIN {
            return Err(ValveError::NoSubsonic { largest: most });
        }
        let [conductance, ratio] = [0, 1].map(|place| joint.estimates[place].clone());
        let reaches = ratio.confidence_interval.unwrap_or([ratio.value; 2]);
        if ratio.on_bound || reaches[1] < 0.0 || reaches[0] > 1.0 {
            return Err(ValveError::CriticalRatio { value: ratio.value });
        }
        let (choked, subsonic): (Vec<_>, Vec<_>) = all.iter().partition(|point| point.ratio() <= ratio.value);
        if choked.is_empty() {
            return Err(ValveError::NoChoked { least, critical: ratio.value });
        }
        if subsonic.len() < 2 {
            return Err(ValveError::NoSubsonic { largest: most });
        }
        let choked_conductance = match choked.len() {
            1 => estimate(("sonic_conductance", "m^3/(s*Pa)"), single(choked[0], air)?, f64::INFINITY, 1),
            _ => as_choked(&choked, air, scatter)?.estimates[0].clone(),
        };
        let subsonic_ratio = subsonic_ratio(&subsonic, &choked_conductance, ratio.value, air, scatter)?;
        Ok(Self {
            sonic_conductance: conductance,
            critical_ratio: ratio,
            choked_conductance,
            subsonic_ratio,
            choked: choked.len(),
            subsonic: subsonic.len(),
            fit: joint,
        })
    }
}

fn unknown_ratio(start: f64) -> Unknown {
    Unknown::new("critical_ratio", "", start).between(RATIOS[0], RATIOS[1])
}

fn law(sonic_conductance: f64, critical_ratio: f64, air: &Air) -> Result<FlowLaw, ValveError> {
    Ok(FlowLaw::new(FlowStandard::Iso6358 { sonic_conductance, critical_ratio }, 1.0, LAMINAR_RATIO, air)?)
}

/// Flows over the conductance, as if all points were choked.
fn choked_flows(points: &[&SteadyPoint], air: &Air) -> Result<Vec<f64>, ValveError> {
    let law = law(1.0, STARTS[0], air)?;
    Ok(points.iter().map(|point| law.mass_flow(point.drive()[0], 1.0)).collect())
}

/// C of a single choked point.
fn single(point: &SteadyPoint, air: &Air) -> Result<f64, ValveError> {
    Ok(point.mass_flow / choked_flows(&[point], air)?[0])
}

/// C of two points or more, as if all were choked.
fn as_choked(points: &[&SteadyPoint], air: &Air, scatter: Scatter) -> Result<Fit, ValveError> {
    let calculated = choked_flows(points, air)?;
    let start = single(points[0], air)?;
    let points: Vec<SteadyPoint> = points.iter().map(|point| **point).collect();
    let flat = Proportional { points: &points, calculated: &calculated, scatter };
    Ok(fit(&flat, &[Unknown::new("sonic_conductance", "m^3/(s*Pa)", start)], &Search::default())?)
}

/// b of subsonic points with a C that was found before.
fn subsonic_ratio(
    points: &[&SteadyPoint],
    conductance: &Estimate,
    start: f64,
    air: &Air,
    scatter: Scatter,
) -> Result<Estimate, ValveError> {
    let with = |value: f64| {
        let curve = Curve { points, law: law(value, STARTS[0], air)?, scatter, conductance: Some(value) };
        Ok::<_, ValveError>(fit(&curve, &[unknown_ratio(start)], &Search::default())?)
    };
    let found = with(conductance.value)?;
    let ratio = found.estimates[0].clone();
    let Some((own, of_conductance)) = ratio.standard_error.zip(conductance.standard_error) else { return Ok(ratio) };
    // The effect of a C that is larger by its standard error.
    let moved = with(conductance.value + of_conductance)?.estimates[0].value - ratio.value;
    Ok(estimate(("critical_ratio", ""), ratio.value, own.hypot(moved), found.degrees_of_freedom))
}

/// The fit with the least cost, or why there is none.
fn best(fits: impl IntoIterator<Item = Result<Fit, FitError>>) -> Result<Fit, FitError> {
    let better = |best: Result<Fit, FitError>, next: Result<Fit, FitError>| match (&best, &next) {
        (Ok(one), Ok(other)) if other.cost < one.cost => next,
        (Err(_), Ok(_)) => next,
        _ => best,
    };
    fits.into_iter().reduce(better).unwrap_or(Err(FitError::NoStart))
}

/// Flows by C and b, or by b alone.
struct Curve<'a> {
    points: &'a [&'a SteadyPoint],
    /// Of any C and b.
    law: FlowLaw,
    scatter: Scatter,
    /// C where it is no unknown.
    conductance: Option<f64>,
}

impl Model for Curve<'_> {
    fn residuals(&self) -> usize {
        self.points.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        type D = Dual<f64, 2>;
        let place = usize::from(self.conductance.is_none());
        let law = self.law.map(|row, value| match self.conductance {
            _ if std::ptr::eq(row, &parameter::CRITICAL_RATIO) => D::variable(values[place], place),
            None if std::ptr::eq(row, &parameter::SONIC_CONDUCTANCE) => D::variable(values[0], 0),
            _ => D::of(value),
        });
        let greatest = self.points.iter().map(|point| point.mass_flow).fold(0.0, f64::max);
        let mut evaluation = Evaluation { residuals: Vec::new(), slopes: Vec::new() };
        for point in self.points {
            let (scale, [drive, gap]) = (point.scale(self.scatter, greatest), point.drive());
            let flow = law.mass_flow(D::of(drive), D::of(gap));
            evaluation.residuals.push((flow.value - point.mass_flow) / scale);
            evaluation.slopes.extend(flow.slope[..values.len()].iter().map(|slope| slope / scale));
        }
        evaluation
    }
}
