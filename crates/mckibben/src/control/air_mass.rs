//! Control of the mass of air, which sets stiffness and position together.
//!
//! ```text
//! m_set = P_set V(L)/(R T)      P_set as for feed-forward
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | P_set, L | pressure and length of the `aim` | Pa, m |
//! | V | volume of braid and hose at L | m³ |
//! | T | `temperature` that the controller reckons with | K |
//!
//! With the valve shut an actuator keeps its air, not its pressure: as a spring of constant mass it is stiffer than (7), and
//! it comes back to its length when a disturbance has gone. A regulator of the pressure would let air out of an actuator
//! that is stretched and back in when it is let go; a regulator of the mass leaves the valve shut. Two masses of air set
//! stiffness and position of a joint together ([`super::JointAim`]).
//!
//! Source: the authors control their leg by "internal air mass … instead of pressure" (Colbrunn, Nelson & Quinn 2001,
//! section 2.1; R. Colbrunn, "Design and Control of a Robotic Leg with Braided Pneumatic Actuators", M.S. thesis, Case
//! Western Reserve University, 2000). How their controller gets from masses to valves is not in the paper: here it is any
//! [`Regulator`]. Checked by `tests/control.rs`.

use super::{Controller, Drive, Measurement, Quantity, Regulator, RegulatorMemory, StaticAim};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;

/// Brings about the mass of air that a model requests.
#[derive(Clone, Debug, PartialEq)]
pub struct AirMass<Aim = StaticAim, S = f64> {
    pub(super) aim: Aim,
    pub(super) temperature: S,
    pub(super) regulator: Regulator<S>,
}

impl<Aim> AirMass<Aim> {
    /// The masses of air that have the pressures of `aim` at a temperature in K.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the temperature is above zero.
    pub fn new(aim: Aim, temperature: f64, regulator: Regulator) -> Result<Self, Error> {
        Ok(Self { aim, temperature: parameter::CONTROL_TEMPERATURE.check(temperature)?, regulator })
    }
}

impl<R: Real> AirMass<StaticAim<R>, R> {
    /// The mass of air in kg that the model requests.
    pub fn mass(&self, seen: &Measurement<R>) -> R {
        let aim = &self.aim;
        aim.actuator().air_mass(aim.pressure(seen), aim.length(seen), self.temperature)
    }
}

impl<R: Real> Controller<R> for AirMass<StaticAim<R>, R> {
    type Memory = RegulatorMemory<R>;

    fn begin(&self) -> RegulatorMemory<R> {
        self.regulator.begin()
    }

    fn decide(&self, seen: &Measurement<R>, memory: &mut RegulatorMemory<R>) -> Drive<R> {
        let masses = [self.mass(seen), seen.air_mass];
        self.regulator.regulate(seen.time, masses, Quantity::AirMass.rises(), memory)
    }

    fn aim(&self, seen: &Measurement<R>) -> Option<(Quantity, R)> {
        Some((Quantity::AirMass, self.mass(seen)))
    }
}
