//! Sampling: when a controller measures, and when what it decides takes effect.
//!
//! ```text
//! t_k = k/f_s                     measurement k = 0, 1, 2, …
//! decision k holds from t_(k+d) until t_(k+d+1)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | f_s | `rate` | Hz |
//! | d | `delay` | sampling instants |
//! | f | `pulse_frequency` of the modulation that follows a duty cycle | Hz |
//!
//! Instants come from their index and are never summed: the millionth is as exact as the first. Until decision 0 takes
//! effect the valve has no command and its coils stay released.

use crate::convert::{Convert, ConvertEach};
use crate::error::Error;
use crate::parameter::{self, Parameter};
use crate::scalar::{Real, Scalar};

/// Largest delay in sampling instants.
pub const MAX_DELAY: usize = 16;

/// When a controller measures, when its decisions take effect, and when pulses start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling<S = f64> {
    rate: S,
    delay: usize,
    pulse_frequency: S,
}

impl Sampling {
    /// Samples at `rate` (Hz, above zero) that take effect `delay` instants later, one pulse a sample.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a rate that is not above zero or a delay above [`MAX_DELAY`].
    pub fn new(rate: f64, delay: usize) -> Result<Self, Error> {
        parameter::CONTROL_RATE.check(rate)?;
        parameter::CONTROL_DELAY.check(delay as f64)?;
        Ok(Self { rate, delay, pulse_frequency: rate })
    }

    /// Sets the frequency of the pulses in Hz, apart from that of the samples.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is above zero.
    pub fn with_pulse_frequency(self, frequency: f64) -> Result<Self, Error> {
        Ok(Self { pulse_frequency: parameter::PULSE_FREQUENCY.check(frequency)?, ..self })
    }
}

impl<S: Scalar> Sampling<S> {
    /// Converts the sampling to another scalar type; `function` receives each number with its parameter.
    pub fn map<T: Scalar>(&self, function: impl FnMut(&'static Parameter, S) -> T) -> Sampling<T> {
        let mut convert = ConvertEach(function);
        Sampling {
            rate: convert.parameter(&parameter::CONTROL_RATE, self.rate),
            delay: self.delay,
            pulse_frequency: convert.parameter(&parameter::PULSE_FREQUENCY, self.pulse_frequency),
        }
    }

    /// That a run of `duration` s has no more than [`MAX_COUNT`](crate::parameter::MAX_COUNT) samples and pulses.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub fn check_counts(&self, duration: f64) -> Result<(), Error>
    where
        S: Real,
    {
        let (rate, pulses) = (self.rate.value(), self.pulse_frequency.value());
        parameter::CONTROL_RATE.check_count(rate, rate * duration, "samples of the controller")?;
        parameter::PULSE_FREQUENCY.check_count(pulses, pulses * duration, "pulses")?;
        Ok(())
    }

    /// Samples a second.
    pub fn rate(&self) -> S {
        self.rate
    }

    /// Sampling instants between a measurement and its effect.
    pub fn delay(&self) -> usize {
        self.delay
    }

    /// Frequency of the pulses in Hz.
    pub fn pulse_frequency(&self) -> S {
        self.pulse_frequency
    }

    /// The sampling instant of an index, in s.
    pub fn instant(&self, index: u64) -> S {
        S::constant(index as f64) / self.rate
    }
}

/// How far sampling has come: what the controller remembers, and what it decided that has no effect yet. It belongs to the
/// caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled<M, A> {
    /// The controller's memory.
    pub memory: M,
    taken: u64,
    pending: [Option<A>; MAX_DELAY],
}

impl<M, A> Sampled<M, A> {
    /// Before the first sampling instant.
    pub fn begin(memory: M) -> Self {
        Self { memory, taken: 0, pending: [const { None }; MAX_DELAY] }
    }

    /// The next sampling instant in s.
    pub fn next<S: Scalar>(&self, sampling: &Sampling<S>) -> S {
        sampling.instant(self.taken)
    }

    /// Takes the sample that is due by `decide`; what takes effect at this instant, if anything has been decided for it.
    pub fn take<S: Scalar>(&mut self, sampling: &Sampling<S>, decide: impl FnOnce(&mut M) -> A) -> Option<A> {
        let decided = Some(decide(&mut self.memory));
        let taken = self.taken;
        self.taken += 1;
        match sampling.delay() as u64 {
            0 => decided,
            delay => core::mem::replace(&mut self.pending[(taken % delay) as usize], decided),
        }
    }
}
