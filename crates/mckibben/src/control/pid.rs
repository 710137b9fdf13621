//! PID control, whose output is the duty cycle of a pulse-width modulation.
//!
//! ```text
//! p = K (β w − y)
//! d ← [T_d d − K T_d N (y − y₋)]/(T_d + N h)              derivative of the measurement, filtered with T_d/N
//! i ← i + h [K (w − y)/T_i + (u − v)/T_t]₋                integral, drawn back by what the limits cut off
//! v = u₀ + p + i + d          u = v within the limits of the output
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | w, y | `target`, `measured`; both negated where more air makes less of the quantity | the quantity's |
//! | K | `gain`, one over the proportional band | 1/the quantity's |
//! | T_i, T_d, T_t | `integral_time`, `derivative_time`, `tracking_time` | s |
//! | N, β | `derivative_filter`, `set_point_weight` | – |
//! | u₀ | `bias` | – |
//! | h | time since the last sample | s |
//! | ₋ | at the last sample | |
//!
//! The derivative is taken of the measurement, so that a step of the set point gives no kick, by the backward difference,
//! which is stable at any h; the integral by the forward difference. Back-calculation with T_t keeps the integral from
//! winding up while the output is at its limit: there `v − u` settles at `K (w − y) T_t/T_i`.
//!
//! The output u is a share of pulses that fill, the rest exhausting (0 to 1, a three-way valve), or a signed one: above zero
//! a share of pulses that fill, below zero of pulses that exhaust, the rest holding (−1 to 1, a fill-hold-exhaust valve).
//!
//! Source: Åström & Hägglund (1995), "PID Controllers: Theory, Design, and Tuning", 2nd ed.; Åström & Murray (2008),
//! "Feedback Systems", the chapter on PID control. Defaults of N and T_t are the customary ones.
//! Checked by `tests/pid.rs`.

use super::{Drive, Quantity};
use crate::convert::{Convert, ConvertEach};
use crate::error::Error;
use crate::parameter::{self, Parameter};
use crate::scalar::{Real, Scalar};
use crate::valve::Request;

/// What the output of a PID controller means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// 0 to 1: pulses that fill, the rest exhausting; for a three-way valve.
    FillExhaust,
    /// −1 to 1: pulses that fill above zero and exhaust below, the rest holding; for a fill-hold-exhaust valve.
    FillHoldExhaust,
}

/// Proportional, integral and derivative action with limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid<S = f64> {
    proportional_band: S,
    integral_time: Option<S>,
    derivative_time: S,
    derivative_filter: S,
    set_point_weight: S,
    tracking_time: Option<S>,
    bias: S,
    output: Output,
}

/// What a PID controller remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PidMemory<R = f64> {
    /// The integral i.
    pub integral: R,
    /// The filtered derivative d.
    pub derivative: R,
    /// Time in s and measured value of the last sample; `None` before the first.
    pub last: Option<(R, R)>,
    /// Rate of the integral in 1/s since the last sample.
    pub integral_rate: R,
}

impl Pid {
    /// Proportional action alone, for an error of `quantity`: the full output at an error of `proportional_band` in its
    /// unit.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the band is above zero.
    pub fn new(quantity: Quantity, proportional_band: f64, output: Output) -> Result<Self, Error> {
        Ok(Self {
            proportional_band: quantity.rows().proportional_band.check(proportional_band)?,
            integral_time: None,
            derivative_time: 0.0,
            derivative_filter: 10.0,
            set_point_weight: 1.0,
            tracking_time: None,
            bias: 0.0,
            output,
        })
    }

    /// Adds integral action with this time in s. It is drawn back from a limit in the time √(T_i T_d), or T_i
    /// without derivative, until [`Pid::with_tracking`] says otherwise.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is above zero.
    pub fn with_integral(self, time: f64) -> Result<Self, Error> {
        Ok(Self { integral_time: Some(parameter::INTEGRAL_TIME.check(time)?), ..self })
    }

    /// Adds derivative action with this time in s, filtered with the time constant `time/filter`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a negative time or a filter that is not above zero.
    pub fn with_derivative(self, time: f64, filter: f64) -> Result<Self, Error> {
        let derivative_time = parameter::DERIVATIVE_TIME.check(time)?;
        Ok(Self { derivative_time, derivative_filter: parameter::DERIVATIVE_FILTER.check(filter)?, ..self })
    }

    /// Sets the time in s in which the integral is drawn back from a limit.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is above zero.
    pub fn with_tracking(self, time: f64) -> Result<Self, Error> {
        Ok(Self { tracking_time: Some(parameter::TRACKING_TIME.check(time)?), ..self })
    }

    /// Sets the share, 0 to 1, of the set point that the proportional action sees.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a share outside its range.
    pub fn with_set_point_weight(self, weight: f64) -> Result<Self, Error> {
        Ok(Self { set_point_weight: parameter::SET_POINT_WEIGHT.check(weight)?, ..self })
    }

    /// Sets the output at zero error.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for an output below −1 or above 1.
    pub fn with_bias(self, bias: f64) -> Result<Self, Error> {
        Ok(Self { bias: parameter::BIAS.check(bias)?, ..self })
    }
}

impl<S: Scalar> Pid<S> {
    /// Converts the controller for an error of `quantity` to another scalar type; `function` receives each number with
    /// its parameter.
    pub fn map<T: Scalar>(&self, quantity: Quantity, function: impl FnMut(&'static Parameter, S) -> T) -> Pid<T> {
        let mut convert = ConvertEach(function);
        let mut number = |row, value| convert.parameter(row, value);
        Pid {
            proportional_band: number(&quantity.rows().proportional_band, self.proportional_band),
            integral_time: self.integral_time.map(|time| number(&parameter::INTEGRAL_TIME, time)),
            derivative_time: number(&parameter::DERIVATIVE_TIME, self.derivative_time),
            derivative_filter: number(&parameter::DERIVATIVE_FILTER, self.derivative_filter),
            set_point_weight: number(&parameter::SET_POINT_WEIGHT, self.set_point_weight),
            tracking_time: self.tracking_time.map(|time| number(&parameter::TRACKING_TIME, time)),
            bias: number(&parameter::BIAS, self.bias),
            output: self.output,
        }
    }

    /// What the output means.
    pub fn output(&self) -> Output {
        self.output
    }

    /// The memory before the first sample.
    pub fn begin(&self) -> PidMemory<S> {
        PidMemory { integral: S::zero(), derivative: S::zero(), last: None, integral_rate: S::zero() }
    }
}

impl<R: Real> Pid<R> {
    /// The output u at a sample at `time` in s.
    pub fn act(&self, time: R, target: R, measured: R, memory: &mut PidMemory<R>) -> R {
        let gain = R::one() / self.proportional_band;
        let (step, change) = match memory.last {
            Some((last, before)) => (time - last, measured - before),
            None => (R::zero(), R::zero()),
        };
        memory.integral = memory.integral + step * memory.integral_rate;
        if self.derivative_time.value() > 0.0 {
            let ahead = self.derivative_time;
            let kick = gain * self.derivative_filter * change;
            memory.derivative = ahead * (memory.derivative - kick) / (ahead + self.derivative_filter * step);
        }
        let proportional = gain * (self.set_point_weight * target - measured);
        let whole = self.bias + proportional + memory.integral + memory.derivative;
        let least = match self.output {
            Output::FillExhaust => R::zero(),
            Output::FillHoldExhaust => -R::one(),
        };
        let cut = whole.larger(least).smaller(R::one());
        if let Some(integral_time) = self.integral_time {
            let drawn_back = (cut - whole) / self.tracking(integral_time);
            memory.integral_rate = gain * (target - measured) / integral_time + drawn_back;
        }
        memory.last = Some((time, measured));
        cut
    }

    fn tracking(&self, integral_time: R) -> R {
        match self.tracking_time {
            Some(time) => time,
            None if self.derivative_time.value() > 0.0 => (integral_time * self.derivative_time).sqrt(),
            None => integral_time,
        }
    }

    /// What the valve is to do at an output u.
    pub fn drive(&self, output: R) -> Drive<R> {
        let (pulse, rest) = match self.output {
            Output::FillExhaust => (Request::Fill, Request::Exhaust),
            Output::FillHoldExhaust if output.value() < 0.0 => (Request::Exhaust, Request::Hold),
            Output::FillHoldExhaust => (Request::Fill, Request::Hold),
        };
        Drive::Pulses { duty: output.magnitude(), pulse, rest }
    }
}
