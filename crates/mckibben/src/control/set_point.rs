//! Set points: what is wanted, as a function of time.
//!
//! ```text
//! constant   w(t) = w₀
//! sinusoid   w(t) = w₀ + A sin(2π f t + φ)
//! lines      straight lines between (t, w), constant before the first row and after the last
//! steps      each value from its time on, the first one before it
//! ```
//!
//! A set point is evaluated on sampling instants only. Two times that differ by the rounding of their own computation
//! are one: a step at a sampling instant is seen at that instant.

use super::Quantity;
use crate::convert::{Convert, ConvertEach};
use crate::error::Error;
use crate::parameter::{self, Parameter};
use crate::scalar::{Real, Scalar};
use core::f64::consts::TAU;

/// What is wanted, as a function of time, in the unit of its quantity.
#[derive(Clone, Debug, PartialEq)]
pub enum SetPoint<S = f64> {
    /// Constant over time.
    Constant(S),
    /// `mean + amplitude · sin(2π · frequency · t + phase)`.
    Sinusoid {
        /// Mean.
        mean: S,
        /// Amplitude.
        amplitude: S,
        /// Frequency in Hz.
        frequency: S,
        /// Phase in rad.
        phase: S,
    },
    /// Straight lines between points.
    #[cfg(feature = "alloc")]
    Lines {
        /// Times in s, strictly rising.
        time: alloc::vec::Vec<S>,
        /// Values.
        value: alloc::vec::Vec<S>,
    },
    /// Each value from its time on.
    #[cfg(feature = "alloc")]
    Steps {
        /// Times in s, strictly rising.
        time: alloc::vec::Vec<S>,
        /// Values.
        value: alloc::vec::Vec<S>,
    },
}

impl SetPoint {
    /// A constant set point of a quantity.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a value that the quantity cannot have.
    pub fn constant(quantity: Quantity, value: f64) -> Result<Self, Error> {
        Ok(Self::Constant(quantity.rows().set_point.check(value)?))
    }

    /// `mean + amplitude · sin(2π · frequency · t + phase)`, with a frequency in Hz and a phase in rad.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range, or a least value that the quantity cannot have.
    pub fn sinusoid(quantity: Quantity, mean: f64, amplitude: f64, frequency: f64, phase: f64) -> Result<Self, Error> {
        let rows = quantity.rows();
        rows.set_point.check(mean)?;
        rows.amplitude.check(amplitude)?;
        rows.set_point.check(mean - amplitude)?;
        parameter::SET_FREQUENCY.check(frequency)?;
        parameter::SET_PHASE.check(phase)?;
        Ok(Self::Sinusoid { mean, amplitude, frequency, phase })
    }

    /// Straight lines through `(time, value)`, with times in s.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists are empty, differ in length, or the times are negative or do not rise;
    /// [`Error::OutOfRange`] for a value that the quantity cannot have.
    #[cfg(feature = "alloc")]
    pub fn lines(quantity: Quantity, time: alloc::vec::Vec<f64>, value: alloc::vec::Vec<f64>) -> Result<Self, Error> {
        check_table(quantity, &time, &value)?;
        Ok(Self::Lines { time, value })
    }

    /// Each value from its time in s on.
    ///
    /// # Errors
    /// As [`SetPoint::lines`].
    #[cfg(feature = "alloc")]
    pub fn steps(quantity: Quantity, time: alloc::vec::Vec<f64>, value: alloc::vec::Vec<f64>) -> Result<Self, Error> {
        check_table(quantity, &time, &value)?;
        Ok(Self::Steps { time, value })
    }
}

#[cfg(feature = "alloc")]
fn check_table(quantity: Quantity, time: &[f64], value: &[f64]) -> Result<(), Error> {
    let row = quantity.rows().set_point;
    if time.len() != value.len() || time.is_empty() {
        return Err(Error::Table {
            name: row.key,
            problem: "there is not one value for each time",
            entry: time.len().min(value.len()) + 1,
            remedy: "give as many values as times",
        });
    }
    crate::valve::check_times(parameter::SET_TIME.key, time)?;
    value.iter().try_for_each(|value| row.check(*value).map(drop))
}

impl<S: Real> SetPoint<S> {
    /// The frequency in Hz with which it repeats; none where it does not.
    pub fn frequency(&self) -> Option<S> {
        match self {
            Self::Sinusoid { frequency, .. } if frequency.value() > 0.0 => Some(*frequency),
            _ => None,
        }
    }

    /// The time in s from which on nothing changes but by its frequency.
    #[cfg(feature = "alloc")]
    pub fn last_change(&self) -> S {
        match self {
            Self::Constant(_) | Self::Sinusoid { .. } => S::zero(),
            Self::Lines { time, .. } | Self::Steps { time, .. } => time.last().copied().unwrap_or(S::zero()),
        }
    }
}

impl<S: Scalar> SetPoint<S> {
    /// Converts the set point of a quantity to another scalar type; `function` receives each number with its parameter.
    pub fn map<T: Scalar>(&self, quantity: Quantity, function: impl FnMut(&'static Parameter, S) -> T) -> SetPoint<T> {
        let (rows, mut convert) = (quantity.rows(), ConvertEach(function));
        let mut number = |row, value: &S| convert.parameter(row, *value);
        match self {
            Self::Constant(value) => SetPoint::Constant(number(rows.set_point, value)),
            Self::Sinusoid { mean, amplitude, frequency, phase } => SetPoint::Sinusoid {
                mean: number(rows.set_point, mean),
                amplitude: number(&rows.amplitude, amplitude),
                frequency: number(&parameter::SET_FREQUENCY, frequency),
                phase: number(&parameter::SET_PHASE, phase),
            },
            #[cfg(feature = "alloc")]
            Self::Lines { time, value } => SetPoint::Lines {
                time: time.iter().map(|time| number(&parameter::SET_TIME, time)).collect(),
                value: value.iter().map(|value| number(rows.set_point, value)).collect(),
            },
            #[cfg(feature = "alloc")]
            Self::Steps { time, value } => SetPoint::Steps {
                time: time.iter().map(|time| number(&parameter::SET_TIME, time)).collect(),
                value: value.iter().map(|value| number(rows.set_point, value)).collect(),
            },
        }
    }
}

impl<R: Real> SetPoint<R> {
    /// Its least and its greatest value.
    pub fn ends(&self) -> [R; 2] {
        match self {
            Self::Constant(value) => [*value; 2],
            Self::Sinusoid { mean, amplitude, .. } => [*mean - *amplitude, *mean + *amplitude],
            #[cfg(feature = "alloc")]
            Self::Lines { value, .. } | Self::Steps { value, .. } => value[1..]
                .iter()
                .fold([value[0]; 2], |[least, most], value| [least.smaller(*value), most.larger(*value)]),
        }
    }

    /// What is wanted at a time in s.
    pub fn at(&self, now: R) -> R {
        match self {
            Self::Constant(value) => *value,
            Self::Sinusoid { mean, amplitude, frequency, phase } => {
                *mean + *amplitude * (R::constant(TAU) * *frequency * now + *phase).sin()
            }
            #[cfg(feature = "alloc")]
            Self::Lines { time, value } => {
                let passed = begun(time, now);
                if passed == 0 || passed == time.len() {
                    return value[passed.max(1) - 1];
                }
                let share = (now - time[passed - 1]) / (time[passed] - time[passed - 1]);
                value[passed - 1] + share * (value[passed] - value[passed - 1])
            }
            #[cfg(feature = "alloc")]
            Self::Steps { time, value } => value[begun(time, now).max(1) - 1],
        }
    }
}

/// How many rows have begun.
#[cfg(feature = "alloc")]
fn begun<R: Real>(time: &[R], now: R) -> usize {
    time.partition_point(|begins| crate::valve::is_due(*begins, now))
}
