//! Feed-forward: the pressure that the static model needs, and a regulator that brings it about.
//!
//! ```text
//! P_set = P(F_set, L)      the static model inverted, between 0 and P_max
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | F_set | `force` | N |
//! | L | `length`: where the ends are to be, or where they are measured | m |
//! | P_max | `highest`, at most the supply's | Pa, gauge |
//!
//! With the length that is wanted and the load that hangs there this is control of position without a length sensor; with
//! the length that is measured, control of force without a force sensor. Either is as good as the model: friction, a wrong
//! effectiveness and a load that is not as heavy as it should be are errors that stay. Where no pressure up to P_max gives
//! the force, P_max is commanded.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (3) and (9), inverted. Checked by `tests/control.rs`.

use super::{Controller, Drive, Measurement, Quantity, Regulator, RegulatorMemory, SetPoint};
use crate::actuator::Actuator;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::Real;

/// Which position a model reckons with.
#[derive(Clone, Debug, PartialEq)]
pub enum Place<S = f64> {
    /// What is measured.
    Measured,
    /// What is wanted.
    Wanted(SetPoint<S>),
}

impl<R: Real> Place<R> {
    /// The position at a time in s, where one is measured.
    pub fn at(&self, time: R, measured: R) -> R {
        match self {
            Self::Measured => measured,
            Self::Wanted(set_point) => set_point.at(time),
        }
    }
}

/// A force at a length, and the model that says which pressure gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticAim<S = f64> {
    actuator: Actuator<S>,
    force: SetPoint<S>,
    length: Place<S>,
    highest: GaugePressure<S>,
}

impl StaticAim {
    /// A force at a length, by the model of `actuator`, with gauge pressures up to `highest`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the highest pressure is above zero.
    pub fn new(actuator: Actuator, force: SetPoint, length: Place, highest: GaugePressure) -> Result<Self, Error> {
        parameter::HIGHEST_GAUGE_PRESSURE.check(highest.0)?;
        Ok(Self { actuator, force, length, highest })
    }
}

impl<R: Real> StaticAim<R> {
    /// The model.
    pub fn actuator(&self) -> &Actuator<R> {
        &self.actuator
    }

    /// The length in m that the model reckons with.
    pub fn length(&self, seen: &Measurement<R>) -> R {
        self.length.at(seen.time, seen.length)
    }

    /// The gauge pressure that the model requests.
    pub fn pressure(&self, seen: &Measurement<R>) -> GaugePressure<R> {
        self.actuator.holding_pressure_within(self.force.at(seen.time), self.length(seen), self.highest)
    }
}

/// Brings about the pressure that a model requests.
#[derive(Clone, Debug, PartialEq)]
pub struct FeedForward<Aim = StaticAim, S = f64> {
    /// The model and its set point.
    pub aim: Aim,
    /// From the error of the pressure to what the valve is to do.
    pub regulator: Regulator<S>,
}

impl<R: Real> Controller<R> for FeedForward<StaticAim<R>, R> {
    type Memory = RegulatorMemory<R>;

    fn begin(&self) -> RegulatorMemory<R> {
        self.regulator.begin()
    }

    fn decide(&self, seen: &Measurement<R>, memory: &mut RegulatorMemory<R>) -> Drive<R> {
        let pressures = [self.aim.pressure(seen).0, seen.pressure.0];
        self.regulator.regulate(seen.time, pressures, Quantity::Pressure.rises(), memory)
    }

    fn aim(&self, seen: &Measurement<R>) -> Option<(Quantity, R)> {
        Some((Quantity::Pressure, self.aim.pressure(seen).0))
    }
}
