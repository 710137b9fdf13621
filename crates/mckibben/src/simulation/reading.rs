//! Samples that are read of a run as it is made.
//!
//! Checked by `tests/run.rs`: what is read on the way is what a kept run gives, bit by bit.

use crate::valve::SIMULTANEOUS;
use core::iter::Peekable;

/// A step from which samples can be read at times.
pub trait Readable {
    /// What is read.
    type Sample;

    /// Whether the next step begins after a time in s. Of the steps that have begun by a time the last one holds it.
    fn holds(&self, time: f64) -> bool;

    /// The sample at a time in s, kept within the step.
    fn read(&self, time: f64) -> Self::Sample;
}

/// Samples at given times of a run of known length, read as it is made: exactly those that a kept trajectory gives.
#[derive(Clone, Debug)]
pub struct Reading<I: Iterator<Item = f64>> {
    times: Peekable<I>,
    end: f64,
}

impl<I: Iterator<Item = f64>> Reading<I> {
    /// Reads at `times` in s, which do not fall, of a run of `duration` s.
    pub fn new(times: I, duration: f64) -> Self {
        Self { times: times.peekable(), end: duration }
    }

    /// Hands to `each` the samples that a step holds.
    ///
    /// # Errors
    /// Those of `each`.
    pub fn step<S: Readable + ?Sized, E>(
        &mut self,
        step: &S,
        mut each: impl FnMut(&S::Sample) -> Result<(), E>,
    ) -> Result<(), E> {
        let end = self.end;
        while let Some(time) = self.times.next_if(|time| *time < end * (1.0 - SIMULTANEOUS) && step.holds(*time)) {
            each(&step.read(time))?;
        }
        Ok(())
    }

    /// Hands to `each` the sample at the end of the run once for every time that is left.
    ///
    /// # Errors
    /// Those of `each`.
    pub fn finish<S, E>(self, last: &S, mut each: impl FnMut(&S) -> Result<(), E>) -> Result<(), E> {
        self.times.into_iter().try_for_each(|_| each(last))
    }
}
