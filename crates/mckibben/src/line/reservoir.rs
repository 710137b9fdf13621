//! A reservoir that feeds the valve and sags as it does: a bottle, or a tank that a compressor fills.
//!
//! ```text
//! dP/dt = κRT/V (ṁ_compressor − ṁ_out)
//!
//! compressor   ṁ = Q ρ_atm η_v while it runs        η_v = 1 − ε ((P/P_atm)^(1/γ) − 1), not below 0
//!              starts when P falls to the cut-in pressure, stops when it rises to the cut-out pressure
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | V, κ | `volume`, `polytropic_index` | m³, – |
//! | Q | `displacement`, free air per second | m³/s |
//! | ε | `clearance`: dead over swept volume | – |
//! | η_v | volumetric efficiency | – |
//! | R, T | gas constant, temperature of the supply | J/(kg·K), K |
//!
//! κ is 1 for a tank that keeps its temperature and γ for one that is drawn upon quickly; the content that goes with it is
//! `V P/(κRT)`. A bottle is a reservoir without a compressor.
//!
//! Source: volumetric efficiency of a piston compressor with clearance, textbook thermodynamics.
//! Checked by `tests/line_supply.rs`: filling time and blow-down in closed form, the switch's band.

use crate::air::Air;
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::{Over, Scalar};
use crate::valve::below_vacuum;

/// A closed volume of air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reservoir<S = f64> {
    volume: S,
    polytropic_index: S,
    gauge_pressure: S,
    atmospheric_pressure: S,
    gas_constant: S,
    temperature: S,
    compressor: Option<Compressor<S>>,
    /// `κRT/V` in Pa/kg.
    stiffness: S,
}

/// What fills a reservoir.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compressor<S = f64> {
    displacement: S,
    clearance: S,
    cut_in: S,
    cut_out: S,
    heat_capacity_ratio: S,
}

impl Compressor {
    /// A compressor that takes in `displacement` m³/s of free air, has dead over swept volume `clearance`, and runs from the
    /// gauge pressure `cut_in` up to `cut_out`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] unless `cut_in` lies below `cut_out`.
    pub fn new(
        [displacement, clearance]: [f64; 2],
        [cut_in, cut_out]: [GaugePressure; 2],
        air: &Air,
    ) -> Result<Self, Error> {
        let (cut_in, cut_out) = (parameter::CUT_IN.check(cut_in.0)?, parameter::CUT_OUT.check(cut_out.0)?);
        if cut_in >= cut_out {
            return Err(Error::Inconsistent {
                parameter: &parameter::CUT_IN,
                value: cut_in,
                requirement: Requirement {
                    relation: "must be less than",
                    other: parameter::CUT_OUT.key,
                    value: cut_out,
                    unit: parameter::CUT_OUT.unit,
                },
                remedy: "let the compressor start at a lower pressure than it stops at",
            });
        }
        Ok(Self {
            displacement: parameter::DISPLACEMENT.check(displacement)?,
            clearance: parameter::CLEARANCE.check(clearance)?,
            cut_in,
            cut_out,
            heat_capacity_ratio: air.heat_capacity_ratio(),
        })
    }
}

impl<S: Scalar> Compressor<S> {
    fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Compressor<T> {
        Compressor {
            displacement: convert.parameter(&parameter::DISPLACEMENT, self.displacement),
            clearance: convert.parameter(&parameter::CLEARANCE, self.clearance),
            cut_in: convert.parameter(&parameter::CUT_IN, self.cut_in),
            cut_out: convert.parameter(&parameter::CUT_OUT, self.cut_out),
            heat_capacity_ratio: convert.parameter(&parameter::HEAT_CAPACITY_RATIO, self.heat_capacity_ratio),
        }
    }

    /// Volumetric efficiency at a ratio of the delivery's absolute pressure to that of the atmosphere.
    #[inline(always)]
    pub fn efficiency<T: Over<S>>(&self, ratio: T) -> T {
        let expanded = ratio.power(T::one() / T::of(self.heat_capacity_ratio));
        (T::one() - T::of(self.clearance) * (expanded - T::one())).larger(T::zero())
    }
}

impl Reservoir {
    /// A reservoir of `volume` m³ that starts at a gauge pressure and keeps its air near `temperature` K with
    /// `polytropic_index` κ, filled by a compressor if there is one.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Inconsistent`] for numbers outside their range.
    pub fn new(
        [volume, polytropic_index, temperature]: [f64; 3],
        start: GaugePressure,
        compressor: Option<Compressor>,
        air: &Air,
    ) -> Result<Self, Error> {
        parameter::RESERVOIR_PRESSURE.check(start.0)?;
        if start.absolute(air.atmosphere()).0 <= 0.0 {
            return Err(below_vacuum(&parameter::RESERVOIR_PRESSURE, start, air));
        }
        Ok(Self::assemble(
            [
                parameter::RESERVOIR_VOLUME.check(volume)?,
                parameter::RESERVOIR_INDEX.check(polytropic_index)?,
                start.0,
                air.atmosphere().0,
                air.gas_constant(),
                parameter::SUPPLY_TEMPERATURE.check(temperature)?,
            ],
            compressor,
        ))
    }
}

impl<S: Scalar> Reservoir<S> {
    fn assemble(numbers: [S; 6], compressor: Option<Compressor<S>>) -> Self {
        let [volume, polytropic_index, gauge_pressure, atmospheric_pressure, gas_constant, temperature] = numbers;
        let stiffness = polytropic_index * gas_constant * temperature / volume;
        Self {
            volume,
            polytropic_index,
            gauge_pressure,
            atmospheric_pressure,
            gas_constant,
            temperature,
            compressor,
            stiffness,
        }
    }

    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Reservoir<T> {
        let numbers = [
            convert.parameter(&parameter::RESERVOIR_VOLUME, self.volume),
            convert.parameter(&parameter::RESERVOIR_INDEX, self.polytropic_index),
            convert.parameter(&parameter::RESERVOIR_PRESSURE, self.gauge_pressure),
            convert.parameter(&parameter::ATMOSPHERIC_PRESSURE, self.atmospheric_pressure),
            convert.parameter(&parameter::GAS_CONSTANT, self.gas_constant),
            convert.parameter(&parameter::SUPPLY_TEMPERATURE, self.temperature),
        ];
        let compressor = self.compressor.as_ref().map(|compressor| compressor.convert(convert));
        let stiffness = convert.carry().map(|mut carry| carry(self.stiffness));
        let reservoir = Reservoir::assemble(numbers, compressor);
        match stiffness {
            Some(stiffness) => Reservoir { stiffness, ..reservoir },
            None => reservoir,
        }
    }

    /// Volume in m³.
    pub fn volume(&self) -> S {
        self.volume
    }

    /// What fills it, unless it is a bottle.
    #[inline(always)]
    pub fn compressor(&self) -> Option<&Compressor<S>> {
        self.compressor.as_ref()
    }

    /// Absolute pressure at the start.
    pub fn start(&self) -> AbsolutePressure<S> {
        AbsolutePressure(self.gauge_pressure + self.atmospheric_pressure)
    }

    /// Absolute pressures in Pa at which the compressor starts and stops.
    pub fn switch_pressures(&self) -> Option<[S; 2]> {
        self.compressor.map(|compressor| [compressor.cut_in, compressor.cut_out].map(|p| p + self.atmospheric_pressure))
    }

    /// Flow in kg/s that the compressor delivers at an absolute pressure in Pa while it runs.
    #[inline(always)]
    pub fn delivery<T: Over<S>>(&self, pressure: T) -> T {
        let Some(compressor) = &self.compressor else { return T::zero() };
        let atmosphere = T::of(self.atmospheric_pressure);
        let density = T::of(self.atmospheric_pressure / (self.gas_constant * self.temperature));
        T::of(compressor.displacement) * density * compressor.efficiency(pressure / atmosphere)
    }

    /// `dP/dt` in Pa/s with a net inflow in kg/s.
    #[inline(always)]
    pub fn pressure_rate<T: Over<S>>(&self, net: T) -> T {
        net * T::of(self.stiffness)
    }

    /// Content in kg at an absolute pressure in Pa.
    pub fn content<T: Over<S>>(&self, pressure: T) -> T {
        pressure / T::of(self.stiffness)
    }
}
