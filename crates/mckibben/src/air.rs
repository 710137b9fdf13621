//! The air in the actuator: how pressure answers to flow and to volume.
//!
//! ```text
//! T = P V/(m R)
//!
//! isentropic      dP/dt = γ P (ṁ/m − V̇/V)                                             (19)
//! isothermal      dP/dt =   P (ṁ/m − V̇/V)
//! polytropic      dP/dt = κ P (ṁ/m − V̇/V)
//! energy balance  dP/dt = [γ R (T_in ṁ_in − T ṁ_out) − γ P V̇ + (γ−1) h A (T_wall − T)]/V
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | P | `pressure`, absolute | Pa |
//! | m | `mass` | kg |
//! | V, V̇ | `volume`, `volume_rate` | m³, m³/s |
//! | ṁ | `inward − outward` | kg/s, positive into the actuator |
//! | T_in, T, T_wall | temperatures of inflow, air and wall | K |
//! | γ, R, κ, hA | `heat_capacity_ratio`, `gas_constant`, `polytropic_index`, `heat_transfer` | –, J/(kg·K), –, W/K |
//!
//! The first three keep `P (V/m)^κ` constant. The paper's (19) treats every arriving parcel as if it had been in the
//! actuator from the start, so charging heats too much: a fixed volume from 1.013 to 7.9 bar ends near 527 K with 4.34
//! times its air, where the energy balance with supply at 293 K ends near 390 K with 5.86 times.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (17) to (19); energy balance of an open system of ideal gas.
//! Checked by `tests/air.rs`: blow-down and filling in closed form, the invariant, the two end temperatures above.

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::AbsolutePressure;
use crate::scalar::{Over, Scalar};

/// How heat goes between the air and the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Process<S = f64> {
    /// No heat, and inflow as if compressed from the state inside: the paper's (19).
    Isentropic,
    /// Heat enough to keep the temperature.
    Isothermal,
    /// `P (V/m)^κ` constant for any κ.
    Polytropic {
        /// The exponent κ.
        index: S,
    },
    /// The first law with inflow at the supply's temperature.
    EnergyBalance {
        /// `h A` in W/K.
        heat_transfer: S,
        /// Temperature of the wall in K.
        wall_temperature: S,
    },
}

/// A perfect gas, the atmosphere and the process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air<S = f64> {
    gas_constant: S,
    heat_capacity_ratio: S,
    atmospheric_pressure: S,
    process: Process<S>,
    /// `1/R`.
    per_gas_constant: S,
}

/// The contents of the actuator at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chamber<T = f64> {
    /// Absolute pressure in Pa.
    pub pressure: T,
    /// Mass of air in kg.
    pub mass: T,
    /// Volume of braid and hose in m³.
    pub volume: T,
    /// Rate of the volume in m³/s.
    pub volume_rate: T,
    /// `1/(m V)`, from which temperature, density and rates follow.
    pub per_content: T,
    /// `1/P`.
    pub per_pressure: T,
}

impl<T: Scalar> Chamber<T> {
    /// The contents of `volume` (m³, changing at `volume_rate` in m³/s): `mass` (kg) at `pressure` (Pa, absolute).
    #[inline(always)]
    pub fn new(pressure: T, mass: T, volume: T, volume_rate: T) -> Self {
        // One division for both: it takes longer than the rest of a rate's arithmetic.
        let content = mass * volume;
        let reciprocal = T::one() / (content * pressure);
        let (per_content, per_pressure) = (pressure * reciprocal, content * reciprocal);
        Self { pressure, mass, volume, volume_rate, per_content, per_pressure }
    }

    /// Density `m/V` in kg/m³.
    #[inline(always)]
    pub fn density(&self) -> T {
        self.mass * self.mass * self.per_content
    }
}

/// Mass flow through the valve, split by direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow<T = f64> {
    /// Flow into the actuator in kg/s, zero or more.
    pub inward: T,
    /// Flow out of the actuator in kg/s, zero or more.
    pub outward: T,
}

impl<T: Scalar> Flow<T> {
    /// No flow.
    #[inline(always)]
    pub fn none() -> Self {
        Self { inward: T::zero(), outward: T::zero() }
    }

    /// Two flows together.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self { inward: self.inward + other.inward, outward: self.outward + other.outward }
    }

    /// The flow where a flow path is open, none where it is shut.
    #[inline(always)]
    pub fn where_open(self, open: T::Mask) -> Self {
        Self { inward: T::select(open, self.inward, T::zero()), outward: T::select(open, self.outward, T::zero()) }
    }

    /// Net flow into the actuator in kg/s.
    #[inline(always)]
    pub fn net(&self) -> T {
        self.inward - self.outward
    }
}

impl Air {
    /// A gas with `gas_constant` R in J/(kg·K) and `heat_capacity_ratio` γ, in an atmosphere at `atmospheric_pressure`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn new(
        gas_constant: f64,
        heat_capacity_ratio: f64,
        atmospheric_pressure: AbsolutePressure,
        process: Process,
    ) -> Result<Self, Error> {
        match process {
            Process::Isentropic | Process::Isothermal => {}
            Process::Polytropic { index } => drop(parameter::POLYTROPIC_INDEX.check(index)?),
            Process::EnergyBalance { heat_transfer, wall_temperature } => {
                parameter::HEAT_TRANSFER.check(heat_transfer)?;
                parameter::WALL_TEMPERATURE.check(wall_temperature)?;
            }
        }
        let gas_constant = parameter::GAS_CONSTANT.check(gas_constant)?;
        Ok(Self {
            gas_constant,
            per_gas_constant: 1.0 / gas_constant,
            heat_capacity_ratio: parameter::HEAT_CAPACITY_RATIO.check(heat_capacity_ratio)?,
            atmospheric_pressure: parameter::ATMOSPHERIC_PRESSURE.check(atmospheric_pressure.0)?,
            process,
        })
    }

    /// Air of the paper at the standard atmosphere: γ = 1.4, R = 286.99 J/(kg·K).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a process whose numbers are outside their range.
    pub fn standard(process: Process) -> Result<Self, Error> {
        Self::new(286.99, 1.4, AbsolutePressure(101_325.0), process)
    }
}

impl<S: Scalar> Air<S> {
    /// Converts the gas to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Air<T> {
        let gas_constant = convert.parameter(&parameter::GAS_CONSTANT, self.gas_constant);
        let per_gas_constant = match convert.carry() {
            Some(mut carry) => carry(self.per_gas_constant),
            None => T::one() / gas_constant,
        };
        Air {
            gas_constant,
            per_gas_constant,
            heat_capacity_ratio: convert.parameter(&parameter::HEAT_CAPACITY_RATIO, self.heat_capacity_ratio),
            atmospheric_pressure: convert.parameter(&parameter::ATMOSPHERIC_PRESSURE, self.atmospheric_pressure),
            process: match self.process {
                Process::Isentropic => Process::Isentropic,
                Process::Isothermal => Process::Isothermal,
                Process::Polytropic { index } => {
                    Process::Polytropic { index: convert.parameter(&parameter::POLYTROPIC_INDEX, index) }
                }
                Process::EnergyBalance { heat_transfer, wall_temperature } => Process::EnergyBalance {
                    heat_transfer: convert.parameter(&parameter::HEAT_TRANSFER, heat_transfer),
                    wall_temperature: convert.parameter(&parameter::WALL_TEMPERATURE, wall_temperature),
                },
            },
        }
    }

    /// Specific gas constant R in J/(kg·K).
    pub fn gas_constant(&self) -> S {
        self.gas_constant
    }

    /// Ratio of heat capacities γ.
    pub fn heat_capacity_ratio(&self) -> S {
        self.heat_capacity_ratio
    }

    /// Pressure of the atmosphere.
    #[inline(always)]
    pub fn atmosphere(&self) -> AbsolutePressure<S> {
        AbsolutePressure(self.atmospheric_pressure)
    }

    /// How heat goes between the air and the wall.
    pub fn process(&self) -> Process<S> {
        self.process
    }

    /// Exponent κ with which a sealed chamber answers a quick change of volume.
    pub fn index(&self) -> S {
        match self.process {
            Process::Isothermal => S::one(),
            Process::Polytropic { index } => index,
            Process::Isentropic | Process::EnergyBalance { .. } => self.heat_capacity_ratio,
        }
    }

    /// Temperature `T = P V/(m R)` in K.
    #[inline(always)]
    pub fn temperature<T: Over<S>>(&self, chamber: &Chamber<T>) -> T {
        chamber.pressure * chamber.volume * chamber.volume * chamber.per_content * T::of(self.per_gas_constant)
    }

    /// Mass in kg that fills `volume` at a pressure and a temperature.
    pub fn mass<T: Over<S>>(&self, pressure: AbsolutePressure<T>, volume: T, temperature: T) -> T {
        pressure.0 * volume / (T::of(self.gas_constant) * temperature)
    }

    /// The net flow into a chamber in kg/s with which its pressure changes at a rate in Pa/s, when what comes in is as warm as
    /// the air inside: [`Air::pressure_rate`] inverted.
    #[inline(always)]
    pub fn flow_for<T: Over<S>>(&self, chamber: &Chamber<T>, pressure_rate: T) -> T {
        let Chamber { pressure, mass, volume, volume_rate, .. } = *chamber;
        match self.process {
            Process::EnergyBalance { heat_transfer, wall_temperature } => {
                let gamma = T::of(self.heat_capacity_ratio);
                let temperature = self.temperature(chamber);
                let heat = (gamma - T::one()) * T::of(heat_transfer) * (T::of(wall_temperature) - temperature);
                let enthalpy = pressure_rate * volume + gamma * pressure * volume_rate - heat;
                enthalpy / (gamma * T::of(self.gas_constant) * temperature)
            }
            _ => mass * (pressure_rate / (T::of(self.index()) * pressure) + volume_rate / volume),
        }
    }

    /// How fast in 1/s heat alone brings the mass of air at a given pressure to that at the temperature of the wall.
    #[cfg(feature = "alloc")]
    #[inline(always)]
    pub(crate) fn given_mass_settling<T: Over<S>>(&self, chamber: &Chamber<T>) -> T {
        match self.process {
            Process::EnergyBalance { heat_transfer, wall_temperature } => {
                let gamma = T::of(self.heat_capacity_ratio);
                let power = (gamma - T::one()) * T::of(heat_transfer) * T::of(wall_temperature);
                power / (gamma * chamber.pressure * chamber.volume)
            }
            _ => T::zero(),
        }
    }

    /// `dP/dt` in Pa/s, with inflow at `inflow_temperature` in K.
    #[inline(always)]
    pub fn pressure_rate<T: Over<S>>(&self, chamber: &Chamber<T>, flow: &Flow<T>, inflow_temperature: T) -> T {
        self.pressure_rate_by(chamber, flow, || inflow_temperature * flow.inward)
    }

    /// `dP/dt` in Pa/s of a chamber with a flow whose parts that come in bring `warmth`, the sum of `T ṁ` in K·kg/s, which only
    /// an energy balance needs.
    #[inline(always)]
    pub fn pressure_rate_by<T: Over<S>>(&self, chamber: &Chamber<T>, flow: &Flow<T>, warmth: impl FnOnce() -> T) -> T {
        let Chamber { pressure, mass, volume, volume_rate, per_content, .. } = *chamber;
        match self.process {
            Process::EnergyBalance { heat_transfer, wall_temperature } => {
                let gamma = T::of(self.heat_capacity_ratio);
                let temperature = self.temperature(chamber);
                let enthalpy = gamma * T::of(self.gas_constant) * (warmth() - temperature * flow.outward);
                let heat = (gamma - T::one()) * T::of(heat_transfer) * (T::of(wall_temperature) - temperature);
                (enthalpy - gamma * pressure * volume_rate + heat) * mass * per_content
            }
            _ => {
                let relative = (flow.net() * volume - volume_rate * mass) * per_content;
                T::of(self.index()) * pressure * relative
            }
        }
    }
}
