//! A proportional pressure regulator: an output pressure that follows a setpoint, behind a flow path that is always
//! open.
//!
//! ```text
//! dp/dt = max(−q, min(q, (u(t − θ) − p)/τ))             p the regulated pressure, u the setpoint
//! ṁ     = C, b law between p and the actuator           in while P < p, out while P > p
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | u, p | `setpoint`, `pressure`, absolute | Pa |
//! | θ | `dead_time` | s |
//! | τ | `time_constant` | s |
//! | q | `rate_limit` | Pa/s |
//!
//! The pressure is a state: the rate limit's two ends and what lies between are three [`Approach`]es, each with its own
//! formula. Tests know it in closed form while the setpoint stays the same: with `e = p − u`, a straight line for
//! `t₁ = max(0, |e₀|/q − τ)`, then `e = ±qτ exp(−(t − t₁)/τ)`, or `e₀ exp(−t/τ)` where the limit is never reached.
//!
//! The flow path is that of a [`Valve`](super::Valve): a large actuator fills as slowly as C and b let it, and its
//! pressure comes to rest at p from both sides. The setpoint is kept between the atmosphere and the supply, beyond
//! which no regulator can go; the flow path is taken as fed at p whatever the supply, so a supply close to the setpoint
//! is outside the law, as are dead band, hysteresis and offset under flow.
//!
//! Source: the first-order model with dead time of process control; rate and flow path limit it as data sheets state
//! them, by a rise time into a volume and a flow. Checked by `tests/regulator.rs`: its branches against the closed
//! form; `tests/regulated_rig.rs`: dead time, rest, flow path.

use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};

/// A proportional pressure regulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulator<S = f64> {
    time_constant: S,
    dead_time: S,
    rate_limit: S,
}

/// Which formula of the rate holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Approach {
    /// At the limit of the rate, upwards.
    Rises,
    /// Within it.
    Settles,
    /// At the limit of the rate, downwards.
    Falls,
}

impl Regulator {
    /// A regulator with its time constant in s (above zero), dead time in s (zero or more) and largest rate in Pa/s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn new(time_constant: f64, dead_time: f64, rate_limit: f64) -> Result<Self, Error> {
        Ok(Self {
            time_constant: parameter::REGULATOR_TIME_CONSTANT.check(time_constant)?,
            dead_time: parameter::VALVE_DEAD_TIME.check(dead_time)?,
            rate_limit: parameter::REGULATOR_RATE_LIMIT.check(rate_limit)?,
        })
    }

    /// Checks that what feeds a regulator, at a gauge pressure in Pa, is enough for a set point in Pa, gauge.
    pub(crate) fn check_set_point(gauge: f64, feed: f64) -> Result<(), Error> {
        if gauge <= feed {
            return Ok(());
        }
        Err(Error::Inconsistent {
            parameter: &parameter::COMMAND_GAUGE_PRESSURE,
            value: gauge,
            requirement: Requirement {
                relation: "must not be greater than",
                other: parameter::SUPPLY_GAUGE_PRESSURE.key,
                value: feed,
                unit: parameter::SUPPLY_GAUGE_PRESSURE.unit,
            },
            remedy: "lower the set point or raise the supply: a regulator cannot give more than feeds it",
        })
    }
}

impl<S: Scalar> Regulator<S> {
    /// Converts the regulator to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Regulator<T> {
        Regulator {
            time_constant: convert.parameter(&parameter::REGULATOR_TIME_CONSTANT, self.time_constant),
            dead_time: convert.parameter(&parameter::VALVE_DEAD_TIME, self.dead_time),
            rate_limit: convert.parameter(&parameter::REGULATOR_RATE_LIMIT, self.rate_limit),
        }
    }

    /// Replaces the dead time, in s.
    pub(super) fn with_dead_time(self, dead_time: S) -> Self {
        Self { dead_time, ..self }
    }

    /// Time in s from a setpoint to the first answer.
    pub fn dead_time(&self) -> S {
        self.dead_time
    }

    /// How an absolute pressure in Pa goes to a setpoint.
    pub fn approach(&self, pressure: S, setpoint: S) -> Approach
    where
        S: Real,
    {
        let apart = (setpoint - pressure).value();
        if apart.abs() <= (self.rate_limit * self.time_constant).value() {
            Approach::Settles
        } else if apart > 0.0 {
            Approach::Rises
        } else {
            Approach::Falls
        }
    }

    /// The absolute pressure in Pa at which the limit of the rate ceases to hold; none within it.
    pub fn limit_end(&self, approach: Approach, setpoint: S) -> Option<S> {
        let reach = self.rate_limit * self.time_constant;
        match approach {
            Approach::Rises => Some(setpoint - reach),
            Approach::Settles => None,
            Approach::Falls => Some(setpoint + reach),
        }
    }

    /// Rate in Pa/s by the formula of an approach, smoothly continued.
    #[inline(always)]
    pub fn rate_in<T: Over<S>>(&self, approach: Approach, pressure: T, setpoint: T) -> T {
        match approach {
            Approach::Rises => T::of(self.rate_limit),
            Approach::Settles => (setpoint - pressure) / T::of(self.time_constant),
            Approach::Falls => -T::of(self.rate_limit),
        }
    }
}
