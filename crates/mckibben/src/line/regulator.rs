//! A pressure regulator between the reservoir and the valve: droop, dead band and lag.
//!
//! ```text
//! τ dP/dt = Z(e)        e = min(P_set − D ṁ, P_reservoir) − P
//! Z(e) = e − B above B,  0 between ∓B,  e + B below −B
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | P, P_set | absolute outlet pressure, what it is set to | Pa |
//! | D | `droop`: loss of outlet pressure over flow | Pa·s/kg |
//! | B | `dead_band`: error within which the poppet rests | Pa |
//! | τ | `lag` | s |
//! | ṁ | flow towards the valve | kg/s |
//!
//! In the steady state the outlet lies within B of `P_set − D ṁ`, which is how maker's flow curves are read; it cannot lie
//! above the reservoir. Where the poppet rests is a mode, and it takes up work again by an event.
//!
//! Source: the three terms are the usual figures of a regulator's data sheet; the form is this project's choice.
//! Checked by `tests/line_supply.rs`.

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// Which way the poppet moves the outlet's pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Poppet {
    /// The outlet is too low: it feeds.
    Raises,
    /// Within the dead band.
    Rests,
    /// The outlet is too high: it relieves.
    Lowers,
}

impl Poppet {
    /// −1, 0 or +1.
    #[inline(always)]
    pub fn direction(self) -> f64 {
        match self {
            Self::Raises => 1.0,
            Self::Rests => 0.0,
            Self::Lowers => -1.0,
        }
    }
}

/// A pressure regulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulator<S = f64> {
    droop: S,
    dead_band: S,
    lag: S,
}

impl Regulator {
    /// A regulator with `droop` in Pa·s/kg, `dead_band` in Pa and `lag` in s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn new(droop: f64, dead_band: f64, lag: f64) -> Result<Self, Error> {
        Ok(Self {
            droop: parameter::DROOP.check(droop)?,
            dead_band: parameter::DEAD_BAND.check(dead_band)?,
            lag: parameter::LAG.check(lag)?,
        })
    }
}

impl<S: Scalar> Regulator<S> {
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Regulator<T> {
        Regulator {
            droop: convert.parameter(&parameter::DROOP, self.droop),
            dead_band: convert.parameter(&parameter::DEAD_BAND, self.dead_band),
            lag: convert.parameter(&parameter::LAG, self.lag),
        }
    }

    /// The error e in Pa, of an outlet at `pressure` set to `set`, fed at `inlet` if that is not without end, with a flow
    /// in kg/s towards the valve; pressures absolute in Pa.
    #[inline(always)]
    pub fn error<T: Over<S>>(&self, pressure: T, set: T, inlet: Option<T>, flow: T) -> T {
        let target = set - T::of(self.droop) * flow;
        inlet.map_or(target, |inlet| target.smaller(inlet)) - pressure
    }

    /// `dP/dt` in Pa/s at an error in Pa while the poppet moves as it does.
    #[inline(always)]
    pub fn pressure_rate<T: Over<S>>(&self, error: T, poppet: Poppet) -> T {
        match poppet {
            Poppet::Rests => T::zero(),
            _ => (error - T::of(self.dead_band) * T::constant(poppet.direction())) / T::of(self.lag),
        }
    }

    /// `dP/dt` in Pa/s at an error in Pa, whatever the poppet does: selects instead of modes.
    #[inline(always)]
    pub fn rate<T: Over<S>>(&self, error: T) -> T {
        let band = T::of(self.dead_band);
        (error - error.smaller(band).larger(-band)) / T::of(self.lag)
    }

    /// How the poppet moves at an error in Pa.
    pub fn poppet(&self, error: S) -> Poppet
    where
        S: crate::scalar::Real,
    {
        // Without a dead band one formula holds throughout.
        if error.value() > self.dead_band.value() || self.dead_band.value() == 0.0 {
            Poppet::Raises
        } else if error.value() < -self.dead_band.value() {
            Poppet::Lowers
        } else {
            Poppet::Rests
        }
    }

    /// Half the width of the dead band in Pa.
    #[inline(always)]
    pub fn dead_band(&self) -> S {
        self.dead_band
    }

    /// Loss of outlet pressure over flow in Pa·s/kg.
    #[inline(always)]
    pub fn droop(&self) -> S {
        self.droop
    }

    /// The time constant in s.
    #[inline(always)]
    pub fn lag(&self) -> S {
        self.lag
    }
}
