//! The valve: how much air flows, and when the seat moves.
//!
//! [`FlowLaw`] is the mass flow through an open passage (21)(23) or ISO 6358; [`Valve`] joins it to a supply and an
//! exhaust; [`Solenoid`] says when the passages open and close after a [`Command`] drives the coil.

mod command;
mod flow;
mod solenoid;

#[cfg(feature = "alloc")]
pub(crate) use command::check_times;
pub use command::{Command, Request};
pub use flow::{FlowLaw, FlowStandard, FlowZone, REFERENCE_DENSITY};
pub(crate) use solenoid::SIMULTANEOUS;
pub use solenoid::{Ports, SeatClock, Solenoid, ValveKind};

use crate::air::{Air, Chamber, Flow};
use crate::error::{Error, Requirement};
use crate::parameter::{self, Parameter};
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::{Over, Scalar};

/// The air that feeds the valve. Its temperature is also that of the surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply<S = f64> {
    gauge_pressure: S,
    atmospheric_pressure: S,
    temperature: S,
    /// `1/√T`, which every inflow has.
    per_root_temperature: S,
}

impl Supply {
    /// A supply at `gauge` pressure (below zero for a vacuum) and `temperature` in K.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] for a gauge pressure at or below
    /// minus the atmospheric pressure.
    pub fn new(gauge: GaugePressure, temperature: f64, air: &Air) -> Result<Self, Error> {
        parameter::SUPPLY_GAUGE_PRESSURE.check(gauge.0)?;
        if gauge.absolute(air.atmosphere()).0 <= 0.0 {
            return Err(below_vacuum(&parameter::SUPPLY_GAUGE_PRESSURE, gauge, air));
        }
        let temperature = parameter::SUPPLY_TEMPERATURE.check(temperature)?;
        Ok(Self::assemble(gauge.0, air.atmosphere().0, temperature))
    }
}

/// The error of a gauge pressure that would leave less than nothing.
pub(crate) fn below_vacuum(parameter: &'static Parameter, gauge: GaugePressure, air: &Air) -> Error {
    Error::Inconsistent {
        parameter,
        value: gauge.0,
        requirement: Requirement {
            relation: "must be greater than minus",
            other: parameter::ATMOSPHERIC_PRESSURE.key,
            value: air.atmosphere().0,
            unit: parameter::ATMOSPHERIC_PRESSURE.unit,
        },
        remedy: "a vacuum cannot be deeper than the surroundings' own pressure",
    }
}

impl<S: Scalar> Supply<S> {
    fn assemble(gauge_pressure: S, atmospheric_pressure: S, temperature: S) -> Self {
        let per_root_temperature = S::one() / temperature.sqrt();
        Self { gauge_pressure, atmospheric_pressure, temperature, per_root_temperature }
    }

    /// The same supply over another scalar.
    pub fn map<T: Scalar>(&self, mut convert: impl FnMut(&'static Parameter, S) -> T) -> Supply<T> {
        Supply::assemble(
            convert(&parameter::SUPPLY_GAUGE_PRESSURE, self.gauge_pressure),
            convert(&parameter::ATMOSPHERIC_PRESSURE, self.atmospheric_pressure),
            convert(&parameter::SUPPLY_TEMPERATURE, self.temperature),
        )
    }

    /// Absolute pressure of the supply.
    #[inline(always)]
    pub fn pressure(&self) -> AbsolutePressure<S> {
        AbsolutePressure(self.gauge_pressure + self.atmospheric_pressure)
    }

    /// Temperature of the supply and of the surroundings in K.
    #[inline(always)]
    pub fn temperature(&self) -> S {
        self.temperature
    }
}

/// Which temperature the flow law takes for air that leaves the actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExhaustTemperature {
    /// The actuator's own.
    Actuator,
    /// The surroundings', as the paper's one `T_am` says.
    Ambient,
}

/// One side of the valve: what lies beyond the passage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// The supply.
    Supply,
    /// The surroundings.
    Exhaust,
}

/// A passage law between the actuator, a supply and the surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valve<S = f64> {
    /// Flow through an open passage.
    pub law: FlowLaw<S>,
    /// The air that feeds it.
    pub supply: Supply<S>,
    /// The temperature that the flow law takes for outflow.
    pub exhaust_temperature: ExhaustTemperature,
    atmospheric_pressure: S,
}

impl<S: Scalar> Valve<S> {
    /// A valve with a flow law, fed by `supply`, that exhausts to the surroundings of `air`.
    pub fn new(law: FlowLaw<S>, supply: Supply<S>, exhaust_temperature: ExhaustTemperature, air: &Air<S>) -> Self {
        Self { law, supply, exhaust_temperature, atmospheric_pressure: air.atmosphere().0 }
    }

    /// The same valve over another scalar.
    pub fn map<T: Scalar>(&self, mut convert: impl FnMut(&'static Parameter, S) -> T) -> Valve<T> {
        Valve {
            law: self.law.map(&mut convert),
            supply: self.supply.map(&mut convert),
            exhaust_temperature: self.exhaust_temperature,
            atmospheric_pressure: convert(&parameter::ATMOSPHERIC_PRESSURE, self.atmospheric_pressure),
        }
    }

    /// Absolute pressure in Pa beyond a port.
    #[inline(always)]
    pub fn port_pressure(&self, port: Port) -> S {
        match port {
            Port::Supply => self.supply.pressure().0,
            Port::Exhaust => self.atmospheric_pressure,
        }
    }

    /// `P/√T` of air that leaves the actuator; with the actuator's own temperature that is `√(R P ρ)`.
    #[inline(always)]
    fn outward_drive<T: Over<S>>(&self, chamber: &Chamber<T>) -> T {
        match self.exhaust_temperature {
            ExhaustTemperature::Ambient => chamber.pressure * T::of(self.supply.per_root_temperature),
            ExhaustTemperature::Actuator => {
                (T::of(self.law.gas_constant()) * chamber.pressure * chamber.density()).sqrt()
            }
        }
    }

    /// Flow through one open port in the zone that `zone` says, smoothly continued beyond the zone's bounds.
    #[inline(always)]
    pub fn flow_in_zone<T: Over<S>>(&self, port: Port, zone: FlowZone, chamber: &Chamber<T>) -> Flow<T> {
        let beyond = T::of(self.port_pressure(port));
        let conductance = T::of(self.law.conductance());
        if zone.is_inward() {
            let drive = beyond * T::of(self.supply.per_root_temperature);
            let ratio = || chamber.pressure / beyond;
            Flow { inward: conductance * drive * self.law.in_zone(zone, ratio), outward: T::zero() }
        } else {
            let ratio = || beyond / chamber.pressure;
            let outward = conductance * self.outward_drive(chamber) * self.law.in_zone(zone, ratio);
            Flow { inward: T::zero(), outward }
        }
    }

    /// Flow through one open port, whatever the zone: selects instead of branches.
    #[inline(always)]
    pub fn flow<T: Over<S>>(&self, port: Port, chamber: &Chamber<T>) -> Flow<T> {
        let beyond = T::of(self.port_pressure(port));
        let pressure = chamber.pressure;
        let inwards = pressure.lt(beyond);
        let inward_drive = beyond * T::of(self.supply.per_root_temperature);
        let drive = T::select(inwards, inward_drive, self.outward_drive(chamber));
        let high = T::select(inwards, beyond, pressure);
        let low = T::select(inwards, pressure, beyond);
        let size = T::of(self.law.conductance()) * drive * self.law.ratio_function(low / high);
        Flow { inward: T::select(inwards, size, T::zero()), outward: T::select(inwards, T::zero(), size) }
    }
}
