//! Steady flow through a valve, and the efficiency (22): measured over calculated flow.

use super::ValveError;
use crate::least_squares::{Estimate, Evaluation, Fit, Model, Search, Unknown, fit};
use mckibben::AbsolutePressure;
use mckibben::air::Air;
use mckibben::valve::{FlowLaw, FlowStandard, REFERENCE_DENSITY, REFERENCE_TEMPERATURE};

/// Temperatures in K of air in a laboratory; a number in °C or °F is outside.
const TEMPERATURES: [f64; 2] = [150.0, 700.0];
/// Where the straight line of the flow law begins.
pub(super) const LAMINAR_RATIO: f64 = 0.999;

/// One point of steady flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyPoint {
    /// Absolute pressure before the valve.
    pub upstream: AbsolutePressure,
    /// Absolute pressure behind it.
    pub downstream: AbsolutePressure,
    /// Temperature of the air before the valve in K.
    pub temperature: f64,
    /// Mass flow in kg/s.
    pub mass_flow: f64,
}

/// How the scatter of measured flows goes with their size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scatter {
    /// It is the same for all.
    Constant,
    /// It is the same part of each.
    Proportional,
}

impl SteadyPoint {
    /// Of a volume flow in m³/s that is counted as air of the reference atmosphere (ANR, ISO 8778: 20 °C, 100 kPa, 65 %).
    pub fn of_reference_volume(
        upstream: AbsolutePressure,
        downstream: AbsolutePressure,
        temperature: f64,
        volume_flow: f64,
    ) -> Self {
        Self { upstream, downstream, temperature, mass_flow: REFERENCE_DENSITY * volume_flow }
    }

    /// Downstream over upstream pressure.
    pub fn ratio(&self) -> f64 {
        self.downstream.0 / self.upstream.0
    }

    /// Conductance of ISO 6358 in m³/(s·Pa): mass flow over reference density and upstream pressure, as if the air upstream
    /// were at the reference temperature. Of a choked point it is C.
    pub fn conductance(&self) -> f64 {
        self.mass_flow / (REFERENCE_DENSITY * self.upstream.0) * (self.temperature / REFERENCE_TEMPERATURE).sqrt()
    }

    /// `P²/T` before the valve in Pa²/K and the gap `1 − r`: what a flow law needs.
    pub(super) fn drive(&self) -> [f64; 2] {
        [self.upstream.0 * self.upstream.0 / self.temperature, 1.0 - self.ratio()]
    }

    /// What a residual of its flow is divided by.
    pub(super) fn scale(&self, scatter: Scatter, largest: f64) -> f64 {
        match scatter {
            Scatter::Constant => largest,
            Scatter::Proportional => self.mass_flow,
        }
    }
}

/// The largest flow.
pub(super) fn largest(points: &[SteadyPoint]) -> f64 {
    points.iter().map(|point| point.mass_flow).fold(0.0, f64::max)
}

/// Checks that there are `least` points or more and that each can be what it says.
pub(super) fn check(points: &[SteadyPoint], least: usize) -> Result<(), ValveError> {
    if points.len() < least {
        return Err(ValveError::TooFewPoints { points: points.len(), least });
    }
    for (place, point) in points.iter().enumerate() {
        let wrong = |what, value, unit, problem, remedy| {
            Err(ValveError::Implausible { what, point: place + 1, value, unit, problem, remedy })
        };
        let SteadyPoint { upstream, downstream, temperature, mass_flow } = *point;
        let numbers = [
            ("upstream pressure", upstream.0, "Pa"),
            ("downstream pressure", downstream.0, "Pa"),
            ("temperature", temperature, "K"),
            ("mass flow", mass_flow, "kg/s"),
        ];
        for (what, value, unit) in numbers {
            if !value.is_finite() {
                return wrong(what, value, unit, "which is not a finite number", "leave that point out");
            }
        }
        for (what, value, unit) in &numbers[..2] {
            check_pressure(what, place, *value, unit)?;
        }
        if downstream.0 >= upstream.0 {
            let (problem, remedy) = ("not below the upstream pressure", "swap the two, or leave that point out");
            return wrong("downstream pressure", downstream.0, "Pa", problem, remedy);
        }
        if !(TEMPERATURES[0]..=TEMPERATURES[1]).contains(&temperature) {
            let (problem, remedy) = (
                "no temperature of air in a laboratory",
                "if it was measured in degC or degF, give it in kelvin, or with its own unit",
            );
            return wrong("temperature", temperature, "K", problem, remedy);
        }
        if mass_flow <= 0.0 {
            let (problem, remedy) = ("not above zero", "count it from upstream to downstream, or leave that point out");
            return wrong("mass flow", mass_flow, "kg/s", problem, remedy);
        }
    }
    Ok(())
}

/// Checks that an absolute pressure in Pa is one.
pub(super) fn check_pressure(
    what: &'static str,
    place: usize,
    value: f64,
    unit: &'static str,
) -> Result<(), ValveError> {
    let (problem, remedy) = match value {
        value if value <= 0.0 => {
            ("not above zero, so it is no absolute pressure", "add the atmosphere's pressure if it is a gauge pressure")
        }
        value if value < 1e3 => {
            ("hardly more than a vacuum", "check its unit, and that it is absolute: 1 bar is 100000 Pa")
        }
        _ => return Ok(()),
    };
    Err(ValveError::Implausible { what, point: place + 1, value, unit, problem, remedy })
}

/// Measured over calculated flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Efficiency {
    /// The factor on the calculated flow that fits best.
    pub factor: Estimate,
    /// Measured over calculated flow, point by point: a trend with the pressure ratio says that the law has another shape.
    pub ratios: Vec<f64>,
    /// The least squares behind it.
    pub fit: Fit,
}

/// The factor η on the flow of a law, by least squares.
///
/// # Errors
/// [`ValveError::TooFewPoints`] for less than two points, [`ValveError::Implausible`] for numbers that cannot be right.
pub fn efficiency(points: &[SteadyPoint], law: &FlowLaw, scatter: Scatter) -> Result<Efficiency, ValveError> {
    factor(points, law, scatter, "efficiency")
}

/// The flow coefficient C_q of (22) of a flow path with an area A_p in m².
///
/// # Errors
/// As [`efficiency`], and [`ValveError::Physics`] for an area that is not above zero.
pub fn flow_coefficient(
    points: &[SteadyPoint],
    area: f64,
    air: &Air,
    scatter: Scatter,
) -> Result<Efficiency, ValveError> {
    let law = FlowLaw::new(FlowStandard::Orifice { flow_area: area }, 1.0, LAMINAR_RATIO, air)?;
    factor(points, &law, scatter, "flow_coefficient")
}

fn factor(points: &[SteadyPoint], law: &FlowLaw, scatter: Scatter, name: &str) -> Result<Efficiency, ValveError> {
    check(points, 2)?;
    let calculated: Vec<f64> = points
        .iter()
        .map(|point| {
            let [drive, gap] = point.drive();
            law.mass_flow(drive, gap)
        })
        .collect();
    let ratios: Vec<f64> = points.iter().zip(&calculated).map(|(point, flow)| point.mass_flow / flow).collect();
    let start = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let proportional = Proportional { points, calculated: &calculated, scatter };
    let fit = fit(&proportional, &[Unknown::new(name, "", start)], &Search::default())?;
    Ok(Efficiency { factor: fit.estimates[0].clone(), ratios, fit })
}

/// Flows that are a factor times those calculated.
pub(super) struct Proportional<'a> {
    pub(super) points: &'a [SteadyPoint],
    pub(super) calculated: &'a [f64],
    pub(super) scatter: Scatter,
}

impl Model for Proportional<'_> {
    fn residuals(&self) -> usize {
        self.points.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let largest = largest(self.points);
        let rows = self.points.iter().zip(self.calculated).map(|(point, flow)| {
            let scale = point.scale(self.scatter, largest);
            ((values[0] * flow - point.mass_flow) / scale, flow / scale)
        });
        let (residuals, slopes) = rows.unzip();
        Evaluation { residuals, slopes }
    }
}
