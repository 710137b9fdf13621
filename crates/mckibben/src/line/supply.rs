//! What feeds the valve where that is not a supply of constant pressure: a reservoir, a regulator, or both, for one actuator
//! or for several alike.

use super::regulator::Regulator;
use super::reservoir::Reservoir;
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::Scalar;

/// A supply whose pressure changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplyLine<S = f64> {
    reservoir: Option<Reservoir<S>>,
    regulator: Option<Regulator<S>>,
    actuators: S,
}

impl SupplyLine {
    /// A reservoir, a regulator, or both, that feed so many `actuators` alike: each draws what the simulated one draws.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number of actuators below one; [`Error::Inconsistent`] for several actuators without a
    /// reservoir or a regulator that they could share.
    pub fn new(reservoir: Option<Reservoir>, regulator: Option<Regulator>, actuators: f64) -> Result<Self, Error> {
        let actuators = parameter::ACTUATORS.check(actuators)?;
        if reservoir.is_none() && regulator.is_none() && actuators != 1.0 {
            return Err(Error::Inconsistent {
                parameter: &parameter::ACTUATORS,
                value: actuators,
                requirement: Requirement {
                    relation: "must be, on a supply of constant pressure,",
                    other: "one",
                    value: 1.0,
                    unit: "",
                },
                remedy: "give supply.reservoir_volume or supply.lag: actuators on a constant pressure do not feel each other",
            });
        }
        Ok(Self { reservoir, regulator, actuators })
    }
}

impl<S: Scalar> SupplyLine<S> {
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> SupplyLine<T> {
        SupplyLine {
            reservoir: self.reservoir.as_ref().map(|reservoir| reservoir.convert(convert)),
            regulator: self.regulator.as_ref().map(|regulator| regulator.convert(convert)),
            actuators: convert.parameter(&parameter::ACTUATORS, self.actuators),
        }
    }

    /// The reservoir.
    #[inline(always)]
    pub fn reservoir(&self) -> Option<&Reservoir<S>> {
        self.reservoir.as_ref()
    }

    /// The regulator.
    #[inline(always)]
    pub fn regulator(&self) -> Option<&Regulator<S>> {
        self.regulator.as_ref()
    }

    /// How many actuators draw from it.
    #[inline(always)]
    pub fn actuators(&self) -> S {
        self.actuators
    }
}
