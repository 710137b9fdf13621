//! The air: its process, where it comes from, and what it flows through; pressures that are given.

use crate::choice::{HoseKind, PressurePlace};
use crate::follow::true_pressure;
use mckibben::Real;
use mckibben::parameter::{self as p, Parameter};

/// The gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// How the actuator's air changes its state.
    pub process: Process,
    /// Absolute pressure of the atmosphere P_atm in Pa.
    pub atmospheric_pressure: f64,
    /// Specific gas constant R in J/(kg·K).
    pub gas_constant: f64,
    /// Ratio of heat capacities γ.
    pub heat_capacity_ratio: f64,
}

/// How the actuator's air changes its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Process {
    /// The paper's isentropic law.
    Isentropic,
    /// Constant temperature.
    Isothermal,
    /// A given exponent.
    Polytropic {
        /// The exponent κ.
        index: f64,
    },
    /// The first law of thermodynamics.
    EnergyBalance {
        /// Heat transfer coefficient times area h A in W/K.
        heat_transfer: f64,
        /// Temperature of the wall T_wall in K.
        wall_temperature: f64,
    },
}

/// The air behind the valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// Gauge pressure in Pa.
    pub gauge_pressure: f64,
    /// Temperature in K of the supply's air and the atmosphere.
    pub temperature: f64,
    /// A reservoir that sags; without one the air has no end.
    pub reservoir: Option<Reservoir>,
    /// A regulator that holds the gauge pressure above; without one it is constant, or the reservoir's.
    pub regulator: Option<PressureRegulator>,
    /// How many actuators, all alike, draw from reservoir or regulator.
    pub actuators: f64,
}

/// A reservoir that feeds the valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reservoir {
    /// Volume V_r in m³.
    pub volume: f64,
    /// Gauge pressure at the start in Pa; the supply's when absent.
    pub gauge_pressure: Option<f64>,
    /// Polytropic exponent κ_r of its air.
    pub polytropic_index: f64,
    /// What fills it; a bottle when absent.
    pub compressor: Option<Compressor>,
}

/// A compressor with a pressure switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compressor {
    /// Free air Q in m³/s.
    pub displacement: f64,
    /// Dead over swept volume ε.
    pub clearance: f64,
    /// Gauge pressure in Pa at which it starts.
    pub cut_in: f64,
    /// Gauge pressure in Pa at which it stops.
    pub cut_out: f64,
}

/// A pressure regulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureRegulator {
    /// Time constant τ in s.
    pub lag: f64,
    /// Loss of outlet pressure over flow D in Pa·s/kg.
    pub droop: f64,
    /// Error within which it rests B in Pa.
    pub dead_band: f64,
}

/// The hose from the valve to the actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hose {
    /// How finely it is resolved.
    pub kind: HoseKind,
    /// How many cells it is divided into when distributed.
    pub cells: usize,
    /// Length L_h in m.
    pub length: f64,
    /// Inner diameter d in m.
    pub diameter: f64,
    /// Viscosity μ of the gas in Pa·s.
    pub viscosity: f64,
    /// Polytropic exponent κ of its air.
    pub polytropic_index: f64,
}

/// A pressure as a given function of time: straight lines between points, constant outside.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureSeries {
    /// Where it stands.
    pub at: PressurePlace,
    /// Times in s, strictly increasing, from zero on.
    pub time: Vec<f64>,
    /// Gauge pressure in Pa at each, as it was recorded.
    pub gauge_pressure: Vec<f64>,
    /// What its sensor makes of the pressure.
    pub sensor: PressureSensor,
}

/// What the sensor of a given pressure makes of it: r(t) = s P(t − δ) + o.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureSensor {
    /// Reading o in Pa at zero gauge pressure.
    pub offset: f64,
    /// Reading over the gauge pressure s.
    pub scale: f64,
    /// By how much readings come late, δ in s.
    pub shift: f64,
}

impl Supply {
    /// Gauge pressure in Pa that its reservoir starts at: the supply's where nothing else is said.
    pub(crate) fn reservoir_start(&self) -> f64 {
        self.reservoir.and_then(|of| of.gauge_pressure).unwrap_or(self.gauge_pressure)
    }
}

impl Default for PressureSensor {
    /// Shows the pressure as it is.
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0, shift: 0.0 }
    }
}

impl PressureSeries {
    /// The gauge pressures in Pa at its rows.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let PressureSensor { offset, scale, .. } = self.sensor;
        self.gauge_pressure.iter().map(move |shown| true_pressure(*shown, [offset, scale]))
    }

    /// The gauge pressure in Pa at t = 0, which is not that of the first row where readings come late.
    pub fn start(&self) -> f64 {
        self.start_over(|_, _, value| value).unwrap_or_default()
    }

    /// [`PressureSeries::start`] over any scalar: `number` gives each number by its parameter, its index in a list, and its value. None
    /// without rows.
    pub(crate) fn start_over<S: Real>(&self, mut number: impl FnMut(&'static Parameter, usize, f64) -> S) -> Option<S> {
        let PressureSensor { offset, scale, shift } = self.sensor;
        let next = self.time.partition_point(|time| *time <= shift);
        let mut reading = |row: usize| {
            let gauge = number(&p::SERIES_GAUGE_PRESSURE, row, *self.gauge_pressure.get(row)?);
            Some([number(&p::SERIES_TIME, row, *self.time.get(row)?), gauge])
        };
        let shown = match (next.checked_sub(1).and_then(&mut reading), reading(next)) {
            // With the shift, and with the times, the place between two rows moves.
            (Some([from, last]), Some([to, next])) if shift > from.value() => {
                let part = (number(&p::SERIES_SHIFT, 0, shift) - from) / (to - from);
                last + part * (next - last)
            }
            (only, other) => only.or(other)?[1],
        };
        let sensor = [number(&p::SERIES_OFFSET, 0, offset), number(&p::SERIES_SCALE, 0, scale)];
        Some(true_pressure(shown, sensor))
    }
}
