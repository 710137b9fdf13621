//! The valve: how much air flows, and when the poppet moves.
//!
//! [`FlowLaw`] is the mass flow through an open flow path (21)(23), by ISO 6358 or by IEC 60534; [`Valve`] joins it to
//! a supply and an exhaust; [`Solenoid`] says when the flow paths open and close after a [`Command`] drives the coil.
//!
//! | valve | law |
//! |---|---|
//! | two-way, three-way, fill-hold-exhaust | [`Solenoid`] |
//! | five-way, two outputs | [`FiveWay`] |
//! | proportional pressure regulator | [`Regulator`] |
//! | a poppet that takes its time | [`Ramp`] |
//! | proportional spool | [`Spool`] |
//!
//! How far the flow paths are open is known beforehand ([`Openings`]): a function of time between instants that are
//! known too.

mod command;
#[cfg(feature = "alloc")]
mod duty_cycle;
mod five_way;
mod flow;
mod flow_path;
mod opening;
mod ramp;
mod regulator;
mod runtime_command;
pub(crate) mod solenoid;
mod spool;
mod spool_clock;

#[cfg(feature = "alloc")]
pub(crate) use command::check_times;
pub use command::{Command, Request};
#[cfg(feature = "alloc")]
pub use duty_cycle::{Interval, actual_duty_cycle};
#[cfg(feature = "alloc")]
pub(crate) use duty_cycle::{duty_range, period, with_duty};
pub use five_way::{FiveWay, FiveWayOutput, FiveWayRest};
pub use flow::{FlowLaw, FlowZone, flow_parameter};
pub use flow_path::{FlowStandard, REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
pub use opening::Openings;
pub use ramp::{Ramp, Stroke};
pub use regulator::{Approach, Regulator};
pub use runtime_command::RuntimeCommand;
pub use solenoid::{PoppetClock, Ports, Solenoid, ValveKind};
pub(crate) use solenoid::{SIMULTANEOUS, is_due};
pub use spool::{Spool, SpoolMotion};
pub use spool_clock::SpoolClock;

use crate::air::{Air, Chamber, Flow};
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter::{self, Parameter};
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::{Mask, Over, Real, Scalar};

/// The air that feeds the valve. Its temperature is also that of the atmosphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply<S = f64> {
    gauge_pressure: S,
    atmospheric_pressure: S,
    temperature: S,
    /// `1/√T`, which every inflow has.
    per_root_temperature: S,
    /// `1/T`.
    per_temperature: S,
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
pub(crate) fn below_vacuum<S: Real>(parameter: &'static Parameter, gauge: GaugePressure, air: &Air<S>) -> Error {
    Error::Inconsistent {
        parameter,
        value: gauge.0,
        requirement: Requirement {
            relation: "must be greater than minus",
            other: parameter::ATMOSPHERIC_PRESSURE.key,
            value: air.atmosphere().0.value(),
            unit: parameter::ATMOSPHERIC_PRESSURE.unit,
        },
        remedy: "a vacuum cannot be deeper than the atmospheric pressure",
    }
}

impl<S: Scalar> Supply<S> {
    fn assemble(gauge_pressure: S, atmospheric_pressure: S, temperature: S) -> Self {
        let per_root_temperature = S::one() / temperature.sqrt();
        let per_temperature = S::one() / temperature;
        Self { gauge_pressure, atmospheric_pressure, temperature, per_root_temperature, per_temperature }
    }

    /// Converts the supply to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Supply<T> {
        let gauge_pressure = convert.parameter(&parameter::SUPPLY_GAUGE_PRESSURE, self.gauge_pressure);
        let atmospheric_pressure = convert.parameter(&parameter::ATMOSPHERIC_PRESSURE, self.atmospheric_pressure);
        let temperature = convert.parameter(&parameter::SUPPLY_TEMPERATURE, self.temperature);
        match convert.carry() {
            Some(mut carry) => Supply {
                gauge_pressure,
                atmospheric_pressure,
                temperature,
                per_root_temperature: carry(self.per_root_temperature),
                per_temperature: carry(self.per_temperature),
            },
            None => Supply::assemble(gauge_pressure, atmospheric_pressure, temperature),
        }
    }

    /// Gauge pressure of the supply.
    pub fn gauge_pressure(&self) -> GaugePressure<S> {
        GaugePressure(self.gauge_pressure)
    }

    /// Absolute pressure of the supply.
    #[inline(always)]
    pub fn pressure(&self) -> AbsolutePressure<S> {
        AbsolutePressure(self.gauge_pressure + self.atmospheric_pressure)
    }

    /// Temperature of the supply and of the atmosphere in K.
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
    /// That of the atmosphere, as the paper's one `T_am` says.
    Ambient,
}

/// One side of the valve: what lies beyond the flow path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Port {
    /// The supply.
    Supply,
    /// The atmosphere.
    Exhaust,
}

/// A flow law between the actuator, a supply and the atmosphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valve<S = f64> {
    /// Flow through the open flow path to the supply, and through the other unless that has a separate law.
    pub law: FlowLaw<S>,
    exhaust_law: Option<FlowLaw<S>>,
    /// The air that feeds it.
    pub supply: Supply<S>,
    /// The temperature that the flow law takes for outflow.
    pub exhaust_temperature: ExhaustTemperature,
    beyond_supply: Beyond<S>,
    beyond_exhaust: Beyond<S>,
}

/// Air at rest beyond a flow path, by what a flow from it needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond<S = f64> {
    /// Absolute pressure in Pa.
    pressure: S,
    /// `1/P`.
    per_pressure: S,
    /// `P²/T` in Pa²/K.
    squared_drive: S,
}

impl<S: Scalar> Valve<S> {
    /// A valve with a flow law, fed by `supply`, that exhausts to the atmosphere of `air`.
    pub fn new(law: FlowLaw<S>, supply: Supply<S>, exhaust_temperature: ExhaustTemperature, air: &Air<S>) -> Self {
        Self::assemble(law, None, supply, exhaust_temperature, air.atmosphere().0)
    }

    /// Gives the flow path to the atmosphere a separate law.
    pub fn with_exhaust(self, law: FlowLaw<S>) -> Self {
        Self { exhaust_law: Some(law), ..self }
    }

    fn assemble(
        law: FlowLaw<S>,
        exhaust_law: Option<FlowLaw<S>>,
        supply: Supply<S>,
        exhaust_temperature: ExhaustTemperature,
        atmospheric_pressure: S,
    ) -> Self {
        let beyond_supply = Beyond::new(supply.pressure().0, &supply);
        let beyond_exhaust = Beyond::new(atmospheric_pressure, &supply);
        Self { law, exhaust_law, supply, exhaust_temperature, beyond_supply, beyond_exhaust }
    }

    /// Converts the valve to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Valve<T> {
        let law = self.law.convert(Port::Supply, convert);
        let exhaust_law = self.exhaust_law.as_ref().map(|law| law.convert(Port::Exhaust, convert));
        let supply = self.supply.convert(convert);
        let atmospheric_pressure = convert.parameter(&parameter::ATMOSPHERIC_PRESSURE, self.beyond_exhaust.pressure);
        let exhaust_temperature = self.exhaust_temperature;
        match convert.carry() {
            Some(mut carry) => Valve {
                law,
                exhaust_law,
                supply,
                exhaust_temperature,
                beyond_supply: self.beyond_supply.map(&mut carry),
                beyond_exhaust: self.beyond_exhaust.map(&mut carry),
            },
            None => Valve::assemble(law, exhaust_law, supply, exhaust_temperature, atmospheric_pressure),
        }
    }

    /// Flow through the open flow path to a port.
    #[inline(always)]
    pub fn law_of(&self, port: Port) -> &FlowLaw<S> {
        match port {
            Port::Supply => &self.law,
            Port::Exhaust => self.exhaust_law.as_ref().unwrap_or(&self.law),
        }
    }

    /// Absolute pressure in Pa beyond a port.
    #[inline(always)]
    pub fn port_pressure(&self, port: Port) -> S {
        self.beyond(port).pressure
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
        self.flow_in_zone_from(port, &self.beyond(port).over(), zone, chamber)
    }

    /// Flow by the formula of a zone from given conditions beyond a port, which may change.
    #[inline(always)]
    pub(crate) fn flow_in_zone_from<T: Over<S>>(
        &self,
        port: Port,
        beyond: &Beyond<T>,
        zone: FlowZone,
        chamber: &Chamber<T>,
    ) -> Flow<T> {
        let law = self.law_of(port);
        let conductance = T::of(law.conductance());
        if zone.is_inward() {
            let drive = beyond.pressure * T::of(self.supply.per_root_temperature);
            let gap = || (beyond.pressure - chamber.pressure) * beyond.per_pressure;
            Flow { inward: conductance * drive * law.in_zone(zone, gap), outward: T::zero() }
        } else {
            let gap = || (chamber.pressure - beyond.pressure) * chamber.per_pressure;
            let outward = conductance * self.outward_drive(chamber) * law.in_zone(zone, gap);
            Flow { inward: T::zero(), outward }
        }
    }

    /// What lies beyond a port.
    #[inline(always)]
    pub fn beyond(&self, port: Port) -> Beyond<S> {
        match port {
            Port::Supply => self.beyond_supply,
            Port::Exhaust => self.beyond_exhaust,
        }
    }

    /// Flow through one open port, whatever the zone.
    #[inline(always)]
    pub fn flow<T: Over<S>>(&self, port: Port, chamber: &Chamber<T>) -> Flow<T> {
        self.flow_by(self.law_of(port), &self.beyond(port).over(), chamber)
    }

    /// Flow through the flow paths whose masks are set, whatever the zone.
    #[inline(always)]
    pub fn open_flow<T: Over<S>>(&self, chamber: &Chamber<T>, supply: S::Mask, exhaust: S::Mask) -> Flow<T> {
        if self.exhaust_law.is_some() {
            let inlet = self.flow(Port::Supply, chamber).where_open(supply);
            return inlet.and(self.flow(Port::Exhaust, chamber).where_open(exhaust));
        }
        // One evaluation serves whichever flow path is open; a second one only while two poppets overlap.
        let one = Beyond::select(supply, self.beyond_supply, self.beyond_exhaust);
        let flow = self.flow_by(&self.law, &one.over(), chamber).where_open(supply | exhaust);
        let both = supply & exhaust;
        if both.any() { flow.and(self.flow(Port::Exhaust, chamber).where_open(both)) } else { flow }
    }

    /// Flow by a law to what lies beyond a flow path, whatever the zone: selects instead of branches.
    #[inline(always)]
    fn flow_by<T: Over<S>>(&self, law: &FlowLaw<S>, beyond: &Beyond<T>, chamber: &Chamber<T>) -> Flow<T> {
        let pressure = chamber.pressure;
        let inwards = pressure.lt(beyond.pressure);
        let outward_drive = match self.exhaust_temperature {
            ExhaustTemperature::Ambient => pressure * pressure * T::of(self.supply.per_temperature),
            ExhaustTemperature::Actuator => T::of(self.law.gas_constant()) * pressure * chamber.density(),
        };
        let squared_drive = T::select(inwards, beyond.squared_drive, outward_drive);
        let per_upstream = T::select(inwards, beyond.per_pressure, chamber.per_pressure);
        let size = law.mass_flow(squared_drive, (pressure - beyond.pressure).magnitude() * per_upstream);
        Flow { inward: T::select(inwards, size, T::zero()), outward: T::select(inwards, T::zero(), size) }
    }
}

impl<S: Scalar> Beyond<S> {
    fn new(pressure: S, supply: &Supply<S>) -> Self {
        let squared_drive = pressure * pressure * supply.per_temperature;
        Self { pressure, per_pressure: S::one() / pressure, squared_drive }
    }

    /// Converts the air to constants of a wider scalar type.
    #[inline(always)]
    fn over<T: Over<S>>(&self) -> Beyond<T> {
        let Self { pressure, per_pressure, squared_drive } = *self;
        Beyond { pressure: T::of(pressure), per_pressure: T::of(per_pressure), squared_drive: T::of(squared_drive) }
    }

    fn map<T>(&self, mut number: impl FnMut(S) -> T) -> Beyond<T> {
        Beyond {
            pressure: number(self.pressure),
            per_pressure: number(self.per_pressure),
            squared_drive: number(self.squared_drive),
        }
    }

    /// One or the other, lane by lane.
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self {
            pressure: S::select(mask, yes.pressure, no.pressure),
            per_pressure: S::select(mask, yes.per_pressure, no.per_pressure),
            squared_drive: S::select(mask, yes.squared_drive, no.squared_drive),
        }
    }
}
