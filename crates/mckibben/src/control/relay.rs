//! Bang-bang control: a relay with a dead band.
//!
//! ```text
//! e = w − y
//! fill      once e > δ,    until e ≤ δ − h
//! exhaust   once e < −δ,   until e ≥ h − δ
//! else      hold, or with a three-way valve the previous request
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | w, y | `target`, `measured`; both negated where more air makes less of the quantity | the quantity's |
//! | δ | `dead_band` | the quantity's |
//! | h | `hysteresis`, at most δ | the quantity's |
//!
//! Without a dead band wider than what the valve moves in one sample and its own closing delay, the relay chatters. Dead band
//! and hysteresis are the textbook's. Checked by `tests/control.rs`.

use super::Quantity;
use crate::error::{Error, Requirement};
use crate::parameter::Parameter;
use crate::scalar::{Real, Scalar};
use crate::valve::Request;

/// What a relay requests inside its dead band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Hold; for a fill-hold-exhaust valve.
    Hold,
    /// The previous request; for a three-way valve, which cannot hold.
    Keep,
}

/// Fill, exhaust, or neither, by the sign and size of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relay<S = f64> {
    dead_band: S,
    hysteresis: S,
    between: Between,
}

impl Relay {
    /// A relay for an error of `quantity`, with `dead_band` and `hysteresis` in its unit.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is negative or not finite; [`Error::Inconsistent`] for a hysteresis above
    /// the dead band.
    pub fn new(quantity: Quantity, dead_band: f64, hysteresis: f64, between: Between) -> Result<Self, Error> {
        let rows = quantity.rows();
        rows.dead_band.check(dead_band)?;
        rows.hysteresis.check(hysteresis)?;
        if hysteresis > dead_band {
            return Err(Error::Inconsistent {
                parameter: &rows.hysteresis,
                value: hysteresis,
                requirement: Requirement {
                    relation: "must not be above",
                    other: rows.dead_band.key,
                    value: dead_band,
                    unit: rows.dead_band.unit,
                },
                remedy: "lower the hysteresis or widen the dead band",
            });
        }
        Ok(Self { dead_band, hysteresis, between })
    }
}

impl<S: Scalar> Relay<S> {
    /// Converts the relay for an error of `quantity` to another scalar type; `function` receives each number with its
    /// parameter.
    pub fn map<T: Scalar>(&self, quantity: Quantity, mut function: impl FnMut(&'static Parameter, S) -> T) -> Relay<T> {
        let rows = quantity.rows();
        Relay {
            dead_band: function(&rows.dead_band, self.dead_band),
            hysteresis: function(&rows.hysteresis, self.hysteresis),
            between: self.between,
        }
    }

    /// The request inside the dead band.
    pub fn between(&self) -> Between {
        self.between
    }

    /// The request before the first sample.
    pub fn begin(&self) -> Request {
        match self.between {
            Between::Hold => Request::Hold,
            Between::Keep => Request::Exhaust,
        }
    }
}

impl<R: Real> Relay<R> {
    /// The request at an error, after the previous request.
    pub fn decide(&self, error: R, before: Request) -> Request {
        let release = self.dead_band - self.hysteresis;
        let beyond = |error: R, already: bool| {
            self.dead_band.lt(error) || (self.between == Between::Hold && already && release.lt(error))
        };
        if beyond(error, before == Request::Fill) {
            Request::Fill
        } else if beyond(-error, before == Request::Exhaust) {
            Request::Exhaust
        } else {
            match self.between {
                Between::Hold => Request::Hold,
                Between::Keep => before,
            }
        }
    }
}
